// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of all widths over a map of Gaussian slopes, across the widths at which glints begin, are
// searched less closely, and end: against quadrature of a Beckmann lobe on the map, and against the
// smooth lobe that lobe and slopes make together [Olano10].
#include "support/glints.h"
#include "support/power.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace spc {
namespace {

using test::GlintFloor;
using test::SceneMaker;

constexpr double kFamily = 1e-3;  // probability that any comparison of a test fails by chance
constexpr double kSlope = 0.2;    // of the map
constexpr double kPixel = 0.1;    // m, its width on the floor
constexpr FilterKind kFilter = FilterKind::blackman_harris;

// A lobe on a map that lies so densely on the floor that a pixel is `texels` wide, and begins at
// `place`.
struct Setting {
    Relief relief;
    float roughness;
    double texels;
    Vec2 place{0.0f, 0.0f};
    uint32_t wave = 8;  // texels; there are 16 in a repeat

    uint32_t period() const { return 16 * wave; }
    double alpha() const { return double(roughness) * double(roughness); }
    double repeat() const { return texels / kPixel * 2.0 / period(); }
    Image map() const {
        return relief == Relief::heights
                   ? test::plane_heights(period(), period(), 1.0 / 16, kSlope, 5)
                   : test::plane_normals(period(), 1.0 / 16, kSlope, 5);
    }
};

// Under a sun of unit irradiance near to the mirrored direction.
GlintFloor floor_of(const Setting& setting) {
    const Graph glossy = test::single_shader(
        "bsdf_glossy", {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {setting.roughness, 0, 0, 0}}},
        {{1, "distribution", "BECKMANN"}});
    const Vec2 tiles(static_cast<float>(setting.repeat()), static_cast<float>(setting.repeat()));
    // The slopes of heights are those of the map for a distance of the width of a repeat.
    Graph graph = setting.relief == Relief::heights
                      ? test::bump_mapped(glossy, tiles, static_cast<float>(2.0 / setting.repeat()))
                      : test::normal_mapped(glossy, tiles);
    graph.inputs.push_back({4, "Location", {setting.place.x, setting.place.y, 0, 0}});
    return {graph, setting.map(), 0.5 * kPixel * setting.period(), 0.5f, [](SceneMaker& maker) {
                maker.builder.add_light(test::sun_towards({0.15f, 0.58f, 0.88f}, 0.009f, 1.0f));
            }};
}

// What a pixel sees, by the textbook: the mean of D / (4 n.o) over the normals n of the map, with
// masking that is 1 to the last digit for lobes this narrow.
class Textbook {
public:
    // Under so much more relief than there is.
    explicit Textbook(const Setting& setting, double excess = 1.0)
        : setting_(setting), excess_(excess), map_(setting.map()) {}

    const Vec3d& half() const { return half_; }
    double cos_o_h() const { return dot(half_, wo_); }

    // Over a whole repeat.
    double of_period() const {
        constexpr int kSteps = 1024;
        double sum = 0.0;
        for (int y = 0; y < kSteps; ++y)
            for (int x = 0; x < kSteps; ++x) sum += at((x + 0.5) / kSteps, (y + 0.5) / kSteps);
        return sum / (double(kSteps) * kSteps);
    }
    // Through the camera's filter.
    double of_pixel(const Camera& camera) const {
        constexpr int kSteps = 1200;
        const PixelFilter filter(kFilter, 1.5f);
        const auto floor_at = [&](const Vec2& film) {
            const Ray ray = camera.ray(film.x, film.y, Vec2(0.5f));
            const Vec3d o(ray.origin), d(ray.direction);
            return o - d * (o.z / d.z);
        };
        const Vec3d middle = floor_at(Vec2(0.5f)), across = floor_at({1.5f, 0.5f}) - middle,
                    along = floor_at({0.5f, 1.5f}) - middle;
        double sum = 0.0;
        for (int y = 0; y < kSteps; ++y)
            for (int x = 0; x < kSteps; ++x) {
                const Vec2 offset =
                    filter.sample(Vec2(float(x) + 0.5f, float(y) + 0.5f) / float(kSteps));
                const Vec3d p = middle + across * double(offset.x) + along * double(offset.y);
                sum += at((0.5 * p.x + 0.5) * setting_.repeat() + double(setting_.place.x),
                          (0.5 * p.y + 0.5) * setting_.repeat() + double(setting_.place.y));
            }
        return sum / (double(kSteps) * kSteps);
    }

private:
    double at(double u, double v) const {
        const Vec3d n = normalize(normal_at(static_cast<float>(u - std::floor(u)),
                                            static_cast<float>(v - std::floor(v))));
        const double cos2 = std::pow(dot(n, half_), 2), alpha2 = std::pow(setting_.alpha(), 2);
        const double density =
            std::exp((1.0 - 1.0 / cos2) / alpha2) / (std::numbers::pi * alpha2 * cos2 * cos2);
        return dot(n, wo_) > 0.0 && dot(n, half_) > 0.0 ? density / (4.0 * dot(n, wo_)) : 0.0;
    }
    Vec3d normal_at(float u, float v) const {
        if (setting_.relief == Relief::normals) {
            const Rgba<float> c =
                lookup<float>(map_, u, v, Interpolation::linear, Extension::repeat);
            return {excess_ * (2.0 * double(c.r) - 1.0), excess_ * (2.0 * double(c.g) - 1.0),
                    2.0 * double(c.b) - 1.0};
        }
        const Dual2 height = lookup(map_, Dual2(u, 1, 0), Dual2(v, 0, 1), Interpolation::cubic,
                                    Extension::repeat, false)
                                 .r;
        return {-excess_ * double(height.du), -excess_ * double(height.dv), 1.0};
    }

