// SPDX-License-Identifier: GPL-3.0-or-later
// The chains between two points to which definite searches come, and trials until random ones do.
#pragma once

#include "manifold/ownership.h"
#include "manifold/sheet_pool.h"

namespace spc {

inline ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

struct FoundChain {
    ChainSolution solution;
    float probability;     // to be found
    float crossed = 0.0f;  // of a chain seed that has looked across a fold from there, the largest
};
using FoundChains = std::vector<FoundChain>;

// Of a chain that is known; null: it is not.
FoundChain* find_chain(const ManifoldSettings& settings, FoundChains& found,
                       const ChainSolution& solution);

// Adds the chains between x and y to which chain seeds of the sheet come.
void shoot_seeds(const Scene& scene, const ManifoldSettings& settings, const LightSheet& sheet,
                 const RayStart& x, const LightPoint& y, float probability_per_density, float u,
                 FoundChains& found, ManifoldStats& stats);
// The same of chain seeds of camera chains.
void shoot_seeds(const Techniques& techniques, const RayStart& x, const LightPoint& y,
                 FoundChains& found, ManifoldStats& stats);

// The chain to which manifold next event estimation comes between x and its end: for refractions
// from the straight line, for reflections from the middle of the caster, which is as good as any
// other point of a shape that nothing is known of.
std::optional<ChainSolution> shoot_from_mnee_seed(const Techniques& techniques, const RayStart& x,
                                                  const ChainEnd& end, Interaction first,
                                                  uint32_t caster, ManifoldStats& stats);

inline bool is_cancelled(const ManifoldSettings& settings) {
    return settings.cancelled != nullptr && settings.cancelled->load(std::memory_order_relaxed);
}

// Until a solution comes again, at most so many: a geometric distribution of mean 1 / p_k.
template <class Trial>
uint32_t count_trials(const ManifoldSettings& settings, uint32_t most, const Trial& comes_again) {
    uint32_t trials = 1;
    while (trials < most && !is_cancelled(settings) && !comes_again()) ++trials;
    return trials;
}

// Whether the chain seed, or one of those to the light, comes to the chain.
bool seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                const ChainSeed& chain_seed, const ChainSolution& solution, ManifoldStats& stats);
bool any_seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                    uint32_t light, const ChainSolution& solution, ManifoldStats& stats);

// A random search from a point of the camera's lens for chains that are seen in a pixel: it begins
// there, too. `pixel`: its corner.
std::optional<ChainSolution> search_pixel(const Techniques& techniques, const RayStart& x,
                                          const Vec2& pixel, const ChainEnd& end, Pcg& pcg,
                                          ManifoldStats& stats);

// 0 where a chain seed of the sheets or of camera chains, or an MNEE seed, comes to the path's chain. Else the
// trials, at most so many, until a random search came to it from the caster where it begins, or the
// pixel; 1 where there are no searches. Not of walks, which may come to any.
uint32_t trials_if_missed(const Techniques& techniques, const LightSheets& sheets,
                          const CausticPath& path, const LightEnd& end, uint32_t most, Pcg& pcg,
                          ManifoldStats& stats);

}  // namespace spc
