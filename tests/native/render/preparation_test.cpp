// SPDX-License-Identifier: GPL-3.0-or-later
// What comes before a render's first sample: its stages, their budgets, and which casters are
// searched.
#include "render/session_settings.h"

#include "manifold/crowding.h"
#include "support/casters.h"
#include "support/glints.h"
#include "support/truths.h"

#include <gtest/gtest.h>

#include <numeric>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

constexpr uint32_t kSide = 32, kSeed = 3;

// A floor that the camera looks down at beside a standing mirror, 1 m wide, with the map over it
// once, under a sun. The map has slopes of 0.1 in waves of `wave` m.
RenderScene beside_a_mirror(double wave, float sun_angle = 0.05f) {
    constexpr float kHalf = 0.5f;
    constexpr uint32_t kTexels = 512;
    SceneMaker maker;
    Camera camera;
    camera.to_world = test::translation({0.0f, -0.6f, 3.0f});
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    camera.viewplane = {-0.2f, 0.2f, -0.2f, 0.2f};
    maker.builder.set_camera(camera);
    maker.builder.add_image(test::plane_normals(kTexels, wave, 0.1, 5));
    maker.add(test::square(4.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.add(test::with_uvs(test::square(kHalf), 1), test::normal_mapped(test::mirror(), {1, 1}),
              test::rotation_x(0.5f * kPi, {0.0f, 0.4f, kHalf}), CausticsRole::caster);
    maker.builder.add_light(test::sun_towards({0.1f, -1.0f, 1.2f}, sun_angle, 3.0f));
    return maker.finish();
}

RenderSettings settings_with(uint32_t samples) {
    return test::automatic_settings(samples, 4, kSeed);
}

TEST(Preparation, GoesThroughItsStages) {
    const RenderScene world = beside_a_mirror(0.2);
    Session session(world, settings_with(4));
    RenderStage last = RenderStage::maps;
    float fraction = 0.0f;
    for (;;) {
        const RenderProgress now = session.wait(0ms);
        EXPECT_GE(now.stage, last);
        // Also where a stage has several parts, as probes have, or begins anew.
        EXPECT_GE(now.stage_fraction, now.stage == last ? fraction : 0.0f);
        EXPECT_LE(now.stage_fraction, 1.0f);
        last = now.stage;
        fraction = now.stage_fraction;
        if (now.state != RenderState::running) break;
    }
    EXPECT_EQ(last, RenderStage::samples);
    const RenderProgress end = session.wait(0ms);
    const RenderStats stats = session.stats();
    const double all = std::accumulate(stats.stage_seconds.begin(), stats.stage_seconds.end(), 0.0);
    EXPECT_GT(stats.stage_seconds[static_cast<size_t>(RenderStage::light_paths)], 0.0);
    EXPECT_NEAR(all, end.seconds, 1e-9);
    EXPECT_LT(all - stats.stage_seconds[static_cast<size_t>(RenderStage::samples)],
              stats.first_sample_seconds);
    EXPECT_LE(stats.first_sample_seconds, end.seconds);
}

// The picture that stands for what is not there yet is all of it.
TEST(Preparation, ShowsAPreviewMeanwhile) {
    const RenderScene world = beside_a_mirror(0.2);
    RenderSettings settings = settings_with(1);
    settings.samples = 1u << 20;
    Session session(world, settings);
    std::vector<float> combined(size_t{4} * kSide * kSide, 0.0f);
    bool seen = false;
    while (session.stats().first_sample_seconds == 0.0) {
        session.film().read(Pass::combined, combined);
        seen = true;
        for (size_t i = 3; i < combined.size(); i += 4) seen = seen && combined[i] == 1.0f;
        if (seen) break;
    }
    EXPECT_TRUE(seen);
    session.cancel();
    EXPECT_NE(session.wait(10s).state, RenderState::running);
}

TEST(Preparation, EndsWhereItsBudgetIsSpent) {
    const RenderScene world = beside_a_mirror(0.2);
    const RenderSettings settings = settings_with(4);
    const std::atomic<bool> running{false}, cancelled{true};
    constexpr double kForever = 1e6;
    const auto sheets = [&](const Budget& budget) {
        uint64_t rays = 0;
        for (const auto& sheet : build_sheets(*world.scene, world.lights, world.casters,
                                              settings.integrator.manifold, kSeed, 256, 1, budget))
            rays += sheet->rays();
        return rays;
    };
    const uint64_t all = sheets(Budget());
    EXPECT_LT(sheets(Budget(0.25 * static_cast<double>(all), kForever, running)), all / 2);
    const auto pilot = [&](const Budget& budget, LightPathStats& stats) {
        return learn_emission(world, settings.integrator, {}, 0.0f, kLeastPilotPaths, kSeed, 1,
                              budget, stats) != nullptr;
    };
    LightPathStats whole, part, none;
    EXPECT_TRUE(pilot(Budget(), whole));
    EXPECT_TRUE(pilot(Budget(0.25 * static_cast<double>(whole.rays), kForever, running), part));
    EXPECT_LT(part.rays, whole.rays / 2 + (1u << 16));
    EXPECT_FALSE(pilot(Budget(1e9, kForever, cancelled), none));
}

// Two ways to count that have nothing in common: slopes and distances, and the overlap of beams.
TEST(CrowdingSlow, MapsMakeAsManyChainsAsSheetsHaveSeeds) {
    for (const double wave : {0.25, 0.12, 0.06}) {
        const RenderScene world = beside_a_mirror(wave);
        const double by_map =
            chains_by_maps(*world.scene, world.lights, world.casters, kSeed).front();
        const SheetPool sheets = build_sheets(*world.scene, world.lights, world.casters,
                                              settings_with(1).integrator.manifold, kSeed, 1024, 2);
        const double by_sheets = chains_by_sheets(world.casters, sheets, kSeed).front();
        EXPECT_GT(by_sheets, 1.0) << wave;
        EXPECT_LT(by_map, 2.5 * by_sheets) << wave;
        EXPECT_GT(by_map, by_sheets / 2.5) << wave;
    }
}

TEST(Crowding, OnlyFineMapsAreLeftToOthers) {
    for (const double wave : {0.2, 0.015}) {
        const RenderScene world = beside_a_mirror(wave);
        Session session(world, settings_with(2));
        EXPECT_EQ(session.wait(60s).state, RenderState::done);
        const std::vector<std::string> report = session.report();
        const bool left = std::any_of(report.begin(), report.end(), [](const std::string& line) {
            return line.find("chains at once by its map, more than") != std::string::npos;
        });
        EXPECT_EQ(left, wave < 0.1) << wave;
        // Sheets lead to what they are made of; nothing else is left to lead to here.
        const auto sheets = static_cast<size_t>(RenderStage::sheets);
        EXPECT_EQ(session.stats().path.manifold.estimates == 0, left) << wave;
        EXPECT_GT(session.stats().stage_seconds[sheets], 0.0);
    }
}

// A sun without extent is found by the manifold and light paths alone, and light paths do not come
// to what is seen in mirrors: nothing may be left out.
TEST(Crowding, NothingIsLeftOutThatRaysDoNotFind) {
    for (const double wave : {0.2, 0.015}) {
        const RenderScene world = beside_a_mirror(wave, 0.0f);
        RenderSettings settings = settings_with(1);
        settings.time_limit = 2.0f;  // its preparation decides, its samples take long
        Session session(world, settings);
        EXPECT_EQ(session.wait(60s).stage, RenderStage::samples);
        EXPECT_TRUE(session.report().empty()) << session.report().front();
    }
}

// What the manifold leaves out, on crowded casters or where light paths are dense, they and path
// tracing find: the mean of the picture is that of path tracing, and a hundredth more would be
// noticed.
TEST(CrowdingSlow, WhatIsLeftOutIsFound) {
    constexpr uint32_t kSeeds = 16;
    struct Case {
        double wave;
        const char* told;
    };
    for (const auto& [wave, told] : {Case{0.015, "by its map, more than 64: left to light paths"},
                                     Case{0.2, "come to them: left to light paths"}}) {
        const RenderScene world = beside_a_mirror(wave, 0.4f);  // a sun that path tracing finds
        bool left = false;
        const auto mean_of = [&](RenderSettings settings, uint32_t seeds) {
            test::MeanEstimate mean;
            for (settings.seed = 100; settings.seed < 100 + seeds; ++settings.seed) {
                Session session(world, settings);
                EXPECT_EQ(session.wait(120s).state, RenderState::done);
                std::vector<float> combined(size_t{4} * kSide * kSide);
                session.film().read(Pass::combined, combined);
                double sum = 0.0;
                for (size_t i = 0; i < combined.size(); i += 4)
                    sum += static_cast<double>(combined[i]);
                mean.add(sum / (kSide * kSide));
                for (const std::string& line : session.report())
                    left = left || line.find(told) != std::string::npos;
            }
            return mean;
        };
        RenderSettings path_tracing = settings_with(512);
        path_tracing.integrator.manifold.enabled = path_tracing.light_tracing = false;
        const test::MeanEstimate truth = test::truth(told, kSeeds, [&](uint32_t seeds) {
            return test::Estimates{mean_of(path_tracing, seeds)};
        })[0];
        EXPECT_FALSE(left);
        const test::MeanEstimate automatic = mean_of(settings_with(16), kSeeds);
        EXPECT_TRUE(left) << told;
        const double error = std::hypot(truth.standard_error(), automatic.standard_error());
        EXPECT_LT(error, 0.0025 * truth.mean()) << told;
        EXPECT_LT(std::abs(automatic.mean() - truth.mean()), 3.5 * error) << told;
    }
}

}  // namespace
}  // namespace spc
