// SPDX-License-Identifier: GPL-3.0-or-later
// Where light tracing or sheets might do harm: sessions with and without have the same mean, with
// them no brighter outliers, at little more work.
#include "render/session.h"

#include "support/casters.h"
#include "support/power.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

#include <numeric>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

// By day of half the size: the means of its parts have twice the error.
const uint32_t kSmaller = test::power(2, 1);
const uint32_t kSide = 48 / kSmaller;
constexpr uint32_t kSamples = 10, kSeeds = 12;
constexpr uint32_t kParts = 4;  // squares in a row

Camera looking_down(const Vec3& from, float half) {
    Camera camera;
    camera.to_world = test::rotation_x(std::atan2(-from.y, from.z), from);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-half, half, -half, half};
    return camera;
}

void add_floor(SceneMaker& maker, float half = 4.0f) {
    maker.add(test::square(half), test::diffuse(0.8f), {}, CausticsRole::receiver);
}
void add_bulb(SceneMaker& maker, const Vec3& p, float radius, float power) {
    LightDesc light;
    light.name = "bulb";
    light.type = LightType::point;
    light.to_world = test::translation(p);
    light.power = Spectrum(power);
    light.radius = radius;
    maker.builder.add_light(light);
}
void add_caster(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Transform& transform,
                uint32_t visibility = kVisibleAll) {
    maker.add(mesh, graph, transform, CausticsRole::caster, visibility);
}
void add_panel(SceneMaker& maker, uint32_t visibility = kVisibleAll) {
    add_caster(maker, test::square(0.6f), test::mirror(),
               test::rotation_x(1.3f, {0.0f, 0.9f, 0.6f}), visibility);
}

// ---- pictures over many seeds

struct Pictures {
    std::vector<std::array<double, kParts * kParts>> parts;  // of each seed
    std::vector<test::MeanEstimate> pixels;
    double brightest = 0.0;  // pixel of a picture, on average
    uint64_t splats = 0;

    // Sum of the pixels' variances but for a hundredth of them.
    double trimmed_variance() const {
        std::vector<double> variance;
        for (const test::MeanEstimate& pixel : pixels)
            variance.push_back(pixel.standard_error() * pixel.standard_error());
        std::sort(variance.begin(), variance.end());
        return std::accumulate(variance.begin(), variance.end() - variance.size() / 100, 0.0);
    }
};

// Chains of several vertices are path tracing's alone without light tracing: so rare and bright
// that no mean of these samples knows of them.
constexpr BounceLimits kAll{}, kShortChains{4, 2, 1, 1, 8};

struct Method {
    bool manifold, light_tracing;
    ChainFinder finder = ChainFinder::walks;
};
constexpr Method kPathTracing{false, false}, kLightPaths{false, true}, kWalks{true, false},
    kWalksAndLight{true, true}, kSheets{true, false, ChainFinder::sheets},
    kSheetsAndLight{true, true, ChainFinder::sheets};

RenderSettings settings_for(const BounceLimits& limits, const Method& method, uint32_t samples,
                            uint32_t seed) {
    RenderSettings settings;
    settings.integrator.limits = limits;
    if (method.manifold) {
        ManifoldSettings& manifold = settings.integrator.manifold;
        manifold = test::unbiased_manifold();
        manifold.finder = method.finder;
    }
    settings.light_tracing = method.light_tracing;
    settings.samples = samples;
    settings.seed = seed;
    settings.threads = 1;
    return settings;
}

Pictures pictures_of(const RenderScene& world, const BounceLimits& limits, const Method& method,
                     uint32_t samples = kSamples, uint32_t seeds = kSeeds) {
    const size_t width = world.scene->camera.crop[2], height = world.scene->camera.crop[3];
    Pictures pictures;
    pictures.pixels.resize(width * height);
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        Session session(world, settings_for(limits, method, samples, seed));
        EXPECT_EQ(session.wait(600s).state, RenderState::done);
        std::vector<float> image(4 * width * height);
        session.film().read(Pass::combined, image);
        auto& parts = pictures.parts.emplace_back();
        parts.fill(0.0);
        double brightest = 0.0;
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x < width; ++x) {
                const double value = double(image[4 * (y * width + x)]);
                pictures.pixels[y * width + x].add(value);
                brightest = std::max(brightest, value);
                parts[y * kParts / height * kParts + x * kParts / width] += value;
            }
        pictures.brightest += brightest / seeds;
        const RenderStats stats = session.stats();
        EXPECT_EQ(stats.nan_samples + stats.light.nan_splats, 0u);
        pictures.splats += stats.light.splats;
    }
    return pictures;
}

