// SPDX-License-Identifier: GPL-3.0-or-later
// Glints that a path comes to after rough bounces, against path tracing of the same map.
#include "integrator/light_path.h"
#include "manifold/emission.h"
#include "support/glints.h"
#include "support/rough.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kFamily = 1e-3;  // probability that any comparison of a test fails by chance

Graph glossy(float roughness) {
    return test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}});
}

// What the camera looks at with a pixel of that width, m, and by which it sees the floor.
struct Via {
    std::string name;
    std::function<void(SceneMaker&, float width)> add;
};

Transform facing(const Vec3& p, const Vec3& z) {
    const Frame frame = Frame::around(normalize(z));
    Transform m = test::translation(p);
    for (int i = 0; i < 3; ++i)
        m.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
    return m;
}

// Where the floor's middle mirrors the sun to.
Via in_mirror(float roughness) {
    return {fmt::format("mirror of roughness {}", roughness), [=](SceneMaker& maker, float width) {
                const Vec3 at(0.0f, -1.0f, 2.0f), to_camera(1.0f, -1.0f, 0.3f);
                maker.add(test::square(1.0f), glossy(roughness),
                          facing(at, normalize(at * -1.0f) + normalize(to_camera)));
                maker.builder.set_camera(test::look_at(at, to_camera, 1000.0f, width));
            }};
}
Via through_pane(float roughness) {
    return {"pane", [=](SceneMaker& maker, float width) {
                const Vec3 at(0.0f, -1.0f, 2.0f);
                maker.add(test::square(0.5f), test::frosted_glass(roughness),
                          facing(at, {0.1f, 0.0f, -1.0f}));
                maker.builder.set_camera(test::look_at(at, at, 1000.0f, width));
            }};
}
Via directly() {
    return {"directly", [](SceneMaker& maker, float width) {
                maker.builder.set_camera(
                    test::look_at(Vec3(0.0f), {0.0f, -1.0f, 2.0f}, 1000.0f, width));
            }};
}
// Seen from below, where the sun does not shine.
Via on_ceiling() {
    return {"ceiling", [](SceneMaker& maker, float width) {
                const Vec3 at(0.3f, -0.3f, 1.0f);
                maker.add(test::square(0.1f), test::diffuse(0.8f), test::rotation_x(kPi, at));
                maker.builder.set_camera(test::look_at(at, {0.0f, -0.5f, -0.8f}, 0.5f, width));
            }};
}
// The same, which sees much of the floor in a mirror, too. That stands in the shade.
Via on_ceiling_beside_mirror(CausticsRole role) {
    return {fmt::format("ceiling beside a mirror of role {}", static_cast<int>(role)),
            [role](SceneMaker& maker, float width) {
                on_ceiling().add(maker, width);
                maker.add(test::square(0.45f), test::mirror(),
                          facing({0.3f, -0.6f, 0.65f}, {0.0f, 1.0f, 0.0f}), role);
                maker.add(test::square(0.5f), test::diffuse(0.0f),
                          test::translation({0.24f, -0.65f, 1.3f}));
            }};
}
// The same, where rough chains are looked for: by way of a metal that lies on the floor.
Via on_ceiling_above_metal() {
    return {"ceiling above a metal", [](SceneMaker& maker, float width) {
                on_ceiling().add(maker, width);
                maker.add(test::square(0.1f), test::metal(0.2f),
                          test::translation({0.4f, 0.2f, 0.05f}), CausticsRole::caster);
            }};
}

// A normal_mapped() of which half is a shader that is not.
Graph half_plain(Graph graph, const Graph& plain) {
    const auto mix = static_cast<uint32_t>(graph.nodes.size());
    graph.nodes.insert(graph.nodes.end(), {{"Both", "mix_shader", kNone}, plain.nodes[1]});
    graph.inputs.push_back({mix, "Fac", {0.5f, 0, 0, 0}});
    for (GraphInput input : plain.inputs) {
        input.node = mix + 1;
        graph.inputs.push_back(input);
    }
    graph.links[0] = {mix, "Shader", 0, "Surface"};
    graph.links.insert(graph.links.end(),
                       {{1, "BSDF", mix, "Shader"}, {mix + 1, "BSDF", mix, "Shader_001"}});
    return graph;
}

