// SPDX-License-Identifier: GPL-3.0-or-later
// Chains without light paths: the light that a sphere throws on the floor under a sun, against what
// its mapping of impact parameters makes of it. Points are drawn on rings around the axis, which no
// pixel is; what agrees with path tracing is in agreement/chains.cpp.
#include "integrator/pictures.h"

namespace spc::test {
namespace {

// Of the floor at points that `point(u)` draws, seen from just above.
template <class Point>
RadianceEstimate floor_mean(const RenderScene& world, const Prepared& prepared, const Point& point,
                            uint32_t samples) {
    constexpr uint32_t kSeed = 3;
    RadianceEstimate mean;
    Pcg pcg(kSeed);
    PathStats stats;
    for (uint32_t i = 0; i < samples; ++i) {
        const Ray down{point(pcg.two()) + Vec3(0, 0, 0.01f), {0, 0, -1}};
        const PathSample sample = path_radiance(world, prepared.settings, prepared.state, down,
                                                Vec2(0.5f), Sampler(kSeed, i, 0), stats);
        mean.radiance.add(average(sample.radiance));
        mean.caustics.add(average(sample.caustics));
    }
    return mean;
}

// ---- a sphere in closed form

constexpr double kRadius = 0.5, kIor = 1.5, kSun = 3.0, kAlbedo = 0.8;

// Unpolarised, of a dielectric.
double fresnel(double sin_i, double ior) {
    const double cos_i = std::sqrt(1.0 - sin_i * sin_i), sin_t = sin_i / ior,
                 cos_t = std::sqrt(1.0 - sin_t * sin_t);
    const double s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t),
                 p = (cos_t - ior * cos_i) / (cos_t + ior * cos_i);
    return 0.5 * (s * s + p * p);
}

// Where light from straight above goes that passes the centre at a distance of b radii, and how
// much of it.
struct Landing {
    double r;  // on the floor, from the axis; infinite where it never gets there
    double share;
};
Landing through_glass(double b, double height) {
    // Both refractions turn it by the same angle.
    const double i = std::asin(b), t = std::asin(b / kIor), out = 2.0 * (i - t);
    const double reflected = fresnel(b, kIor);
    // It leaves at the angle 2 t - i from the axis, below the centre.
    const double at = 2.0 * t - i, z = height - kRadius * std::cos(at);
    const double r = kRadius * std::sin(at) - z * std::tan(out);
    return {out < 0.5 * std::numbers::pi ? std::abs(r) : HUGE_VAL, std::pow(1.0 - reflected, 2)};
}
Landing off_mirror(double b, double height) {
    const double i = std::asin(b), down = std::numbers::pi - 2.0 * i;  // to the vertical
    if (down >= 0.5 * std::numbers::pi) return {HUGE_VAL, 1.0};
    return {kRadius * b + (height + kRadius * std::cos(i)) * std::tan(down), 1.0};
}

// Mean irradiance of the ring between two radii: the light of all annuli that land there.
double ring_irradiance(Landing (*landing)(double, double), double height, double from, double to) {
    constexpr int kAnnuli = 400000;
    double flux = 0.0;
    for (int k = 0; k < kAnnuli; ++k) {
        const double b = (k + 0.5) / kAnnuli;
        const Landing at = landing(b, height);
        if (at.r >= from && at.r < to) flux += 2.0 * b / kAnnuli * at.share;
    }
    return kSun * flux * kRadius * kRadius / (to * to - from * from);
}

struct SphereCase {
    const char* name;
    Graph graph;
    Landing (*landing)(double, double);
    double height;  // of the centre
    std::vector<std::pair<double, double>> rings;
    std::vector<Method> methods;
    uint32_t longest;  // chain
    uint32_t samples;
};

TEST(SphereUnderASunSlow, HasTheIrradianceOfItsMapping) {
    constexpr uint32_t kCells = 256, kSeed = 5;
    constexpr double kFacets = 2e-3;  // relative error that these leave
    constexpr double kNoticed = 1.1;
    const double significance = sidak(kFamily, 10);
    // Within the shadow nothing is reflected; rays that meet behind the focus are there, too.
    const Graph ball = glass(float(kIor));
    constexpr uint32_t kThrough = 2, kAny = kLongestManifoldChain;
    const std::vector<Method> sheets{kSheetsAlone}, both{kManifold, kSheetsAlone};
    const std::vector<std::pair<double, double>> before{{0.045, 0.08}, {0.08, 0.12}, {0.15, 0.3}},
        beyond{{0.02, 0.06}, {0.06, 0.12}, {0.2, 0.45}}, around{{0.7, 1.2}, {1.2, 2.5}};
    const SphereCase cases[] = {
        {"glass", ball, through_glass, 0.6, before, sheets, kThrough, 10000},
        {"glass beyond its focus", ball, through_glass, 1.0, beyond, sheets, kThrough, 10000},
        {"mirror", mirror(), off_mirror, 0.6, around, both, kAny, 80000}};
    for (const SphereCase& c : cases) {
        SceneMaker maker;
        add_floor(maker);
        maker.add(sphere(kCells, kRadius), c.graph, translation({0, 0, float(c.height)}),
                  CausticsRole::caster);
        maker.builder.add_light(lamp(LightType::sun, float(kSun)));
        const RenderScene world = maker.finish();
        for (const Method& method : c.methods) {
            IntegratorSettings settings = few_bounces();
            settings.manifold.longest_chain = c.longest;
            const Prepared prepared(world, settings, method, kSeed);
            for (const auto& [from, to] : c.rings) {
                const auto in_ring = [from = from, to = to](const Vec2& u) {
                    const double r = std::sqrt(from * from + (to * to - from * from) * double(u.x)),
                                 turn = 2.0 * std::numbers::pi * double(u.y);
                    return Vec3(float(r * std::cos(turn)), float(r * std::sin(turn)), 0.0f);
                };
                const MeanEstimate found = floor_mean(world, prepared, in_ring, c.samples).radiance;
                const double expected =
                    kAlbedo / std::numbers::pi * ring_irradiance(c.landing, c.height, from, to);
                std::cout << c.name << " by " << method.name << ", ring from " << from << " to "
                          << to << ": " << found.mean() / expected << " +- "
                          << found.standard_error() / expected << std::endl;
                EXPECT_TRUE(is_mean(found, expected, significance, kFacets * expected))
                    << c.name << " by " << method.name << ", ring from " << from;
                EXPECT_FALSE(is_mean(found, kNoticed * expected, significance, kFacets * expected));
            }
        }
    }
}

// ---- folds

// Directions next to folds lead to rays that nothing ever ends: the floor is tiny beside the mirror
// around it.
TEST(Folds, RaysEndAmongMirrorsThatAreNoCasters) {
    SceneMaker maker;
    maker.add(square(1.0f), diffuse(0.8f), {}, CausticsRole::receiver);
    maker.builder.add_image(plane_normals(128, 0.25, 0.1, 5));
    maker.add(square(0.8f), normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
              rotation_x(1.3f, {0.0f, 0.9f, 0.8f}), CausticsRole::caster);
    maker.add(sphere(48, 5000.0), mirror(), translation({1000, 2000, 1500}), CausticsRole::off);
    add_lamp(maker, {0.3f, -1.2f, 2.6f}, {0.0f, 0.2f, 0.8f}, 0.05f);
    const RenderScene world = maker.finish();
    const RadianceEstimate mean = floor_mean(
        world, Prepared(world, few_bounces(), kSheetsAlone, 5),
        [](const Vec2& u) { return Vec3(u.x - 0.5f, u.y - 0.5f, 0.0f); }, 2000);
    EXPECT_GT(mean.caustics.mean(), 0.0);
}

}  // namespace
}  // namespace spc::test
