// SPDX-License-Identifier: GPL-3.0-or-later
// Bounce limits, ray visibility and the caustics switches, with Cycles' meaning.
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kSignificance = 1e-5;

IntegratorSettings limited(uint32_t BounceLimits::*kind, uint32_t limit) {
    IntegratorSettings settings = test::unlimited();
    settings.limits.*kind = limit;
    return settings;
}

// In a closed room each bounce adds its term of the series, whatever the direction: n bounces and
// the light at their end make n + 2 terms.
TEST(BounceLimits, DiffuseSeries) {
    constexpr double kEmission = 0.5, kAlbedo = 0.7;
    SceneMaker maker;
    maker.add(
        test::flat(test::sphere(5, 2.0)),
        test::combined(test::emission(float(kEmission)), test::diffuse(float(kAlbedo)), -1.0f));
    const RenderScene world = maker.finish();
    const Ray ray = test::ray_to({0.1f, 0.2f, 0.3f}, {1.0f, 0.5f, -0.3f});
    for (uint32_t limit = 0; limit < 4; ++limit) {
        double expected = 0.0;
        for (uint32_t i = 0; i <= limit + 1; ++i)
            expected += kEmission * std::pow(kAlbedo, double(i));
        for (const IntegratorSettings& settings :
             {limited(&BounceLimits::total, limit), limited(&BounceLimits::diffuse, limit)}) {
            const test::RadianceEstimate e = test::estimate(world, settings, 20000, ray);
            EXPECT_TRUE(test::is_mean(e.radiance, expected, kSignificance, 1e-4))
                << "limit " << limit;
        }
        // The limits of other kinds of bounces have no say.
        for (const auto kind :
             {&BounceLimits::glossy, &BounceLimits::transmission, &BounceLimits::transparent}) {
            const test::RadianceEstimate e = test::estimate(world, limited(kind, 0), 5000, ray);
            EXPECT_TRUE(test::is_mean(e.radiance, kEmission / (1 - kAlbedo), kSignificance, 1e-3));
        }
    }
}

// Sheets under a white world, seen from below: which number of them still lets the light through.
bool light_passes(const Graph& material, int sheets, const IntegratorSettings& settings) {
    SceneMaker maker;
    for (int i = 0; i < sheets; ++i)
        maker.add(test::square(10.0f), material, test::translation(Vec3(0, 0, float(i))));
    test::set_world(maker, 1.0f);
    const test::RadianceEstimate e = test::estimate(
        maker.finish(), settings, 50, test::ray_to({0.0f, 0.0f, -1.0f}, {0.1f, 0.2f, 0.0f}));
    EXPECT_TRUE(e.radiance.mean() == 0.0 || e.radiance.mean() > 0.99) << e.radiance.mean();
    return e.radiance.mean() > 0.5;
}

TEST(BounceLimits, TransparentSheets) {
    for (uint32_t limit = 0; limit < 4; ++limit)
        for (int sheets = 0; sheets < 7; ++sheets)
            EXPECT_EQ(light_passes(test::transparent(1.0f), sheets,
                                   limited(&BounceLimits::transparent, limit)),
                      sheets <= int(limit))
                << sheets << " sheets, limit " << limit;
    EXPECT_TRUE(light_passes(test::transparent(1.0f), 6, limited(&BounceLimits::total, 0)));
}

// A lamp above sheets lights the floor below them by shadow rays and by scattered rays, which must
// pass as many: all of its light, or none.
TEST(BounceLimits, ShadowRaysPassAsManySheetsAsPaths) {
    const auto below = [](int sheets, uint32_t limit, float radius) {
        SceneMaker maker;
        maker.add(test::square(4.0f), test::diffuse(1.0f));
        for (int i = 0; i < sheets; ++i)
            maker.add(test::square(40.0f), test::transparent(1.0f),
                      test::translation(Vec3(0, 0, 1.0f + 0.1f * float(i))));
        LightDesc light;
        light.name = "bulb";
        light.radius = radius;
        light.to_world = test::translation(Vec3(0, 0, 4));
        light.power = Spectrum(100.0f);
        maker.builder.add_light(light);
        return test::estimate(maker.finish(), limited(&BounceLimits::transparent, limit), 2000,
                              test::ray_to({0.3f, 0.0f, 0.5f}, {0.0f, 0.0f, 0.0f}))
            .radiance;
    };
    for (const float radius : {0.0f, 1.0f, 2.5f}) {
        const double lit = below(0, 0, radius).mean();
        for (uint32_t limit = 0; limit < 3; ++limit)
            for (int sheets = 0; sheets < 5; ++sheets) {
                const double expected = sheets <= int(limit) ? lit : 0.0;
                EXPECT_TRUE(test::is_mean(below(sheets, limit, radius), expected, kSignificance,
                                          0.02 * expected))
                    << sheets << " sheets, limit " << limit << ", radius " << radius;
            }
    }
}

