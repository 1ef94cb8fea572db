// SPDX-License-Identifier: GPL-3.0-or-later
// Casters over the origin of a floor, for each kind of chain that light may take from a lamp to
// there, and rows in which the manifold alone finds it.
#pragma once

#include "agreement/parts.h"

namespace spc::test {

// What makes the normals of a surface: image 0 as a normal map or as heights.
enum class Relief : uint8_t { none, normals, heights };
// Of the caster that the light meets last, and of all others.
struct Reliefs {
    Relief one = Relief::none, others = Relief::none;
};

struct ChainScene {
    std::string name;
    uint32_t interactions;
    std::function<void(SceneMaker&, Reliefs)> build;
    Vec3 lamp = {0.2f, -0.3f, 1.9f};
    bool has_relief = true;  // may have one
    float lamp_radius = 0.3f;
};

inline const char* to_string(Relief relief) {
    return relief == Relief::none ? "smooth" : relief == Relief::normals ? "mapped" : "bumped";
}

// Waves with slopes of a tenth.
inline void add_relief_image(SceneMaker& maker, Reliefs reliefs) {
    constexpr uint32_t kTexels = 128;
    constexpr double kWavelength = 0.25, kSlope = 0.1;
    constexpr uint64_t kSeed = 5;
    const bool heights = reliefs.one == Relief::heights || reliefs.others == Relief::heights;
    maker.builder.add_image(heights ? plane_heights(kTexels, kTexels, kWavelength, kSlope, kSeed)
                                    : plane_normals(kTexels, kWavelength, kSlope, kSeed));
}
// Both reliefs are named where the others have one.
inline Part casters_of(const ChainScene& scene, Reliefs reliefs) {
    std::string name = scene.name + ", " + to_string(reliefs.one);
    if (reliefs.others != Relief::none) name += std::string(" and ") + to_string(reliefs.others);
    return {name, [scene, reliefs](SceneMaker& maker) {
                add_relief_image(maker, reliefs);
                scene.build(maker, reliefs);
            }};
}
// By the manifold alone, which finds a quarter of the light at least.
inline Claim alone(const Method& method, uint32_t rounds) {
    return {method, rounds / power(2u, 1u), power(0.35, 0.25), 0.25};
}
inline Row chain_row(const ChainScene& scene, Reliefs reliefs, const std::vector<Claim>& claims) {
    return {.casters = casters_of(scene, reliefs),
            .light = bulb("", scene.lamp, scene.lamp_radius),
            .camera = camera_above(0.3f),
            .reference = {12500},
            .claims = claims};
}

inline Mesh square_with_uvs(float half) {
    return with_uvs(grid(
                        1,
                        [=](double u, double v) {
                            return Vec3d(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0) * double(half);
                        },
                        [](double, double) { return Vec3d(0, 0, 1); }),
                    1);
}

// The camera looks through casters, and through what stands beside them.
inline void add_for_light(SceneMaker& maker, const Mesh& mesh, const Graph& graph,
                          const Transform& transform, CausticsRole role = CausticsRole::caster) {
    maker.add(mesh, graph, transform, role, kVisibleAll & ~uint32_t{kVisibleCamera});
}
// A square caster.
inline void add_surface(SceneMaker& maker, float half, const Graph& graph,
                        const Transform& transform, Relief relief = Relief::none) {
    constexpr float kTile = 1.0f / 0.6f;  // m
    const Vec2 repeat = Vec2(2.0f * half, 2.0f * half) / kTile;
    switch (relief) {
        case Relief::none: return add_for_light(maker, flat(square(half)), graph, transform);
        case Relief::normals:
            return add_for_light(maker, square_with_uvs(half), normal_mapped(graph, repeat),
                                 transform);
        case Relief::heights:
            return add_for_light(maker, square_with_uvs(half), bump_mapped(graph, repeat, kTile),
                                 transform);
    }
}
inline void add_slab(SceneMaker& maker, float top, Relief above = Relief::none,
                     Relief below = Relief::none) {
    add_surface(maker, 2.5f, refraction(1.5f), translation({0, 0, top}), above);
    add_surface(maker, 2.5f, refraction(1.5f), rotation_x(kPi, {0, 0, top - 0.2f}), below);
}
// Upright, behind the part of the floor that is looked at; the others in front of it and over it.
inline void add_mirror(SceneMaker& maker, Relief relief, const Graph& graph = mirror()) {
    add_surface(maker, 0.6f, graph, rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), relief);
}
inline void add_pane_before_mirror(SceneMaker& maker, const Graph& graph,
                                   Relief relief = Relief::none) {
    add_surface(maker, 0.75f, graph, rotation_x(0.5f * kPi, {0, 1.0f, 0.8f}), relief);
}
inline void add_pane_over_mirror(SceneMaker& maker, const Graph& graph,
                                 Relief relief = Relief::none) {
    add_surface(maker, 2.5f, graph, translation({0, 0, 1.45f}), relief);
    // Nothing comes to the floor but by the mirror.
    add_for_light(maker, square(0.9f), diffuse(0.0f), translation({0, -0.6f, 1.2f}),
                  CausticsRole::off);
}

inline std::vector<ChainScene> chain_scenes() {
    return {{"R", 1, [](SceneMaker& m, Reliefs r) { add_mirror(m, r.one); }},
            {"T", 1,
             [](SceneMaker& m, Reliefs r) {
                 add_surface(m, 2.5f, refraction(1.4f), translation({0, 0, 0.7f}), r.one);
             }},
            {"RT", 2,
             [](SceneMaker& m, Reliefs r) {
                 add_mirror(m, r.others);
                 add_pane_over_mirror(m, refraction(1.3f), r.one);
             }},
            {"TT", 2, [](SceneMaker& m, Reliefs r) { add_slab(m, 0.8f, r.one, r.others); }},
            {"TRT", 3,
             [](SceneMaker& m, Reliefs r) {
                 add_mirror(m, r.others);
                 add_pane_before_mirror(m, refraction(1.4f), r.one);
             }},
            // Half of the light is reflected at each interaction, outside and inside.
            {"R, TT and TRT of a ball",
             3,
             [](SceneMaker& m, Reliefs) {
                 add_for_light(m, sphere(32, 0.5), combined(mirror(), refraction(1.5f), 0.5f),
                               translation({0.0f, 0.9f, 0.6f}));
             },
             {0.1f, -0.4f, 1.3f},
             false},
            {"TTTT", 4, [](SceneMaker& m, Reliefs r) {
                 add_slab(m, 0.5f, r.others, r.others);
                 add_slab(m, 1.0f, r.one, r.others);
             }}};
}

}  // namespace spc::test
