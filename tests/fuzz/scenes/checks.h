// SPDX-License-Identifier: GPL-3.0-or-later
// The checks that every scene must pass.
#pragma once

#include "scenes/plan.h"

#include <cstdint>
#include <string>

namespace spc::fuzz {

// The checks by name. A smaller scene shows the same failure if the same check fails. The values
// are exit codes, too.
enum class Check : uint8_t { weights = 10, numbers, progress, times, cancelling, means };
inline constexpr Check kChecks[] = {Check::weights, Check::numbers,    Check::progress,
                                    Check::times,   Check::cancelling, Check::means};
const char* name_of(Check check);

struct Broken {
    Check check;
    std::string what;
};

// Counts and extremes over all scenes.
struct Tally {
    uint64_t scenes;
    uint64_t paths;      // whose weights were summed
    uint64_t pairs;      // of methods that were compared
    uint64_t undecided;  // pairs of which one was too slow, or that differ in a few pixels alone
    uint64_t doubted;    // pairs that differed, but did not with more samples
    uint64_t renders;    // whose times were measured
    double slowest_first_sample, longest_after_limit, longest_after_cancel;  // s
    double worst_sum;  // largest distance of a sum of weights from one
    // Sum over the pairs of the logarithm of the smallest relative difference that would be
    // noticed.
    double log_noticed;
};

// How many times longer than promised a render may take: twice as long on a busy machine, since
// other programs disturb caches and clocks. In either case times are those of Stopwatch.
inline constexpr double kBusy = 2.0, kQuiet = 1.0;

// The checks throw Broken. `seed` is that of their random choices.

// The techniques' weights of single paths sum to one, in the plan under one of its lights alone.
void check_weights(const Plan& plan, uint64_t seed, Tally& tally);
// Methods without bias have one mean, and all values of all passes are finite. `with_bias`: a
// biased method is compared as if it had none, which the check has to notice.
void check_means(const Plan& plan, uint64_t seed, bool with_bias, Tally& tally);
// Renders reach their first sample, end, and stop when they are cancelled, all in time, and show
// progress all the while. `patience`: kBusy or kQuiet.
void check_times(const Plan& plan, uint64_t seed, double patience, Tally& tally);

}  // namespace spc::fuzz
