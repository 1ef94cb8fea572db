// SPDX-License-Identifier: GPL-3.0-or-later
// Light paths against path tracing and the manifold: whoever takes part, the picture is the same.
#include "integrator/light_path.h"

#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kFamily = 1e-3;  // chance that right estimators differ somewhere in a test
constexpr uint32_t kSide = 8;     // pixels
constexpr uint32_t kHalf = kSide / 2;

// One diffuse scattering is enough: what comes after only adds noise.
IntegratorSettings few_bounces() {
    IntegratorSettings settings;
    settings.limits = {16, 1, 16, 16, 16};
    return settings;
}

// Of the four quarters of the picture, then of the whole.
struct Picture {
    std::array<test::MeanEstimate, 5> mean;
    test::MeanEstimate splats;  // the share of light paths in the whole
};

double average(const Spectrum& c) { return (double(c.x) + double(c.y) + double(c.z)) / 3.0; }

// Which techniques find caustics beside path tracing.
struct Method {
    const char* name;
    bool manifold, light_paths;
    ChainFinder finder = ChainFinder::walks;
    uint32_t tiles = 512;  // 0: there is no sheet, and all chains are missed
};
constexpr Method kPathTracing{"path tracing", false, false}, kManifold{"manifold", true, false},
    kLightPaths{"light paths", false, true}, kAll{"manifold and light paths", true, true},
    kSheets{"light sheets and light paths", true, true, ChainFinder::sheets},
    kMissed{"walks beside no sheets", true, true, ChainFinder::sheets, 0},
    kMnee{"fixed starts", true, false, ChainFinder::mnee},
    kMneeAndLight{"fixed starts and light paths", true, true, ChainFinder::mnee};

// `rounds` samples of each pixel under a box filter; all rounds independent of each other.
Picture render(const RenderScene& world, IntegratorSettings settings, const Method& method,
               uint32_t rounds, uint32_t seed) {
    constexpr uint32_t kPixels = kSide * kSide;
    if (method.manifold) settings.manifold = test::unbiased_manifold();
    settings.manifold.finder = method.finder;
    if (method.finder != ChainFinder::walks)
        settings.manifold.longest_chain = kLongestManifoldChain;
    SheetPool sheets;
    PassState state{{1, 1, 1}};
    if (method.finder == ChainFinder::sheets) {
        constexpr float kSure = 0.2f;  // leaves many chains to chance
        if (method.tiles > 0)
            sheets = build_sheets(*world.scene, world.lights, world.casters, settings.manifold,
                                  seed, method.tiles, 1);
        state.sheets = {sheets, kSure};
    }
    std::unique_ptr<const LightPilot> pilot;
    if (method.light_paths) {
        settings.light_tracing.paths = kPixels;
        LightPathStats stats;
        const std::atomic<bool> cancelled{false};
        pilot = learn_emission(world, settings, 0.0f, seed, 1, cancelled, stats);
        EXPECT_TRUE(pilot) << "no light path finds the picture";
        settings.light_tracing.guide = &pilot->guide;
    }
    Picture picture;
    PathStats path_stats;
    LightPathStats light_stats;
    std::vector<Splat> splats;
    const auto quarter = [](uint32_t x, uint32_t y) {
        return (y < kHalf ? 0u : 2u) + (x < kHalf ? 0u : 1u);
    };
    for (uint32_t round = 0; round < rounds; ++round) {
        std::array<double, 5> sum{};
        double splatted = 0.0;
        const auto add = [&](uint32_t x, uint32_t y, double value) {
            sum[quarter(x, y)] += value / (kPixels / 4);
            sum[4] += value / kPixels;
        };
        for (uint32_t y = 0; y < kSide; ++y)
            for (uint32_t x = 0; x < kSide; ++x) {
                const Sampler sampler(seed, (round * kSide + y) * kSide + x, 0);
                const Vec2 u = sampler[Domain::film].two();
                const Ray ray = world.scene->camera.ray(float(x) + u.x, float(y) + u.y, Vec2(0.5f));
                add(x, y,
                    average(
                        path_radiance(world, settings, state, ray, Vec2(0.5f), sampler, path_stats)
                            .radiance));
            }
        for (uint32_t i = 0; pilot && i < kPixels; ++i) {
            splats.clear();
            trace_light_path(world, settings, 0.0f, seed + round, i, splats, light_stats);
            for (const Splat& splat : splats) {
                add(uint32_t(splat.film.x), uint32_t(splat.film.y), average(splat.value));
                splatted += average(splat.value) / kPixels;
            }
        }
        for (size_t i = 0; i < sum.size(); ++i) picture.mean[i].add(sum[i]);
        picture.splats.add(splatted);
    }
    EXPECT_EQ(light_stats.nan_splats, 0u);
    return picture;
}

