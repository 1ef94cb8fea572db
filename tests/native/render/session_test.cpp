// SPDX-License-Identifier: GPL-3.0-or-later
// A session with light paths: what it promises of its image, its ends, and the probabilities that
// it gives to manifold estimates.
#include "render/session_settings.h"

#include "core/error.h"

#include "support/glints.h"
#include "support/power.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

constexpr uint32_t kSide = 40;  // pixels: nine tiles, of which five are not whole

// A floor under a mirror and a ball of glass.
RenderScene scene_of(bool with_casters, float lamp_radius = 0.05f, const Vec3& place = Vec3(0.0f)) {
    SceneMaker maker;
    Camera camera;
    const Vec3 from(0.0f, -3.0f, 2.0f);
    camera.to_world = test::rotation_x(std::atan2(-from.y, from.z), place + from);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-0.3f, 0.3f, -0.3f, 0.3f};
    maker.builder.set_camera(camera);
    maker.add(test::square(4.0f), test::diffuse(0.8f), test::translation(place),
              CausticsRole::receiver);
    if (with_casters) {
        maker.add(test::square(0.6f), test::mirror(),
                  test::rotation_x(1.3f, place + Vec3(0.0f, 0.875f, 0.6f)), CausticsRole::caster);
        maker.add(test::sphere(16, 0.2), test::glass(1.5f),
                  test::translation(place + Vec3(0.3125f, 0.0f, 0.4f)), CausticsRole::caster);
    }
    LightDesc light;
    light.name = "lamp";
    light.type = LightType::point;
    light.to_world = test::translation(place + Vec3(0, -0.75f, 2.2f));
    light.power = Spectrum(100.0f);
    light.radius = lamp_radius;
    maker.builder.add_light(light);
    return maker.finish();
}

RenderSettings settings_with(uint32_t samples, uint32_t threads = 1) {
    RenderSettings settings = test::manifold_settings(samples, threads);
    settings.light_tracing = true;
    settings.passes.add(Pass::position);
    return settings;
}

struct Rendered {
    std::vector<float> combined, caustics, variance;
    RenderStats stats;
};
Rendered render(const RenderScene& world, RenderSettings settings) {
    settings.passes.add(Pass::caustics);
    Session session(world, settings);
    EXPECT_EQ(session.wait(60s).state, RenderState::done);
    EXPECT_EQ(session.failure(), nullptr);
    const auto read = [&](Pass pass) {
        std::vector<float> out(size_t{pass_channels(pass)} * kSide * kSide);
        session.film().read(pass, out);
        return out;
    };
    Rendered rendered{read(Pass::combined), read(Pass::caustics), read(Pass::variance),
                      session.stats()};
    EXPECT_EQ(rendered.stats.nan_samples + rendered.stats.light.nan_splats, 0u);
    return rendered;
}

// What lies 70 km from the origin, at coordinates that both places can tell, is the same picture:
// samples are the same but for rounding, which may send one of them elsewhere.
TEST(SessionWithLightPaths, PlaceDoesNotShow) {
    const Vec3 place(65536.0f, -32768.0f, 0.0f);
    const RenderScene near = scene_of(true), far = scene_of(true, 0.05f, place);
    EXPECT_EQ(length(near.scene->origin), 0.0f);
    EXPECT_LT(length(far.scene->origin - place), 1.0f);
    const auto positions = [](const RenderScene& world) {
        Session session(world, settings_with(4));
        EXPECT_EQ(session.wait(60s).state, RenderState::done);
        std::vector<float> out(size_t{3} * kSide * kSide);
        session.film().read(Pass::position, out);
        return out;
    };
    const std::vector<float> here = positions(near), there = positions(far);
    size_t moved = 0;
    for (size_t i = 0; i < here.size(); ++i)
        moved += std::abs(there[i] - place[static_cast<int>(i % 3)] - here[i]) > 0.02f;
    EXPECT_LT(moved, here.size() / 1000);
    RenderSettings few_bounces = settings_with(12);  // the longer a path, the farther it may be sent
    few_bounces.integrator.limits.total = 2;
    const Rendered a = render(near, few_bounces), b = render(far, few_bounces);
    size_t other = 0;
    for (size_t i = 0; i < a.combined.size(); ++i)
        other += std::abs(a.combined[i] - b.combined[i]) > 0.01f * (a.combined[i] + 0.01f);
    EXPECT_LT(other, a.combined.size() / 100);
}

