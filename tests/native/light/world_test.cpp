// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/bench.h"
#include "support/chi_square.h"

namespace spc::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr double kSignificance = 0.01;
constexpr int64_t kSamples = 100000;
const Vec3 kOrigin(0, 0, 0), kUp(0, 0, 1);

using Texels = std::vector<float>;  // RGB, bottom row first

Graph panorama_graph(uint32_t image) {
    Graph graph;
    graph.name = "world";
    graph.nodes = {{"Output", "output", kNone},
                   {"Background", "background", kNone},
                   {"Sky", "environment_texture", image}};
    graph.links = {{1, "Background", 0, "Surface"}, {2, "Color", 1, "Color"}};
    return graph;
}

void add_panorama(SceneMaker& maker, const Texels& texels, uint32_t width, uint32_t height,
                  bool feeds_caustics) {
    const uint32_t image = maker.builder.add_image(image_from_floats(
        "panorama", texels, width, height, 3, ColorSpace::linear, AlphaMode::none));
    maker.builder.set_environment(
        {maker.builder.add_material(panorama_graph(image)), kVisibleAll, feeds_caustics});
}

Lit under_panorama(const Texels& texels, uint32_t width, uint32_t height) {
    SceneMaker maker;
    add_panorama(maker, texels, width, height, true);
    return freeze(maker);
}

Lit under_constant(float radiance) {
    SceneMaker maker;
    maker.builder.set_environment(
        {maker.builder.add_material(background(radiance, radiance, radiance)), kVisibleAll, true});
    return freeze(maker);
}

// One texel of a black panorama.
Texels single_texel(uint32_t width, uint32_t height, uint32_t x, uint32_t y, float value) {
    Texels texels(static_cast<size_t>(width) * height * 3, 0.0f);
    std::fill_n(texels.begin() + (static_cast<size_t>(y) * width + x) * 3, 3, value);
    return texels;
}

