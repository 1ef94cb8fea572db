// SPDX-License-Identifier: GPL-3.0-or-later
// The quadtree's density against its samples and against the points that it follows.
#include "core/quadtree.h"

#include "support/chi_square.h"

namespace spc {
namespace {

constexpr float kFloor = 0.05f;
constexpr int kCells = 16;  // a side; leaves that are finer lie within one cell
constexpr double kFamily = 1e-3;

// A spot, a line and a few points of much weight.
std::vector<WeightedPoint> uneven_points() {
    test::Uniforms uniforms(3);
    std::vector<WeightedPoint> points;
    for (int i = 0; i < 4000; ++i) {
        const Vec2 u = uniforms.two();
        points.push_back({{0.2f + 0.02f * u.x, 0.7f + 0.02f * u.y}, 1.0f});
        points.push_back({{u.x, 0.4f}, 0.5f + u.y});
    }
    for (int i = 0; i < 40; ++i) points.push_back({{0.9f, 0.1f}, 25.0f});
    return points;
}

// The density's share of each cell of a grid, from a midpoint rule that no leaf straddles.
std::vector<double> shares(const QuadtreeDensity& density) {
    constexpr int kFine = 512;
    std::vector<double> sum(size_t{kCells} * kCells);
    for (int j = 0; j < kFine; ++j)
        for (int i = 0; i < kFine; ++i)
            sum[size_t(j * kCells / kFine) * kCells + size_t(i * kCells / kFine)] +=
                double(density.pdf({(float(i) + 0.5f) / kFine, (float(j) + 0.5f) / kFine})) /
                (double(kFine) * kFine);
    return sum;
}

size_t cell_of(const Vec2& p) { return size_t(p.y * kCells) * kCells + size_t(p.x * kCells); }

test::ChiSquare fit_of(const QuadtreeDensity& density, const std::vector<double>& share) {
    constexpr int64_t kSamples = 400000;
    std::vector<int64_t> observed(share.size());
    std::vector<double> expected;
    for (const double s : share) expected.push_back(s * double(kSamples));
    test::Uniforms uniforms(5);
    for (int64_t i = 0; i < kSamples; ++i) {
        const QuadtreeDensity::Sample sample = density.sample(uniforms.two());
        EXPECT_TRUE(sample.p.x >= 0.0f && sample.p.x < 1.0f && sample.p.y >= 0.0f && sample.p.y < 1.0f)
            << sample.p;
        EXPECT_GT(sample.pdf, 0.0f);
        EXPECT_EQ(sample.pdf, density.pdf(sample.p));
        ++observed[std::min(cell_of(sample.p), observed.size() - 1)];
    }
    return test::chi_square(observed, expected);
}

TEST(QuadtreeDensity, SamplesFollowTheDensity) {
    // Spread wide enough for all leaves to be larger than the cells of the midpoint rule.
    test::Uniforms uniforms(9);
    std::vector<WeightedPoint> points;
    for (int i = 0; i < 5000; ++i) {
        const Vec2 u = uniforms.two();
        points.push_back({{u.x * u.x, u.y}, 0.2f + u.y});
    }
    const QuadtreeDensity density(points, kFloor);
    const std::vector<double> share = shares(density);
    EXPECT_NEAR(std::accumulate(share.begin(), share.end(), 0.0), 1.0, 1e-5);
    const test::ChiSquare fit = fit_of(density, share);
    EXPECT_TRUE(fit.passes(kFamily)) << fit.text();
    // A density that leans by some percent is found out.
    std::vector<double> leaning = share;
    for (size_t i = 0; i < leaning.size(); ++i) leaning[i] *= i % kCells < kCells / 2 ? 1.02 : 0.97;
    EXPECT_FALSE(fit_of(density, leaning).passes(kFamily));
}

// 1/pdf over its own samples is the area of the square, however fine the leaves.
TEST(QuadtreeDensity, IntegratesToOneWhereItIsFine) {
    std::vector<WeightedPoint> points = uneven_points();
    const QuadtreeDensity density(points, kFloor);
    test::Uniforms uniforms(4);
    test::MeanEstimate area, left;
    for (int i = 0; i < 400000; ++i) {
        const QuadtreeDensity::Sample sample = density.sample(uniforms.two());
        area.add(1.0 / double(sample.pdf));
        left.add(sample.p.x < 0.3f ? 1.0 / double(sample.pdf) : 0.0);
    }
    EXPECT_TRUE(test::is_mean(area, 1.0, test::sidak(kFamily, 2)));
    EXPECT_TRUE(test::is_mean(left, 0.3, test::sidak(kFamily, 2)));
}

TEST(QuadtreeDensity, FollowsTheWeights) {
    std::vector<WeightedPoint> points = uneven_points();
    double total = 0.0;
    for (const WeightedPoint& point : points) total += double(point.weight);
    const QuadtreeDensity density(points, kFloor);
    // Cells of an eighth: much coarser than the leaves around all that has weight.
    std::vector<double> wanted(64, kFloor / 64.0), got(64);
    const auto eighth = [](const Vec2& p) { return size_t(p.y * 8) * 8 + size_t(p.x * 8); };
    for (const WeightedPoint& point : points)
        wanted[eighth(point.p)] += (1.0 - double(kFloor)) * double(point.weight) / total;
    test::Uniforms uniforms(6);
    constexpr int kSamples = 200000;
    for (int i = 0; i < kSamples; ++i)
        got[eighth(density.sample(uniforms.two()).p)] += 1.0 / kSamples;
    for (size_t i = 0; i < 64; ++i)
        EXPECT_NEAR(got[i], wanted[i], 5.0 * std::sqrt(wanted[i] / kSamples) + 2e-3) << i;
    // Between them there is the floor, and nothing else.
    EXPECT_NEAR(density.pdf({0.6f, 0.8f}), kFloor, 1e-6f);
    EXPECT_GT(density.pdf({0.21f, 0.71f}), 100.0f);
}

// Points of uneven weights, evenly spread: what an estimate's second moment grows by if its samples
// follow what was learned of them and not the even density that is best.
TEST(QuadtreeDensity, DoesNotFollowTheNoiseOfWeights) {
    test::Uniforms uniforms(10);
    std::vector<WeightedPoint> points;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 u = uniforms.two();
        points.push_back({u, 1.0f / (0.01f + uniforms.two().x)});
    }
    const QuadtreeDensity density(points, kFloor);
    test::MeanEstimate moment;
    for (int i = 0; i < 100000; ++i) moment.add(1.0 / double(density.pdf(uniforms.two())));
    EXPECT_LT(moment.mean(), 1.25);
}

TEST(QuadtreeDensity, IsUniformWithoutWeight) {
    std::vector<WeightedPoint> weightless(100, WeightedPoint{{0.25f, 0.25f}, 0.0f});
    for (const QuadtreeDensity& density :
         {QuadtreeDensity(), QuadtreeDensity({}, kFloor), QuadtreeDensity(weightless, kFloor)}) {
        test::Uniforms uniforms(7);
        for (int i = 0; i < 1000; ++i) {
            const Vec2 u = uniforms.two();
            const QuadtreeDensity::Sample sample = density.sample(u);
            EXPECT_EQ(sample.pdf, 1.0f);
            EXPECT_EQ(sample.p, u);
        }
    }
}

// All weight in one place: the deepest leaf there is, and no number that is not finite.
TEST(QuadtreeDensity, EndsAtTheFinestCells) {
    std::vector<WeightedPoint> points(1000, WeightedPoint{{0.3f, 0.6f}, 1e-30f});
    const QuadtreeDensity density(points, kFloor);
    test::Uniforms uniforms(8);
    test::MeanEstimate near;
    for (int i = 0; i < 10000; ++i) {
        const QuadtreeDensity::Sample sample = density.sample(uniforms.two());
        ASSERT_TRUE(std::isfinite(sample.pdf) && sample.pdf > 0.0f);
        near.add((sample.p - Vec2(0.3f, 0.6f)).length() < 1e-5f ? 1.0 : 0.0);
    }
    EXPECT_TRUE(test::is_mean(near, 1.0 - double(kFloor), kFamily));
}

TEST(QuadtreeDensity, HasNoFinerCellsThanAskedFor) {
    std::vector<WeightedPoint> points(1000, WeightedPoint{{0.3f, 0.6f}, 1.0f});
    const QuadtreeDensity density(points, kFloor, 0.25f);
    EXPECT_EQ(density.pdf({0.251f, 0.501f}), density.pdf({0.3f, 0.6f}));
    EXPECT_NEAR(density.pdf({0.3f, 0.6f}), 16.0f * (1.0f - kFloor) + kFloor, 1e-4f);
}

}  // namespace
}  // namespace spc
