// SPDX-License-Identifier: GPL-3.0-or-later
// Light paths against path tracing and the manifold: whoever takes part, the picture is the same.
#include "integrator/pictures.h"
#include "support/power.h"

namespace spc::test {
namespace {

// A wide texture of gentle slopes in both directions.
Image gentle_waves() {
    return normal_image(64, 64, [](double u, double v) {
        const double turn = 2.0 * std::numbers::pi;
        return Vec2(float(0.15 * std::sin(turn * u)), float(0.12 * std::cos(turn * (u + v))));
    });
}

// A relief from 0 to 1 that takes as few texels as it may.
Image gentle_hills() {
    constexpr uint32_t kSide = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const double a = 2.0 * std::numbers::pi * x / kSide,
                         b = 2.0 * std::numbers::pi * y / kSide;
            texels.push_back(float(0.5 + 0.25 * (std::sin(a) + std::cos(a + b))));
        }
    return image_from_floats("hills", texels, kSide, kSide, 1, ColorSpace::data, AlphaMode::none);
}
Mesh panel_with_uvs() {
    return with_uvs(grid(
                        1, [](double u, double v) { return Vec3d(1.4 * u - 0.7, 1.4 * v - 0.7, 0); },
                        [](double, double) { return Vec3d(0, 0, 1); }),
                    1);
}

void set_panorama(SceneMaker& maker) {
    std::vector<float> texels;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const bool bright = y >= 11 && y < 14 && x >= 6 && x < 11;
            for (int c = 0; c < 3; ++c) texels.push_back(bright ? 20.0f : 0.2f);
        }
    set_world(maker, texels, 32, 16, kNotDirectly);
}

struct Setup {
    const char* name;
    std::function<void(SceneMaker&)> build;
};