void expect_same(const Picture& a, const Picture& b, const std::string& what, int comparisons) {
    for (size_t i = 0; i < a.mean.size(); ++i)
        EXPECT_TRUE(test::same_mean(a.mean[i], b.mean[i], test::sidak(kFamily, 5 * comparisons)))
            << what << ", part " << i;
}

// Looks down at the floor around the origin from the south.
void set_camera(SceneMaker& maker, const Vec3& from = {0.0f, -3.0f, 2.0f}, float half = 0.25f) {
    Camera camera;
    camera.to_world = test::rotation_x(std::atan2(-from.y, from.z), from);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-half, half, -half, half};
    maker.builder.set_camera(camera);
}

void add_floor(SceneMaker& maker, CausticsRole role = CausticsRole::receiver) {
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, role);
}

// Of lights that are seen in casters alone: nothing but caustics is left to compare.
constexpr uint32_t kNotDirectly = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;

LightDesc lamp(LightType type, float power) {
    LightDesc light;
    light.name = "lamp";
    light.type = type;
    light.to_world = test::translation(Vec3(0.4f, -0.2f, 1.9f));
    light.power = Spectrum(power);
    light.visibility = kNotDirectly;
    return light;
}
void add(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Transform& transform,
         uint32_t visibility, CausticsRole role) {
    Instance instance;
    instance.name = mesh.name + " of " + graph.name;
    instance.mesh = maker.builder.add_mesh(mesh);
    instance.object_to_world = transform;
    instance.materials = {maker.builder.add_material(graph)};
    instance.visibility = visibility;
    instance.role = role;
    maker.builder.add_instance(instance);
}
void add_bulb(SceneMaker& maker, const Vec3& p = {0.8f, -0.8f, 0.7f}, float radius = 0.3f,
              uint32_t visibility = kNotDirectly) {
    LightDesc light = lamp(LightType::point, 100.0f);
    light.visibility = visibility;
    light.to_world = test::translation(p);
    light.radius = radius;
    maker.builder.add_light(light);
}

// Objects that hide from some of the scattered rays would keep light paths away.
void add_glowing(SceneMaker& maker, const Mesh& mesh, const Vec3& p) {
    add(maker, mesh, test::emission(20.0f), test::translation(p), kVisibleAll & ~kVisibleCamera,
        CausticsRole::automatic);
}
// The camera looks through: what lamps it would see in casters is noise here.
void add_caster(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Transform& transform) {
    add(maker, mesh, graph, transform, kVisibleAll & ~uint32_t{kVisibleCamera},
        CausticsRole::caster);
}

// Two faces, `thickness` apart, that look away from each other.
Mesh slab(float half, float thickness) {
    Mesh mesh = test::flat(test::square(half));
    mesh.uv_layers.clear();
    for (uint32_t i = 0; i < 4; ++i)
        mesh.positions.push_back(mesh.positions[i] - Vec3(0, 0, thickness));
    mesh.triangles.push_back({4, 6, 5});
    mesh.triangles.push_back({4, 7, 6});
    return mesh;
}

