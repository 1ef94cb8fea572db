// SPDX-License-Identifier: GPL-3.0-or-later
// One mutated scene through the C interface: built, committed, rendered, and held against what
// specula.h promises.
#pragma once

#include <cstdint>

namespace spc::fuzz {

// What became of scenes.
struct Tally {
    uint64_t scenes, calls, refusals;
    uint64_t pictures;       // all of them finite
    uint64_t cancelled;      // renders, by us
    uint64_t out_of_memory;  // calls, or renders
    uint64_t bad_samples;    // pictures with samples that were dropped
    uint64_t bad_rays;       // pictures with rays that could not be cast
};

// Aborts, with a word of why, where a promise is not kept.
void run_scene(uint64_t seed, Tally& tally);

}  // namespace spc::fuzz
