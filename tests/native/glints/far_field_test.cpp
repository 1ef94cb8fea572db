// SPDX-License-Identifier: GPL-3.0-or-later
// How far the far field is from the truth: pixels in which the directions or the normal vary,
// against path tracing of the same map.
#include "support/glints.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kPixel = 0.1;  // m, its width on the surface
constexpr float kRoughness = 0.25f, kAlpha = kRoughness * kRoughness;
constexpr int kPixels = 24;

// What varies within a pixel.
enum class Near { light, camera, curvature };

// The half-vector turns by `share` of the lobe's width from one side of the pixel to the other,
// against the interpolated normal. Each pixel has its own part of the map.
RenderScene pixel_of(Near near, double share, int pixel, GlintsMode mode) {
    constexpr double kFar = 1000.0;
    const double turn = share * double(kAlpha);
    const double half_turn = kPixel / (2.0 * turn);  // m; a direction turns the half-vector half
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(64, 5.0 / 64, 0.2, 5));
    Graph graph = test::normal_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {kRoughness, 0, 0, 0}}}),
        {1.25f, 1.25f});
    test::Uniforms uniforms(static_cast<uint64_t>(pixel) + 1);
    graph.inputs.push_back({4, "Location", {uniforms(), uniforms(), 0, 0}});
    graph.glints = mode;
    const double radius = near == Near::curvature ? kPixel / turn : kFar;
    constexpr uint32_t kCells = 64;
    const auto normal = [=](double u, double v) {
        return normalize(Vec3d((u - 0.5) / radius, (v - 0.5) / radius, 1.0));
    };
    maker.add(test::with_uvs(test::grid(
                                 kCells,
                                 [=](double u, double v) {
                                     return normal(u, v) * radius - Vec3d(0.0, 0.0, radius);
                                 },
                                 normal),
                             kCells),
              graph);
    maker.builder.set_camera(
        test::look_at(Vec3(0.0f), Vec3(0.3f, -0.3f, 1.0f),
                      static_cast<float>(near == Near::camera ? half_turn : kFar), float(kPixel)));
    const double away = near == Near::light ? half_turn : kFar;
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = LightType::point;
    const Vec3 to_lamp = normalize(Vec3(-0.2f, 0.4f, 1.0f));
    lamp.to_world = test::translation(to_lamp * static_cast<float>(away));
    lamp.radius = static_cast<float>(0.03 * away);
    lamp.power = Spectrum(static_cast<float>(4.0 * std::numbers::pi * away * away));
    maker.builder.add_light(lamp);
    return maker.finish();
}

// Over all pixels, relative to their mean: the root mean square of what a pixel is too bright or
// too dark, and the deviation of the pixels themselves; and the mean's own difference with its
// error.
struct Difference {
    double rms, contrast, mean, error;
};
Difference difference(const std::string& name, Near near, double share) {
    constexpr uint32_t kGlints = 1500, kReference = 12000;
    const auto seed_of = [](int pixel, uint32_t i) {
        return 4 * static_cast<uint32_t>(pixel) + 2 * i;
    };
    const test::Estimates traced = test::truth(name, kReference, [&](uint32_t samples) {
        test::Estimates all;
        for (int pixel = 0; pixel < kPixels; ++pixel) {
            const RenderScene off = pixel_of(near, share, pixel, GlintsMode::off);
            for (uint32_t i = 0; i < 2; ++i)
                all.push_back(
                    test::estimate_pixel(off, test::unlimited(), samples, seed_of(pixel, i) + 1)
                        .radiance);
        }
        return all;
    });
    double excess = 0.0, truth = 0.0, squares = 0.0, truth_squares = 0.0, variance = 0.0;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
        const RenderScene on = pixel_of(near, share, pixel, GlintsMode::on);
        // Two independent estimates of each: their product has no noise on average.
        std::array<double, 2> a, b;
        for (uint32_t i = 0; i < 2; ++i) {
            const test::MeanEstimate glints = test::estimate_pixel(on, test::unlimited(), kGlints,
                                                                   seed_of(pixel, i))
                                                  .radiance,
                                     paths = traced[2 * static_cast<size_t>(pixel) + i];
            a[i] = glints.mean();
            b[i] = paths.mean();
            variance +=
                0.25 * (std::pow(glints.standard_error(), 2) + std::pow(paths.standard_error(), 2));
            excess += 0.5 * (a[i] - b[i]);
            truth += 0.5 * b[i];
        }
        squares += (a[0] - b[0]) * (a[1] - b[1]);
        truth_squares += b[0] * b[1];
    }
    const double mean = truth / kPixels;
    return {std::sqrt(std::max(squares / kPixels, 0.0)) / mean,
            std::sqrt(truth_squares / kPixels - mean * mean) / mean, excess / truth,
            std::sqrt(variance) / truth};
}

// docs/limits.md states what this measures. A quarter of the lobe's width does not show; where
// four of them meet in a pixel, its glints are softer by most of what they differ.
TEST(FarFieldSlow, IsTheTruthWhileDirectionsTurnByLessThanTheLobe) {
    for (const Near near : {Near::light, Near::camera, Near::curvature})
        for (const double share : {0.25, 1.0, 4.0}) {
            const char* name = near == Near::light    ? "light"
                               : near == Near::camera ? "camera"
                                                      : "curvature";
            const Difference d = difference(fmt::format("{}, {}", name, share), near, share);
            const std::string text = fmt::format(
                "{}, {} of the lobe: rms {:.3f} of contrast {:.3f}, mean {:+.4f} +- {:.4f}", name,
                share, d.rms, d.contrast, d.mean, d.error);
            RecordProperty(fmt::format("{}_{}", name, share), text);
            if (share < 1.0) {
                EXPECT_LT(d.rms, 0.2 * d.contrast) << text;
                EXPECT_LT(std::abs(d.mean), 4.0 * d.error) << text;
            } else if (share > 1.0) {
                EXPECT_GT(d.rms, 0.5 * d.contrast) << text << ": the measure notices nothing";
            } else {
                EXPECT_LT(d.rms, 0.5 * d.contrast) << text;
            }
        }
}

}  // namespace
}  // namespace spc
