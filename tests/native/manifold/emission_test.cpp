// SPDX-License-Identifier: GPL-3.0-or-later
// Directions from lights to casters: their density against the rays, its integral, and what it
// reaches.
#include "manifold/emission.h"

#include "light/bench.h"
#include "math/warp.h"
#include "support/chi_square.h"

namespace spc::test {
namespace {

constexpr double kFamily = 1e-3;

// A mirror ball and an inclined sheet of glass, in all between -1 and 1.
void add_casters(SceneMaker& maker) {
    maker.add(sphere(16, 0.4), mirror(), translation({-0.5f, 0.1f, 0.1f}), CausticsRole::caster);
    maker.add(square(0.4f), refraction(1.4f), rotation_x(0.5f, {0.5f, 0.0f, -0.2f}),
              CausticsRole::caster);
}

struct LightCase {
    std::string name;
    std::function<void(SceneMaker&)> add;
};
std::vector<LightCase> all_lights() {
    const auto lamp = [](const char* name, const LightDesc& light) {
        return LightCase{name, [light](SceneMaker& maker) { maker.builder.add_light(light); }};
    };
    const Vec3 above(0.6f, -0.4f, 3.0f), down = normalize(above) * -1.0f, tilted(0.3f, 0.1f, -1.0f);
    LightDesc spot = spot_lamp(10.0f, 0.2f, 1.5f, 0.3f), sharp = spot;
    sharp.radius = 0.0f;
    return {
        lamp("point", point_lamp(10.0f, 0.0f, above)),
        lamp("point among the casters", point_lamp(10.0f, 0.0f, {0.1f, 0.0f, 0.3f})),
        lamp("point at 10 km", point_lamp(1e6f, 0.0f, {6e3f, 0.0f, 8e3f})),
        lamp("point at 10 km, south", point_lamp(1e6f, 0.0f, {0.0f, -1e4f, 0.0f})),
        lamp("delta spot", sharp),
        lamp("spot", spot),
        lamp("sphere", point_lamp(10.0f, 0.3f, above)),
        lamp("sphere beside the casters", point_lamp(10.0f, 0.4f, {0.0f, 0.0f, 0.9f})),
        lamp("rectangle", area_lamp(10.0f, AreaShape::rectangle, {0.8f, 0.3f}, above, down)),
        lamp("wide beam of a rectangle",
             beam(area_lamp(10.0f, AreaShape::rectangle, {0.8f, 0.3f}, above, down), 1.5f)),
        lamp("narrow beam of a rectangle",
             beam(area_lamp(10.0f, AreaShape::rectangle, {0.8f, 0.3f}, above, down), 0.1f)),
        lamp("narrow beam of a large rectangle",
             beam(area_lamp(10.0f, AreaShape::rectangle, {6, 6}, {0, 0, 2}, {0.1f, 0, -1}), 0.02f)),
        lamp("ellipse", area_lamp(10.0f, AreaShape::ellipse, {0.8f, 0.3f}, above, down)),
        lamp("large rectangle",
             area_lamp(10.0f, AreaShape::rectangle, {6, 6}, {0, 0, 2}, {0, 0, -1})),
        lamp("parallel sun", sun_lamp(1.0f, 0.0f, tilted)),
        lamp("sun with a disc", sun_lamp(1.0f, 0.02f, tilted)),
        {"emissive mesh",
         [=](SceneMaker& maker) {
             maker.add(sphere(8, 0.3), emission(1, 1, 1, 5), translation(above));
         }},
        {"panorama",
         [](SceneMaker& maker) {
             std::vector<float> texels(size_t{16} * 8 * 3, 0.1f);
             std::fill_n(texels.begin() + (5 * 16 + 3) * 3, 6, 50.0f);
             const uint32_t image = maker.builder.add_image(
                 image_from_floats("sky", texels, 16, 8, 3, ColorSpace::linear, AlphaMode::none));
             Graph graph = background(1, 1, 1);
             graph.nodes.push_back({"Sky", "environment_texture", image});
             graph.links.push_back({2, "Color", 1, "Color"});
             maker.builder.set_environment({maker.builder.add_material(graph), kVisibleAll, true});
         }},
    };
}

ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

// A guide that aims, or one that learned of a few places besides.
EmissionGuide guide_for(const RenderScene& world, uint32_t light, bool learned,
                        Squares squares = Squares::of_beams) {
    std::vector<EmissionSample> samples;
    Uniforms uniforms(17);
    for (int i = 0; learned && i < 3000; ++i) {
        const Vec2 u = uniforms.two();
        samples.push_back({light, {{0.3f + 0.2f * u.x * u.y, 0.9f * u.y}, 0.1f + uniforms()}});
    }
    return aim_at_casters(*world.scene, world.lights, world.casters, squares, samples);
}

struct Bench {
    RenderScene world;
    uint32_t light;  // the only one
    std::string name;
};
std::vector<Bench> benches() {
    std::vector<Bench> all;
    for (const LightCase& c : all_lights()) {
        SceneMaker maker;
        add_casters(maker);
        c.add(maker);
        Bench bench{maker.finish(), 0, c.name};
        const auto y =
            sample_light_point(bench.world.lights, *bench.world.scene, {0.5f, 0.4f, 0.3f});
        EXPECT_TRUE(y) << c.name;
        if (y) bench.light = y->light;
        all.push_back(std::move(bench));
    }
    return all;
}

// Where a ray passes the casters: any point of it will do.
Vec3 point_on(const EmittedRay& ray, const EmissionGuide& guide, float share) {
    const float near = std::max(length(guide.center - ray.origin) - guide.radius, 0.1f);
    return ray.origin + ray.direction * (near + 2.0f * share * guide.radius);
}

TEST(Emission, RaysHaveTheirDensity) {
    for (const Bench& bench : benches())
        for (const bool learned : {false, true}) {
            const EmissionGuide guide = guide_for(bench.world, bench.light, learned);
            Uniforms uniforms(3);
            constexpr int kRays = 20000;
            int different = 0;
            for (int i = 0; i < kRays; ++i) {
                const auto y = sample_point_of_light(bench.world.lights, *bench.world.scene,
                                                     bench.light, uniforms.two());
                ASSERT_TRUE(y);
                const EmittedRay ray = emit(guide, *y, uniforms.two());
                ASSERT_GT(ray.pdf, 0.0f);
                ASSERT_NEAR(length(ray.direction), 1.0f, 1e-5f);
                const Vec3 p = point_on(ray, guide, uniforms());
                const float pdf = emission_pdf(guide, bench.light, end_of(*y), p);
                different += std::abs(pdf - ray.pdf) > 1e-3f * ray.pdf ? 1 : 0;
            }
            // By rounding a few fall into the neighbouring leaf; from far away that is wider.
            EXPECT_LT(different, bench.name.find("km") != std::string::npos ? kRays / 50 : kRays / 200)
                << bench.name << (learned ? ", learned" : "");
        }
}

// 1 - cos of the cone in which a point of a local light sees the sphere around the casters, or of
// its beam.
double cone_from(const EmissionGuide& guide, const LightEmission& emission, const Vec3& y) {
    if (emission.by_beam) return double(emission.narrowest);
    const Vec3d axis = Vec3d(guide.center) - Vec3d(y);
    const double sine = double(guide.radius) / length(axis);
    const bool everywhere = sine >= 1.0 || dot(axis, Vec3d(emission.frame.z)) <= 0.0;
    return everywhere ? 2.0 : 1.0 - std::sqrt(1.0 - sine * sine);
}

// Two ways to the same number: uniform over more than the whole domain, and 1 / pdf over its own
// samples, which is the domain's size.
TEST(Emission, DensityIntegratesToOne) {
    constexpr int kSamples = 100000;
    constexpr double kRoundoff = 1e-6;  // where all rays have the same density
    const std::vector<Bench> all = benches();
    const double significance = sidak(kFamily, 4 * int(all.size()));
    for (const Bench& bench : all)
        for (const bool learned : {false, true}) {
            const EmissionGuide guide = guide_for(bench.world, bench.light, learned);
            const LightEmission& emission = guide.lights[bench.light];
            Uniforms uniforms(4);
            MeanEstimate integral, size;
            const bool distant = bench.world.lights.is_distant(bench.light);
            for (int i = 0; i < kSamples; ++i) {
                const auto y = sample_point_of_light(bench.world.lights, *bench.world.scene,
                                                     bench.light, uniforms.two());
                ASSERT_TRUE(y);
                const EmittedRay ray = emit(guide, *y, uniforms.two());
                const double cone = distant ? 0.0 : cone_from(guide, emission, y->p);
                const double domain = distant ? 4.0 * std::pow(double(guide.radius), 2)
                                              : 2.0 * std::numbers::pi * cone;
                size.add(1.0 / double(ray.pdf) / domain);
                const Vec2 u = uniforms.two();
                if (distant) {
                    const Frame frame = Frame::around(y->direction);
                    const Vec3 p = guide.center + frame.x * (3.0f * guide.radius * (u.x - 0.5f)) +
                                   frame.y * (3.0f * guide.radius * (u.y - 0.5f));
                    integral.add(9.0 * std::pow(double(guide.radius), 2) *
                                 double(emission_pdf(guide, bench.light, end_of(*y), p)));
                } else {
                    // Wider than the cone where there is more than that.
                    const float wide = std::min(1.5f * float(cone), 2.0f);
                    const float far = length(guide.center - y->p);
                    const Frame frame = Frame::around(
                        emission.by_beam ? emission.frame.z : normalize(guide.center - y->p));
                    const Vec3 w = frame.to_world(uniform_cone(u, wide));
                    integral.add(double(emission_pdf(guide, bench.light, end_of(*y),
                                                     y->p + w * std::max(far, 1.0f)) /
                                        uniform_cone_pdf(wide)));
                }
            }
            const std::string what = bench.name + (learned ? ", learned" : "");
            // Positions 10 km away have a spacing of a millimetre, a thousandth of the casters.
            EXPECT_TRUE(is_mean(integral, 1.0, significance, 2e-3)) << what;
            EXPECT_TRUE(is_mean(size, 1.0, significance, kRoundoff)) << what;
        }
}

// Squares that stand for beams reach what the light point shines at.
TEST(Emission, ReachesEveryPointOfTheCasters) {
    for (const Bench& bench : benches())
        for (const Squares squares : {Squares::of_casters, Squares::of_beams}) {
            const EmissionGuide guide = guide_for(bench.world, bench.light, true, squares);
            Pcg pcg(5);
            int reached = 0, missed = 0;
            for (int i = 0; i < 20000; ++i) {
                const auto y = sample_point_of_light(bench.world.lights, *bench.world.scene,
                                                     bench.light, pcg.two());
                ASSERT_TRUE(y);
                const Caster& caster = bench.world.casters.casters[pcg.bits() % 2];
                const Vec3 p = surface_position(*bench.world.scene, sample_on(caster, pcg));
                const Vec3 away = y->distant ? y->direction * -1.0f : normalize(p - y->p);
                if (guide.lights[bench.light].by_beam &&
                    is_black(radiance_at(bench.world.lights, *bench.world.scene, *y, away, 1.0f)))
                    continue;
                ++(emission_pdf(guide, bench.light, end_of(*y), p) > 0.0f ? reached : missed);
            }
            EXPECT_EQ(missed, 0) << bench.name;
            EXPECT_GT(reached, 0) << bench.name;
        }
}

// A light path from a narrow beam is not wasted on directions that the lamp leaves dark.
TEST(Emission, KeepsToTheBeam) {
    for (const Bench& bench : benches()) {
        if (!bench.name.starts_with("narrow beam") && bench.name != "delta spot") continue;
        const EmissionGuide guide = guide_for(bench.world, bench.light, false);
        EXPECT_TRUE(guide.lights[bench.light].by_beam) << bench.name;
        Uniforms uniforms(8);
        constexpr int kRays = 10000;
        int lit = 0;
        for (int i = 0; i < kRays; ++i) {
            const auto y = sample_point_of_light(bench.world.lights, *bench.world.scene,
                                                 bench.light, uniforms.two());
            ASSERT_TRUE(y);
            const EmittedRay ray = emit(guide, *y, uniforms.two());
            lit += is_black(
                       radiance_at(bench.world.lights, *bench.world.scene, *y, ray.direction, 1.0f))
                       ? 0
                       : 1;
        }
        EXPECT_GT(lit, kRays * 99 / 100) << bench.name;
    }
}

// One over the density of those rays that meet a disk is the disk's solid angle.
TEST(Emission, IsExactFromFarAway) {
    struct Case {
        float distance, radius;
        double tolerance;  // of the solid angle; directions have a spacing of 6e-8
    };
    for (const Case& c : {Case{100.0f, 0.1f, 1e-3}, Case{1e4f, 0.5f, 2e-2},
                          Case{100.0f, 5e-4f, 3e-2}, Case{1e3f, 5e-4f, 0.4}})
        for (const Vec3& towards : {Vec3(0, 0, 1), normalize(Vec3(1, -2, 1.5f))}) {
            SceneMaker maker;
            Mesh disk = grid(
                32,
                [&](double u, double v) {
                    const Vec2 p = concentric_disk({float(u), float(v)});
                    return Vec3d(double(p.x), double(p.y), 0.0) * double(c.radius);
                },
                [](double, double) { return Vec3d(0, 0, 1); });
            maker.add(disk, mirror(), facing(Vec3(0.0f), towards * -1.0f), CausticsRole::caster);
            maker.builder.add_light(point_lamp(100.0f, 0.0f, towards * c.distance));
            const RenderScene world = maker.finish();
            const EmissionGuide guide =
                aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_beams);
            Uniforms uniforms(6);
            const auto y = sample_point_of_light(world.lights, *world.scene, 0, {0.5f, 0.5f});
            ASSERT_TRUE(y);
            MeanEstimate angle;
            for (int i = 0; i < 200000; ++i) {
                const EmittedRay ray = emit(guide, *y, uniforms.two());
                // Where it passes the disk's plane, in double.
                const Vec3d d(ray.direction), n(towards), o(ray.origin);
                const Vec3d at = o - d * (dot(o, n) / dot(d, n));
                const float pdf = emission_pdf(guide, 0, end_of(*y), Vec3(at));
                if (!(length(at) < double(c.radius) * 0.9)) {
                    angle.add(0.0);
                    continue;
                }
                EXPECT_GT(pdf, 0.0f);
                angle.add(pdf > 0.0f ? 1.0 / double(pdf) : 0.0);
            }
            const double expected =
                std::numbers::pi * std::pow(0.9 * double(c.radius) / double(c.distance), 2);
            EXPECT_TRUE(is_mean(angle, expected, sidak(kFamily, 8), c.tolerance * expected))
                << c.radius << " m at " << c.distance << " m";
        }
}

}  // namespace
}  // namespace spc::test
