// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold without light paths, for each kind of chain: a sphere under a sun against what its
// mapping of impact parameters to the floor makes of the light, the rest against path tracing.
#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

constexpr double kFamily = 1e-3;  // chance that right estimators differ somewhere in a test
constexpr float kAlbedo = 0.8f;
// Lights show by way of casters alone.
constexpr uint32_t kNotDirectly = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;

struct Method {
    const char* name;
    ChainFinder finder;
    uint32_t longest;
    uint32_t samples = 15000;  // for each block, against path tracing
};
constexpr Method kWalks{"walks", ChainFinder::walks, 1, 60000},
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
        constexpr uint32_t kSeed = 5, kTiles = 256;
        constexpr float kSure = 0.2f;  // leaves many chains to chance
        sheets_ = build_sheets(*world.scene, world.lights, world.casters, settings_.manifold, kSeed,
                               kTiles, 1);
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
    PassState state_;
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

// ---- every kind of chain, against path tracing

// A square with UVs whose normals come from image 0: waves of this slope.
void add_waves(SceneMaker& maker, double slope) {
    maker.builder.add_image(plane_normals(128, 0.25, slope, 5));
}
Mesh mapped_square(float half) {
    return with_uvs(grid(
                        1,
                        [=](double u, double v) {
                            return Vec3d(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0) * double(half);
                        },
                        [](double, double) { return Vec3d(0, 0, 1); }),
                    1);
}

struct ChainCase {
    std::string name;
    std::function<void(SceneMaker&, bool mapped)> build;
    Vec3 lamp;
    std::vector<Method> methods;
    bool can_be_mapped = true;
    LightType light = LightType::point;
    float radius = 0.3f;  // of the lamp
};
// One surface of the casters; where `mapped`, by the normal map.
void add_surface(SceneMaker& maker, float half, const Graph& graph, const Transform& transform,
                 bool mapped) {
    maker.add(mapped ? mapped_square(half) : flat(square(half)),
              mapped ? normal_mapped(graph, Vec2(2.0f * half, 2.0f * half) * 0.6f) : graph,
              transform, CausticsRole::caster);
}
void add_slab(SceneMaker& maker, float top, bool mapped) {
    add_surface(maker, 2.5f, refraction(1.5f), translation({0, 0, top}), mapped);
    add_surface(maker, 2.5f, refraction(1.5f), rotation_x(kPi, {0, 0, top - 0.2f}), false);
}
// Upright, behind the part of the floor that is looked at.
void add_mirror(SceneMaker& maker, bool mapped) {
    add_surface(maker, 0.6f, mirror(), rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), mapped);
}

std::vector<ChainCase> chain_cases() {
    const Vec3 above(0.2f, -0.3f, 1.9f);
    return {
        {"R", [](SceneMaker& m, bool mapped) { add_mirror(m, mapped); }, above, {kWalks, kSheets}},
        {"T",
         [](SceneMaker& m, bool mapped) {
             add_surface(m, 2.5f, refraction(1.4f), translation({0, 0, 0.7f}), mapped);
         },
         above,
         {kWalks, kSheets}},
        {"RT",
         [](SceneMaker& m, bool mapped) {
             add_mirror(m, false);
             add_surface(m, 2.5f, refraction(1.3f), translation({0, 0, 1.45f}), mapped);
             // Nothing comes to the floor but by the mirror.
             m.add(square(0.9f), diffuse(0.0f), translation({0, -0.6f, 1.2f}), CausticsRole::off);
         },
         above,
         {kSheets}},
        {"TT", [](SceneMaker& m, bool mapped) { add_slab(m, 0.8f, mapped); }, above, {kSheets}},
        {"TRT",
         [](SceneMaker& m, bool mapped) {
             add_mirror(m, false);
             add_surface(m, 0.75f, refraction(1.4f), rotation_x(0.5f * kPi, {0, 1.0f, 0.8f}),
                         mapped);
         },
         above,
         {kSheets}},
        // Half of the light is reflected at each interaction, outside and inside.
        {"R, TT and TRT of a ball",
         [](SceneMaker& m, bool) {
             m.add(sphere(32, 0.5), combined(mirror(), refraction(1.5f), 0.5f),
                   translation({0.0f, 0.9f, 0.6f}), CausticsRole::caster);
         },
         {0.1f, -0.4f, 1.3f},
         {kSheets},
         false},
        {"TTTT",
         [](SceneMaker& m, bool mapped) {
             add_slab(m, 0.5f, false);
             add_slab(m, 1.0f, mapped);
         },
         above,
         {kSheets}}};
}

// ---- rough vertices

