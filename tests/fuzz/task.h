// SPDX-License-Identifier: GPL-3.0-or-later
// Which scenes a fuzzer runs, as its command line says.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace spc::fuzz {

struct Task {
    uint64_t seed = 1, count = 100;
    double cpu_seconds = 0.0, seconds = 0.0;  // if not 0, instead of a count
};

// [--seed N] [--count N | --cpu-seconds N | --minutes N], and the options that `takes(name,
// value)`. Ends the program where something else stands there.
Task parse(int count, char** arguments,
           const std::function<bool(const std::string& name, const char* value)>& takes);

}  // namespace spc::fuzz
