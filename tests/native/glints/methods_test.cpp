// SPDX-License-Identifier: GPL-3.0-or-later
// The methods that glints are compared with: against rays through the pixel, each of which looks
// the map up at one point, and against the search.
#include "support/glints.h"
#include "support/power.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::GlintFloor;
using test::MeanEstimate;
using test::SceneMaker;

constexpr double kFamily = 1e-3;  // probability that any comparison of a test fails by chance

// A floor, the pixels that look at it, and directions of light.
class Site {
public:
    explicit Site(const GlintFloor& floor) : world_(test::finish(floor, GlintsMode::on)) {
        for (const SlopeField& field : world_.glints.fields) flakes_.emplace_back(field, 2);
    }

    // The mean of f |cos| over the pixel around `centre`.
    double once(GlintSettings settings, const Vec2& centre, const Vec3& wi, uint64_t seed,
                GlintStats& stats) {
        settings.flakes = &flakes_;
        const PixelKernel pixel{&filter_, centre, Vec2(0.0f)};
        const Ray ray = camera().ray(centre.x, centre.y, Vec2(0.5f));
        const Hit hit = see(ray);
        const std::optional<GlintPoint> point =
            GlintPoint::at(world_.glints, settings, *world_.scene, surface_,
                           camera_differential(camera(), pixel, Vec2(0.5f), ray.direction),
                           static_cast<double>(hit.t), pixel);
        return mean_of(point->f_cos(wi, {8.0f}, mix_bits(seed), stats));
    }
    // Likewise, estimated so often.
    MeanEstimate by(const GlintSettings& settings, const Vec2& centre, const Vec3& wi,
                    uint32_t estimates, GlintStats& stats) {
        MeanEstimate result;
        for (uint32_t i = 0; i < estimates; ++i)
            result.add(once(settings, centre, wi, i + 1, stats));
        return result;
    }

    // By so many rays squared.
    double by_rays(const Vec2& centre, const Vec3& wi, int side) {
        double sum = 0.0;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const Vec2 at =
                    centre + filter_.sample((Vec2(float(x), float(y)) + Vec2(0.5f)) / float(side));
                see(camera().ray(at.x, at.y, Vec2(0.5f)));
                sum +=
                    mean_of(eval(surface_.closures, surface_.ng, surface_.wo, wi, kGlintsBit).f_cos);
            }
        return sum / (double(side) * side);
    }

    // The direction in which the interpolated normal would mirror the camera, and some around it.
    Vec3 light(uint64_t seed, float spread) {
        see(camera().ray(0.5f, 0.5f, Vec2(0.5f)));
        const Vec3 mirrored(-surface_.wo.x, -surface_.wo.y, surface_.wo.z);
        Pcg pcg(seed);
        return normalize(mirrored + (Vec3(pcg.one(), pcg.one(), 0.5f) - Vec3(0.5f)) * spread);
    }

    const RenderScene& world() const { return world_; }
    const FlakeSet& flakes() const { return flakes_; }

private:
    const Camera& camera() const { return world_.scene->camera; }
    static double mean_of(const Spectrum& c) { return static_cast<double>(mean(c)); }
    Hit see(const Ray& ray) {
        const Hit hit = *world_.scene->accel->intersect(ray, kVisibleCamera);
        evaluate_surface(*world_.scene, hit.surface, ray.direction * -1.0f, surface_);
        surface_.closures.glints_apart = true;
        return hit;
    }

    RenderScene world_;
    FlakeSet flakes_;
    PixelFilter filter_{FilterKind::blackman_harris, 1.5f};
    Surface surface_;
};

Graph glossy(float roughness, const char* distribution = "GGX", float repeat = 1.0f) {
    return test::normal_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}},
                            {{1, "distribution", distribution}}),
        {repeat, repeat});
}

std::function<void(SceneMaker&)> sun(float angle) {
    return [angle](SceneMaker& maker) {
        maker.builder.add_light(test::sun_towards({-0.5f, 0.2f, 1.0f}, angle, 1.0f));
    };
}

Image waves(double texels = 5.0) { return test::plane_normals(128, texels / 128, 0.2, 5); }
// Stairs whose slope is constant on each, as in files of 8 bits: walks have nothing to solve there.
Image stairs() {
    return test::normal_image(96, 96, [](double u, double v) {
        return Vec2(float(0.2 * std::floor(3.0 * std::sin(40.0 * u)) / 3.0),
                    float(0.2 * std::floor(3.0 * std::cos(50.0 * v)) / 3.0));
    });
}
Image flat() {
    return test::normal_image(64, 64, [](double, double) { return Vec2(0.05f, -0.03f); });
}

