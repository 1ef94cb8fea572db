// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/panorama.h"

namespace spc {
namespace {

Vec3 from_angles(float longitude, float latitude) {
    return {std::cos(latitude) * std::sin(longitude), std::sin(latitude),
            -std::cos(latitude) * std::cos(longitude)};
}

// At the angle theta from the axis, towards the film's point `at`, seen from its middle.
Vec3 from_axis(const Vec2& at, float theta) {
    const float r = length(Vec3(at.x, at.y, 0.0f));
    const Vec2 side = r > 0.0f ? at / r : Vec2(1.0f, 0.0f);
    return {side.x * std::sin(theta), side.y * std::sin(theta), -std::cos(theta)};
}

// Where a mirroring ball, seen from far away, shows what is behind the viewer.
std::optional<Vec3> from_ball(const Vec2& at) {
    const float squared = at.x * at.x + at.y * at.y;
    if (squared > 1.0f) return std::nullopt;
    const float facing = std::sqrt(1.0f - squared);
    return Vec3(2.0f * facing * at.x, 2.0f * facing * at.y, 1.0f - 2.0f * facing * facing);
}

}  // namespace

std::optional<Vec3> panoramic_direction(const Camera& camera, const Vec2& at) {
    const std::array<float, 8>& of = camera.panorama;
    const Vec2 centered(2.0f * at.x - 1.0f, 2.0f * at.y - 1.0f);
    const auto radius = [](const Vec2& a) { return std::sqrt(a.x * a.x + a.y * a.y); };
    switch (camera.projection) {
        case Projection::equirectangular:
            return from_angles(lerp(of[0], of[1], at.x), lerp(of[2], of[3], at.y));
        case Projection::fisheye_equidistant: {
            const float r = radius(centered);
            if (r > 1.0f) return std::nullopt;
            return from_axis(centered, 0.5f * of[0] * r);
        }
        case Projection::fisheye_equisolid: {
            const Vec2 sensor(0.5f * of[2] * centered.x, 0.5f * of[3] * centered.y);
            const float chord = radius(sensor) / (2.0f * of[1]);  // sine of half the angle
            if (chord > std::sin(0.25f * of[0])) return std::nullopt;
            return from_axis(sensor, 2.0f * std::asin(chord));
        }
        case Projection::fisheye_polynomial: {
            const Vec2 sensor(0.5f * of[6] * centered.x, 0.5f * of[7] * centered.y);
            const float r = radius(sensor);
            const float theta = -(of[1] + r * (of[2] + r * (of[3] + r * (of[4] + r * of[5]))));
            if (std::abs(theta) > 0.5f * of[0]) return std::nullopt;
            return from_axis(sensor, theta);
        }
        case Projection::mirror_ball: return from_ball(centered);
        case Projection::equiangular_cubemap_face:
            return normalize(Vec3(std::tan(0.25f * kPi * centered.x),
                                  std::tan(0.25f * kPi * centered.y), -1.0f));
        case Projection::central_cylindrical: {
            const float longitude = lerp(of[0], of[1], at.x);
            return normalize(
                Vec3(std::sin(longitude), lerp(of[2], of[3], at.y), -std::cos(longitude)));
        }
        case Projection::perspective:
        case Projection::orthographic: break;
    }
    return std::nullopt;
}

}  // namespace spc
