// SPDX-License-Identifier: GPL-3.0-or-later
// Casters as three of the example scenes have them, each under its lamp; blend_scenes/README.md
// gives their sizes.
#pragma once

#include "math/warp.h"
#include "support/scenes.h"

namespace spc::test {

struct CausticScene {
    RenderScene world;                   // one caster and one lamp
    std::function<Vec3(Pcg&)> receiver;  // a random point that the caustic may reach
};

// Random plane waves in space of one slope each: what a normal map shows of them, or a height map.
class Waves {
public:
    explicit Waves(double slope) : slope_(slope) {}
    void add(const Vec3d& k, double phase) { waves_.push_back({k, normalize(k) * slope_, phase}); }
    Vec3d gradient(const Vec3d& p) const {
        Vec3d sum(0.0);
        for (const Wave& wave : waves_) sum += wave.along * std::cos(dot(wave.k, p) + wave.phase);
        return sum;
    }
    double height(const Vec3d& p) const {
        double sum = 0.0;
        for (const Wave& wave : waves_)
            sum += slope_ / length(wave.k) * std::sin(dot(wave.k, p) + wave.phase);
        return sum;
    }

private:
    struct Wave {
        Vec3d k, along;
        double phase;
    };
    double slope_;
    std::vector<Wave> waves_;
};

// Tangent-space normals from the slopes along u and v at each texel's centre.
inline Image normal_image(uint32_t width, uint32_t height,
                          const std::function<Vec2(double, double)>& slope) {
    std::vector<float> texels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const Vec2 s = slope((x + 0.5) / width, (y + 0.5) / height);
            const Vec3 n = normalize(Vec3(-s.x, -s.y, 1.0f));
            for (int i = 0; i < 3; ++i) texels.push_back(0.5f + 0.5f * n[i]);
        }
    return image_from_floats("normals", texels, width, height, 3, ColorSpace::data, AlphaMode::none);
}

constexpr int kWaves = 64;

// Periodic waves over the unit square whose slopes have the spectrum of a Gaussian filter, with its
// peak at `wavelength`; `rms_slope` over both axes.
inline Waves plane_waves(double wavelength, double rms_slope, uint64_t seed) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    Pcg pcg(seed);
    Waves waves(2.0 * rms_slope / std::sqrt(double(kWaves)));
    const double width = std::sqrt(1.5) * wavelength / kTurn;
    for (int i = 0; i < kWaves;) {
        // Of a density k^3 exp(-k^2 width^2): a gamma distribution of k^2.
        const double k = std::sqrt(-std::log((1.0 - double(pcg.one())) * (1.0 - double(pcg.one())))),
                     angle = kTurn * double(pcg.one());
        const Vec3d whole(std::round(k / width * std::cos(angle) / kTurn),
                          std::round(k / width * std::sin(angle) / kTurn), 0.0);
        if (!(length(whole) > 0.0)) continue;
        waves.add(whole * kTurn, kTurn * double(pcg.one()));
        ++i;
    }
    return waves;
}

inline Image plane_normals(uint32_t size, double wavelength, double rms_slope, uint64_t seed) {
    const Waves waves = plane_waves(wavelength, rms_slope, seed);
    return normal_image(size, size, [&](double u, double v) {
        const Vec3d g = waves.gradient(Vec3d(u, v, 0.0));
        return Vec2(static_cast<float>(g.x), static_cast<float>(g.y));
    });
}

// The same as heights.
inline Image plane_heights(uint32_t width, uint32_t height, double wavelength, double rms_slope,
                           uint64_t seed) {
    const Waves waves = plane_waves(wavelength, rms_slope, seed);
    std::vector<float> texels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            texels.push_back(
                static_cast<float>(waves.height(Vec3d((x + 0.5) / width, (y + 0.5) / height, 0.0))));
    return image_from_floats("heights", texels, width, height, 1, ColorSpace::data, AlphaMode::none);
}

