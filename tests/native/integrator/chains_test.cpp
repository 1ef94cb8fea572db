// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold without light paths: a sphere under a sun against what its mapping of impact parameters
// to the floor makes of the light, and directions next to folds against walks.
#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

constexpr double kFamily = 1e-3;  // probability that right estimators differ somewhere in a test
constexpr float kAlbedo = 0.8f;
// Lights show by way of casters alone.
constexpr uint32_t kNotDirectly = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;

struct Method {
    const char* name;
    ChainFinder finder;
    uint32_t longest;
    uint32_t samples = 15000;  // for each block, against path tracing
};
constexpr Method kWalks{"walks", ChainFinder::walks, kLongestManifoldChain, 60000},
    kSheets{"sheets", ChainFinder::sheets, kLongestManifoldChain};

IntegratorSettings one_scattering() {
    IntegratorSettings settings;
    settings.limits = {16, 1, 16, 16, 16};
    return settings;
}

// Radiance of the floor at points that `point(u)` draws, seen from just above, and the manifold's
// share of it.
struct FloorMean {
    MeanEstimate radiance, caustics;
};
class Floor {
public:
    Floor(const RenderScene& world, const Method* method)
        : world_(world), settings_(one_scattering()) {
        if (method == nullptr) return;
        settings_.manifold = unbiased_manifold();
        settings_.manifold.finder = method->finder;
        settings_.manifold.longest_chain = method->longest;
        if (method->finder != ChainFinder::sheets) return;
        constexpr uint32_t kSeed = 5, kEmissionCells = 256;
        constexpr float kSure = 0.2f;  // leaves many chains to chance
        sheets_ = build_sheets(*world.scene, world.lights, world.casters, settings_.manifold, kSeed,
                               kEmissionCells, 1);
        state_.sheets = {sheets_, kSure};
    }

    template <class Point>
    FloorMean mean(const Point& point, uint32_t samples, uint32_t seed) {
        FloorMean result;
        Pcg pcg(seed);
        PathStats stats;
        for (uint32_t i = 0; i < samples; ++i) {
            const Vec3 p = point(pcg.two());
            const Ray down{p + Vec3(0, 0, 0.01f), {0, 0, -1}};
            const PathSample sample = path_radiance(world_, settings_, state_, down, Vec2(0.5f),
                                                    Sampler(seed, i, 0), stats);
            result.radiance.add(double(sample.radiance.x + sample.radiance.y + sample.radiance.z) /
                                3.0);
            result.caustics.add(double(sample.caustics.y));
        }
        return result;
    }

private:
    const RenderScene& world_;
    IntegratorSettings settings_;
    SheetPool sheets_;
    RoundState state_;
};

void add_floor(SceneMaker& maker) {
    maker.add(square(8.0f), diffuse(kAlbedo), {}, CausticsRole::receiver);
}

// ---- a sphere in closed form

constexpr double kRadius = 0.5, kIor = 1.5, kSun = 3.0;

// Unpolarised, of a dielectric.
double fresnel(double sin_i, double ior) {
    const double cos_i = std::sqrt(1.0 - sin_i * sin_i), sin_t = sin_i / ior,
                 cos_t = std::sqrt(1.0 - sin_t * sin_t);
    const double s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t),
                 p = (cos_t - ior * cos_i) / (cos_t + ior * cos_i);
    return 0.5 * (s * s + p * p);
}

// Where light from straight above goes that passes the centre at a distance of b radii, and how much
// of it.
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
    uint32_t samples;
};

