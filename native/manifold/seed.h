// SPDX-License-Identifier: GPL-3.0-or-later
// Where walks begin, and what each of them looks for.
//
// Where they begin decides how likely each solution is to be found, hence noise and time, but not
// what an unbiased estimate expects, as long as every solution can be reached.
#pragma once

#include "core/random.h"
#include "manifold/caster.h"

namespace spc {

// Light between `x` and `end` by way of one caster.
struct ChainQuery {
    Vec3 x;
    ChainEnd end;
    const Caster* caster;
};

// The normal that a walk aims for: the surface's own, or, in the first of two stages, the smooth
// one leaning by a fixed slope.
struct NormalTarget {
    bool smooth_base = false;
    Vec3 offset{0.0f, 0.0f, 1.0f};  // unit, in Frame::around(smooth normal)
};
DifferentialGeometry aimed_geometry(const Scene& scene, const SurfaceHit& hit,
                                    const NormalTarget& target);

struct Seed {
    SurfaceHit hit;
    Interaction interaction;
    float eta;           // behind over in front, as seen from x
    NormalTarget first;  // of the first stage; the surface's own where there is none
};

// The seed at one point: whether x and the light lie on one side of it says what is looked for.
// Empty where the material has no such interaction.
std::optional<Seed> seed_at(const Scene& scene, const ManifoldSettings& settings,
                            const ChainQuery& query, const SurfaceHit& hit,
                            const NormalTarget& first = {});

// The best of a few random points: the one where the constraint is smallest. Half of the walks draw
// them uniform over the caster's specular area, half from what x sees of it.
std::optional<Seed> sample_seed(const Scene& scene, const ManifoldSettings& settings,
                                const ChainQuery& query, Pcg& pcg, ManifoldStats& stats);

}  // namespace spc
