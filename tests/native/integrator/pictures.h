// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures of a floor that casters throw light at, by path tracing, manifold and light paths.
#pragma once

#include "integrator/camera_chains.h"
#include "integrator/light_path.h"
#include "support/casters.h"
#include "support/power.h"
#include "support/radiance.h"
#include "support/truths.h"

#include <gtest/gtest.h>

namespace spc::test {

inline constexpr double kFamily =
    1e-3;  // probability that right estimators differ somewhere in a test
inline constexpr uint32_t kSide = 8;  // pixels, of most pictures

// One diffuse scattering is enough: what comes after only adds noise.
inline IntegratorSettings few_bounces() {
    IntegratorSettings settings;
    settings.limits = {16, 1, 16, 16, 16};
    return settings;
}

// Of the four quarters of the picture, then of the whole.
struct Picture {
    std::array<MeanEstimate, 5> mean;
    // Of the whole, the share that is splatted (by light paths and chains from the camera), and the
    // one that the manifold finds at receivers.
    MeanEstimate splats, caustics;
};

inline double average(const Spectrum& c) { return (double(c.x) + double(c.y) + double(c.z)) / 3.0; }

// Who finds lamps that the camera sees in casters, beside rays: chains that start from what random
// walks have learned, or searches alone.
enum class CameraChainUse : uint8_t { none, learned, searched };

// Which techniques find caustics beside path tracing.
struct Method {
    const char* name;
    bool manifold, light_paths;
    ChainFinder finder = ChainFinder::walks;
    uint32_t emission_cells = 512;  // 0: there is no sheet, and all chains are missed
    Constraint constraint = Constraint::half_vector;
    bool biased = false;
    CameraChainUse camera_chains = CameraChainUse::none;
    uint32_t camera_walks = 8192;  // which learn of those
};
inline constexpr Method kPathTracing{"path tracing", false, false},
    kManifold{"manifold", true, false}, kLightPaths{"light paths", false, true},
    kAll{"manifold and light paths", true, true},
    kSheets{"light sheets and light paths", true, true, ChainFinder::sheets},
    kSheetsAlone{"light sheets", true, false, ChainFinder::sheets},
    kMissed{"walks beside no sheets", true, true, ChainFinder::sheets, 0},
    kMnee{"mnee", true, false, ChainFinder::mnee},
    kMneeAndLight{"mnee and light paths", true, true, ChainFinder::mnee};

// What a method prepares before its first sample.
class Prepared {
public:
    Prepared(const RenderScene& world, const IntegratorSettings& settings, const Method& method,
             uint32_t seed)
        : settings(settings) {
        ManifoldSettings& manifold = this->settings.manifold;
        manifold.enabled = method.manifold;
        manifold.constraint = method.constraint;
        manifold.finder = method.finder;
        manifold.biased = method.biased;
        if (method.finder == ChainFinder::sheets) {
            constexpr float kSure = 0.2f;  // leaves many chains to chance
            if (method.emission_cells > 0)
                sheets_ = build_sheets(*world.scene, world.lights, world.casters, manifold, seed,
                                       method.emission_cells, 1);
            state.sheets = {sheets_, kSure};
        }
        if (method.light_paths) learn_light_paths(world, seed);
        if (method.camera_chains != CameraChainUse::none) learn_camera_chains(world, seed, method);
    }
    Prepared(const Prepared&) = delete;
    Prepared& operator=(const Prepared&) = delete;

