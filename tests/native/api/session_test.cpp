// SPDX-License-Identifier: GPL-3.0-or-later
// Renders under way through the public interface: misuse, progress, cancelling, and the promise
// that an image is a function of scene, seed and sample indices alone.
#include "support/api_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>

namespace spc::test {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// A floor beneath a mirror of random corner normals: walks rarely find the same solution twice, so
// nearly every estimate runs into the cap of its trials.
ScenePtr hard_scene(uint32_t width = 64, uint32_t height = 64) {
    ScenePtr scene = new_scene();
    add_resources(scene.get());
    constexpr uint32_t kSide = 64;
    std::mt19937 engine(3);
    std::vector<float> positions, normals;
    std::vector<uint32_t> triangles;
    const auto lean = [&] { return static_cast<float>(engine() >> 8) * 0x1p-24f * 0.6f - 0.3f; };
    for (uint32_t j = 0; j <= kSide; ++j)
        for (uint32_t i = 0; i <= kSide; ++i)
            for (const float x : {0.0f, float(i) / 16.0f - 2.0f, float(j) / 16.0f})
                positions.push_back(x);
    std::vector<float> leans((kSide + 1) * (kSide + 1) * 2);
    for (float& value : leans) value = lean();
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        for (const uint32_t k : {a, b, c}) {
            triangles.push_back(k);
            for (const float x : {1.0f, leans[2 * k], leans[2 * k + 1]}) normals.push_back(x);
        }
    };
    for (uint32_t j = 0; j < kSide; ++j)
        for (uint32_t i = 0; i < kSide; ++i) {
            const uint32_t a = j * (kSide + 1) + i;
            add(a, a + 1, a + kSide + 2);
            add(a, a + kSide + 2, a + kSide + 1);
        }
    auto mesh = sized<spc_mesh_desc>();
    mesh.name = "Crumpled foil";
    mesh.positions = positions.data();
    mesh.vertex_count = static_cast<uint32_t>(positions.size() / 3);
    mesh.triangles = triangles.data();
    mesh.triangle_count = static_cast<uint32_t>(triangles.size() / 3);
    mesh.normals = normals.data();
    mesh.slot_count = 1;
    uint32_t index;
    EXPECT_EQ(spc_scene_add_mesh(scene.get(), &mesh, &index), SPC_OK) << spc_last_error();
    const uint32_t plaster = 0, silver = 1;
    const spc_instance_desc floor = valid_instance(0, plaster);
    EXPECT_EQ(spc_scene_add_instance(scene.get(), &floor, &index), SPC_OK);
    spc_instance_desc foil = valid_instance(1, silver);
    foil.transform[3] = -1.0f;
    EXPECT_EQ(spc_scene_add_instance(scene.get(), &foil, &index), SPC_OK);
    const spc_light_desc light = valid_light(SPC_LIGHT_POINT);
    EXPECT_EQ(spc_scene_add_light(scene.get(), &light, &index), SPC_OK);
    const spc_camera_desc camera = valid_camera(width, height);
    EXPECT_EQ(spc_scene_set_camera(scene.get(), &camera), SPC_OK);
    EXPECT_EQ(spc_scene_commit(scene.get(), 1), SPC_OK) << spc_last_error();
    return scene;
}

// More samples than any test waits for.
spc_render_settings endless(uint32_t threads) {
    spc_render_settings settings = quick_settings(1u << 24);
    settings.threads = threads;
    return settings;
}

// ---- misuse

