// SPDX-License-Identifier: GPL-3.0-or-later
// Lights so small that path tracing is blind: the manifold alone against light paths alone, for each
// kind of chain.
#include "integrator/chain_cases.h"
#include "integrator/pictures.h"

#include <set>

namespace spc::test {
namespace {

constexpr Method kSheetsAlone{"sheets", true, false, ChainFinder::sheets};

struct SmallLight {
    const char* name;
    LightType type;
    float radius;
};
constexpr SmallLight kPoint{"a point", LightType::point, 0.0f},
    kTiny{"a tiny sphere", LightType::point, 1e-3f}, kSun{"a sun", LightType::sun, 0.0f};
constexpr Vec3 kSlanting(0.1f, -1.0f, 0.9f);  // towards the sun: what leads to the floor by a mirror

// Of the floor, m: the mirror lights a narrow part. Where casters are much larger than what the camera
// sees of their light, light paths have rare bright splats that their sample variance does not know of.
constexpr float kNarrow = 0.3f, kWide = 0.9f;

RenderScene make(const ChainScene& scene, Reliefs reliefs, const SmallLight& small, float half_view) {
    constexpr float kHeight = 3.0f;
    SceneMaker maker;
    set_camera(maker, {0.0f, 0.0f, kHeight}, half_view / kHeight);
    add_floor(maker);
    add_relief_image(maker, reliefs);
    scene.build(maker, reliefs);
    LightDesc light = lamp(small.type, small.type == LightType::sun ? 3.0f : 100.0f);
    light.to_world = small.type == LightType::sun ? rotation_x(std::atan2(-kSlanting.y, kSlanting.z))
                                                  : translation(scene.lamp);
    light.radius = small.radius;
    maker.builder.add_light(light);
    return maker.finish();
}

void expect_agreement(const std::set<std::string>& kinds, Reliefs reliefs, const SmallLight& light,
                      float half_view, int comparisons) {
    constexpr uint32_t kRounds = 1000, kRoundsOfWalks = 12000, kLightRounds = 16000;
    constexpr double kNoticed = 0.12;  // a relative error that shows
    for (const ChainScene& scene : chain_scenes()) {
        if (!kinds.contains(scene.name)) continue;
        const RenderScene world = make(scene, reliefs, light, half_view);
        const std::string scene_name =
            scene.name + ", " + to_string(reliefs.one) + ", under " + light.name;
        const Picture by_light = true_picture(scene_name, kLightRounds, [&](uint32_t rounds) {
            return render(world, few_bounces(), kLightPaths, rounds, 1u << 20);
        });
        std::vector<Method> methods{kSheetsAlone};
        // Of the ball walks hardly meet some chains.
        if (reliefs.one == Relief::none && scene.has_relief) methods.push_back(kManifold);
        for (const Method& method : methods) {
            const bool walks = method.finder == ChainFinder::walks;
            const Picture found =
                render(world, few_bounces(), method, walks ? kRoundsOfWalks : kRounds, 1);
            const std::string what = scene_name + " by " + method.name;
            double largest = 0.0;  // of all parts, in standard deviations
            for (size_t i = 0; i < found.mean.size(); ++i)
                largest =
                    std::max(largest, std::abs(found.mean[i].mean() - by_light.mean[i].mean()) /
                                          std::hypot(found.mean[i].standard_error(),
                                                     by_light.mean[i].standard_error()));
            const double notices =
                5.0 * std::hypot(found.mean[4].standard_error(), by_light.mean[4].standard_error()) /
                by_light.mean[4].mean();
            std::cout << what << ": differ by " << largest
                      << " standard deviations, an error is noticed from " << notices << std::endl;
            expect_same(found, by_light, what, comparisons);
            EXPECT_LT(notices, kNoticed) << what;
        }
        EXPECT_EQ(render(world, few_bounces(), kPathTracing, 10, 1).mean[4].mean(), 0.0)
            << scene.name;
    }
}

const char* const kBall = "R, TT and TRT of a ball";
const std::set<std::string> kEvery{"R", "T", "RT", "TT", "TRT", "TTTT", kBall};

TEST(SmallLightsSlow, ManifoldAgreesWithLightPathsForPoints) {
    expect_agreement(kEvery, {}, kPoint, kWide, 9);
}
TEST(SmallLightsSlow, ManifoldAgreesWithLightPathsForTinySpheres) {
    expect_agreement(kEvery, {}, kTiny, kWide, 9);
}
TEST(SmallLightsSlow, ManifoldAgreesWithLightPathsForSuns) {
    // What is over the mirror keeps such a sun away in RT.
    expect_agreement({"R", "T", "TT", "TRT", "TTTT", kBall}, {}, kSun, kWide, 8);
}
TEST(SmallLightsSlow, ManifoldAgreesWithLightPathsBehindNormalMaps) {
    expect_agreement({"R", "TRT"}, {Relief::normals}, kPoint, kNarrow, 6);
    expect_agreement({"T", "RT", "TT", "TTTT"}, {Relief::normals}, kPoint, kWide, 6);
}
TEST(SmallLightsSlow, ManifoldAgreesWithLightPathsBehindBumps) {
    expect_agreement({"R", "T", "RT", "TT"}, {Relief::heights}, kPoint, kWide, 4);
}

}  // namespace
}  // namespace spc::test