void add_ball(SceneMaker& maker, const Graph& graph) {
    add_caster(maker, test::sphere(24, 0.4), graph, test::translation(Vec3(-0.1f, 0.1f, 0.7f)));
}
void add_panel(SceneMaker& maker, const Graph& graph) {
    add_caster(maker, test::square(0.6f), graph, test::rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
}

// A wide texture of gentle slopes in both directions.
Image gentle_waves() {
    return test::normal_image(64, 64, [](double u, double v) {
        const double turn = 2.0 * std::numbers::pi;
        return Vec2(float(0.15 * std::sin(turn * u)), float(0.12 * std::cos(turn * (u + v))));
    });
}

void set_panorama(SceneMaker& maker) {
    std::vector<float> texels;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const bool bright = y >= 11 && y < 14 && x >= 6 && x < 11;
            for (int c = 0; c < 3; ++c) texels.push_back(bright ? 20.0f : 0.2f);
        }
    const uint32_t image = maker.builder.add_image(
        image_from_floats("sky", texels, 32, 16, 3, ColorSpace::linear, AlphaMode::none));
    Graph graph = test::background(1, 1, 1);
    graph.name = "panorama";
    graph.nodes.push_back({"Sky", "environment_texture", image});
    graph.links.push_back({2, "Color", 1, "Color"});
    maker.builder.set_environment({maker.builder.add_material(graph), kNotDirectly, true});
}

struct Setup {
    const char* name;
    std::function<void(SceneMaker&)> build;
};

