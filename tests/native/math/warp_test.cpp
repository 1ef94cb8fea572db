// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/warp.h"

#include "support/chi_square.h"

namespace spc::test {
namespace {

constexpr double kSignificance = 0.01;  // of each test below, over all of its comparisons
constexpr int64_t kSamples = 200000;

TEST(UnitCircle, MatchesTheLibrary) {
    for (int i = 0; i <= 10000; ++i) {
        const double turn = i / 10000.0;
        const Vec2 p = unit_circle(static_cast<float>(turn));
        EXPECT_NEAR(p.x, std::cos(2 * std::numbers::pi * turn), 3e-7) << turn;
        EXPECT_NEAR(p.y, std::sin(2 * std::numbers::pi * turn), 3e-7) << turn;
    }
}

TEST(ConcentricDisk, FillsTheDiskEvenly) {
    Uniforms uniforms(1);
    constexpr int kRings = 8, kSectors = 16;
    std::vector<int64_t> observed(kRings * kSectors);
    for (int64_t i = 0; i < kSamples; ++i) {
        const Vec2 p = concentric_disk(uniforms.two());
        const double r2 = sqr(p.x) + sqr(p.y);
        ASSERT_LE(r2, 1 + 1e-6);
        const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
        ++observed[std::min(int(r2 * kRings), kRings - 1) * kSectors +
                   std::min(int(turn * kSectors), kSectors - 1)];
    }
    const ChiSquare fit = chi_square(
        observed, std::vector<double>(observed.size(), double(kSamples) / double(observed.size())));
    EXPECT_TRUE(fit.passes(kSignificance)) << fit.text();
}

TEST(ConcentricDisk, IsContinuousAndReachesCentreAndRim) {
    EXPECT_EQ(concentric_disk({0.5f, 0.5f}), Vec2(0, 0));
    for (int i = 0; i <= 100; ++i) {
        const float t = static_cast<float>(i) / 100;
        for (const Vec2& rim : {Vec2(0, t), Vec2(1, t), Vec2(t, 0), Vec2(t, 1)})
            EXPECT_NEAR(concentric_disk(rim).length(), 1.0f, 1e-6f);
        const Vec2 diagonal = concentric_disk({t, t}),
                   beside = concentric_disk({t, t * (1 - 1e-6f)});
        EXPECT_NEAR((diagonal - beside).length(), 0.0f, 1e-5f);
    }
}

TEST(ConcentricDisk, HasAnInverse) {
    const auto expect_back = [](const Vec2& u) {
        EXPECT_NEAR((concentric_square(concentric_disk(u)) - u).length(), 0.0f, 3e-7f) << u;
    };
    Uniforms uniforms(6);
    for (int i = 0; i < 100000; ++i) expect_back(uniforms.two());
    for (int i = 0; i <= 64; ++i) {
        const float t = static_cast<float>(i) / 64;
        for (const Vec2& u : {Vec2(0.5f, t), Vec2(t, 0.5f), Vec2(t, t), Vec2(t, 1 - t), Vec2(0, t),
                              Vec2(1, t), Vec2(t, 0), Vec2(t, 1)})
            expect_back(u);
    }
    for (const float small : {1e-30f, 1e-10f})
        EXPECT_NEAR((concentric_square({small, -small}) - Vec2(0.5f, 0.5f)).length(), 0.0f, 1e-7f);
}

TEST(SphereWarps, HaveTheirDensities) {
    const SphereGrid grid{Frame::around(Vec3(0, 0, 1))};
    Uniforms uniforms(2);
    const double significance = sidak(kSignificance, 2);
    const ChiSquare cosine = chi_square_sphere(
        grid, kSamples, [&] { return std::optional(cosine_hemisphere(uniforms.two())); },
        [](const Vec3& w) { return cosine_hemisphere_pdf(w.z); });
    EXPECT_TRUE(cosine.passes(significance)) << cosine.text();
    EXPECT_NEAR(cosine.integral, 1.0, 1e-6);

    const ChiSquare sphere = chi_square_sphere(
        grid, kSamples, [&] { return std::optional(uniform_sphere(uniforms.two())); },
        [](const Vec3&) { return kUniformSpherePdf; });
    EXPECT_TRUE(sphere.passes(significance)) << sphere.text();
    EXPECT_NEAR(sphere.integral, 1.0, 1e-6);
}

// Inside the cone, 1 - cos is uniform; the grid is over it, since a sun's cone is too narrow for a
// grid on the sphere.
TEST(UniformCone, IsEvenDownToTheSun) {
    const double half_angles[] = {1.2, 0.1, 0.00465 /* the sun */};
    for (const double half_angle : half_angles) {
        Uniforms uniforms(3);
        const float width = one_minus_cos(static_cast<float>(half_angle));
        EXPECT_NEAR_REL(width, 2 * std::pow(std::sin(half_angle / 2), 2), 1e-6);
        EXPECT_NEAR_REL(uniform_cone_pdf(width) * 2 * std::numbers::pi * width, 1.0, 1e-6);
        constexpr int kRings = 8, kSectors = 8;
        std::vector<int64_t> observed(kRings * kSectors);
        for (int64_t i = 0; i < kSamples; ++i) {
            const Vec3 w = uniform_cone(uniforms.two(), width);
            ASSERT_NEAR(w.length(), 1.0f, 1e-6f);
            const double theta = std::atan2(std::hypot(w.x, w.y), w.z);
            ASSERT_LE(theta, half_angle * (1 + 1e-5));
            const double height = 2 * std::pow(std::sin(theta / 2), 2) / width;
            const double turn = std::atan2(w.y, w.x) / (2 * std::numbers::pi) + 0.5;
            ++observed[std::min(int(height * kRings), kRings - 1) * kSectors +
                       std::min(int(turn * kSectors), kSectors - 1)];
        }
        const ChiSquare fit = chi_square(
            observed,
            std::vector<double>(observed.size(), double(kSamples) / double(observed.size())));
        EXPECT_TRUE(fit.passes(sidak(kSignificance, 3))) << half_angle << ": " << fit.text();
    }
}

// Counts over the congruent triangles of a regular subdivision, which have equal areas.
TEST(UniformTriangle, IsEven) {
    Uniforms uniforms(4);
    constexpr int kSide = 8;
    std::vector<int64_t> observed(kSide * kSide);
    for (int64_t i = 0; i < kSamples; ++i) {
        const Vec2 b = uniform_triangle(uniforms.two());
        ASSERT_GE(b.x, 0.0f);
        ASSERT_GE(b.y, 0.0f);
        ASSERT_LE(b.x + b.y, 1.0f + 1e-6f);
        const double x = b.x * kSide, y = std::min<double>(b.y, 1 - b.x) * kSide;
        const int column = std::min(int(x), kSide - 1), row = std::min(int(y), kSide - 1 - column);
        const bool upper = (x - column) + (y - row) > 1 && row + column < kSide - 1;
        // Row r of columns c holds 2 (kSide - c) - 1 triangles; number them within the square of
        // kSide^2.
        int index = 0;
        for (int c = 0; c < column; ++c) index += 2 * (kSide - c) - 1;
        ++observed[index + 2 * row + (upper ? 1 : 0)];
    }
    const ChiSquare fit = chi_square(
        observed, std::vector<double>(observed.size(), double(kSamples) / double(observed.size())));
    EXPECT_TRUE(fit.passes(kSignificance)) << fit.text();
}

// The tests' own tools.
TEST(Numerics, GammaAndQuadratureMatchClosedForms) {
    EXPECT_NEAR_REL(gamma_q(1.0, 3.0), std::exp(-3.0), 1e-12);
    EXPECT_NEAR_REL(gamma_q(0.5, 2.0), std::erfc(std::sqrt(2.0)), 1e-12);
    EXPECT_NEAR_REL(gamma_q(2.0, 0.3), 1.3 * std::exp(-0.3), 1e-12);
    EXPECT_NEAR_REL(integrate([](double x) { return 1 / (1e-4 + x * x); }, -1, 1, 1e-8),
                    2e2 * std::atan(1e2), 1e-9);
    EXPECT_NEAR_REL(sidak(0.05, 10), 1 - std::pow(0.95, 0.1), 1e-12);
    const Frame frame = Frame::around(normalize(Vec3(1, 2, -2)));
    EXPECT_NEAR_REL(integrate_sphere(
                        frame, [](const Vec3& w) { return std::max(w.z, 0.0f); }, 1e-5),
                    std::numbers::pi, 1e-4);
}

// Power: a density that is 5 % off on one hemisphere is found out.
TEST(ChiSquare, FindsASkewOfFivePercent) {
    Uniforms uniforms(5);
    const SphereGrid grid{Frame::around(Vec3(0, 0, 1))};
    const ChiSquare fit = chi_square_sphere(
        grid, kSamples, [&] { return std::optional(uniform_sphere(uniforms.two())); },
        [](const Vec3& w) { return kUniformSpherePdf * (w.x > 0 ? 1.05f : 0.95f); });
    EXPECT_FALSE(fit.passes(1e-6)) << fit.text();
}

}  // namespace
}  // namespace spc::test
