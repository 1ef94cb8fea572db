// SPDX-License-Identifier: GPL-3.0-or-later
// What hosts with many threads do through the public interface. `./dev test tsan` runs it under the
// thread sanitizer, which finds the races that these tests themselves would notice only by chance.
#include "support/api_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

namespace spc::test {
namespace {

constexpr uint32_t kThreads = 16;
constexpr uint32_t kWidth = 48, kHeight = 32;

// Calls act(i) on a thread of its own for each i below kThreads.
template <class Act>
void on_all_threads(const Act& act) {
    std::vector<std::jthread> threads;
    for (uint32_t i = 0; i < kThreads; ++i) threads.emplace_back([&act, i] { act(i); });
}

// One host reads passes, counts, progress and the log while others do.
void look_at(spc_session* session, uint32_t host, uint32_t round) {
    for (const float value : read_pass(session, (host + round) % SPC_PASS_COUNT, kWidth, kHeight))
        EXPECT_TRUE(std::isfinite(value));
    auto stats = sized<spc_render_stats>();
    EXPECT_EQ(spc_render_get_stats(session, &stats), SPC_OK);
    const char* report = spc_render_report(session);
    ASSERT_NE(report, nullptr);
    const std::string text = report;
    EXPECT_LE(wait_for(session, 1).fraction, 1.0f);
    EXPECT_EQ(text, report);  // which others have asked for meanwhile
}

struct NamedMethod {
    const char* name;
    spc_method method;
};
class Threads : public testing::TestWithParam<NamedMethod> {};
INSTANTIATE_TEST_SUITE_P(Methods, Threads,
                         testing::Values(NamedMethod{"PathTracing", SPC_METHOD_PT},
                                         NamedMethod{"Walks", SPC_METHOD_SMS_UNBIASED},
                                         NamedMethod{"LightTracing", SPC_METHOD_LT},
                                         NamedMethod{"Sheets", SPC_METHOD_SHEETS},
                                         NamedMethod{"Mnee", SPC_METHOD_MNEE},
                                         NamedMethod{"Auto", SPC_METHOD_AUTO}),
                         [](const auto& info) { return info.param.name; });

TEST_P(Threads, RenderReadAndCancel) {
    constexpr uint32_t kLooks = 5;
    constexpr uint32_t kPause = 50;  // ms: hosts that only look keep the preparation from its end
    const ScenePtr scene = committed_scene(valid_camera(kWidth, kHeight));
    spc_render_settings settings = quick_settings(1u << 24);  // more than the test waits for
    settings.method = GetParam().method;
    settings.threads = kThreads;
    const SessionPtr session = start(scene.get(), settings);
    on_all_threads([&](uint32_t host) {
        for (uint32_t i = 0; i < kLooks; ++i) look_at(session.get(), host, i);
        while (wait_for(session.get(), kPause).samples_done == 0)
            look_at(session.get(), host, kLooks);
        EXPECT_EQ(spc_render_cancel(session.get()), SPC_OK);
        look_at(session.get(), host, 0);
    });
    EXPECT_EQ(wait_for(session.get()).state, uint32_t{SPC_RENDER_CANCELLED});
}

// Scenes of one series are built on threads of their own while the one before is rendered; some are
// cancelled, some destroyed meanwhile.
TEST(ScenesOnThreads, AreBuiltBesideRenders) {
    const ScenePtr before = edited(nullptr);
    add_resources(before.get());
    add_objects(before.get());
    ASSERT_EQ(spc_scene_commit(before.get(), 2), SPC_OK) << spc_last_error();
    const std::vector<float> wanted = render_all(before.get(), quick_settings());
    on_all_threads([&](uint32_t i) {
        const ScenePtr scene = edited(before.get());
        keep_resources(scene.get());
        add_objects(scene.get());
        ASSERT_EQ(spc_scene_commit_start(scene.get(), 2), SPC_OK) << spc_last_error();
        const std::vector<float> meanwhile = render_all(before.get(), quick_settings());
        EXPECT_TRUE(same_bits(meanwhile, wanted));
        if (i % 4 == 0) return;
        if (i % 4 == 1) {
            EXPECT_EQ(spc_scene_commit_cancel(scene.get()), SPC_OK) << spc_last_error();
        }
        const spc_status status = end_of_commit(scene.get());
        if (status == SPC_CANCELLED) return;
        ASSERT_EQ(status, SPC_OK) << spc_last_error();
        EXPECT_TRUE(same_bits(render_all(scene.get(), quick_settings()), wanted));
    });
}

// Some renders come to their end, others are destroyed wherever they stand.
TEST(ScenesOnThreads, AreRenderedSideBySide) {
    const ScenePtr scene = committed_scene();
    spc_render_settings settings = quick_settings();
    settings.method = SPC_METHOD_AUTO;
    on_all_threads([&](uint32_t i) {
        if (i % 2 == 0) {
            for (const float value : render_all(scene.get(), settings))
                EXPECT_TRUE(std::isfinite(value));
        } else {
            spc_render_settings endless = settings;
            endless.samples = 1u << 24;
            endless.threads = 2;
            const SessionPtr session = start(scene.get(), endless);
            std::this_thread::sleep_for(std::chrono::milliseconds(10 * i));
        }
    });
}

TEST(ScenesOnThreads, AreBuiltAndRefusedSideBySide) {
    on_all_threads([](uint32_t i) {
        const ScenePtr scene = new_scene();
        add_resources(scene.get());
        spc_light_desc light = valid_light(SPC_LIGHT_POINT);
        const std::string name = "Lantern " + std::to_string(i);
        light.name = name.c_str();
        light.radius = kNan;
        uint32_t index;
        expect_refused(spc_scene_add_light(scene.get(), &light, &index), SPC_INVALID_ARGUMENT,
                       {"\"" + name + "\""});
        add_objects(scene.get());
        EXPECT_EQ(spc_scene_commit(scene.get(), 1 + i % 4), SPC_OK) << spc_last_error();
        EXPECT_FALSE(render_all(scene.get(), quick_settings()).empty());
    });
}

}  // namespace
}  // namespace spc::test