TEST(BounceLimits, RefractingSheets) {
    for (uint32_t limit = 0; limit < 3; ++limit)
        for (int sheets = 1; sheets < 6; ++sheets) {
            for (const IntegratorSettings& settings : {limited(&BounceLimits::transmission, limit),
                                                       limited(&BounceLimits::total, limit)})
                EXPECT_EQ(light_passes(test::refraction(1.2f), sheets, settings),
                          sheets <= int(limit) + 1)
                    << sheets << " sheets, limit " << limit;
            EXPECT_TRUE(
                light_passes(test::refraction(1.2f), sheets, limited(&BounceLimits::glossy, 0)));
        }
}

// Between two mirrors a ray zigzags upward and leaves at their end.
TEST(BounceLimits, Mirrors) {
    SceneMaker maker;
    Transform facing_right = test::rotation_x(0.0f), facing_left = test::rotation_x(0.0f);
    facing_right.row = {Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0)};
    facing_left.row = {Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0)};
    facing_right.translation = Vec3(-0.5f, 0, 0);
    facing_left.translation = Vec3(0.5f, 0, 0);
    maker.add(test::square(2.0f), test::mirror(), facing_right);
    maker.add(test::square(2.0f), test::mirror(), facing_left);
    test::set_world(maker, 1.0f);
    const RenderScene world = maker.finish();
    // Rises 1 for each crossing of 1: four reflections between z = -1.5 and 2.
    const Ray ray{{0.0f, 0.0f, -2.0f}, normalize(Vec3(1, 0, 1))};
    for (uint32_t limit = 0; limit < 6; ++limit)
        for (const auto kind : {&BounceLimits::glossy, &BounceLimits::total}) {
            const test::RadianceEstimate e = test::estimate(world, limited(kind, limit), 4, ray);
            EXPECT_NEAR(e.radiance.mean(), limit + 1 >= 4 ? 1.0 : 0.0, 1e-5) << "limit " << limit;
        }
}

// ---- visibility

// A floor that scatters as `floor` says below a glowing sheet, seen by the floor alone.
double radiance_below(const Graph& floor, uint32_t visibility,
                      void (*add_light)(SceneMaker&, uint32_t)) {
    SceneMaker maker;
    maker.add(test::square(1.0f), floor);
    add_light(maker, visibility);
    return test::estimate(maker.finish(), test::unlimited(), 3000,
                          test::ray_to({0.2f, 0.0f, 0.5f}, {0.0f, 0.0f, 0.0f}))
        .radiance.mean();
}
void glowing_mesh(SceneMaker& maker, uint32_t visibility) {
    Instance sheet;
    sheet.name = "glow";
    sheet.mesh = maker.builder.add_mesh(test::square(4.0f));
    sheet.object_to_world = test::translation(Vec3(0, 0, 1));
    sheet.materials = {maker.builder.add_material(test::emission(1.0f))};
    sheet.visibility = visibility;
    maker.builder.add_instance(sheet);
}
void area_lamp(SceneMaker& maker, uint32_t visibility) {
    LightDesc light;
    light.name = "panel";
    light.type = LightType::area;
    light.to_world = test::translation(Vec3(0, 0, 1));
    light.size = Vec2(8.0f, 8.0f);
    light.power = Spectrum(64.0f * kPi);
    light.visibility = visibility;
    maker.builder.add_light(light);
}
void white_world(SceneMaker& maker, uint32_t visibility) {
    test::set_world(maker, 1.0f, visibility);
}