// Raised by waves of heights: slopes of 0.2 for a distance of 2 m.
Image heights(double texels = 5.0) { return test::plane_heights(128, 128, texels / 128, 0.2, 5); }
Graph raised(float roughness, float strength = 1.0f, float distance = 2.0f) {
    Graph graph = test::bump_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}}), {1, 1},
        distance);
    graph.inputs.push_back({2, "Strength", {strength, 0, 0, 0}});
    return graph;
}

GlintFloor floor_of(const Graph& graph, const Image& map, double pixel_texels) {
    return {graph, map, pixel_texels, 0.5f, sun(0.1f)};
}

const Vec2 kCentre(0.5f, 0.5f);

// Hypothesis: walks have the mean of rays, whose error is an order less than that of walks.
TEST(GlintWalksSlow, AgreeWithRays) {
    struct Case {
        const char* name;
        GlintFloor floor;
        uint32_t estimates = 40000;
    };
    const Graph plastic = test::normal_mapped(test::principled(0.3f, 0.25f), {1, 1});
    const std::vector<Case> cases{
        {"GGX", floor_of(glossy(0.3f), waves(), 6.0)},
        {"Beckmann", floor_of(glossy(0.3f, "BECKMANN"), waves(), 6.0)},
        {"narrow", floor_of(glossy(0.2f), waves(), 4.0)},
        {"several lobes", floor_of(plastic, waves(), 4.0)},
        {"stairs", floor_of(glossy(0.3f), stairs(), 6.0)},
        {"few texels", floor_of(glossy(0.3f), waves(), 1.5), 100000},
        {"bump", floor_of(raised(0.3f), heights(), 6.0)},
        {"weak bump", floor_of(raised(0.3f, 0.4f, 5.0f), heights(), 6.0)},
    };
    constexpr int kLights = 2;
    const double significance = test::sidak(kFamily, kLights * int(cases.size()));
    for (const Case& c : cases) {
        Site site(c.floor);
        for (uint64_t light = 1; light <= kLights; ++light) {
            const Vec3 wi = site.light(light, 0.3f);
            GlintStats stats;
            const uint32_t estimates = test::power(c.estimates / 2, c.estimates);
            const MeanEstimate walks = site.by({GlintMethod::walks}, kCentre, wi, estimates, stats);
            const double rays = site.by_rays(kCentre, wi, 300);
            const double z = (walks.mean() - rays) / walks.standard_error();
            EXPECT_GT(std::erfc(std::abs(z) / std::sqrt(2.0)), significance)
                << c.name << ": " << walks.mean() << " and " << rays << " +- "
                << walks.standard_error();
            EXPECT_LT(walks.standard_error(), test::power(0.07, 0.05) * rays)
                << c.name << ": too little power";
            // Solutions at the very edge of the filter, next to which no walk starts.
            EXPECT_LE(stats.capped, estimates / 10000) << c.name;
        }
    }
}

// Hypothesis: the search has the mean of rays on a bump. `excess`: of the relief that rays meet.
double z_of_search(float strength, float distance, float excess, uint64_t light) {
    constexpr uint32_t kEstimates = 45000;
    Site site(floor_of(raised(0.2f, strength, distance), heights(), 6.0));
    Site truth(floor_of(raised(0.2f, strength, distance * excess), heights(), 6.0));
    const Vec3 wi = site.light(light, 0.3f);
    GlintStats stats;
    const MeanEstimate search = site.by({GlintMethod::search}, kCentre, wi, kEstimates, stats);
    const double rays = truth.by_rays(kCentre, wi, 600);
    EXPECT_LT(search.standard_error(), 0.005 * rays) << "too little power";
    return (search.mean() - rays) / search.standard_error();
}
// Of every comparison: whole and weak bumps under several directions of light.
std::vector<double> all_z_of_search(float excess) {
    std::vector<double> all;
    for (const uint64_t light : {1u, 2u})
        for (const auto& [strength, distance] : {std::pair(1.0f, 2.0f), std::pair(0.4f, 5.0f)})
            all.push_back(z_of_search(strength, distance, excess, light));
    return all;
}
double least_p_value(const std::vector<double>& all) {
    double most = 0.0;
    for (const double z : all) most = std::max(most, std::abs(z));
    return std::erfc(most / std::sqrt(2.0));
}
TEST(GlintSearchSlow, AgreesWithRaysOnBumps) {
    const std::vector<double> all = all_z_of_search(1.0f);
    EXPECT_GT(least_p_value(all), test::sidak(kFamily, int(all.size())))
        << ::testing::PrintToString(all);
}
// Its twin: a relief that is 3 % higher.
TEST(GlintSearchSlow, NoticesALittleRelief) {
    const std::vector<double> all = all_z_of_search(1.03f);
    EXPECT_LT(least_p_value(all), test::sidak(kFamily, int(all.size())))
        << ::testing::PrintToString(all);
}

