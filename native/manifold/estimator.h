// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate of the light that reaches a receiver through one specular interaction,
// and its share of each such path beside path tracing.
//
//   L(x, wo) = sum over chains of  int f(x) cos T L(y) |dw/dA_y| dA_y
//
// A point y is drawn by power, one caster by its bound, and the chains between them by random
// walks.
#pragma once

#include "bsdf/closure.h"
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
};

// A chain as both estimators describe it. Everything that decides who owns it is a property of the
// path alone.
struct ChainClass {
    bool receiver;          // x has the role, the closure and the bounces left
    uint32_t instance;      // where the one interaction lies
    bool on_caster_normal;  // by a delta closure of the material's specular interface
    Interaction interaction;
    bool through_caster;  // passed straight through a transparent part of any caster on the way to it
};

// The one predicate: whether the manifold can find chains of this class. Outside it path tracing
// owns all; inside it the balance heuristic shares each path by the two densities below.
bool manifold_owns(const ManifoldSettings& settings, const CasterSet& casters,
                   const ChainClass& chain);

// Densities of one chain, both by area at y (distant light: by solid angle at the light).
struct ChainDensities {
    double manifold;  // p_L(y) times the chance of the caster
    double path_tracing;  // p_bsdf(w) |dw/dA_y| times the chance of the caster's lobe; 0 for delta lights
};
inline float manifold_share(const ChainDensities& p) {
    return static_cast<float>(p.manifold / (p.manifold + p.path_tracing));
}

// A chain as path tracing runs along it: a smooth scattering at x, then a caster's lobe.
struct TracedChain {
    Vec3 x;
    ReceiverSides sides{};   // of x, by the side of the path that arrived
    float pdf_omega = 0.0f;  // of the scattering at x
    SurfaceHit vertex{};     // on the caster
    Interaction interaction = Interaction::reflection;
    float lobe_probability = 0.0f;  // of all closures that scatter there, as delta_lobe() states it
};

// Path tracing's share of a chain that it found, to the point `end` of a light that it could also
// have drawn with density `light_pdf` (as LightPoint::pdf). `cos_y` is the cosine at y, 1 for
// distant lights.
float path_tracing_share(const Scene& scene, const CasterSet& casters, const TracedChain& chain,
                         const ChainEnd& end, float cos_y, float light_pdf);

// One estimate of the radiance from `receiver` towards its wo. [Zeltner20 Alg. 2] or, biased, [Alg.
// 3].
Spectrum manifold_radiance(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                           const ManifoldSettings& settings, const Receiver& receiver,
                           const Sampler& sampler, ManifoldStats& stats);

}  // namespace spc