// A floor of 2 x 2 m with waves of five texels, which are `texel` wide, m, under a sun; the pixel
// covers `width`, m, of what it looks at. Each `pixel` has its own part of the map.
struct Floor {
    float roughness = 0.25f, texel = 0.002f, sun_angle = 0.009f, irradiance = 1.0f;
    int pixel = 0;
    CausticsRole role = CausticsRole::off;
    float width = 0.02f;
    bool half_plain = false;  // a lobe as wide without the map
};
RenderScene scene_of(const Via& via, const Floor& floor, GlintsMode mode) {
    constexpr int kMap = 256;
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(kMap, 5.0 / kMap, 0.2, 5));
    Graph graph = test::normal_mapped(glossy(floor.roughness), Vec2(2.0f / (floor.texel * kMap)));
    if (floor.half_plain) graph = half_plain(graph, glossy(floor.roughness));
    graph.glints = mode;
    if (floor.pixel > 0) {
        test::Uniforms uniforms(static_cast<uint64_t>(floor.pixel));
        graph.inputs.push_back({4, "Location", {uniforms(), uniforms(), 0, 0}});
    }
    maker.add(test::square(1.0f), graph, {}, floor.role);
    via.add(maker, floor.width);
    maker.builder.add_light(
        test::sun_towards({-0.1f, 0.4f, 1.0f}, floor.sun_angle, floor.irradiance));
    return maker.finish();
}

double p_value_of_difference(const test::MeanEstimate& a, const test::MeanEstimate& b) {
    const double z = (a.mean() - b.mean()) / std::hypot(a.standard_error(), b.standard_error());
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}
// Of one sample, relative.
double deviation(const test::MeanEstimate& a, uint32_t samples) {
    return a.standard_error() * std::sqrt(double(samples)) / a.mean();
}

// Over many texels. Its twin is a sun that is a tenth brighter.
TEST(LaterGlintsSlow, AgreeWithPathTracing) {
    constexpr uint32_t kSamples = 12000, kReference = 600000;
    const std::vector<Via> vias{in_mirror(0.02f), in_mirror(0.1f),    in_mirror(0.2f),
                                in_mirror(0.4f),  through_pane(0.2f), on_ceiling()};
    const double significance = test::sidak(kFamily, 2 * int(vias.size()));
    double least_of_twins = 1.0;
    for (const Via& via : vias)
        for (const float sun_angle : {0.009f, 0.2f}) {
            Floor floor;
            floor.sun_angle = sun_angle;
            const std::string name = fmt::format("{}, sun of {} rad", via.name, sun_angle);
            const auto off =
                test::path_traced_pixel(name, scene_of(via, floor, GlintsMode::off), kReference, 2);
            const auto with = [&](float irradiance) {
                floor.irradiance = irradiance;
                return test::estimate_pixel(scene_of(via, floor, GlintsMode::on), test::unlimited(),
                                            kSamples, 1);
            };
            const auto on = with(1.0f), twin = with(1.1f);
            EXPECT_GT(p_value_of_difference(on.radiance, off.radiance), significance)
                << name << ": " << on.radiance.mean() << " and " << off.radiance.mean();
            EXPECT_GT(on.stats.glints.estimates, kSamples / 3) << name;
            EXPECT_EQ(off.stats.glints.estimates, 0u) << name;
            EXPECT_LT(off.radiance.standard_error(), 0.015 * off.radiance.mean())
                << name << ": too little power";
            const double p_value = p_value_of_difference(twin.radiance, off.radiance);
            EXPECT_LT(p_value, 1e-2) << name << ": the comparison notices nothing";
            least_of_twins = std::min(least_of_twins, p_value);
        }
    EXPECT_LT(least_of_twins, significance);
}