std::vector<Setup> casters_under_a_bulb() {
    const Graph sheet = test::combined(test::transparent(0.8f), test::diffuse(0.5f), 0.4f);
    return {
        {"mirror ball",
         [](SceneMaker& m) {
             add_ball(m, test::mirror());
             add_bulb(m);
         }},
        {"mirror",
         [](SceneMaker& m) {
             add_panel(m, test::mirror());
             add_bulb(m, {0, -0.7f, 2.2f}, 0.3f, kVisibleAll);
         }},
        {"normal-mapped mirror",
         [](SceneMaker& m) {
             m.builder.add_image(gentle_waves());
             add_caster(
                 m,
                 test::with_uvs(
                     test::grid(
                         1, [](double u, double v) { return Vec3d(1.4 * u - 0.7, 1.4 * v - 0.7, 0); },
                         [](double, double) { return Vec3d(0, 0, 1); }),
                     1),
                 test::normal_mapped(test::mirror(), Vec2(1.0f, 1.0f)),
                 test::rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
             add_bulb(m, {0, -0.7f, 2.2f});
         }},
        {"glass slab",
         [](SceneMaker& m) {
             add_caster(m, slab(2.0f, 0.3f), test::glass(1.5f), test::translation({0, 0, 1.2f}));
             set_camera(m, {0.0f, -1.0f, 0.7f}, 0.4f);
             add_bulb(m, {0.7f, 0.2f, 2.5f}, 0.6f);
         }},
        {"glass ball",
         [](SceneMaker& m) {
             add_ball(m, test::glass(1.5f));
             add_bulb(m);
         }},
        {"sheets around the ball",
         [sheet](SceneMaker& m) {
             add_ball(m, test::mirror());
             m.add(test::flat(test::square(1.5f)), sheet, test::translation({0, 0, 0.15f}));
             m.add(test::flat(test::square(0.6f)), sheet,
                   test::rotation_x(0.9f, {0.0f, -1.2f, 0.9f}));
             add_bulb(m);
         }},
        {"transparent mirror",
         [](SceneMaker& m) {
             add_caster(m, test::square(0.5f),
                        test::combined(test::transparent(1.0f), test::mirror(), 0.3f),
                        test::translation({0, 0, 0.3f}));
             add_ball(m, test::mirror());
             add_bulb(m);
         }},
        {"mirror and glass",
         [](SceneMaker& m) {
             add_panel(m, test::mirror());
             add_caster(m, slab(0.7f, 0.2f), test::glass(1.5f),
                        test::rotation_x(0.2f, {0, 0.1f, 0.9f}));
             add_bulb(m, {0, -0.7f, 2.2f});
         }},
    };
}

std::vector<Setup> lights_over_a_ball() {
    const auto over_ball = [](const char* name, const std::function<void(SceneMaker&)>& light) {
        return Setup{name, [light](SceneMaker& m) {
                         add_ball(m, test::mirror());
                         add_caster(m, test::square(0.6f), test::refraction(1.4f),
                                    test::rotation_x(0.3f, {0.4f, 0.0f, 0.4f}));
                         light(m);
                     }};
    };
    const auto lamp_over_ball = [&](const char* name, const LightDesc& light) {
        return over_ball(name, [light](SceneMaker& m) { m.builder.add_light(light); });
    };
    LightDesc spot = lamp(LightType::spot, 100.0f);
    spot.radius = 0.3f;
    spot.spot_angle = 1.5f;
    spot.spot_blend = 0.4f;
    LightDesc sun = lamp(LightType::sun, 3.0f);
    sun.sun_angle = 0.25f;
    LightDesc rectangle = lamp(LightType::area, 100.0f);
    rectangle.size = Vec2(0.7f, 0.4f);
    LightDesc sheared = rectangle;
    sheared.shape = AreaShape::ellipse;
    for (Vec3& row : sheared.to_world.row) row.z += 0.6f * row.x;
    return {lamp_over_ball("spot", spot),
            lamp_over_ball("sun", sun),
            lamp_over_ball("rectangle", rectangle),
            lamp_over_ball("sheared ellipse", sheared),
            over_ball("emissive mesh",
                      [](SceneMaker& m) {
                          add_glowing(m, test::flat(test::square(0.3f)), {0.4f, -0.2f, 1.9f});
                      }),
            over_ball("emissive ball between the casters",
                      [](SceneMaker& m) {
                          add_glowing(m, test::sphere(12, 0.15), {0.4f, 0.3f, 0.9f});
                      }),
            over_ball("panorama", set_panorama)};
}

// Water between floor and camera on one side and the lamp on the other.
std::vector<Setup> other_media() {
    const auto water = [](float angle, SceneMaker& m) {
        add_caster(m, test::flat(test::square(4.0f)), test::glass(1.33f),
                   test::rotation_x(angle, {0, 0, 0.8f}));
        set_camera(m, {0.0f, -1.0f, 0.7f}, 0.4f);
        add_bulb(m, {0.4f, 0.3f, 2.2f}, 0.5f);
    };
    return {{"camera under water", [water](SceneMaker& m) { water(0.0f, m); }},
            {"lamp under water", [water](SceneMaker& m) { water(kPi, m); }}};
}

void expect_agreement(const std::vector<Setup>& setups,
                      const IntegratorSettings& settings = few_bounces(),
                      CausticsRole floor = CausticsRole::receiver, uint32_t factor = 12) {
    constexpr uint32_t kRounds = 3000;
    for (const Setup& setup : setups) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker, floor);
        setup.build(maker);
        const RenderScene world = maker.finish();
        const Picture expected = render(world, settings, kPathTracing, factor * kRounds, 1);
        Picture light_paths;
        for (const Method& method : {kManifold, kLightPaths, kAll, kSheets, kMnee, kMneeAndLight}) {
            const Picture actual = render(world, settings, method, kRounds, 1u << 20);
            const std::string what = std::string(setup.name) + " by " + method.name;
            expect_same(actual, expected, what, 5 * int(setups.size()));
            if (!method.light_paths) continue;
            if (method.manifold)
                expect_same(actual, light_paths, what + ", or without", 5 * int(setups.size()));
            if (method.finder != ChainFinder::walks)
                continue;  // they may leave little to light paths
            light_paths = actual;
            const double share = actual.splats.mean() / actual.mean[4].mean(),
                         noise = std::hypot(expected.mean[4].standard_error(),
                                            actual.mean[4].standard_error());
            std::cout << what << ": light paths give " << share << " of the picture, known to "
                      << noise / expected.mean[4].mean() << std::endl;
            EXPECT_GT(share, 0.02) << what;
            // What the comparison would notice.
            EXPECT_GT(0.5 * actual.splats.mean(), 5.0 * noise) << what;
        }
    }
}