    Setting setting_;
    double excess_;
    Image map_;
    Vec3d wo_{0.0, -std::sin(0.5), std::cos(0.5)};
    Vec3d half_ = normalize(wo_ + normalize(Vec3d(0.15, 0.58, 0.88)));
};

// Pixels at several places of the map.
struct Measured {
    double mean = 0.0, error = 0.0, expected = 0.0;
    double noise = 0.0;  // standard deviation of a sample, relative to the mean
    uint64_t estimates = 0;
    double z() const { return (mean - expected) / error; }
};
Measured measure(Setting setting, uint32_t samples, GlintsMode mode = GlintsMode::on,
                 double excess = 1.0) {
    // Of many repeats a pixel holds, places make no difference.
    const bool wide = setting.texels > 7.0 * setting.period();
    const uint32_t places = wide ? 1 : 4;
    const uint32_t count = samples / places;
    test::Uniforms uniforms(7);
    Measured m;
    double variance = 0.0;
    for (uint32_t i = 0; i < places; ++i) {
        setting.place = uniforms.two();
        const RenderScene world = test::finish(floor_of(setting), mode);
        const auto estimate = test::estimate_pixel(world, test::unlimited(), count, i + 1, kFilter);
        const Textbook textbook(setting, excess);
        m.expected +=
            (wide ? textbook.of_period() : textbook.of_pixel(world.scene->camera)) / places;
        m.mean += estimate.radiance.mean() / places;
        variance += std::pow(estimate.radiance.standard_error(), 2) * count / places;
        m.estimates += estimate.stats.glints.estimates;
    }
    m.error = std::sqrt(variance / samples);
    m.noise = std::sqrt(variance) / m.mean;
    return m;
}

// Where a pixel covers a 16th of a square texel, where the search may not look at each of the cells
// any more and where it looks at a set number of them, and where a footprint reaches a million
// texels.
constexpr double kBegins = 0.937 / 4, kCoarser = 28.3, kCoarse = 40.0, kEnds = 5.85e5;
const std::vector<double> kWidths{
    0.5,   1.0,   2.0, 5.0, 20.0,         0.99 * kCoarser, 1.01 * kCoarser, 1.01 * kCoarse,
    100.0, 300.0, 1e3, 1e5, 0.997 * kEnds};

struct Lobe {
    const char* name;
    Relief relief;
    float roughness;
    uint32_t samples;
};
// By day half of the samples, and twins that are as much steeper as the errors are larger.
const uint32_t kFewer = test::power(2, 1);
const double kLargerError = std::sqrt(kFewer);
const std::vector<Lobe> kLobes{{"normals", Relief::normals, 0.3f, 20000 / kFewer},
                               {"heights", Relief::heights, 0.3f, 20000 / kFewer},
                               {"narrow", Relief::normals, 0.12f, 8000 / kFewer}};

// The noise of a sample with one estimate hardly depends on the width, either: where the search may
// not look at each cell it leaves 1.6 times as much of the narrow lobe as before.
TEST(GlintConvergenceSlow, PixelsOfAllWidthsMeetTheTextbook) {
    constexpr double kMostNoise = 0.65, kLargestJump = 2.0;
    const double significance = test::sidak(kFamily, int(kLobes.size() * kWidths.size()));
    for (const Lobe& lobe : kLobes) {
        double before = 0.0;
        for (const double texels : kWidths) {
            // Between texels hardly any light is left of a narrow lobe, but by the sun's disc.
            if (lobe.roughness < 0.2f && texels < 2.0) continue;
            const Measured m = measure({lobe.relief, lobe.roughness, texels}, lobe.samples);
            const std::string text = fmt::format(
                "{}, {:.4g} texels: {:.5f} +- {:.5f} and {:.5f}, z {:+.2f}, noise {:.3f}",
                lobe.name, texels, m.mean, m.error, m.expected, m.z(), m.noise);
            RecordProperty(fmt::format("{}_{:.4g}", lobe.name, texels), text);
            EXPECT_GT(std::erfc(std::abs(m.z()) / std::sqrt(2.0)), significance) << text;
            EXPECT_LT(m.error, 0.007 * kLargerError * m.expected) << text << ": too little power";
            EXPECT_GT(m.estimates, lobe.samples / 2) << text;
            EXPECT_LT(m.noise, kMostNoise) << text;
            if (before > 0.0) {
                EXPECT_LT(m.noise, kLargestJump * before) << text;
                EXPECT_GT(m.noise, before / kLargestJump) << text;
            }
            before = m.noise;
        }
    }
}

