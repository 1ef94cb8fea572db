// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold's estimate against brute-force path tracing, with one caster and with many.
#include "manifold/estimator.h"

#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kFamily = 1e-3;  // probability that a right estimator fails somewhere in a test

Transform shining_down_from(const Vec3& p) { return test::translation(p); }

LightDesc lamp(LightType type, float power) {
    LightDesc light;
    light.name = "lamp";
    light.type = type;
    light.to_world = shining_down_from(Vec3(0.9f, 0.2f, 2.5f));
    light.power = Spectrum(power);
    return light;
}

// Large enough for path tracing to find it.
LightDesc large_sphere() {
    LightDesc light = lamp(LightType::point, 100.0f);
    light.radius = 0.3f;
    return light;
}

// A diffuse floor with a mirror ball above it, and a sheet of glass between floor and light.
void add_floor_and_casters(SceneMaker& maker) {
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.add(test::sphere(24, 0.4), test::mirror(), test::translation(Vec3(-0.6f, 0.1f, 0.5f)));
    maker.add(test::square(0.6f), test::refraction(1.4f),
              test::rotation_x(0.3f, Vec3(0.4f, 0.0f, 0.6f)));
}

Ray camera_ray(uint32_t i) {
    Pcg pcg(i);
    return test::ray_to({0.0f, -3.0f, 2.0f}, {pcg.one() - 0.5f, 0.6f * pcg.one() - 0.3f, 0.0f});
}

// Frosted glass seen from below scatters what a sheet of clear glass above it refracts.
TEST(ManifoldEstimatorSlow, ReachesReceiversThroughTheirBack) {
    SceneMaker maker;
    maker.add(test::square(4.0f), test::refraction(1.3f, 0.4f), {}, CausticsRole::receiver);
    maker.add(test::square(4.0f), test::refraction(1.4f), test::translation(Vec3(0.0f, 0.0f, 0.6f)),
              CausticsRole::caster);
    LightDesc large = lamp(LightType::point, 100.0f);
    large.radius = 0.3f;
    maker.builder.add_light(large);
    const RenderScene world = maker.finish();
    const Ray from_below = test::ray_to({0.0f, -0.5f, -1.5f}, {0.3f, 0.1f, 0.0f});
    const test::MeanEstimate expected =
        test::path_traced("from below", world, test::unlimited(), 1000000, from_below);
    const test::RadianceEstimate actual =
        test::estimate(world, test::unlimited(test::unbiased_manifold()), 100000, from_below, 2);
    EXPECT_TRUE(test::same_mean(actual.radiance, expected, kFamily));
    EXPECT_GT(actual.caustics.mean(), 0.3 * actual.radiance.mean());
}

// The same comparison must notice when the manifold's share is wrong by a twentieth.
TEST(ManifoldEstimatorSlow, ComparisonNoticesAWrongShare) {
    // Under a sheet of glass all light is refracted.
    SceneMaker maker;
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.add(test::square(4.0f), test::refraction(1.4f), test::translation(Vec3(0.0f, 0.0f, 0.6f)));
    LightDesc large = lamp(LightType::point, 100.0f);
    large.radius = 0.2f;  // the manifold's share is large
    maker.builder.add_light(large);
    const RenderScene world = maker.finish();
    const Ray below = test::ray_to({0.0f, -1.0f, 0.4f}, {0.2f, 0.1f, 0.0f});
    const test::MeanEstimate expected =
        test::path_traced("under glass", world, test::unlimited(), 12000000, below);
    const test::RadianceEstimate actual =
        test::estimate(world, test::unlimited(test::unbiased_manifold()), 1000000, below, 2);
    EXPECT_TRUE(test::same_mean(actual.radiance, expected, kFamily));
    const double deviation = std::hypot(expected.standard_error(), actual.radiance.standard_error());
    EXPECT_GT(0.05 * actual.caustics.mean(), 5.0 * deviation);
}

// Lights without extent: the limit of small ones.
TEST(ManifoldEstimator, DeltaLightsAreTheLimitOfSmallOnes) {
    for (const LightType type : {LightType::point, LightType::spot, LightType::sun}) {
        test::MeanEstimate means[2];
        for (const bool delta : {false, true}) {
            LightDesc light = lamp(type, 50.0f);
            light.radius = delta ? 0.0f : 1e-3f;
            light.sun_angle = delta ? 0.0f : 1e-3f;
            light.spot_angle = 1.5f;
            SceneMaker maker;
            add_floor_and_casters(maker);
            maker.builder.add_light(light);
            const RenderScene world = maker.finish();
            means[delta] = test::estimate(world, test::unlimited(test::unbiased_manifold()), 40000,
                                          camera_ray, delta ? 1 : 2)
                               .caustics;
        }
        EXPECT_GT(means[1].mean(), 0.0);
        EXPECT_TRUE(test::same_mean(means[0], means[1], test::sidak(kFamily, 3))) << int(type);
    }
}

