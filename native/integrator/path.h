// SPDX-License-Identifier: GPL-3.0-or-later
// One camera path: unidirectional path tracing with next event estimation, and the manifold at
// receivers.
#pragma once

#include "manifold/estimator.h"

namespace spc {

// Everything that is frozen before rendering.
struct RenderScene {
    std::unique_ptr<Scene> scene;
    LightSet lights;
    CasterSet casters;
};
// `threads` 0 = all.
RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads = 0);

struct IntegratorSettings {
    BounceLimits limits;
    bool transparent_film = false;
    ManifoldSettings manifold;
    LightTracing light_tracing;
};

inline Techniques techniques_of(const RenderScene& world, const IntegratorSettings& settings) {
    return {*world.scene,      world.lights,           world.casters,
            settings.manifold, settings.light_tracing, settings.limits};
}

struct PathStats {
    uint64_t rays = 0;
    ManifoldStats manifold;
};

// What one path contributes to the film.
struct PathSample {
    Spectrum radiance{0.0f};
    Spectrum caustics{0.0f};  // the manifold's share of it
    float alpha = 1.0f;
    // Of the first surface that is not looked through.
    bool hit = false;
    Vec3 position{0.0f};
    Vec3 normal{0.0f};
};

// `lens`: what the camera's ray was made with.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const Ray& camera_ray, const Vec2& lens, const Sampler& sampler,
                         PathStats& stats);

}  // namespace spc