TEST(RenderMisuse, Settings) {
    const ScenePtr scene = committed_scene();
    const auto refuses = [&](const std::string& word, auto spoil) {
        spc_render_settings settings = quick_settings();
        spoil(settings);
        spc_session* session = nullptr;
        expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_INVALID_ARGUMENT,
                       {word});
        EXPECT_EQ(session, nullptr);
        spc_session_destroy(session);
    };
    const spc_render_settings good = quick_settings();
    spc_session* session = nullptr;
    expect_refused(spc_render_start(nullptr, &good, &session), SPC_INVALID_ARGUMENT, {"scene"});
    expect_refused(spc_render_start(scene.get(), nullptr, &session), SPC_INVALID_ARGUMENT,
                   {"settings"});
    expect_refused(spc_render_start(scene.get(), &good, nullptr), SPC_INVALID_ARGUMENT, {"session"});
    for (const size_t size : {size_t{0}, sizeof(spc_render_settings) - 4})
        refuses("struct_size", [&](auto& s) { s.struct_size = size; });
    refuses("method", [](auto& s) { s.method = SPC_METHOD_AUTO + 1; });
    refuses("light tracing", [](auto& s) { s.light_tracing = 3; });
    // Whatever the method.
    refuses("light tracing",
            [](auto& s) { s.method = SPC_METHOD_PT, s.light_tracing = 0xffffffff; });
    refuses("constraint", [](auto& s) { s.constraint = 2; });
    refuses("chain_family", [](auto& s) { s.chain_family = "RX"; });
    refuses("chain_family", [](auto& s) { s.chain_family = "TTTTTTT"; });
    refuses("glint method", [](auto& s) { s.glint_method = SPC_GLINT_METHOD_YAN + 1; });
    refuses("filter", [](auto& s) { s.pixel_filter = 3; });
    refuses("samples", [](auto& s) { s.samples = 0; });
    refuses("samples", [](auto& s) { s.first_sample = 0xffffffff, s.samples = 1; });
    refuses("samples", [](auto& s) { s.first_sample = 0x80000000, s.samples = 0x80000000; });
    refuses("set_size", [](auto& s) { s.set_size = 0; });
    refuses("set_size", [](auto& s) { s.method = SPC_METHOD_SMS_BIASED, s.set_size = 0xffffffff; });
    refuses("threads", [](auto& s) { s.threads = 0xffffffff; });
    for (const float bad : {kNan, kInf, -1.0f})
        refuses("time_limit", [&](auto& s) { s.time_limit = bad; });
    for (const float bad : {kNan, kInf, -1.0f, 0.0f, 1e30f})
        refuses("filter_width", [&](auto& s) { s.filter_width = bad; });

    // The box has no width to be wrong.
    spc_render_settings box = quick_settings();
    box.pixel_filter = SPC_FILTER_BOX;
    box.filter_width = kNan;
    EXPECT_FALSE(render_all(scene.get(), box).empty());
}

TEST(RenderMisuse, Sessions) {
    auto progress = sized<spc_render_progress>();
    auto stats = sized<spc_render_stats>();
    float buffer[12 * 8 * 4];
    expect_refused(spc_render_wait(nullptr, 0, &progress), SPC_INVALID_ARGUMENT, {"session"});
    expect_refused(spc_render_cancel(nullptr), SPC_INVALID_ARGUMENT, {"session"});
    expect_refused(spc_render_pause(nullptr, 1), SPC_INVALID_ARGUMENT, {"session"});
    expect_refused(spc_render_get_stats(nullptr, &stats), SPC_INVALID_ARGUMENT, {"session"});
    expect_refused(spc_film_read(nullptr, 0, buffer, 1), SPC_INVALID_ARGUMENT, {"session"});

    const ScenePtr scene = committed_scene();
    const SessionPtr session = start(scene.get(), quick_settings());
    progress.struct_size = 1;
    expect_refused(spc_render_wait(session.get(), 0, &progress), SPC_INVALID_ARGUMENT,
                   {"struct_size"});
    EXPECT_EQ(spc_render_wait(session.get(), 60000, nullptr), SPC_OK);
    expect_refused(spc_render_get_stats(session.get(), nullptr), SPC_INVALID_ARGUMENT, {"stats"});
    stats.struct_size = 1;
    expect_refused(spc_render_get_stats(session.get(), &stats), SPC_INVALID_ARGUMENT,
                   {"struct_size"});
    for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) {
        const size_t count = size_t{12} * 8 * spc_pass_channels(pass);
        expect_refused(spc_film_read(session.get(), pass, nullptr, count), SPC_INVALID_ARGUMENT,
                       {"buffer"});
        for (const size_t wrong : {size_t{0}, count - 1, count + 1, ~size_t{0}})
            expect_refused(spc_film_read(session.get(), pass, buffer, wrong), SPC_INVALID_ARGUMENT,
                           {"floats"});
        EXPECT_EQ(spc_film_read(session.get(), pass, buffer, count), SPC_OK);
    }
    for (const uint32_t unknown : {uint32_t{SPC_PASS_COUNT}, 0xffffffffu}) {
        EXPECT_EQ(spc_pass_channels(unknown), 0u);
        expect_refused(spc_film_read(session.get(), unknown, buffer, 0), SPC_INVALID_ARGUMENT,
                       {"pass"});
    }
}