    IntegratorSettings settings;
    RoundState state;
    bool has_light_paths() const { return pilot_ != nullptr; }

private:
    void learn_light_paths(const RenderScene& world, uint32_t seed) {
        const Camera& camera = world.scene->camera;
        settings.light_tracing.paths = camera.crop[2] * camera.crop[3];
        LightPathStats stats;
        pilot_ = learn_emission(world, settings, state.sheets, 0.0f, kLeastPilotPaths, seed, 1,
                                Budget(), stats);
        EXPECT_TRUE(pilot_) << "no light path finds the picture";
        if (!pilot_) return;
        settings.light_tracing.guide = &pilot_->guide;
        settings.light_tracing.mean_search_trials = pilot_->mean_search_trials;
        settings.light_tracing.manifold_share = pilot_->manifold_share;
    }
    void learn_camera_chains(const RenderScene& world, uint32_t seed, const Method& method) {
        PathStats stats;
        const std::unique_ptr<const CameraChains> learned = spc::learn_camera_chains(
            world, settings, method.camera_walks, seed, 1, Budget(), stats);
        EXPECT_TRUE(learned) << "no chain from the camera to a light";
        if (!learned) return;
        camera_chains_ = *learned;
        if (method.camera_chains == CameraChainUse::searched) leave_searches_alone(*camera_chains_);
        settings.camera_chains = &*camera_chains_;
    }
    // In the place of all chain seeds one that comes to nothing, and so many searches that they
    // have their share beside rays, which find the lamps of tests easily.
    static void leave_searches_alone(CameraChains& camera_chains) {
        camera_chains.searches = 16.0;
        for (std::vector<ChainSeed>& chain_seeds : camera_chains.chain_seeds) {
            if (chain_seeds.empty()) continue;
            chain_seeds.resize(1);
            chain_seeds[0].w = chain_seeds[0].w * -1.0f;
        }
    }

    SheetPool sheets_;
    std::unique_ptr<const LightPilot> pilot_;
    std::optional<CameraChains> camera_chains_;
};

// `rounds` samples of each pixel under a box filter; all rounds independent of each other.
inline Picture render(const RenderScene& world, const IntegratorSettings& integrator,
                      const Method& method, uint32_t rounds, uint32_t seed) {
    const Prepared prepared(world, integrator, method, seed);
    const IntegratorSettings& settings = prepared.settings;
    const Camera& camera = world.scene->camera;
    const auto& [x0, y0, width, height] = camera.crop;
    const uint32_t pixels = width * height;
    Picture picture;
    PathStats stats;
    LightPathStats light_stats;
    std::vector<Splat> splats;
    for (uint32_t round = 0; round < rounds; ++round) {
        std::array<double, 5> sum{};
        double splatted = 0.0, caustics = 0.0;
        const auto add = [&](float x, float y, double value) {
            const bool right = x >= float(x0) + 0.5f * float(width),
                       upper = y >= float(y0) + 0.5f * float(height);
            sum[(upper ? 2u : 0u) + (right ? 1u : 0u)] += value / (0.25 * pixels);
            sum[4] += value / pixels;
        };
        for (uint32_t y = y0; y < y0 + height; ++y)
            for (uint32_t x = x0; x < x0 + width; ++x) {
                const Sampler sampler(seed, (round * camera.height + y) * camera.width + x, 0);
                const Vec2 u = sampler[Domain::film].two(), lens = sampler[Domain::lens].two();
                const float fx = float(x) + u.x, fy = float(y) + u.y;
                const PathSample sample = path_radiance(
                    world, settings, prepared.state, camera.ray(fx, fy, lens), lens, sampler, stats);
                add(fx, fy, average(sample.radiance));
                caustics += average(sample.caustics) / pixels;
            }
        splats.clear();
        if (prepared.has_light_paths())
            for (uint32_t i = 0; i < pixels; ++i)
                trace_light_path(world, settings, 0.0f, seed, {round, i}, splats, light_stats);
        if (const CameraChains* chains = settings.camera_chains) {
            const auto count = static_cast<uint64_t>(chains->estimates);
            for (uint64_t i = 0; i < count; ++i)
                estimate_camera_chains(world, settings, 0.0f, seed, {round, i}, splats, stats);
            const uint64_t searches = camera_chain_searches(camera, *chains, 0.0f);
            for (uint64_t i = 0; i < searches; ++i)
                search_camera_chains(world, settings, 0.0f, seed, {round, i}, splats, stats);
        }
        for (const Splat& splat : splats) {
            add(splat.film.x, splat.film.y, average(splat.value));
            splatted += average(splat.value) / pixels;
        }
        for (size_t i = 0; i < sum.size(); ++i) picture.mean[i].add(sum[i]);
        picture.splats.add(splatted);
        picture.caustics.add(caustics);
    }
    EXPECT_EQ(light_stats.nan_splats, 0u);
    return picture;
}

// As brute force finds it, `find(rounds)`.
inline Picture true_picture(const std::string& name, uint32_t rounds,
                            const std::function<Picture(uint32_t)>& find) {
    const Estimates means = truth(name, rounds, [&](uint32_t count) {
        const Picture found = find(count);
        return Estimates(found.mean.begin(), found.mean.end());
    });
    Picture picture;
    std::copy(means.begin(), means.end(), picture.mean.begin());
    return picture;
}

inline void expect_same(const Picture& a, const Picture& b, const std::string& what,
                        int comparisons) {
    for (size_t i = 0; i < a.mean.size(); ++i)
        EXPECT_TRUE(same_mean(a.mean[i], b.mean[i], sidak(kFamily, 5 * comparisons)))
            << what << ", part " << i;
}

// Looks down at the floor around the origin from the south.
inline void set_camera(SceneMaker& maker, const Vec3& from = {0.0f, -3.0f, 2.0f},
                       float half = 0.25f) {
    Camera camera;
    camera.to_world = rotation_x(std::atan2(-from.y, from.z), from);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-half, half, -half, half};
    maker.builder.set_camera(camera);
}

