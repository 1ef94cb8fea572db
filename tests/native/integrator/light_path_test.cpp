// SPDX-License-Identifier: GPL-3.0-or-later
// What light paths learn beforehand, and light from images.
#include "agreement/image_of_light.h"

namespace spc::test {
namespace {

// Trials for the light that light paths find, beside sheets of so many emission cells.
double search_trials_beside_sheets(const std::function<void(SceneMaker&)>& add_caster,
                                   uint32_t emission_cells) {
    constexpr uint32_t kSeed = 3;
    SceneMaker maker;
    set_camera(maker);
    add_floor(maker);
    add_caster(maker);
    add_bulb(maker);
    const RenderScene world = maker.finish();
    IntegratorSettings settings = few_bounces();
    settings.manifold = unbiased_manifold();
    settings.manifold.finder = ChainFinder::sheets;
    const SheetPool pool = build_sheets(*world.scene, world.lights, world.casters,
                                        settings.manifold, kSeed, emission_cells, 1);
    LightPathStats stats;
    const std::unique_ptr<const LightPilot> pilot =
        learn_emission(world, settings, {pool}, 0.0f, kLeastPilotPaths, kSeed, 1, Budget(), stats);
    return pilot ? pilot->mean_search_trials : 0.0;
}

// That light paths learn from beside a ball, told to take `paths`.
uint64_t learned_from(const Graph& ball, uint32_t paths) {
    SceneMaker maker;
    set_camera(maker);
    add_floor(maker);
    add_ball(maker, ball);
    add_bulb(maker);
    const RenderScene world = maker.finish();
    LightPathStats stats;
    EXPECT_TRUE(learn_emission(world, few_bounces(), {}, 0.0f, paths, 3, 1, Budget(), stats));
    return stats.paths;
}

TEST(LightPaths, LearnFromAsManyAsTheyAreTold) {
    for (const uint32_t paths : {kLeastPilotPaths, 2 * kLeastPilotPaths})
        EXPECT_EQ(learned_from(mirror(), paths), paths);
}

TEST(LightPaths, LearnFromAQuarterWhereFewComeThrough) {
    const Graph hardly_there = combined(transparent(1.0f), mirror(), 1.0f / 64);
    EXPECT_EQ(learned_from(hardly_there, kLeastPilotPaths), kLeastPilotPaths / 4);
}

TEST(LightPathsSlow, KnowWhatItTakesToFindWhatSheetsMiss) {
    const auto mirror_ball = [](SceneMaker& m) { add_ball(m, mirror()); };
    const auto hammered_ball = [](SceneMaker& m) {
        m.builder.add_image(sphere_normals(320, 0.22, 0.3, 11));
        add_caster(m, with_sphere_uvs(sphere(48, 0.4), 48),
                   normal_mapped(glass(1.5f), Vec2(1.0f, 1.0f)), translation({0, 0, 0.6f}));
    };
    const double of_plain = search_trials_beside_sheets(mirror_ball, 64),
                 of_hammered = search_trials_beside_sheets(hammered_ball, 64);
    EXPECT_GE(of_plain, 1.0);
    EXPECT_LE(of_plain, 2.0);
    EXPECT_GE(of_hammered, 20.0);
}

// The image turned by a quarter shows.
TEST(LightPathsSlow, EmissionFromAnImageHasItsOrientation) {
    std::vector<Picture> pictures;
    for (const bool turned : {false, true}) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        add_panel(maker, mirror());
        image_of_light(turned).add(maker);
        const RenderScene world = maker.finish();
        pictures.push_back(render(world, few_bounces(), kSheets, 500, 1));
    }
    EXPECT_FALSE(same_mean(pictures[0].mean[4], pictures[1].mean[4], sidak(kFamily, 5)));
}

// What comes straight to the floor, by quadrature over the panel.
TEST(LightPathsSlow, EmissionFromAnImageIsThatOfItsTexels) {
    constexpr double kHeight = 1.7, kNoticed = 1.03;
    constexpr uint32_t kSamples = 40000;
    constexpr int kCells = 200;
    SceneMaker maker;
    add_floor(maker);
    add_panel_of_light(maker, rotation_x(kPi, {0.0f, 0.0f, float(kHeight)}));
    const RenderScene world = maker.finish();
    for (const Vec3& p : {Vec3(0.0f), Vec3(0.5f, 0.4f, 0.0f), Vec3(-0.7f, 0.9f, 0.0f)}) {
        std::array<double, 3> expected{};
        for (int j = 0; j < kCells; ++j)
            for (int i = 0; i < kCells; ++i) {
                const double side = 2.0 * double(kPanelOfLight);
                const double x = ((i + 0.5) / kCells - 0.5) * side,
                             y = ((j + 0.5) / kCells - 0.5) * side;
                const double squared =
                    std::pow(x - double(p.x), 2) + std::pow(y - double(p.y), 2) + kHeight * kHeight;
                const double irradiance = std::pow(kHeight * side / (kCells * squared), 2);
                for (size_t c = 0; c < 3; ++c)
                    expected[c] += 0.8 / std::numbers::pi * irradiance *
                                   double(kCornersOfLight[2 * (x > 0.0) + (y > 0.0)][c]);
            }
        std::array<MeanEstimate, 3> found;
        PathStats stats;
        for (uint32_t i = 0; i < kSamples; ++i) {
            const Ray down{p + Vec3(0, 0, 0.01f), {0, 0, -1}};
            const Spectrum radiance =
                path_radiance(world, few_bounces(), {}, down, Vec2(0.5f), Sampler(3, i, 0), stats)
                    .radiance;
            for (int c = 0; c < 3; ++c) found[size_t(c)].add(double(radiance[c]));
        }
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_TRUE(is_mean(found[c], expected[c], sidak(kFamily, 9))) << p << ", channel " << c;
            EXPECT_FALSE(is_mean(found[c], kNoticed * expected[c], sidak(kFamily, 9))) << p;
        }
    }
}

}  // namespace
}  // namespace spc::test
