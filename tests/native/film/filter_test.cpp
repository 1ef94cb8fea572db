// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel filters against their densities as Blender defines them, written down here again.
#include "film/filter.h"

#include "support/chi_square.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

struct FilterCase {
    FilterKind kind;
    float width;
    double radius;  // offsets lie within +-radius pixels
};

double density(const FilterCase& c, double x) {
    if (std::abs(x) > c.radius) return 0.0;
    const double w = double(c.width), pi = std::numbers::pi;
    switch (c.kind) {
        case FilterKind::box: return 1.0;
        case FilterKind::gaussian: return std::exp(-2.0 * (2.0 * x / w) * (2.0 * x / w));
        case FilterKind::blackman_harris: {
            const double t = 2.0 * pi * (x + w) / (2.0 * w);
            return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) -
                   0.01168 * std::cos(3 * t);
        }
    }
    return 0.0;
}

class Filters : public ::testing::TestWithParam<FilterCase> {};
INSTANTIATE_TEST_SUITE_P(All, Filters,
                         ::testing::Values(FilterCase{FilterKind::box, 1.0f, 0.5},
                                           FilterCase{FilterKind::box, 3.0f, 0.5},
                                           FilterCase{FilterKind::gaussian, 1.5f, 2.25},
                                           FilterCase{FilterKind::gaussian, 0.01f, 0.015},
                                           FilterCase{FilterKind::blackman_harris, 1.5f, 1.5},
                                           FilterCase{FilterKind::blackman_harris, 10.0f, 10.0}));

TEST_P(Filters, HistogramFollowsTheDensity) {
    const FilterCase c = GetParam();
    const PixelFilter filter(c.kind, c.width);
    constexpr int kCells = 40, kSamples = 200000;
    std::vector<int64_t> observed_x(kCells + 1), observed_y(kCells + 1);
    test::Uniforms uniforms(11);
    test::MeanEstimate product;
    const auto cell = [&](float offset) {
        const double at = (double(offset) / c.radius + 1.0) / 2.0;
        return at < 0.0 || at > 1.0 ? size_t{kCells}
                                    : std::min(size_t(at * kCells), size_t{kCells - 1});
    };
    for (int i = 0; i < kSamples; ++i) {
        const Vec2 offset = filter.sample(uniforms.two());
        ++observed_x[cell(offset.x)];
        ++observed_y[cell(offset.y)];
        product.add(double(offset.x) * double(offset.y));
    }
    std::vector<double> expected(kCells + 1, 0.0);
    const double norm = test::integrate([&](double x) { return density(c, x); }, -c.radius,
                                        c.radius, 1e-12 * c.radius);
    for (int i = 0; i < kCells; ++i)
        expected[size_t(i)] =
            kSamples / norm *
            test::integrate([&](double x) { return density(c, x); },
                            c.radius * (2.0 * i / kCells - 1),
                            c.radius * (2.0 * (i + 1) / kCells - 1), 1e-12 * c.radius);
    const double significance = test::sidak(1e-4, 3 * 6);
    for (const auto& observed : {observed_x, observed_y}) {
        const test::ChiSquare result = test::chi_square(observed, expected);
        EXPECT_TRUE(result.passes(significance)) << result.text();
        EXPECT_EQ(observed[kCells], 0) << "offsets beyond the filter's radius";
    }
    EXPECT_TRUE(test::is_mean(product, 0.0, significance)) << "x and y are not independent";
}

// Exact in the limit, so by a fine midpoint rule instead of samples.
TEST_P(Filters, MomentsAreThoseOfTheDensity) {
    const FilterCase c = GetParam();
    const PixelFilter filter(c.kind, c.width);
    double second = 0.0, expected_second = 0.0, norm = 0.0;
    constexpr int kSteps = 100000;
    for (int i = 0; i < kSteps; ++i) {
        const double u = (i + 0.5) / kSteps;
        const auto at = [&](double v) { return double(filter.sample(Vec2(float(v), 0.5f)).x); };
        second += at(u) * at(u) / kSteps;
        EXPECT_NEAR(at(u), -at(1.0 - u), 1e-4 * c.radius) << "not symmetric at " << u;
        const double x = c.radius * (2.0 * u - 1.0), d = density(c, x);
        expected_second += x * x * d;
        norm += d;
    }
    EXPECT_NEAR(second, expected_second / norm, 2e-3 * second);
}

TEST_P(Filters, OffsetsGrowWithTheRandomNumber) {
    const PixelFilter filter(GetParam().kind, GetParam().width);
    float last = -kInfinity;
    for (int i = 0; i <= 10000; ++i) {
        const float x = filter.sample(Vec2(std::min(float(i) * 1e-4f, 0x1.fffffep-1f), 0.0f)).x;
        ASSERT_TRUE(std::isfinite(x));
        ASSERT_GE(x, last);
        last = x;
    }
}

}  // namespace
}  // namespace spc
