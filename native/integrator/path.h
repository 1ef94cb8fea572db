// SPDX-License-Identifier: GPL-3.0-or-later
// The radiance of one camera path: path tracing with next event estimation, and manifold estimates
// at receivers.
#pragma once

#include "film/passes.h"
#include "glints/glint.h"
#include "integrator/pass_sources.h"
#include "manifold/estimator.h"

namespace spc {

// The scene and all that is built from it before rendering. Immutable from then on.
struct RenderScene {
    std::unique_ptr<Scene> scene;
    LightSet lights;
    CasterSet casters, rough_chain_casters;
    GlintSet glints;
};
// `before`: what was built for the snapshot before, or null; it is shared where it would be the
// same. `threads` 0 = all.
RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads = 0,
                    const RenderScene* before = nullptr);

struct IntegratorSettings {
    BounceLimits limits;
    bool transparent_film = false;
    bool transparent_glass = false;        // the film is seen through clear glass, too,
    float transparent_glass_alpha = 0.1f;  // of at most this roughness
    ManifoldSettings manifold;
    LightTracing light_tracing;
    const CameraChains* camera_chains = nullptr;  // null: path tracing alone finds them
    // The casters on which the manifold looks for chains; null: all of the scene.
    const CasterSet* searched = nullptr;
    GlintSettings glints;
    bool tell_lobes =
        false;  // light paths and camera chains tell by which lobe they come to the camera
    const PassSources* pass_sources = nullptr;  // null: no pass asks
    // Passes of the first surface are of the first that is at least as opaque.
    float pass_alpha_threshold = 0.5f;

    uint32_t group_of_instance(uint32_t instance) const {
        return pass_sources != nullptr ? pass_sources->of_instance[instance] : kNoGroup;
    }
    uint32_t group_of_light(uint32_t light) const {
        return pass_sources != nullptr ? pass_sources->of_light[light] : kNoGroup;
    }

    const CasterSet& casters_of(const RenderScene& world) const {
        return searched != nullptr ? *searched : world.casters;
    }
};

inline Techniques techniques_of(const RenderScene& world, const IntegratorSettings& settings) {
    return {*world.scene,
            world.lights,
            settings.casters_of(world),
            world.rough_chain_casters,
            settings.manifold,
            settings.light_tracing,
            settings.camera_chains,
            settings.limits};
}

// Receivers are counted by how often the path has scattered before: 0, 1, or 2 and more times.
inline constexpr size_t kReceiverDepths = 3;
inline size_t receiver_depth(uint32_t bounces) {
    return std::min<size_t>(bounces, kReceiverDepths - 1);
}

// Probability of a manifold estimate, by receiver depth: first of chains of deltas, then of chains
// with rough vertices. With light sheets it is that of the random search; chain seeds have
// probabilities of their own. 0 switches both off.
inline constexpr size_t kEstimates = 2 * kReceiverDepths;
using Activation = std::array<float, kEstimates>;
inline constexpr Activation kAlways{1, 1, 1, 1, 1, 1};

// How much work a sample spends on glints.
struct GlintSampling {
    uint32_t estimates = 1;  // number of estimates of the light that glints throw to the pixel
    float faint = 0.0f;      // radiance below which an estimate may be lost in noise
};

// What is the same for all samples of a tile in one round.
struct RoundState {
    Activation activation = kAlways;
    LightSheets sheets{};  // empty unless ManifoldSettings::finder asks for them
    GlintSampling glints{};
};

// What the random part of manifold estimates of one kind brought and cost, scaled as if every
// receiver had made it.
struct ActivationEvidence {
    double second_moment =
        0.0;            // sum of squares of what they add to their pixels, mean of the channels
    double cost = 0.0;  // Newton iterations plus rays
    void add(const ActivationEvidence& other) {
        second_moment += other.second_moment;
        cost += other.cost;
    }
};

struct PathStats {
    uint64_t rays = 0;
    ManifoldStats manifold;
    GlintStats glints;
    std::array<ActivationEvidence, kEstimates> evidence;
    // Newton iterations plus rays of chain seeds and fold directions; not part of the evidence.
    uint64_t seed_work = 0;
};

// What one path contributes to the film.
struct PathSample {
    Spectrum radiance{0.0f};
    Spectrum caustics{0.0f};  // the share of it that the manifold and fold directions found
    float alpha = 1.0f;
    // The first surface that the path does not pass straight through.
    bool hit = false;
    SurfaceHit surface{};
    Vec3 position{0.0f};
    Vec3 normal{0.0f};
};

// `lens` is the argument of Camera::ray() that made the camera's ray. `pixel` is the pixel that the
// ray stands for; without one, glints are not averaged. To `values`, if there are any, the path
// adds what passes ask of light, colours and the denoiser's features.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const RoundState& round, const Ray& camera_ray, const Vec2& lens,
                         const Sampler& sampler, PathStats& stats,
                         const PixelKernel* pixel = nullptr, PassValues* values = nullptr);

}  // namespace spc
