// SPDX-License-Identifier: GPL-3.0-or-later
// Glints from frame to frame: what a picture shows must be the map's, not the noise's.
#include "render/session.h"
#include "support/glints.h"
#include "support/power.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;
using namespace std::chrono_literals;

constexpr uint32_t kSide = 24;  // pixels
const int kFrames = test::power(8, 24);
constexpr uint32_t kSamples = 16, kReference = 64;

// What turns by a little in each frame, about the plate's middle.
enum class Turning { camera, sun };

RenderScene frame_of(Turning turning, int frame, GlintsMode mode) {
    constexpr float kStep = 0.003f;  // rad: a thirtieth of a pixel at the plate's edge
    const float turn = kStep * static_cast<float>(frame);
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(128, 5.0 / 128, 0.2, 5));
    Graph graph = test::normal_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {0.22f, 0, 0, 0}}}), {1, 1});
    graph.glints = mode;
    maker.add(test::square(0.1f), graph);
    const float view = turning == Turning::camera ? turn : 0.0f,
                light = turning == Turning::sun ? turn : 0.0f;
    Camera camera = test::look_at(
        Vec3(0.0f), Vec3(0.5f * std::sin(view), -0.5f * std::cos(view), 1.0f), 2.0f, 0.15f);
    camera.width = camera.height = kSide;
    camera.crop = {0, 0, kSide, kSide};
    maker.builder.set_camera(camera);
    maker.builder.add_light(
        test::sun_towards(Vec3(0.4f * std::sin(light), 0.4f * std::cos(light), 1.0f), 0.05f, 1.0f));
    return maker.finish();
}

std::vector<float> render(const RenderScene& world, uint32_t samples, uint32_t seed = 1) {
    RenderSettings settings;
    settings.samples = samples;
    settings.seed = seed;
    settings.threads = 2;
    Session session(world, settings);
    EXPECT_EQ(session.wait(60s).state, RenderState::done);
    const size_t channels = pass_channels(Pass::combined);
    std::vector<float> pixels(channels * kSide * kSide), red;
    session.film().read(Pass::combined, pixels);
    for (size_t i = 0; i < pixels.size(); i += channels) red.push_back(pixels[i]);
    return red;
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
    const auto n = static_cast<double>(a.size());
    double sa = 0, sb = 0, saa = 0, sab = 0, sbb = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double x = a[i], y = b[i];
        sa += x;
        sb += y;
        saa += x * x;
        sab += x * y;
        sbb += y * y;
    }
    return (sab - sa * sb / n) / std::sqrt((saa - sa * sa / n) * (sbb - sb * sb / n));
}

enum class Seeds { one, one_for_each_frame };

// Mean correlation of the pixels between neighbouring frames.
double steadiness(Turning turning, GlintsMode mode, uint32_t samples, Seeds seeds) {
    double sum = 0.0;
    std::vector<float> before;
    for (int frame = 0; frame < kFrames; ++frame) {
        const uint32_t seed = seeds == Seeds::one ? 1u : 1u + static_cast<uint32_t>(frame);
        std::vector<float> now = render(frame_of(turning, frame, mode), samples, seed);
        if (frame > 0) sum += correlation(before, now);
        before = std::move(now);
    }
    return sum / (kFrames - 1);
}

// Path tracing with one seed meets the same points of the map in each frame, so even its noise
// changes no faster than the map. What glints lose against it is flicker; with a seed for each
// frame all of their noise is. With random numbers in the order of the search a tenth of it was.
TEST(AnimationSlow, GlintsDoNotFlicker) {
    constexpr double kFlicker = 0.03;  // of the noise, from one frame to the next
    for (const Turning turning : {Turning::camera, Turning::sun}) {
        const double map = steadiness(turning, GlintsMode::off, kReference, Seeds::one),
                     glints = steadiness(turning, GlintsMode::on, kSamples, Seeds::one),
                     noise =
                         steadiness(turning, GlintsMode::on, kSamples, Seeds::one_for_each_frame);
        EXPECT_GT(map, 0.99) << "the turn is too large to tell";
        EXPECT_LT(noise, 0.98) << "too little noise to tell";
        EXPECT_LT(map - glints, kFlicker * (map - noise))
            << (turning == Turning::camera ? "camera: " : "sun: ") << map << ", glints " << glints
            << ", with seeds " << noise;
    }
}

TEST(Animation, AFrameIsTheSameAgain) {
    const RenderScene world = frame_of(Turning::camera, 12, GlintsMode::on);
    EXPECT_EQ(render(world, kSamples), render(world, kSamples));
    EXPECT_EQ(render(frame_of(Turning::camera, 12, GlintsMode::on), kSamples),
              render(world, kSamples));
}

}  // namespace
}  // namespace spc
