// SPDX-License-Identifier: GPL-3.0-or-later
// Panoramic cameras against what their projections are named after.
#include "scene/description.h"
#include "shading/graphs.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

constexpr float kWidth = 200.0f, kHeight = 100.0f;

Camera panoramic(Projection projection, const std::array<float, 8>& numbers = {}) {
    Camera camera;
    camera.projection = projection;
    camera.panorama = numbers;
    camera.width = static_cast<uint32_t>(kWidth);
    camera.height = static_cast<uint32_t>(kHeight);
    camera.viewplane = {0, 1, 0, 1};
    return camera;
}

// Where a share of the whole picture looks.
Vec3 seen_at(const Camera& camera, float u, float v, const Vec2& lens = {0.5f, 0.5f}) {
    return camera.ray(u * kWidth, v * kHeight, lens).direction;
}

float angle_to_axis(const Camera& camera, float u, float v) {
    return std::acos(std::min(1.0f, -seen_at(camera, u, v).z));
}

TEST(Panorama, AnEquirectangularOneIsAGridOfAngles) {
    const Camera camera =
        panoramic(Projection::equirectangular, {-kPi, kPi, -0.5f * kPi, 0.5f * kPi});
    test::expect_near(seen_at(camera, 0.5f, 0.5f), Vec3(0, 0, -1), 1e-6f);
    test::expect_near(seen_at(camera, 0.75f, 0.5f), Vec3(1, 0, 0), 1e-6f);
    test::expect_near(seen_at(camera, 0.0f, 0.5f), Vec3(0, 0, 1), 1e-6f);
    test::expect_near(seen_at(camera, 0.3f, 1.0f), Vec3(0, 1, 0), 1e-6f);
    const float s = std::sqrt(0.5f);
    test::expect_near(seen_at(camera, 0.5f, 0.25f), Vec3(0, -s, -s), 1e-6f);
}

TEST(Panorama, AnglesOfAnEquidistantFisheyeGrowWithTheRadius) {
    const Camera camera = panoramic(Projection::fisheye_equidistant, {3.0f});
    for (const float share : {0.1f, 0.4f, 0.9f}) {
        EXPECT_NEAR(angle_to_axis(camera, 0.5f + 0.5f * share, 0.5f), 1.5f * share, 1e-4f);
        EXPECT_NEAR(angle_to_axis(camera, 0.5f, 0.5f - 0.5f * share), 1.5f * share, 1e-4f);
    }
    EXPECT_GT(seen_at(camera, 0.6f, 0.5f).x, 0.0f);
    EXPECT_GT(seen_at(camera, 0.5f, 0.6f).y, 0.0f);
    EXPECT_TRUE(camera.sees({0.5f * kWidth, 0.99f * kHeight}));
    EXPECT_FALSE(camera.sees({0.05f * kWidth, 0.05f * kHeight}));
}

// Equal parts of the sensor see equal solid angles.
TEST(Panorama, AnEquisolidFisheyeKeepsAreas) {
    constexpr float kFocal = 10.0f, kSensor = 30.0f;
    const Camera camera =
        panoramic(Projection::fisheye_equisolid, {kPi, kFocal, kSensor, kSensor / 2});
    const auto solid_angle = [&](float u, float v) {
        constexpr float kStep = 2e-3f;
        const Vec3 du = seen_at(camera, u + kStep, v) - seen_at(camera, u - kStep, v),
                   dv = seen_at(camera, u, v + kStep) - seen_at(camera, u, v - kStep);
        return length(cross(du, dv)) / (4 * kStep * kStep);
    };
    const float expected = kSensor * kSensor / 2 / (kFocal * kFocal);
    for (const Vec2& at : {Vec2(0.5f, 0.5f), Vec2(0.7f, 0.4f), Vec2(0.3f, 0.8f)})
        EXPECT_NEAR(solid_angle(at.x, at.y), expected, 2e-3f * expected);
    EXPECT_FALSE(camera.sees({0.999f * kWidth, 0.5f * kHeight}));
}