// Where there is nothing to solve for.
TEST(GlintWalks, LoseNothingOnAFlatMap) {
    Site site(floor_of(glossy(0.3f), flat(), 6.0));
    const Vec3 wi = site.light(1, 0.1f);
    for (const GlintMethod method : {GlintMethod::walks, GlintMethod::walks_biased}) {
        GlintStats stats;
        const double rays = site.by_rays(kCentre, wi, 50);
        EXPECT_NEAR(site.once({method}, kCentre, wi, 1, stats), rays, 1e-4 * rays);
    }
}

// In a picture, weights and all: under a sun and in a mirror.
TEST(GlintWalksSlow, AgreeWithPathTracing) {
    constexpr uint32_t kSamples = 60000, kReference = 400000;
    struct Case {
        const char* name;
        GlintFloor floor;
    };
    const std::vector<Case> cases{{"GGX", floor_of(glossy(0.3f), waves(), 6.0)},
                                  {"Beckmann", floor_of(glossy(0.3f, "BECKMANN"), waves(), 6.0)},
                                  {"bump", floor_of(raised(0.3f), heights(), 6.0)}};
    IntegratorSettings settings = test::unlimited();
    settings.glints.method = GlintMethod::walks;
    const double significance = test::sidak(kFamily, 2 * int(cases.size()));
    for (const Case& c : cases)
        for (const bool mirrored : {false, true}) {
            const auto on = test::estimate_pixel(test::finish(c.floor, GlintsMode::on, mirrored),
                                                 settings, kSamples, 1);
            const std::string name = std::string(c.name) + (mirrored ? ", in a mirror" : "");
            const auto off = test::path_traced_pixel(
                name, test::finish(c.floor, GlintsMode::off, mirrored), kReference, 2);
            const double error =
                std::hypot(on.radiance.standard_error(), off.radiance.standard_error());
            const double z = (on.radiance.mean() - off.radiance.mean()) / error;
            EXPECT_GT(std::erfc(std::abs(z) / std::sqrt(2.0)), significance)
                << name << ": " << on.radiance.mean() << " and " << off.radiance.mean() << " +- "
                << error;
            EXPECT_LT(error, 0.03 * on.radiance.mean()) << name << ": too little power";
            EXPECT_GT(on.stats.glints.estimates, kSamples / 3) << name;
        }
}

// More walks find more, and never more than there is.
TEST(GlintWalks, BiasedOnesConvergeFromBelow) {
    constexpr uint32_t kEstimates = 2000;
    Site site(floor_of(glossy(0.2f), waves(), 5.0));
    const Vec3 wi = site.light(1, 0.1f);
    const double rays = site.by_rays(kCentre, wi, 300);
    double before = 0.0;
    for (const uint32_t walks : {2u, 8u, 32u, 128u}) {
        GlintStats stats;
        const MeanEstimate found =
            site.by({GlintMethod::walks_biased, walks}, kCentre, wi, kEstimates, stats);
        EXPECT_GT(found.mean(), 1.2 * before) << walks;
        EXPECT_LT(found.mean(), rays + 4.0 * found.standard_error()) << walks;
        before = found.mean() / (walks == 32 ? 1.2 : 1.0);
    }
    EXPECT_GT(before, 0.9 * rays);
}

// How far Gaussians are from the truth, over many pixels and directions of light.
struct Deviation {
    double of_mean;   // relative
    double absolute;  // of single pixels, relative to the mean
};
Deviation deviation(Site& site, float spread, int count) {
    double truth = 0.0, flakes = 0.0, absolute = 0.0;
    Pcg pcg(3);
    for (int i = 0; i < count; ++i) {
        const Vec2 centre = kCentre + (pcg.two() - Vec2(0.5f)) * 6.0f;
        const Vec3 wi = site.light(static_cast<uint64_t>(i) + 1, spread);
        GlintStats stats;
        const double a = site.once({GlintMethod::yan}, centre, wi, 1, stats),
                     b = site.by_rays(centre, wi, 120);
        flakes += a;
        truth += b;
        absolute += std::abs(a - b);
    }
    return {flakes / truth - 1.0, absolute / truth};
}