inline void add_floor(SceneMaker& maker, CausticsRole role = CausticsRole::receiver) {
    maker.add(square(4.0f), diffuse(0.8f), {}, role);
}

// Of lights that are seen in casters alone: nothing but caustics is left to compare.
inline constexpr uint32_t kNotDirectly = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;

inline LightDesc lamp(LightType type, float power) {
    LightDesc light;
    light.name = "lamp";
    light.type = type;
    light.to_world = translation(Vec3(0.4f, -0.2f, 1.9f));
    light.power = Spectrum(power);
    light.visibility = kNotDirectly;
    return light;
}
inline void add(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Transform& transform,
                uint32_t visibility, CausticsRole role) {
    maker.add(mesh, graph, transform, role, visibility);
}
inline void add_bulb(SceneMaker& maker, const Vec3& p = {0.8f, -0.8f, 0.7f}, float radius = 0.3f,
                     uint32_t visibility = kNotDirectly) {
    LightDesc light = lamp(LightType::point, 100.0f);
    light.visibility = visibility;
    light.to_world = translation(p);
    light.radius = radius;
    maker.builder.add_light(light);
}

// Objects that hide from some of the scattered rays would keep light paths away.
inline void add_glowing(SceneMaker& maker, const Mesh& mesh, const Vec3& p) {
    add(maker, mesh, emission(20.0f), translation(p), kVisibleAll & ~kVisibleCamera,
        CausticsRole::automatic);
}
// The camera looks through: what lamps it would see in casters is noise here.
inline void add_caster(SceneMaker& maker, const Mesh& mesh, const Graph& graph,
                       const Transform& transform) {
    add(maker, mesh, graph, transform, kVisibleAll & ~uint32_t{kVisibleCamera},
        CausticsRole::caster);
}

// Two faces, `thickness` apart, that look away from each other.
inline Mesh slab(float half, float thickness) {
    Mesh mesh = flat(square(half));
    mesh.attributes.clear();
    for (uint32_t i = 0; i < 4; ++i)
        mesh.positions.push_back(mesh.positions[i] - Vec3(0, 0, thickness));
    mesh.triangles.push_back({4, 6, 5});
    mesh.triangles.push_back({4, 7, 6});
    return mesh;
}

inline void add_ball(SceneMaker& maker, const Graph& graph) {
    add_caster(maker, sphere(24, 0.4), graph, translation(Vec3(-0.1f, 0.1f, 0.7f)));
}
inline void add_panel(SceneMaker& maker, const Graph& graph) {
    add_caster(maker, square(0.6f), graph, rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
}

}  // namespace spc::test
