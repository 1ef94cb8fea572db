// SPDX-License-Identifier: GPL-3.0-or-later
// Absorbing media against the law of Beer and Lambert: along rays through surfaces that bend light
// or do not, to lights near and far, from inside and from outside.
#include "support/radiance.h"

#include <gmock/gmock.h>

namespace spc {
namespace {

using test::SceneMaker;

const Spectrum kSigma(0.0f, 0.7f, 3.0f);  // 1/m
// Relative: rays leave surfaces by what positions may be wrong, 3 m times 2^-18 on either side.
constexpr float kTolerance = 5e-5f;

IntegratorSettings direct_only() {
    IntegratorSettings settings;
    settings.limits.total = 0;
    return settings;
}

// Where nothing is left to chance.
Spectrum radiance(const RenderScene& world, const Ray& ray,
                  const IntegratorSettings& settings = test::unlimited()) {
    PathStats stats;
    return path_radiance(world, settings, {}, ray, Vec2(0.5f), Sampler(1, 0, 0), stats).radiance;
}

void expect_left(const Spectrum& actual, const Spectrum& sigma, double distance, double full,
                 const char* what) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(double(actual[c]), full * std::exp(-double(sigma[c]) * distance),
                    double(kTolerance) * full)
            << what << ", channel " << c;
}

Graph clear_block() { return test::absorbing(test::transparent(1.0f), kSigma); }

// From the height of 3 m to the point (0, 0, `z`), at an angle whose cosine is 0.8.
Ray slanting(float z) { return test::ray_to({(3.0f - z) * 0.75f, 0.0f, 3.0f}, {0.0f, 0.0f, z}); }
constexpr double kCosine = 0.8;

TEST(Absorption, ThroughABlockThatDoesNotBendLight) {
    SceneMaker maker;
    maker.add(test::block(3.0f, 0.6f), clear_block());
    test::set_world(maker, 2.0f);
    const RenderScene world = maker.finish();
    expect_left(radiance(world, slanting(0.0f)), kSigma, 0.6 / kCosine, 2.0, "from above");
    const Ray down = slanting(0.0f);
    expect_left(radiance(world, {down.origin + down.direction * 8.0f, down.direction * -1.0f}),
                kSigma, 0.6 / kCosine, 2.0, "from below");
}

TEST(Absorption, ThroughABlockThatRefracts) {
    SceneMaker maker;
    maker.add(test::block(3.0f, 0.6f), test::absorbing(test::refraction(1.5f), kSigma));
    test::set_world(maker, 2.0f);
    const double sine = std::sqrt(1.0 - kCosine * kCosine) / 1.5;
    expect_left(radiance(maker.finish(), slanting(0.0f)), kSigma,
                0.6 / std::sqrt(1.0 - sine * sine), 2.0, "refraction");
}

// Scale and shear belong to the object, lengths to the world.
TEST(Absorption, AlongLengthsInTheWorld) {
    SceneMaker maker;
    Transform flipped;  // and a metre thick
    flipped.row = {Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 4)};
    maker.add(test::block(3.0f, 0.25f), clear_block(), flipped);
    test::set_world(maker, 2.0f);
    expect_left(radiance(maker.finish(), slanting(0.0f)), kSigma, 1.0 / kCosine, 2.0, "scaled");
}

TEST(Absorption, AddsUpWhereMediaOverlap) {
    SceneMaker maker;
    maker.add(test::block(3.0f, 0.6f), clear_block());
    maker.add(test::block(3.2f, 0.6f), clear_block(), test::translation({0, 0, -0.2f}));
    Mesh two = test::block(3.4f, 0.3f);  // the same object twice, in part of it
    const auto count = static_cast<uint32_t>(two.positions.size());
    for (uint32_t i = 0; i < count; ++i)
        two.positions.push_back(two.positions[i] + Vec3(0, 0, 0.2f));
    for (size_t i = 0; i < 12; ++i) {
        const auto [a, b, c] = two.triangles[i];
        two.triangles.push_back({a + count, b + count, c + count});
    }
    maker.add(two, clear_block(), test::translation({0, 0, -1.1f}));
    test::set_world(maker, 1.0f);
    const RenderScene world = maker.finish();
    const Ray down = slanting(0.0f);
    const Ray up{down.origin + down.direction * 8.0f, down.direction * -1.0f};
    for (const Ray& ray : {down, up})
        expect_left(radiance(world, ray), kSigma, (0.6 + 0.6 + 0.5) / kCosine, 1.0, "overlap");
}

