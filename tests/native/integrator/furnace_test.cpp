// SPDX-License-Identifier: GPL-3.0-or-later
// Whole scenes without loss in uniform light: every path, however it goes, must bring back radiance
// 1. It needs no reference and sees every factor that is forgotten, counted twice or weighed
// wrongly.
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;
using test::unlimited;

constexpr double kFamily = 1e-4;

// Rays from all around at a sphere of radius 1, over its whole disc.
auto rays_at_unit_sphere(uint64_t seed) {
    return [uniforms = test::Uniforms(seed)](uint32_t) mutable {
        const Vec3 axis = normalize(uniforms.three() - Vec3(0.5f));
        const Frame frame = Frame::around(axis);
        const float r = 0.99f * std::sqrt(uniforms()), phi = 2.0f * kPi * uniforms();
        return Ray{frame.to_world(Vec3(r * std::cos(phi), r * std::sin(phi), 5.0f)), axis * -1.0f};
    };
}

TEST(Furnace, FlatObjectsVanishInAWhiteWorldExactly) {
    const std::pair<const char*, Graph> materials[] = {
        {"diffuse", test::diffuse(1.0f)},
        {"mirror", test::mirror()},
        {"glass", test::glass(1.5f)},
        {"transparent", test::transparent(1.0f)},
        {"half and half", test::combined(test::mirror(), test::diffuse(1.0f), 0.5f)}};
    for (const auto& [name, graph] : materials) {
        SceneMaker maker;
        maker.add(test::flat(test::sphere(8, 1.0)), graph);
        test::set_world(maker, 1.0f);
        const RenderScene world = maker.finish();
        for (const bool manifold : {false, true}) {
            const IntegratorSettings settings =
                unlimited(manifold ? test::unbiased_manifold() : ManifoldSettings{});
            const test::RadianceEstimate e =
                test::estimate(world, settings, 2000, rays_at_unit_sphere(3));
            EXPECT_NEAR(e.least, 1.0, 1e-4) << name;
            EXPECT_NEAR(e.most, 1.0, 1e-4) << name;
        }
    }
}

// Interpolated normals lose what leaves them through the geometry, near silhouettes, and never
// gain.
TEST(Furnace, SmoothObjectsNearlyVanish) {
    const std::pair<const char*, Graph> materials[] = {
        {"diffuse", test::diffuse(1.0f)}, {"mirror", test::mirror()}, {"glass", test::glass(1.5f)}};
    for (const auto& [name, graph] : materials) {
        SceneMaker maker;
        maker.add(test::sphere(64, 1.0), graph);
        test::set_world(maker, 1.0f);
        const test::RadianceEstimate e =
            test::estimate(maker.finish(), unlimited(), 4000, rays_at_unit_sphere(4));
        EXPECT_LE(e.most, 1.0001) << name;
        EXPECT_GT(e.radiance.mean(), 0.985) << name;
    }
}

// What a coat does not reflect is all there below it. Its table of albedos is good to 1 %.
TEST(Furnace, CoatedBallsNearlyVanish) {
    for (const float roughness : {0.0f, 0.2f, 0.5f, 1.0f})
        for (const float ior : {1.5f, 1.0f}) {
            SceneMaker maker;
            maker.add(test::flat(test::sphere(16, 1.0)),
                      test::single_shader("bsdf_principled",
                                          {{1, "Base Color", {1, 1, 1, 1}},
                                           {1, "Roughness", {0.3f, 0, 0, 0}},
                                           {1, "IOR", {ior, 0, 0, 0}},
                                           {1, "Coat Weight", {1, 0, 0, 0}},
                                           {1, "Coat IOR", {1.6f, 0, 0, 0}},
                                           {1, "Coat Roughness", {roughness, 0, 0, 0}}}));
            test::set_world(maker, 1.0f);
            const test::RadianceEstimate e =
                test::estimate(maker.finish(), unlimited(), 40000, rays_at_unit_sphere(5));
            EXPECT_NEAR(e.radiance.mean(), 1.0, 0.004) << roughness << ", IOR " << ior;
            EXPECT_LT(e.radiance.standard_error(), 0.001) << "too little power";
        }
}

// Glows as a white world would. The manifold is fed by meshes, and by no more of a world than its
// narrow bright parts.
void add_dome(SceneMaker& maker) {
    maker.add(test::flat(test::sphere(5, 30.0)), test::emission(1.0f));
}

// A white floor under a white dome, with casters above it: light comes to the floor directly, by
// reflection and through glass, and the manifold shares it with path tracing.
struct FurnaceCase {
    const char* name;
    Mesh mesh;
    Graph material;
    Transform transform;
};
std::vector<FurnaceCase> furnace_cases() {
    return {{"mirror plane", test::square(1.0f), test::mirror(),
             test::rotation_x(0.6f, Vec3(0.0f, 0.8f, 0.8f))},
            {"sheet of glass", test::square(1.2f), test::glass(1.5f),
             test::rotation_x(0.2f, Vec3(0.1f, 0.0f, 0.7f))},
            {"sheet of glass from its back", test::square(1.2f), test::glass(1.5f),
             test::rotation_x(2.9f, Vec3(0.1f, 0.0f, 0.7f))},
            {"faceted mirror ball", test::flat(test::sphere(6, 0.5)), test::mirror(),
             test::translation(Vec3(0.3f, 0.2f, 0.8f))},
            {"faceted glass ball", test::flat(test::sphere(6, 0.5)), test::glass(1.4f),
             test::translation(Vec3(0.3f, 0.2f, 0.8f))}};
}

