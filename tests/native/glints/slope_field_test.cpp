// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_field.h"
#include "support/casters.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

struct Map {
    const char* name;
    Image image;
    float strength;  // of normals
    Relief relief = Relief::normals;
};

SlopeField field_of(const Map& map) {
    if (map.relief == Relief::heights) return SlopeField::of_heights(map.image, 2);
    return *SlopeField::of_normals(map.image, map.strength, 2);
}

// Sizes that are powers of two and that are not; floats, bytes and one channel; normals and
// heights.
std::vector<Map> maps() {
    const auto noise = [](uint32_t width, uint32_t height, float steepest) {
        test::Uniforms uniforms(width);
        return test::normal_image(width, height, [&](double, double) {
            return (uniforms.two() - Vec2(0.5f)) * (2.0f * steepest);
        });
    };
    std::vector<uint8_t> bytes;
    test::Uniforms uniforms(3);
    for (int i = 0; i < 20 * 9; ++i)
        for (const int value : {int(255 * uniforms()), int(255 * uniforms()), 255, 255})
            bytes.push_back(static_cast<uint8_t>(value));
    const std::vector<float> grey{0.8f, 0.9f, 0.6f, 0.7f};
    return {
        {"waves", test::plane_normals(64, 0.1, 0.2, 7), 1.0f},
        {"noise", noise(33, 18, 1.0f), 1.0f},
        {"strong noise", noise(16, 64, 3.0f), 1.7f},
        {"weak noise", noise(7, 5, 3.0f), 0.4f},
        {"one texel", noise(1, 1, 1.0f), 1.0f},
        {"a row", noise(40, 1, 1.0f), 1.0f},
        {"bytes", image_from_bytes("b", bytes, 20, 9, 4, ColorSpace::data, AlphaMode::packed), 1.0f},
        {"grey", image_from_floats("g", grey, 2, 2, 1, ColorSpace::data, AlphaMode::none), 1.0f},
        {"height waves", test::plane_heights(48, 21, 0.3, 6.0, 7), 1.0f, Relief::heights},
        {"height noise", noise(19, 34, 1.0f), 1.0f, Relief::heights},
        {"height bytes", image_from_bytes("b", bytes, 20, 9, 4, ColorSpace::data, AlphaMode::packed),
         1.0f, Relief::heights},
        {"height of one texel", noise(1, 1, 1.0f), 1.0f, Relief::heights}};
}

// The slope that the texture itself gives.
Vec2 looked_up(const Map& map, double s, double t) {
    const float u = static_cast<float>((s + 0.5) / map.image.width),
                v = static_cast<float>((t + 0.5) / map.image.height);
    if (map.relief == Relief::heights) {
        const Rgba<Dual2> c = lookup(map.image, Dual2(u, 1, 0), Dual2(v, 0, 1),
                                     Interpolation::cubic, Extension::repeat, false);
        const Dual2 height = c.r * 0.2126729f + c.g * 0.7151522f + c.b * 0.0721750f;
        return {height.du / float(map.image.width), height.dv / float(map.image.height)};
    }
    const Rgba<float> c = lookup<float>(map.image, u, v, Interpolation::linear, Extension::repeat);
    const double z = 1.0 + (2.0 * double(c.b) - 2.0) * std::min(double(map.strength), 1.0);
    return Vec2(float((2.0 * double(c.r) - 1.0) * double(map.strength) / z),
                float((2.0 * double(c.g) - 1.0) * double(map.strength) / z));
}

TEST(SlopeField, IsWhatTheTextureGives) {
    for (const Map& map : maps()) {
        const SlopeField field = field_of(map);
        test::Uniforms uniforms(1);
        for (int i = 0; i < 500; ++i) {
            const int x = int(uniforms() * float(field.width())),
                      y = int(uniforms() * float(field.height()));
            const Vec2 at = uniforms.two();
            const Vec2 slope = slope_at(field.cell(x, y), at.x, at.y),
                       expected = looked_up(map, x + double(at.x), y + double(at.y));
            EXPECT_NEAR(slope.x, expected.x, 1e-3f * (1.0f + std::abs(expected.x))) << map.name;
            EXPECT_NEAR(slope.y, expected.y, 1e-3f * (1.0f + std::abs(expected.y))) << map.name;
        }
    }
}