// Renders of one seed share samples: their difference is what has no mean.
void expect_same(const Pictures& a, const Pictures& b, const std::string& what) {
    for (size_t i = 0; i < kParts * kParts; ++i) {
        test::MeanEstimate difference;
        for (size_t seed = 0; seed < a.parts.size(); ++seed)
            difference.add(a.parts[seed][i] - b.parts[seed][i]);
        EXPECT_TRUE(test::is_mean(difference, 0.0, test::sidak(1e-3, int(kParts * kParts))))
            << what << ", part " << i;
    }
}

// Rays and iterations of a render long enough for what is learned beforehand to pay.
double work_of(const RenderScene& world, const Method& method) {
    Session session(world, settings_for(kAll, method, 8 * kSamples * kSmaller * kSmaller, 1));
    EXPECT_EQ(session.wait(600s).state, RenderState::done);
    const RenderStats stats = session.stats();
    return double(stats.path.rays + stats.path.manifold.rays + stats.path.manifold.iterations +
                  stats.light.rays);
}

// ---- harm

constexpr double kBrighter = 2.0, kMoreWork = 1.2;  // maxima of heavy tails are noise themselves
constexpr double kMoreWorkOfSheets = 2.0;           // they are built beforehand, and tell more
constexpr double kLessEfficient = 1.15;             // variance x work, with its noise

struct Expected {
    bool useful = true;                    // light paths are
    uint32_t samples_of_means = kSamples;  // fewer do not know of the tail of walks
};

// What a method makes of a scene.
struct Outcome {
    double work;
    Pictures means, all;  // of short chains with many samples, and of all chains
};
Outcome outcome_of(const RenderScene& world, const Method& method, const Expected& expected) {
    return {work_of(world, method),
            pictures_of(world, kShortChains, method, expected.samples_of_means),
            pictures_of(world, kAll, method)};
}

void expect_no_harm(const RenderScene& world, const Method& without, const Outcome& outcome_without,
                    const Method& with, const Expected& expected) {
    const bool more_sheets = with.finder != without.finder;
    const std::string what = more_sheets ? "sheets and light tracing" : "light tracing";
    const Outcome outcome_with = outcome_of(world, with, expected);
    const double work = outcome_with.work / outcome_without.work;
    std::cout << what << ": work x " << work << std::endl;
    EXPECT_LE(work, more_sheets ? kMoreWorkOfSheets : kMoreWork) << what;
    expect_same(outcome_with.means, outcome_without.means, "with " + what);
    const Pictures &before = outcome_without.all, &after = outcome_with.all;
    EXPECT_EQ(after.splats > 0, expected.useful) << what;
    const double variance = after.trimmed_variance() / before.trimmed_variance();
    std::cout << what << ": " << after.splats << " splats, maximum x "
              << after.brightest / before.brightest << ", trimmed variance x " << variance
              << std::endl;
    EXPECT_LE(after.brightest, kBrighter * before.brightest) << what;
    EXPECT_LE(variance * work, kLessEfficient) << what;
}

// Beside light paths and sheets lamps are found that the camera sees in casters, which walks alone
// hardly ever meet: here casters hide from it.
constexpr uint32_t kHidden = kVisibleAll & ~uint32_t{kVisibleCamera};

void expect_no_harm(const std::function<void(SceneMaker&)>& build, const Expected& expected = {}) {
    SceneMaker maker;
    build(maker);
    const RenderScene world = maker.finish();
    const Outcome without = outcome_of(world, kWalks, expected);
    for (const Method& with : {kWalksAndLight, kSheetsAndLight})
        expect_no_harm(world, kWalks, without, with, expected);
}

TEST(LightTracingStressSlow, CloseUpOfAWideCaustic) {
    expect_no_harm(
        [](SceneMaker& m) {
            m.builder.add_image(test::plane_normals(256, 0.1, 0.03, 3));
            const Mesh panel =
                test::with_uvs(test::grid(
                                   1, [](double u, double v) { return Vec3d(6 * u - 3, 3 * v, 0); },
                                   [](double, double) { return Vec3d(0, 0, 1); }),
                               1);
            m.builder.set_camera(looking_down({0.0f, -1.0f, 1.0f}, 0.03f));
            add_floor(m);
            add_caster(m, panel, test::normal_mapped(test::mirror(), Vec2(2.0f, 1.0f)),
                       test::rotation_x(1.4f, {0.0f, 1.5f, 0.0f}), kHidden);
            add_bulb(m, {0.3f, -2.5f, 2.0f}, 0.03f, 100.0f);
        },
        {.samples_of_means = 8 * kSamples});
}

