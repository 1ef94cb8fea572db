// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that shine on some objects alone, and lights whose shadow some objects alone throw.
#include "integrator/pictures.h"

namespace spc::test {
namespace {

struct Light {
    const char* name;
    std::function<void(SceneMaker&, const LightLinks&)> add;  // above the origin
};
std::vector<Light> lights() {
    const auto lamp_of = [](LightType type, float power, const auto& set) {
        LightDesc light = lamp(type, power);
        light.visibility = kVisibleAll;
        set(light);
        return [light](SceneMaker& maker, const LightLinks& links) {
            LightDesc linked = light;
            linked.links = links;
            maker.builder.add_light(linked);
        };
    };
    return {{"point", lamp_of(LightType::point, 100.0f, [](LightDesc&) {})},
            {"sphere", lamp_of(LightType::point, 100.0f, [](LightDesc& l) { l.radius = 0.4f; })},
            {"disk", lamp_of(LightType::spot, 100.0f,
                             [](LightDesc& l) {
                                 l.radius = 0.4f;
                                 l.spot_angle = 2.0f;
                                 l.soft_falloff = true;
                             })},
            {"rectangle",
             lamp_of(LightType::area, 100.0f, [](LightDesc& l) { l.size = Vec2(0.8f, 0.6f); })},
            {"sun", lamp_of(LightType::sun, 3.0f, [](LightDesc& l) { l.sun_angle = 0.4f; })},
            {"glowing square", [](SceneMaker& maker, const LightLinks& links) {
                 maker.links = links;
                 add_glowing(maker, square(0.4f), {0.4f, -0.2f, 1.9f});
                 maker.links = {};
             }}};
}

const Graph& graph_of(const char* name) {
    static const std::map<std::string, Graph> graphs{
        {"matt", diffuse(0.8f)}, {"glossy", mirror(0.3f)}, {"mirror", mirror()}};
    return graphs.at(name);
}
constexpr const char* kSurfaces[] = {"matt", "glossy", "mirror"};

// A mirror does not show what has no size.
bool is_seen_by(const Light& light, const char* surface) {
    return std::string(surface) != "mirror" || std::string(light.name) != "point";
}

// What a floor of the sets scatters, or shows, of a light.
double seen_on_floor(const Light& light, const LightLinks& links, const char* surface,
                     const LinkSets& sets, const std::function<void(SceneMaker&)>& add_more = {}) {
    constexpr uint32_t kSamples = 2000;
    SceneMaker maker;
    maker.sets = sets;
    maker.add(square(4.0f), graph_of(surface), {}, CausticsRole::off);
    maker.sets = {};
    light.add(maker, links);
    if (add_more) add_more(maker);
    const Ray ray = ray_to(Vec3(0.0f, 0.4f, 1.9f), Vec3(0.2f, 0.1f, 0.0f));
    return estimate(maker.finish(), {}, kSamples, ray).radiance.mean();
}

TEST(Linking, ALightShinesOnTheMembersOfItsSets) {
    for (const Light& light : lights())
        for (const char* surface : kSurfaces) {
            const double all = seen_on_floor(light, {}, surface, {});
            const auto on = [&](uint64_t links, uint64_t sets) {
                return seen_on_floor(light, {links, 0}, surface, {sets, 0});
            };
            EXPECT_EQ(all > 0.01, is_seen_by(light, surface)) << light.name << ", " << surface;
            EXPECT_EQ(on(2, 2), all) << light.name << ", " << surface;
            EXPECT_EQ(on(6, 4), all) << light.name << ", " << surface;
            EXPECT_EQ(on(2, 4), 0.0) << light.name << ", " << surface;
            EXPECT_EQ(on(2, 0), 0.0) << light.name << ", " << surface;
            EXPECT_EQ(on(uint64_t{1} << 63, uint64_t{1} << 63), all) << light.name;
        }
}

// A black plate, whole or half, between the floor and the light.
TEST(Linking, OnlyMembersOfItsSetsAreInALightsWay) {
    constexpr double kRounding = 1e-4;
    for (const Light& light : lights())
        for (const char* surface : kSurfaces) {
            const auto behind = [&](uint64_t links, uint64_t sets) {
                return seen_on_floor(light, {0, links}, surface, {}, [&](SceneMaker& maker) {
                    maker.sets = {0, sets};
                    maker.add(square(0.9f), diffuse(0.0f), translation({0.3f, -0.1f, 0.9f}),
                              CausticsRole::off, kVisibleAll & ~uint32_t{kVisibleCamera});
                });
            };
            const double all = seen_on_floor(light, {}, surface, {});
            EXPECT_NEAR(behind(2, 4), all, kRounding * all) << light.name << ", " << surface;
            EXPECT_NEAR(behind(2, 0), all, kRounding * all) << light.name << ", " << surface;
            EXPECT_EQ(behind(6, 4), behind(0, 0)) << light.name << ", " << surface;
            EXPECT_EQ(behind(0, 0) < 0.5 * all, is_seen_by(light, surface))
                << light.name << ", " << surface;
        }
}

// The camera sees a light and what stands before it whatever that is linked to.
TEST(Linking, TheCameraSeesLightsAsTheyAre) {
    for (const Light& light : lights()) {
        if (std::string(light.name) == "point" || std::string(light.name) == "glowing square")
            continue;  // which it does not see
        for (const bool plate : {false, true}) {
            SceneMaker maker;
            light.add(maker, {2, 2});
            if (plate) maker.add(square(0.9f), diffuse(0.0f), translation({0.3f, -0.1f, 0.9f}));
            const Ray up{{0.4f, -0.2f, 0.0f}, {0.0f, 0.0f, 1.0f}};
            const double seen = estimate(maker.finish(), {}, 10, up).radiance.mean();
            EXPECT_EQ(seen > 1.0, !plate) << light.name;
        }
    }
}

// Linked is the caster next to the light.
TEST(LinkingSlow, IsTheSameForAllMethods) {
    constexpr uint64_t kBall = 1, kPane = 2, kPlate = 4;
    struct Case {
        const char* name;
        LightLinks links;
        uint32_t light;  // of lights()
    };
    const Case cases[] = {{"a rectangle on the ball", {kBall, 0}, 3},
                          {"a sphere on the pane", {kPane, 0}, 1},
                          {"a rectangle in the pane's way", {0, kPane}, 3},
                          {"a glowing square in the plate's way", {0, kPlate}, 5},
                          {"a rectangle on the pane, in the plate's way", {kPane, kPlate}, 3}};
    // Light paths do not start where something has to be looked through.
    const Method by_chains[] = {kManifold, {"sheets", true, false, ChainFinder::sheets}};
    const Method methods[] = {kManifold, kLightPaths, kAll, kSheets, kMissed};
    constexpr int kComparisons = 2 * 5 + 3 * 2;
    for (const auto& [name, links, light] : cases) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        maker.sets = {kBall, kBall};
        add_ball(maker, mirror());
        maker.sets = {kPane, kPane};
        add_caster(maker, square(0.6f), refraction(1.4f), rotation_x(0.3f, {0.4f, 0.0f, 0.4f}));
        maker.sets = {kPlate, kPlate};
        maker.add(square(0.15f), diffuse(0.0f), translation({0.2f, -0.1f, 1.4f}), CausticsRole::off,
                  kVisibleAll & ~uint32_t{kVisibleCamera});
        maker.sets = {};
        lights()[light].add(maker, links);
        const RenderScene world = maker.finish();
        const Picture expected = render(world, few_bounces(), kPathTracing, 20000, 1);
        EXPECT_LT(5.0 * expected.mean[4].standard_error(), 0.25 * expected.mean[4].mean())
            << name << ": too little power";
        for (const Method& method : links.blockers != 0 ? std::span<const Method>(by_chains)
                                                        : std::span<const Method>(methods))
            expect_same(render(world, few_bounces(), method, 600, 2), expected,
                        std::string(name) + " by " + method.name, kComparisons);
    }
}

}  // namespace
}  // namespace spc::test
