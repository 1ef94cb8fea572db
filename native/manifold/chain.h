// SPDX-License-Identifier: GPL-3.0-or-later
// A specular chain between a receiver x and a light point y: the constraint of one vertex, which
// vanishes where light can pass, and the derivative of a chain of any length.
#pragma once

#include "light/light.h"
#include "manifold/settings.h"
#include "scene/surface.h"
#include "scene/transmittance.h"

#include <span>

namespace spc {

// Roundoff of single precision after the handful of operations that each coordinate has seen.
inline constexpr float kUnitRoundoff = 8.0f * 0x1p-24f;
inline float largest_coordinate(const Vec3& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

// Whether the material has such an interaction.
bool has_interaction(const SpecularInterface& specular, Interaction interaction);
// Whether wi and wo lie on the sides of the geometric and the shading surface that the interaction
// demands.
bool sides_agree(const DifferentialGeometry& geometry, const Vec3& wi, const Vec3& wo,
                 Interaction interaction);

// Ratio of the index behind the interface to that in front of it, where `towards` points to the
// front. `ior` is that ratio for the front side, which `front_ng` points to.
float eta_seen_from(const Vec3& front_ng, const Vec3& towards, float ior);

// `preferred`, unless that is the half-vector and the index ratio is near 1: then wi + eta wo
// vanishes at every solution, and the angle difference is used.
Constraint constraint_for(Constraint preferred, Interaction interaction, float eta);

// The constraint C at a vertex with its derivatives by (u, v). C is a pair of angles (rad), zero
// exactly where light can pass: between the generalised half-vector and the normal (its sine), or
// between the scattered and the wanted direction. The normal may be any: the shading normal, or an
// offset one in the first of two stages.
struct ConstraintValue {
    Vec2 c;
    Vec2 dc_du, dc_dv;
    float noise;  // what rounding to single precision leaves of C at an exact solution
    float size() const { return std::sqrt(c.x * c.x + c.y * c.y); }
};
// [Zeltner20]. Empty at total internal reflection (angle difference) or a degenerate half-vector.
std::optional<ConstraintValue> evaluate_constraint(Constraint constraint, Interaction interaction,
                                                   float eta, const Vec3& x,
                                                   const DifferentialGeometry& vertex,
                                                   const ChainEnd& end);

// A vertex of a chain. `eta` is the index behind it over that in front, as seen from x.
struct ChainVertex {
    Interaction interaction;
    float eta;
    DifferentialGeometry geometry;
};

// A ray differential in double precision: a ray's direction, and the derivatives of its position
// and direction by two parameters, such as turns at the receiver or coordinates of the film.
struct RayDual {
    Vec3d d;                      // unit
    std::array<Vec3d, 2> dp, dd;  // derivatives of position and direction
    double etendue = 1.0;         // see ChainDerivative
};
// The ray from a point along the unit direction w; the parameters turn w in two orthogonal
// directions, rad.
RayDual ray_dual_from(const Vec3& w);
// Transfers the ray by `distance` m to the plane of a vertex and reflects or refracts it there.
// False at total internal reflection or a vertex seen edge-on.
bool propagate_through_vertex(const ChainVertex& vertex, double distance, RayDual& ray);

struct ChainDerivative {
    // |d solid angle at x / d area at y|, 1/m^2, without the cosine at y. For distant ends by solid
    // angle at the light instead of area.
    double geometry;
    // Ratio of the derivative the other way round, |d solid angle at y / d area at x| without the
    // cosine at x, to `geometry`. It is (eta_x / eta_y)^2 if all normals are geometric; each
    // shading normal scales it, since it bends light as no real surface would.
    double etendue;
};
// Computed by a ray differential from x through all vertices, of which there may be none; [Jakob12]
// has the same in another form. Empty at total internal reflection or a vertex seen edge-on.
std::optional<ChainDerivative> chain_derivative(const Vec3& x, std::span<const ChainVertex> chain,
                                                const ChainEnd& end);

}  // namespace spc
