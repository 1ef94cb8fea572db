// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/bench.h"
#include "math/warp.h"
#include "shading/light_profile.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

const Vec3 kUp(0, 0, 1);

// Emission that differs by direction: half of one plus the lamp's own normal, scaled by a falloff.
Graph pattern(const std::string& falloff) {
    Graph graph = emission(1, 1, 1, 1);
    graph.nodes.push_back({"Coordinates", "texture_coordinate", kNone});
    graph.nodes.push_back({"Mapping", "mapping", kNone});
    graph.nodes.push_back({"Falloff", "light_falloff", kNone});
    graph.inputs.push_back({3, "Scale", {0.5f, 0.5f, -0.5f, 0}});
    graph.inputs.push_back({3, "Location", {0.5f, 0.5f, 0.5f, 0}});
    graph.inputs.push_back({4, "Strength", {1, 0, 0, 0}});
    graph.links.push_back({2, "Normal", 3, "Vector"});
    graph.links.push_back({3, "Vector", 1, "Color"});
    graph.links.push_back({4, falloff, 1, "Strength"});
    return graph;
}

Lit lit_by_nodes(LightDesc lamp, const Graph& graph) {
    SceneMaker maker;
    lamp.material = maker.builder.add_material(graph);
    maker.builder.add_light(lamp);
    return freeze(maker);
}

// What a delta lamp sends to the origin, 1 m below, along its own -Z.
TEST(LampShading, FactorsByDirectionAndLength) {
    const auto radiance = [](const LightDesc& lamp, const char* falloff) {
        const Lit lit = lit_by_nodes(lamp, pattern(falloff));
        const auto s = sample_direct(lit.lights, *lit.scene, {Vec3(0.0f)}, Vec3(0.5f));
        return s ? s->radiance : Spectrum(0.0f);
    };
    const float intensity = 10.0f / (4.0f * kPi);
    const Spectrum factor(0.5f, 0.5f, 1.0f);  // of the normal (0, 0, -1)
    const auto near = [](const Spectrum& a, const Spectrum& b) {
        return max_component(a - b) < 1e-5f && max_component(b - a) < 1e-5f;
    };
    const LightDesc far = point_lamp(10.0f, 0.0f, {0, 0, 3});
    EXPECT_TRUE(near(radiance(point_lamp(10.0f, 0.0f), "Quadratic"), factor * intensity));
    EXPECT_TRUE(near(radiance(far, "Quadratic"), factor * (intensity / 9.0f)));
    EXPECT_TRUE(near(radiance(far, "Linear"), factor * (intensity / 3.0f)));
    EXPECT_TRUE(near(radiance(far, "Constant"), factor * intensity));
}

// Next event estimation and points of the light, which share the factor, but with what they give it
// of their own, give the irradiance of directions drawn over the hemisphere.
TEST(LampShading, AllWaysToSampleAgree) {
    const std::vector<LightDesc> lamps{
        point_lamp(10, 0.4f), soft(point_lamp(10, 0.4f)), spot_lamp(10, 0.3f, 1.5f, 0.5f),
        area_lamp(10, AreaShape::rectangle, {1.2f, 0.7f}, {0, 0, 1}, {0, 0.3f, -1})};
    const double significance = sidak(1e-3, 2 * static_cast<int>(lamps.size()));
    for (const LightDesc& lamp : lamps) {
        const Lit lit = lit_by_nodes(lamp, pattern("Linear"));
        constexpr int64_t kSamples = 200000;
        MeanEstimate directions;
        Uniforms uniforms(3);
        for (int64_t i = 0; i < kSamples; ++i) {
            const Vec3 wi = uniform_cone(uniforms.two(), 1.0f);
            const auto hit = intersect_light(lit.scene->lights[0], {Vec3(0.0f), wi});
            if (!hit) {
                directions.add(0.0);
                continue;
            }
            RayState ray;
            ray.length = hit->t;
            const Spectrum radiance =
                radiance_of_lamp(lit.lights, *lit.scene, 0, hit->p, wi * -1.0f, ray);
            directions.add(static_cast<double>(radiance[0] * wi.z) * 2.0 * std::numbers::pi);
        }
        const MeanEstimate direct = irradiance_direct(lit, Vec3(0.0f), kUp, kSamples, 4, 0);
        const MeanEstimate points = irradiance_light_point(lit, Vec3(0.0f), kUp, kSamples, 5, 0);
        EXPECT_TRUE(same_mean(directions, direct, significance)) << lamp.name;
        EXPECT_TRUE(same_mean(directions, points, significance)) << lamp.name;
        const MeanEstimate brighter(static_cast<size_t>(kSamples), 1.05 * direct.mean(),
                                    1.05 * direct.standard_error());
        EXPECT_FALSE(same_mean(directions, brighter, significance)) << lamp.name;
    }
}

// Of the brightness 1 + cos over the polar angle, all around: a table of every five degrees.
TEST(LightProfile, MeetsAFunctionAndItsMean) {
    std::vector<float> block{3.0f, 37.0f, 0.0f, kPi, 2.0f * kPi};
    std::vector<float> row;
    for (int i = 0; i <= 36; ++i) {
        block.push_back(kPi * static_cast<float>(i) / 36.0f);
        row.push_back(1.0f + std::cos(block.back()));
    }
    for (int i = 0; i < 3; ++i) block.insert(block.end(), row.begin(), row.end());
    ASSERT_TRUE(LightProfile::is_valid(block));
    const LightProfile profile(block.data());
    EXPECT_NEAR(profile.mean(), 1.0, 1e-3);
    Uniforms uniforms(6);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 d = uniform_sphere(uniforms.two());
        EXPECT_NEAR(profile.at(d * 3.0f), 1.0f - d.z, 1e-3f);
    }
    block.pop_back();
    EXPECT_FALSE(LightProfile::is_valid(block));
}

// A lamp of a half turn, and of polar angles from 45 to 90 degrees, is dark beyond.
TEST(LightProfile, IsDarkBeyondItsAngles) {
    const std::vector<float> block{2.0f, 2.0f, 0.0f, kPi, kPi / 4, kPi / 2, 5.0f, 5.0f, 5.0f, 5.0f};
    ASSERT_TRUE(LightProfile::is_valid(block));
    const LightProfile profile(block.data());
    EXPECT_FLOAT_EQ(profile.at({-1, 0, -0.5f}), 5.0f);  // the azimuth pi / 2
    EXPECT_EQ(profile.at({1, 0, -0.5f}), 0.0f);
    EXPECT_EQ(profile.at({-0.5f, 0, -1}), 0.0f);
    EXPECT_EQ(profile.at({-1, 0, 0.5f}), 0.0f);
}

TEST(LampShading, WhoseNodesTellRaysApartFeedNoCaustics) {
    Graph by_kind = emission(1, 1, 1, 1);
    by_kind.nodes.push_back({"Path", "light_path", kNone});
    by_kind.links.push_back({2, "Is Diffuse Ray", 1, "Strength"});
    const LightDesc lamp = point_lamp(10, 0.4f);
    EXPECT_TRUE(lit_by_nodes(lamp, by_kind).lights.caustic_selection.empty());
    EXPECT_FALSE(lit_by_nodes(lamp, pattern("Constant")).lights.caustic_selection.empty());
}

}  // namespace
}  // namespace spc::test