// Its twin: slopes that are 3 % steeper, at full power.
TEST(GlintConvergence, TextbookNoticesALittleRelief) {
    for (const double texels : {20.0, 1e3}) {
        const Measured m = measure({Relief::normals, 0.3f, texels}, kLobes[0].samples,
                                   GlintsMode::on, 1.0 + 0.03 * kLargerError);
        EXPECT_GT(std::abs(m.z()), 5.0) << texels << ": " << m.mean << " and " << m.expected;
    }
}

// Beyond both ends the map is path traced, sample by sample, with path tracing's noise: of this
// lobe about as much where glints begin, four times as much where they end. Single precision
// puts the samples of a million texels on a lattice, which costs path tracing some percent.
TEST(GlintConvergenceSlow, PathTracingGoesOnBeyondTheEnds) {
    constexpr uint32_t kSamples = 40000;
    constexpr double kLattice = 0.06;
    for (const auto& [inside, outside] :
         {std::pair(1.003 * kBegins, 0.997 * kBegins), std::pair(0.997 * kEnds, 1.003 * kEnds),
          std::pair(0.997 * kEnds, 2e6)}) {
        const Setting there{Relief::normals, 0.3f, outside};
        const Measured last = measure({Relief::normals, 0.3f, inside}, kSamples),
                       beyond = measure(there, kSamples),
                       off = measure(there, kSamples, GlintsMode::off);
        const std::string text = fmt::format(
            "{:.4g} texels: {:.5f} +- {:.5f} and {:.5f}, noise {:.3f} after {:.3f}", outside,
            beyond.mean, beyond.error, beyond.expected, beyond.noise, last.noise);
        RecordProperty(fmt::format("beyond_{:.4g}", outside), text);
        EXPECT_EQ(beyond.estimates, 0u) << text;
        EXPECT_EQ(beyond.mean, off.mean) << text;
        EXPECT_LT(beyond.error, 0.02 * beyond.expected) << text << ": too little power";
        const double bias = outside > 1e5 ? kLattice * beyond.expected : 0.0;
        EXPECT_LT(std::abs(beyond.mean - beyond.expected), bias + 4.0 * beyond.error) << text;
        EXPECT_LT(beyond.noise, 5.0 * last.noise) << text;
    }
}

// Of a footprint of many repeats the moments are those of all slopes, and what they promise is what
// there is: but for angles of the lobe's width squared, and for slopes that are not quite Gaussian.
// Between texels a normal map is less steep than at them, where the moments are from: of waves of 8
// texels they promise 12 % too little.
TEST(GlintConvergence, MomentsPromiseTheSmoothLobe) {
    for (const float roughness : {0.12f, 0.3f})
        for (const auto& [relief, wave, tolerance] :
             {std::tuple(Relief::heights, 8u, 0.04), std::tuple(Relief::normals, 8u, 0.15),
              std::tuple(Relief::normals, 32u, 0.04)}) {
            const Setting setting{relief, roughness, 1e5, {0.0f, 0.0f}, wave};
            const bool bumped = relief == Relief::heights;
            const Image map = setting.map();
            const SlopeField field =
                bumped ? SlopeField::of_heights(map, 2) : *SlopeField::of_normals(map, 1.0f, 2);
            // Slopes are a normal's own x and y, or those of heights by texels.
            const float up = bumped ? -static_cast<float>(setting.period()) : 1.0f;
            GlintSite site{};
            site.frame = {{Vec3(up, 0, 0), Vec3(0, up, 0), Vec3(0, 0, 1)}};
            site.moments = field.moments(Vec2(-1e5f), Vec2(1e5f));
            const Textbook textbook(setting);
            const GlintTarget target(site.frame, Vec3(textbook.half()));
            const double promised =
                double(site.normal_slopes_density(static_cast<float>(setting.alpha()), target)) /
                (4.0 * textbook.cos_o_h());
            EXPECT_NEAR(promised / textbook.of_period(), 1.0, tolerance)
                << (bumped ? "heights" : "normals") << ", waves of " << wave << ", roughness "
                << roughness;
        }
}

}  // namespace
}  // namespace spc
