// SPDX-License-Identifier: GPL-3.0-or-later
// The manifold without light paths, for each kind of chain: a sphere under a sun against what its
// mapping of impact parameters to the floor makes of the light, the rest against path tracing.
#include "integrator/chain_cases.h"
#include "support/power.h"
#include "support/truths.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

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

struct ChainCase {
    ChainScene scene;
    std::vector<Method> methods;
    LightType light = LightType::point;
    float radius = 0.3f;  // of the lamp
};

std::vector<ChainCase> chain_cases() {
    std::vector<ChainCase> cases;
    // Of longer chains walks leave most light to path tracing, where it finds the lamp.
    for (const ChainScene& scene : chain_scenes())
        cases.push_back(
            {scene, scene.interactions == 1 ? std::vector{kWalks, kSheets} : std::vector{kSheets}});
    return cases;
}

// ---- rough vertices

// Roughness 0.2 and 0.15: lobes of 0.04 and 0.0225 rad.
const Graph kMetal = mirror(0.2f), kFrosted = refraction(1.4f, 0.15f);
Graph beckmann(Graph graph) {
    graph.options.push_back({1, "distribution", "BECKMANN"});
    return graph;
}
constexpr Method kRoughWalks{"walks", ChainFinder::walks, kLongestManifoldChain, 30000},
    kRoughSheets{"sheets", ChainFinder::sheets, kLongestManifoldChain, 80000};

using Build = std::function<void(SceneMaker&)>;
ChainCase rough(const char* name, const Method& method, const Build& build) {
    return {{name, 1, [build](SceneMaker& m, Reliefs) { build(m); }}, {method}};
}
void add_pane(SceneMaker& maker, float z, const Graph& graph) {
    add_surface(maker, 2.5f, graph, translation({0, 0, z}));
}
// Whose back is above.
void add_pane_over_glass(SceneMaker& maker, float z, const Graph& graph) {
    add_surface(maker, 2.5f, graph, rotation_x(kPi, {0, 0, z}));
}

std::vector<ChainCase> rough_reflections() {
    const auto off = [](const Graph& graph) {
        return [graph](SceneMaker& m) { add_mirror(m, Relief::none, graph); };
    };
    std::vector<ChainCase> cases{
        rough("rough R", kRoughWalks, off(kMetal)),
        rough("rough R, Beckmann", kRoughWalks, off(beckmann(kMetal))),
        // What its diffuse part scatters is path tracing's.
        rough("rough R of a mixture", kRoughWalks, off(combined(kMetal, diffuse(0.7f), 0.5f))),
        // Half of the light passes the pane straight on.
        rough("rough R behind a pane", kRoughSheets,
              [](SceneMaker& m) {
                  add_mirror(m, Relief::none, kMetal);
                  add_pane_before_mirror(m, combined(kMetal, transparent(1.0f), 0.5f));
              }),
        // Next event estimation finds lights without size at rough vertices.
        rough("rough R of a point", kRoughWalks, off(kMetal)),
        rough("rough T, rough R, rough T", kRoughSheets, [](SceneMaker& m) {
            add_mirror(m, Relief::none, kMetal);
            add_pane_before_mirror(m, kFrosted);
        })};
    cases[4].radius = 0.0f;
    const auto by_pane = [](const Graph& wall, const Graph& pane) {
        return [=](SceneMaker& m) {
            add_mirror(m, Relief::none, wall);
            add_pane_over_mirror(m, pane);
        };
    };
    cases.push_back(rough("rough R, T", kRoughSheets, by_pane(kMetal, refraction(1.3f))));
    cases.push_back(rough("R, rough T", kRoughSheets, by_pane(mirror(), refraction(1.3f, 0.15f))));
    cases.push_back(
        rough("rough R, rough T", kRoughSheets, by_pane(kMetal, refraction(1.3f, 0.15f))));
    return cases;
}

