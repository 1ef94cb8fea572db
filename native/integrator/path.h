// SPDX-License-Identifier: GPL-3.0-or-later
// One camera path: unidirectional path tracing with next event estimation, and the manifold at
// receivers.
#pragma once

#include "glints/glint.h"
#include "manifold/estimator.h"

namespace spc {

// Everything that is frozen before rendering.
struct RenderScene {
    std::unique_ptr<Scene> scene;
    LightSet lights;
    CasterSet casters, rough_chain_casters;
    GlintSet glints;
};
// `threads` 0 = all.
RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads = 0);

struct IntegratorSettings {
    BounceLimits limits;
    bool transparent_film = false;
    ManifoldSettings manifold;
    LightTracing light_tracing;
    const CameraChains* camera_chains = nullptr;  // null: path tracing alone finds them
    // Where the manifold looks for chains; null: on all casters of the scene.
    const CasterSet* searched = nullptr;
    GlintSettings glints;

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

// Receivers by how often the path has scattered before: 0, 1, 2 or more times.
inline constexpr size_t kReceiverDepths = 3;
inline size_t receiver_depth(uint32_t bounces) {
    return std::min<size_t>(bounces, kReceiverDepths - 1);
}

// Probabilities of manifold estimates at a receiver of each depth, of sheets' but for the chains that chain seeds
// come to: first of chains of deltas, then of chains with rough vertices. 0: there are none at all.
inline constexpr size_t kEstimates = 2 * kReceiverDepths;
using Activation = std::array<float, kEstimates>;
inline constexpr Activation kAlways{1, 1, 1, 1, 1, 1};

// How closely a sample looks at glints.
struct GlintSampling {
    uint32_t estimates = 1;  // of the light that they throw to a pixel
    // Of radiance: what is less need not be told from noise.
    float faint = 0.0f;
};

// What a sample of the picture knows.
struct RoundState {
    Activation activation = kAlways;
    LightSheets sheets{};  // where ManifoldSettings::finder asks for them
    GlintSampling glints{};
};

// What manifold estimates of one kind gave and cost by what is left to chance, as if each receiver had
// had it.
struct ActivationEvidence {
    double second_moment = 0.0;  // of what they add to their pixels, mean of the channels
    double cost = 0.0;           // Newton iterations and rays
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
    // Newton iterations, and rays, those next to folds among them; not part of the evidence.
    uint64_t seed_work = 0;
};

// What one path contributes to the film.
struct PathSample {
    Spectrum radiance{0.0f};
    Spectrum caustics{0.0f};  // the manifold's share of it, and that of directions next to folds
    float alpha = 1.0f;
    // Of the first surface that is not looked through.
    bool hit = false;
    Vec3 position{0.0f};
    Vec3 normal{0.0f};
};

// `lens`: what the camera's ray was made with; `pixel`: what it stands for, null for a ray alone,
// which finds no glints.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const RoundState& round, const Ray& camera_ray, const Vec2& lens,
                         const Sampler& sampler, PathStats& stats,
                         const PixelKernel* pixel = nullptr);

}  // namespace spc
