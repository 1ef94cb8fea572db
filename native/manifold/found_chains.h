// SPDX-License-Identifier: GPL-3.0-or-later
// The chains between two points that seeds find, and trials of random searches for the others.
#pragma once

#include "manifold/ownership.h"
#include "manifold/sheet_pool.h"

namespace spc {

inline ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

struct FoundChain {
    ChainSolution solution;
    float probability;     // that the chain is found
    float crossed = 0.0f;  // largest probability of a seed that has looked across a fold from here
};
using FoundChains = std::vector<FoundChain>;

// The entry of the same chain, or null if it is not among those found.
FoundChain* find_chain(const ManifoldSettings& settings, FoundChains& found,
                       const ChainSolution& solution);

// Adds the chains between x and y that seeds of the sheet find. `probability_per_density`, `u`: see
// LightSheet::find_seeds().
void shoot_seeds(const Scene& scene, const ManifoldSettings& settings, const LightSheet& sheet,
                 const RayStart& x, const LightPoint& y, float probability_per_density, float u,
                 FoundChains& found, ManifoldStats& stats);
// The same by the seeds of camera chains.
void shoot_seeds(const Techniques& techniques, const RayStart& x, const LightPoint& y,
                 FoundChains& found, ManifoldStats& stats);

// The chain between x and its end that manifold next event estimation finds [Hanika15]. Refractions
// start from the straight line; reflections from the middle of the caster, since nothing is known
// of its shape.
std::optional<ChainSolution> shoot_from_mnee_seed(const Techniques& techniques, const RayStart& x,
                                                  const ChainEnd& end, Interaction first,
                                                  uint32_t caster, ManifoldStats& stats);

inline bool is_cancelled(const ManifoldSettings& settings) {
    return settings.cancelled != nullptr && settings.cancelled->load(std::memory_order_relaxed);
}

// Counts trials until the solution is found again, at most `most`. The count has a geometric
// distribution of mean 1 / p_k.
template <class Trial>
uint32_t count_trials(const ManifoldSettings& settings, uint32_t most, const Trial& comes_again) {
    uint32_t trials = 1;
    while (trials < most && !is_cancelled(settings) && !comes_again()) ++trials;
    return trials;
}

// Whether the chain seed, or any of those of the light, finds the chain.
bool seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                const ChainSeed& chain_seed, const ChainSolution& solution, ManifoldStats& stats);
bool any_seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                    uint32_t light, const ChainSolution& solution, ManifoldStats& stats);

// A random search from a point x of the camera's lens for a chain that is seen in a pixel. The
// search starts in that pixel. `pixel`: its lower left corner.
std::optional<ChainSolution> search_pixel(const Techniques& techniques, const RayStart& x,
                                          const Vec2& pixel, const ChainEnd& end, Pcg& pcg,
                                          ManifoldStats& stats);

// 0 if a seed (of the sheets, of camera chains, or MNEE's) finds the path's chain. Else the number
// of trials, at most `most`, until a random search from the chain's first caster, or its pixel,
// finds it; 1 if there are no searches. Not meaningful for walks, which may find any chain.
uint32_t trials_if_missed(const Techniques& techniques, const LightSheets& sheets,
                          const CausticPath& path, const LightEnd& end, uint32_t most, Pcg& pcg,
                          ManifoldStats& stats);

}  // namespace spc
