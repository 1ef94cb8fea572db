// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between a surface and the light, or the next vertex, that a path connects it to.
#pragma once

#include "scene/media.h"

namespace spc {

// The far end of a connection: a point, or a direction if distant.
struct ChainEnd {
    bool distant;
    Vec3 p;          // if not distant
    Vec3 direction;  // if distant: unit, towards the light
    // How far along the ray rounding may put the surface on which p lies, m; 0 if p lies on none
    // that blocks.
    float margin = 0.0f;
    Vec3 from(const Vec3& vertex, float& distance) const {
        if (distant) {
            distance = kInfinity;
            return direction;
        }
        const Vec3 to = p - vertex;
        distance = length(to);
        return to * (1.0f / distance);
    }
};

// What a connection cannot be looked through.
enum class Opaque : uint8_t {
    by_material,  // what its material says
    casters_too   // and every caster, however transparent
};

// Fraction of light that passes from the surface point `from` to `end` (both excluded) through
// transparent surfaces, as a ray of `kind` sees them, and the media between them. Takes those
// surfaces off `transparent_left`; one more blocks. `media`: those behind `from`, then, if any light
// passes, those before `end`. Counts the rays that it casts in `rays`.
Spectrum transmittance(const Scene& scene, const RayStart& from, const ChainEnd& end, uint32_t kind,
                       uint32_t& transparent_left, Media& media, uint64_t& rays,
                       Opaque opaque = Opaque::by_material);

}  // namespace spc
