// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that the camera sees in casters, by chains from the camera beside path tracing, in closed
// form.
#include "integrator/camera_chains.h"

#include "integrator/pictures.h"

namespace spc::test {
namespace {

constexpr uint32_t kWidth = 32;     // pixels
constexpr float kHalfView = 0.08f;  // of the picture, at distance 1: little more than a ball
constexpr uint32_t kWalks = 8192;
// Lamps: the camera sees one reflected by the ball at the origin, the other through it.
const Vec3 kEye(0.0f, -3.0f, 2.0f), kBefore(0.3f, -1.4f, 2.2f);

void set_wide_camera(SceneMaker& maker, const Vec3& from, const std::function<void(Camera&)>& more) {
    Camera camera;
    camera.to_world = rotation_x(std::atan2(-from.y, from.z), from);
    camera.width = camera.height = kWidth;
    camera.crop = {0, 0, kWidth, kWidth};
    camera.viewplane = {-kHalfView, kHalfView, -kHalfView, kHalfView};
    if (more) more(camera);
    maker.builder.set_camera(camera);
}

// Chains from the camera, of which so many walks learn beforehand.
Method by_chains(ChainFinder finder = ChainFinder::sheets, uint32_t walks = kWalks) {
    Method method{"chains from the camera", true, false, finder};
    method.camera_chains = CameraChainUse::learned;
    method.camera_walks = walks;
    return method;
}
IntegratorSettings within(const BounceLimits& limits) {
    IntegratorSettings settings;
    settings.limits = limits;
    return settings;
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
    const double expected = radiance * solid_angle * pixels_per_sr / (kWidth * kWidth);

    for (const ChainFinder finder : {ChainFinder::sheets, ChainFinder::walks, ChainFinder::mnee}) {
        const Picture picture =
            render(world, within({16, 0, 16, 16, 16}), by_chains(finder), 500, 3);
        const double error = picture.mean[4].standard_error();
        EXPECT_LT(error, 0.005 * expected);
        EXPECT_NEAR(picture.mean[4].mean(), expected, 4.0 * error);
        EXPECT_GT(picture.splats.mean(), 0.99 * picture.mean[4].mean());
    }
}

// Between two mirrors, seen down a row of pictures: the one behind n reflections, the floor's
// first, lies n below for odd n, for a distance of 1 between them.
TEST(CameraChainsSlow, BetweenMirrorsAreInClosedFormForAllReflections) {
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
        expected += radiance * std::numbers::pi * std::pow(double(kRadius) / distance, 2) *
                    pixels_per_sr / (kWidth * kWidth);
        ++seen;
    }
    EXPECT_GE(seen, 5u);

    const BounceLimits limits{kMost - 1, 0, kMost - 1, kMost - 1, 16};
    const Picture picture =
        render(world, within(limits), by_chains(ChainFinder::sheets, 32 * kWalks), 500, 3);
    const double error = picture.mean[4].standard_error();
    EXPECT_LT(error, 0.02 * expected);
    EXPECT_NEAR(picture.mean[4].mean(), expected, 4.0 * error);
    EXPECT_GT(picture.splats.mean(), 0.95 * picture.mean[4].mean());  // none was left out
}

// Hidden from the camera.
void add_unseen(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Vec3& at) {
    maker.add(mesh, graph, translation(at), CausticsRole::caster,
              kVisibleAll & ~uint32_t{kVisibleCamera});
}
void add_mirror_ball(SceneMaker& maker) {
    maker.add(sphere(24, 0.5), mirror(), {}, CausticsRole::caster);
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