TEST(RenderMisuse, FrameBeyondAllMemoryIsRefused) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer ends the program where memory is refused";
#endif
    spc_camera_desc camera = valid_camera(0xffffffff, 0xffffffff);
    const ScenePtr scene = committed_scene(camera);
    const spc_render_settings settings = quick_settings();
    spc_session* session = nullptr;
    expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_OUT_OF_MEMORY,
                   {"film", "4294967295 x 4294967295", "out of memory"});
    EXPECT_EQ(session, nullptr);
}

TEST(RenderMisuse, MostSamplesThatCanBeAskedFor) {
    const ScenePtr scene = committed_scene();
    const Clock::time_point begin = Clock::now();
    const SessionPtr session = start(scene.get(), quick_settings(0xffffffff));
    const spc_render_progress progress = wait_for(session.get(), 50);
    EXPECT_EQ(progress.state, static_cast<uint32_t>(SPC_RENDER_RUNNING));
    EXPECT_EQ(spc_render_cancel(session.get()), SPC_OK);
    EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_CANCELLED));
    EXPECT_LT(seconds_since(begin), 1.0) << "numbers that nobody renders cost time";
}

// ---- progress and ends

TEST(Session, ProgressRunsFromNothingToDone) {
    const ScenePtr scene = committed_scene(valid_camera(48, 32));
    spc_render_settings settings = quick_settings(40);
    settings.threads = 2;
    const SessionPtr session = start(scene.get(), settings);
    spc_render_progress last = sized<spc_render_progress>(), now;
    do {
        now = wait_for(session.get(), 3);
        EXPECT_GE(now.fraction, last.fraction);
        EXPECT_GE(now.samples_done, last.samples_done);
        EXPECT_LE(now.fraction, 1.0f);
        EXPECT_GE(now.seconds, last.seconds);
        EXPECT_EQ(now.struct_size, sizeof(now));
        last = now;
    } while (now.state == SPC_RENDER_RUNNING);
    EXPECT_EQ(now.state, static_cast<uint32_t>(SPC_RENDER_DONE));
    EXPECT_EQ(now.samples_done, 40u);
    EXPECT_EQ(now.fraction, 1.0f);
    auto stats = sized<spc_render_stats>();
    ASSERT_EQ(spc_render_get_stats(session.get(), &stats), SPC_OK);
    EXPECT_EQ(stats.samples, 48u * 32 * 40);
    EXPECT_GT(stats.rays, stats.samples);
    EXPECT_GT(stats.estimates, 0u);
    EXPECT_GE(stats.walks, stats.estimates);
    EXPECT_GE(stats.walks, stats.walks_converged);
    EXPECT_GE(stats.trials, stats.trial_estimates);
    EXPECT_EQ(stats.nan_samples, 0u);
    // Cancelling what is done changes nothing.
    EXPECT_EQ(spc_render_cancel(session.get()), SPC_OK);
    EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE));
}

