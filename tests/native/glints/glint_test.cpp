// SPDX-License-Identifier: GPL-3.0-or-later
// Glints against path tracing of the same map, in the far field, where both estimate the same.
#include "support/glints.h"
#include "support/power.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace spc {
namespace {

using test::GlintFloor;
using test::SceneMaker;

constexpr double kFamily = 1e-3;  // probability that any comparison of a test fails by chance

struct Case {
    const char* name;
    GlintFloor floor;
    FilterKind filter = FilterKind::blackman_harris;
};

Graph glossy(float roughness, const char* distribution = "GGX", const Vec2& repeat = {1, 1}) {
    return test::normal_mapped(test::single_shader("bsdf_glossy",
                                                   {{1, "Color", {1, 0.8f, 0.6f, 1}},
                                                    {1, "Roughness", {roughness, 0, 0, 0}}},
                                                   {{1, "distribution", distribution}}),
                               repeat);
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

// As large as the real one is seen, of different strengths.
void several_suns(SceneMaker& maker) {
    for (const float x : {-0.35f, 0.0f, 0.2f, 0.4f})
        maker.builder.add_light(test::sun_towards({x - 0.5f, 0.2f, 1.0f}, 0.009f, 1.0f + x));
}

// The same sun, and on the camera's way a pane of glass that is tilted to it.
std::function<void(SceneMaker&)> sun_and_pane(float view_angle) {
    return [=](SceneMaker& maker) {
        const Vec3 at = Vec3(0.0f, -std::sin(view_angle), std::cos(view_angle)) * 2.0f;
        maker.add(test::block(0.5f, 0.05f), test::glass(1.5f),
                  test::rotation_x(view_angle + 0.3f, at));
        sun(0.1f)(maker);
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

// A world from an image: grey, with a bright spot or without, or a third of it alone. An even one
// is left to closures, the others are sampled as lights.
std::function<void(SceneMaker&)> sky(float spot, bool third = false) {
    return [=](SceneMaker& maker) {
        constexpr uint32_t kWidth = 64, kHeight = 32;
        std::vector<float> texels(size_t{kWidth} * kHeight * 3, 1.0f);
        for (size_t i = 0; i < texels.size(); ++i)
            if (third && (i / 3 + 4) % kWidth > kWidth / 3) texels[i] = 0.0f;
        for (size_t i = 0; i < 3; ++i) texels[(size_t{26} * kWidth + 27) * 3 + i] += spot;
        test::set_world(maker, texels, kWidth, kHeight);
    };
}

Image bumps() { return test::plane_normals(128, 4.0 / 128, 0.2, 5); }
Image heights() { return test::plane_heights(128, 128, 5.0 / 128, 0.2, 5); }

Graph metal(const Vec3& color) {
    return test::normal_mapped(
        test::single_shader("bsdf_principled",
                            {{1, "Base Color", {color.x, color.y, color.z, 1}},
                             {1, "Metallic", {1, 0, 0, 0}},
                             {1, "Roughness", {0.3f, 0, 0, 0}}},
                            {{1, "distribution", "MULTI_GGX"}}),
        {1, 1});
}
const Vec3 kGold(0.9f, 0.7f, 0.3f);

Graph plastic() { return test::normal_mapped(test::principled(0.3f, 0.25f), {1, 1}); }

std::vector<Case> cases() {
    const Image scratches = test::normal_image(128, 96, [](double u, double v) {
        return Vec2(float(0.3 * std::sin(400.0 * u)), float(0.02 * std::cos(90.0 * v)));
    });
    Graph weak = glossy(0.25f);
    weak.inputs.push_back({2, "Strength", {0.6f, 0, 0, 0}});
    Graph placed = glossy(0.25f);
    placed.inputs.push_back({4, "Rotation", {0, 0, 0.7f, 0}});
    placed.inputs.push_back({4, "Location", {0.3f, -0.8f, 0, 0}});
    Graph tiled = glossy(0.25f, "GGX", {1.5f, 3.5f});
    tiled.inputs.push_back({4, "Rotation", {0, 0, 0.7f, 0}});
    return {
        {"sun on GGX", {glossy(0.25f), bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"sun on Beckmann", {glossy(0.3f, "BECKMANN"), bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"sun on metal", {metal(kGold), bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"sun on plastic", {plastic(), bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"few texels", {glossy(0.25f), bumps(), 1.5, 0.6f, sun(0.1f)}},
        {"many texels", {glossy(0.25f), bumps(), 30.0, 0.6f, sun(0.1f)}},
        {"grazing", {glossy(0.3f), bumps(), 8.0, 1.3f, sun(0.1f)}},
        {"grazing on metal", {metal(kGold), bumps(), 8.0, 1.3f, sun(0.1f)}},
        {"from behind",
         {glossy(0.25f), bumps(), 8.0, 2.6f,
          [](SceneMaker& maker) {
              maker.builder.add_light(test::sun_towards({0.1f, -0.2f, -1.0f}, 0.1f, 1.0f));
          }}},
        {"scratches", {glossy(0.25f), scratches, 12.0, 0.6f, sun(0.1f)}},
        {"weak map", {weak, bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"placed map", {placed, bumps(), 12.0, 0.6f, sun(0.1f)}},
        {"tiled map", {tiled, bumps(), 6.0, 0.6f, sun(0.1f)}},
        {"through a pane", {glossy(0.25f), bumps(), 12.0, 0.6f, sun_and_pane(0.6f)}},
        {"out of focus",
         {glossy(0.25f), bumps(), 12.0, 0.6f, sun(0.1f), Projection::perspective, 0.3f}},
        {"orthographic", {glossy(0.25f), bumps(), 12.0, 0.6f, sun(0.1f), Projection::orthographic}},
        {"box filter", {glossy(0.25f), bumps(), 12.0, 0.6f, sun(0.1f)}, FilterKind::box},
        {"Gaussian filter", {glossy(0.25f), bumps(), 12.0, 0.6f, sun(0.1f)}, FilterKind::gaussian},
        {"several suns", {glossy(0.25f), bumps(), 12.0, 0.6f, several_suns}},
        {"ball", {glossy(0.25f), bumps(), 12.0, 0.6f, lamp(LightType::point, 5.0f)}},
        {"spot", {glossy(0.25f), bumps(), 12.0, 0.6f, lamp(LightType::spot, 5.0f)}},
        {"point", {glossy(0.3f), bumps(), 12.0, 0.6f, lamp(LightType::point, 0.0f)}},
        {"area", {glossy(0.25f), bumps(), 12.0, 0.6f, lamp(LightType::area, 5.0f)}},
        {"wide area", {glossy(0.2f), bumps(), 12.0, 0.6f, lamp(LightType::area, 60.0f)}},
        {"sky with a spot", {glossy(0.2f), bumps(), 12.0, 0.6f, sky(500.0f)}},
        {"a third of the sky", {glossy(0.2f), bumps(), 12.0, 0.6f, sky(0.0f, true)}},
    };
}

std::vector<Case> bump_cases() {
    Graph tiled = raised(0.25f, 1.0f, -0.8f, {1.5f, 3.5f});
    tiled.inputs.push_back({4, "Rotation", {0, 0, 0.7f, 0}});
    return {{"bump", {raised(0.25f), heights(), 12.0, 0.6f, sun(0.1f)}},
            {"weak bump", {raised(0.25f, 0.4f, 5.0f), heights(), 12.0, 0.6f, sun(0.1f)}},
            {"tiled bump", {tiled, heights(), 6.0, 0.6f, sun(0.1f)}},
            {"bump from behind",
             {raised(0.25f), heights(), 8.0, 2.6f, [](SceneMaker& maker) {
                  maker.builder.add_light(test::sun_towards({0.1f, -0.2f, -1.0f}, 0.1f, 1.0f));
              }}}};
}

// Over paint without a reflection of its own; over metal on the same map, which the tinted coat
// dims by the normal of each place; and flat over metal that glints.
std::vector<Case> coat_cases() {
    const Image bumps = test::plane_normals(128, 4.0 / 128, 0.2, 5);
    const auto mapped = [](float metallic, float ior, float coat_roughness, bool coat_mapped) {
        Graph graph = test::normal_mapped(test::principled(metallic, 0.3f), {1, 1});
        graph.inputs.push_back({1, "IOR", {ior, 0, 0, 0}});
        graph.inputs.push_back({1, "Coat Tint", {0.7f, 0.5f, 0.9f, 1}});
        return test::coated(graph, coat_roughness, coat_mapped);
    };
    Graph paint = mapped(0.0f, 1.0f, 0.2f, true);
    std::erase_if(paint.links, [](const GraphLink& link) { return link.to_socket == "Normal"; });
    const Graph metal = mapped(1.0f, 1.5f, 0.2f, true);
    return {
        {"coat over paint", {paint, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"coat and metal", {metal, bumps, 12.0, 0.6f, sun(0.1f)}},
        {"coat and metal, grazing", {metal, bumps, 8.0, 1.3f, sun(0.1f)}},
        {"coat and plastic", {mapped(0.0f, 1.5f, 0.25f, true), bumps, 12.0, 0.6f, sun(0.1f)}},
        {"flat coat over metal", {mapped(1.0f, 1.5f, 0.2f, false), bumps, 12.0, 0.6f, sun(0.1f)}},
        {"smooth coat over metal", {mapped(1.0f, 1.5f, 0.0f, false), bumps, 12.0, 0.6f, sun(0.1f)}}};
}

struct Comparison {
    test::PixelEstimate on, off;
    double error, z;                   // of the mean of the channels
    std::array<double, 3> z_channels;  // which have their noise in common
};
double z_of(const test::MeanEstimate& a, const test::MeanEstimate& b) {
    return (a.mean() - b.mean()) / std::hypot(a.standard_error(), b.standard_error());
}
Comparison compare(const std::string& name, const RenderScene& on, const RenderScene& off,
                   FilterKind filter, uint32_t samples, uint32_t reference_samples) {
    Comparison c{test::estimate_pixel(on, test::unlimited(), samples, 1, filter),
                 test::path_traced_pixel(name, off, reference_samples, 2, filter),
                 0.0,
                 0.0,
                 {}};
    c.error = std::hypot(c.on.radiance.standard_error(), c.off.radiance.standard_error());
    c.z = z_of(c.on.radiance, c.off.radiance);
    for (size_t k = 0; k < 3; ++k) c.z_channels[k] = z_of(c.on.channels[k], c.off.channels[k]);
    return c;
}
Comparison compare(const std::string& name, const GlintFloor& floor, FilterKind filter,
                   uint32_t samples, uint32_t reference_samples, bool mirrored = false) {
    return compare(name, test::finish(floor, GlintsMode::on, mirrored),
                   test::finish(floor, GlintsMode::off, mirrored), filter, samples,
                   reference_samples);
}

// Of a |z| as large by chance.
double p_value(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }
double least_p_value(const Comparison& c) {
    double least = 1.0;
    for (const double z : c.z_channels) least = std::min(least, p_value(z));
    return least;
}

// Hypothesis: both have the same mean, in each channel.
void expect_agreement(const std::vector<Case>& all) {
    constexpr uint32_t kReference = 400000;
    const auto samples = test::power(4000u, 8000u);
    const double significance = test::sidak(kFamily, 2 * 3 * int(all.size()));
    for (const Case& c : all)
        for (const bool mirrored : {false, true}) {
            const std::string name = std::string(c.name) + (mirrored ? ", in a mirror" : "");
            const Comparison result =
                compare(name, c.floor, c.filter, samples, kReference, mirrored);
            EXPECT_GT(least_p_value(result), significance)
                << name << ": " << result.on.radiance.mean() << " and "
                << result.off.radiance.mean() << " +- " << result.error << ", z of the channels "
                << ::testing::PrintToString(result.z_channels);
            EXPECT_LT(result.error, 0.02 * result.on.radiance.mean())
                << name << ": too little power";
            EXPECT_GT(result.on.stats.glints.estimates, samples / 3) << name;
            EXPECT_EQ(result.off.stats.glints.estimates, 0u) << name;
        }
}

TEST(GlintsSlow, AgreeWithPathTracing) { expect_agreement(cases()); }
TEST(GlintsSlow, AgreeWithPathTracingOnBumps) { expect_agreement(bump_cases()); }
TEST(GlintsSlow, AgreeWithPathTracingUnderCoats) { expect_agreement(coat_cases()); }

// Its twin: the comparison notices a sun that is 8 % brighter, on a normal map and on a bump.
TEST(GlintsSlow, ComparisonNoticesALittleLight) {
    const double significance = test::sidak(kFamily, 2 * 3 * int(cases().size()));
    for (const Case& c : {cases()[0], bump_cases()[0]}) {
        GlintFloor floor = c.floor;
        const auto on =
            test::estimate_pixel(test::finish(floor, GlintsMode::on), test::unlimited(), 20000, 1);
        floor.light = sun(0.1f, 1.08f);
        const auto off =
            test::path_traced_pixel(c.name, test::finish(floor, GlintsMode::off), 200000, 2);
        EXPECT_LT(p_value(z_of(on.radiance, off.radiance)), significance) << c.name;
    }
}

// Another twin: a tint whose red and green are swapped, of which the mean of the channels knows
// nothing.
TEST(GlintsSlow, ComparisonNoticesASwappedTint) {
    const auto floor = [](const Vec3& color) {
        return GlintFloor{metal(color), bumps(), 12.0, 0.6f, sun(0.1f)};
    };
    const Comparison c = compare("swapped", test::finish(floor(kGold), GlintsMode::on),
                                 test::finish(floor({kGold.y, kGold.x, kGold.z}), GlintsMode::off),
                                 FilterKind::blackman_harris, 8000, 200000);
    EXPECT_LT(std::abs(c.z), 4.0);
    EXPECT_LT(least_p_value(c), test::sidak(kFamily, 2 * 3 * int(cases().size())));
}

// What it is for: a hundredth of the variance for each sample, under a sun of half a degree and
// with a lobe as narrow as the light.
TEST(Glints, HaveLittleNoise) {
    GlintFloor floor = cases()[0].floor;
    floor.light = sun(0.009f);
    const Comparison c = compare("a narrow sun", floor, FilterKind::blackman_harris, 4000, 40000);
    EXPECT_LT(c.on.radiance.standard_error() * std::sqrt(4000.0), 0.5 * c.on.radiance.mean());
    EXPECT_LT(c.on.radiance.standard_error() * std::sqrt(4000.0),
              0.1 * c.off.radiance.standard_error() * std::sqrt(40000.0));
}

// However closely a sample looks, it has the same mean: of several lamps, among which it chooses.
// Four estimates take most of the noise of one away, and what may be left to chance costs less.
TEST(GlintsSlow, SamplingChangesNoiseAlone) {
    constexpr uint32_t kSamples = 12000;
    GlintFloor floor = cases()[0].floor;
    floor.light = [](SceneMaker& maker) {
        for (const float x : {-0.35f, 0.0f, 0.2f, 0.4f})
            maker.builder.add_light(test::sun_towards({x - 0.5f, 0.2f, 1.0f}, 0.02f, 1.0f + x));
    };
    const RenderScene world = test::finish(floor, GlintsMode::on);
    const auto with = [&](uint32_t seed, const GlintSampling& sampling) {
        return test::estimate_pixel(world, test::unlimited(), kSamples, seed,
                                    FilterKind::blackman_harris, sampling);
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

// Under an even sky there is nothing to find, and nothing to lose, be it from an image or not: rays
// alone find it.
TEST(GlintsSlow, FurnaceUnderAnEvenSky) {
    struct Furnace {
        const char* name;
        Graph material;
        Image map;
    };
    const std::vector<Furnace> furnaces{{"GGX", glossy(0.2f), bumps()},
                                        {"Beckmann", glossy(0.2f, "BECKMANN"), bumps()},
                                        {"metal", metal(kGold), bumps()},
                                        {"plastic", plastic(), bumps()},
                                        {"bump", raised(0.25f), heights()}};
    const std::function<void(SceneMaker&)> uniform = [](SceneMaker& maker) {
        test::set_world(maker, 1.0f);
    };
    constexpr std::array<double, 3> kTexels{2.0, 12.0, 30.0};
    const double significance = test::sidak(kFamily, int(2 * 3 * furnaces.size() * kTexels.size()));
    for (const Furnace& f : furnaces)
        for (const double texels : kTexels) {
            GlintFloor floor{f.material, f.map, texels, 0.6f, uniform};
            const RenderScene off = test::finish(floor, GlintsMode::off);
            for (const bool is_image : {true, false}) {
                floor.light = is_image ? sky(0.0f) : uniform;
                const std::string name =
                    fmt::format("{}{}, {}", f.name, is_image ? "" : ", uniform", texels);
                const Comparison c = compare(name, test::finish(floor, GlintsMode::on), off,
                                             FilterKind::blackman_harris, 20000, 100000);
                EXPECT_GT(least_p_value(c), significance)
                    << name << ": " << c.on.radiance.mean() << " and " << c.off.radiance.mean();
                EXPECT_LT(c.error, 0.004) << name << ": too little power";
                EXPECT_EQ(c.on.stats.glints.estimates, 0u) << name;
            }
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

// Nearer than that the map is seen as it is.
TEST(Glints, NoneWhereAPixelIsAFifthOfATexel) {
    GlintFloor floor = cases()[0].floor;
    floor.pixel_texels = 0.2;
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
