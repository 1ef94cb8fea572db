// SPDX-License-Identifier: GPL-3.0-or-later
// Walks: Newton's method on a caster's surface [Jakob12, Zeltner20 Sec. 4], from a seed to a point
// where light passes from the light point to the receiver.
#pragma once

#include "manifold/seed.h"

namespace spc {

// A solution of a walk: the point on the caster, and the interaction there.
struct ChainRoot {
    SurfaceHit hit;
    DifferentialGeometry geometry;
    Interaction interaction;
    float eta;         // behind over in front, as seen from x
    float resolution;  // how far the point may lie from the true solution, m
};

// One walk from a seed. Empty if it diverged, left the caster, met total internal reflection, or
// ended on the wrong side of the surface or on a fold, where solutions cannot be told apart.
// Occlusion is ignored.
std::optional<ChainRoot> walk_from(const Scene& scene, const ManifoldSettings& settings,
                                   const ChainQuery& query, const Seed& seed, ManifoldStats& stats);
// One walk from a random seed.
std::optional<ChainRoot> random_walk(const Scene& scene, const ManifoldSettings& settings,
                                     const ChainQuery& query, Pcg& pcg, ManifoldStats& stats);

// Whether two walks of one query found the same solution.
bool same_root(const ManifoldSettings& settings, const ChainRoot& a, const ChainRoot& b);

}  // namespace spc
