// SPDX-License-Identifier: GPL-3.0-or-later
// Glints against path tracing of the same map, in the far field, where both estimate the same.
#include "support/glints.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::GlintFloor;
using test::SceneMaker;

constexpr double kFamily = 1e-3;  // chance that any comparison of a test fails by chance

struct Case {
    const char* name;
    GlintFloor floor;
    FilterKind filter = FilterKind::blackman_harris;
};

Graph glossy(float roughness, const char* distribution = "GGX") {
    return test::normal_mapped(test::single_shader("bsdf_glossy",
                                                   {{1, "Color", {1, 0.8f, 0.6f, 1}},
                                                    {1, "Roughness", {roughness, 0, 0, 0}}},
                                                   {{1, "distribution", distribution}}),
                               {1, 1});
}

// Waves over the floor, 2 m wide, of the slopes that a normal map of the same waves would have.
Graph raised(float roughness, float strength = 1.0f, float distance = 2.0f,
             const Vec2& repeat = {1, 1}) {
    Graph graph = test::bump_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}}), repeat,
        distance);
    graph.inputs.push_back({2, "Strength", {strength, 0, 0, 0}});
    return graph;
}

std::function<void(SceneMaker&)> sun(float angle, float irradiance = 1.0f) {
    return [=](SceneMaker& maker) {
        maker.builder.add_light(test::sun_towards({-0.5f, 0.2f, 1.0f}, angle, irradiance));
    };
}

std::function<void(SceneMaker&)> lamp(LightType type, float radius) {
    return [=](SceneMaker& maker) {
        LightDesc light;
        light.name = "lamp";
        light.type = type;
        const Frame frame = Frame::around(normalize(Vec3(-0.5f, 0.2f, 1.0f)));
        for (int i = 0; i < 3; ++i)
            light.to_world.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
        light.to_world.translation = Vec3(-0.5f, 0.2f, 1.0f) * 100.0f;
        light.power = Spectrum(1e5f);
        light.radius = radius;
        light.size = Vec2(2.0f * radius, 2.0f * radius);
        light.spot_angle = 1.0f;
        maker.builder.add_light(light);
    };
}

// A world from an image, so that it is sampled as a light: grey, with a bright spot or without.
std::function<void(SceneMaker&)> sky(float spot) {
    return [spot](SceneMaker& maker) {
        constexpr uint32_t kWidth = 64, kHeight = 32;
        std::vector<float> texels(size_t{kWidth} * kHeight * 3, 1.0f);
        for (size_t i = 0; i < 3; ++i) texels[(size_t{26} * kWidth + 27) * 3 + i] += spot;
        const uint32_t image = maker.builder.add_image(image_from_floats(
            "sky", texels, kWidth, kHeight, 3, ColorSpace::linear, AlphaMode::none));
        Graph graph = test::background(1, 1, 1);
        graph.nodes.push_back({"Sky", "environment_texture", image});
        graph.links.push_back({2, "Color", 1, "Color"});
        maker.builder.set_environment({maker.builder.add_material(graph), kVisibleAll, true});
    };
}

