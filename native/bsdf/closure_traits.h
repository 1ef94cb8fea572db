// SPDX-License-Identifier: GPL-3.0-or-later
// What a kind of closure is; what follows of it is asked of this row, never of the kind.
#pragma once

#include <cstdint>

namespace spc {

// The bounce counters and visibility flags that Blender knows.
enum class BounceKind : uint8_t { diffuse, glossy, transmission, transparent };

struct ClosureTraits {
    BounceKind reflected;    // what rays are that it sends to the side of wo
    BounceKind transmitted;  // and to the other side
    // Facets around its normal scatter: a delta where their alpha vanishes, a caustic where light
    // falls on what scatters diffusely.
    bool has_facets = false;
    bool straight = false;       // lets light pass as it came: shadow rays see through it
    bool crosses = false;        // scatters to the other side without facets
    bool all_around = false;     // scatters to either side, as one lobe
    bool enters = false;         // goes on below the surface: an integrator finds where it leaves
    bool albedo_varies = false;  // how much it scatters depends on wo
};

}  // namespace spc