// Whatever the weights of chains that sheets miss, all of them are found.
void expect_agreement_of_missed(const std::vector<Setup>& setups) {
    constexpr uint32_t kRounds = 3000;
    for (const Setup& setup : setups) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        setup.build(maker);
        const RenderScene world = maker.finish();
        expect_same(render(world, few_bounces(), kMissed, kRounds, 1u << 20),
                    render(world, few_bounces(), kPathTracing, 6 * kRounds, 1), setup.name,
                    int(setups.size()));
    }
}

TEST(LightPathsSlow, AgreeWithPathTracingForWhatSheetsMiss) {
    expect_agreement_of_missed(casters_under_a_bulb());
}
TEST(LightPathsSlow, AgreeWithPathTracingForEveryCaster) {
    expect_agreement(casters_under_a_bulb());
}
TEST(LightPathsSlow, AgreeWithPathTracingForEveryLight) { expect_agreement(lights_over_a_ball()); }
TEST(LightPathsSlow, AgreeWithPathTracingInOtherMedia) { expect_agreement(other_media()); }

// What casters throw at a wall beside the floor.
constexpr Vec3 kWall(0.0f, 1.2f, 0.0f);

Graph satin() {
    return test::combined(test::diffuse(0.9f),
                          test::single_shader("bsdf_glossy", {{1, "Color", {0.9f, 0.9f, 0.9f, 1}},
                                                              {1, "Roughness", {0.5f, 0, 0, 0}}}),
                          0.5f);
}
void add_wall(SceneMaker& maker, const Graph& graph, uint32_t visibility = kVisibleAll,
              const Vec3& p = kWall) {
    Mesh mesh = test::flat(test::square(1.5f));
    add(maker, mesh, graph, test::rotation_x(0.5f * kPi, p), visibility, CausticsRole::receiver);
}
// A mirror that faces the wall.
void add_projector(SceneMaker& maker, const Graph& graph = test::mirror()) {
    add_caster(maker, test::square(0.5f), graph, test::rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
}
constexpr Vec3 kBeforeWall(0.0f, 0.5f, 1.6f);

std::vector<Setup> walls() {
    return {{"wall by a mirror",
             [](SceneMaker& m) {
                 add_wall(m, test::diffuse(0.9f));
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"bumpy wall by a mirror",
             [](SceneMaker& m) {
                 m.builder.add_image(gentle_waves());
                 Mesh mesh = test::square(1.5f);
                 mesh.normals.assign(6, Vec3(0, 0, 1));
                 m.add(mesh, test::normal_mapped(test::diffuse(0.9f), Vec2(1.0f, 1.0f)),
                       test::rotation_x(0.5f * kPi, kWall), CausticsRole::receiver);
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"satin wall by glass",
             [](SceneMaker& m) {
                 add_wall(m, satin());
                 add_caster(m, slab(0.6f, 0.2f), test::glass(1.5f),
                            test::rotation_x(0.9f, {0.0f, 0.4f, 1.2f}));
                 add_bulb(m, {0.0f, -0.4f, 2.0f}, 0.25f);
             }},
            {"screen from behind",
             [](SceneMaker& m) {
                 add_wall(m,
                          test::combined(test::refraction(1.2f, 0.6f), test::diffuse(0.6f), 0.3f));
                 add_caster(m, test::square(0.6f), test::mirror(),
                            test::rotation_x(1.3f, {0.0f, 2.4f, 0.8f}));
                 // Not seen through the screen itself.
                 add_bulb(m, {0.0f, 1.6f, 1.5f}, 0.25f, kVisibleGlossy | kVisibleShadow);
             }},
            {"wall behind a sheet",
             [](SceneMaker& m) {
                 add_wall(m, test::diffuse(0.9f));
                 m.add(test::flat(test::square(1.0f)),
                       test::combined(test::transparent(0.8f), test::diffuse(0.5f), 0.4f),
                       test::rotation_x(1.0f, {0.0f, 0.9f, 0.4f}));
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"wall that the camera does not see", [](SceneMaker& m) {
                 add_wall(m, test::diffuse(0.9f), kVisibleAll & ~uint32_t{kVisibleCamera});
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }}};
}

IntegratorSettings more_bounces() {
    IntegratorSettings settings = few_bounces();
    settings.limits.diffuse = 3;
    return settings;
}

// The floor shows what comes from the wall; its own caustics are path tracing's.
TEST(LightPathsSlow, AgreeForIndirectCaustics) {
    expect_agreement(walls(), more_bounces(), CausticsRole::off, 40);
}
// Light that comes in one way and another; few of the paths go on.
IntegratorSettings few_going_on() {
    IntegratorSettings settings = more_bounces();
    settings.light_tracing.goes_on = 0.3;
    return settings;
}
TEST(LightPathsSlow, AgreeForDirectAndIndirectCaustics) {
    expect_agreement({{"satin wall by a mirror ball",
                       [](SceneMaker& m) {
                           add_wall(m, satin());
                           add_ball(m, test::mirror());
                           add_bulb(m);
                       }},
                      walls()[1]},
                     few_going_on());
}

// What a camera does not see shows no caustic; what nothing else sees shows its own all the same.
TEST(LightPathsSlow, AgreeForReceiversThatFewSee) {
    const auto floor_of = [](uint32_t visibility) {
        return [visibility](SceneMaker& m) {
            add_panel(m, test::mirror());
            add(m, test::square(0.5f), test::diffuse(0.8f), test::translation({0, 0, 0.1f}),
                visibility, CausticsRole::receiver);
            add_bulb(m, {0, -0.7f, 2.2f});
        };
    };
    expect_agreement(
        {{"floor for the camera", floor_of(kVisibleCamera)},
         {"floor for all but the camera", floor_of(kVisibleAll & ~uint32_t{kVisibleCamera})}});
}

// Lights that path tracing never finds.
void expect_agreement_with_manifold(const std::function<void(SceneMaker&)>& build,
                                    const IntegratorSettings& settings, CausticsRole floor) {
    LightDesc spot = lamp(LightType::spot, 50.0f);
    spot.spot_angle = 1.5f;
    const std::array lights{lamp(LightType::point, 50.0f), spot, lamp(LightType::sun, 3.0f)};
    for (const LightDesc& light : lights) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker, floor);
        build(maker);
        maker.builder.add_light(light);
        const RenderScene world = maker.finish();
        const Picture expected = render(world, settings, kManifold, 1000, 1);
        for (const Method& method : {kLightPaths, kAll}) {
            const Picture actual = render(world, settings, method, 3000, 1u << 20);
            expect_same(actual, expected,
                        "light " + std::to_string(int(light.type)) + " by " + method.name, 6);
            EXPECT_GT(actual.splats.mean(), 0.0);
        }
    }
}

TEST(LightPathsSlow, AgreeWithTheManifoldForDeltaLights) {
    // One interaction alone, for that is all that the manifold can.
    IntegratorSettings settings = few_bounces();
    settings.limits = {2, 1, 1, 1, 16};
    expect_agreement_with_manifold(
        [](SceneMaker& m) {
            add_panel(m, test::mirror());
            add_caster(m, test::square(0.6f), test::refraction(1.4f),
                       test::rotation_x(0.3f, {0.2f, 0.0f, 0.4f}));
        },
        settings, CausticsRole::receiver);
}
TEST(LightPathsSlow, AgreeWithTheManifoldForDeltaLightsOnWalls) {
    expect_agreement_with_manifold(
        [](SceneMaker& m) {
            add_wall(m, test::diffuse(0.9f));
            // Lit from above, it throws the light at the wall alone.
            add_caster(m, test::square(0.5f), test::mirror(),
                       test::rotation_x(-0.7f, {0.0f, -0.3f, 0.6f}));
        },
        few_going_on(), CausticsRole::off);
}

}  // namespace
}  // namespace spc
