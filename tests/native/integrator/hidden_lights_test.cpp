// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that something hides from close by: what stands before them, what they lie in, and what
// they shine through.
#include "integrator/pictures.h"

namespace spc::test {
namespace {

struct Light {
    const char* name;
    std::function<void(SceneMaker&, const Transform&, float scale)> add;  // shines along -z
};
std::vector<Light> lights_of_some_extent() {
    const auto lamp = [](LightDesc light) {
        return [light](SceneMaker& maker, const Transform& place, float scale) {
            LightDesc own = light;
            own.to_world = place;
            own.size = Vec2(0.2f * scale);
            own.power = Spectrum(100.0f * scale * scale);
            maker.builder.add_light(own);
        };
    };
    LightDesc area, disc, point;
    area.type = disc.type = LightType::area;
    disc.shape = AreaShape::ellipse;
    return {{"rectangle", lamp(area)},
            {"disc", lamp(disc)},
            {"point", lamp(point)},
            {"glowing square", [](SceneMaker& maker, const Transform& place, float scale) {
                 maker.add(square(0.1f * scale), emission(100.0f), place);
             }}};
}

// A black plate is a thousandth of a lamp's extent before it, and less than a hundred-thousandth of
// the way.
TEST(HiddenLights, APlateCloseBeforeThemLeavesNothing) {
    struct Place {
        float distance, gap;  // m
    };
    IntegratorSettings settings;
    for (const auto& [distance, gap] :
         {Place{1.0f, 1.5e-5f}, Place{1.0f, 1e-3f}, Place{10.0f, 1e-4f}, Place{100.0f, 1e-3f}})
        for (const Light& light : lights_of_some_extent())
            for (const bool hidden : {false, true}) {
                SceneMaker maker;
                maker.add(square(2.0f * distance), diffuse(0.8f));
                light.add(maker, translation({0.0f, 0.0f, distance}), distance);
                if (hidden)
                    maker.add(square(0.2f * distance), diffuse(0.0f),
                              translation({0.0f, 0.0f, distance - gap}));
                const Ray ray = ray_to(Vec3(0.3f, 0.1f, 0.4f) * distance, Vec3(0.0f));
                const RadianceEstimate e = estimate(maker.finish(), settings, 500, ray);
                if (hidden)
                    EXPECT_EQ(e.radiance.mean(), 0.0) << light.name << " at " << distance << " m";
                else
                    EXPECT_GT(e.radiance.mean(), 0.1) << light.name << " at " << distance << " m";
            }
}

// A lamp whose light comes to the floor by a mirror, with a plate close before the one or the
// other.
enum class Plate { none, before_lamp, before_mirror };
RenderScene mirrored(const Light& light, Plate plate) {
    constexpr float kGap = 3e-5f;
    SceneMaker maker;
    set_camera(maker);
    add_floor(maker);
    const Transform mirror_place = rotation_x(0.5f * kPi, {0.0f, 1.0f, 0.5f}),  // looks to the south
        lamp_place = rotation_x(1.2f, {0.0f, -1.0f, 1.2f});  // shines to the north, down to it
    add_caster(maker, square(0.5f), mirror(), mirror_place);
    light.add(maker, lamp_place, 1.0f);
    const auto add_plate = [&](const Transform& place, float half, const Vec3& off) {
        Transform moved = place;
        moved.translation = moved.translation + off;
        maker.add(square(half), diffuse(0.0f), moved, CausticsRole::off,
                  kVisibleAll & ~uint32_t{kVisibleCamera});
    };
    if (plate == Plate::before_lamp)
        add_plate(lamp_place, 0.2f, lamp_place.vector({0.0f, 0.0f, -kGap}));
    if (plate == Plate::before_mirror)
        add_plate(mirror_place, 0.6f, mirror_place.vector({0.0f, 0.0f, kGap}));
    return maker.finish();
}

TEST(HiddenLights, NoChainGoesThroughAPlateCloseBeforeItsEnds) {
    IntegratorSettings settings = few_bounces();
    settings.manifold = unbiased_manifold();
    for (const ChainFinder finder : {ChainFinder::walks, ChainFinder::mnee}) {
        settings.manifold.finder = finder;
        for (const Light& light : lights_of_some_extent())
            for (const Plate plate : {Plate::none, Plate::before_lamp, Plate::before_mirror}) {
                const RenderScene world = mirrored(light, plate);
                const RadianceEstimate e = estimate(world, settings, 2000, [&](uint32_t) {
                    return ray_to({0.0f, -3.0f, 2.0f}, {0.0f, 0.0f, 0.0f});
                });
                if (plate == Plate::none)
                    EXPECT_GT(e.caustics.mean(), 0.01) << light.name;
                else
                    EXPECT_EQ(e.caustics.mean(), 0.0)
                        << light.name << (plate == Plate::before_lamp ? ", lamp" : ", mirror");
            }
    }
}

// Next event estimation looks through everything for a lamp without shadow. Behind casters rays
// alone come to it, and casters themselves stand in the way of chains that would leave them through
// their other side.
TEST(HiddenLightsSlow, LampsWithoutShadowAreTheSameForAllMethodsBehindCasters) {
    struct Case {
        const char* name;
        std::function<void(SceneMaker&)> add_caster;
        Vec3 bulb;
        Transform plate;  // in the way of a part of the light
    };
    const Case cases[] = {
        {"glass ball",
         [](SceneMaker& maker) { add_ball(maker, glass(1.5f)); },
         {0.1f, -0.2f, 1.9f},
         translation({0.1f, 0.0f, 1.4f})},
        {"mirror",
         [](SceneMaker& maker) {
             add_caster(maker, square(0.6f), mirror(), rotation_x(0.5f * kPi, {0.0f, 0.9f, 0.6f}));
         },
         {0.0f, -0.6f, 1.2f},
         rotation_x(0.5f * kPi, {0.05f, 0.3f, 0.75f})}};
    const Method methods[] = {kManifold,
                              {"light sheets", true, false, ChainFinder::sheets},
                              {"walks beside no sheets", true, false, ChainFinder::sheets, 0},
                              kMnee};
    constexpr int kComparisons = 2 * 4;
    for (const auto& [name, add_caster_to, bulb, plate] : cases) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        add_caster_to(maker);
        maker.add(square(0.1f), diffuse(0.0f), plate, CausticsRole::off,
                  kVisibleAll & ~uint32_t{kVisibleCamera});
        add_bulb(maker, bulb, 0.3f, kNotDirectly & ~uint32_t{kVisibleShadow});
        const RenderScene world = maker.finish();
        const Picture expected = render(world, few_bounces(), kPathTracing, 30000, 1);
        EXPECT_LT(5.0 * expected.mean[4].standard_error(), 0.08 * expected.mean[4].mean())
            << name << ": too little power";
        for (const Method& method : methods)
            expect_same(render(world, few_bounces(), method, 600, 2), expected,
                        std::string(name) + " by " + method.name, kComparisons);
    }
}

}  // namespace
}  // namespace spc::test
