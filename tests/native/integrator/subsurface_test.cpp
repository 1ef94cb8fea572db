// SPDX-License-Identifier: GPL-3.0-or-later
// Random walks below a surface: what comes out of a large ball is what its colour says.
#include "integrator/subsurface.h"

#include "support/radiance.h"

namespace spc::test {
namespace {

constexpr float kRadius = 0.1f;  // m, beside a ball of 1 m

Graph skin(const Vec3& color, const std::string& method, float anisotropy = 0.0f) {
    Graph graph = single_shader("subsurface_scattering",
                                {{1, "Color", {color.x, color.y, color.z, 1}},
                                 {1, "Scale", {kRadius, 0, 0, 0}},
                                 {1, "Radius", {1, 0.5f, 0.25f, 0}},
                                 {1, "Anisotropy", {anisotropy, 0, 0, 0}}},
                                {{1, "falloff", method}});
    graph.links = {{1, "BSSRDF", 0, "Surface"}};
    return graph;
}

RenderScene ball_of(const Graph& graph) {
    SceneMaker maker;
    maker.add(sphere(64, 1.0), graph);
    return maker.finish();
}

const Ray kFromAbove{Vec3(0.1f, 0.2f, 4.0f), Vec3(0, 0, -1), 0.0f, kInfinity};

// The walk's weight, times the colour, is the reflectance of a diffuse surface of that colour: the
// medium is chosen so, to some percent, for light that enters as from one. Light that enters
// through facets goes deeper, which shows where the medium scatters forward.
TEST(Subsurface, ReflectsItsColour) {
    const Vec3 color(0.9f, 0.5f, 0.2f);
    for (const std::string method :
         {"RANDOM_WALK_SKIN", "RANDOM_WALK_FIXED_RADIUS", "RANDOM_WALK_DIPOLE"})
        for (const float g : {0.0f, 0.6f}) {
            if (method == "RANDOM_WALK_SKIN" && g > 0.0f) continue;
            const RenderScene world = ball_of(skin(color, method, g));
            const Scene& scene = *world.scene;
            const std::optional<Hit> hit = scene.accel->intersect(kFromAbove, kVisibleCamera);
            ASSERT_TRUE(hit);
            Surface surface;
            evaluate_surface(scene, hit->surface, kFromAbove.direction * -1.0f, surface);
            const auto s = sample(surface.closures, surface.ng, surface.wo, Vec3(0.5f));
            ASSERT_TRUE(s && s->below);
            EXPECT_FALSE(has_smooth_closure(surface.closures));
            std::array<MeanEstimate, 3> reflected;
            Pcg pcg(7);
            uint64_t rays = 0;
            for (int i = 0; i < 20000; ++i) {
                const auto exit = walk_below(scene, surface, *s->below, pcg, rays);
                for (int k = 0; k < 3; ++k)
                    reflected[static_cast<size_t>(k)].add(
                        exit ? static_cast<double>(exit->weight[k] * s->weight[k]) : 0.0);
                if (!exit) continue;
                ASSERT_GT(dot(exit->surface.ng, exit->surface.p), 0.0f);  // seen from outside
                ASSERT_EQ(exit->surface.closures.count, 1);
            }
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(reflected[static_cast<size_t>(k)].mean(), color[k],
                            0.06 * color[k] + 4 * reflected[static_cast<size_t>(k)].standard_error())
                    << method << " " << g << " " << k;
        }
}

// A white medium gives back what comes in, but for the walks that are given up, some percent.
TEST(Subsurface, WhiteLosesNothing) {
    SceneMaker maker;
    maker.add(sphere(64, 1.0), skin(Vec3(1.0f), "RANDOM_WALK_FIXED_RADIUS"));
    maker.builder.set_environment(
        {maker.builder.add_material(background(1, 1, 1)), kVisibleAll, true});
    const RenderScene world = maker.finish();
    const RadianceEstimate found = estimate(world, unlimited(), 4000, kFromAbove);
    EXPECT_GT(found.radiance.mean(), 0.9);
    EXPECT_LT(found.radiance.mean(), 1.0 + 4 * found.radiance.standard_error());
}

// Light comes as far as the medium lets it: the mean distance of the channels goes like their
// radii.
TEST(Subsurface, ComesAsFarAsItsRadius) {
    const RenderScene world = ball_of(skin(Vec3(0.7f), "RANDOM_WALK_FIXED_RADIUS"));
    const Scene& scene = *world.scene;
    const std::optional<Hit> hit = scene.accel->intersect(kFromAbove, kVisibleCamera);
    Surface surface;
    evaluate_surface(scene, hit->surface, kFromAbove.direction * -1.0f, surface);
    const auto s = sample(surface.closures, surface.ng, surface.wo, Vec3(0.5f));
    ASSERT_TRUE(s && s->below);
    Pcg pcg(8);
    uint64_t rays = 0;
    Spectrum distance(0.0f), weight(0.0f);
    for (int i = 0; i < 20000; ++i)
        if (const auto exit = walk_below(scene, surface, *s->below, pcg, rays)) {
            distance += exit->weight * length(exit->surface.p - surface.p);
            weight += exit->weight;
        }
    const Spectrum mean = distance / weight;
    EXPECT_NEAR(mean.x / mean.y, 2.0f, 0.2f);
    EXPECT_NEAR(mean.y / mean.z, 2.0f, 0.2f);
    const float free_path = kRadius / (4.0f * kPi);
    EXPECT_GT(mean.x, 0.5f * free_path);
    EXPECT_LT(mean.x, 10.0f * free_path);
}

}  // namespace
}  // namespace spc::test