TEST(Session, CancelReturnsSoonAndKeepsSamples) {
    const ScenePtr scene = committed_scene(valid_camera(64, 64));
    const SessionPtr session = start(scene.get(), endless(2));
    spc_render_progress now;
    do now = wait_for(session.get(), 5);
    while (now.samples_done == 0 && now.state == SPC_RENDER_RUNNING);
    const Clock::time_point asked = Clock::now();
    EXPECT_EQ(spc_render_cancel(session.get()), SPC_OK);
    now = wait_for(session.get());
    EXPECT_LT(seconds_since(asked), 1.0);
    EXPECT_EQ(now.state, static_cast<uint32_t>(SPC_RENDER_CANCELLED));
    EXPECT_GE(now.samples_done, 1u);
    const std::vector<float> combined = read_pass(session.get(), SPC_PASS_COMBINED, 64, 64);
    for (size_t i = 3; i < combined.size(); i += 4)
        ASSERT_EQ(combined[i], 1.0f) << "pixel " << i / 4;
    EXPECT_EQ(read_pass(session.get(), SPC_PASS_COMBINED, 64, 64), combined)
        << "still being written to";
}

TEST(Session, CancelReturnsSoonAmidHeavyTrials) {
    const ScenePtr scene = hard_scene();
    for (const uint32_t method : {SPC_METHOD_SMS_UNBIASED, SPC_METHOD_SMS_BIASED}) {
        spc_render_settings settings = endless(2);
        settings.method = method;
        settings.set_size = 4096;
        settings.light_tracing = SPC_LIGHT_TRACING_OFF;
        const SessionPtr session = start(scene.get(), settings);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        const Clock::time_point asked = Clock::now();
        EXPECT_EQ(spc_render_cancel(session.get()), SPC_OK);
        EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_CANCELLED));
        EXPECT_LT(seconds_since(asked), 1.0);
        auto stats = sized<spc_render_stats>();
        ASSERT_EQ(spc_render_get_stats(session.get(), &stats), SPC_OK);
        EXPECT_GT(stats.walks, 1000u) << "the scene is not hard";
        EXPECT_EQ(stats.nan_samples, 0u);
    }
}

TEST(Session, DestroyedWhileRunning) {
    const ScenePtr scene = committed_scene(valid_camera(64, 64));
    for (int i = 0; i < 10; ++i) {
        const SessionPtr session = start(scene.get(), endless(3));
        std::this_thread::sleep_for(std::chrono::milliseconds(i));
    }
}

TEST(Session, TimeLimitIsAnEnd) {
    const ScenePtr scene = committed_scene(valid_camera(40, 40));
    for (const float limit : {1e-6f, 0.15f}) {
        spc_render_settings settings = endless(5);
        settings.time_limit = limit;
        // Its pilot takes a time of its own.
        settings.light_tracing = SPC_LIGHT_TRACING_OFF;
        const SessionPtr session = start(scene.get(), settings);
        const spc_render_progress end = wait_for(session.get());
        EXPECT_EQ(end.state, static_cast<uint32_t>(SPC_RENDER_DONE));
        EXPECT_EQ(end.fraction, 1.0f);
        EXPECT_LT(end.seconds, 2.0);
        const std::vector<float> combined = read_pass(session.get(), SPC_PASS_COMBINED, 40, 40);
        for (size_t i = 3; i < combined.size(); i += 4)
            ASSERT_EQ(combined[i], 1.0f) << "pixel " << i / 4;
    }
}

// With many threads the first to finish its tile sees the time run out while others work on their
// first samples. What has none by then shows the preview.
TEST(Session, TheShortestTimeLeavesNoPixelEmpty) {
    const ScenePtr scene = hard_scene(32, 32);
    for (int i = 0; i < 5; ++i) {
        spc_render_settings settings = endless(5);
        settings.time_limit = 1e-6f;
        const SessionPtr session = start(scene.get(), settings);
        EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE));
        const std::vector<float> combined = read_pass(session.get(), SPC_PASS_COMBINED, 32, 32);
        for (size_t k = 3; k < combined.size(); k += 4)
            ASSERT_EQ(combined[k], 1.0f) << "pixel " << k / 4;
    }
}