TEST(Flakes, KeepTheLightOfALobeOnAFlatMap) {
    // What is beyond the reach of a Gaussian is lost.
    Site beckmann(floor_of(glossy(0.3f, "BECKMANN"), flat(), 6.0));
    EXPECT_LT(std::abs(deviation(beckmann, 0.1f, 50).of_mean), 0.01);
    Site ggx(floor_of(glossy(0.3f), flat(), 6.0));
    EXPECT_LT(deviation(ggx, 0.2f, 50).absolute, 0.12) << "as its Gaussians are fitted";
}

// A few percent: flakes are linear, lobes are Gaussians of small angles.
TEST(FlakesSlow, MeetTheTruthAsFarAsGaussiansDo) {
    for (const double texels : {5.0, 16.0})
        for (const char* distribution : {"BECKMANN", "GGX"}) {
            Site site(floor_of(glossy(0.3f, distribution), waves(texels), 6.0));
            const Deviation d = deviation(site, 0.5f, 100);
            EXPECT_LT(std::abs(d.of_mean), 0.03) << texels << " " << distribution;
            EXPECT_LT(d.absolute, 0.04) << texels << " " << distribution;
        }
    // Bumps bend within a cell, where flakes do not: for waves of 5 texels they are 7 % off.
    for (const Graph& bump : {raised(0.3f), raised(0.3f, 0.4f, 5.0f)}) {
        Site site(floor_of(bump, heights(16.0), 6.0));
        const Deviation d = deviation(site, 0.5f, 100);
        EXPECT_LT(std::abs(d.of_mean), 0.03) << "bump: " << d.of_mean;
        EXPECT_LT(d.absolute, 0.04) << "bump";
    }
}

// Beyond the number of flakes that are looked at, slopes are one Gaussian: of waves from all sides
// they are.
TEST(Flakes, ManyOfThemAreOneGaussian) {
    Site site(floor_of(glossy(0.3f, "BECKMANN", 10.0f), waves(16.0), 10.0));
    const Vec3 wi = site.light(1, 0.1f);
    GlintStats stats;
    const double flakes = site.once({GlintMethod::yan}, kCentre, wi, 1, stats);
    EXPECT_EQ(stats.points, 0u);
    EXPECT_NEAR(flakes / site.by_rays(kCentre, wi, 600), 1.0, 0.1);
}

TEST(Flakes, TakeLessThanTwentyBytesForEachTexel) {
    const Site site(floor_of(glossy(0.2f), waves(), 6.0));
    EXPECT_LT(site.flakes()[0].memory_bytes(), size_t{20} * 128 * 128);
    EXPECT_GT(site.flakes()[0].memory_bytes(), size_t{16} * 128 * 128);
}

// Each holds the slope and its derivatives in the middle of a cell.
TEST(Flakes, AreTheMapInTheMiddleOfCells) {
    const Site site(floor_of(glossy(0.2f), waves(), 6.0));
    const SlopeField& field = site.world().glints.fields[0];
    const FlakeField& flakes = site.flakes()[0];
    for (int i = 0; i < 200; ++i) {
        const int x = (37 * i) % flakes.width(), y = (61 * i) % flakes.height();
        const SlopePatch cell = field.cell(x, y);
        const SlopeJet flake = flakes.flake(x, y);
        constexpr float kStep = 1.0f / 64;
        const Vec2 by_s = (slope_at(cell, 0.5f + kStep, 0.5f) - slope_at(cell, 0.5f - kStep, 0.5f)) *
                          (0.5f / kStep),
                   by_t = (slope_at(cell, 0.5f, 0.5f + kStep) - slope_at(cell, 0.5f, 0.5f - kStep)) *
                          (0.5f / kStep);
        EXPECT_LT((flake.slope - slope_at(cell, 0.5f, 0.5f)).length(), 1e-6f);
        EXPECT_LT((flake.by_s - by_s).length(), 1e-3f);
        EXPECT_LT((flake.by_t - by_t).length(), 1e-3f);
    }
}

}  // namespace
}  // namespace spc