TEST(Furnace, CausticsOnAWhiteFloor) {
    const std::vector<FurnaceCase> cases = furnace_cases();
    ManifoldSettings two_stage = test::unbiased_manifold();
    two_stage.two_stage = true;
    const std::pair<const char*, ManifoldSettings> methods[] = {
        {"path tracing", {}},
        {"half-vector", test::unbiased_manifold()},
        {"angle difference", test::unbiased_manifold(Constraint::angle_difference)},
        {"two stages", two_stage}};
    const double significance = test::sidak(kFamily, int(cases.size() * std::size(methods)));
    for (const FurnaceCase& c : cases) {
        SceneMaker maker;
        maker.add(test::square(20.0f), test::diffuse(1.0f));
        maker.add(c.mesh, c.material, c.transform);
        add_dome(maker);
        const RenderScene world = maker.finish();
        for (const auto& [name, manifold] : methods) {
            const test::RadianceEstimate e =
                test::estimate(world, unlimited(manifold), 6000,
                               test::ray_to({0.9f, -0.6f, 0.18f}, {0.0f, 0.0f, 0.0f}));
            EXPECT_TRUE(test::is_mean(e.radiance, 1.0, significance, 2e-4))
                << c.name << ", " << name;
            if (manifold.enabled) {
                EXPECT_GT(e.caustics.mean(), 1e-4) << c.name << ": nothing to share";
            }
        }
    }
}

// The same inside a closed room that glows, e + r = 1: emissive triangles instead of a world,
// sampled as lights.
TEST(Furnace, ClosedRoomOfGlowingWalls) {
    constexpr float kEmission = 0.4f;
    const Graph wall =
        test::combined(test::emission(kEmission), test::diffuse(1.0f - kEmission), -1.0f);
    const std::vector<FurnaceCase> cases = furnace_cases();
    const double significance = test::sidak(kFamily, int(cases.size() * 2));
    for (const FurnaceCase& c : cases)
        for (const bool manifold : {false, true}) {
            SceneMaker maker;
            maker.add(test::flat(test::sphere(5, 4.0)), wall);
            maker.add(c.mesh, c.material, c.transform);
            const RenderScene world = maker.finish();
            const test::RadianceEstimate e = test::estimate(
                world, unlimited(manifold ? test::unbiased_manifold() : ManifoldSettings{}), 6000,
                test::ray_to({0.1f, 0.1f, -1.0f}, {0.7f, -0.5f, -4.0f}));
            EXPECT_TRUE(test::is_mean(e.radiance, 1.0, significance, 2e-4))
                << c.name << (manifold ? ", manifold" : ", path tracing");
        }
}

// Its twin: the furnace notices two percent.
TEST(Furnace, NoticesALossOfTwoPercent) {
    SceneMaker maker;
    maker.add(test::flat(test::sphere(5, 4.0)),
              test::combined(test::emission(0.4f), test::diffuse(0.588f), -1.0f));
    const test::RadianceEstimate e = test::estimate(
        maker.finish(), unlimited(), 20000, test::ray_to({0.1f, 0.1f, -1.0f}, {0.7f, -0.5f, -4.0f}));
    EXPECT_FALSE(test::is_mean(e.radiance, 1.0, test::sidak(kFamily, 10)));
}

// A curved mirror has no closed form here; both methods must agree on it.
TEST(Furnace, ManifoldAndPathTracingAgreeUnderADome) {
    SceneMaker maker;
    maker.add(test::square(20.0f), test::diffuse(0.8f));
    maker.add(test::sphere(32, 0.5), test::mirror(), test::translation(Vec3(0.4f, 0.3f, 0.7f)));
    add_dome(maker);
    const RenderScene world = maker.finish();
    const Ray ray = test::ray_to({1.5f, -1.0f, 1.5f}, {0.0f, 0.0f, 0.0f});
    const test::RadianceEstimate alone = test::estimate(world, unlimited(), 40000, ray, 5),
                                 both = test::estimate(world, unlimited(test::unbiased_manifold()),
                                                       40000, ray, 6);
    const double spread =
        std::hypot(alone.radiance.standard_error(), both.radiance.standard_error());
    EXPECT_LT(std::abs(alone.radiance.mean() - both.radiance.mean()), 4.0 * spread)
        << alone.radiance.mean() << " and " << both.radiance.mean() << ", standard error " << spread;
    EXPECT_LT(spread, 0.01) << "too little power";
    EXPECT_GT(both.caustics.mean(), 0.005);
}

}  // namespace
}  // namespace spc