// ---- the image is a function of scene, seed and samples

TEST(Determinism, AnyNumberOfThreads) {
    const ScenePtr scene = committed_scene(valid_camera(37, 29));
    spc_render_settings settings = quick_settings(5);
    const std::vector<float> one = render_all(scene.get(), settings, 37, 29);
    for (const uint32_t threads : {2u, 3u, 7u}) {
        settings.threads = threads;
        EXPECT_TRUE(same_bits(render_all(scene.get(), settings, 37, 29), one))
            << threads << " threads";
    }
    settings.seed = 1;
    EXPECT_FALSE(same_bits(render_all(scene.get(), settings, 37, 29), one))
        << "the seed does nothing";
}

TEST(Determinism, TwoSessionsOnOneScene) {
    const ScenePtr scene = committed_scene(valid_camera(37, 29));
    spc_render_settings a = quick_settings(6), b = quick_settings(6);
    a.threads = b.threads = 2;
    b.method = SPC_METHOD_PT;
    b.seed = 9;
    const std::vector<float> alone_a = render_all(scene.get(), a, 37, 29),
                             alone_b = render_all(scene.get(), b, 37, 29);
    std::vector<float> together_b;
    std::thread other([&] { together_b = render_all(scene.get(), b, 37, 29); });
    const std::vector<float> together_a = render_all(scene.get(), a, 37, 29);
    other.join();
    EXPECT_TRUE(same_bits(together_a, alone_a));
    EXPECT_TRUE(same_bits(together_b, alone_b));
}

// A committed scene that is looked at from elsewhere is that scene with another camera.
TEST(Determinism, MovedCameraIsAnotherScenes) {
    spc_render_settings settings = quick_settings(4);
    settings.method = SPC_METHOD_AUTO;
    spc_camera_desc moved = valid_camera(20, 15);
    moved.transform[3] = 0.3f;
    moved.transform[11] = 3.0f;
    const std::vector<float> wanted = render_all(committed_scene(moved).get(), settings, 20, 15);
    const ScenePtr scene = committed_scene();
    const std::vector<float> before = render_all(scene.get(), settings);
    {
        const SessionPtr session = start(scene.get(), settings);
        expect_refused(spc_scene_set_camera(scene.get(), &moved), SPC_WRONG_STATE,
                       {"being rendered"});
    }
    ASSERT_EQ(spc_scene_set_camera(scene.get(), &moved), SPC_OK) << spc_last_error();
    EXPECT_TRUE(same_bits(render_all(scene.get(), settings, 20, 15), wanted));
    spc_camera_desc bad = moved;
    bad.clip_far = 0.0f;
    expect_refused(spc_scene_set_camera(scene.get(), &bad), SPC_INVALID_ARGUMENT, {"clipping"});
    EXPECT_TRUE(same_bits(render_all(scene.get(), settings, 20, 15), wanted));
    const spc_camera_desc back = valid_camera();
    ASSERT_EQ(spc_scene_set_camera(scene.get(), &back), SPC_OK);
    EXPECT_TRUE(same_bits(render_all(scene.get(), settings), before));
}