std::vector<ChainCase> rough_refractions() {
    const auto through = [](const Graph& graph) {
        return [graph](SceneMaker& m) { add_pane(m, 0.7f, graph); };
    };
    const auto pair = [](const Graph& below, const Graph& above) {
        return [=](SceneMaker& m) {
            add_pane_over_glass(m, 0.6f, below);
            add_pane(m, 0.8f, above);
        };
    };
    std::vector<ChainCase> cases{
        rough("rough T", kRoughSheets, through(kFrosted)),
        rough("rough T, Beckmann", kRoughSheets, through(beckmann(kFrosted))),
        rough("rough T, T", kRoughSheets, pair(kFrosted, refraction(1.4f))),
        rough("rough T, T, Beckmann", kRoughSheets, pair(beckmann(kFrosted), refraction(1.4f))),
        rough("rough T, rough T, Beckmann", kRoughSheets,
              pair(beckmann(kFrosted), beckmann(kFrosted))),
        rough("T, rough T", kRoughSheets, pair(refraction(1.4f), kFrosted)),
        rough("rough T of a sun without a disc", kRoughSheets, through(refraction(1.4f, 0.28f)))};
    cases[5].radius = 0.2f;
    cases[6].light = LightType::sun;
    cases[6].radius = 0.0f;
    return cases;
}

std::vector<ChainCase> rough_pairs_of_slabs() {
    const auto slabs = [](const std::array<Graph, 4>& from_below) {
        return [=](SceneMaker& m) {
            for (size_t i = 0; i < 4; i += 2) {
                const float z = 0.3f + 0.25f * float(i);
                add_pane_over_glass(m, z, from_below[i]);
                add_pane(m, z + 0.2f, from_below[i + 1]);
            }
        };
    };
    const Graph clear = refraction(1.4f), frosted = refraction(1.4f, 0.12f);
    std::vector<ChainCase> cases{
        rough("rough T, T, T, T", kRoughSheets, slabs({frosted, clear, clear, clear})),
        rough("T, T, rough T, T", kRoughSheets, slabs({clear, clear, frosted, clear})),
        rough("four times rough T", kRoughSheets, slabs({frosted, frosted, frosted, frosted}))};
    for (ChainCase& c : cases) c.radius = 0.2f;
    return cases;
}

ChainCase rough_ball() {
    ChainCase ball = rough("rough ball", kRoughSheets, [](SceneMaker& m) {
        add_for_light(m, sphere(32, 0.5), combined(kMetal, refraction(1.5f, 0.2f), 0.5f),
                      translation({0.0f, 0.9f, 0.6f}));
    });
    ball.scene.lamp = {0.1f, -0.4f, 1.3f};
    return ball;
}

std::vector<ChainCase> rough_reliefs() {
    constexpr Method kPatient{"sheets", ChainFinder::sheets, kLongestManifoldChain, 160000};
    const auto relieved = [](const char* name, const Method& method, const auto& build) {
        return ChainCase{{name, 1, build}, {method}};
    };
    return {relieved("rough R", kRoughWalks,
                     [](SceneMaker& m, Reliefs r) { add_mirror(m, r.one, kMetal); }),
            relieved("rough T, Beckmann", kRoughSheets,
                     [](SceneMaker& m, Reliefs r) {
                         add_surface(m, 2.5f, beckmann(kFrosted), translation({0, 0, 0.7f}), r.one);
                     }),
            relieved("rough T, R, rough T", kPatient,
                     [](SceneMaker& m, Reliefs r) {
                         add_mirror(m, r.others);
                         add_pane_before_mirror(m, kFrosted, r.one);
                     }),
            relieved("T, rough T", kPatient, [](SceneMaker& m, Reliefs r) {
                add_surface(m, 2.5f, kFrosted, translation({0, 0, 0.8f}), r.one);
                add_surface(m, 2.5f, refraction(1.4f), rotation_x(kPi, {0, 0, 0.6f}), r.others);
            })};
}

