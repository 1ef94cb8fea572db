// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate of the light that reaches a receiver through specular interactions.
//
//   L(x, wo) = sum over chains of  int f(x) cos T L(y) |dw/dA_y| dA_y
//
// A point y is drawn by power. The chains to it come from random walks on one caster, drawn by its
// bound, from a light sheet, or from fixed starts.
#pragma once

#include "bsdf/closure.h"
#include "manifold/ownership.h"
#include "manifold/sheet_pool.h"
#include "manifold/walk.h"

namespace spc {

// What a path knows of the vertex where a chain may begin.
struct Receiver {
    Vec3 p;
    float p_error;  // m, see RayStart
    Vec3 ng;        // on the side of wo
    Vec3 wo;
    const ClosureList* closures;
    uint32_t transparent_left;  // surfaces that the rest of the path may be looked through
    const Media* media;         // on the side of wo
    SurfaceHit hit;
    CameraApproach approach;
    BounceCounts before;  // see CausticPath
    // What irradiance adds to the pixel's radiance, about; largest channel.
    float importance;
    const CausticPath* rough_before;  // see RoughVisit; null: there is none
};

// The path of light that arrives from the direction wi, without its chain and its light: `at_x`
// evaluates the receiver there.
CausticPath caustic_path(const Scene& scene, const Receiver& receiver, const ClosureEval& at_x,
                         const Vec3& wi);

// One estimate of the radiance from `receiver` towards its wo.
Spectrum manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                           const LightSheets& sheets, const Sampler& sampler, ManifoldStats& stats);

// The same of chains with rough vertices alone, each at a facet that is drawn anew.
Spectrum rough_chain_radiance(const Techniques& techniques, const Receiver& receiver,
                              const Sampler& sampler, ManifoldStats& stats);

// Whether no lead of the sheets, or no fixed start, comes to the path's chain: not of walks, which
// may come to any.
bool manifold_misses(const Techniques& techniques, const LightSheets& sheets,
                     const CausticPath& path, const LightEnd& end, ManifoldStats& stats);

}  // namespace spc