TEST(Determinism, CropIsAWindow) {
    constexpr uint32_t kWidth = 40, kHeight = 24;
    // Light paths and the probabilities of manifold estimates follow what is seen of the picture.
    spc_render_settings settings = quick_settings();
    settings.method = SPC_METHOD_PT;
    spc_camera_desc camera = valid_camera(kWidth, kHeight);
    camera.aperture_radius = 0.2f;
    camera.focus_distance = 3.0f;
    camera.aperture_ratio = 1.0f;
    const std::vector<float> full =
        render_all(committed_scene(camera).get(), settings, kWidth, kHeight);
    const uint32_t crop[4] = {5, 3, 21, 18};
    std::copy(crop, crop + 4, camera.crop);
    const std::vector<float> part =
        render_all(committed_scene(camera).get(), settings, crop[2], crop[3]);
    size_t full_begin = 0, part_at = 0;
    for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) {
        const size_t channels = spc_pass_channels(pass);
        for (uint32_t y = 0; y < crop[3]; ++y)
            for (uint32_t x = 0; x < crop[2]; ++x)
                for (size_t c = 0; c < channels; ++c, ++part_at)
                    ASSERT_EQ(
                        part[part_at],
                        full[full_begin + ((crop[1] + y) * kWidth + crop[0] + x) * channels + c])
                        << "pass " << pass << " at " << x << ", " << y;
        full_begin += channels * kWidth * kHeight;
    }
}

// A mesh that a second, invisible instance shares is traced in object space instead of world space.
TEST(Determinism, InstancingDoesNotShow) {
    const auto image = [](bool shared) {
        const ScenePtr scene = new_scene();
        add_resources(scene.get());
        uint32_t index;
        spc_mesh_desc mesh = valid_mesh();
        EXPECT_EQ(spc_scene_add_mesh(scene.get(), &mesh, &index), SPC_OK);  // 1: the wall's own
        const uint32_t plaster = 0, silver = 1;
        spc_instance_desc floor = valid_instance(0, plaster), wall = valid_instance(1, silver);
        const float upright[12] = {0,    0, 0.7f,  -1, 0, -0.4f,
                                   0.1f, 0, -0.4f, 0,  0, 0.8f};  // mirrored, uneven
        std::copy(upright, upright + 12, wall.transform);
        for (const spc_instance_desc& desc : {floor, wall})
            EXPECT_EQ(spc_scene_add_instance(scene.get(), &desc, &index), SPC_OK);
        floor.visibility = wall.visibility = 0;
        floor.caustics_role = wall.caustics_role = SPC_CAUSTICS_OFF;
        for (const spc_instance_desc& desc : {floor, wall})
            if (shared) {
                EXPECT_EQ(spc_scene_add_instance(scene.get(), &desc, &index), SPC_OK);
            }
        const spc_light_desc light = valid_light(SPC_LIGHT_POINT);
        EXPECT_EQ(spc_scene_add_light(scene.get(), &light, &index), SPC_OK);
        const spc_camera_desc camera = valid_camera(24, 24);
        EXPECT_EQ(spc_scene_set_camera(scene.get(), &camera), SPC_OK);
        EXPECT_EQ(spc_scene_commit(scene.get(), 1), SPC_OK) << spc_last_error();
        const SessionPtr session = start(scene.get(), quick_settings(8));
        wait_for(session.get());
        const std::vector<float> caustics = read_pass(session.get(), SPC_PASS_CAUSTICS, 24, 24);
        EXPECT_GT(*std::max_element(caustics.begin(), caustics.end()), 0.0f);
        return read_pass(session.get(), SPC_PASS_COMBINED, 24, 24);
    };
    const std::vector<float> single = image(false), shared = image(true);
    int different = 0;  // a walk may take another turn by the last bit
    double sum_single = 0, sum_shared = 0;
    for (size_t i = 0; i < single.size(); ++i) {
        different += std::abs(single[i] - shared[i]) > 1e-3f * (1.0f + std::abs(single[i])) ? 1 : 0;
        sum_single += static_cast<double>(single[i]);
        sum_shared += static_cast<double>(shared[i]);
    }
    EXPECT_LT(different, int(single.size() / 20));
    EXPECT_NEAR(sum_shared, sum_single, 0.01 * sum_single);
}

