// SPDX-License-Identifier: GPL-3.0-or-later
// What counts as a rough caster, and what light paths are worth there.
#include "integrator/pictures.h"
#include "support/rough.h"

namespace spc::test {
namespace {

Graph principled(float roughness, float metallic) {
    return single_shader("bsdf_principled", {{1, "Roughness", {roughness, 0, 0, 0}},
                                             {1, "Metallic", {metallic, 0, 0, 0}}});
}

// Of the same scene with the same budget, light paths leave less to chance.
TEST(RoughCastersSlow, AreQuieterWithLightPaths) {
    SceneMaker maker;
    set_camera(maker);
    add_floor(maker);
    add_panel(maker, metal(0.1f));
    add_bulb(maker, {0, -0.7f, 2.2f}, 0.3f);
    const RenderScene world = maker.finish();
    IntegratorSettings settings = few_bounces();
    settings.limits.diffuse = 3;  // as light paths count the metal's
    const Picture with = render(world, settings, kLightPaths, 500, 1),
                  without = render(world, settings, kPathTracing, 500, 1);
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