TEST(LightTracingStressSlow, AThousandSmallCasters) {
    const auto build = [](SceneMaker& m) {
        m.builder.set_camera(looking_down({0.0f, -3.0f, 3.0f}, 0.3f));
        add_floor(m);
        Pcg pcg(11);
        const uint32_t mesh = m.builder.add_mesh(test::sphere(8, 0.03)),
                       mirror = m.builder.add_material(test::mirror());
        for (int i = 0; i < 1000; ++i) {
            Instance instance;
            instance.name = "ball " + std::to_string(i);
            instance.mesh = mesh;
            instance.object_to_world = test::translation(
                {3.0f * pcg.one() - 1.5f, 3.0f * pcg.one() - 1.5f, 0.05f + 0.3f * pcg.one()});
            instance.materials = {mirror};
            instance.visibility = kHidden;
            instance.role = CausticsRole::caster;
            m.builder.add_instance(instance);
        }
        add_bulb(m, {0.5f, -0.5f, 3.0f}, 0.05f, 100.0f);
    };
    expect_no_harm(build);
}

TEST(LightTracingStressSlow, ALightFarOutside) {
    expect_no_harm(
        [](SceneMaker& m) {
            m.builder.set_camera(looking_down({0.0f, -3.0f, 2.0f}, 0.3f));
            add_floor(m);
            add_panel(m, kHidden);
            add_caster(m, test::sphere(24, 0.3), test::glass(1.5f),
                       test::translation({0.2f, 0.0f, 0.5f}), kHidden);
            add_bulb(m, {0.0f, -3e3f, 4e3f}, 2.0f, 4e8f);
        },
        {.samples_of_means = 4 * kSamples});
}

TEST(LightTracingStressSlow, ACasterThatFillsTheView) {
    const auto build = [](SceneMaker& m, float height, uint32_t casters) {
        m.builder.set_camera(looking_down({0.0f, -0.75f * height, height}, 0.3f));
        add_floor(m);
        m.builder.add_image(test::plane_normals(256, 0.1, 0.03, 3));
        const Mesh water =
            test::with_uvs(test::grid(
                               1, [](double u, double v) { return Vec3d(6 * u - 3, 6 * v - 3, 0); },
                               [](double, double) { return Vec3d(0, 0, 1); }),
                           1);
        add_caster(m, water, test::normal_mapped(test::glass(1.33f), Vec2(2.0f, 2.0f)),
                   test::translation({0.0f, 0.0f, 0.5f}), casters);
        add_bulb(m, {0.5f, 0.8f, 2.5f}, 0.05f, 100.0f);
    };
    // From above all is seen through it, lamps too, which sheets always find; from below lit
    // through it.
    SceneMaker above;
    build(above, 2.0f, kVisibleAll);
    const RenderScene world = above.finish();
    const Expected useless{.useful = false};
    expect_no_harm(world, kSheets, outcome_of(world, kSheets, useless), kSheetsAndLight, useless);
    expect_no_harm([build](SceneMaker& m) { build(m, 0.4f, kHidden); });
}

// ---- seams: path tracing finds a lamp of this size so often that so many seeds know of its tail

constexpr float kLargeLamp = 0.8f;
constexpr uint32_t kManySeeds = 36;

void expect_agreement(const Camera& camera) {
    SceneMaker maker;
    maker.builder.set_camera(camera);
    add_floor(maker);
    add_panel(maker);
    maker.add(test::sphere(16, 0.2), test::glass(1.5f), test::translation({0.3f, 0.0f, 0.4f}),
              CausticsRole::caster);
    add_bulb(maker, {0.0f, -0.7f, 2.2f}, kLargeLamp, 100.0f);
    const RenderScene world = maker.finish();
    const Pictures expected = pictures_of(world, kAll, kPathTracing, 8 * kSamples, kManySeeds),
                   light_paths = pictures_of(world, kAll, kLightPaths, kSamples, kManySeeds),
                   all = pictures_of(world, kAll, kWalksAndLight, kSamples, kManySeeds);
    EXPECT_GT(all.splats, 1000u);
    expect_same(light_paths, expected, "light paths");
    expect_same(all, expected, "manifold and light paths");
}

TEST(LightTracingSeamsSlow, DepthOfField) {
    Camera camera = looking_down({0.0f, -3.0f, 2.0f}, 0.3f);
    camera.aperture_radius = 0.15f;
    camera.focus_distance = 2.5f;
    camera.aperture_blades = 5;
    camera.aperture_ratio = 1.5f;
    expect_agreement(camera);
}
TEST(LightTracingSeamsSlow, OrthographicCamera) {
    Camera camera = looking_down({0.0f, -3.0f, 2.0f}, 1.2f);
    camera.projection = Projection::orthographic;
    expect_agreement(camera);
}
TEST(LightTracingSeamsSlow, Border) {
    Camera camera = looking_down({0.0f, -3.0f, 2.0f}, 0.3f);
    camera.crop = {11 / kSmaller, 5 / kSmaller, 24 / kSmaller, 36 / kSmaller};
    expect_agreement(camera);
}

}  // namespace
}  // namespace spc