void add_many_mirrors(SceneMaker& maker, int count) {
    for (int i = 0; i < count; ++i) {
        Pcg pcg(uint64_t(i) + 100);
        const Vec3 p(4.0f * pcg.one() - 2.0f, 4.0f * pcg.one() - 2.0f, 0.15f + 0.5f * pcg.one());
        maker.add(test::sphere(12, 0.1), test::mirror(), test::translation(p));
    }
}

TEST(CasterChoice, FollowsItsProbabilities) {
    SceneMaker maker;
    add_many_mirrors(maker, 100);
    const RenderScene world = maker.finish();
    ASSERT_EQ(world.casters.casters.size(), 100u);
    const ChainEnd end{false, Vec3(0.5f, 0.0f, 3.0f), {}};
    for (const Vec3& x : {Vec3(0.0f), Vec3(1.5f, -1.0f, 0.3f), Vec3(9.0f, 0.0f, 0.0f)}) {
        const Vec3 ng(0, 0, 1);
        double sum = 0.0;
        std::vector<double> expected;
        for (uint32_t i = 0; i < 100; ++i) {
            expected.push_back(double(caster_probability(world.casters, i, x, {ng, false}, end)));
            sum += expected.back();
            // Only what lies wholly below the horizon may be left out.
            const Caster& caster = world.casters.casters[i];
            if (caster.center.z + caster.half_extent.z > x.z + 0.01f) {
                EXPECT_GT(expected.back(), 0.0) << i;
            }
        }
        EXPECT_NEAR(sum, 1.0, 1e-4);
        std::vector<int> counts(100, 0);
        constexpr int kDraws = 200000;
        for (int k = 0; k < kDraws; ++k) {
            const CasterChoice choice =
                choose_caster(world.casters, x, {ng, false}, end, (float(k) + 0.5f) / kDraws);
            ASSERT_NE(choice.index, kNone);
            EXPECT_FLOAT_EQ(choice.probability, float(expected[choice.index]));
            ++counts[choice.index];
        }
        for (uint32_t i = 0; i < 100; ++i)
            EXPECT_NEAR(counts[i], expected[i] * kDraws, 3.0 + 1e-3 * kDraws * expected[i]);
    }
}

TEST(ManifoldEstimatorSlow, ManyCastersAgreeWithPathTracing) {
    SceneMaker maker;
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    add_many_mirrors(maker, 60);
    maker.builder.add_light(large_sphere());
    const RenderScene world = maker.finish();
    const test::MeanEstimate expected =
        test::path_traced("many mirrors", world, test::unlimited(), 400000, camera_ray);
    const test::RadianceEstimate actual =
        test::estimate(world, test::unlimited(test::unbiased_manifold()), 200000, camera_ray, 2);
    EXPECT_TRUE(test::same_mean(actual.radiance, expected, kFamily));
    EXPECT_GT(actual.caustics.mean(), 1e-3 * actual.radiance.mean());
}

// Several delta closures on one normal share a chain; so do chains of a surface that lost some to a
// switch.
TEST(ManifoldEstimatorSlow, SharesOfSeveralLobesSumToOne) {
    const Graph two = test::combined(
        test::mirror(),
        test::single_shader("bsdf_glossy",
                            {{1, "Color", {0.9f, 0.6f, 0.3f, 1}}, {1, "Roughness", {0, 0, 0, 0}}}),
        0.5f);
    struct Case {
        const char* name;
        Graph graph;
        bool refractions;
    };
    for (const Case& c : {Case{"two mirrors", two, true},
                          Case{"glass without refraction", test::glass(2.0f), false}}) {
        SceneMaker maker;
        maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
        maker.add(test::square(0.5f), c.graph, test::rotation_x(-0.9f, Vec3(0.0f, 0.7f, 0.5f)));
        LightDesc large = lamp(LightType::point, 100.0f);  // so near that both densities are alike
        large.to_world = test::translation(Vec3(0.0f, -0.6f, 1.6f));
        large.radius = 0.4f;
        maker.builder.add_light(large);
        const RenderScene world = maker.finish();
        const Ray ray = test::ray_to({0.0f, -2.0f, 0.5f}, {0.0f, 0.25f, 0.0f});
        IntegratorSettings settings = test::unlimited();
        settings.manifold.refractions = c.refractions;
        const test::MeanEstimate expected = test::path_traced(c.name, world, settings, 400000, ray);
        settings.manifold = test::unbiased_manifold();
        settings.manifold.refractions = c.refractions;
        const test::RadianceEstimate actual = test::estimate(world, settings, 400000, ray, 2);
        EXPECT_TRUE(test::same_mean(actual.radiance, expected, kFamily)) << c.name;
        EXPECT_GT(actual.caustics.mean(), 1e-3 * actual.radiance.mean()) << c.name;
    }
}

