// SPDX-License-Identifier: GPL-3.0-or-later
// Chains from the camera through casters to the lights that it sees in them: manifold/camera_chains.h.
#pragma once

#include "core/budget.h"
#include "film/film.h"
#include "integrator/path.h"

namespace spc {

// Looks for them by so many random walks, or as many as the budget allows. Does not depend on `threads`.
// Null where there are none, or the budget was cancelled.
std::unique_ptr<const CameraChains> learn_camera_chains(const RenderScene& world,
                                                        IntegratorSettings settings, uint32_t walks,
                                                        uint32_t seed, uint32_t threads,
                                                        const Budget& budget, PathStats& stats);

// One estimate of those that chain seeds come to; appends what it adds within the camera's crop and `margin`
// pixels around it.
void estimate_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                            float margin, uint32_t seed, uint64_t index, std::vector<Splat>& splats,
                            PathStats& stats);

// Searches for those that no chain seed comes to, for one sample of the picture, and one of them, which
// appends what it adds.
uint64_t camera_chain_searches(const Camera& camera, const CameraChains& camera_chains,
                               float margin);
void search_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                          float margin, uint32_t seed, uint64_t index, std::vector<Splat>& splats,
                          PathStats& stats);

}  // namespace spc
