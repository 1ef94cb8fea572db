// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate of the light that reaches a receiver through one specular interaction.
//
//   L(x, wo) = sum over chains of  int f(x) cos T L(y) |dw/dA_y| dA_y
//
// A point y is drawn by power, one caster by its bound, and the chains between them by random
// walks.
#pragma once

#include "bsdf/closure.h"
#include "manifold/ownership.h"
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
    SurfaceHit hit;
    CameraApproach approach;
};

// The path of light by way of one solution, without its light: `at_x` evaluates the receiver towards
// it, `probability` is that of its lobe.
CausticPath caustic_path(const Scene& scene, const Receiver& receiver, const ClosureEval& at_x,
                         const ChainRoot& root, float probability);

// One estimate of the radiance from `receiver` towards its wo. [Zeltner20 Alg. 2] or, biased, [Alg.
// 3].
Spectrum manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                           const Sampler& sampler, ManifoldStats& stats);

}  // namespace spc