// [Zeltner20 Alg. 3] loses what its walks miss, and nothing else: less than all, more with more
// walks.
TEST(ManifoldEstimatorSlow, BiasedComesFromBelow) {
    SceneMaker maker;
    add_floor_and_casters(maker);
    maker.builder.add_light(large_sphere());
    const RenderScene world = maker.finish();
    const auto caustics = [&](const ManifoldSettings& settings) {
        return test::estimate(world, test::unlimited(settings), 100000, camera_ray).caustics;
    };
    const test::MeanEstimate all = caustics(test::unbiased_manifold());
    double before = 0.0;
    for (const uint32_t walks : {1u, 4u, 16u}) {
        ManifoldSettings biased = test::unbiased_manifold();
        biased.biased = true;
        biased.set_size = walks;
        const test::MeanEstimate some = caustics(biased);
        const double noise = 4.0 * std::hypot(all.standard_error(), some.standard_error());
        EXPECT_LT(some.mean(), all.mean() + noise) << walks;
        EXPECT_GT(some.mean(), before) << walks;
        before = some.mean();
        if (walks == 1) {
            EXPECT_LT(some.mean(), 0.8 * all.mean());
        }
        if (walks == 16) {
            EXPECT_GT(some.mean(), 0.9 * all.mean());
        }
    }
}

// ---- MNEE seeds [Hanika15]

ManifoldSettings mnee_seeds(bool biased) {
    ManifoldSettings settings = test::unbiased_manifold();
    settings.finder = ChainFinder::mnee;
    settings.biased = biased;
    return settings;
}

// Light that comes by way of casters alone: a lamp that diffuse rays do not see.
struct CausticCase {
    const char* name;
    std::function<void(SceneMaker&)> add_casters;
    // Of the light: what is lost at least, and at most, without the path-traced remainder.
    double least_lost, most_lost;
    double notices;  // relative error of what is found that the comparison must notice
};
RenderScene under_a_lamp(const CausticCase& c) {
    SceneMaker maker;
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    c.add_casters(maker);
    LightDesc large = lamp(LightType::point, 100.0f);
    large.to_world = test::translation(Vec3(0.2f, -0.7f, 2.2f));
    large.radius = 0.5f;
    large.visibility = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;
    maker.builder.add_light(large);
    return maker.finish();
}
// From below the casters, so that nothing but the floor is seen.
Ray ray_under_casters(uint32_t i) {
    Pcg pcg(i);
    return test::ray_to({0.0f, -0.8f, 0.3f}, {pcg.one() - 0.5f, 0.5f * pcg.one() - 0.2f, 0.0f});
}
std::vector<CausticCase> caustic_cases() {
    const auto add = [](SceneMaker& maker, const Mesh& mesh, const Graph& graph,
                        const Transform& transform) {
        maker.add(mesh, graph, transform, CausticsRole::caster);
    };
    return {
        {"flat slab",
         [add](SceneMaker& m) {
             add(m, test::flat(test::square(4.0f)), test::refraction(1.5f),
                 test::translation({0, 0, 0.9f}));
             add(m, test::flat(test::square(4.0f)), test::refraction(1.5f),
                 test::rotation_x(kPi, {0, 0, 0.6f}));
         },
         0.0, 0.0, 0.05},
        {"glass ball",
         [add](SceneMaker& m) {
             add(m, test::sphere(24, 0.4), test::refraction(1.5f),
                 test::translation({0, 0.1f, 0.9f}));
         },
         0.02, 0.5, 0.3},
        {"mirror ball",
         [add](SceneMaker& m) {
             add(m, test::sphere(24, 0.4), test::mirror(), test::translation({0, 1.2f, 0.5f}));
         },
         0.0, 0.0, 0.2},
        {"normal-mapped mirror",
         [add](SceneMaker& m) {
             m.builder.add_image(test::plane_normals(128, 0.25, 0.1, 5));
             add(m,
                 test::with_uvs(
                     test::grid(
                         1, [](double u, double v) { return Vec3d(1.6 * u - 0.8, 1.6 * v - 0.8, 0); },
                         [](double, double) { return Vec3d(0, 0, 1); }),
                     1),
                 test::normal_mapped(test::mirror(), Vec2(1.0f, 1.0f)),
                 test::rotation_x(1.3f, {0.0f, 0.9f, 0.8f}));
         },
         0.5, 1.0, 0.8}};
}