// ---- from inside

TEST(Absorption, OfACameraInsideTheMedium) {
    SceneMaker closed, open;
    closed.add(test::block(3.0f, 0.6f), clear_block());
    open.add(test::flat(test::square(3.0f)), clear_block());
    open.add(test::square(3.0f), test::emission(2.0f), test::translation({0, 0, 1.0f}));
    closed.add(test::square(3.0f), test::emission(2.0f), test::translation({0, 0, 1.0f}));
    const Vec3 up = slanting(0.0f).direction * -1.0f;
    Ray ray{Vec3(0.1f, 0.2f, -0.4f), up};
    for (SceneMaker* maker : {&closed, &open}) {
        const RenderScene world = maker->finish();
        expect_left(radiance(world, ray), kSigma, 0.4 / kCosine, 2.0, "inside");
        Ray clipped = ray;
        clipped.t_near = 0.1f;
        expect_left(radiance(world, clipped), kSigma, 0.4 / kCosine - 0.1, 2.0, "clipped");
        clipped.t_near = 0.6f;
        expect_left(radiance(world, clipped), kSigma, 0.0, 2.0, "clipped outside");
    }
}

TEST(Absorption, IsCompleteOnTheWayToInfinity) {
    SceneMaker maker;
    maker.add(test::flat(test::square(5.0f)), clear_block());
    maker.add(test::flat(test::square(1.0f)), test::diffuse(0.5f),
              test::rotation_x(0.5f * kPi, {0.0f, 1.0f, -2.0f}));
    test::set_world(maker, 2.0f, kVisibleCamera);
    LightDesc sun;
    sun.name = "sun";
    sun.type = LightType::sun;
    sun.to_world = test::rotation_x(0.5f * kPi);  // from the south
    sun.power = Spectrum(3.0f);
    maker.builder.add_light(sun);
    const RenderScene world = maker.finish();
    const Vec3 inside(0.0f, 0.0f, -2.0f);
    const Spectrum sky = radiance(world, {inside, Vec3(0.0f, 0.0f, -1.0f)});
    EXPECT_EQ(sky, Spectrum(2.0f, 0.0f, 0.0f));
    const Spectrum wall = radiance(world, {inside, Vec3(0.0f, 1.0f, 0.0f)}, direct_only());
    EXPECT_GT(wall.x, 3.0f * 0.5f * kInvPi * 0.999f);
    EXPECT_EQ(Spectrum(0.0f, wall.y, wall.z), Spectrum(0.0f));
}

// ---- light that a vertex connects to

// A floor at z = 0 under a lamp at `height`, with a block whose top is at `top` down to the floor
// or below it.
RenderScene floor_in_a_block(float top, float bottom, float height, const Graph& graph) {
    SceneMaker maker;
    maker.add(test::square(2.5f), test::diffuse(0.5f));
    maker.add(test::block(3.0f, top - bottom), graph, test::translation({0, 0, top}));
    LightDesc light;
    light.name = "lamp";
    light.to_world = test::translation({0, 0, height});
    light.power = Spectrum(10.0f);
    maker.builder.add_light(light);
    return maker.finish();
}

TEST(Absorption, OnTheWayToALamp) {
    struct Case {
        const char* what;
        float top, bottom, height;
        double to_light, to_camera;  // m in the medium
    };
    const float x = 3.0f * 0.75f;  // from the camera to the left, where the floor is looked at
    for (const Case& c : {Case{"floor and lamp inside", 2.5f, -0.5f, 2.0f, 2.0, 2.5 / kCosine},
                          Case{"floor inside", 0.5f, -0.5f, 2.0f, 0.5, 0.5 / kCosine},
                          Case{"between", 1.5f, 0.5f, 2.0f, 1.0, 1.0 / kCosine},
                          Case{"lamp inside", 2.5f, 1.5f, 2.0f, 0.5, 1.0 / kCosine}}) {
        const double irradiance = 10.0 / (4.0 * std::numbers::pi) / 4.0;
        expect_left(radiance(floor_in_a_block(c.top, c.bottom, c.height, clear_block()),
                             test::ray_to({x, 0, 3}, {0, 0, 0}), direct_only()),
                    kSigma, c.to_light + c.to_camera, 0.5 / std::numbers::pi * irradiance, c.what);
    }
}

