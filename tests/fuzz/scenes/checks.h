// SPDX-License-Identifier: GPL-3.0-or-later
// What every scene is held against.
#pragma once

#include "scenes/plan.h"

#include <cstdint>
#include <string>

namespace spc::fuzz {

// What is broken, by which a smaller scene that fails is known to fail alike. They are exit codes, too.
enum class Check : uint8_t { weights = 10, numbers, progress, times, cancelling, means };
inline constexpr Check kChecks[] = {Check::weights, Check::numbers,    Check::progress,
                                    Check::times,   Check::cancelling, Check::means};
const char* name_of(Check check);

struct Broken {
    Check check;
    std::string what;
};

// What scenes told.
struct Tally {
    uint64_t scenes;
    uint64_t paths;      // whose weights were summed
    uint64_t pairs;      // of methods, compared
    uint64_t undecided;  // pairs for which one was too slow, or whose difference a few pixels make
    uint64_t doubted;    // pairs that differed, and with more samples did not
    uint64_t renders;    // whose times were taken
    double slowest_first_sample, longest_after_limit, longest_after_cancel;  // s
    double worst_sum;  // of weights: its distance from one
    double log_noticed;  // logarithms of what part of a picture's light a pair would be seen to differ by
};

// How times are judged: as promised on a quiet machine, or by twice that, for what other programs do to
// caches and clocks. In either case processor time counts where that is less than what has passed.
inline constexpr double kBusy = 2.0, kQuiet = 1.0;

// Throw Broken. `seed`: of random choices.
// The techniques' weights of single paths sum to one, in the plan under one of its lights alone.
void check_weights(const Plan& plan, uint64_t seed, Tally& tally);
// Methods without bias have one mean, and no pass has a number that is none. `with_bias`: one that has some
// is taken for one of them, which is to be noticed.
void check_means(const Plan& plan, uint64_t seed, bool with_bias, Tally& tally);
// Renders come to a first sample, to their end and to a stop in time, and show progress all the while.
void check_times(const Plan& plan, uint64_t seed, double patience, Tally& tally);

}  // namespace spc::fuzz
