// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that shine on some instances alone, or that some alone throw the shadow of. As in Cycles
// both are asked next to the light: whom it shines on is the surface at which it scatters first,
// a mirror or a pane as much as a wall; what shadows it stands between that surface and the light.
#pragma once

#include <cstdint>

namespace spc {

// Sets of instances are bits, which the host numbers.

// What a light is tied to; 0: to everything.
struct LightLinks {
    uint64_t receivers = 0;  // sets of which it shines on the members
    uint64_t blockers = 0;   // sets whose members throw its shadow
};
// The sets that an instance is in.
struct LinkSets {
    uint64_t receives = 0, blocks = 0;
};

inline bool is_linked(uint64_t links, uint64_t sets) { return links == 0 || (links & sets) != 0; }

}  // namespace spc
