// SPDX-License-Identifier: GPL-3.0-or-later
// A render that is cancelled ends soon, wherever it is.
#include "render/session_settings.h"

#include "support/casters.h"
#include "support/glints.h"

#include <gtest/gtest.h>

#include <ctime>
#include <set>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

// By all threads of the process, s. How busy the machine is makes no difference to it.
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Water with waves of all heights over a floor, 2 m wide, under a sun that is wide enough for
// several sheets. The camera looks down at it.
RenderScene pool() {
    constexpr uint32_t kCells = 256;
    constexpr float kFloor = 2.0f, kDeep = 1.0f;
    SceneMaker maker;
    Camera camera;
    camera.to_world = test::translation({0.0f, 0.0f, 6.0f});
    camera.width = 256;
    camera.height = 128;
    camera.crop = {0, 0, camera.width, camera.height};
    camera.viewplane = {-0.4f, 0.4f, -0.2f, 0.2f};
    maker.builder.set_camera(camera);
    const test::Waves waves = test::plane_waves(0.15, 0.12, 7);
    const auto at = [](double u, double v) { return Vec3d(u, v, 0.0); };
    maker.add(test::square(kFloor), test::diffuse(0.8f), test::translation({0, 0, -kDeep}),
              CausticsRole::receiver);
    maker.add(test::grid(
                  kCells,
                  [&](double u, double v) {
                      return Vec3d(2.0 * u - 1.0, 2.0 * v - 1.0, 2.0 * waves.height(at(u, v)));
                  },
                  [&](double u, double v) {
                      const Vec3d slope = waves.gradient(at(u, v));
                      return normalize(Vec3d(-slope.x, -slope.y, 1.0));
                  }),
              test::glass(1.33f), {}, CausticsRole::caster);
    maker.builder.add_light(test::sun_towards({0.1f, -0.3f, 1.2f}, 0.2f, 3.0f));
    return maker.finish();
}

RenderSettings settings() { return test::automatic_settings(1u << 16, 8, 5); }

// What its last stage, and all before it, take.
double preparation_seconds(const RenderScene& world) {
    const double before = processor_seconds();
    Session session(world, settings());
    while (session.wait(1ms).stage != RenderStage::samples) {}
    return processor_seconds() - before;
}

TEST(CancellingSlow, EndsEveryStageSoon) {
    constexpr int kMoments = 12;
    constexpr double kShare = 0.05;  // of the preparation
    const RenderScene world = pool();
    const double whole = preparation_seconds(world);
    std::set<RenderStage> stages;
    for (int i = 0; i < kMoments; ++i) {
        const double begin = processor_seconds(), moment = whole * (i + 0.5) / kMoments;
        Session session(world, settings());
        RenderStage stage = RenderStage::maps;
        while (processor_seconds() - begin < moment && stage != RenderStage::samples)
            stage = session.wait(0ms).stage;
        const double cancelled = processor_seconds();
        session.cancel();
        EXPECT_EQ(session.wait(60s).state, RenderState::cancelled);
        EXPECT_LT(processor_seconds() - cancelled, kShare * whole)
            << "in stage " << static_cast<int>(stage) << ", " << moment << " of " << whole << " s";
        stages.insert(stage);
    }
    EXPECT_TRUE(stages.contains(RenderStage::sheets));
    EXPECT_TRUE(stages.contains(RenderStage::light_paths));
}

}  // namespace
}  // namespace spc