// Every node holds the slopes of all its points, and is no wider than they and two steps of the
// grid.
TEST(SlopeField, BoundsHoldAndAreTight) {
    for (const Map& map : maps()) {
        const SlopeField field = field_of(map);
        const SlopeBounds all = field.pyramid().bounds(field.pyramid().levels() - 1, 0, 0);
        const Vec2 step = (all.upper - all.lower) / 60000.0f;
        for (int level = 1; level < field.pyramid().levels(); ++level) {
            const int size = 1 << level;
            for (int y = 0; y * size < field.height(); ++y)
                for (int x = 0; x * size < field.width(); ++x) {
                    SlopeBounds exact{Vec2(kInfinity), Vec2(-kInfinity)};
                    for (int j = y * size; j < std::min((y + 1) * size, field.height()); ++j)
                        for (int i = x * size; i < std::min((x + 1) * size, field.width()); ++i)
                            exact.extend(bounds_of(field.cell(i, j)));
                    const SlopeBounds bounds = field.pyramid().bounds(level, x, y);
                    for (int k = 0; k < 2; ++k) {
                        const float rounding = 0.01f * step[k] + 1e-6f;
                        EXPECT_LE(bounds.lower[k], exact.lower[k] + rounding) << map.name;
                        EXPECT_GE(bounds.upper[k], exact.upper[k] - rounding) << map.name;
                        EXPECT_GE(bounds.lower[k], exact.lower[k] - 2.0f * step[k] - 1e-6f);
                        EXPECT_LE(bounds.upper[k], exact.upper[k] + 2.0f * step[k] + 1e-6f);
                    }
                }
        }
    }
}

TEST(SlopeField, PiecesOfACellHoldTheirSlopes) {
    for (const Map& map : maps()) {
        const SlopeField field = field_of(map);
        test::Uniforms uniforms(2);
        const auto check = [&](const auto& cell) {
            auto piece = cell;
            Vec2 corner(0.0f);
            float size = 1.0f;
            for (int depth = 0; depth < 4; ++depth) {
                const int quarter = int(4.0f * uniforms());
                size *= 0.5f;
                corner += Vec2(float(quarter & 1), float(quarter >> 1)) * size;
                piece = piece.quarter(quarter);
                const Vec2 at = uniforms.two();
                const Vec2 slope = piece.jet(at.x, at.y).slope,
                           expected = cell.jet(corner.x + at.x * size, corner.y + at.y * size).slope;
                const SlopeBounds bounds = piece.bounds();
                for (int k = 0; k < 2; ++k) {
                    const float rounding = 1e-5f * (1.0f + std::abs(expected[k]));
                    EXPECT_NEAR(slope[k], expected[k], rounding) << map.name;
                    EXPECT_GE(slope[k], bounds.lower[k] - rounding) << map.name;
                    EXPECT_LE(slope[k], bounds.upper[k] + rounding) << map.name;
                }
            }
        };
        for (int i = 0; i < 200; ++i)
            std::visit(check, field.cell(int(uniforms() * float(field.width())),
                                         int(uniforms() * float(field.height()))));
    }
}