// Isotropic bumps on the unit sphere, for with_sphere_uvs(); `wavelength` in radians.
inline Image sphere_normals(uint32_t height, double wavelength, double rms_slope, uint64_t seed) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    Pcg pcg(seed);
    Waves waves(rms_slope * std::sqrt(6.0 / kWaves));
    for (int i = 0; i < kWaves; ++i) {
        const Vec3d direction(uniform_sphere(pcg.two()));
        const double k = kTurn / wavelength * (0.6 + 0.6 * double(pcg.one()));
        waves.add(direction * k, kTurn * double(pcg.one()));
    }
    return normal_image(2 * height, height, [&](double u, double v) {
        const double phi = kTurn * u, theta = std::numbers::pi * v;
        const Vec3d p(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                      -std::cos(theta)),
            east(-std::sin(phi), std::cos(phi), 0.0), north = cross(p, east);
        const Vec3d g = waves.gradient(p);
        return Vec2(static_cast<float>(dot(g, east)), static_cast<float>(dot(g, north)));
    });
}

// A grid() of n x n cells with the UVs of its cells, under which normal maps find their tangents.
inline Mesh with_uvs(Mesh mesh, uint32_t n) {
    std::vector<Vec2> uv;
    for (const auto& triangle : mesh.triangles)
        for (const uint32_t k : triangle) {
            const uint32_t row = k / (n + 1), column = k % (n + 1);
            uv.push_back(Vec2(float(column), float(row)) / float(n));
        }
    mesh.attributes = {uv_layer(uv)};
    return mesh;
}

// The same for a sphere(), with tangents to the east.
inline Mesh with_sphere_uvs(Mesh mesh, uint32_t n) {
    mesh = with_uvs(std::move(mesh), n);
    Attribute& layer = mesh.attributes[0];
    for (const Vec3& normal : mesh.normals) {
        const Vec3 east = cross(Vec3(0.0f, 0.0f, 1.0f), normal);
        const bool at_pole = !(length(east) > 1e-6f);
        layer.tangents.push_back(at_pole ? Vec3(1.0f, 0.0f, 0.0f) : normalize(east));
        layer.tangent_signs.push_back(1.0f);
    }
    return mesh;
}

// A single_shader() whose normal comes from image 0, repeated over the UVs.
inline Graph normal_mapped(Graph graph, const Vec2& repeat) {
    graph.name = "mapped " + graph.name;
    graph.nodes.insert(graph.nodes.end(), {{"Map", "normal_map", kNone},
                                           {"Image", "image_texture", 0},
                                           {"Mapping", "mapping", kNone},
                                           {"Coordinates", "texture_coordinate", kNone}});
    graph.inputs.push_back({4, "Scale", {repeat.x, repeat.y, 1, 0}});
    graph.links.insert(graph.links.end(), {{2, "Normal", 1, "Normal"},
                                           {3, "Color", 2, "Color"},
                                           {4, "Vector", 3, "Vector"},
                                           {5, "UV", 4, "Vector"}});
    return graph;
}

// A normal_mapped() Principled under a coat, whose normal the map turns, too, if so asked.
inline Graph coated(Graph graph, float roughness, bool mapped) {
    graph.name = "coated " + graph.name;
    graph.inputs.push_back({1, "Coat Weight", {1, 0, 0, 0}});
    graph.inputs.push_back({1, "Coat Roughness", {roughness, 0, 0, 0}});
    if (mapped) graph.links.push_back({2, "Normal", 1, "Coat Normal"});
    return graph;
}

// A normal_mapped() whose image holds heights, times `distance` (m).
inline Graph bump_mapped(Graph graph, const Vec2& repeat, float distance) {
    graph = normal_mapped(std::move(graph), repeat);
    graph.nodes[2] = {"Bump", "bump", kNone};
    graph.inputs.push_back({2, "Distance", {distance, 0, 0, 0}});
    for (GraphLink& link : graph.links)
        if (link.to_node == 2) link.to_socket = "Height";
    return graph;
}

// A single_shader() raised by image 0 times `distance` (m), where the UVs have it.
inline Graph bumped(Graph graph, float distance) {
    graph.name = "bumped " + graph.name;
    graph.nodes.insert(graph.nodes.end(), {{"Bump", "bump", kNone}, {"Image", "image_texture", 0}});
    graph.inputs.push_back({2, "Distance", {distance, 0, 0, 0}});
    graph.links.insert(graph.links.end(), {{2, "Normal", 1, "Normal"}, {3, "Color", 2, "Height"}});
    return graph;
}

