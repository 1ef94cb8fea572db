// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate of the light that reaches a receiver through specular interactions.
//
//   L(x, wo) = sum over chains of  int f(x) cos T L(y) |dw/dA_y| dA_y
//
// A light point y is drawn by power. The chains to it are found by walks on one caster, which is
// drawn by its bound, and random shots for several interactions; or by the seeds of a light sheet;
// or by MNEE seeds.
#pragma once

#include "bsdf/closure.h"
#include "manifold/ownership.h"
#include "manifold/sheet_pool.h"
#include "manifold/walk.h"

namespace spc {

// What one chain brings to a receiver from wi, for whoever tells lobes apart. `drawn` as in
// ManifoldRadiance.
struct ReceivedLight {
    Vec3 wi;
    Spectrum radiance;
    uint32_t light;
    bool drawn;
};

// The vertex of a path where a chain may begin. If that is the camera, `ng` is its viewing axis,
// `importance` and `camera_subpath` are unused, and there are no closures.
struct Receiver {
    Vec3 p;
    float p_error;  // m, see RayStart
    Vec3 ng;        // on the side of wo
    Vec3 wo;
    const ClosureList* closures;
    uint32_t transparent_left;  // transparent surfaces that the rest of the path may pass through
    const Media* media;         // media on the side of wo
    SurfaceHit hit;
    CameraSubpath camera_subpath;
    BounceCounts before;  // see CausticPath
    // About the radiance that unit irradiance here adds to the pixel, largest channel.
    float importance;
    const CausticPath* rough_before;        // RoughVisit::before
    const FoldDirections* folds = nullptr;  // see CausticPath
    const Camera* camera = nullptr;
    std::vector<ReceivedLight>* received = nullptr;  // takes all that is found, if there is one
};

// The path whose light arrives at the receiver from wi, still without its chain. `at_x`: the
// receiver's closures evaluated for wi.
CausticPath caustic_path(const Scene& scene, const Receiver& receiver, const ClosureEval& at_x,
                         const Vec3& wi);

// Radiance from a receiver towards its wo, in two parts: of chains that sheet seeds find, and of
// those that the random search finds.
struct ManifoldRadiance {
    Spectrum seeded{0.0f}, drawn{0.0f};
    uint64_t seed_work = 0;  // Newton iterations and rays
};
// One estimate. Without `draws` the random search is left out; only sheets allow that.
ManifoldRadiance manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                                   const LightSheets& sheets, bool draws, const Sampler& sampler,
                                   ManifoldStats& stats);

// One estimate of rough chains alone. Each draws the facets of its vertices anew.
Spectrum rough_chain_radiance(const Techniques& techniques, const Receiver& receiver,
                              const Sampler& sampler, ManifoldStats& stats);

// A camera chain as the film sees it.
struct CameraChain {
    Vec3 p;             // position of the chain's first vertex
    Spectrum value;     // radiance times pixels^2 of the film
    Interaction first;  // at p
    uint32_t count;     // of the chain's vertices
    uint32_t light;     // at its end
};
// One estimate: appends the camera chains to one light point that chain seeds find.
void find_camera_chains(const Techniques& techniques, const Receiver& camera, const Sampler& sampler,
                        std::vector<CameraChain>& found, ManifoldStats& stats);
// One random search in a pixel, given by its lower left corner, for a chain that no chain seed
// finds.
std::optional<CameraChain> search_camera_chain(const Techniques& techniques, const Receiver& camera,
                                               const Vec2& pixel, const Sampler& sampler,
                                               ManifoldStats& stats);

// A camera chain near which a random ray came.
struct RandomCameraChain {
    LightPoint y;
    ChainSolution solution;
};
// Follows a camera ray through the casters and appends the camera chains within `radius` pixels of
// it that carry light by the weights of techniques.camera_chains. How the ray leaves each caster
// tells whether a light is near.
void add_random_camera_chains(const Techniques& techniques, const Receiver& camera,
                              const Vec2& film, float radius, const Sampler& sampler,
                              std::vector<RandomCameraChain>& found, ManifoldStats& stats);
// Whether the chain seed finds this camera chain.
bool seed_finds(const Techniques& techniques, const Receiver& camera, const ChainSeed& chain_seed,
                const RandomCameraChain& camera_chain, ManifoldStats& stats);

}  // namespace spc
