// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate of the light that reaches a receiver through specular interactions.
//
//   L(x, wo) = sum over chains of  int f(x) cos T L(y) |dw/dA_y| dA_y
//
// A point y is drawn by power. The chains to it come from random walks on one caster, drawn by its
// bound, and random shots for those of several interactions, from a light sheet, or from MNEE seeds.
#pragma once

#include "bsdf/closure.h"
#include "manifold/ownership.h"
#include "manifold/sheet_pool.h"
#include "manifold/walk.h"

namespace spc {

// What a path knows of the vertex where a chain may begin. Where that is the camera, `ng` is its
// viewing axis, `importance` and `camera_subpath` say nothing, and there are no closures.
struct Receiver {
    Vec3 p;
    float p_error;  // m, see RayStart
    Vec3 ng;        // on the side of wo
    Vec3 wo;
    const ClosureList* closures;
    uint32_t transparent_left;  // surfaces that the rest of the path may be looked through
    const Media* media;         // on the side of wo
    SurfaceHit hit;
    CameraSubpath camera_subpath;
    BounceCounts before;  // see CausticPath
    // What irradiance adds to the pixel's radiance, about; largest channel.
    float importance;
    const CausticPath* rough_before;        // see RoughVisit; null: there is none
    const FoldDirections* folds = nullptr;  // see CausticPath
    const Camera* camera = nullptr;
};

// The path of light that arrives from the direction wi, without its chain and its light: `at_x`
// evaluates the receiver there.
CausticPath caustic_path(const Scene& scene, const Receiver& receiver, const ClosureEval& at_x,
                         const Vec3& wi);

// Radiance from a receiver towards its wo. What each estimate has, where sheets lead it, and what is
// left to chance.
struct ManifoldRadiance {
    Spectrum seeded{0.0f}, drawn{0.0f};
    uint64_t seed_work = 0;  // Newton iterations and rays
};
// One estimate; without `draws`, which only sheets do without, of what chain seeds come to alone.
ManifoldRadiance manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                                   const LightSheets& sheets, bool draws, const Sampler& sampler,
                                   ManifoldStats& stats);

// The same of chains with rough vertices alone, each at a facet that is drawn anew.
Spectrum rough_chain_radiance(const Techniques& techniques, const Receiver& receiver,
                              const Sampler& sampler, ManifoldStats& stats);

// What the camera sees of a light in casters.
struct CameraChain {
    Vec3 p;          // of the chain's first vertex
    Spectrum value;  // radiance times pixels^2
};
// One estimate of those that chain seeds come to: appends them.
void find_camera_chains(const Techniques& techniques, const Receiver& camera, const Sampler& sampler,
                        std::vector<CameraChain>& found, ManifoldStats& stats);
// One search in a pixel, by its corner, for one that no chain seed comes to.
std::optional<CameraChain> search_camera_chain(const Techniques& techniques, const Receiver& camera,
                                               const Vec2& pixel, const Sampler& sampler,
                                               ManifoldStats& stats);

// One that a random ray came near, as techniques.camera_chains would share it if it had chain seeds for it.
struct RandomCameraChain {
    LightPoint y;
    ChainSolution solution;
};
// Follows a ray from there on the film through casters, and appends what is within `radius` pixels of
// it, by how the ray leaves each of them.
void add_random_camera_chains(const Techniques& techniques, const Receiver& camera,
                              const Vec2& film, float radius, const Sampler& sampler,
                              std::vector<RandomCameraChain>& found, ManifoldStats& stats);
// Whether the chain seed comes to it.
bool seed_finds(const Techniques& techniques, const Receiver& camera, const ChainSeed& chain_seed,
                const RandomCameraChain& camera_chain, ManifoldStats& stats);

}  // namespace spc
