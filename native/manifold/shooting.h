// SPDX-License-Identifier: GPL-3.0-or-later
// Shots: Newton's method for chains of any length. The unknown is the direction at the receiver,
// whose ray is traced through all vertices with its differential; so there are two equations in two
// unknowns, however many vertices there are.
#pragma once

#include "manifold/caster.h"
#include "manifold/facet.h"

namespace spc {

// One vertex of a chain kind: the instance, and how light leaves it.
struct ChainLink {
    uint32_t instance;
    Interaction interaction;
    auto operator<=>(const ChainLink&) const = default;  // NOLINT(modernize-use-nullptr)
};
// What a chain meets, from the receiver on. Only the first `count` links are used.
struct ChainKind {
    uint32_t count = 0;
    std::array<ChainLink, kLongestChain> links{};
    auto operator<=>(const ChainKind&) const = default;  // NOLINT(modernize-use-nullptr)

    void append(const ChainLink& link) { links[count++] = link; }
    ChainKind first(uint32_t n) const;
    ChainKind reversed() const;
};

// For each vertex from the receiver on, a point of [0, 1)^2 that selects the facet if the vertex
// lies on a rough surface.
using FrozenFacets = std::array<Vec2, kLongestChain>;
FrozenFacets freeze_facets(Pcg& pcg);

// Vertices along a chain, from the receiver on.
struct Chain {
    uint32_t count = 0;
    std::array<SurfaceHit, kLongestChain> hits;
    std::array<ChainVertex, kLongestChain> vertices;
};

// A solution of a shot. The resolutions (m) bound how far its first and last vertex may lie from
// the true ones.
struct ChainSolution {
    ChainKind kind;
    Chain chain;
    float first_resolution, last_resolution;
    Vec3 w;  // unit direction at the receiver
    // `determinant`: of the endpoint error's derivative by w; zero on a fold, with opposite signs
    // on its sides. `softest`: unit direction across w in which the endpoint error changes least;
    // two solutions that meet on a fold lie along it.
    float determinant;
    Vec3 softest;
};

// Solves for a chain of this kind from x to `end`, starting with the unit direction `w` at x. A
// step whose ray misses its caster, meets total internal reflection or the wrong side of a surface
// is halved, at most `max_halvings` times. Empty if that fails, if the shot diverges, or on a fold,
// where solutions cannot be told apart. Occlusion between the vertices is ignored. Without `facets`
// rough surfaces block the shot.
std::optional<ChainSolution> shoot(const Scene& scene, const ManifoldSettings& settings,
                                   const RayStart& x, const ChainEnd& end, const ChainKind& kind,
                                   const Vec3& w, int max_halvings, ManifoldStats& stats,
                                   const FrozenFacets* facets = nullptr);

// Looks for the other solution of the same kind beyond a nearby fold, whose determinant has the
// other sign. Where it should lie is extrapolated from how the determinant changes over a step of
// `step` rad.
std::optional<ChainSolution> shoot_across_fold(const Scene& scene, const ManifoldSettings& settings,
                                               const RayStart& x, const ChainEnd& end,
                                               const ChainSolution& solution, float step,
                                               int max_halvings, ManifoldStats& stats);

// A chain seed: where a shot for a chain starts.
struct ChainSeed {
    ChainKind kind;
    Vec3 w;  // unit, at the receiver
};
// Draws a chain seed: follows a random ray from the receiver to a caster and on through casters. It
// is reflected or refracted at random, about as Fresnel has it, or as settings.family demands. Half
// of the rays aim at points uniform over the caster's specular area, half are uniform in the cone
// of its bounding sphere. Empty if the ray meets no caster. `facets`: see shoot().
std::optional<ChainSeed> sample_chain(const Scene& scene, const ManifoldSettings& settings,
                                      const RayStart& x, const CasterSet& casters, uint32_t caster,
                                      Pcg& pcg, ManifoldStats& stats,
                                      const FrozenFacets* facets = nullptr);
// A random ray through casters, with its differential behind each of them.
struct FollowedRay {
    struct Behind {
        Vec3 p;  // position of the vertex
        RayDual ray;
    };
    ChainKind kind;
    Vec3 w;
    uint32_t fewest =
        1;  // first vertex behind which a light counts; the last one if settings.family is set
    std::array<Behind, kLongestChain> behind;
};
// Follows a camera ray from the first caster that it meets, as sample_chain() does.
std::optional<FollowedRay> follow_camera_ray(const Scene& scene, const ManifoldSettings& settings,
                                             Ray ray, const CasterSet& casters, Pcg& pcg,
                                             ManifoldStats& stats);
// Angle (rad at the receiver) of Newton's first step from this ray towards `end`. Of many rays,
// only those with a small angle are worth a shot.
float turn_towards(const FollowedRay::Behind& behind, const ChainEnd& end);
// MNEE seed of refractions: the straight segment to the end, refracted by every caster that it
// crosses [Hanika15]. Other occluders are ignored. Empty if it crosses none, or more than a chain
// may have.
std::optional<ChainSeed> straight_chain(const Scene& scene, const ManifoldSettings& settings,
                                        const RayStart& x, const CasterSet& casters,
                                        const ChainEnd& end, ManifoldStats& stats);
// MNEE seed of a reflection: one vertex on the caster, in the direction of the caster's centre.
// Empty if x is the centre.
std::optional<ChainSeed> central_reflection(const RayStart& x, const Caster& caster);

// Whether two solutions for the same ends are the same chain.
bool same_solution(const ManifoldSettings& settings, const ChainSolution& a, const ChainSolution& b);

}  // namespace spc
