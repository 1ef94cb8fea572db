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

// The far end as a ray comes to it. What lies there, such as the light itself, must not block the
// ray, and whatever stands in front of it must: the ray ends as near to p as rounding lets it.
struct RayEnd {
    ChainEnd at;
    Vec3 ng{0.0f};           // of the surface that p lies on: unit, either side; zero: of none
    float error = 0.0f;      // m: position_error() of p
    float ray_error = 0.0f;  // see there
    float clip = 0.0f;       // m: so much of the ray's end is left out

    // The end of a ray from `vertex`: beside p, on its side.
    Vec3 beside(const Vec3& vertex) const;
};
RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const Vec3& p);
RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const DifferentialGeometry& vertex);

// What a connection cannot be looked through.
enum class Opaque : uint8_t {
    by_material,  // what its material says
    casters_too   // and every caster, however transparent
};

// Fraction of light that passes from the surface point `from` to `end` (both excluded) through
// transparent surfaces, as a ray of `kind` sees them, and the media between them. Takes those
// surfaces off `transparent_left`; one more blocks. `media`: those behind `from`, then, if any light
// passes, those before `end`. Counts the rays that it casts in `rays`.
Spectrum transmittance(const Scene& scene, const RayStart& from, const RayEnd& end, uint32_t kind,
                       uint32_t& transparent_left, Media& media, uint64_t& rays,
                       Opaque opaque = Opaque::by_material);

}  // namespace spc
