// SPDX-License-Identifier: GPL-3.0-or-later
// What casters know of themselves, on those of the example scenes.
#include "manifold/caster.h"

#include "support/casters.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

// Of some thousand random points.
void expect_slopes(const Caster& caster, double rms) {
    EXPECT_TRUE(caster.mapped_normal);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(caster.slope_mean[i], 0.0, 0.1 * rms) << "axis " << i;
    const auto x = double(caster.slope_deviation.x), y = double(caster.slope_deviation.y);
    EXPECT_NEAR(std::sqrt(0.5 * (x * x + y * y)), rms, 0.05 * rms);
}

TEST(Caster, MeasuresTheSlopesOfItsNormalMap) {
    expect_slopes(test::reflective_plane().world.casters.casters.at(0), test::kPanelSlope);
    expect_slopes(test::refractive_sphere().world.casters.casters.at(0), test::kSphereSlope);
}

TEST(Caster, WithoutANormalMapHasNoSlopes) {
    const test::CausticScene scene = test::smooth_ring();
    const Caster& caster = scene.world.casters.casters.at(0);
    EXPECT_FALSE(caster.mapped_normal);
    EXPECT_EQ(caster.slope_deviation, Vec2(0.0f));
}

}  // namespace
}  // namespace spc