Vec3 direction_of_texel(double x, double y, uint32_t width, uint32_t height) {
    const double phi = (0.5 - x / width) * 2 * kPiD, theta = (1 - y / height) * kPiD;
    return to_float(direction({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, theta, phi));
}

TEST(World, ConstantIsLeftToClosures) {
    const Lit lit = under_constant(2);
    ASSERT_TRUE(lit.lights.has_world && lit.lights.world_is_constant);
    EXPECT_EQ(pdf_light_point_world(lit.lights, kUp), 0.0f);
    EXPECT_FALSE(sample_light_point(lit.lights, *lit.scene, {0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(pdf_direct_world(lit.lights, kOrigin, kUp), 0.0f);
    EXPECT_FALSE(sample_direct(lit.lights, *lit.scene, kOrigin, {0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(world_radiance(lit.lights, *lit.scene, kUp), Spectrum(2.0f));
}

TEST(World, BlackIsNoLight) {
    const Lit lit = under_constant(0);
    EXPECT_FALSE(lit.lights.has_world);
    EXPECT_EQ(lit.lights.count(), 0u);
    EXPECT_FALSE(sample_light_point(lit.lights, *lit.scene, {0.5f, 0.5f, 0.5f}));
    EXPECT_TRUE(is_black(world_radiance(lit.lights, *lit.scene, kUp)));
    EXPECT_FALSE(under_panorama(Texels(64 * 32 * 3, 0.0f), 64, 32).lights.has_world);
}

TEST(World, NearlyEvenOnesAreLeftToClosures) {
    // The mean square of radiance is 1 + (1 - dim)^2 / (1 + dim)^2 times the square of its mean
    // where the lower half is dim, and more than twice where more than that is black.
    for (const float dim : {1.0f, 0.1f, 0.0f}) {
        Texels texels(64 * 32 * 3, 0.5f);
        std::fill_n(texels.begin(), 64 * (dim > 0.0f ? 16 : 20) * 3, 0.5f * dim);
        const Lit lit = under_panorama(texels, 64, 32);
        ASSERT_TRUE(lit.lights.has_world);
        const Vec3 above = normalize(Vec3(0.1f, 0.2f, 0.5f));
        EXPECT_EQ(world_radiance(lit.lights, *lit.scene, above), Spectrum(0.5f));
        const bool sampled = pdf_direct_world(lit.lights, kOrigin, above) > 0.0f;
        EXPECT_EQ(sampled, dim == 0.0f);
        EXPECT_EQ(sampled, sample_direct(lit.lights, *lit.scene, kOrigin, Vec3(0.5f)).has_value());
    }
}

TEST(World, IsSampledByWhatItHasAboveItsMean) {
    // A quarter of the sphere, by azimuth, has 4 times the mean but for a ground of a tenth of
    // that.
    constexpr uint32_t kWidth = 256, kHeight = 128;
    Texels texels(kWidth * kHeight * 3, 0.1f);
    for (uint32_t y = 0; y < kHeight; ++y)
        std::fill_n(texels.begin() + (y * kWidth + 64) * 3, 64 * 3, 3.7f);
    const Lit lit = under_panorama(texels, kWidth, kHeight);
    const auto pdf = [&](double x) {
        return pdf_direct_world(lit.lights, kOrigin,
                                direction_of_texel(x, kHeight * 0.6, kWidth, kHeight));
    };
    // Mean 1; what is above it lies evenly on the quarter, and next to nothing elsewhere.
    EXPECT_NEAR_REL(pdf(96.5), 1 / kPiD, 1e-2);
    EXPECT_LT(pdf(200.5), 1e-3 / kPiD);
    EXPECT_GT(pdf(200.5), 0.0);
}

// Images of any shape and of more texels than the table has cells: one bright texel on an even
// ground is always found, and the density gives it its share.
TEST(WorldSlow, OneBrightTexelOfAnyImageIsNotMissed) {
    for (const auto& [width, height] :
         {std::pair{1501u, 350u}, std::pair{350u, 751u}, std::pair{4099u, 1000u}})
        for (const uint32_t place : width > 4096 ? std::vector{3u} : std::vector{3u, 5u}) {
            const uint32_t x = width * place / 7 + 1, y = height * place / 8 + 1;
            Texels texels(static_cast<size_t>(width) * height * 3, 0.1f);
            const float sun = 1e7f;
            std::fill_n(texels.begin() + (static_cast<size_t>(y) * width + x) * 3, 3, sun);
            const Lit lit = under_panorama(texels, width, height);
            ASSERT_FALSE(lit.lights.world_is_constant);
            const Vec3 center = direction_of_texel(x + 0.5, y + 0.5, width, height);
            const double solid_angle = 2 * kPiD / width * kPiD / height *
                                       std::sqrt(1 - double(center.z) * double(center.z));
            // The sun has nearly all the light; in its own cell the density is at least a tenth of
            // the ideal one, which is even over its texel.
            EXPECT_GT(sun * solid_angle, 4 * kPiD * 0.1 * 10);
            EXPECT_GT(pdf_direct_world(lit.lights, kOrigin, center) * solid_angle, 0.1)
                << width << " x " << height;
        }
}

TEST(World, SamplesHaveTheirDensity) {
    // A sky of uneven brightness with black parts; the bright one lies at a pole once.
    const Texels texels = [] {
        Texels t(16 * 8 * 3);
        Uniforms uniforms(1);
        for (size_t i = 0; i < t.size(); i += 3) {
            const float value =
                uniforms() < 0.3f ? 0.0f : uniforms() + (i >= t.size() - 48 ? 5.0f : 0.0f);
            t[i] = t[i + 1] = t[i + 2] = value;
        }
        return t;
    }();
    const Lit lit = under_panorama(texels, 16, 8);
    ASSERT_FALSE(lit.lights.world_cells.empty());
    Uniforms uniforms(2);
    const auto pdf = [&](const Vec3& wi) { return pdf_direct_world(lit.lights, kOrigin, wi); };
    const auto draw = [&]() -> std::optional<Vec3> {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        return s ? std::optional(s->wi) : std::nullopt;
    };
    const ChiSquare fit = chi_square_sphere({Frame::around(kUp), 12, 16, 1}, kSamples, draw, pdf);
    EXPECT_TRUE(fit.passes(kSignificance)) << fit.text();
    EXPECT_NEAR(fit.integral, 1.0, 1e-3);
    const ChiSquare twin =
        chi_square_sphere({Frame::around(kUp), 12, 16, 1}, kSamples, draw,
                          [&](const Vec3& wi) { return pdf(wi) * (wi.x > 0 ? 1.03f : 0.97f); });
    EXPECT_FALSE(twin.passes(kSignificance)) << twin.text();

    int different = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        ASSERT_TRUE(s);
        EXPECT_EQ(s->distance, kInfinity);
        EXPECT_NEAR(length(s->wi), 1.0f, 1e-6f);
        if (std::abs(pdf(s->wi) / s->density - 1) > 1e-3f) ++different;
    }
    EXPECT_LE(different, 20);  // on the edges of cells
}

TEST(World, BrightTexelIsFoundWhereverItLies) {
    // A bilinear texel of value v shines v times its own solid angle; one on each side of the
    // equator, beside the seam and beside a pole, on grids of one, few and many cells a texel.
    for (const uint32_t width : {64u, 512u}) {
        const uint32_t height = width / 2;
        const double step = kPiD / height;
        const std::vector<std::array<uint32_t, 2>> places = {{width / 3, height / 2 + height / 8},
                                                             {0, height / 2 + height / 5},
                                                             {width - 1, height - 2}};
        for (const auto& [x, y] : places) {
            const float value = 1e4f;
            const Lit lit = under_panorama(single_texel(width, height, x, y, value), width, height);
            const Vec3 center = direction_of_texel(x + 0.5, y + 0.5, width, height);
            // Over the hat function, in polar angles.
            const double theta0 = std::acos(static_cast<double>(center.z));
            const double over_theta = integrate(
                                          [&](double theta) {
                                              return (1 - std::abs(theta - theta0) / step) *
                                                     std::sin(theta) * std::cos(theta);
                                          },
                                          theta0 - step, theta0, 1e-12) +
                                      integrate(
                                          [&](double theta) {
                                              return (1 - std::abs(theta - theta0) / step) *
                                                     std::sin(theta) * std::cos(theta);
                                          },
                                          theta0, theta0 + step, 1e-12);
            const double expected = value * step * over_theta;
            const MeanEstimate e = irradiance_direct(lit, kOrigin, kUp, 4 * kSamples, 3);
            EXPECT_TRUE(is_mean(e, expected, kSignificance / 12, 1e-3 * expected))
                << width << " " << x << " " << y;
            EXPECT_FALSE(is_mean(e, 1.02 * expected, kSignificance / 12, 1e-3 * expected));
            EXPECT_LT(e.standard_error() / e.mean() * std::sqrt(4.0 * kSamples), 1.6);
            // Casters get all of it but the skirts of the hat, which are no peak.
            const MeanEstimate peak = irradiance_light_point(lit, kOrigin, kUp, 4 * kSamples, 4);
            EXPECT_GT(peak.mean(), 0.9 * expected) << width << " " << x << " " << y;
            EXPECT_LT(peak.mean(), expected + 5.0 * peak.standard_error())
                << width << " " << x << " " << y;
        }
    }
}

TEST(World, NoDirectionIsOutOfReach) {
    const Lit lit = under_panorama(single_texel(512, 256, 100, 200, 1e6f), 512, 256);
    Uniforms uniforms(5);
    for (int i = 0; i < 10000; ++i)
        EXPECT_GT(pdf_direct_world(lit.lights, kOrigin, normalize(uniforms.three() - Vec3(0.5f))),
                  0.0f);
    for (const Vec3& axis :
         {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(-1, -0.0f, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
        EXPECT_GT(pdf_direct_world(lit.lights, kOrigin, axis), 0.0f) << axis;
    for (const Vec3& pole : {Vec3(0, 0, 1), Vec3(0, 0, -1)})
        EXPECT_TRUE(std::isfinite(pdf_direct_world(lit.lights, kOrigin, pole))) << pole;
}

TEST(World, TwelveOrdersOfMagnitudeInOneSky) {
    Texels texels(128 * 64 * 3, 1e-6f);
    std::fill_n(texels.begin() + (40 * 128 + 30) * 3, 3, 1e6f);
    const Lit lit = under_panorama(texels, 128, 64);
    Uniforms uniforms(6);
    for (int i = 0; i < 20000; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        ASSERT_TRUE(s && std::isfinite(s->density) && s->density > 0 && std::isfinite(s->radiance.y));
    }
}

TEST(World, SharesTheChoiceWithLamps) {
    // The sum of a cap of sky and of a sun on the ground is exact.
    SceneMaker maker;
    constexpr uint32_t kWidth = 1024, kHeight = 512, kFirstRow = 320;
    Texels texels(kWidth * kHeight * 3);
    std::fill(texels.begin() + kFirstRow * kWidth * 3, texels.end(), 2.0f);
    add_panorama(maker, texels, kWidth, kHeight, false);
    maker.builder.add_light(sun_lamp(4, 0.1f));
    maker.add(square(3), diffuse(0.5f), translation({0, 0, -1}));
    const Lit lit = freeze(maker);
    // The edge is a ramp of a texel's height.
    const double step = kPiD / kHeight, dark = (kFirstRow - 0.5 - kHeight * 0.5) * step;
    const auto over = [&](double from, double to, const auto& radiance) {
        return integrate(
            [&](double e) { return 2 * kPiD * radiance(e) * std::sin(e) * std::cos(e); }, from, to,
            1e-9);
    };
    const double sky = over(dark, dark + step, [&](double e) { return 2 * (e - dark) / step; }) +
                       over(dark + step, kPiD / 2, [](double) { return 2.0; });
    const double sun = 4;
    EXPECT_TRUE(is_mean(irradiance_direct(lit, kOrigin, kUp, 4 * kSamples, 8), sky + sun,
                        kSignificance, 1e-3 * sky));
    // The sky feeds no casters.
    EXPECT_EQ(pdf_light_point_world(lit.lights, kUp), 0.0f);
    EXPECT_TRUE(
        is_mean(irradiance_light_point(lit, kOrigin, kUp, kSamples, 9), sun, kSignificance, 1e-4));
}

}  // namespace
}  // namespace spc::test