// ---- through casters

// A floor in water whose surface lies 0.8 m above it, under a lamp.
RenderScene floor_in_water(const Graph& water, float radius) {
    SceneMaker maker;
    maker.add(test::square(1.2f), test::diffuse(0.5f));
    maker.add(test::flat(test::square(1.5f)), water, test::translation({0, 0, 0.8f}));
    LightDesc light;
    light.name = "lamp";
    light.to_world = test::translation({0.3f, 0.1f, 2.2f});
    light.power = Spectrum(10.0f);
    light.radius = radius;
    light.visibility = kVisibleAll & ~uint32_t{kVisibleCamera};
    maker.builder.add_light(light);
    return maker.finish();
}

// The only chain goes straight up. Whether walks find it, and after how many trials, does not
// depend on what is absorbed.
TEST(Absorption, OfAChain) {
    const Graph water = test::glass(1.33f);
    const RenderScene clear = floor_in_water(water, 0.0f),
                      coloured = floor_in_water(test::absorbing(water, kSigma), 0.0f);
    IntegratorSettings settings = test::unlimited(test::unbiased_manifold());
    settings.limits.total = 1;
    const Ray ray = test::ray_to({0.9f, 0.1f, 0.45f}, {0.3f, 0.1f, 0.0f});
    int found = 0;
    for (uint32_t i = 0; i < 100; ++i) {
        PathStats stats;
        const auto sample = [&](const RenderScene& world) {
            return path_radiance(world, settings, {}, ray, Vec2(0.5f), Sampler(1, i, 0), stats).radiance;
        };
        const Spectrum full = sample(clear);
        if (is_black(full)) continue;
        ++found;
        expect_left(sample(coloured) * (1.0f / full.x), kSigma, 0.75 + 0.8, 1.0, "chain");
    }
    EXPECT_GT(found, 10);
}

// From above the water, where light paths do not find what the camera sees.
TEST(AbsorptionSlow, IsTheSameForWalksAndForPathTracing) {
    const RenderScene world =
        floor_in_water(test::absorbing(test::glass(1.33f), Spectrum(0.2f, 0.7f, 2.0f)), 0.35f);
    const Ray ray = test::ray_to({1.0f, 0.2f, 2.0f}, {0.4f, 0.2f, 0.8f});
    IntegratorSettings traced = test::unlimited();
    traced.limits.total = 2;  // into the water, at the floor: lit through the surface
    IntegratorSettings walked = traced;
    walked.manifold = test::unbiased_manifold();
    const test::RadianceEstimate a = test::estimate(world, traced, 400000, ray),
                                 b = test::estimate(world, walked, 200000, ray, 2);
    EXPECT_TRUE(test::same_mean(a.radiance, b.radiance, 1e-3));
    EXPECT_GT(b.caustics.mean(), 0.2 * b.radiance.mean());
    EXPECT_LT(std::hypot(a.radiance.standard_error(), b.radiance.standard_error()),
              0.03 * a.radiance.mean());
}

// ---- who takes part

TEST(Absorption, OfObjectsThatSomeRaysDoNotSeeIsLeftOutAndReported) {
    SceneMaker maker;
    Instance instance;
    instance.name = "ghost";
    instance.mesh = maker.builder.add_mesh(test::block(3.0f, 0.6f));
    instance.materials = {maker.builder.add_material(clear_block())};
    instance.visibility = kVisibleAll & ~uint32_t{kVisibleShadow};
    maker.builder.add_instance(instance);
    test::set_world(maker, 2.0f);
    const RenderScene world = maker.finish();
    EXPECT_EQ(radiance(world, slanting(0.0f)), Spectrum(2.0f));
    EXPECT_TRUE(world.scene->absorbing.empty());
    EXPECT_THAT(world.scene->report,
                testing::Contains(testing::AllOf(testing::HasSubstr("ghost"),
                                                 testing::HasSubstr("volume has no effect"))));
}

}  // namespace
}  // namespace spc
