// SPDX-License-Identifier: GPL-3.0-or-later
// How much statistical tests take: enough for every day, or all of their power.
#pragma once

#include <cstdlib>

namespace spc::test {

// `./dev test --nightly` sets it.
inline bool nightly() { return std::getenv("SPECULA_TEST_NIGHTLY") != nullptr; }

// Samples, rounds or deviations that are noticed: what every run takes, and what a nightly one
// does.
template <class T>
T power(T daily, T at_night) {
    return nightly() ? at_night : daily;
}

}  // namespace spc::test
