// SPDX-License-Identifier: GPL-3.0-or-later
// What sheets there are, and what their chain seeds promise.
#include "manifold/sheet_pool.h"
#include "support/casters.h"

#include <gtest/gtest.h>

#include <set>

namespace spc {
namespace {

using test::SceneMaker;

constexpr Vec3 kLamp(0.3f, -0.4f, 1.0f);
constexpr float kMirror = 2.0f;  // height

// Lamps that shine up to a mirror above a floor.
RenderScene below_a_mirror(const std::vector<Vec3>& lamps, float side) {
    SceneMaker maker;
    maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.add(test::square(4.0f), test::mirror(), test::translation({0, 0, kMirror}),
              CausticsRole::caster);
    for (const Vec3& p : lamps) test::add_lamp(maker, p, p + Vec3(0, 0, 1), side);
    return maker.finish();
}

ManifoldSettings settings() {
    ManifoldSettings s;
    s.enabled = true;
    s.finder = ChainFinder::sheets;
    return s;
}

SheetPool sheets_of(const RenderScene& world) {
    constexpr uint32_t kEmissionCells = 1, kSeed = 3;  // as few as there can be
    return build_sheets(*world.scene, world.lights, world.casters, settings(), kSeed,
                        kEmissionCells, 1);
}

TEST(SheetPool, HasAsManySheetsAsALightIsLarge) {
    EXPECT_EQ(sheets_of(below_a_mirror({kLamp}, 0.01f)).size(), 1u);
    EXPECT_EQ(sheets_of(below_a_mirror({kLamp}, 2.0f)).size(), 8u);
    const size_t some = sheets_of(below_a_mirror({kLamp}, 0.12f)).size();
    EXPECT_GT(some, 1u);
    EXPECT_LT(some, 8u);
}

TEST(SheetPool, SpreadsTheSheetsOfALight) {
    const RenderScene world = below_a_mirror({kLamp}, 2.0f);
    const SheetPool sheets = sheets_of(world);
    for (const auto& a : sheets)
        for (const auto& b : sheets) {
            if (a == b) continue;
            EXPECT_GT(length(shift_between(a->light_point(), b->light_point())), 0.4f);
        }
    // Nowhere is the nearest one far: eight discs of half the lamp's side cover it.
    Pcg pcg(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec2 u = pcg.two();
        const auto y = sample_light_point(world.lights, *world.scene, {0.5f, u.x, u.y});
        ASSERT_TRUE(y);
        const LightSheet* nearest = nearest_sheet({sheets}, *y);
        ASSERT_NE(nearest, nullptr);
        EXPECT_LT(length(shift_between(nearest->light_point(), *y)), 1.0f);
    }
}

TEST(SheetPool, SharesALimitAmongManyLights) {
    std::vector<Vec3> lamps;
    for (int i = 0; i < 20; ++i) lamps.push_back(kLamp + Vec3(0.02f * static_cast<float>(i), 0, 0));
    const RenderScene world = below_a_mirror(lamps, 0.01f);
    const SheetPool sheets = sheets_of(world);
    EXPECT_EQ(sheets.size(), 16u);
    std::set<uint32_t> lights;
    for (const auto& sheet : sheets) lights.insert(sheet->light_point().light);
    EXPECT_EQ(lights.size(), 16u);
}

// Behind a flat mirror light arrives as from the lamp's image: radiance cos(y) / distance^2 by area
// across it.
TEST(LightSheet, PromisesTheIrradianceOfTheMirrorImage) {
    const RenderScene world = below_a_mirror({kLamp}, 0.01f);
    const SheetPool sheets = sheets_of(world);
    ASSERT_EQ(sheets.size(), 1u);
    const LightPoint& y = sheets[0]->light_point();
    const Vec3 image(y.p.x, y.p.y, 2.0f * kMirror - y.p.z);
    Pcg pcg(5);
    std::vector<float> ratios;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 x(2.0f * pcg.one() - 1.0f, 2.0f * pcg.one() - 1.0f, 0.0f);
        const float distance = length(image - x), cosine = image.z / distance;
        const Vec3 up = (image - x) * (1.0f / distance);
        const Vec3 away(-up.x, -up.y, up.z);  // as the light leaves y
        const float expected =
            max_component(radiance_at(world.lights, *world.scene, y, away, distance)) * cosine /
            sqr(distance);
        ASSERT_GT(expected, 0.0f);
        const float probability_per_density = 0.25f / expected;  // so that it is a probability
        std::vector<SheetSeed> chain_seeds;
        sheets[0]->find_seeds(x, Vec3(0.0f), probability_per_density, 0.0f, chain_seeds);
        ASSERT_FALSE(chain_seeds.empty());
        EXPECT_TRUE(chain_seeds[0].inside);
        for (const SheetSeed& chain_seed : chain_seeds) EXPECT_EQ(chain_seed.kind->count, 1u);
        ratios.push_back(chain_seeds[0].probability / 0.25f);
    }
    // Two beams share a cell of the light's square evenly, but on the diagonals, where the map from
    // the square to the cone has a crease.
    std::sort(ratios.begin(), ratios.end());
    EXPECT_NEAR(ratios[500], 1.0f, 0.02f);
    EXPECT_GT(ratios[50], 0.9f);
    EXPECT_LT(ratios[950], 1.1f);
    EXPECT_GT(ratios.front(), 0.45f);
    EXPECT_LT(ratios.back(), 2.2f);
}

// A sheet stands for all points of a lamp around its own, however narrow their beams are.
TEST(LightSheet, LeadsToWhatOtherPointsOfANarrowLampShineAt) {
    SceneMaker maker;
    maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.add(test::square(4.0f), test::mirror(), test::translation({0, 0, kMirror}),
              CausticsRole::caster);
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = LightType::area;
    lamp.to_world = test::rotation_x(kPi, kLamp);  // shines up
    lamp.size = Vec2(2.0f, 2.0f);
    lamp.spread = 0.02f;
    maker.builder.add_light(lamp);
    const RenderScene world = maker.finish();
    const SheetPool sheets = sheets_of(world);
    Pcg pcg(6);
    for (int i = 0; i < 1000; ++i) {
        const Vec2 u = pcg.two();
        const auto y = sample_light_point(world.lights, *world.scene, {0.5f, u.x, u.y});
        ASSERT_TRUE(y);
        const LightSheet* sheet = nearest_sheet({sheets}, *y);
        ASSERT_NE(sheet, nullptr);
        std::vector<SheetSeed> chain_seeds;
        sheet->find_seeds({y->p.x, y->p.y, 0.0f}, shift_between(sheet->light_point(), *y), 1.0f,
                          0.0f, chain_seeds);
        EXPECT_FALSE(chain_seeds.empty());
    }
}

TEST(LightSheet, LeavesSeedsToOneRandomNumber) {
    const RenderScene world = below_a_mirror({kLamp}, 0.01f);
    const SheetPool sheets = sheets_of(world);
    ASSERT_EQ(sheets.size(), 1u);
    const Vec3 x(0.4f, 0.1f, 0.0f);
    const auto chain_seeds = [&](float probability_per_density, float u) {
        std::vector<SheetSeed> found;
        sheets[0]->find_seeds(x, Vec3(0.0f), probability_per_density, u, found);
        return found;
    };
    const std::vector<SheetSeed> all = chain_seeds(std::numeric_limits<float>::max(), 0.999f);
    ASSERT_FALSE(all.empty());
    for (const SheetSeed& chain_seed : all) EXPECT_EQ(chain_seed.probability, 1.0f);
    for (const SheetSeed& chain_seed : chain_seeds(1e-30f, 0.0f))
        EXPECT_EQ(chain_seed.probability, 1.0f / 512);
    EXPECT_TRUE(chain_seeds(1e-30f, 1.0f / 512).empty());
    float probability_per_density = 1.0f;
    while (chain_seeds(probability_per_density, 0.0f)[0].probability > 0.5f)
        probability_per_density *= 0.5f;
    const float probability = chain_seeds(probability_per_density, 0.0f)[0].probability;
    EXPECT_FALSE(chain_seeds(probability_per_density, 0.99f * probability).empty());
    EXPECT_TRUE(chain_seeds(probability_per_density, probability).empty());
}

}  // namespace
}  // namespace spc
