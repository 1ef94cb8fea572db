// SPDX-License-Identifier: GPL-3.0-or-later
// Light groups and AOVs: groups of all lights add up to the picture by every method, one group is
// the picture of its lights alone, and AOVs are what their nodes write where the camera looks.
#include "render/session_settings.h"

#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

constexpr uint32_t kSide = 24;  // pixels

LightDesc lamp(const std::string& group, const Vec3& place, float radius) {
    LightDesc light;
    light.name = group;
    light.light_group = group;
    light.type = LightType::point;
    light.to_world = test::translation(place);
    light.power = Spectrum(40.0f, 20.0f, 60.0f);
    light.radius = radius;
    return light;
}

// With a node that writes `color` and `value` to AOVs of a name.
Graph writing(Graph graph, const std::string& name, const Vec3& color, float value) {
    const auto node = uint32_t(graph.nodes.size());
    graph.name += " that writes " + name;
    graph.nodes.push_back({name, "aov_output", kNone});
    graph.inputs.push_back({node, "Color", {color.x, color.y, color.z, 1}});
    graph.inputs.push_back({node, "Value", {value, 0, 0, 0}});
    graph.options.push_back({node, "aov_name", name});
    return graph;
}

const Vec3 kFloorColor(0.1f, 0.2f, 0.3f), kSkyColor(0.7f, 0.0f, 0.5f);

// A floor under a mirror and a ball of glass; `lights`: which of two lamps, a glowing square and
// the sky there are.
RenderScene scene_of(const std::vector<std::string>& lights) {
    SceneMaker maker;
    const auto has = [&](const char* group) {
        return std::find(lights.begin(), lights.end(), group) != lights.end();
    };
    Camera camera;
    const Vec3 from(0.0f, -3.0f, 2.0f);
    camera.to_world = test::rotation_x(std::atan2(-from.y, from.z) - 0.1f, from);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-0.5f, 0.5f, -0.5f, 0.5f};
    maker.builder.set_camera(camera);
    maker.add(test::square(4.0f), writing(test::diffuse(0.8f), "mask", kFloorColor, 0.25f),
              Transform{}, CausticsRole::receiver);
    maker.add(test::square(0.6f), test::mirror(), test::rotation_x(1.3f, Vec3(0, 0.875f, 0.6f)),
              CausticsRole::caster);
    maker.add(test::sphere(16, 0.2), test::glass(1.5f), test::translation({0.3125f, 0.0f, 0.4f}),
              CausticsRole::caster);
    maker.add(test::square(0.3f), test::mirror(0.3f), test::translation({-0.6f, 0.0f, 0.3f}));
    if (has("key")) maker.builder.add_light(lamp("key", {0, -0.75f, 2.2f}, 0.05f));
    if (has("fill")) maker.builder.add_light(lamp("fill", {1.0f, 0.2f, 1.8f}, 0.3f));
    if (has("glow")) {
        Instance square;
        square.name = square.light_group = "glow";
        square.mesh = maker.builder.add_mesh(test::square(0.3f));
        square.object_to_world = test::rotation_x(2.5f, Vec3(-0.8f, -0.4f, 1.5f));
        square.materials = {maker.builder.add_material(test::emission(5.0f))};
        maker.builder.add_instance(square);
    }
    const float sky = has("sky") ? 0.3f : 0.0f;
    const uint32_t world = maker.builder.add_material(
        writing(test::background(sky, 0.5f * sky, sky), "mask", kSkyColor, 4.0f));
    maker.builder.set_environment({world, kVisibleAll, true, "sky"});
    return maker.finish();
}

const std::vector<std::string> kGroups{"key", "fill", "glow", "sky"};

RenderSettings settings_with(uint32_t samples) {
    RenderSettings settings = test::manifold_settings(samples, 2);
    settings.custom.of = {kGroups, {"mask"}, {"none", "mask"}};
    settings.passes = PassSet(0, settings.custom.counts());
    return settings;
}

struct Passes {
    std::vector<float> combined;
    std::vector<std::vector<float>> groups;
    std::vector<float> color, unwritten, value;
};
Passes render(const RenderScene& world, const RenderSettings& settings) {
    Session session(world, settings);
    EXPECT_EQ(session.wait(120s).state, RenderState::done);
    const auto read = [&](Pass pass) {
        std::vector<float> out(size_t{pass_channels(pass)} * kSide * kSide);
        session.film().read(pass, out);
        return out;
    };
    Passes found;
    found.combined = read(Pass::combined);
    for (uint32_t i = 0; i < kGroups.size(); ++i)
        found.groups.push_back(read(pass_of(CustomKind::light_group, i)));
    found.color = read(pass_of(CustomKind::color_aov, 0));
    found.unwritten = read(pass_of(CustomKind::value_aov, 0));
    found.value = read(pass_of(CustomKind::value_aov, 1));
    return found;
}

