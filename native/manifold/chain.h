// SPDX-License-Identifier: GPL-3.0-or-later
// Specular interactions between a receiver x and a light point y, seen as a map: the constraint of
// one, which vanishes where light can pass, and the derivative of a chain of any length.
#pragma once

#include "light/light.h"
#include "manifold/settings.h"
#include "scene/surface.h"
#include "scene/transmittance.h"

#include <span>

namespace spc {

// Of single precision, with room for the handful of operations that each coordinate has seen.
inline constexpr float kUnitRoundoff = 8.0f * 0x1p-24f;
inline float largest_coordinate(const Vec3& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

// Whether the material lets light pass a surface so.
bool has_interaction(const SpecularInterface& specular, Interaction interaction);
// Whether wi and wo leave the geometric and the shading surface as the interaction demands.
bool sides_agree(const DifferentialGeometry& geometry, const Vec3& wi, const Vec3& wo,
                 Interaction interaction);

// Index ratio for light that passes the interface: behind the surface over in front of it, as seen
// by the side on which `ng` points at the receiver. `ior` is that of the back of a front face.
float eta_seen_from(const Vec3& front_ng, const Vec3& towards, float ior);

// The constraint to use where `preferred` is asked for. A refraction at an index ratio of 1 has no
// half-vector: wi + eta wo vanishes at every solution.
Constraint constraint_for(Constraint preferred, Interaction interaction, float eta);

// Value and derivative by (u, v) of the constraint at a vertex. `C` is an angle in radians
// (half-vector: the sine of the angle between generalised half-vector and normal; angle-difference:
// between scattered and wanted direction), zero exactly where the chain is admissible. The unit
// normal n and its derivatives may be any: the shading normal, or an offset one in the first of two
// stages.
struct ConstraintValue {
    Vec2 c;
    Vec2 dc_du, dc_dv;
    float noise;  // what rounding to single precision leaves of C at an exact solution
    float size() const { return std::sqrt(c.x * c.x + c.y * c.y); }
};
// [Zeltner20]. Empty at total internal reflection (angle-difference) or a
// degenerate half-vector.
std::optional<ConstraintValue> evaluate_constraint(Constraint constraint, Interaction interaction,
                                                   float eta, const Vec3& x,
                                                   const DifferentialGeometry& vertex,
                                                   const ChainEnd& end);

// A vertex of a chain, as seen from x: `eta` behind over in front.
struct ChainVertex {
    Interaction interaction;
    float eta;
    DifferentialGeometry geometry;
};

// A ray, and what becomes of its position and direction if what it comes from is changed by two
// parameters: turns at a receiver, or the place in the picture. In double precision.
struct RayDual {
    Vec3d d;                      // unit
    std::array<Vec3d, 2> dp, dd;  // of position and direction
    double etendue = 1.0;         // see ChainDerivative
};
// Leaves x along the unit direction w, and turns there.
RayDual ray_dual_from(const Vec3& w);
// Goes on by `distance` m to the plane of a vertex, then turns there. False where there is no way
// on: total internal reflection, or a vertex seen edge-on.
bool propagate_through_vertex(const ChainVertex& vertex, double distance, RayDual& ray);

struct ChainDerivative {
    // |d solid angle at x / d area at y|, 1/m^2, without the cosine at y; distant ends: by solid
    // angle at the light.
    double geometry;
    // What the other way round differs by: |d solid angle at y / d area at x| without the cosine at
    // x = geometry times this. (eta_x / eta_y)^2 where all normals are those of the geometry;
    // shading normals bend the light as no real surface would, and scale it at each vertex.
    double etendue;
};
// By ray differentials from x through all vertices in turn [Jakob12, in another form]; there may be
// none. Empty for a refraction that cannot be (total internal reflection) or a vertex seen edge-on.
std::optional<ChainDerivative> chain_derivative(const Vec3& x, std::span<const ChainVertex> chain,
                                                const ChainEnd& end);

}  // namespace spc