RenderScene make(const ChainCase& c, Reliefs reliefs) {
    SceneMaker maker;
    add_floor(maker);
    add_relief_image(maker, reliefs);
    c.scene.build(maker, reliefs);
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = c.light;
    lamp.to_world = translation(c.scene.lamp);
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

void expect_agreement(const std::vector<ChainCase>& cases, Reliefs reliefs = {}) {
    constexpr uint32_t kTruth = 200000;
    const uint32_t by_day = power(2, 1);  // fewer samples
    const double noticed = power(0.35, 0.25);
    const double significance = sidak(kFamily, 4 * 11);
    const bool smooth = reliefs.one == Relief::none && reliefs.others == Relief::none;
    for (const ChainCase& c : cases) {
        if (!smooth && !c.scene.has_relief) continue;
        const RenderScene world = make(c, reliefs);
        Floor by_path_tracing(world, nullptr);
        const Estimates expected = truth(
            fmt::format("{}, {} and {}", c.scene.name, to_string(reliefs.one),
                        to_string(reliefs.others)),
            kTruth, [&](uint32_t samples) {
                Estimates found;
                for (int block = 0; block < 4; ++block)
                    found.push_back(by_path_tracing.mean(block_of(block), samples, 1).radiance);
                return found;
            });
        for (const Method& method : c.methods) {
            Floor floor(world, &method);
            double radiance = 0.0, caustics = 0.0, variance = 0.0;  // of all blocks together
            for (int block = 0; block < 4; ++block) {
                const FloorMean found = floor.mean(block_of(block), method.samples / by_day, 2);
                EXPECT_TRUE(same_mean(found.radiance, expected[size_t(block)], significance))
                    << c.scene.name << " by " << method.name << ", block " << block;
                radiance += found.radiance.mean();
                caustics += found.caustics.mean();
                variance += std::pow(found.radiance.standard_error(), 2) +
                            std::pow(expected[size_t(block)].standard_error(), 2);
            }
            // What five standard errors are of the manifold's share.
            const double notices = 5.0 * std::sqrt(variance) / caustics;
            std::cout << c.scene.name << ", " << to_string(reliefs.one) << " and "
                      << to_string(reliefs.others) << ", by " << method.name
                      << ": the manifold finds " << caustics / radiance
                      << " of the light, an error is noticed from " << notices << std::endl;
            EXPECT_GT(caustics, 0.25 * radiance) << c.scene.name;
            EXPECT_LT(notices, noticed) << c.scene.name;
        }
    }
}

std::vector<ChainCase> of_kinds(const std::set<std::string>& names, const Method& method) {
    std::vector<ChainCase> cases = chain_cases();
    std::erase_if(cases, [&](const ChainCase& c) { return !names.contains(c.scene.name); });
    EXPECT_EQ(cases.size(), names.size());
    for (ChainCase& c : cases) c.methods = {method};
    return cases;
}

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

TEST(ChainsSlow, OfSmoothCastersAgreeWithPathTracing) { expect_agreement(chain_cases()); }
TEST(ChainsSlow, OfNormalMappedCastersAgreeWithPathTracing) {
    expect_agreement(of_kinds({"R", "T"}, kWalks), {Relief::normals});
    expect_agreement(of_kinds({"R", "T", "RT", "TT", "TRT", "TTTT"}, kSheets), {Relief::normals});
}
TEST(ChainsSlow, OfSeveralNormalMappedCastersAgreeWithPathTracing) {
    constexpr Method kPatient{"sheets", ChainFinder::sheets, kLongestManifoldChain, 40000};
    expect_agreement(of_kinds({"RT", "TRT"}, kPatient), {Relief::none, Relief::normals});
    expect_agreement(of_kinds({"RT", "TT", "TTTT"}, kPatient), {Relief::normals, Relief::normals});
}
TEST(ChainsSlow, OfBumpedCastersAgreeWithPathTracing) {
    expect_agreement(of_kinds({"R", "T"}, kWalks), {Relief::heights});
    expect_agreement(of_kinds({"R", "T", "RT", "TT"}, kSheets), {Relief::heights});
    expect_agreement(of_kinds({"TT"}, kSheets), {Relief::heights, Relief::heights});
}
TEST(ChainsSlow, OfRoughMirrorsAgreeWithPathTracing) { expect_agreement(rough_reflections()); }
TEST(ChainsSlow, ThroughRoughPanesAgreeWithPathTracing) { expect_agreement(rough_refractions()); }
TEST(ChainsSlow, ThroughRoughSlabsAgreeWithPathTracing) {
    expect_agreement(rough_pairs_of_slabs());
}
TEST(ChainsSlow, OfMappedRoughCastersAgreeWithPathTracing) {
    expect_agreement(rough_reliefs(), {Relief::normals});
    expect_agreement({rough_reliefs()[0], rough_reliefs()[1]}, {Relief::heights});
}
TEST(ChainsSlow, OfARoughBallAgreeWithPathTracing) { expect_agreement({rough_ball()}); }

}  // namespace
}  // namespace spc::test
