// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of scenes and claims that several tables share.
#pragma once

#include "agreement/matrix.h"

namespace spc::test {

// A texture of gentle slopes in both directions.
inline Image gentle_waves() {
    return normal_image(64, 64, [](double u, double v) {
        const double turn = 2.0 * std::numbers::pi;
        return Vec2(float(0.15 * std::sin(turn * u)), float(0.12 * std::cos(turn * (u + v))));
    });
}
// A relief from 0 to 1 that takes as few texels as it may.
inline Image gentle_hills() {
    constexpr uint32_t kTexels = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kTexels; ++y)
        for (uint32_t x = 0; x < kTexels; ++x) {
            const double a = 2.0 * std::numbers::pi * x / kTexels,
                         b = 2.0 * std::numbers::pi * y / kTexels;
            texels.push_back(float(0.5 + 0.25 * (std::sin(a) + std::cos(a + b))));
        }
    return image_from_floats("hills", texels, kTexels, kTexels, 1, ColorSpace::data,
                             AlphaMode::none);
}
// A square of so many metres with UVs, under which maps find their tangents.
inline Mesh panel_with_uvs(double side) {
    return with_uvs(
        grid(
            1, [side](double u, double v) { return Vec3d(side * (u - 0.5), side * (v - 0.5), 0); },
            [](double, double) { return Vec3d(0, 0, 1); }),
        1);
}

// ---- lights

inline Part bulb(const std::string& name, const Vec3& p, float radius = 0.3f,
                 uint32_t visibility = kNotDirectly) {
    return {name, [=](SceneMaker& m) { add_bulb(m, p, radius, visibility); }};
}
inline Part light(const std::string& name, const LightDesc& desc) {
    return {name, [desc](SceneMaker& m) { m.builder.add_light(desc); }};
}
inline LightDesc wide_sun() {
    LightDesc sun = lamp(LightType::sun, 3.0f);
    sun.sun_angle = 0.25f;
    return sun;
}
inline LightDesc rectangle_lamp() {
    LightDesc rectangle = lamp(LightType::area, 100.0f);
    rectangle.size = Vec2(0.7f, 0.4f);
    return rectangle;
}

// ---- cameras

inline Part camera_from(const std::string& name, const Vec3& from, float half) {
    return {name, [=](SceneMaker& m) { set_camera(m, from, half); }};
}
// Straight above the origin; of the floor it sees so many metres to each side.
inline Part camera_above(float half_view) {
    constexpr float kHeight = 3.0f;
    return camera_from("", {0.0f, 0.0f, kHeight}, half_view / kHeight);
}
// Below what casters are over the floor.
inline const Vec3 kLowEye(0.0f, -1.0f, 0.7f);

// ---- claims

// Light paths alone and beside each way to look for chains. By day half of the samples.
inline std::vector<Claim> of_light_paths() {
    const uint32_t rounds = power(1000u, 2000u);
    const double notices = power(0.6, 0.5);
    return {{kManifold, rounds},
            {kLightPaths, rounds, notices},
            {kAll, rounds, notices},
            {kSheets, rounds}};  // they may leave little to light paths
}

}  // namespace spc::test