// What a method alone has for its maps is there if that method renders.
TEST(Session, FlakesAreThereForTheirMethodAlone) {
    const test::GlintFloor floor{
        test::normal_mapped(test::single_shader("bsdf_glossy", {{1, "Roughness", {0.3f, 0, 0, 0}}}),
                            {1, 1}),
        test::plane_normals(128, 5.0 / 128, 0.2, 5), 6.0, 0.5f, [](SceneMaker& maker) {
            maker.builder.add_light(test::sun_towards({-0.5f, 0.2f, 1.0f}, 0.1f, 1.0f));
        }};
    const RenderScene world = test::finish(floor, GlintsMode::on);
    for (const GlintMethod method :
         {GlintMethod::search, GlintMethod::walks, GlintMethod::walks_biased, GlintMethod::yan}) {
        RenderSettings settings;
        settings.samples = 16;
        settings.threads = 2;
        settings.integrator.glints.method = method;
        Session session(world, settings);
        EXPECT_EQ(session.wait(60s).state, RenderState::done);
        EXPECT_EQ(session.failure(), nullptr);
        const RenderStats stats = session.stats();
        EXPECT_GT(stats.path.glints.estimates, 0u);
        EXPECT_EQ(stats.nan_samples, 0u);
        if (method == GlintMethod::yan)
            EXPECT_GT(stats.glint_bytes, world.glints.memory_bytes() + size_t{16} * 128 * 128);
        else
            EXPECT_EQ(stats.glint_bytes, world.glints.memory_bytes());
    }
}

// Tiles side by side: smooth and rough without a map, and of the given roughness with a normal map
// and with a bump.
RenderScene scene_that_may_glint(float roughness, GlintsMode mode) {
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(64, 5.0 / 64, 0.2, 5));
    Camera camera;
    camera.to_world = test::rotation_x(std::atan2(3.0f, 2.0f), Vec3(0.0f, -3.0f, 2.0f));
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-0.3f, 0.3f, -0.3f, 0.3f};
    maker.builder.set_camera(camera);
    const Graph rough = test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}});
    float x = -0.9f;
    for (Graph graph :
         {test::diffuse(0.8f), test::mirror(0.2f), test::glass(1.5f),
          test::normal_mapped(rough, {8, 8}), test::bump_mapped(rough, {8, 8}, 0.02f)}) {
        graph.glints = mode;
        maker.add(test::square(0.2f), graph, test::translation(Vec3(x, 0.0f, 0.0f)));
        x += 0.45f;
    }
    maker.builder.add_light(test::sun_towards({-0.2f, 0.8f, 0.6f}, 0.05f, 3.0f));
    return maker.finish();
}

// Where nothing glints, automatic glints are no glints, to the last bit. Its twin: with a lobe as
// narrow as it takes they are.
TEST(Session, GlintsAreNotThereWhereNothingGlints) {
    for (const float roughness : {0.45f, 0.2f}) {
        const bool glints = roughness < 0.4f;
        const RenderScene automatic = scene_that_may_glint(roughness, GlintsMode::automatic),
                          off = scene_that_may_glint(roughness, GlintsMode::off);
        RenderSettings settings;
        settings.samples = 16;
        settings.threads = 2;
        const Rendered a = render(automatic, settings), b = render(off, settings);
        EXPECT_EQ(a.combined == b.combined, !glints);
        EXPECT_EQ(a.variance == b.variance, !glints);
        EXPECT_EQ(a.caustics, b.caustics);
        EXPECT_EQ(a.stats.glint_bytes > 0, glints);
        EXPECT_EQ(a.stats.path.glints.estimates > 0, glints);
        EXPECT_EQ(a.stats.path.rays == b.stats.path.rays, !glints);
        EXPECT_EQ(b.stats.glint_bytes, 0u);
        EXPECT_EQ(b.stats.path.glints.estimates, 0u);
        EXPECT_GT(*std::max_element(b.combined.begin(), b.combined.end()), 1.0f)
            << "a black picture would pass";
    }
}

