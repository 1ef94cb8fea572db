// SPDX-License-Identifier: GPL-3.0-or-later
// Light that camera chains bring (manifold/camera_chains.h): learning their seeds, and estimates.
#pragma once

#include "core/budget.h"
#include "film/film.h"
#include "integrator/path.h"

namespace spc {

// Follows `walks` random camera rays through casters, or as many as the budget allows, and keeps
// the chain seeds that they give. The result does not depend on `threads`. Null if there are no
// seeds, or if the budget was cancelled.
std::unique_ptr<const CameraChains> learn_camera_chains(const RenderScene& world,
                                                        IntegratorSettings settings, uint32_t walks,
                                                        uint32_t seed, uint32_t threads,
                                                        const Budget& budget, PathStats& stats);

// One estimate of the chains that chain seeds find. Appends the splats that lie in the camera's
// crop or at most `margin` pixels beside it.
void estimate_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                            float margin, uint32_t seed, const SplatIndex& index,
                            std::vector<Splat>& splats, PathStats& stats);

// Number of searches for one sample of the picture.
uint64_t camera_chain_searches(const Camera& camera, const CameraChains& camera_chains,
                               float margin);
// One search for a chain that no chain seed finds. Appends its splats.
void search_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                          float margin, uint32_t seed, const SplatIndex& index,
                          std::vector<Splat>& splats, PathStats& stats);

}  // namespace spc
