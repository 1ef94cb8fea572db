// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method on a caster's surface [Jakob12, Zeltner20 Sec. 4]: from a seed to a point where
// light passes from the light point to the receiver.
#pragma once

#include "core/random.h"
#include "manifold/caster.h"

namespace spc {

struct ChainQuery {
    Vec3 x;
    ChainEnd end;
    const Caster* caster;
};

// A solution: the point on the caster and how light turns there.
struct ChainRoot {
    SurfaceHit hit;
    CasterPatch patch;
    Interaction interaction;
    float eta;         // behind over in front, as seen from x
    float resolution;  // m: how far the tolerance of the constraint lets the point move
};

// One walk: empty when it diverged, left the caster, met total internal reflection or ended on the
// wrong side of the surface. The seed's own geometry says whether light is to be reflected or
// refracted there. With two stages and a mapped normal, `pcg` gives the first stage's normal. A
// walk does not ask whether something stands in the way.
std::optional<ChainRoot> walk_from(const Scene& scene, const ManifoldSettings& settings,
                                   const ChainQuery& query, const SurfaceHit& seed, Pcg& pcg,
                                   ManifoldStats& stats);
// From a random seed: half of them uniform over the caster's specular area, half over what x sees
// of it.
std::optional<ChainRoot> random_walk(const Scene& scene, const ManifoldSettings& settings,
                                     const ChainQuery& query, Pcg& pcg, ManifoldStats& stats);

// Whether two walks of one query found the same solution.
bool same_root(const ManifoldSettings& settings, const ChainRoot& a, const ChainRoot& b);

}  // namespace spc
