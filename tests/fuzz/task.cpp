// SPDX-License-Identifier: GPL-3.0-or-later
#include "task.h"

#include <cstdio>
#include <cstdlib>

namespace spc::fuzz {

Task parse(int count, char** arguments,
           const std::function<bool(const std::string& name, const char* value)>& takes) {
    Task task;
    for (int i = 1; i < count; i += 2) {
        const std::string name = arguments[i];
        const char* value = i + 1 < count ? arguments[i + 1] : nullptr;
        if (value != nullptr && name == "--seed")
            task.seed = std::strtoull(value, nullptr, 10);
        else if (value != nullptr && name == "--count")
            task.count = std::strtoull(value, nullptr, 10);
        else if (value != nullptr && name == "--cpu-seconds")
            task.cpu_seconds = std::strtod(value, nullptr);
        else if (value != nullptr && name == "--minutes")
            task.seconds = 60.0 * std::strtod(value, nullptr);
        else if (value == nullptr || !takes(name, value)) {
            std::fprintf(stderr,
                         "%s [--seed N] [--count N | --cpu-seconds N | --minutes N]: what is %s?\n",
                         arguments[0], name.c_str());
            std::exit(2);
        }
    }
    if (task.cpu_seconds > 0.0 || task.seconds > 0.0) task.count = ~uint64_t{0} - task.seed;
    return task;
}

}  // namespace spc::fuzz
