// SPDX-License-Identifier: GPL-3.0-or-later
// What casters know of themselves, on those of the example scenes.
#include "manifold/caster.h"

#include "support/casters.h"
#include "support/rough.h"

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

constexpr double kWavelength = 0.5, kSlope = 0.1;
constexpr uint64_t kSeed = 7;

// A square metre of rough metal, or of frosted glass, whose map comes back so many times along a
// side.
RenderScene mapped_square(const Graph& graph, float repeat) {
    test::SceneMaker maker;
    maker.builder.add_image(test::plane_normals(64, kWavelength, kSlope, kSeed));
    const Mesh square = test::with_uvs(test::grid(
                                           1, [](double u, double v) { return Vec3d(u, v, 0.0); },
                                           [](double, double) { return Vec3d(0, 0, 1); }),
                                       1);
    maker.add(square, test::normal_mapped(graph, Vec2(repeat, repeat)), {}, CausticsRole::caster);
    maker.add_area_light(test::rotation_x(kPi, Vec3(0, 0, 2)), 0.2f, 1.0f);
    return maker.finish();
}
// As the report tells.
double chains_at_facets(const RenderScene& world) {
    const std::string before = "whose map makes some ";
    for (const std::string& line : world.scene->report)
        if (const size_t at = line.find(before); at != std::string::npos)
            return std::stod(line.substr(at + before.size()));
    ADD_FAILURE() << "the report says nothing of the map";
    return 0.0;
}

TEST(RoughChainCasters, AreThoseWhoseMapMakesFewChains) {
    const Graph metal = test::metal(0.2f);
    const RenderScene coarse = mapped_square(metal, 1.0f), fine = mapped_square(metal, 8.0f);
    EXPECT_EQ(coarse.rough_chain_casters.casters.size(), 1u);
    EXPECT_TRUE(fine.rough_chain_casters.empty());
    // As many as there are waves, of which eight times as many along a side are 64 times as many.
    EXPECT_NEAR(chains_at_facets(fine) / chains_at_facets(coarse), 64.0, 5.0);
    // Glass of index 1.45 needs slopes 5.4 times as steep as a mirror's for the same turn.
    const RenderScene glass = mapped_square(test::frosted_glass(0.2f), 8.0f);
    EXPECT_NEAR(chains_at_facets(fine) / chains_at_facets(glass), std::pow(2.45 / 0.45, 2), 1.0);
    EXPECT_EQ(glass.rough_chain_casters.casters.size(), 1u);
}

// Against a quadrature of the waves that the map was made of.
TEST(RoughChainCasters, CountThePlacesOfASlope) {
    const RenderScene world = mapped_square(test::metal(0.2f), 1.0f);
    const test::Waves waves = test::plane_waves(kWavelength, kSlope, kSeed);
    const auto slope = [&](double u, double v) { return waves.gradient(Vec3d(u, v, 0.0)); };
    constexpr int kSteps = 200;
    constexpr double h = 1e-4;
    double bends = 0.0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double u = (i + 0.5) / kSteps, v = (j + 0.5) / kSteps;
            const Vec3d du = (slope(u + h, v) - slope(u - h, v)) / (2 * h),
                        dv = (slope(u, v + h) - slope(u, v - h)) / (2 * h);
            bends += std::abs(du.x * dv.y - du.y * dv.x) / (kSteps * kSteps);
        }
    // Points as far away as the bounding sphere's radius, half a diagonal.
    EXPECT_NEAR(chains_at_facets(world) / (0.5 * bends), 1.0, 0.1);
}

}  // namespace
}  // namespace spc