TEST(Determinism, HalvesAddUp) {
    const ScenePtr scene = committed_scene(valid_camera(20, 20));
    const auto mean_of = [&](uint32_t first, uint32_t count, uint32_t pass,
                             uint32_t method = SPC_METHOD_PT) {
        spc_render_settings settings = quick_settings(count);
        settings.method = method;
        settings.first_sample = first;
        const SessionPtr session = start(scene.get(), settings);
        wait_for(session.get());
        return read_pass(session.get(), pass, 20, 20);
    };
    for (const uint32_t pass : {SPC_PASS_COMBINED, SPC_PASS_NORMAL}) {
        const std::vector<float> all = mean_of(0, 16, pass), low = mean_of(0, 8, pass),
                                 high = mean_of(8, 8, pass);
        EXPECT_NE(low, high);
        double energy = 0;
        for (size_t i = 0; i < all.size(); ++i) {
            ASSERT_NEAR(all[i], 0.5f * (low[i] + high[i]), 1e-5f * (1.0f + std::abs(all[i])))
                << "pass " << pass << ", float " << i;
            energy += std::abs(static_cast<double>(all[i]));
        }
        EXPECT_GT(energy, 0.0) << "pass " << pass << " is empty";
    }
    // The probabilities of manifold estimates follow the samples before: halves and whole are then
    // different pictures of one mean. Light paths alone are a sum over their indices.
    for (const uint32_t method : {SPC_METHOD_SMS_UNBIASED, SPC_METHOD_LT}) {
        const auto all = mean_of(0, 16, SPC_PASS_COMBINED, method),
                   low = mean_of(0, 8, SPC_PASS_COMBINED, method),
                   high = mean_of(8, 8, SPC_PASS_COMBINED, method),
                   variance = mean_of(0, 16, SPC_PASS_VARIANCE, method);
        double difference = 0, noise = 0;
        for (size_t i = 0; i < all.size() / 4; ++i) {
            const double d =
                static_cast<double>(all[4 * i]) -
                0.5 * (static_cast<double>(low[4 * i]) + static_cast<double>(high[4 * i]));
            difference += d;
            noise += static_cast<double>(variance[3 * i]);
            if (method == SPC_METHOD_LT) {
                ASSERT_NEAR(d, 0.0, 1e-4 * (1.0 + static_cast<double>(all[4 * i]))) << i;
            }
        }
        EXPECT_GT(noise, 0.0);
        EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(noise)) << "method " << method;
    }
    // Position and depth are those of the first sample asked for.
    EXPECT_EQ(mean_of(8, 1, SPC_PASS_POSITION), mean_of(8, 8, SPC_PASS_POSITION));
    EXPECT_NE(mean_of(0, 1, SPC_PASS_POSITION), mean_of(8, 8, SPC_PASS_POSITION));
    // The last indices there are.
    EXPECT_EQ(mean_of(0xfffffff0, 15, SPC_PASS_COMBINED).size(), 20u * 20 * 4);
}

TEST(Settings, DefaultsAreValidAndComplete) {
    spc_render_settings settings;
    std::memset(&settings, 0xff, sizeof(settings));
    spc_render_settings_init(&settings);
    EXPECT_EQ(settings.struct_size, sizeof(settings));
    EXPECT_EQ(settings.method, static_cast<uint32_t>(SPC_METHOD_AUTO));
    EXPECT_EQ(settings.light_tracing, static_cast<uint32_t>(SPC_LIGHT_TRACING_AUTO));
    EXPECT_EQ(settings.first_sample, 0u);
    EXPECT_EQ(settings.time_limit, 0.0f);
    EXPECT_EQ(settings.max_bounces, 12u);
    EXPECT_EQ(settings.transparent_film, 0u);
    EXPECT_EQ(settings.passes, 0u);
    const ScenePtr scene = committed_scene();
    settings.samples = 1;
    settings.passes = quick_settings().passes;
    EXPECT_FALSE(render_all(scene.get(), settings).empty());
}

}  // namespace
}  // namespace spc::test
