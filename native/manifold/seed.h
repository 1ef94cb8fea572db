// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds: where walks start, and what each of them looks for.
//
// Seeds decide how probable it is to find each solution, hence noise and time, but not the
// expectation of an unbiased estimate, as long as every solution can be found.
#pragma once

#include "core/random.h"
#include "manifold/caster.h"

namespace spc {

// Asks for light between `x` and `end` by way of one caster.
struct ChainQuery {
    Vec3 x;
    ChainEnd end;
    const Caster* caster;
};

// The normal that a walk uses: the surface's own or, in the first of two stages, the smooth one
// leaning by a fixed slope.
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
    NormalTarget first;  // of the first stage; the surface's own normal if there is one stage
};

// The seed at one point. It looks for a reflection if x and the light lie on one side of the
// surface, else for a refraction. Empty if the material has no such interaction.
std::optional<Seed> seed_at(const Scene& scene, const ManifoldSettings& settings,
                            const ChainQuery& query, const SurfaceHit& hit,
                            const NormalTarget& first = {});

// Draws a few random points and takes the one where the constraint is smallest. Half of the seeds
// draw them uniformly over the caster's specular area, half from what x sees of the caster.
std::optional<Seed> sample_seed(const Scene& scene, const ManifoldSettings& settings,
                                const ChainQuery& query, Pcg& pcg, ManifoldStats& stats);

}  // namespace spc