TEST(Panorama, APolynomialOfDegreeOneIsEquidistant) {
    const Camera camera = panoramic(Projection::fisheye_polynomial,
                                    {2.5f, 0.0f, -0.05f, 0.0f, 0.0f, 0.0f, 36.0f, 18.0f});
    EXPECT_NEAR(angle_to_axis(camera, 0.75f, 0.5f), 0.05f * 9.0f, 1e-4f);
    EXPECT_NEAR(angle_to_axis(camera, 0.5f, 0.75f), 0.05f * 4.5f, 1e-4f);
    EXPECT_GT(seen_at(camera, 0.75f, 0.5f).x, 0.0f);
    const Camera bent = panoramic(Projection::fisheye_polynomial,
                                  {2.5f, 0.0f, -0.05f, 0.0f, 1e-4f, 0.0f, 36.0f, 18.0f});
    EXPECT_NEAR(angle_to_axis(bent, 0.75f, 0.5f), 0.05f * 9.0f - 1e-4f * 729.0f, 1e-4f);
}

// What a ray along the axis meets on a ball of radius 1 and mirrors.
TEST(Panorama, AMirrorBallMirrors) {
    const Camera camera = panoramic(Projection::mirror_ball);
    for (const Vec2& at : {Vec2(0.0f, 0.0f), Vec2(0.6f, -0.3f), Vec2(0.0f, 0.9f)}) {
        const Vec3 normal(at.x, at.y, -std::sqrt(1.0f - at.x * at.x - at.y * at.y));
        const Vec3 incoming(0, 0, 1);
        const Vec3 mirrored = incoming - normal * (2.0f * dot(normal, incoming));
        test::expect_near(seen_at(camera, 0.5f + 0.5f * at.x, 0.5f + 0.5f * at.y), mirrored, 1e-5f);
    }
    EXPECT_FALSE(camera.sees({0.0f, 0.0f}));
}

TEST(Panorama, ACubesFaceIsASquareOfAngles) {
    const Camera camera = panoramic(Projection::equiangular_cubemap_face);
    EXPECT_NEAR(angle_to_axis(camera, 1.0f, 0.5f), 0.25f * kPi, 1e-4f);
    EXPECT_NEAR(angle_to_axis(camera, 0.75f, 0.5f), 0.125f * kPi, 1e-4f);
}

TEST(Panorama, ACylinderIsUnrolled) {
    const Camera camera = panoramic(Projection::central_cylindrical, {-kPi, kPi, -2.0f, 2.0f});
    test::expect_near(seen_at(camera, 0.75f, 0.75f), normalize(Vec3(1, 1, 0)), 1e-6f);
}

TEST(Panorama, RaysThroughTheLensMeetAtTheFocus) {
    Camera camera = panoramic(Projection::equirectangular, {-kPi, kPi, -0.5f * kPi, 0.5f * kPi});
    const Vec3 sharp = seen_at(camera, 0.7f, 0.6f) * 3.0f;
    camera.aperture_radius = 0.2f;
    camera.focus_distance = 3.0f;
    test::Uniforms uniforms(3);
    for (int i = 0; i < 20; ++i) {
        const Ray ray = camera.ray(0.7f * kWidth, 0.6f * kHeight, uniforms.two());
        EXPECT_LE(length(ray.origin), 0.2f);
        EXPECT_NEAR(dot(ray.origin, sharp), 0.0f, 1e-5f);
        const Vec3 to_focus = sharp - ray.origin;
        test::expect_near(ray.origin + ray.direction * dot(to_focus, ray.direction), sharp, 1e-5f);
    }
}

TEST(Panorama, DerivativesAreThoseOfItsRays) {
    const Camera camera = panoramic(Projection::fisheye_equidistant, {3.0f});
    const Vec2 lens{0.5f, 0.5f};
    const RayChange change = camera.ray_change(120.0f, 60.0f, lens);
    const Vec3 right = camera.ray(120.1f, 60.0f, lens).direction,
               left = camera.ray(119.9f, 60.0f, lens).direction;
    test::expect_near(change.direction[0], (right - left) * 5.0f, 1e-5f);
}

}  // namespace
}  // namespace spc