std::vector<Setup> casters_under_a_bulb() {
    const Graph sheet = combined(transparent(0.8f), diffuse(0.5f), 0.4f);
    return {
        {"mirror ball",
         [](SceneMaker& m) {
             add_ball(m, mirror());
             add_bulb(m);
         }},
        {"mirror",
         [](SceneMaker& m) {
             add_panel(m, mirror());
             add_bulb(m, {0, -0.7f, 2.2f}, 0.3f, kVisibleAll);
         }},
        {"normal-mapped mirror",
         [](SceneMaker& m) {
             m.builder.add_image(gentle_waves());
             add_caster(m, panel_with_uvs(), normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
                        rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
             add_bulb(m, {0, -0.7f, 2.2f});
         }},
        {"bumped mirror",
         [](SceneMaker& m) {
             m.builder.add_image(gentle_hills());
             add_caster(m, panel_with_uvs(), bumped(mirror(), 0.1f),
                        rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
             add_bulb(m, {0, -0.7f, 2.2f});
         }},
        {"glass slab",
         [](SceneMaker& m) {
             add_caster(m, slab(2.0f, 0.3f), glass(1.5f), translation({0, 0, 1.2f}));
             set_camera(m, {0.0f, -1.0f, 0.7f}, 0.4f);
             add_bulb(m, {0.7f, 0.2f, 2.5f}, 0.6f);
         }},
        {"glass ball",
         [](SceneMaker& m) {
             add_ball(m, glass(1.5f));
             add_bulb(m, {0.8f, -0.8f, 0.7f}, 0.6f);  // few walks are unlucky
         }},
        {"sheets around the ball",
         [sheet](SceneMaker& m) {
             add_ball(m, mirror());
             m.add(flat(square(1.5f)), sheet, translation({0, 0, 0.15f}));
             m.add(flat(square(0.6f)), sheet, rotation_x(0.9f, {0.0f, -1.2f, 0.9f}));
             add_bulb(m);
         }},
        {"transparent mirror",
         [](SceneMaker& m) {
             add_caster(m, square(0.5f), combined(transparent(1.0f), mirror(), 0.3f),
                        translation({0, 0, 0.3f}));
             add_ball(m, mirror());
             add_bulb(m);
         }},
        {"mirror and glass",
         [](SceneMaker& m) {
             add_panel(m, mirror());
             add_caster(m, slab(0.7f, 0.2f), glass(1.5f), rotation_x(0.2f, {0, 0.1f, 0.9f}));
             add_bulb(m, {0, -0.7f, 2.2f});
         }},
    };
}

std::vector<Setup> lights_over_a_ball() {
    const auto over_ball = [](const char* name, const std::function<void(SceneMaker&)>& light) {
        return Setup{
            name, [light](SceneMaker& m) {
                add_ball(m, mirror());
                add_caster(m, square(0.6f), refraction(1.4f), rotation_x(0.3f, {0.4f, 0.0f, 0.4f}));
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
    LightDesc wide_beam = rectangle, narrow_beam = rectangle;
    wide_beam.spread = 1.2f;
    narrow_beam.size = Vec2(1.5f, 1.5f);
    narrow_beam.spread = 0.5f;
    LightDesc disk = lamp(LightType::point, 100.0f);
    disk.radius = 0.7f;
    disk.soft_falloff = true;
    const auto disk_cut_by_a_shade = [disk](SceneMaker& m) {
        m.builder.add_light(disk);
        for (const float side : {0.3f, -0.35f})
            add(m, square(0.25f), diffuse(0.0f),
                translation(disk.position() + Vec3(side, 0.1f, side)),
                kVisibleAll & ~kVisibleCamera, CausticsRole::off);
    };
    return {lamp_over_ball("disk", disk),
            over_ball("disk cut by a shade", disk_cut_by_a_shade),
            lamp_over_ball("wide beam", wide_beam),
            lamp_over_ball("narrow beam", narrow_beam),
            lamp_over_ball("spot", spot),
            lamp_over_ball("sun", sun),
            lamp_over_ball("rectangle", rectangle),
            lamp_over_ball("sheared ellipse", sheared),
            over_ball("emissive mesh",
                      [](SceneMaker& m) {
                          add_glowing(m, flat(square(0.3f)), {0.4f, -0.2f, 1.9f});
                      }),
            over_ball("emissive ball between the casters",
                      [](SceneMaker& m) {
                          add_glowing(m, sphere(12, 0.15), {0.4f, 0.3f, 0.9f});
                      }),
            over_ball("panorama", set_panorama)};
}

// ---- emission from an image

// Its corners, bottom row first: one is bright, one dim, two have colours of their own.
constexpr float kCornersOfLight[4][3] = {
    {60.0f, 40.0f, 20.0f}, {10.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 10.0f}, {0.5f, 0.5f, 0.5f}};
constexpr float kPanelOfLight = 0.6f;  // half its side, m
// Hangs from `transform` with its front below. Turned, it has its UVs along its edges; else these go
// round by a quarter.
void add_panel_of_light(SceneMaker& maker, const Transform& transform, bool turned = false) {
    constexpr uint32_t kTexels = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kTexels; ++y)
        for (uint32_t x = 0; x < kTexels; ++x)
            for (const float value : kCornersOfLight[2 * (2 * y / kTexels) + 2 * x / kTexels])
                texels.push_back(value);
    const uint32_t image = maker.builder.add_image(image_from_floats(
        "light", texels, kTexels, kTexels, 3, ColorSpace::linear, AlphaMode::none));
    Graph graph = emission(1.0f);
    graph.name = "image of light";
    graph.nodes.push_back({"Image", "image_texture", image});
    graph.options.push_back({2, "interpolation", "Closest"});
    graph.links.push_back({2, "Color", 1, "Color"});
    Mesh mesh = flat(square(kPanelOfLight));
    for (Vec2& uv : mesh.uv_layers[0].uv)
        if (!turned) uv = Vec2(1.0f - uv.y, uv.x);
    add(maker, mesh, graph, transform, kVisibleAll & ~uint32_t{kVisibleCamera}, CausticsRole::off);
}

std::vector<Setup> under_an_image_of_light(bool turned = false) {
    const auto hang = [=](SceneMaker& m) {
        add_panel_of_light(m, rotation_x(kPi + 0.2f, {0.3f, -0.2f, 1.7f}), turned);
    };
    return {{"mirror",
             [=](SceneMaker& m) {
                 hang(m);
                 add_panel(m, mirror());
             }},
            {"glass", [=](SceneMaker& m) {
                 hang(m);
                 add_caster(m, slab(0.5f, 0.2f), glass(1.5f), translation({0.1f, 0, 0.7f}));
             }}};
}

// Water between floor and camera on one side and the lamp on the other.
std::vector<Setup> other_media() {
    const auto water = [](float angle, SceneMaker& m) {
        add_caster(m, flat(square(4.0f)), glass(1.33f), rotation_x(angle, {0, 0, 0.8f}));
        set_camera(m, {0.0f, -1.0f, 0.7f}, 0.4f);
        add_bulb(m, {0.4f, 0.3f, 2.2f}, 0.5f);
    };
    return {{"camera under water", [water](SceneMaker& m) { water(0.0f, m); }},
            {"lamp under water", [water](SceneMaker& m) { water(kPi, m); }}};
}

// Colours of media: chains of all lengths lose a good part of their light.
const Spectrum kTea(0.2f, 1.5f, 4.0f), kSmoke(0.3f, 0.5f, 0.8f);  // 1/m

// All rays see what absorbs; the camera looks by it where it is a caster.
void add_absorbing(SceneMaker& maker, const Mesh& mesh, const Graph& graph,
                   const Transform& transform, const Spectrum& sigma = kTea) {
    add(maker, mesh, test::absorbing(graph, sigma), transform, kVisibleAll, CausticsRole::automatic);
}
std::vector<Setup> absorbing_media() {
    const auto water = [](SceneMaker& m) {
        add_absorbing(m, test::block(4.0f, 1.0f), test::glass(1.33f),
                      test::translation({0, 0, 0.8f}));
        set_camera(m, {0.0f, -1.0f, 0.7f}, 0.4f);
        add_bulb(m, {0.4f, 0.3f, 2.2f}, 0.5f);
    };
    // Does not bend light: what passes between casters has to enter and to leave it.
    const auto mirror_in_smoke = [](float top, SceneMaker& m) {
        add_ball(m, test::mirror());
        add_absorbing(m, test::block(2.5f, 3.0f), test::transparent(1.0f),
                      test::translation({0, 0, top}), kSmoke);
    };
    return {{"floor and camera under coloured water", water},
            {"coloured glass slab",
             [](SceneMaker& m) {
                 add_absorbing(m, test::block(1.2f, 0.3f), test::glass(1.5f),
                               test::translation({0, 0, 1.2f}));
                 set_camera(m, {0.0f, -1.0f, 0.7f}, 0.3f);
                 add_bulb(m, {0.3f, 0.2f, 2.5f}, 0.6f);
             }},
            {"coloured glass ball",
             [](SceneMaker& m) {
                 add_absorbing(m, test::sphere(24, 0.4), test::glass(1.5f),
                               test::translation({-0.1f, 0.1f, 0.8f}));
                 set_camera(m, {0.0f, -1.0f, 0.5f}, 0.12f);
                 add_bulb(m, {0.1f, -0.2f, 2.2f}, 0.4f);
             }},
            {"mirror ball and lamp in smoke",
             [=](SceneMaker& m) {
                 mirror_in_smoke(1.5f, m);
                 add_bulb(m);
             }},
            {"mirror ball in smoke under a sun", [=](SceneMaker& m) {
                 mirror_in_smoke(1.3f, m);
                 LightDesc sun = lamp(LightType::sun, 3.0f);
                 sun.sun_angle = 0.25f;
                 m.builder.add_light(sun);
             }}};
}

void expect_agreement(const std::vector<Setup>& setups,
                      const IntegratorSettings& settings = few_bounces(),
                      CausticsRole floor = CausticsRole::receiver, uint32_t factor = 12,
                      bool from_mnee_seeds = false) {
    constexpr uint32_t kRounds = 2000;
    const uint32_t rounds = power(kRounds / 2, kRounds);
    for (const Setup& setup : setups) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker, floor);
        setup.build(maker);
        const RenderScene world = maker.finish();
        const Picture expected = path_traced(setup.name, world, settings, factor * kRounds);
        Picture light_paths;
        std::vector<Method> methods{kManifold, kLightPaths, kAll, kSheets};
        if (from_mnee_seeds) methods.insert(methods.end(), {kMnee, kMneeAndLight});
        for (const Method& method : methods) {
            const Picture actual = render(world, settings, method, rounds, 1u << 20);
            const std::string what = std::string(setup.name) + " by " + method.name;
            expect_same(actual, expected, what, 5 * int(setups.size()));
            if (!method.light_paths) continue;
            if (method.manifold)
                expect_same(actual, light_paths, what + ", or without", 5 * int(setups.size()));
            if (method.finder != ChainFinder::walks)
                continue;  // they may leave little to light paths
            light_paths = actual;
            expect_light_paths_to_matter(actual, expected, what);
        }
    }
}

// Whatever the weights of chains that sheets miss, all of them are found.
void expect_agreement_of_missed(const std::vector<Setup>& setups) {
    constexpr uint32_t kRounds = 2000;
    for (const Setup& setup : setups) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        setup.build(maker);
        const RenderScene world = maker.finish();
        expect_same(render(world, few_bounces(), kMissed, kRounds, 1u << 20),
                    path_traced(setup.name, world, few_bounces(), 6 * kRounds), setup.name,
                    int(setups.size()));
    }
}

TEST(LightPathsSlow, AgreeWithPathTracingForWhatSheetsMiss) {
    expect_agreement_of_missed(casters_under_a_bulb());
}
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

TEST(LightPathsSlow, AgreeWithPathTracingForEveryCaster) {
    expect_agreement(casters_under_a_bulb(), few_bounces(), CausticsRole::receiver, 8, true);
}
TEST(LightPathsSlow, AgreeWithPathTracingForEveryLight) { expect_agreement(lights_over_a_ball()); }
TEST(LightPathsSlow, AgreeWithPathTracingForEmissionFromAnImage) {
    expect_agreement(under_an_image_of_light());
    // The image turned by a quarter shows.
    std::vector<Picture> pictures;
    for (const bool turned : {false, true}) {
        SceneMaker maker;
        set_camera(maker);
        add_floor(maker);
        under_an_image_of_light(turned)[0].build(maker);
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
TEST(LightPathsSlow, AgreeWithPathTracingInOtherMedia) { expect_agreement(other_media()); }
TEST(LightPathsSlow, AgreeWithPathTracingInAbsorbingMedia) {
    expect_agreement(absorbing_media(), few_bounces(), CausticsRole::receiver, 16);
}

// What casters throw at a wall beside the floor.
constexpr Vec3 kWall(0.0f, 1.2f, 0.0f);

Graph satin() {
    return combined(diffuse(0.9f),
                    single_shader("bsdf_glossy", {{1, "Color", {0.9f, 0.9f, 0.9f, 1}},
                                                  {1, "Roughness", {0.5f, 0, 0, 0}}}),
                    0.5f);
}
void add_wall(SceneMaker& maker, const Graph& graph, uint32_t visibility = kVisibleAll,
              const Vec3& p = kWall) {
    Mesh mesh = flat(square(1.5f));
    add(maker, mesh, graph, rotation_x(0.5f * kPi, p), visibility, CausticsRole::receiver);
}
// A mirror that faces the wall.
void add_projector(SceneMaker& maker, const Graph& graph = mirror()) {
    add_caster(maker, square(0.5f), graph, rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
}
constexpr Vec3 kBeforeWall(0.0f, 0.5f, 1.6f);

std::vector<Setup> walls() {
    return {{"wall by a mirror",
             [](SceneMaker& m) {
                 add_wall(m, diffuse(0.9f));
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"bumpy wall by a mirror",
             [](SceneMaker& m) {
                 m.builder.add_image(gentle_waves());
                 Mesh mesh = square(1.5f);
                 mesh.normals.assign(6, Vec3(0, 0, 1));
                 m.add(mesh, normal_mapped(diffuse(0.9f), Vec2(1.0f, 1.0f)),
                       rotation_x(0.5f * kPi, kWall), CausticsRole::receiver);
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"satin wall by glass",
             [](SceneMaker& m) {
                 add_wall(m, satin());
                 add_caster(m, slab(0.6f, 0.2f), glass(1.5f), rotation_x(0.9f, {0.0f, 0.4f, 1.2f}));
                 add_bulb(m, {0.0f, -0.4f, 2.0f}, 0.25f);
             }},
            {"screen from behind",
             [](SceneMaker& m) {
                 add_wall(m, combined(refraction(1.2f, 0.6f), diffuse(0.6f), 0.3f));
                 add_caster(m, square(0.6f), mirror(), rotation_x(1.3f, {0.0f, 2.4f, 0.8f}));
                 // Not seen through the screen itself.
                 add_bulb(m, {0.0f, 1.6f, 1.5f}, 0.25f, kVisibleGlossy | kVisibleShadow);
             }},
            {"wall behind a sheet",
             [](SceneMaker& m) {
                 add_wall(m, diffuse(0.9f));
                 m.add(flat(square(1.0f)), combined(transparent(0.8f), diffuse(0.5f), 0.4f),
                       rotation_x(1.0f, {0.0f, 0.9f, 0.4f}));
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }},
            {"wall that the camera does not see", [](SceneMaker& m) {
                 add_wall(m, diffuse(0.9f), kVisibleAll & ~uint32_t{kVisibleCamera});
                 add_projector(m);
                 add_bulb(m, kBeforeWall, 0.25f);
             }}};
}

// Light from the wall comes to the floor by way of more casters.
std::vector<Setup> walls_behind_casters() {
    const auto wall_and = [](const char* name, const Mesh& mesh, const Graph& graph,
                             const Transform& transform) {
        return Setup{name, [=](SceneMaker& m) {
                         add_wall(m, satin());
                         add_projector(m);
                         add_bulb(m, kBeforeWall, 0.35f);
                         add_caster(m, mesh, graph, transform);
                     }};
    };
    return {wall_and("wall behind a sheet that refracts", square(0.9f), refraction(1.3f),
                     rotation_x(0.5f * kPi, {0.0f, 0.9f, 0.9f})),
            wall_and("wall in a mirror", square(0.9f), mirror(),
                     rotation_x(-0.5f * kPi, {0.0f, -1.0f, 0.9f}))};
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
TEST(LightPathsSlow, AgreeForIndirectCausticsBehindCasters) {
    expect_agreement(walls_behind_casters(), more_bounces(), CausticsRole::off, 40);
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
                           add_ball(m, mirror());
                           add_bulb(m);
                       }},
                      walls()[1]},
                     few_going_on());
}

// What a camera does not see shows no caustic; what nothing else sees shows its own all the same.
TEST(LightPathsSlow, AgreeForReceiversThatFewSee) {
    const auto floor_of = [](uint32_t visibility) {
        return [visibility](SceneMaker& m) {
            add_panel(m, mirror());
            add(m, square(0.5f), diffuse(0.8f), translation({0, 0, 0.1f}), visibility,
                CausticsRole::receiver);
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
            add_panel(m, mirror());
            add_caster(m, square(0.6f), refraction(1.4f), rotation_x(0.3f, {0.2f, 0.0f, 0.4f}));
        },
        settings, CausticsRole::receiver);
}
TEST(LightPathsSlow, AgreeWithTheManifoldForDeltaLightsOnWalls) {
    expect_agreement_with_manifold(
        [](SceneMaker& m) {
            add_wall(m, diffuse(0.9f));
            // Lit from above, it throws the light at the wall alone.
            add_caster(m, square(0.5f), mirror(), rotation_x(-0.7f, {0.0f, -0.3f, 0.6f}));
        },
        few_going_on(), CausticsRole::off);
}

}  // namespace
}  // namespace spc::test
