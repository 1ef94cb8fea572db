// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance along rays of small scenes, as the integrator estimates it.
#pragma once

#include "support/numerics.h"
#include "support/scenes.h"
#include "support/truths.h"

namespace spc::test {

inline ManifoldSettings unbiased_manifold(Constraint constraint = Constraint::half_vector) {
    ManifoldSettings settings;
    settings.enabled = true;
    settings.constraint = constraint;
    return settings;
}

// Enough bounces for energy to be conserved.
inline IntegratorSettings unlimited(const ManifoldSettings& manifold = {}) {
    IntegratorSettings settings;
    settings.limits = {1000, 1000, 1000, 1000, 1000};
    settings.manifold = manifold;
    return settings;
}

// Independent samples (each of its own pixel), so that the standard error is one. `ray(i)` gives
// the i-th camera ray.
struct RadianceEstimate {
    MeanEstimate radiance, caustics, alpha;
    double least = kInfinity, most = -kInfinity;  // of the radiance
};
template <class MakeRay>
RadianceEstimate estimate(const RenderScene& world, const IntegratorSettings& settings,
                          uint32_t samples, MakeRay ray, uint32_t seed = 1) {
    RadianceEstimate result;
    PathStats stats;
    for (uint32_t i = 0; i < samples; ++i) {
        const PathSample sample = path_radiance(world, settings, {1, 1, 1}, ray(i), Vec2(0.5f),
                                                Sampler(seed, i, 0), stats);
        EXPECT_TRUE(is_finite(sample.radiance));
        const double value =
            (double(sample.radiance.x) + double(sample.radiance.y) + double(sample.radiance.z)) /
            3.0;
        result.radiance.add(value);
        result.caustics.add(double(sample.caustics.y));
        result.alpha.add(double(sample.alpha));
        result.least = std::min(result.least, value);
        result.most = std::max(result.most, value);
    }
    return result;
}
inline RadianceEstimate estimate(const RenderScene& world, const IntegratorSettings& settings,
                                 uint32_t samples, const Ray& ray, uint32_t seed = 1) {
    return estimate(
        world, settings, samples, [&](uint32_t) { return ray; }, seed);
}

// As path tracing finds it; `rays` as of estimate().
template <class Rays>
MeanEstimate path_traced(const std::string& name, const RenderScene& world,
                         const IntegratorSettings& settings, uint32_t samples, const Rays& rays) {
    return truth(name, samples, [&](uint32_t count) {
        return Estimates{estimate(world, settings, count, rays).radiance};
    })[0];
}

inline Ray ray_to(const Vec3& from, const Vec3& to) { return {from, normalize(to - from)}; }

// ---- graphs

inline Graph emission(float strength) {
    return single_shader("emission",
                         {{1, "Color", {1, 1, 1, 1}}, {1, "Strength", {strength, 0, 0, 0}}});
}
inline Graph transparent(float color) {
    return single_shader("bsdf_transparent", {{1, "Color", {color, color, color, 1}}});
}

// With a medium behind its front faces that absorbs `sigma` (1/m).
inline Graph absorbing(Graph graph, const Spectrum& sigma) {
    const float density = max_component(sigma);
    const Spectrum color = Spectrum(1.0f) - sigma * (1.0f / density);
    const auto index = static_cast<uint32_t>(graph.nodes.size());
    graph.name += " in which light is absorbed";
    graph.nodes.push_back({"Medium", "volume_absorption", kNone});
    graph.inputs.push_back({index, "Color", {color.x, color.y, color.z, 1}});
    graph.inputs.push_back({index, "Density", {density, 0, 0, 0}});
    graph.links.push_back({index, "Volume", 0, "Volume"});
    return graph;
}

// Two shaders under a mix (by `fac`) or, with fac < 0, an addition.
inline Graph combined(const Graph& a, const Graph& b, float fac) {
    Graph graph;
    graph.name = a.name + " and " + b.name;
    const bool adds = fac < 0.0f;
    graph.nodes = {{"Output", "output", kNone},
                   {"Both", adds ? "add_shader" : "mix_shader", kNone},
                   a.nodes[1],
                   b.nodes[1]};
    if (!adds) graph.inputs.push_back({1, "Fac", {fac, 0, 0, 0}});
    for (GraphInput input : a.inputs) {
        input.node = 2;
        graph.inputs.push_back(input);
    }
    for (GraphInput input : b.inputs) {
        input.node = 3;
        graph.inputs.push_back(input);
    }
    graph.links = {{1, "Shader", 0, "Surface"},
                   {2, a.links[0].from_socket, 1, "Shader"},
                   {3, b.links[0].from_socket, 1, "Shader_001"}};
    return graph;
}

inline void set_world(SceneMaker& maker, float radiance, uint32_t visibility = kVisibleAll) {
    const uint32_t sky = maker.builder.add_material(background(radiance, radiance, radiance));
    maker.builder.set_environment({sky, visibility, true});
}

// From an image: RGB, bottom row first.
inline void set_world(SceneMaker& maker, const std::vector<float>& texels, uint32_t width,
                      uint32_t height, uint32_t visibility = kVisibleAll) {
    const uint32_t image = maker.builder.add_image(
        image_from_floats("sky", texels, width, height, 3, ColorSpace::linear, AlphaMode::none));
    Graph graph = background(1, 1, 1);
    graph.nodes.push_back({"Sky", "environment_texture", image});
    graph.links.push_back({2, "Color", 1, "Color"});
    maker.builder.set_environment({maker.builder.add_material(graph), visibility, true});
}

// Of a square's half side and from z = 0 down to -height; outside is front.
inline Mesh block(float half, float height) {
    Mesh mesh;
    mesh.name = "block";
    for (const float z : {-height, 0.0f})
        for (const Vec2& p :
             {Vec2(-half, -half), Vec2(half, -half), Vec2(half, half), Vec2(-half, half)})
            mesh.positions.push_back({p.x, p.y, z});
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t next = (i + 1) % 4;
        mesh.triangles.push_back({i, next, next + 4});
        mesh.triangles.push_back({i, next + 4, i + 4});
    }
    return mesh;
}

inline Mesh flat(Mesh mesh) {
    mesh.normals.clear();
    return mesh;
}

}  // namespace spc::test
