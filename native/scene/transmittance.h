// SPDX-License-Identifier: GPL-3.0-or-later
// Transmittance of a connection between a surface and a light or another vertex.
#pragma once

#include "scene/media.h"

namespace spc {

// The endpoint of a connection: a point, or a direction if distant.
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

// An endpoint with what a ray to it needs. The surface at the endpoint must not block the ray, and
// whatever stands in front of it must, so the ray ends as near to p as rounding allows.
struct RayEnd {
    ChainEnd at;
    Vec3 ng{0.0f};           // normal of the surface that p lies on, unit, either side; zero: none
    float error = 0.0f;      // position_error() of p, m
    float ray_error = 0.0f;  // see ray_error()
    float clip = 0.0f;       // length by which the ray ends before p, m

    // The end of a ray from `vertex`: p, offset to that side of the surface.
    Vec3 beside(const Vec3& vertex) const;
};
RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const Vec3& p);
RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const DifferentialGeometry& vertex);

// What blocks a connection.
enum class Opaque : uint8_t {
    by_material,  // surfaces that are opaque by their material
    casters_too   // these and every caster, even where it is transparent
};

// Fraction of light between the surface point `from` and `end` (both excluded) that transparent
// surfaces visible to `kind`, and media, let pass. Each surface is subtracted from
// `transparent_left`; one too many blocks. `media`: the media at `from`; on return, if any light
// passes, those at `end`. Adds the number of rays cast to `rays`. `blockers`: LightLinks of the
// light at `end`.
Spectrum transmittance(const Scene& scene, const RayStart& from, const RayEnd& end, uint32_t kind,
                       uint32_t& transparent_left, Media& media, uint64_t& rays,
                       Opaque opaque = Opaque::by_material, uint64_t blockers = 0);
// The same for a ray of which more is known than its kind; lengths are found.
Spectrum transmittance(const Scene& scene, const RayStart& from, const RayEnd& end, uint32_t kind,
                       RayState ray, uint32_t& transparent_left, Media& media, uint64_t& rays,
                       Opaque opaque = Opaque::by_material, uint64_t blockers = 0);

}  // namespace spc
