// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes for tests, built through SceneBuilder.
#pragma once

#include "core/random.h"
#include "integrator/path.h"
#include "scene/builder.h"

#include <functional>

namespace spc::test {

inline Graph single_shader(const std::string& kind, std::vector<GraphInput> inputs,
                           std::vector<GraphOption> options = {}) {
    Graph graph;
    graph.name = kind;
    graph.nodes = {{"Output", "output", kNone}, {"Shader", kind, kNone}};
    for (GraphInput& input : inputs) input.node = 1;
    for (GraphOption& option : options) option.node = 1;
    graph.inputs = std::move(inputs);
    graph.options = std::move(options);
    const std::string socket = kind == "emission"     ? "Emission"
                               : kind == "background" ? "Background"
                                                      : "BSDF";
    graph.links = {{1, socket, 0, "Surface"}};
    return graph;
}
inline Graph diffuse(float albedo) {
    return single_shader("bsdf_diffuse", {{1, "Color", {albedo, albedo, albedo, 1}}});
}
inline Graph mirror(float roughness = 0.0f) {
    return single_shader("bsdf_glossy",
                         {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {roughness, 0, 0, 0}}});
}
inline Graph refraction(float ior, float roughness = 0.0f) {
    return single_shader("bsdf_refraction", {{1, "Color", {1, 1, 1, 1}},
                                             {1, "Roughness", {roughness, 0, 0, 0}},
                                             {1, "IOR", {ior, 0, 0, 0}}});
}
inline Graph glass(float ior) {
    return single_shader(
        "bsdf_glass",
        {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {0, 0, 0, 0}}, {1, "IOR", {ior, 0, 0, 0}}});
}
inline Graph background(float r, float g, float b) {
    return single_shader("background", {{1, "Color", {r, g, b, 1}}, {1, "Strength", {1, 0, 0, 0}}});
}

// Square of the given half side in the plane z = 0, facing +z, with UVs over [0, 1]^2.
// The active UV layer, of a pair for each corner.
inline Attribute uv_layer(const std::vector<Vec2>& uv) {
    Attribute layer;
    layer.called = {AttributeKind::uv, "UVMap"};
    for (const Vec2& at : uv) layer.values.insert(layer.values.end(), {at.x, at.y});
    return layer;
}

inline Mesh square(float half) {
    Mesh mesh;
    mesh.name = "square";
    mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.attributes = {uv_layer({{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})};
    return mesh;
}

// Grid over [0, 1]^2 mapped by `position`, with exact corner normals by `normal`.
inline Mesh grid(uint32_t n, const std::function<Vec3d(double, double)>& position,
                 const std::function<Vec3d(double, double)>& normal) {
    Mesh mesh;
    mesh.name = "grid";
    std::vector<Vec3> normals;
    for (uint32_t j = 0; j <= n; ++j)
        for (uint32_t i = 0; i <= n; ++i) {
            mesh.positions.push_back(Vec3(position(double(i) / n, double(j) / n)));
            normals.push_back(Vec3(normal(double(i) / n, double(j) / n)));
        }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        mesh.triangles.push_back({a, b, c});
        for (const uint32_t k : {a, b, c}) mesh.normals.push_back(normals[k]);
    };
    for (uint32_t j = 0; j < n; ++j)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = j * (n + 1) + i;
            add(a, a + 1, a + n + 2);
            add(a, a + n + 2, a + n + 1);
        }
    return mesh;
}

// Whole sphere, smooth, by latitude and longitude; outside is front.
inline Mesh sphere(uint32_t n, double radius) {
    const auto point = [](double u, double v) {
        const double phi = 2.0 * std::numbers::pi * u, theta = std::numbers::pi * (1.0 - v);
        return Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     std::cos(theta));
    };
    return grid(
        n, [&](double u, double v) { return point(u, v) * radius; }, point);
}

inline Transform translation(const Vec3& t) {
    Transform m;
    m.translation = t;
    return m;
}
// Rotation by `angle` around the x axis, then a translation.
inline Transform rotation_x(float angle, const Vec3& t = Vec3(0.0f)) {
    Transform m;
    const float c = std::cos(angle), s = std::sin(angle);
    m.row = {Vec3(1, 0, 0), Vec3(0, c, -s), Vec3(0, s, c)};
    m.translation = t;
    return m;
}

class SceneMaker {
public:
    explicit SceneMaker(SceneBuilder empty = {}) : builder(std::move(empty)) {
        Camera camera;
        builder.set_camera(camera);
    }
    uint32_t add(const Mesh& mesh, const Graph& graph, const Transform& transform = {},
                 CausticsRole role = CausticsRole::automatic, uint32_t visibility = kVisibleAll) {
        Instance instance;
        instance.name = mesh.name + " of " + graph.name;
        instance.mesh = builder.add_mesh(mesh);
        instance.object_to_world = transform;
        instance.materials.assign(builder.mesh(instance.mesh).slot_count,
                                  builder.add_material(graph));
        instance.role = role;
        instance.visibility = visibility;
        instance.links = links;
        instance.sets = sets;
        return builder.add_instance(instance);
    }
    // Square light of the given side at `center`, shining along -z of `transform`.
    uint32_t add_area_light(const Transform& transform, float side, float power) {
        LightDesc light;
        light.name = "area";
        light.type = LightType::area;
        light.to_world = transform;
        light.size = Vec2(side, side);
        light.power = Spectrum(power);
        return builder.add_light(light);
    }
    RenderScene finish() { return prepare(builder.freeze(1), 1); }

    SceneBuilder builder;
    LightLinks links{};  // of what add() adds from now on
    LinkSets sets{};
};

}  // namespace spc::test