TEST(SessionWithLightPaths, ThreadsDoNotShow) {
    const RenderScene world = scene_of(true);
    const Rendered one = render(world, settings_with(12));
    EXPECT_GT(one.stats.light.splats, 1000u);
    EXPECT_GT(one.stats.path.manifold.estimates, 400u);
    for (const uint32_t threads : {2u, 5u}) {
        const Rendered many = render(world, settings_with(12, threads));
        EXPECT_EQ(many.combined, one.combined) << threads;
        EXPECT_EQ(many.caustics, one.caustics) << threads;
        EXPECT_EQ(many.variance, one.variance) << threads;
        EXPECT_EQ(many.stats.light.splats, one.stats.light.splats) << threads;
        EXPECT_EQ(many.stats.path.manifold.walks, one.stats.path.manifold.walks) << threads;
    }
}

// Through glass and in the mirror the lamp is a fraction of a pixel.
RenderSettings settings_with_camera_chains(ChainFinder finder, bool light_paths,
                                           uint32_t threads = 1) {
    RenderSettings settings = settings_with(12, threads);
    settings.integrator.manifold.finder = finder;
    settings.light_tracing = light_paths;
    return settings;
}

TEST(SessionWithCameraChains, ThreadsDoNotShow) {
    const RenderScene world = scene_of(true);
    for (const auto& [finder, light_paths] : {std::pair(ChainFinder::sheets, true),
                                              {ChainFinder::sheets, false},
                                              {ChainFinder::walks, true}}) {
        const Rendered one = render(world, settings_with_camera_chains(finder, light_paths));
        EXPECT_GT(one.stats.path.manifold.chain_seeds, 0u);
        for (const uint32_t threads : test::repeats(std::vector{2u, 5u}, {5u})) {
            const Rendered many =
                render(world, settings_with_camera_chains(finder, light_paths, threads));
            EXPECT_EQ(many.combined, one.combined) << threads;
            EXPECT_EQ(many.caustics, one.caustics) << threads;
            EXPECT_EQ(many.variance, one.variance) << threads;
            EXPECT_EQ(many.stats.path.manifold.walks, one.stats.path.manifold.walks) << threads;
        }
    }
}

// Of walks, which shoot no other chain seeds.
TEST(SessionWithCameraChains, AreBesideLightPathsAndNotBesideWalksAlone) {
    const RenderScene world = scene_of(true);
    const auto chain_seeds_of = [&](const RenderSettings& settings) {
        return render(world, settings).stats.path.manifold.chain_seeds;
    };
    EXPECT_GT(chain_seeds_of(settings_with_camera_chains(ChainFinder::walks, true)), 0u);
    EXPECT_EQ(chain_seeds_of(settings_with_camera_chains(ChainFinder::walks, false)), 0u);
    RenderSettings light_paths_alone = settings_with_camera_chains(ChainFinder::walks, true);
    light_paths_alone.integrator.manifold.enabled = false;
    EXPECT_EQ(chain_seeds_of(light_paths_alone), 0u);
}

TEST(SessionWithLightPaths, NeedsCastersAndLight) {
    EXPECT_EQ(render(scene_of(false), settings_with(2)).stats.light.paths, 0u);
    const RenderScene world = scene_of(true);
    RenderSettings off = settings_with(2);
    off.light_tracing = false;
    EXPECT_EQ(render(world, off).stats.light.paths, 0u);
    EXPECT_GT(render(world, settings_with(2)).stats.light.paths, 0u);
}

TEST(SessionWithLightPaths, CancelReturnsSoonFromThePilot) {
    const RenderScene world = scene_of(true);
    for (const auto delay : {0ms, 1ms, 5ms, 20ms, 60ms}) {
        RenderSettings settings = settings_with(1u << 20, 2);
        Session session(world, settings);
        std::this_thread::sleep_for(delay);
        const auto asked = std::chrono::steady_clock::now();
        session.cancel();
        EXPECT_EQ(session.wait(60s).state, RenderState::cancelled);
        EXPECT_LT(std::chrono::steady_clock::now() - asked, 200ms) << "after " << delay.count();
    }
}

