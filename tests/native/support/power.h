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

// How often a test does what is no statistic: under a sanitizer, which makes each step ten times as
// long, only so often that all of its code runs.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
template <class T>
constexpr T repeats(T usual, T sanitized) {
    return kSanitized ? sanitized : usual;
}

}  // namespace spc::test
