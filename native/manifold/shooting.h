// SPDX-License-Identifier: GPL-3.0-or-later
// Chains of any length: Newton's method on the first direction at the receiver, whose ray is shot
// through all vertices with its differentials. Two equations in two unknowns, however many vertices
// there are.
#pragma once

#include "manifold/caster.h"
#include "manifold/facet.h"

namespace spc {

// What a chain meets, from the receiver on. Only the first `count` links mean anything.
struct ChainLink {
    uint32_t instance;
    Interaction interaction;
    auto operator<=>(const ChainLink&) const = default;  // NOLINT(modernize-use-nullptr)
};
struct ChainKind {
    uint32_t count = 0;
    std::array<ChainLink, kLongestChain> links{};
    auto operator<=>(const ChainKind&) const = default;  // NOLINT(modernize-use-nullptr)

    void append(const ChainLink& link) { links[count++] = link; }
    ChainKind first(uint32_t n) const;
    ChainKind reversed() const;
};

// For each vertex, from the receiver on, a place in [0, 1)^2: it stands for one facet on whichever
// rough surface the vertex lies.
using FrozenFacets = std::array<Vec2, kLongestChain>;
FrozenFacets freeze_facets(Pcg& pcg);

// Vertices along a chain, from the receiver on.
struct Chain {
    uint32_t count = 0;
    std::array<SurfaceHit, kLongestChain> hits;
    std::array<ChainVertex, kLongestChain> vertices;
};

// A solution. It may lie as far from the true one, in m, at its first and at its last vertex.
struct ChainSolution {
    ChainKind kind;
    Chain chain;
    float first_resolution, last_resolution;
    Vec3 w;  // unit direction at the receiver
    // Of the derivative by w of the angle by which a shot misses: 0 on a fold, and of the other sign
    // beyond. The unit direction across w in which the endpoint error changes least: two solutions that meet on
    // a fold lie along it.
    float determinant;
    Vec3 softest;
};

// Goes on from the unit direction `w` at the receiver to a chain of this kind that leads to `end`.
// Empty when it diverges, a ray misses its caster or meets total internal reflection or the wrong
// side of a surface, or on a fold, where solutions cannot be told apart. A step that fails so is
// halved, `max_halvings` times at most. What stands between the vertices does not matter. Without
// `facets` rough surfaces are the wrong side of everything.
std::optional<ChainSolution> shoot(const Scene& scene, const ManifoldSettings& settings,
                                   const RayStart& x, const ChainEnd& end, const ChainKind& kind,
                                   const Vec3& w, int max_halvings, ManifoldStats& stats,
                                   const FrozenFacets* facets = nullptr);

// The other solution of the same kind, across a fold, if there is one with a determinant of the other
// sign about where the determinant's linear change puts it: that is measured by a step of so many rad.
std::optional<ChainSolution> shoot_across_fold(const Scene& scene, const ManifoldSettings& settings,
                                               const RayStart& x, const ChainEnd& end,
                                               const ChainSolution& solution, float step,
                                               int max_halvings, ManifoldStats& stats);

// Where a chain may be looked for.
struct ChainSeed {
    ChainKind kind;
    Vec3 w;  // unit, at the receiver
};
// Follows a random ray from the receiver to a caster, and on through casters, reflected or refracted by
// chance, as Fresnel has it about, or as settings.family demands. Half of the rays aim at points uniform over the caster's specular area, half are
// uniform in the cone of its bounding sphere. Empty where the ray meets nothing. `facets`: as above.
std::optional<ChainSeed> sample_chain(const Scene& scene, const ManifoldSettings& settings,
                                      const RayStart& x, const CasterSet& casters, uint32_t caster,
                                      Pcg& pcg, ManifoldStats& stats,
                                      const FrozenFacets* facets = nullptr);
// A random ray through casters, and how it leaves each of them.
struct FollowedRay {
    struct Behind {
        Vec3 p;  // of the vertex
        RayDual ray;
    };
    ChainKind kind;
    Vec3 w;
    uint32_t fewest =
        1;  // turns behind which light is looked for; all, if settings.family says which
    std::array<Behind, kLongestChain> behind;
};
// As sample_chain has it, along a ray of the camera's and from the first caster that it meets on.
std::optional<FollowedRay> follow_camera_ray(const Scene& scene, const ManifoldSettings& settings,
                                             Ray ray, const CasterSet& casters, Pcg& pcg,
                                             ManifoldStats& stats);
// By how much, in rad at the receiver, Newton's first step would turn a ray that leaves its last vertex
// so for it to come to `end`: of many rays, only those nearby are worth a shot.
float turn_towards(const FollowedRay::Behind& behind, const ChainEnd& end);
// Along the segment to the end: refracted by every caster that it crosses, whatever else stands in
// its way [Hanika15]. Empty where it crosses none, or more than a chain may have.
std::optional<ChainSeed> straight_chain(const Scene& scene, const ManifoldSettings& settings,
                                        const RayStart& x, const CasterSet& casters,
                                        const ChainEnd& end, ManifoldStats& stats);
// Reflected once by the caster, from where x sees it in the direction of its middle. Empty in the
// middle.
std::optional<ChainSeed> central_reflection(const RayStart& x, const Caster& caster);

// Whether two solutions for the same ends are the same chain.
bool same_solution(const ManifoldSettings& settings, const ChainSolution& a, const ChainSolution& b);

}  // namespace spc
