// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that the camera sees in casters, by chains from the camera beside path tracing: against a
// closed form, and against path tracing alone.
#include "integrator/camera_chains.h"
#include "integrator/pictures.h"

#include <fmt/format.h>

namespace spc::test {
namespace {

constexpr uint32_t kWidth = 32;     // pixels
constexpr float kHalfView = 0.08f;  // of the picture, at distance 1: little more than a ball
constexpr uint32_t kWalks = 8192;
// Lamps: the camera sees one reflected by the ball at the origin, the other through it.
const Vec3 kEye(0.0f, -3.0f, 2.0f), kBefore(0.3f, -1.4f, 2.2f), kBehind(0.1f, 1.5f, -1.1f);

void set_wide_camera(SceneMaker& maker, const Vec3& from, const std::function<void(Camera&)>& more) {
    Camera camera;
    camera.to_world = rotation_x(std::atan2(-from.y, from.z), from);
    camera.width = camera.height = kWidth;
    camera.crop = {0, 0, kWidth, kWidth};
    camera.viewplane = {-kHalfView, kHalfView, -kHalfView, kHalfView};
    if (more) more(camera);
    maker.builder.set_camera(camera);
}

enum class By { rays, chain_seeds, searches };

// In the place of all chain seeds one that comes to nothing, and so many searches that they have their share
// beside rays, which find the lamps of this test easily.
void blind(CameraChains& camera_chains) {
    camera_chains.searches = 16.0;
    for (std::vector<ChainSeed>& chain_seeds : camera_chains.chain_seeds) {
        if (chain_seeds.empty()) continue;
        chain_seeds.resize(1);
        chain_seeds[0].w = chain_seeds[0].w * -1.0f;
    }
}

// The whole picture without what lights show by themselves.
Picture render_camera_chains(const RenderScene& world, By by, uint32_t rounds, uint32_t seed,
                             const BounceLimits& limits = {16, 0, 16, 16, 16},
                             uint32_t walks = kWalks, ChainFinder finder = ChainFinder::sheets) {
    IntegratorSettings settings;
    settings.limits = limits;
    PathStats stats;
    std::optional<CameraChains> camera_chains;
    if (by != By::rays) {
        settings.manifold = unbiased_manifold();
        settings.manifold.finder = finder;
        const std::unique_ptr<const CameraChains> learned =
            learn_camera_chains(world, settings, walks, seed, 1, Budget(), stats);
        EXPECT_TRUE(learned) << "no chain from the camera to a light";
        if (learned) camera_chains = *learned;
        if (by == By::searches) blind(*camera_chains);
        settings.camera_chains = &*camera_chains;
    }
    const Camera& camera = world.scene->camera;
    const auto& [x0, y0, width, height] = camera.crop;
    Picture picture;
    std::vector<Splat> splats;
    for (uint32_t round = 0; round < rounds; ++round) {
        std::array<double, 5> sum{};
        double splatted = 0.0;
        const auto add = [&](float x, float y, double value) {
            const bool right = x >= float(x0) + 0.5f * float(width),
                       upper = y >= float(y0) + 0.5f * float(height);
            sum[(upper ? 2u : 0u) + (right ? 1u : 0u)] += value;
            sum[4] += value;
        };
        for (uint32_t y = y0; y < y0 + height; ++y)
            for (uint32_t x = x0; x < x0 + width; ++x) {
                const Sampler sampler(seed, (round * kWidth + y) * kWidth + x, 0);
                const Vec2 u = sampler[Domain::film].two(), lens = sampler[Domain::lens].two();
                const float fx = float(x) + u.x, fy = float(y) + u.y;
                add(fx, fy,
                    average(path_radiance(world, settings, {}, camera.ray(fx, fy, lens), lens,
                                          sampler, stats)
                                .radiance));
            }
        splats.clear();
        const auto count = camera_chains ? static_cast<uint64_t>(camera_chains->estimates) : 0u;
        for (uint64_t i = 0; i < count; ++i)
            estimate_camera_chains(world, settings, 0.0f, seed, round * count + i, splats, stats);
        const uint64_t searches =
            camera_chains ? camera_chain_searches(camera, *camera_chains, 0.0f) : 0u;
        for (uint64_t i = 0; i < searches; ++i)
            search_camera_chains(world, settings, 0.0f, seed, round * searches + i, splats, stats);
        for (const Splat& splat : splats) {
            add(splat.film.x, splat.film.y, average(splat.value));
            splatted += average(splat.value);
        }
        for (size_t i = 0; i < sum.size(); ++i) picture.mean[i].add(sum[i]);
        picture.splats.add(splatted);
    }
    return picture;
}

// In a flat mirror the picture of a lamp is that of a lamp behind it: its radiance over the solid
// angle of a sphere.
TEST(CameraChains, OfASphereInAMirrorAreInClosedForm) {
    constexpr float kRadius = 0.003f;
    const Vec3 eye = kEye, at(0.1f, 2.0f, 1.4f);
    SceneMaker maker;
    set_wide_camera(maker, eye, {});
    maker.add(square(1.0f), mirror(), {}, CausticsRole::caster);
    add_bulb(maker, at, kRadius);
    const RenderScene world = maker.finish();

    const Vec3 to = Vec3(at.x, at.y, -at.z) - eye;
    const double distance = double(length(to)),
                 cosine = double(dot(to, Vec3(0.0f, 0.0f, 0.0f) - eye)) /
                          (distance * double(length(eye)));
    const double radiance = 100.0 / (4.0 * std::pow(std::numbers::pi * double(kRadius), 2));
    const double solid_angle = std::numbers::pi * std::pow(double(kRadius) / distance, 2);
    const double pixels_per_sr =
        std::pow(double(kWidth) / (2.0 * double(kHalfView)), 2) / std::pow(cosine, 3);
    const double expected = radiance * solid_angle * pixels_per_sr;

    for (const ChainFinder finder : {ChainFinder::sheets, ChainFinder::walks, ChainFinder::mnee}) {
        const Picture picture = render_camera_chains(world, By::chain_seeds, 500, 3,
                                                     {16, 0, 16, 16, 16}, kWalks, finder);
        const double error = picture.mean[4].standard_error();
        EXPECT_LT(error, 0.005 * expected);
        EXPECT_NEAR(picture.mean[4].mean(), expected, 4.0 * error);
        EXPECT_GT(picture.splats.mean(), 0.99 * picture.mean[4].mean());
    }
}

// Between two mirrors, seen down a row of pictures: the one behind n reflections, the floor's first,
// lies n below for odd n, for a distance of 1 between them.
TEST(CameraChains, BetweenMirrorsAreInClosedFormForAllReflections) {
    constexpr float kRadius = 0.003f;
    constexpr uint32_t kMost = kLongestChain, kMiddle = 9;
    const Vec3 eye(0.0f, -0.8f, 0.5f), at(0.0f, 0.8f, 0.4f);
    const auto picture_of = [&](uint32_t n) {
        const float below = n % 2 == 1 ? -at.z : at.z;
        return Vec3(at.x, at.y, below - static_cast<float>(n - n % 2));
    };
    SceneMaker maker;
    const Vec3 middle = picture_of(kMiddle) - eye;
    set_wide_camera(maker, eye, [&](Camera& camera) {
        camera.to_world = rotation_x(std::atan2(middle.y, -middle.z), eye);
    });
    maker.add(square(1.0f), mirror(), {}, CausticsRole::caster);
    maker.add(square(1.0f), mirror(), rotation_x(std::numbers::pi_v<float>, {0.0f, 0.0f, 1.0f}),
              CausticsRole::caster);
    add_bulb(maker, at, kRadius);
    const RenderScene world = maker.finish();

    const double radiance = 100.0 / (4.0 * std::pow(std::numbers::pi * double(kRadius), 2));
    double expected = 0.0;
    uint32_t seen = 0;
    for (uint32_t n = 1; n <= kMost; ++n) {
        const Vec3 to = picture_of(n) - eye;
        const double distance = double(length(to)),
                     cosine = double(dot(to, middle)) / (distance * double(length(middle))),
                     tangent = double(length(cross(to, middle)) / dot(to, middle));
        ASSERT_GT(std::abs(tangent - double(kHalfView)), 2.0 * double(kRadius) / distance) << n;
        if (tangent > double(kHalfView)) continue;
        const double pixels_per_sr =
            std::pow(double(kWidth) / (2.0 * double(kHalfView)), 2) / std::pow(cosine, 3);
        expected +=
            radiance * std::numbers::pi * std::pow(double(kRadius) / distance, 2) * pixels_per_sr;
        ++seen;
    }
    EXPECT_GE(seen, 5u);

    const BounceLimits limits{kMost - 1, 0, kMost - 1, kMost - 1, 16};
    const Picture picture =
        render_camera_chains(world, By::chain_seeds, 500, 3, limits, 32 * kWalks);
    const double error = picture.mean[4].standard_error();
    EXPECT_LT(error, 0.02 * expected);
    EXPECT_NEAR(picture.mean[4].mean(), expected, 4.0 * error);
    EXPECT_GT(picture.splats.mean(), 0.95 * picture.mean[4].mean());  // none was left out
}

struct Case {
    std::string name;
    RenderScene world;
    uint32_t rounds = 4000;
    BounceLimits limits{16, 0, 16, 16, 16};
    ChainFinder finder = ChainFinder::sheets;
};

// Path tracing has to find the lamps often enough for a comparison: some pixels wide.
void expect_agreement(std::vector<Case> cases, By by = By::chain_seeds) {
    for (Case& one : cases) {
        const Picture expected = true_picture(one.name, one.rounds,
                                              [&](uint32_t rounds) {
                                                  return render_camera_chains(
                                                      one.world, By::rays, rounds, 11, one.limits);
                                              }),
                      actual = render_camera_chains(one.world, by, one.rounds / 16, 12, one.limits,
                                                    kWalks, one.finder);
        for (size_t i = 0; i < actual.mean.size(); ++i) {
            // Of less than some ten hits nothing follows for a part.
            const MeanEstimate& traced = expected.mean[i];
            if (i < 4 && !(traced.standard_error() < 0.3 * traced.mean())) continue;
            EXPECT_TRUE(
                same_mean(actual.mean[i], expected.mean[i], sidak(kFamily, 5 * int(cases.size()))))
                << one.name << ", part " << i;
        }
        const double noise = std::hypot(expected.mean[4].standard_error(),
                                        actual.mean[4].standard_error()),
                     share = actual.splats.mean() / actual.mean[4].mean();
        std::cout << one.name << ": chains give " << share << " of the picture, known to "
                  << noise / expected.mean[4].mean() << std::endl;
        EXPECT_GT(0.3 * actual.splats.mean(), 5.0 * noise) << one.name;
    }
}

Case with_bulb(const std::string& name, const std::function<void(SceneMaker&)>& casters,
               float radius = 0.012f, const std::function<void(Camera&)>& camera = {}) {
    SceneMaker maker;
    set_wide_camera(maker, kEye, camera);
    casters(maker);
    add_bulb(maker, kBefore, radius);
    return {name, maker.finish()};
}

void add_seen(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Vec3& at) {
    maker.add(mesh, graph, translation(at), CausticsRole::caster);
}
// Hidden from the camera.
void add_unseen(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Vec3& at) {
    maker.add(mesh, graph, translation(at), CausticsRole::caster,
              kVisibleAll & ~uint32_t{kVisibleCamera});
}
void add_mirror_ball(SceneMaker& maker) { add_seen(maker, sphere(24, 0.5), mirror(), {0, 0, 0}); }
void add_glass_ball(SceneMaker& maker) { add_seen(maker, sphere(24, 0.5), glass(1.5f), {0, 0, 0}); }

TEST(CameraChainsSlow, AgreeWithPathTracingForEveryCaster) {
    std::vector<Case> cases;
    cases.push_back(with_bulb("mirror ball", add_mirror_ball, 0.1f));
    cases.push_back(with_bulb("glass ball", add_glass_ball, 0.1f));
    cases.push_back(with_bulb(
        "two balls",
        [](SceneMaker& maker) {
            add_seen(maker, sphere(24, 0.14), mirror(), {-0.15f, 0, 0});
            add_seen(maker, sphere(24, 0.14), glass(1.5f), {0.15f, 0, 0});
        },
        0.2f));
    cases.push_back(with_bulb(
        "a ball beside one that the camera does not see",
        [](SceneMaker& maker) {
            add_seen(maker, sphere(24, 0.14), mirror(), {-0.15f, 0, 0});
            add_unseen(maker, sphere(24, 0.14), mirror(), {0.15f, 0, 0});
        },
        0.2f));
    cases.push_back(with_bulb(
        "bumped mirror",
        [](SceneMaker& maker) {
            maker.builder.add_image(plane_normals(32, 0.25, 0.05, 4));
            maker.add(square(1.0f), normal_mapped(mirror(), {1, 1}),
                      rotation_x(std::numbers::pi_v<float> / 4), CausticsRole::caster);
        },
        0.05f));
    expect_agreement(std::move(cases));
}

// What the manifold does elsewhere is not to show in their weights.
TEST(CameraChainsSlow, AgreeWithPathTracingBesideEveryFinder) {
    std::vector<Case> cases;
    for (const ChainFinder finder : {ChainFinder::walks, ChainFinder::mnee})
        for (const auto& add_ball : {add_mirror_ball, add_glass_ball}) {
            cases.push_back(with_bulb(
                fmt::format("ball {} beside finder {}", cases.size() % 2, static_cast<int>(finder)),
                add_ball, 0.1f));
            cases.back().finder = finder;
        }
    expect_agreement(std::move(cases));
}

TEST(CameraChainsSlow, AgreeWithPathTracingForEveryCamera) {
    std::vector<Case> cases;
    cases.push_back(with_bulb("lens", add_mirror_ball, 0.1f, [](Camera& camera) {
        camera.aperture_radius = 0.02f;
        camera.focus_distance = 3.0f;
    }));
    cases.push_back(with_bulb("window", add_mirror_ball, 0.1f, [](Camera& camera) {
        camera.crop = {12, 10, 17, 20};
    }));
    cases.push_back(with_bulb(
        "near clip behind a pane",
        [](SceneMaker& maker) {
            add_mirror_ball(maker);
            maker.add(square(0.5f), diffuse(0.5f), rotation_x(0.98f, kEye * 0.8f));
        },
        0.1f, [](Camera& camera) { camera.clip_near = 1.2f; }));
    expect_agreement(std::move(cases));
}

TEST(CameraChainsSlow, AgreeWithPathTracingForEveryLight) {
    std::vector<Case> cases;
    const auto with = [&](const char* name, const std::function<void(SceneMaker&)>& add_lights,
                          const std::function<void(SceneMaker&)>& add_ball = add_glass_ball) {
        SceneMaker maker;
        set_wide_camera(maker, kEye, {});
        add_ball(maker);
        add_lights(maker);
        cases.push_back({name, maker.finish()});
    };
    with("sun", [](SceneMaker& maker) {
        LightDesc sun = lamp(LightType::sun, 2.0f);
        sun.to_world = rotation_x(0.56f);
        sun.sun_angle = 0.1f;
        maker.builder.add_light(sun);
    });
    with("square lamp and a bulb", [](SceneMaker& maker) {
        maker.add_area_light(rotation_x(-0.7f, {0.4f, -1.0f, 1.6f}), 0.1f, 5.0f);
        add_bulb(maker, kBefore, 0.1f);
    });
    with("glowing mesh", [](SceneMaker& maker) { add_glowing(maker, sphere(12, 0.1), kBefore); });
    with(
        "lamp that shines through everything beside a bulb",
        [](SceneMaker& maker) {
            add_bulb(maker, kBefore, 0.1f);
            add_bulb(maker, {-0.3f, -1.4f, 2.2f}, 0.1f, kNotDirectly & ~kVisibleShadow);
        },
        add_mirror_ball);
    expect_agreement(std::move(cases));
}

TEST(CameraChainsSlow, AgreeWithPathTracingWhereNoSeedComesToThem) {
    std::vector<Case> cases;
    cases.push_back(with_bulb("lens and window", add_mirror_ball, 0.1f, [](Camera& camera) {
        camera.aperture_radius = 0.02f;
        camera.focus_distance = 3.0f;
        camera.crop = {12, 10, 17, 20};
    }));
    cases.push_back(with_bulb(
        "bumped mirror",
        [](SceneMaker& maker) {
            maker.builder.add_image(plane_normals(32, 0.25, 0.05, 4));
            maker.add(square(1.0f), normal_mapped(mirror(), {1, 1}),
                      rotation_x(std::numbers::pi_v<float> / 4), CausticsRole::caster);
        },
        0.05f));
    cases.push_back(with_bulb(
        "mirror ball behind a veil",
        [](SceneMaker& maker) {
            add_mirror_ball(maker);
            maker.add(square(0.5f), transparent(0.5f), rotation_x(0.98f, kEye * 0.8f));
        },
        0.1f));
    for (Case& one : cases) one.rounds /= 2;
    expect_agreement(std::move(cases), By::searches);
}

TEST(CameraChainsSlow, AgreeWithPathTracingWithinLimits) {
    const auto both_lamps = [](SceneMaker& maker) {
        add_glass_ball(maker);
        add_bulb(maker, kBehind, 0.012f);
    };
    std::vector<Case> cases;
    cases.push_back(with_bulb("glass ball, no transmission", both_lamps, 0.15f));
    cases.back().limits = {16, 0, 16, 0, 16};
    cases.push_back(with_bulb("glass ball, one transmission", both_lamps, 0.15f));
    cases.back().limits = {16, 0, 16, 1, 16};
    cases.push_back(with_bulb("glass ball, one bounce", both_lamps, 0.15f));
    cases.back().limits = {1, 0, 1, 1, 16};
    expect_agreement(std::move(cases));
}

TEST(CameraChains, AreNotLookedForWhereNoneCanBe) {
    const auto learned = [](const std::function<void(SceneMaker&)>& fill) {
        SceneMaker maker;
        set_wide_camera(maker, kEye, {});
        fill(maker);
        const RenderScene world = maker.finish();
        IntegratorSettings settings;
        settings.manifold = unbiased_manifold();
        settings.manifold.finder = ChainFinder::sheets;
        PathStats stats;
        return learn_camera_chains(world, settings, kWalks, 1, 1, Budget(), stats) != nullptr;
    };
    const auto bulb = [](SceneMaker& maker, float radius) { add_bulb(maker, kBefore, radius); };
    EXPECT_TRUE(learned([&](SceneMaker& maker) {
        add_mirror_ball(maker);
        bulb(maker, 0.01f);
    }));
    EXPECT_FALSE(learned([&](SceneMaker& maker) { bulb(maker, 0.01f); }));
    EXPECT_FALSE(learned([&](SceneMaker& maker) {
        add_unseen(maker, sphere(24, 0.5), mirror(), {0, 0, 0});
        bulb(maker, 0.01f);
    }));
    EXPECT_FALSE(learned([&](SceneMaker& maker) {  // no ray ever hits it
        add_mirror_ball(maker);
        bulb(maker, 0.0f);
    }));
    EXPECT_FALSE(learned([&](SceneMaker& maker) {  // rays hit it as often
        add_mirror_ball(maker);
        maker.add_area_light(rotation_x(0.56f, kBefore), 1.5f, 5.0f);
    }));
}

}  // namespace
}  // namespace spc::test