inline Graph principled(float metallic, float roughness, float transmission = 0.0f) {
    return single_shader("bsdf_principled", {{1, "Base Color", {1.0f, 0.76f, 0.36f, 1}},
                                             {1, "Metallic", {metallic, 0, 0, 0}},
                                             {1, "Roughness", {roughness, 0, 0, 0}},
                                             {1, "Transmission Weight", {transmission, 0, 0, 0}}});
}

// Square lamp that shines from `p` towards `target`.
inline void add_lamp(SceneMaker& maker, const Vec3& p, const Vec3& target, float side) {
    const Frame frame = Frame::around(normalize(p - target));
    Transform m = translation(p);
    for (int i = 0; i < 3; ++i) m.row[i] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
    maker.add_area_light(m, side, 100.0f);
}

// Of the two normal maps, root mean square over both axes.
inline constexpr double kPanelSlope = 0.016, kSphereSlope = 0.085;

// The wavy golden panel of reflective_plane: one quad, many reflections for each point.
inline CausticScene reflective_plane() {
    constexpr double kWidth = 3.6, kHeight = 2.4, kTile = 2.4;
    SceneMaker maker;
    maker.builder.add_image(plane_normals(512, 36.0 / 512.0, kPanelSlope, 3));
    const Mesh panel = with_uvs(
        grid(
            1, [](double u, double v) { return Vec3d((u - 0.5) * kWidth, v * kHeight, 0.0); },
            [](double, double) { return Vec3d(0.0, 0.0, 1.0); }),
        1);
    maker.add(panel,
              normal_mapped(principled(1.0f, 0.0f),
                            Vec2(static_cast<float>(kWidth / kTile), kHeight / kTile)),
              rotation_x(120.0f / 180.0f * kPi, Vec3(0.0f, 1.0f, 0.12f)), CausticsRole::caster);
    add_lamp(maker, {-2.7f, -3.5f, 0.35f}, {0.0f, 1.0f, 4.2f}, 0.04f);
    return {maker.finish(), [](Pcg& pcg) {
                return Vec3(lerp(-2.5f, 2.5f, pcg.one()), lerp(-4.0f, 0.9f, pcg.one()), 0.0f);
            }};
}

// The hammered glass sphere of refractive_sphere: receivers on the floor inside it.
inline CausticScene refractive_sphere() {
    constexpr uint32_t kCells = 96;
    SceneMaker maker;
    maker.builder.add_image(sphere_normals(320, 0.22, kSphereSlope, 11));
    Transform turned;  // the poles lie in the floor
    turned.row = {Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0)};
    maker.add(with_sphere_uvs(sphere(kCells, 1.0), kCells),
              normal_mapped(glass(1.5f), Vec2(1.0f, 1.0f)), turned, CausticsRole::caster);
    add_lamp(maker, {1.9f, 1.6f, 3.4f}, {0.0f, 0.0f, 0.3f}, 0.1f);
    return {maker.finish(), [](Pcg& pcg) {
                const Vec2 disk = concentric_disk(pcg.two());
                return Vec3(0.95f * disk.x, 0.95f * disk.y, 0.0f);
            }};
}

// The inside of a polished ring on its table, as in ring: smooth normals on a fine mesh, no map.
inline CausticScene smooth_ring() {
    constexpr double kRadius = 0.08, kHeight = 0.036;
    SceneMaker maker;
    const auto radial = [](double u) {
        const double angle = 2.0 * std::numbers::pi * u;
        return Vec3d(std::cos(angle), std::sin(angle), 0.0);
    };
    maker.add(
        grid(
            128, [&](double u, double v) { return radial(u) * kRadius + Vec3d(0, 0, kHeight * v); },
            [&](double u, double) { return radial(u) * -1.0; }),
        mirror(), {}, CausticsRole::caster);
    add_lamp(maker, {-0.45f, -0.58f, 0.33f}, {0.0f, 0.0f, 0.0f}, 0.01f);
    return {maker.finish(), [](Pcg& pcg) {
                const Vec2 disk = concentric_disk(pcg.two());
                return Vec3(0.078f * disk.x, 0.078f * disk.y, 0.0f);
            }};
}

}  // namespace spc::test