TEST(ManifoldEstimatorSlow, MneeSeedsAgreeWithPathTracing) {
    const std::vector<CausticCase> cases = caustic_cases();
    constexpr uint32_t kSamples = 150000;
    const double significance = test::sidak(kFamily, int(cases.size()));
    const auto settings_for = [](const ManifoldSettings& manifold) {
        IntegratorSettings settings = test::unlimited(manifold);
        settings.limits.diffuse = 1;  // what comes after only adds noise
        return settings;
    };
    for (const CausticCase& c : cases) {
        const RenderScene world = under_a_lamp(c);
        const test::MeanEstimate truth =
            test::path_traced(c.name, world, settings_for({}), 10 * kSamples, ray_under_casters);
        const auto mean_of = [&](bool biased) {
            return test::estimate(world, settings_for(mnee_seeds(biased)), kSamples,
                                  ray_under_casters, 2);
        };
        const test::RadianceEstimate all = mean_of(false), some = mean_of(true);
        EXPECT_TRUE(test::same_mean(all.radiance, truth, significance)) << c.name;
        const double lost = 1.0 - some.radiance.mean() / truth.mean(),
                     noise = std::hypot(some.radiance.standard_error(), truth.standard_error()) /
                             truth.mean();
        std::cout << c.name << ": MNEE seeds find " << all.caustics.mean() / truth.mean()
                  << " of the light, without path tracing's remainder " << lost << " is lost, +- "
                  << noise << std::endl;
        EXPECT_GT(lost, c.least_lost - 4.0 * noise) << c.name;
        EXPECT_LT(lost, c.most_lost + 4.0 * noise) << c.name;
        // What the comparison would notice.
        EXPECT_GT(c.notices * all.caustics.mean(),
                  5.0 * std::hypot(all.radiance.standard_error(), truth.standard_error()))
            << c.name;
    }
}

// Under a slab a ring of light between two cones becomes a ring on the floor: I sin t dt = E r dr.
TEST(ManifoldEstimator, MneeSeedsGiveTheLightUnderASlabWithoutNoise) {
    constexpr double kPower = 100.0, kIor = 1.5, kThickness = 0.3, kHeight = 2.2;
    const Vec3 above(0.2f, -0.7f, 2.2f);
    SceneMaker maker;
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    caustic_cases()[0].add_casters(maker);
    LightDesc point = lamp(LightType::point, static_cast<float>(kPower));
    point.to_world = test::translation(above);
    maker.builder.add_light(point);
    const RenderScene world = maker.finish();
    for (const Vec3& x : {Vec3(0.3f, 0.1f, 0.0f), Vec3(-0.4f, 0.2f, 0.0f)}) {
        const test::RadianceEstimate found = test::estimate(
            world, test::unlimited(mnee_seeds(true)), 16, test::ray_to({0.0f, -0.8f, 0.3f}, x));
        const double r = std::hypot(double(x.x - above.x), double(x.y - above.y));
        const auto radius = [&](double t) {
            return (kHeight - kThickness) * std::tan(t) +
                   kThickness * std::sin(t) / std::sqrt(kIor * kIor - std::sin(t) * std::sin(t));
        };
        double low = 0.0, high = 1.5;
        for (int i = 0; i < 60; ++i)
            (radius(0.5 * (low + high)) < r ? low : high) = 0.5 * (low + high);
        constexpr double kStep = 1e-5;
        const double slope = (radius(low + kStep) - radius(low - kStep)) / (2.0 * kStep);
        const double irradiance = kPower / (4.0 * std::numbers::pi) * std::sin(low) / (r * slope);
        const double expected = 0.8 / std::numbers::pi * irradiance;
        EXPECT_NEAR(found.least, expected, 2e-4 * expected);
        EXPECT_NEAR(found.most, expected, 2e-4 * expected);
    }
}

}  // namespace
}  // namespace spc