double mean_of(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

struct Way {
    const char* name;
    bool manifold, light_paths;
    ChainFinder finder = ChainFinder::walks;
};
constexpr std::array kWays{Way{"path tracing", false, false}, Way{"light paths", false, true},
                           Way{"walks and light paths", true, true},
                           Way{"sheets and light paths", true, true, ChainFinder::sheets}};

TEST(LightGroups, AddUpToThePictureByEveryMethod) {
    const RenderScene world = scene_of(kGroups);
    for (const Way& way : kWays) {
        RenderSettings settings = settings_with(8);
        settings.integrator.manifold.enabled = way.manifold;
        settings.integrator.manifold.finder = way.finder;
        settings.light_tracing = way.light_paths;
        const Passes found = render(world, settings);
        for (size_t pixel = 0; pixel < size_t{kSide} * kSide; ++pixel)
            for (size_t c = 0; c < 3; ++c) {
                float sum = 0.0f;
                for (const std::vector<float>& group : found.groups) sum += group[3 * pixel + c];
                const float combined = found.combined[4 * pixel + c];
                ASSERT_NEAR(sum, combined, 2e-5f * combined + 1e-6f) << way.name << ' ' << pixel;
            }
        for (const std::vector<float>& group : found.groups) EXPECT_GT(mean_of(group), 0.0);
    }
}

// Each lamp's caustics are in its own group: as bright as in the picture of that lamp alone.
TEST(LightGroupsSlow, AreThePicturesOfTheirLights) {
    constexpr uint32_t kSamples = 256;
    RenderSettings settings = settings_with(kSamples);
    settings.integrator.manifold.finder = ChainFinder::sheets;
    settings.light_tracing = true;
    const Passes together = render(scene_of(kGroups), settings);
    for (size_t i = 0; i < kGroups.size(); ++i) {
        const Passes alone = render(scene_of({kGroups[i]}), settings);
        EXPECT_NEAR(mean_of(together.groups[i]) / mean_of(alone.groups[i]), 1.0, 0.03) << kGroups[i];
        for (size_t k = 0; k < kGroups.size(); ++k)
            if (k != i) {
                EXPECT_EQ(mean_of(alone.groups[k]), 0.0) << kGroups[k];
            }
    }
}

// The floor and the sky write; mirrors and glass do not, and hide what is behind them.
TEST(Aovs, AreWhatTheSurfaceThatTheCameraSeesWrites) {
    RenderSettings settings = settings_with(1);
    settings.filter = FilterKind::box;
    settings.integrator.manifold.enabled = false;
    const Passes found = render(scene_of(kGroups), settings);
    EXPECT_EQ(mean_of(found.unwritten), 0.0);
    std::array<int, 3> seen{};  // floor, sky, others
    for (size_t pixel = 0; pixel < size_t{kSide} * kSide; ++pixel) {
        const float value = found.value[pixel];
        const size_t which = value == 0.25f ? 0 : value == 4.0f ? 1 : 2;
        const Vec3 colors[]{kFloorColor, kSkyColor, Vec3(0.0f)};
        ++seen[which];
        for (size_t c = 0; c < 3; ++c)
            ASSERT_EQ(found.color[4 * pixel + c], colors[which][int(c)]) << pixel;
        ASSERT_EQ(found.color[4 * pixel + 3], which == 2 ? 0.0f : 1.0f) << pixel;
        if (which == 2) {
            ASSERT_EQ(value, 0.0f);
        }
    }
    for (const int count : seen) EXPECT_GT(count, 20);
}

// Below the threshold of alpha a surface is one of several that write.
TEST(Aovs, AddUpThroughWhatIsTransparent) {
    const auto value_with = [](float threshold) {
        SceneMaker maker;
        Camera camera;
        camera.to_world = test::translation({0, 0, 3});
        camera.width = camera.height = 1;
        camera.crop = {0, 0, 1, 1};
        camera.viewplane = {-0.1f, 0.1f, -0.1f, 0.1f};
        maker.builder.set_camera(camera);
        Graph veil = test::combined(test::diffuse(0.5f), test::transparent(1.0f), 0.75f);
        maker.add(test::square(1.0f), writing(veil, "mask", Vec3(1.0f), 1.0f),
                  test::translation({0, 0, 1}));
        maker.add(test::square(1.0f), writing(test::diffuse(0.5f), "mask", Vec3(1.0f), 10.0f));
        RenderSettings settings;
        settings.samples = 64;
        settings.threads = 1;
        settings.custom.of[size_t(CustomKind::value_aov)] = {"mask"};
        settings.passes = PassSet(0, settings.custom.counts());
        settings.integrator.pass_alpha_threshold = threshold;
        const RenderScene world = maker.finish();
        Session session(world, settings);
        EXPECT_EQ(session.wait(60s).state, RenderState::done);
        float value = 0.0f;
        session.film().read(pass_of(CustomKind::value_aov, 0), {&value, 1});
        return value;
    };
    EXPECT_EQ(value_with(0.2f), 1.0f);          // the veil's alpha is a quarter
    EXPECT_NEAR(value_with(0.5f), 8.5f, 1.3f);  // three quarters of the paths go on
}

}  // namespace
}  // namespace spc
