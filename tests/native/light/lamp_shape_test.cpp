// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/description.h"
#include "support/numerics.h"

namespace spc::test {
namespace {

Transform frame_at(const Vec3& center, const Vec3& axis, float scale_x = 1.0f, float scale_y = 1.0f) {
    const Frame frame = Frame::around(normalize(axis) * -1.0f);
    Transform m;
    for (int i = 0; i < 3; ++i)
        m.row[i] = Vec3(frame.x[i] * scale_x, frame.y[i] * scale_y, frame.z[i]);
    m.translation = center;
    return m;
}

LightDesc sphere_lamp(const Vec3& center, float radius) {
    LightDesc light;
    light.type = LightType::point;
    light.to_world = frame_at(center, {0.3f, 0.2f, -1.0f});
    light.radius = radius;
    return light;
}

LightDesc area_lamp(const Vec3& center, const Vec3& axis, AreaShape shape, Vec2 size) {
    LightDesc light;
    light.type = LightType::area;
    light.shape = shape;
    light.size = size;
    light.to_world = frame_at(center, axis);
    return light;
}

Vec3 random_direction(Uniforms& uniforms) {
    const float z = 2.0f * uniforms() - 1.0f, phi = 2.0f * kPi * uniforms(),
                s = safe_sqrt(1.0f - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

TEST(LampShape, LampsWithoutExtentAndSunsAreNotHit) {
    LightDesc light = sphere_lamp({0, 0, 0}, 0.0f);
    EXPECT_FALSE(intersect_light(light, {{0, 0, 2}, {0, 0, -1}}));
    light.type = LightType::sun;
    light.sun_angle = 1.0f;
    EXPECT_FALSE(intersect_light(light, {{0, 0, 2}, {0, 0, -1}}));
}

TEST(LampShape, SphereFromOutsideByTheQuadratic) {
    Uniforms uniforms(1);
    const Vec3 center(1.0f, -2.0f, 0.5f);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const float radius = 0.1f + uniforms();
        const LightDesc light = sphere_lamp(center, radius);
        const Vec3 origin =
            center + random_direction(uniforms) * (radius * (1.05f + 10.0f * uniforms()));
        const Vec3 aim = center + random_direction(uniforms) * (1.5f * radius * uniforms());
        const Vec3 d = normalize(aim - origin);
        // t^2 + 2 b t + c = 0, in double
        const Vec3d o = Vec3d(origin) - Vec3d(center), w(d);
        const double b = dot(o, w), c = dot(o, o) - double(radius) * radius,
                     discriminant = b * b - c * dot(w, w);
        if (std::abs(discriminant) < 1e-4 * radius * radius) continue;
        const std::optional<LightSurfaceHit> hit = intersect_light(light, {origin, d});
        ASSERT_EQ(hit.has_value(), discriminant > 0 && b < 0);
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR_REL(hit->t, -b - std::sqrt(discriminant), 2e-4);
        EXPECT_NEAR(length(hit->p - center), radius, 1e-5f * radius + 2e-6f);
        EXPECT_NEAR(length(hit->n), 1.0f, 1e-6f);
        EXPECT_LT(dot(hit->n, d), 0.0f);
        EXPECT_NEAR(length(hit->n * radius - (hit->p - center)), 0.0f, 1e-5f);
        // Limits of the ray; and who has passed the near side does not meet the far one.
        EXPECT_FALSE(intersect_light(light, {origin, d, 0.0f, hit->t * 0.999f}));
        EXPECT_FALSE(intersect_light(light, {origin, d, hit->t * 1.001f, kInfinity}));
        EXPECT_FALSE(intersect_light(light, {origin, d * -1.0f}));
    }
    EXPECT_GT(hits, 5000);
}

TEST(LampShape, SphereFromWithinShowsItsInnerSide) {
    Uniforms uniforms(2);
    const LightDesc light = sphere_lamp({0, 0, 3}, 2.0f);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 origin = Vec3(0, 0, 3) + random_direction(uniforms) * (1.9f * uniforms());
        const Vec3 d = random_direction(uniforms);
        const std::optional<LightSurfaceHit> hit = intersect_light(light, {origin, d});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(length(origin + d * hit->t - Vec3(0, 0, 3)), 2.0f, 1e-5f);
        EXPECT_NEAR_ANGLE(hit->n, (Vec3(0, 0, 3) - hit->p) * 0.5f, 1e-5);
    }
}

TEST(LampShape, SmallFarSphereKeepsItsSize) {
    // Seen from 1e4 radii, the textbook formula's discriminant has no digits left.
    const LightDesc light = sphere_lamp({100.0f, 0, 0}, 0.01f);
    for (const float offset : {0.0f, 0.005f, 0.0095f})
        EXPECT_TRUE(intersect_light(light, {{0, offset, 0}, {1, 0, 0}})) << offset;
    for (const float offset : {0.0105f, 0.02f})
        EXPECT_FALSE(intersect_light(light, {{0, offset, 0}, {1, 0, 0}})) << offset;
}

TEST(LampShape, DiskFacesWhereTheRayStarts) {
    Uniforms uniforms(5);
    LightDesc light = sphere_lamp({1.0f, -2.0f, 0.5f}, 0.0f);
    light.soft_falloff = true;
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        light.radius = 0.1f + uniforms();
        const Vec3 origin = light.position() + random_direction(uniforms) *
                                                   (light.radius * (0.1f + 5.0f * uniforms()));
        const Vec3 n = normalize(origin - light.position());
        const Vec3 aim =
            light.position() + random_direction(uniforms) * (2.0f * light.radius * uniforms());
        const Vec3 d = normalize(aim - origin);
        // The plane through the centre, in double.
        const Vec3d o = Vec3d(origin) - Vec3d(light.position()), w(d), up(n);
        const double t = -dot(o, up) / dot(w, up), off = length(o + w * t);
        if (std::abs(off - static_cast<double>(light.radius)) < 1e-3 * t) continue;
        const std::optional<LightSurfaceHit> hit = intersect_light(light, {origin, d});
        ASSERT_EQ(hit.has_value(), t > 0 && off < static_cast<double>(light.radius));
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR_REL(hit->t, t, 1e-4);
        EXPECT_NEAR(length(origin + d * hit->t - hit->p), 0.0f, 1e-5f * (1.0f + hit->t));
        EXPECT_NEAR_ANGLE(hit->n, n, 1e-4);
        EXPECT_FALSE(intersect_light(light, {origin, d, 0.0f, hit->t * 0.999f}));
        EXPECT_FALSE(intersect_light(light, {origin, d, hit->t * 1.001f, kInfinity}));
    }
    EXPECT_GT(hits, 5000);
}

TEST(LampShape, AreaLightsByTheirEdges) {
    Uniforms uniforms(3);
    for (const AreaShape shape : {AreaShape::rectangle, AreaShape::ellipse}) {
        const Vec3 center(0.5f, 1.0f, 2.0f), axis(0.4f, -0.3f, -1.0f);
        const LightDesc light = area_lamp(center, axis, shape, {2.0f, 0.6f});
        const Vec3 x = normalize(light.to_world.column(0)), y = normalize(light.to_world.column(1));
        int hits = 0;
        for (int i = 0; i < 20000; ++i) {
            const float a = 3.0f * uniforms() - 1.5f, b = uniforms() - 0.5f;
            const bool inside = shape == AreaShape::rectangle
                                    ? std::abs(a) < 1.0f && std::abs(b) < 0.3f
                                    : a * a + b * b / 0.09f < 1.0f;
            const Vec3 target = center + x * a + y * b;
            const Vec3 direction = random_direction(uniforms);
            const bool towards_front = dot(direction, light.axis()) < 0.0f;
            const float distance = 0.1f + 3.0f * uniforms();
            const Ray ray{target - direction * distance, direction};
            const std::optional<LightSurfaceHit> hit = intersect_light(light, ray);
            const float edge =
                shape == AreaShape::rectangle
                    ? std::min(std::abs(std::abs(a) - 1.0f), std::abs(std::abs(b) - 0.3f))
                    : std::abs(a * a + b * b / 0.09f - 1.0f);
            if (edge < 1e-3f || std::abs(dot(direction, light.axis())) < 1e-2f) continue;
            ASSERT_EQ(hit.has_value(), inside && towards_front) << a << " " << b;
            if (!hit) continue;
            ++hits;
            EXPECT_NEAR_REL(hit->t, distance, 1e-3);
            EXPECT_NEAR(length(hit->p - target), 0.0f, 1e-4f);
            EXPECT_NEAR_ANGLE(hit->n, light.axis(), 1e-3);
            EXPECT_FALSE(intersect_light(light, {ray.origin, direction, 0.0f, distance * 0.99f}));
            EXPECT_FALSE(
                intersect_light(light, {ray.origin, direction, distance * 1.01f, kInfinity}));
        }
        EXPECT_GT(hits, 3000);
    }
}

TEST(LampShape, AreaLightsFollowScaleMirrorAndShear) {
    LightDesc light = area_lamp({0, 0, 1}, {0, 0, -1}, AreaShape::rectangle, {1.0f, 1.0f});
    const auto seen_at = [&](float x, float y) {
        return intersect_light(light, {{x, y, 0}, {0, 0, 1}}).has_value();
    };
    light.to_world.row = {Vec3(-4, 0, 0), Vec3(0, 2, 0),
                          Vec3(0, 0, 1)};  // mirrored: still shines along -z
    EXPECT_TRUE(seen_at(1.9f, 0.9f));
    EXPECT_TRUE(seen_at(-1.9f, -0.9f));
    EXPECT_FALSE(seen_at(2.1f, 0.0f));
    EXPECT_FALSE(seen_at(0.0f, 1.1f));
    light.to_world.row = {Vec3(2, 2, 0), Vec3(0, 2, 0), Vec3(0, 0, 1)};  // corners (+-1 +-1, +-1)
    EXPECT_TRUE(seen_at(1.9f, 0.95f));
    EXPECT_TRUE(seen_at(-1.9f, -0.95f));
    EXPECT_FALSE(seen_at(1.9f, -0.95f));
    light.to_world.row = {Vec3(2, 0, 0), Vec3(0, 2, 0),
                          Vec3(0, 0, -1)};  // turned over: shines upwards
    EXPECT_FALSE(seen_at(0.0f, 0.0f));
    EXPECT_TRUE(intersect_light(light, {{0, 0, 2}, {0, 0, -1}}));
}

}  // namespace
}  // namespace spc::test
