// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/rectangle.h"

#include "support/numerics.h"

namespace spc::test {
namespace {

// Signed solid angle between the foot of the perpendicular and a corner.
double corner(double x, double y, double z) {
    return std::atan2(x * y, z * std::sqrt(x * x + y * y + z * z));
}
double solid_angle(double x0, double x1, double y0, double y1, double z) {
    return corner(x1, y1, z) - corner(x0, y1, z) - corner(x1, y0, z) + corner(x0, y0, z);
}

// A box's six faces, seen from within, share the sphere.
TEST(SphericalRectangle, FacesOfABoxFillTheSphere) {
    const Vec3 low(-0.3f, -0.7f, -0.2f), high(0.9f, 0.4f, 0.5f);
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        sum += SphericalRectangle(low[a], high[a], low[b], high[b], high[axis]).solid_angle;
        sum += SphericalRectangle(low[a], high[a], low[b], high[b], -low[axis]).solid_angle;
    }
    EXPECT_NEAR(sum, 4 * std::numbers::pi, 2e-6);
}

// The sampler inverts the two cumulative shares, in double here; its error in either share is
// bounded.
TEST(SphericalRectangle, SamplesInvertTheirCumulativeShares) {
    Uniforms uniforms(1);
    int tested = 0;
    double worst_x = 0, worst_y = 0, worst_angle = 0;
    for (int i = 0; i < 300000; ++i) {
        const float w = std::exp(4 * (uniforms() - 0.5f)), h = std::exp(4 * (uniforms() - 0.5f));
        const float x0 = 10 * (uniforms() - 0.5f) - w / 2, y0 = 10 * (uniforms() - 0.5f) - h / 2;
        const float x1 = x0 + w, y1 = y0 + h, z = std::exp(2 - 12 * uniforms());
        const SphericalRectangle rectangle(x0, x1, y0, y1, z);
        const double exact = solid_angle(x0, x1, y0, y1, z);
        if (exact < kLeastRectangleSolidAngle) continue;
        ++tested;
        worst_angle = std::max(worst_angle, std::abs(rectangle.solid_angle / exact - 1));
        const Vec2 u = uniforms.two();
        const Vec2 q = rectangle.sample(u);
        ASSERT_TRUE(q.x >= x0 && q.x <= x1 && q.y >= y0 && q.y <= y1);
        worst_x = std::max(worst_x, std::abs(solid_angle(x0, q.x, y0, y1, z) / exact - u.x));
        const double d2 = double(q.x) * q.x + double(z) * z;
        const auto elevation = [&](double y) { return y / std::sqrt(d2 + y * y); };
        worst_y = std::max(
            worst_y,
            std::abs((elevation(q.y) - elevation(y0)) / (elevation(y1) - elevation(y0)) - u.y));
    }
    EXPECT_GT(tested, 10000);
    EXPECT_LT(worst_angle, 3e-5);
    EXPECT_LT(worst_x, 3e-3);
    EXPECT_LT(worst_y, 5e-4);
}

TEST(SphericalRectangle, CornersOfTheUnitSquareAreCorners) {
    const SphericalRectangle rectangle(-0.5f, 1.0f, -2.0f, 0.3f, 0.7f);
    for (const float s : {0.0f, 1.0f})
        for (const float t : {0.0f, 1.0f}) {
            const Vec2 q = rectangle.sample({s, t});
            EXPECT_NEAR(q.x, s == 0 ? -0.5f : 1.0f, 1e-5f);
            EXPECT_NEAR(q.y, t == 0 ? -2.0f : 0.3f, 1e-5f);
        }
}

}  // namespace
}  // namespace spc::test