// What it is for. Paths that came without a footprint would have the variance of the map.
TEST(LaterGlints, HaveLittleNoise) {
    constexpr uint32_t kSamples = 4000, kReference = 40000;
    for (const Via& via : {in_mirror(0.1f), in_mirror(0.4f), through_pane(0.2f), on_ceiling()}) {
        const Floor floor;
        const auto on = test::estimate_pixel(scene_of(via, floor, GlintsMode::on),
                                             test::unlimited(), kSamples, 1),
                   off = test::estimate_pixel(scene_of(via, floor, GlintsMode::off),
                                              test::unlimited(), kReference, 2);
        EXPECT_LT(deviation(on.radiance, kSamples), 0.5 * deviation(off.radiance, kReference))
            << via.name;
    }
}

// There one direction sees few of the facets that shine, and closure sampling misses no light.
TEST(LaterGlints, HaveNoMoreNoiseUnderWideLamps) {
    constexpr uint32_t kSamples = 20000;
    for (const Via& via : {directly(), in_mirror(0.1f), in_mirror(0.4f)}) {
        Floor floor;
        floor.roughness = 0.1f;
        floor.texel = 0.01f;
        floor.width = 0.05f;
        floor.sun_angle = 2.0f;
        const auto on = test::estimate_pixel(scene_of(via, floor, GlintsMode::on),
                                             test::unlimited(), kSamples, 1),
                   off = test::estimate_pixel(scene_of(via, floor, GlintsMode::off),
                                              test::unlimited(), kSamples, 2);
        EXPECT_GT(on.stats.glints.estimates, kSamples / 2) << via.name;
        EXPECT_LT(deviation(on.radiance, kSamples), 1.15 * deviation(off.radiance, kSamples))
            << via.name;
    }
}

// With light paths, so many for each sample.
struct WithLightPaths {
    test::MeanEstimate splatted;
    test::PixelEstimate camera_paths;

    double mean() const { return camera_paths.radiance.mean() + splatted.mean(); }
    double error() const {
        return std::hypot(camera_paths.radiance.standard_error(), splatted.standard_error());
    }
};
WithLightPaths with_light_paths(const RenderScene& world, uint32_t samples, uint32_t light_paths,
                                double beside_glints = std::numeric_limits<double>::infinity()) {
    const EmissionGuide guide =
        aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_beams);
    IntegratorSettings settings = test::unlimited();
    settings.light_tracing = {
        .guide = &guide, .paths = double(light_paths), .beside_glints = beside_glints};
    WithLightPaths result;
    result.camera_paths = test::estimate_pixel(world, settings, samples, 1, FilterKind::box);
    LightPathStats stats;
    std::vector<Splat> splats;
    for (uint32_t i = 0; i < light_paths * samples; ++i) {
        splats.clear();
        trace_light_path(world, settings, 0.0f, 5, {0, i}, splats, stats);
        double sum = 0.0;
        for (const Splat& splat : splats) sum += double(mean(splat.value));
        result.splatted.add(sum * light_paths);
    }
    return result;
}