TEST(Visibility, LightsShowThemselvesToTheirKindsOfRays) {
    const Graph rough = test::single_shader(
        "bsdf_glossy", {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {0.4f, 0, 0, 0}}});
    const Graph behind = test::refraction(1.3f);
    struct Case {
        const char* name;
        Graph floor;
        uint32_t seen_by;
    };
    const Case floors[] = {{"diffuse", test::diffuse(1.0f), kVisibleDiffuse},
                           {"mirror", test::mirror(), kVisibleGlossy},
                           {"rough metal", rough, kVisibleGlossy}};
    const std::pair<const char*, void (*)(SceneMaker&, uint32_t)> lights[] = {
        {"mesh", glowing_mesh}, {"area lamp", area_lamp}, {"world", white_world}};
    for (const Case& floor : floors)
        for (const auto& [name, add] : lights) {
            EXPECT_GT(radiance_below(floor.floor, kVisibleAll, add), 0.5)
                << floor.name << ", " << name;
            EXPECT_GT(radiance_below(floor.floor, floor.seen_by, add), 0.5)
                << floor.name << ", " << name << " shown to it alone";
            EXPECT_EQ(radiance_below(floor.floor, kVisibleAll & ~floor.seen_by, add), 0.0)
                << floor.name << ", " << name << " hidden from it alone";
        }
}

// A floor of two kinds of scattering under lights that one of them alone sees: as much as a floor
// of that half alone, whichever way the light is found.
TEST(VisibilitySlow, MixedFloorsSeeEachLightByTheirOwnHalf) {
    const Graph rough = test::single_shader(
        "bsdf_glossy", {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {0.3f, 0, 0, 0}}});
    const Graph black = test::diffuse(0.0f);
    const Graph matt = test::diffuse(0.8f);
    const std::pair<const char*, void (*)(SceneMaker&, uint32_t)> lights[] = {
        {"mesh", glowing_mesh}, {"area lamp", area_lamp}, {"world", white_world}};
    const auto below = [](const Graph& floor, uint32_t visibility,
                          void (*add_light)(SceneMaker&, uint32_t)) {
        SceneMaker maker;
        maker.add(test::square(1.0f), floor);
        add_light(maker, visibility);
        return test::estimate(maker.finish(), test::unlimited(), 100000,
                              test::ray_to({0.2f, 0.0f, 0.5f}, {0.0f, 0.0f, 0.0f}))
            .radiance;
    };
    const Graph mixed = test::combined(matt, rough, 0.3f);
    for (const auto& [name, add] : lights)
        for (const bool diffuse : {true, false}) {
            const uint32_t kind = diffuse ? kVisibleDiffuse : kVisibleGlossy;
            const Graph half =
                diffuse ? test::combined(matt, black, 0.3f) : test::combined(black, rough, 0.3f);
            const test::MeanEstimate expected = below(half, kVisibleAll, add);
            const test::MeanEstimate found = below(mixed, kind | kVisibleShadow, add);
            const double error = std::hypot(expected.standard_error(), found.standard_error());
            EXPECT_NEAR(found.mean(), expected.mean(), 5.0 * error + 1e-4)
                << name << (diffuse ? ", diffuse" : ", glossy");
            EXPECT_LT(5.0 * error, 0.03 * expected.mean()) << "too little power";
        }
}

// The same with a red and a blue half: light that one of them alone sees never has the other's
// colour, by whichever rays.
TEST(Visibility, MixedFloorsKeepTheColourOfTheHalfThatSees) {
    const Graph red = test::single_shader("bsdf_diffuse", {{1, "Color", {0.8f, 0, 0, 1}}});
    const Graph blue = test::single_shader(
        "bsdf_glossy", {{1, "Color", {0, 0, 1, 1}}, {1, "Roughness", {0.3f, 0, 0, 0}}});
    for (const auto add : {glowing_mesh, area_lamp, white_world})
        for (const bool diffuse : {true, false}) {
            SceneMaker maker;
            maker.add(test::square(1.0f), test::combined(red, blue, 0.5f));
            add(maker, (diffuse ? kVisibleDiffuse : kVisibleGlossy) | kVisibleShadow);
            const RenderScene world = maker.finish();
            const Ray ray = test::ray_to({0.2f, 0.0f, 0.5f}, {0.0f, 0.0f, 0.0f});
            PathStats stats;
            Spectrum sum(0.0f);
            for (uint32_t i = 0; i < 2000; ++i)
                sum += path_radiance(world, test::unlimited(), {}, ray, Vec2(0.5f),
                                     Sampler(1, i, 0), stats)
                           .radiance;
            EXPECT_GT(diffuse ? sum.x : sum.z, 100.0f);
            EXPECT_EQ(diffuse ? sum.z : sum.x, 0.0f);
        }
}