TEST(SphereUnderASunSlow, HasTheIrradianceOfItsMapping) {
    constexpr uint32_t kCells = 256;
    constexpr double kFacets = 2e-3;  // relative error that these leave
    constexpr double kNoticed = 1.1;
    const double significance = sidak(kFamily, 10);
    // Within the shadow nothing is reflected; rays that meet behind the focus are there, too.
    const SphereCase cases[] = {
        {"glass",
         glass(float(kIor)),
         through_glass,
         0.6,
         {{0.045, 0.08}, {0.08, 0.12}, {0.15, 0.3}},
         {{"sheets", ChainFinder::sheets, 2}},
         10000},
        {"glass beyond its focus",
         glass(float(kIor)),
         through_glass,
         1.0,
         {{0.02, 0.06}, {0.06, 0.12}, {0.2, 0.45}},
         {{"sheets", ChainFinder::sheets, 2}},
         10000},
        {"mirror", mirror(), off_mirror, 0.6, {{0.7, 1.2}, {1.2, 2.5}}, {kWalks, kSheets}, 80000}};
    for (const SphereCase& c : cases) {
        SceneMaker maker;
        add_floor(maker);
        maker.add(sphere(kCells, kRadius), c.graph, translation({0, 0, float(c.height)}),
                  CausticsRole::caster);
        LightDesc sun;
        sun.name = "sun";
        sun.type = LightType::sun;
        sun.power = Spectrum(float(kSun));
        sun.visibility = kNotDirectly;
        maker.builder.add_light(sun);
        const RenderScene world = maker.finish();
        for (const Method& method : c.methods) {
            Floor floor(world, &method);
            for (const auto& [from, to] : c.rings) {
                const auto in_ring = [from = from, to = to](const Vec2& u) {
                    const double r = std::sqrt(from * from + (to * to - from * from) * double(u.x)),
                                 turn = 2.0 * std::numbers::pi * double(u.y);
                    return Vec3(float(r * std::cos(turn)), float(r * std::sin(turn)), 0.0f);
                };
                const MeanEstimate found = floor.mean(in_ring, c.samples, 3).radiance;
                const double expected = double(kAlbedo) / std::numbers::pi *
                                        ring_irradiance(c.landing, c.height, from, to);
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
    maker.add(square(1.0f), diffuse(kAlbedo), {}, CausticsRole::receiver);
    maker.builder.add_image(plane_normals(128, 0.25, 0.1, 5));
    maker.add(square(0.8f), normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
              rotation_x(1.3f, {0.0f, 0.9f, 0.8f}), CausticsRole::caster);
    maker.add(sphere(48, 5000.0), mirror(), translation({1000, 2000, 1500}), CausticsRole::off);
    add_lamp(maker, {0.3f, -1.2f, 2.6f}, {0.0f, 0.2f, 0.8f}, 0.05f);
    const RenderScene world = maker.finish();
    const FloorMean mean =
        Floor(world, &kSheets)
            .mean([](const Vec2& u) { return Vec3(u.x - 0.5f, u.y - 0.5f, 0.0f); }, 2000, 3);
    EXPECT_GT(mean.caustics.mean(), 0.0);
}

// Beside strong waves directions next to folds bring a sixth of the light. Walks, which know of no
// folds, tell whether it is all.
TEST(FoldsSlow, AgreeWithWalks) {
    SceneMaker maker;
    add_floor(maker);
    maker.builder.add_image(plane_normals(128, 0.25, 0.1, 5));
    maker.add(square(0.8f), normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
              rotation_x(1.3f, {0.0f, 0.9f, 0.8f}), CausticsRole::caster);
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = LightType::point;
    lamp.to_world = translation({0.3f, -1.2f, 2.6f});
    lamp.power = Spectrum(100.0f);
    lamp.radius = 0.05f;
    lamp.visibility = kNotDirectly;
    maker.builder.add_light(lamp);
    const RenderScene world = maker.finish();
    const auto point = [](const Vec2& u) { return Vec3(u.x - 0.5f, u.y - 0.5f, 0.0f); };
    const MeanEstimate sheets = Floor(world, &kSheets).mean(point, 200000, 3).radiance,
                       walks = truth("walks", 1600000, [&](uint32_t samples) {
                           return Estimates{Floor(world, &kWalks).mean(point, samples, 4).radiance};
                       })[0];
    std::cout << sheets.mean() << " +- " << sheets.standard_error() << ", by walks " << walks.mean()
              << " +- " << walks.standard_error() << std::endl;
    EXPECT_TRUE(same_mean(sheets, walks, kFamily));
    EXPECT_LT(std::hypot(sheets.standard_error(), walks.standard_error()), 0.02 * walks.mean());
}

}  // namespace
}  // namespace spc::test