TEST(SessionWithLightPaths, PilotGrowsWithTheRender) {
    constexpr uint64_t kLargestPilot = 1u << 19;
    const RenderScene world = scene_of(true);
    const uint64_t of_short_render = render(world, settings_with(2)).stats.light.paths;
    EXPECT_GE(of_short_render, kLeastPilotPaths);
    EXPECT_LT(of_short_render, kLargestPilot / 2);
    Session session(world, settings_with(1u << 20, 2));
    uint64_t paths = 0;  // none of them is counted before the pilot's end
    while (paths == 0 && session.wait(1ms).state == RenderState::running)
        paths = session.stats().light.paths;
    EXPECT_GE(paths, kLargestPilot);
}

// Means of one square of the picture over many seeds.
constexpr uint32_t kPart = 10, kParts = kSide / kPart;
std::vector<test::MeanEstimate> parts_of(const RenderScene& world, RenderSettings settings,
                                         uint32_t seeds, uint32_t first_seed) {
    std::vector<test::MeanEstimate> parts(kParts * kParts);
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        settings.seed = first_seed + seed;
        const Rendered rendered = render(world, settings);
        std::vector<double> sum(parts.size());
        for (uint32_t y = 0; y < kSide; ++y)
            for (uint32_t x = 0; x < kSide; ++x)
                sum[y / kPart * kParts + x / kPart] +=
                    double(rendered.combined[4 * (size_t{y} * kSide + x)]) / (kPart * kPart);
        for (size_t i = 0; i < parts.size(); ++i) parts[i].add(sum[i]);
    }
    return parts;
}

void expect_same(const std::vector<test::MeanEstimate>& a, const std::vector<test::MeanEstimate>& b,
                 const char* what) {
    for (size_t i = 0; i < a.size(); ++i)
        EXPECT_TRUE(test::same_mean(a[i], b[i], test::sidak(1e-3, int(a.size()))))
            << what << ", part " << i;
}

// Path tracing finds a lamp of this size: what all others are compared with.
constexpr float kLargeLamp = 0.4f;

TEST(SessionWithLightPathsSlow, ShortAndLongRendersHaveOneMean) {
    const RenderScene world = scene_of(true, kLargeLamp);
    RenderSettings alone = settings_with(256);
    alone.light_tracing = false;
    alone.integrator.manifold.enabled = false;
    const auto expected = parts_of(world, alone, 10, 1000);
    RenderSettings first_round = settings_with(64);
    first_round.time_limit = 1e-6f;
    expect_same(parts_of(world, first_round, 56, 1), expected, "the first pass");
    // Long enough for probabilities of manifold estimates to fall below one.
    expect_same(parts_of(world, settings_with(32), 28, 300), expected, "with probabilities");
    RenderSettings manifold = settings_with(32);
    manifold.light_tracing = false;
    expect_same(parts_of(world, manifold, 28, 400), expected, "manifold with probabilities");
    // Sample ranges: [0, 8) and [8, 16) are pictures of one mean.
    RenderSettings later = settings_with(8);
    later.first_sample = 8;
    expect_same(parts_of(world, later, 36, 500), expected, "samples from the eighth on");
}

// ---- adaptive sampling

RenderSettings adaptive_settings(uint32_t samples, float threshold, uint32_t threads) {
    RenderSettings settings = settings_with(samples, threads);
    settings.integrator.manifold.enabled = settings.light_tracing = false;
    settings.noise_threshold = threshold;
    settings.min_samples = 8;
    return settings;
}
std::vector<float> counts_of(const RenderScene& world, const RenderSettings& settings) {
    Session session(world, settings);
    EXPECT_EQ(session.wait(60s).state, RenderState::done);
    std::vector<float> counts(size_t{kSide} * kSide);
    session.film().read(Pass::sample_count, counts);
    return counts;
}

TEST(AdaptiveSampling, EndsWhereTheErrorIsSmallAndDoesNotDependOnThreads) {
    const RenderScene world = scene_of(true);
    const auto counts = counts_of(world, adaptive_settings(64, 0.05f, 1));
    EXPECT_EQ(counts, counts_of(world, adaptive_settings(64, 0.05f, 3)));
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    EXPECT_GE(*least, 8.0f);
    EXPECT_LT(*least, 32.0f);
    EXPECT_EQ(*most, 64.0f);
    for (const float count : counts_of(world, adaptive_settings(64, 0.0f, 2)))
        ASSERT_EQ(count, 64.0f);
    RenderSettings part = adaptive_settings(64, 0.05f, 2);
    part.total_samples = 64;
    for (const float count : counts_of(world, part)) ASSERT_EQ(count, 64.0f);
}

