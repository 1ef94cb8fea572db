// SPDX-License-Identifier: GPL-3.0-or-later
// What a ray finds where it meets the scene: geometry and closures for transport, and the local
// shape with derivatives that manifold walks need.
#pragma once

#include "scene/scene.h"

namespace spc {

// A point of a surface from which rays leave.
struct RayStart {
    Vec3 p;       // world
    Vec3 ng;      // unit, either side
    float error;  // m: position_error()
};

// A point on a surface as transport sees it.
struct Surface {
    SurfaceHit hit;
    Vec3 p;           // world
    float p_error;    // m, see RayStart
    Vec3 ng;          // unit geometric normal on the side of wo
    Vec3 n;           // unit interpolated normal on the side of wo (before any normal map)
    Vec3 wo;          // unit, towards where the path came from
    bool backfacing;  // wo sees the back of the triangle
    ClosureList closures;
};

// Bound of the distance along the normal, in m, by which rounding may part a point of the triangle,
// as the functions here compute it, from the triangle that a ray cast meets.
float position_error(const Scene& scene, uint32_t instance, uint32_t triangle);
// The same of a lamp's points, which no tree knows.
float position_error(const Vec3& p);
// What a ray adds to that by each metre of its way to a surface: of an instance, and of a lamp.
float ray_error(const Scene& scene, uint32_t instance);
constexpr float kRayError = 0x1p-19f;
// Of the point p of the hit's triangle; ng on its front side.
RayStart ray_start(const Scene& scene, const SurfaceHit& hit, const Vec3& p);

// Fills `surface` with everything, closures included. `wo` = -direction of the ray that made the
// hit.
void evaluate_surface(const Scene& scene, const SurfaceHit& hit, const Vec3& wo, Surface& surface);
// The same for points of view that need one thing alone.
Spectrum surface_emission(const Scene& scene, const SurfaceHit& hit, const Vec3& wo);
Spectrum surface_transparency(const Scene& scene, const SurfaceHit& hit, const Vec3& wo);
Vec3 surface_position(const Scene& scene, const SurfaceHit& hit);
// Unit geometric normal of a triangle on its front side, world; by the instance's handedness.
Vec3 front_normal(const Scene& scene, uint32_t instance, uint32_t triangle);

// The local shape of a caster at a hit, world space, by the barycentrics (u, v) of SurfaceHit. `n`
// is the normal of the material's specular interface on the *front* side: the mapped one, or the
// interpolated mesh normal if `smooth_base` is asked for. Its derivatives are exact inside a
// texture cell.
struct DifferentialGeometry {
    Vec3 p, dp_du, dp_dv;
    Vec3 n, dn_du, dn_dv;
    Vec3 ng;               // unit, front side
    float p_error = 0.0f;  // m, see RayStart
};
DifferentialGeometry evaluate_caster(const Scene& scene, const SurfaceHit& hit, bool smooth_base);

// Origin for a ray that leaves the surface at `from` towards the side of `direction`: as far from
// the triangle as rounding could have p and ray cast disagree about it, and no farther.
Vec3 offset_origin(const RayStart& from, const Vec3& direction);

}  // namespace spc
