// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces where rays meet the scene: geometry and closures for transport, and differential
// geometry for the manifold.
#pragma once

#include "scene/scene.h"

namespace spc {

// A point of a surface from which rays leave.
struct RayStart {
    Vec3 p;       // world
    Vec3 ng;      // unit, either side
    float error;  // m: position_error()
};

// A surface point as transport sees it.
struct Surface {
    SurfaceHit hit;
    Vec3 p;           // world
    float p_error;    // m, see RayStart
    Vec3 ng;          // unit geometric normal on the side of wo
    Vec3 n;           // unit interpolated normal on the side of wo (before any normal map)
    Vec3 wo;          // unit, towards the path's previous vertex
    bool backfacing;  // wo is on the back of the triangle
    ClosureList closures;
};

// Bound (m) of the distance along the normal by which rounding may separate a point of the
// triangle, as computed here, from the triangle that a ray cast meets.
float position_error(const Scene& scene, uint32_t instance, uint32_t triangle);
// The same for points of lamps.
float position_error(const Vec3& p);
// What a ray adds to that error for each metre of its length: to a surface of an instance, and of a
// lamp.
float ray_error(const Scene& scene, uint32_t instance);
constexpr float kRayError = 0x1p-19f;
// RayStart of the point p on the hit's triangle; ng is on its front side.
RayStart ray_start(const Scene& scene, const SurfaceHit& hit, const Vec3& p);

// Fills `surface`, closures included. `wo` = -direction of the ray that made the hit, `ray` what is
// known of it: Material::depends_on_ray.
void evaluate_surface(const Scene& scene, const SurfaceHit& hit, const Vec3& wo, Surface& surface,
                      const RayState& ray = {});
// The same for callers that need one value alone.
Spectrum surface_emission(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                          const RayState& ray = {});
Spectrum surface_transparency(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                              const RayState& ray = {});
// The same of what a node of Material::aovs writes.
Vec3 surface_color_aov(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                       const RayState& ray, uint32_t node);
float surface_value_aov(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                        const RayState& ray, uint32_t node);
Vec3 surface_position(const Scene& scene, const SurfaceHit& hit);
// By how much the material displaces the point of a hit: m, world. Of materials that move vertices.
Vec3 surface_displacement(const Scene& scene, const SurfaceHit& hit);
// Unit geometric normal on the triangle's front side, world. A mirrored instance is taken into
// account.
Vec3 front_normal(const Scene& scene, uint32_t instance, uint32_t triangle);

// Differential geometry of a caster at a hit: position and normal with their derivatives by the
// barycentrics (u, v) of SurfaceHit, world space. `n` is the normal of the material's specular
// interface on the *front* side: the mapped one, or the interpolated mesh normal if `smooth_base`
// is set. Its derivatives are exact inside a cell of a texture.
struct DifferentialGeometry {
    Vec3 p, dp_du, dp_dv;
    Vec3 n, dn_du, dn_dv;
    Vec3 ng;               // unit, front side
    float p_error = 0.0f;  // m, see RayStart
};
DifferentialGeometry evaluate_caster(const Scene& scene, const SurfaceHit& hit, bool smooth_base);

// Origin for a ray that leaves the surface at `from` along `direction`: offset to that side by the
// bound of rounding errors, and no farther.
Vec3 offset_origin(const RayStart& from, const Vec3& direction);

}  // namespace spc