TEST(AdaptiveSampling, ErrorIsTheDifferenceOfHalves) {
    PixelSums all;
    HalfSums half;
    all.count = 4;
    all.radiance = {8.0, 4.0, 0.4};   // means 2, 1, 0.1
    half.radiance = {6.0, 2.0, 0.2};  // means 3, 1, 0.1
    EXPECT_NEAR(relative_error(all, half), 1.0 / 3.1, 1e-4);
    all.radiance = {0.8, 0.16, 0.04};  // means 0.2, 0.04, 0.01: below 1, so over the root
    half.radiance = {0.2, 0.08, 0.02};
    EXPECT_NEAR(relative_error(all, half), 0.1 / (std::sqrt(0.25) + 1e-4), 1e-5);
}

// A picture without noise needs no more than the least, whatever the number of samples.
TEST(AdaptiveSampling, EndsTheRenderWhereAllPixelsEnd) {
    const RenderScene world = scene_of(false);
    RenderSettings settings = adaptive_settings(1u << 30, 1.0f, 2);
    for (const float count : counts_of(world, settings)) EXPECT_LT(count, 64.0f);
}

// ---- parts

TEST(Parts, AddUpToOneRenderToTheBit) {
    const RenderScene world = scene_of(true);
    RenderSettings settings = settings_with(24, 3);
    settings.integrator.manifold.finder = ChainFinder::sheets;
    settings.chooses = true;
    settings.total_samples = 24;
    settings.passes = PassSet((uint64_t{1} << kPasses) - 1);
    Session whole(world, settings);
    EXPECT_EQ(whole.wait(60s).state, RenderState::done);
    const Session::Export expected = whole.export_film();
    EXPECT_EQ(expected.samples, 24u);
    std::unique_ptr<Film> sum;
    for (const auto& [first, end] : {std::pair{0u, 5u}, {5u, 6u}, {6u, 24u}}) {
        settings.threads = end % 2 + 1;
        settings.first_sample = first;
        settings.samples = end - first;
        Session part(world, settings);
        EXPECT_EQ(part.wait(60s).state, RenderState::done);
        auto film = Film::from_bytes(part.export_film().sums);
        if (sum)
            sum->add(*film, false);
        else
            sum = std::move(film);
    }
    EXPECT_TRUE(sum->to_bytes() == expected.sums);
}

// Sums that are taken while a render goes on are those of whole samples, and do not disturb it.
TEST(Parts, ExportsOnTheWayAreWholeSamples) {
    const RenderScene world = scene_of(true);
    RenderSettings settings = settings_with(64, 3);
    settings.total_samples = 64;
    Session session(world, settings);
    std::vector<Session::Export> exports;
    for (int i = 0; i < 4; ++i) exports.push_back(session.export_film());
    EXPECT_EQ(session.wait(60s).state, RenderState::done);
    exports.push_back(session.export_film());
    EXPECT_EQ(exports.back().samples, 64u);
    for (const Session::Export& one : {exports[1], exports.back()}) {
        settings.samples = one.samples;
        Session same(world, settings);
        EXPECT_EQ(same.wait(60s).state, RenderState::done);
        EXPECT_TRUE(same.export_film().sums == one.sums) << one.samples;
    }
}

TEST(Session, APauseHoldsSamplesBackAndDoesNotShow) {
    const RenderScene world = scene_of(true);
    const RenderSettings settings = settings_with(16, 2);
    Session session(world, settings);
    session.pause(true);
    while (session.wait(1ms).stage != RenderStage::samples) {}
    const uint32_t before = session.wait(0ms).samples_done;  // the first may have begun
    EXPECT_EQ(session.wait(300ms).state, RenderState::running);
    EXPECT_LE(session.wait(0ms).samples_done, before + 1);
    const uint32_t held = session.wait(0ms).samples_done;
    EXPECT_EQ(session.wait(200ms).samples_done, held);
    session.pause(false);
    EXPECT_EQ(session.wait(60s).state, RenderState::done);
    Session other(world, settings);
    EXPECT_EQ(other.wait(60s).state, RenderState::done);
    EXPECT_TRUE(session.export_film().sums == other.export_film().sums);
}