// Where light paths find what a rough caster throws on, they share it with path tracing by the
// normal of a point: glints would be in the picture twice. They come by way of casters, too, and
// past none that are not. What the camera comes to densely, which is here the floor that the
// ceiling faces, they leave to glints.
TEST(LaterGlintsSlow, LeaveToLightPathsWhatTheyFind) {
    constexpr uint32_t kSamples = 120000, kLightPaths = 8;
    constexpr double kSome = 2.95, kAll = std::numeric_limits<double>::infinity();
    struct Case {
        Via via;
        bool all_by_light_paths;
        double beside_glints;
    };
    const Via by_caster = on_ceiling_beside_mirror(CausticsRole::caster);
    double of_all = 0.0;  // what light paths bring where they may have it all
    for (const Case& c : {Case{on_ceiling(), true, kAll}, Case{on_ceiling(), false, kSome},
                          Case{by_caster, true, kAll}, Case{by_caster, false, kSome},
                          Case{on_ceiling_beside_mirror(CausticsRole::off), false, kAll}}) {
        Floor floor;
        floor.sun_angle = 0.1f;
        floor.width = 0.1f;
        const std::string name = fmt::format("{}, beside glints {}", c.via.name, c.beside_glints);
        const auto off = test::path_traced_pixel(name, scene_of(c.via, floor, GlintsMode::off),
                                                 4 * kSamples, 2, FilterKind::box);
        floor.role = CausticsRole::caster;
        const RenderScene world = scene_of(c.via, floor, GlintsMode::on);
        ASSERT_TRUE(world.scene->instances[0].rough_caster);
        const WithLightPaths with = with_light_paths(world, kSamples, kLightPaths, c.beside_glints);
        EXPECT_EQ(with.camera_paths.stats.glints.estimates == 0, c.all_by_light_paths) << name;
        const double error = std::hypot(with.error(), off.radiance.standard_error());
        EXPECT_LT(std::abs(with.mean() - off.radiance.mean()), 3.5 * error)
            << name << ": " << with.mean() << " and " << off.radiance.mean() << " +- " << error;
        EXPECT_GT(with.splatted.mean(), 8.0 * error) << name << ": too little power";
        if (c.beside_glints == kAll)
            of_all = with.splatted.mean();
        else
            EXPECT_LT(with.splatted.mean(), of_all - 5.0 * error) << name << ": nothing was left";
    }
}

// The same of rough chains, which turn here at a lobe without a map alone: beside others a map's
// glints are averaged.
TEST(LaterGlintsSlow, LeaveToRoughChainsWhatTheyFind) {
    constexpr uint32_t kSamples = 60000;
    for (const bool half_plain : {false, true}) {
        const Via via = half_plain ? on_ceiling() : on_ceiling_above_metal();
        Floor floor;
        floor.sun_angle = 0.1f;
        floor.width = 0.1f;
        floor.half_plain = half_plain;
        const auto off = test::path_traced_pixel(via.name, scene_of(via, floor, GlintsMode::off),
                                                 6 * kSamples, 2, FilterKind::box);
        floor.role = CausticsRole::caster;
        const RenderScene world = scene_of(via, floor, GlintsMode::on);
        ASSERT_FALSE(world.rough_chain_casters.empty());
        ManifoldSettings manifold;
        manifold.enabled = true;
        const auto on =
            test::estimate_pixel(world, test::unlimited(manifold), kSamples, 1, FilterKind::box);
        EXPECT_EQ(on.stats.glints.estimates > 0, !half_plain) << via.name;
        EXPECT_GT(on.stats.manifold.trial_estimates, 0u) << via.name;
        const double error = std::hypot(on.radiance.standard_error(), off.radiance.standard_error());
        EXPECT_LT(std::abs(on.radiance.mean() - off.radiance.mean()), 3.5 * error)
            << via.name << ": " << on.radiance.mean() << " and " << off.radiance.mean() << " +- "
            << error;
        EXPECT_LT(12.0 * error, off.radiance.mean()) << via.name << ": too little power";
    }
}

// Without reflective caustics a diffuse ray meets no glints either.
TEST(LaterGlints, AreNoneWithoutReflectiveCaustics) {
    const RenderScene world = scene_of(on_ceiling(), {}, GlintsMode::on);
    for (const bool reflections : {true, false}) {
        IntegratorSettings settings = test::unlimited();
        settings.manifold.reflections = reflections;
        const auto estimate = test::estimate_pixel(world, settings, 1000, 1);
        EXPECT_EQ(estimate.radiance.mean() > 0.0, reflections);
        EXPECT_EQ(estimate.stats.glints.estimates > 0, reflections);
    }
}

}  // namespace
}  // namespace spc