// Roughness 0.2 and 0.15: lobes of 0.04 and 0.0225 rad.
std::vector<ChainCase> rough_chain_cases() {
    const Vec3 above(0.2f, -0.3f, 1.9f);
    const Graph metal = mirror(0.2f), frosted = refraction(1.4f, 0.15f);
    const auto beckmann = [](Graph graph) {
        graph.options.push_back({1, "distribution", "BECKMANN"});
        return graph;
    };
    const Method single{"walks", ChainFinder::walks, 1, 30000},
        any{"sheets", ChainFinder::sheets, kLongestManifoldChain, 60000};
    return {
        {"rough R",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, metal, rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
         },
         above,
         {single},
         false},
        {"rough R, Beckmann",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, beckmann(metal), rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
         },
         above,
         {single},
         false},
        // What its diffuse part scatters is path tracing's.
        {"rough R of a mixture",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, combined(metal, diffuse(0.7f), 0.5f),
                         rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
         },
         above,
         {single},
         false},
        {"rough T",
         [=](SceneMaker& m, bool) {
             add_surface(m, 2.5f, frosted, translation({0, 0, 0.7f}), false);
         },
         above,
         {any}},
        {"rough T, T",
         [=](SceneMaker& m, bool) {
             add_surface(m, 2.5f, frosted, rotation_x(kPi, {0, 0, 0.6f}), false);
             add_surface(m, 2.5f, refraction(1.4f), translation({0, 0, 0.8f}), false);
         },
         above,
         {any}},
        {"T, rough T",
         [=](SceneMaker& m, bool) {
             add_surface(m, 2.5f, refraction(1.4f), rotation_x(kPi, {0, 0, 0.6f}), false);
             add_surface(m, 2.5f, frosted, translation({0, 0, 0.8f}), false);
         },
         above,
         {any},
         false,
         LightType::point,
         0.2f},
        {"rough T, rough R, rough T",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, metal, rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
             add_surface(m, 0.75f, frosted, rotation_x(0.5f * kPi, {0, 1.0f, 0.8f}), false);
         },
         above,
         {any},
         false},
        // Half of the light passes the pane straight on.
        {"rough R behind a pane",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, metal, rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
             add_surface(m, 0.75f, combined(metal, transparent(1.0f), 0.5f),
                         rotation_x(0.5f * kPi, {0, 1.0f, 0.8f}), false);
         },
         above,
         {any},
         false},
        // Next event estimation finds lights without size at rough vertices.
        {"rough R of a point",
         [=](SceneMaker& m, bool) {
             add_surface(m, 0.6f, metal, rotation_x(0.5f * kPi, {0, 1.1f, 0.8f}), false);
         },
         above,
         {single},
         false,
         LightType::point,
         0.0f},
        {"rough T of a sun without a disc",
         [=](SceneMaker& m, bool) {
             add_surface(m, 2.5f, refraction(1.4f, 0.28f), translation({0, 0, 0.7f}), false);
         },
         above,
         {any},
         false,
         LightType::sun,
         0.0f},
        {"rough ball",
         [=](SceneMaker& m, bool) {
             m.add(sphere(32, 0.5), combined(metal, refraction(1.5f, 0.2f), 0.5f),
                   translation({0.0f, 0.9f, 0.6f}), CausticsRole::caster);
         },
         {0.1f, -0.4f, 1.3f},
         {any},
         false}};
}

RenderScene make(const ChainCase& c, bool mapped) {
    SceneMaker maker;
    add_floor(maker);
    add_waves(maker, 0.1);
    c.build(maker, mapped);
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = c.light;
    lamp.to_world = translation(c.lamp);
    lamp.power = Spectrum(100.0f);
    lamp.radius = c.radius;
    lamp.visibility = kNotDirectly;
    maker.builder.add_light(lamp);
    return maker.finish();
}

// Four blocks of the floor.
auto block_of(int block) {
    return [block](const Vec2& u) {
        constexpr float kSide = 0.3f;
        return Vec3(u.x - float(block % 2), u.y - float(block / 2), 0.0f) * kSide;
    };
}

void expect_agreement(const std::vector<ChainCase>& cases, bool mapped) {
    constexpr uint32_t kTruth = 200000;
    const double significance = sidak(kFamily, 4 * 11);
    for (const ChainCase& c : cases) {
        if (mapped && !c.can_be_mapped) continue;
        const RenderScene world = make(c, mapped);
        Floor by_path_tracing(world, nullptr);
        std::vector<MeanEstimate> truth;
        for (int block = 0; block < 4; ++block)
            truth.push_back(by_path_tracing.mean(block_of(block), kTruth, 1).radiance);
        for (const Method& method : c.methods) {
            Floor floor(world, &method);
            double radiance = 0.0, caustics = 0.0, variance = 0.0;  // of all blocks together
            for (int block = 0; block < 4; ++block) {
                const FloorMean found = floor.mean(block_of(block), method.samples, 2);
                EXPECT_TRUE(same_mean(found.radiance, truth[size_t(block)], significance))
                    << c.name << " by " << method.name << ", block " << block;
                radiance += found.radiance.mean();
                caustics += found.caustics.mean();
                variance += std::pow(found.radiance.standard_error(), 2) +
                            std::pow(truth[size_t(block)].standard_error(), 2);
            }
            // What five standard errors are of the manifold's share.
            const double notices = 5.0 * std::sqrt(variance) / caustics;
            std::cout << c.name << (mapped ? ", mapped," : "") << " by " << method.name
                      << ": the manifold finds " << caustics / radiance
                      << " of the light, an error is noticed from " << notices << std::endl;
            EXPECT_GT(caustics, 0.3 * radiance) << c.name;
            EXPECT_LT(notices, 0.25) << c.name;
        }
    }
}

TEST(ChainsSlow, OfSmoothCastersAgreeWithPathTracing) { expect_agreement(chain_cases(), false); }
TEST(ChainsSlow, OfNormalMappedCastersAgreeWithPathTracing) {
    expect_agreement(chain_cases(), true);
}
TEST(ChainsSlow, OfRoughCastersAgreeWithPathTracing) {
    expect_agreement(rough_chain_cases(), false);
}

}  // namespace
}  // namespace spc::test
