// SPDX-License-Identifier: GPL-3.0-or-later
// Light that rough mirrors and glass throw on: light paths against path tracing alone.
#include "integrator/pictures.h"
#include "support/rough.h"

namespace spc::test {
namespace {

Graph principled(float roughness, float metallic) {
    return single_shader("bsdf_principled", {{1, "Roughness", {roughness, 0, 0, 0}},
                                             {1, "Metallic", {metallic, 0, 0, 0}}});
}

struct Setup {
    const char* name;
    std::function<void(SceneMaker&)> build;
};

Setup metal_panel_under(const char* name, const LightDesc& light) {
    return {name, [light](SceneMaker& m) {
                add_panel(m, metal(0.2f));
                m.builder.add_light(light);
            }};
}

std::vector<Setup> lights() {
    LightDesc sun = lamp(LightType::sun, 3.0f), disc = sun, area = lamp(LightType::area, 100.0f),
              bulb = lamp(LightType::point, 100.0f);
    disc.sun_angle = 0.25f;
    area.size = Vec2(0.7f, 0.4f);
    bulb.radius = 0.3f;
    return {metal_panel_under("point", lamp(LightType::point, 100.0f)),
            metal_panel_under("bulb", bulb),
            metal_panel_under("sun without size", sun),
            metal_panel_under("sun", disc),
            metal_panel_under("area", area),
            {"emissive mesh", [](SceneMaker& m) {
                 add_panel(m, metal(0.2f));
                 add_glowing(m, flat(square(0.3f)), {0.4f, -0.2f, 1.9f});
             }}};
}

std::vector<Setup> casters() {
    const Graph half = combined(metal(0.15f), diffuse(0.8f), 0.5f);
    return {{"smoother metal",
             [](SceneMaker& m) {
                 add_panel(m, metal(0.1f));
                 add_bulb(m, {0, -0.7f, 2.2f}, 0.3f);
             }},
            {"ball of metal",
             [](SceneMaker& m) {
                 add_ball(m, metal(0.2f));
                 add_bulb(m);
             }},
            {"two of metal",
             [](SceneMaker& m) {
                 add_panel(m, metal(0.15f));
                 add_caster(m, square(0.5f), metal(0.3f), rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
                 add_bulb(m, {0, -0.2f, 1.8f}, 0.2f);
             }},
            {"metal that is diffuse, too",
             [half](SceneMaker& m) {
                 add_panel(m, half);
                 add_bulb(m, {0, -0.7f, 2.2f}, 0.2f, kVisibleAll);
             }},
            {"frosted slab",
             [](SceneMaker& m) {
                 add_caster(m, slab(0.6f, 0.2f), frosted_glass(0.2f),
                            rotation_x(0.4f, {0, 0.1f, 0.8f}));
                 add_bulb(m, {0.3f, 0.2f, 2.2f}, 0.2f);
             }},
            {"beside a mirror", [](SceneMaker& m) {
                 add_panel(m, metal(0.15f));
                 add_ball(m, mirror());
                 add_bulb(m, {0.4f, -0.7f, 2.2f}, 0.3f);
             }}};
}

// Floor, two interactions with glass, and the light.
IntegratorSettings rough_bounces() {
    IntegratorSettings settings = few_bounces();
    settings.limits.diffuse = 3;
    return settings;
}

void expect_agreement(const std::vector<Setup>& setups, const IntegratorSettings& settings) {
    constexpr uint32_t kRounds = 2000;
    for (const Setup& setup : setups) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        setup.build(maker);
        const RenderScene world = maker.finish();
        const Picture expected = path_traced(setup.name, world, settings, 24 * kRounds);
        const Picture actual = render(world, settings, kSheets, kRounds, 1u << 20);
        expect_same(actual, expected, setup.name, int(setups.size()));
        expect_light_paths_to_matter(actual, expected, setup.name);
    }
}

TEST(RoughCastersSlow, AgreeWithPathTracingUnderEveryLight) {
    expect_agreement(lights(), rough_bounces());
}
TEST(RoughCastersSlow, AgreeWithPathTracingForEveryCaster) {
    expect_agreement(casters(), rough_bounces());
}

// Of the same scene with the same budget, light paths leave less to chance.
TEST(RoughCastersSlow, AreQuieterWithLightPaths) {
    SceneMaker maker;
    set_camera(maker);
    add_floor(maker);
    casters()[0].build(maker);
    const RenderScene world = maker.finish();
    const Picture with = render(world, rough_bounces(), kLightPaths, 500, 1),
                  without = render(world, rough_bounces(), kPathTracing, 500, 1);
    EXPECT_LT(with.mean[4].standard_error(), 0.5 * without.mean[4].standard_error());
}

// What throws nothing sharper than a wall does is no caster.
TEST(RoughCasters, AreThoseWithNarrowLobes) {
    const auto is_caster = [](const Graph& graph, CausticsRole role) {
        SceneMaker maker;
        maker.add(square(1.0f), graph, {}, role);
        return maker.finish().scene->instances[0].rough_caster;
    };
    EXPECT_TRUE(is_caster(metal(0.2f), CausticsRole::automatic));
    EXPECT_TRUE(is_caster(frosted_glass(0.3f), CausticsRole::automatic));
    EXPECT_TRUE(is_caster(combined(metal(0.2f), diffuse(0.8f), 0.5f), CausticsRole::caster));
    EXPECT_FALSE(is_caster(metal(0.2f), CausticsRole::off));
    EXPECT_FALSE(is_caster(metal(0.2f), CausticsRole::receiver));
    EXPECT_TRUE(is_caster(refraction(1.4f, 0.2f), CausticsRole::automatic));
    EXPECT_TRUE(is_caster(principled(0.2f, 1.0f), CausticsRole::automatic));
    EXPECT_FALSE(is_caster(principled(0.2f, 0.0f), CausticsRole::automatic));
    EXPECT_FALSE(is_caster(metal(0.5f), CausticsRole::automatic));
    EXPECT_FALSE(is_caster(mirror(), CausticsRole::automatic));
    EXPECT_FALSE(is_caster(diffuse(0.8f), CausticsRole::automatic));
}

}  // namespace
}  // namespace spc::test