TEST(Session, APauseDoesNotOutliveACancel) {
    const RenderScene world = scene_of(true);
    Session session(world, settings_with(1u << 20, 2));
    session.pause(true);
    session.cancel();
    EXPECT_EQ(session.wait(60s).state, RenderState::cancelled);
}

// A render that was cancelled within a sample has no sums to give; one that was not, whole ones.
TEST(Parts, CancelledRendersGiveWholeSamplesOrNone) {
    const RenderScene world = scene_of(true);
    Session session(world, settings_with(1u << 20, 2));
    const uint32_t before = session.export_film().samples;
    session.cancel();
    try {
        EXPECT_GE(session.export_film().samples, before);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::wrong_state);
    }
}

// ---- the probabilities themselves, by hand

// Half of the samples of each pixel are 0, the others 2 a: mean a, variance n / (n - 1) a^2.
std::vector<PixelSums> pixels_with(double a, uint32_t n, size_t count = 4) {
    PixelSums pixel;
    pixel.count = n;
    for (size_t c = 0; c < 3; ++c) {
        pixel.radiance[c] = n * a;
        pixel.radiance_squared[c] = n * 2.0 * a * a;
    }
    return std::vector<PixelSums>(count, pixel);
}
TileEvidence evidence_of(uint64_t samples, uint64_t rays, double second_moment, double cost) {
    TileEvidence evidence;
    evidence.samples = samples;
    evidence.rays = rays;
    evidence.manifold[0] = {second_moment, cost};
    return evidence;
}

TEST(Activation, IsAsBeforeWithoutEvidence) {
    const Activation before{0.5f, 1.0f, 0.25f, 0.75f, 1.0f, 0.3f};
    EXPECT_EQ(activation_for({}, pixels_with(1.0, 8), before), before);
    // Two samples of each pixel, then enough but in too few of them.
    EXPECT_EQ(activation_for(evidence_of(8, 100, 0.0, 1000.0), pixels_with(1.0, 2), before), before);
    std::vector<PixelSums> pixels = pixels_with(1.0, 16);
    pixels[2].count = 1;
    EXPECT_EQ(activation_for(evidence_of(49, 100, 0.0, 1000.0), pixels, before), before);
    pixels[2].count = 16;
    EXPECT_NE(activation_for(evidence_of(64, 100, 0.0, 1000.0), pixels, before), before);
}

TEST(Activation, IsOneWithoutVariance) {
    EXPECT_EQ(activation_for(evidence_of(64, 100, 0.0, 1000.0), pixels_with(0.0, 16),
                             Activation{0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}),
              kAlways);
}

TEST(Activation, IsLeastWhereTheManifoldGivesNothing) {
    const Activation probabilities =
        activation_for(evidence_of(64, 200, 0.0, 1000.0), pixels_with(1.0, 16), kAlways);
    Activation expected = kAlways;  // other estimates cost nothing
    expected[0] = 0.25f;
    EXPECT_EQ(probabilities, expected);
    TileEvidence rough = evidence_of(64, 200, 0.0, 0.0);
    rough.manifold[kReceiverDepths] = {0.0, 1000.0};
    EXPECT_EQ(activation_for(rough, pixels_with(1.0, 16), kAlways)[kReceiverDepths], 0.25f);
}

TEST(Activation, IsOneWhereTheManifoldIsTheNoise) {
    // All of the variance, at no more cost than that of the rest.
    const Activation probabilities = activation_for(evidence_of(64, 200, 64 * 16.0 / 15.0, 200.0),
                                                    pixels_with(1.0, 16), kAlways);
    EXPECT_EQ(probabilities[0], 1.0f);
}

// sqrt((V_m / C_m) / (V_r / C_r)).
TEST(Activation, BalancesVarianceAndCost) {
    const double variance = 16.0 / 15.0, moment = 0.4, rays = 2.0, cost = 10.0;
    const Activation probabilities = activation_for(
        evidence_of(64, uint64_t(64 * rays), 64 * moment, 64 * cost), pixels_with(1.0, 16), kAlways);
    EXPECT_NEAR(probabilities[0], std::sqrt(moment / cost / ((variance - moment) / rays)), 1e-5);
    EXPECT_GT(probabilities[0], 0.26f);
    EXPECT_LT(probabilities[0], 0.9f);
}

}  // namespace
}  // namespace spc