std::vector<Case> cases() {
    const Image bumps = test::plane_normals(128, 4.0 / 128, 0.2, 5);
    const Image scratches = test::normal_image(128, 96, [](double u, double v) {
        return Vec2(float(0.3 * std::sin(400.0 * u)), float(0.02 * std::cos(90.0 * v)));
    });
    const Graph metal =
        test::normal_mapped(test::single_shader("bsdf_principled",
                                                {{1, "Base Color", {0.9f, 0.7f, 0.3f, 1}},
                                                 {1, "Metallic", {1, 0, 0, 0}},
                                                 {1, "Roughness", {0.3f, 0, 0, 0}}},
                                                {{1, "distribution", "MULTI_GGX"}}),
                            {1, 1});
    const Graph plastic = test::normal_mapped(test::principled(0.3f, 0.25f), {1, 1});
    Graph weak = glossy(0.25f);
    weak.inputs.push_back({2, "Strength", {0.6f, 0, 0, 0}});
    Graph placed = glossy(0.25f);
    placed.inputs.push_back({4, "Rotation", {0, 0, 0.7f, 0}});
    placed.inputs.push_back({4, "Location", {0.3f, -0.8f, 0, 0}});
    return {
        {"sun on GGX", {glossy(0.25f), bumps, 12.0, 0.6f, sun(0.1f)}},
        {"sun on Beckmann", {glossy(0.3f, "BECKMANN"), bumps, 12.0, 0.6f, sun(0.1f)}},
        {"sun on metal", {metal, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"sun on plastic", {plastic, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"few texels", {glossy(0.25f), bumps, 1.5, 0.6f, sun(0.1f)}},
        {"many texels", {glossy(0.25f), bumps, 30.0, 0.6f, sun(0.1f)}},
        {"grazing", {glossy(0.3f), bumps, 8.0, 1.3f, sun(0.1f)}},
        {"from behind",
         {glossy(0.25f), bumps, 8.0, 2.6f,
          [](SceneMaker& maker) {
              maker.builder.add_light(test::sun_towards({0.1f, -0.2f, -1.0f}, 0.1f, 1.0f));
          }}},
        {"scratches", {glossy(0.25f), scratches, 12.0, 0.6f, sun(0.1f)}},
        {"weak map", {weak, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"placed map", {placed, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"box filter", {glossy(0.25f), bumps, 12.0, 0.6f, sun(0.1f)}, FilterKind::box},
        {"Gaussian filter", {glossy(0.25f), bumps, 12.0, 0.6f, sun(0.1f)}, FilterKind::gaussian},
        {"ball", {glossy(0.25f), bumps, 12.0, 0.6f, lamp(LightType::point, 5.0f)}},
        {"spot", {glossy(0.25f), bumps, 12.0, 0.6f, lamp(LightType::spot, 5.0f)}},
        {"point", {glossy(0.3f), bumps, 12.0, 0.6f, lamp(LightType::point, 0.0f)}},
        {"area", {glossy(0.25f), bumps, 12.0, 0.6f, lamp(LightType::area, 5.0f)}},
        {"wide area", {glossy(0.2f), bumps, 12.0, 0.6f, lamp(LightType::area, 60.0f)}},
        {"sky with a spot", {glossy(0.2f), bumps, 12.0, 0.6f, sky(500.0f)}},
        {"even sky", {glossy(0.2f), bumps, 12.0, 0.6f, sky(0.0f)}},
    };
}

std::vector<Case> bump_cases() {
    const Image heights = test::plane_heights(128, 128, 5.0 / 128, 0.2, 5);
    Graph tiled = raised(0.25f, 1.0f, -0.8f, {1.5f, 3.5f});
    tiled.inputs.push_back({4, "Rotation", {0, 0, 0.7f, 0}});
    return {{"bump", {raised(0.25f), heights, 12.0, 0.6f, sun(0.1f)}},
            {"weak bump", {raised(0.25f, 0.4f, 5.0f), heights, 12.0, 0.6f, sun(0.1f)}},
            {"tiled bump", {tiled, heights, 6.0, 0.6f, sun(0.1f)}},
            {"bump from behind",
             {raised(0.25f), heights, 8.0, 2.6f, [](SceneMaker& maker) {
                  maker.builder.add_light(test::sun_towards({0.1f, -0.2f, -1.0f}, 0.1f, 1.0f));
              }}}};
}

struct Comparison {
    test::PixelEstimate on, off;
    double error, z;
};
Comparison compare(const GlintFloor& floor, FilterKind filter, uint32_t samples,
                   uint32_t reference_samples, bool mirrored = false) {
    Comparison c{test::estimate_pixel(test::finish(floor, GlintsMode::on, mirrored),
                                      test::unlimited(), samples, 1, filter),
                 test::estimate_pixel(test::finish(floor, GlintsMode::off, mirrored),
                                      test::unlimited(), reference_samples, 2, filter),
                 0.0, 0.0};
    const test::MeanEstimate &a = c.on.radiance, &b = c.off.radiance;
    c.error = std::hypot(a.standard_error(), b.standard_error());
    c.z = (a.mean() - b.mean()) / c.error;
    return c;
}

// Hypothesis: both have the same mean.
void expect_agreement(const std::vector<Case>& all) {
    constexpr uint32_t kSamples = 8000, kReference = 400000;
    const double significance = test::sidak(kFamily, 2 * int(all.size()));
    for (const Case& c : all)
        for (const bool mirrored : {false, true}) {
            const Comparison result = compare(c.floor, c.filter, kSamples, kReference, mirrored);
            const std::string name = std::string(c.name) + (mirrored ? ", in a mirror" : "");
            EXPECT_GT(std::erfc(std::abs(result.z) / std::sqrt(2.0)), significance)
                << name << ": " << result.on.radiance.mean() << " and "
                << result.off.radiance.mean() << " +- " << result.error;
            EXPECT_LT(result.error, 0.02 * result.on.radiance.mean())
                << name << ": too little power";
            EXPECT_GT(result.on.stats.glints.estimates, kSamples / 3) << name;
            EXPECT_EQ(result.off.stats.glints.estimates, 0u) << name;
        }
}

TEST(GlintsSlow, AgreeWithPathTracing) { expect_agreement(cases()); }
TEST(GlintsSlow, AgreeWithPathTracingOnBumps) { expect_agreement(bump_cases()); }

// Its twin: the comparison notices a sun that is 8 % brighter, on a normal map and on a bump.
TEST(Glints, ComparisonNoticesALittleLight) {
    const double significance = test::sidak(kFamily, 2 * int(cases().size()));
    for (const Case& c : {cases()[0], bump_cases()[0]}) {
        GlintFloor floor = c.floor;
        const auto on =
            test::estimate_pixel(test::finish(floor, GlintsMode::on), test::unlimited(), 20000, 1);
        floor.light = sun(0.1f, 1.08f);
        const auto off = test::estimate_pixel(test::finish(floor, GlintsMode::off),
                                              test::unlimited(), 200000, 2);
        const double z = (on.radiance.mean() - off.radiance.mean()) /
                         std::hypot(on.radiance.standard_error(), off.radiance.standard_error());
        EXPECT_LT(std::erfc(std::abs(z) / std::sqrt(2.0)), significance) << c.name;
    }
}

// What it is for: a hundredth of the variance for each sample, under a sun of half a degree and
// with a lobe as narrow as the light.
TEST(Glints, HaveLittleNoise) {
    GlintFloor floor = cases()[0].floor;
    floor.light = sun(0.009f);
    const Comparison c = compare(floor, FilterKind::blackman_harris, 4000, 40000);
    EXPECT_LT(c.on.radiance.standard_error() * std::sqrt(4000.0), 0.5 * c.on.radiance.mean());
    EXPECT_LT(c.on.radiance.standard_error() * std::sqrt(4000.0),
              0.1 * c.off.radiance.standard_error() * std::sqrt(40000.0));
}

// However closely a sample looks, it has the same mean: of several lamps, among which it chooses.
// Four estimates take most of the noise of one away, and what may be left to chance costs less.
TEST(Glints, EffortChangesNoiseAlone) {
    constexpr uint32_t kSamples = 12000;
    GlintFloor floor = cases()[0].floor;
    floor.light = [](SceneMaker& maker) {
        for (const float x : {-0.35f, 0.0f, 0.2f, 0.4f})
            maker.builder.add_light(test::sun_towards({x - 0.5f, 0.2f, 1.0f}, 0.02f, 1.0f + x));
    };
    const RenderScene world = test::finish(floor, GlintsMode::on);
    const auto with = [&](uint32_t seed, const GlintEffort& effort) {
        return test::estimate_pixel(world, test::unlimited(), kSamples, seed,
                                    FilterKind::blackman_harris, effort);
    };
    const test::PixelEstimate once = with(1, {}), often = with(2, {4, 0.0f}),
                              roughly = with(3, {1, float(once.radiance.mean())});
    const double significance = test::sidak(kFamily, 2);
    EXPECT_TRUE(same_mean(often.radiance, once.radiance, significance));
    EXPECT_TRUE(same_mean(roughly.radiance, once.radiance, significance));
    EXPECT_LT(once.radiance.standard_error(), 0.01 * once.radiance.mean()) << "too little power";
    EXPECT_LT(often.radiance.standard_error(), 0.6 * once.radiance.standard_error());
    EXPECT_LT(roughly.radiance.standard_error(), 2.0 * once.radiance.standard_error());
    EXPECT_LT(double(roughly.stats.glints.points), 0.9 * double(once.stats.glints.points));
}

// Under an even sky there is nothing to find, and nothing to lose.
TEST(GlintsSlow, FurnaceUnderAnEvenSky) {
    for (const double texels : {2.0, 12.0, 30.0}) {
        GlintFloor floor = cases().back().floor;
        floor.pixel_texels = texels;
        const Comparison c = compare(floor, FilterKind::blackman_harris, 60000, 40000);
        EXPECT_LT(std::abs(c.z), 4.0)
            << texels << ": " << c.on.radiance.mean() << " and " << c.off.radiance.mean();
        EXPECT_LT(c.error, 0.003) << "too little power";
    }
}

TEST(Glints, WithoutAPixelThereAreNone) {
    const RenderScene world = test::finish(cases()[0].floor, GlintsMode::on);
    const Ray ray = world.scene->camera.ray(0.5f, 0.5f, Vec2(0.5f));
    PathStats stats;
    for (uint32_t i = 0; i < 100; ++i)
        path_radiance(world, test::unlimited(), {}, ray, Vec2(0.5f), Sampler(1, i, 0), stats);
    EXPECT_EQ(stats.glints.estimates, 0u);
}

// Nearer than a texel the map is seen as it is.
TEST(Glints, NoneWhereAPixelIsWithinATexel) {
    GlintFloor floor = cases()[0].floor;
    floor.pixel_texels = 0.5;
    const auto on =
        test::estimate_pixel(test::finish(floor, GlintsMode::on), test::unlimited(), 100, 1);
    EXPECT_EQ(on.stats.glints.estimates, 0u);
}

// Two materials with one map and strength share its field; one that nobody uses has none.
TEST(GlintSet, FieldsAreShared) {
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(32, 0.2, 0.2, 5));
    Graph strong = glossy(0.3f);
    strong.inputs.push_back({2, "Strength", {2, 0, 0, 0}});
    Graph unused = glossy(0.3f);
    unused.inputs.push_back({2, "Strength", {3, 0, 0, 0}});
    maker.builder.add_material(unused);
    for (const Graph& graph : {glossy(0.1f), glossy(0.2f), strong})
        maker.add(test::square(1.0f), graph);
    const RenderScene world = maker.finish();
    EXPECT_EQ(world.glints.fields.size(), 2u);
    EXPECT_EQ(world.glints.of_material, (std::vector<uint32_t>{kNone, 0, 0, 1}));
    EXPECT_GT(world.glints.memory_bytes(), 0u);
}

TEST(GlintSet, ReportsMapsThatPointInwards) {
    SceneMaker maker;
    const std::vector<float> texels(12, 0.4f);
    maker.builder.add_image(
        image_from_floats("inwards", texels, 2, 2, 3, ColorSpace::data, AlphaMode::none));
    maker.add(test::square(1.0f), glossy(0.2f));
    const RenderScene world = maker.finish();
    EXPECT_TRUE(world.glints.fields.empty());
    ASSERT_FALSE(world.scene->report.empty());
    EXPECT_EQ(world.scene->report.back(),
              "mapped bsdf_glossy: no glints: normals of image \"inwards\" point into the surface");
}

}  // namespace
}  // namespace spc