TEST(Visibility, CameraAndTransmission) {
    const auto radiance = [](bool through_glass, uint32_t visibility,
                             void (*add)(SceneMaker&, uint32_t)) {
        SceneMaker maker;
        if (through_glass) maker.add(test::square(1.0f), test::refraction(1.3f));
        add(maker, visibility);
        return test::estimate(maker.finish(), test::unlimited(), 4,
                              test::ray_to({0.1f, 0.0f, -0.5f}, {0.0f, 0.0f, 0.0f}))
            .radiance.mean();
    };
    for (const auto add : {glowing_mesh, area_lamp, white_world})
        for (const auto& [glass, kind] :
             {std::pair{false, kVisibleCamera}, std::pair{true, kVisibleTransmission}}) {
            EXPECT_NEAR(radiance(glass, kind, add), 1.0, 1e-4);
            EXPECT_EQ(radiance(glass, kVisibleAll & ~uint32_t(kind), add), 0.0);
        }
}

// ---- caustics switches

struct Pool {
    Graph caster;
    Transform transform;
};

test::RadianceEstimate floor_beside(const Pool& pool, bool reflective, bool refractive,
                                    bool manifold, float lamp_radius) {
    SceneMaker maker;
    maker.add(test::square(3.0f), test::diffuse(0.8f));
    maker.add(test::square(1.0f), pool.caster, pool.transform);
    LightDesc light;
    light.name = "bulb";
    light.to_world = test::translation(Vec3(0.0f, 0.0f, 2.0f));
    light.radius = lamp_radius;
    light.power = Spectrum(50.0f);
    maker.builder.add_light(light);
    IntegratorSettings settings =
        test::unlimited(manifold ? test::unbiased_manifold() : ManifoldSettings{});
    settings.manifold.reflections = reflective;
    settings.manifold.refractions = refractive;
    return test::estimate(maker.finish(), settings, 20000,
                          test::ray_to({1.0f, 0.1f, 0.3f}, {0.0f, 0.0f, 0.0f}));
}

TEST(CausticsSwitches, TurnOffEveryWayToTheLight) {
    Transform upright;
    upright.row = {Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0)};  // faces -x
    upright.translation = Vec3(1.2f, 0, 1.0f);
    const Graph rough = test::single_shader(
        "bsdf_glossy", {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {0.3f, 0, 0, 0}}});
    const Graph rough_glass = test::single_shader(
        "bsdf_refraction",
        {{1, "Color", {1, 1, 1, 1}}, {1, "Roughness", {0.3f, 0, 0, 0}}, {1, "IOR", {1.4f, 0, 0, 0}}});
    struct Case {
        const char* name;
        Pool pool;
        bool reflects;
    };
    const Transform above = test::translation(Vec3(0.0f, 0.0f, 1.0f));
    const Case cases[] = {{"mirror", {test::mirror(), upright}, true},
                          {"rough mirror", {rough, upright}, true},
                          {"refracting sheet", {test::refraction(1.4f), above}, false},
                          {"rough refracting sheet", {rough_glass, above}, false}};
    for (const Case& c : cases)
        for (const bool manifold : {false, true})
            for (const float radius : {0.0f, 0.2f}) {
                const std::string name = std::string(c.name) +
                                         (manifold ? ", manifold" : ", path tracing") +
                                         ", radius " + std::to_string(radius);
                // Nothing at all comes back from something black.
                const double direct =
                    floor_beside({test::diffuse(0.0f), c.pool.transform}, true, true, false, radius)
                        .radiance.mean();
                const test::RadianceEstimate off =
                    floor_beside(c.pool, !c.reflects, c.reflects, manifold, radius);
                EXPECT_TRUE(test::is_mean(off.radiance, direct, kSignificance, 0.01 * direct + 1e-6))
                    << name;
                EXPECT_EQ(off.caustics.mean(), 0.0) << name;
                if (!manifold && radius == 0.0f &&
                    (c.name == std::string("mirror") || c.name == std::string("refracting sheet")))
                    continue;
                const test::RadianceEstimate on =
                    floor_beside(c.pool, c.reflects, !c.reflects, manifold, radius);
                EXPECT_GT(on.radiance.mean(), 1.02 * direct + 1e-4) << name;
            }
}

}  // namespace
}  // namespace spc