// Against central differences.
TEST(SlopeField, JetsAreDerivatives) {
    constexpr float kStep = 1.0f / 128;
    for (const Map& map : maps()) {
        const SlopeField field = field_of(map);
        test::Uniforms uniforms(4);
        for (int i = 0; i < 100; ++i) {
            const SlopePatch cell = field.cell(int(uniforms() * float(field.width())),
                                               int(uniforms() * float(field.height())));
            const Vec2 at = Vec2(0.1f) + uniforms.two() * 0.8f;
            const auto along = [&](const Vec2& d) {
                return (slope_at(cell, at.x + d.x, at.y + d.y) -
                        slope_at(cell, at.x - d.x, at.y - d.y)) *
                       (0.5f / kStep);
            };
            const SlopeJet jet = jet_at(cell, at.x, at.y);
            const float scale = 1.0f + jet.slope.length() + jet.by_s.length() + jet.by_t.length();
            EXPECT_LT((jet.by_s - along({kStep, 0.0f})).length(), 5e-3f * sqr(scale)) << map.name;
            EXPECT_LT((jet.by_t - along({0.0f, kStep})).length(), 5e-3f * sqr(scale)) << map.name;
        }
    }
}

// Over the whole map, and over one of its nodes.
void check_moments(const Map& map) {
    const SlopeField field = field_of(map);
    const auto check = [&](const Vec2& lower, const Vec2& upper, int x0, int y0, int x1, int y1) {
        double a = 0, b = 0, aa = 0, ab = 0, bb = 0, n = 0;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) {
                const Vec2 s = looked_up(map, x, y);
                a += double(s.x), b += double(s.y);
                aa += double(s.x) * double(s.x), ab += double(s.x) * double(s.y);
                bb += double(s.y) * double(s.y), n += 1.0;
            }
        const SlopeMoments m = field.moments(lower, upper);
        EXPECT_NEAR(m.mean.x, a / n, 1e-4);
        EXPECT_NEAR(m.mean.y, b / n, 1e-4);
        EXPECT_NEAR(m.aa, aa / n - a / n * (a / n), 1e-4);
        EXPECT_NEAR(m.ab, ab / n - a / n * (b / n), 1e-4);
        EXPECT_NEAR(m.bb, bb / n - b / n * (b / n), 1e-4);
    };
    check({-200, -200}, {200, 200}, 0, 0, 64, 64);
    check({9, 17}, {10, 18}, 8, 16, 16, 24);
    check({9 + 64, 17 - 128}, {10 + 64, 18 - 128}, 8, 16, 16, 24);  // other repeats
}
TEST(SlopeField, MomentsAreThoseOfTheTexels) {
    check_moments(maps()[0]);
    check_moments({"heights", test::plane_heights(64, 64, 0.1, 10.0, 7), 1.0f, Relief::heights});
}

TEST(SlopeField, NoFieldOfNormalsThatPointInwards) {
    const std::vector<float> texels{0.5f, 0.5f, 1.0f, 0.5f, 0.5f, 0.49f};
    const Image image =
        image_from_floats("inwards", texels, 2, 1, 3, ColorSpace::data, AlphaMode::none);
    EXPECT_FALSE(SlopeField::of_normals(image, 1.0f, 2));
    EXPECT_TRUE(SlopeField::of_normals(image, 0.5f, 2)) << "a weak map is lifted";
}

// Whatever the size, of either kind: eight bytes for two by two cells and what the levels above
// them hold, and moments, at least.
TEST(SlopeField, TakesLessThanFourBytesForEachTexel) {
    for (const auto& [width, height] : {std::pair(256u, 256u), std::pair(257u, 130u),
                                        std::pair(130u, 257u), std::pair(1000u, 37u)})
        for (const Relief relief : {Relief::normals, Relief::heights}) {
            const auto texels = [width = width, height = height](double of_each) {
                return static_cast<size_t>(of_each * width * height);
            };
            const Image image = relief == Relief::heights
                                    ? test::plane_heights(width, height, 0.1, 0.2, 7)
                                    : test::normal_image(width, height, [](double u, double v) {
                                          return Vec2(float(0.2 * std::sin(40.0 * u)),
                                                      float(0.1 * std::cos(30.0 * v)));
                                      });
            const size_t bytes = field_of({"", image, 1.0f, relief}).memory_bytes();
            EXPECT_LT(bytes, texels(4.0)) << width << " x " << height << ", " << int(relief);
            EXPECT_GT(bytes, texels(3.0)) << width << " x " << height << ", " << int(relief);
        }
}

}  // namespace
}  // namespace spc
