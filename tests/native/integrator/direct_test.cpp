// SPDX-License-Identifier: GPL-3.0-or-later
// Direct light on a diffuse floor against closed forms and quadrature, and what may stand in its
// way.
#include "support/radiance.h"
#include "support/rough.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr float kAlbedo = 0.6f;
constexpr double kSignificance = 1e-5;
const Ray kAtOrigin = test::ray_to({2.0f, 0.5f, 1.0f}, {0.0f, 0.0f, 0.0f});

LightDesc lamp(LightType type, const Transform& transform = {}, float power = 10.0f) {
    LightDesc light;
    light.name = "lamp";
    light.type = type;
    light.to_world = transform;
    light.power = Spectrum(power);
    light.spot_angle = 1.0f;
    return light;
}

IntegratorSettings direct_only() {
    IntegratorSettings settings;
    settings.limits.total = 0;
    return settings;
}

RenderScene floor_under(const LightDesc& light) {
    SceneMaker maker;
    maker.add(test::square(10.0f), test::diffuse(kAlbedo));
    maker.builder.add_light(light);
    return maker.finish();
}

void expect_irradiance(const RenderScene& world, double irradiance, const char* what,
                       uint32_t samples = 4000) {
    const test::RadianceEstimate e = test::estimate(world, direct_only(), samples, kAtOrigin);
    const double expected = double(kAlbedo) * irradiance / std::numbers::pi;
    EXPECT_TRUE(test::is_mean(e.radiance, expected, kSignificance, 1e-4 * expected)) << what;
    EXPECT_LT(e.radiance.standard_error(), 0.02 * expected + 1e-12) << what << ": too little power";
}

TEST(DirectLight, PointAndSphereLampsFollowTheInverseSquare) {
    const Vec3 p(0.7f, -0.4f, 1.6f);
    const double d2 = double(length_squared(p)), cosine = double(p.z) / std::sqrt(d2);
    for (const float radius : {0.0f, 0.01f, 0.5f}) {
        LightDesc light = lamp(LightType::point, test::translation(p));
        light.radius = radius;
        // A sphere wholly above the horizon lights as its centre does.
        expect_irradiance(floor_under(light), 10.0 / (4.0 * std::numbers::pi) * cosine / d2,
                          "point");
    }
}

TEST(DirectLight, SunsAcrossTheirDirection) {
    const float tilt = 0.7f;
    for (const float angle : {0.0f, 0.01f, 0.6f}) {
        LightDesc light = lamp(LightType::sun, test::rotation_x(tilt), 3.0f);
        light.sun_angle = angle;
        // A disc of the sphere wholly above the horizon: its vector irradiance lies along its axis.
        expect_irradiance(floor_under(light), 3.0 * std::cos(double(tilt)), "sun");
    }
}

TEST(DirectLight, AreaLampsByQuadrature) {
    const Transform transform = test::rotation_x(0.5f, Vec3(0.3f, 0.2f, 1.2f));
    for (const AreaShape shape : {AreaShape::rectangle, AreaShape::ellipse}) {
        LightDesc light = lamp(LightType::area, transform);
        light.shape = shape;
        light.size = Vec2(0.8f, 1.4f);
        const double pi = std::numbers::pi, full = 0.8 * 1.4,
                     area = shape == AreaShape::rectangle ? full : full * pi / 4;
        const double radiance = 10.0 / (pi * area);
        const auto kernel = [&](double x, double y) {
            const Vec3d p(transform.point(Vec3(float(x), float(y), 0.0f)));
            const double d2 = dot(p, p);
            return radiance * p.z * dot(Vec3d(light.axis()), p * -1.0) / (d2 * d2);
        };
        const double irradiance =
            shape == AreaShape::rectangle
                ? test::integrate_2d(kernel, -0.4, 0.4, -0.7, 0.7, 1e-9)
                : test::integrate_2d(
                      [&](double r, double phi) {
                          return r * 0.4 * 0.7 *
                                 kernel(0.4 * r * std::cos(phi), 0.7 * r * std::sin(phi));
                      },
                      0, 1, 0, 2 * pi, 1e-9);
        expect_irradiance(floor_under(light), irradiance,
                          shape == AreaShape::rectangle ? "rectangle" : "ellipse");
    }
}

TEST(DirectLight, EmissiveMeshByQuadrature) {
    SceneMaker maker;
    maker.add(test::square(10.0f), test::diffuse(kAlbedo));
    const Transform transform = test::rotation_x(0.5f, Vec3(0.3f, 0.2f, 1.2f));
    maker.add(test::square(0.5f), test::emission(2.0f), transform);
    const Vec3d n(transform.vector(Vec3(0, 0, 1)));
    const double irradiance = test::integrate_2d(
        [&](double x, double y) {
            const Vec3d p(transform.point(Vec3(float(x), float(y), 0.0f)));
            return 2.0 * p.z * std::abs(dot(n, p)) / (dot(p, p) * dot(p, p));
        },
        -0.5, 0.5, -0.5, 0.5, 1e-9);
    expect_irradiance(maker.finish(), irradiance, "emissive square");
}

// A mesh of many panels, here a street of them, is as good as a mesh for each panel: what is near
// counts, not what has the most area. Drawn by area alone they have 25 times the variance.
TEST(DirectLight, PlacesOfAMeshAreAsGoodAsMeshes) {
    constexpr uint32_t kPanels = 60;
    const auto street = [](bool joined) {
        SceneMaker maker;
        maker.add(test::square(100.0f), test::diffuse(kAlbedo));
        Mesh all;
        for (uint32_t i = 0; i < kPanels; ++i) {
            const Vec3 at(3.0f * (float(i) - 15.0f), 0.4f, 0.5f);
            Mesh panel = test::square(0.05f);
            for (Vec3& p : panel.positions) p = p + at;
            if (!joined) maker.add(panel, test::emission(2.0f));
            const auto first = static_cast<uint32_t>(all.positions.size());
            for (const Vec3& p : panel.positions) all.positions.push_back(p);
            for (const auto& [a, b, c] : panel.triangles)
                all.triangles.push_back({a + first, b + first, c + first});
        }
        if (joined) maker.add(all, test::emission(2.0f));
        return maker.finish();
    };
    const auto of = [&](bool joined) {
        return test::estimate(street(joined), direct_only(), 8000, kAtOrigin).radiance;
    };
    const auto one = of(true), many = of(false);
    EXPECT_TRUE(test::is_mean(one, many.mean(), kSignificance, 3.0 * many.standard_error()));
    EXPECT_LT(one.standard_error(), 1.2 * many.standard_error());
    EXPECT_LT(many.standard_error(), 0.02 * many.mean());
}

TEST(DirectLight, UniformWorldAndItsSumWithALamp) {
    SceneMaker maker;
    maker.add(test::square(10.0f), test::diffuse(kAlbedo));
    test::set_world(maker, 0.7f);
    maker.builder.add_light(lamp(LightType::point, test::translation(Vec3(0, 0, 2))));
    expect_irradiance(maker.finish(), 0.7 * std::numbers::pi + 10.0 / (16.0 * std::numbers::pi),
                      "world and point");
}

// Hypothesis: what one bounce finds keeps the stratification of its random numbers. Four times the
// samples leave a quarter of the variance to independent ones, and to every roulette between.
TEST(DirectLight, FallsFasterThanIndependentSamples) {
    const auto sky = [](SceneMaker& maker, float sun) {
        constexpr uint32_t kWidth = 64, kHeight = 32;
        std::vector<float> texels(size_t{kWidth} * kHeight * 3);
        for (size_t i = 0; i < texels.size(); ++i)
            texels[i] = 0.5f + 0.5f * float(i / 3 / kWidth) / kHeight;
        for (size_t i = 0; i < 3; ++i) texels[(size_t{26} * kWidth + 27) * 3 + i] += sun;
        test::set_world(maker, texels, kWidth, kHeight);
    };
    for (const float sun : {0.0f, 1000.0f}) {  // by closures alone, and by the map of the world, too
        SceneMaker maker;
        maker.add(test::square(10.0f), test::diffuse(0.2f));
        sky(maker, sun);
        const RenderScene world = maker.finish();
        const auto variance = [&](uint32_t samples) {
            test::MeanEstimate pixels;
            PathStats stats;
            for (uint32_t pixel = 0; pixel < 400; ++pixel) {
                double sum = 0.0;
                for (uint32_t i = 0; i < samples; ++i)
                    sum += double(path_radiance(world, {}, {1, 1, 1}, kAtOrigin, Vec2(0.5f),
                                                Sampler(1, pixel, i), stats)
                                      .radiance.y);
                pixels.add(sum / samples);
            }
            return pixels.standard_error() * pixels.standard_error();
        };
        const double ratio = variance(16) / variance(64);
        // Known to a tenth. Roulette after the first bounce left 8 without a sun, densities
        // constant over texels 5 with one.
        EXPECT_GT(ratio, sun > 0.0f ? 7.0 : 12.0) << "sun " << sun;
    }
}

// ---- what stands in the way

// A sheet at z = 1 between the floor and what lights it from above; past its edges comes 1e-8 of a
// world's light.
RenderScene screened(const Graph& screen, const std::function<void(SceneMaker&)>& light,
                     uint32_t visibility = kVisibleAll, int sheets = 1) {
    SceneMaker maker;
    maker.add(test::square(10.0f), test::diffuse(kAlbedo));
    Instance sheet;
    sheet.name = "sheet";
    sheet.mesh = maker.builder.add_mesh(test::square(9000.0f));
    sheet.materials = {maker.builder.add_material(screen)};
    sheet.visibility = visibility;
    for (int i = 0; i < sheets; ++i) {
        sheet.object_to_world = test::translation(Vec3(0, 0, 1.0f + 0.01f * float(i)));
        maker.builder.add_instance(sheet);
    }
    light(maker);
    return maker.finish();
}
// From between floor and sheet.
const Ray kUnderSheet = test::ray_to({0.5f, 0.2f, 0.5f}, {0.0f, 0.0f, 0.0f});

void add_point(SceneMaker& maker) {
    maker.builder.add_light(lamp(LightType::point, test::translation(Vec3(0, 0, 2))));
}
void add_area(SceneMaker& maker) {
    maker.add_area_light(test::translation(Vec3(0, 0, 2)), 1.5f, 10.0f);
}
void add_world(SceneMaker& maker) { test::set_world(maker, 1.0f); }
void add_emitter(SceneMaker& maker) {
    maker.add(test::square(1.0f), test::emission(1.0f), test::translation(Vec3(0, 0, 2)));
}

struct Lighting {
    const char* name;
    void (*add)(SceneMaker&);
};
constexpr Lighting kLightings[] = {{"point", add_point},
                                   {"area", add_area},
                                   {"emissive mesh", add_emitter},
                                   {"uniform world", add_world}};

double mean_under(const RenderScene& world, const IntegratorSettings& settings, double& error) {
    const test::RadianceEstimate e = test::estimate(world, settings, 20000, kUnderSheet);
    error = e.radiance.standard_error();
    return e.radiance.mean();
}

TEST(TransparentShadows, TintWhatPasses) {
    const IntegratorSettings settings;
    for (const Lighting& light : kLightings) {
        double open_error, error;
        const double open =
            mean_under(screened(test::transparent(1.0f), light.add, 0), settings, open_error);
        for (const float tint : {1.0f, 0.5f, 0.0f}) {
            const double got =
                mean_under(screened(test::transparent(tint), light.add), settings, error);
            EXPECT_NEAR(got, double(tint) * open, 4.5 * std::hypot(error, open_error) + 1e-5)
                << light.name << ", tint " << tint;
        }
        // Half of the sheet is there; it is black.
        const double half = mean_under(
            screened(test::combined(test::transparent(1.0f), test::diffuse(0.0f), 0.5f), light.add),
            settings, error);
        EXPECT_NEAR(half, 0.5 * open, 4.5 * std::hypot(error, open_error) + 1e-5)
            << light.name << ", half";
    }
}

// A path at its last bounce still looks through what is transparent, as in Cycles.
TEST(TransparentShadows, DoNotCountAsTheLastBounce) {
    for (const Lighting& light : kLightings) {
        double open_error, error;
        const double open =
            mean_under(screened(test::transparent(1.0f), light.add, 0), direct_only(), open_error);
        const double got =
            mean_under(screened(test::transparent(1.0f), light.add), direct_only(), error);
        EXPECT_NEAR(got, open, 4.5 * std::hypot(error, open_error) + 1e-5) << light.name;
    }
}

// Shadow rays obey the limit that paths obey, or else their shares do not add up.
TEST(TransparentShadows, EndAtTheLimitOfTransparentBounces) {
    IntegratorSettings settings;
    settings.limits.transparent = 2;
    for (const Lighting& light : kLightings) {
        double open_error, error;
        const double open =
            mean_under(screened(test::transparent(1.0f), light.add, 0), settings, open_error);
        const double few = mean_under(screened(test::transparent(1.0f), light.add, kVisibleAll, 2),
                                      settings, error);
        EXPECT_NEAR(few, open, 4.5 * std::hypot(error, open_error) + 1e-5)
            << light.name << ", two sheets";
        const double many = mean_under(screened(test::transparent(1.0f), light.add, kVisibleAll, 6),
                                       settings, error);
        EXPECT_LT(many, 0.02 * open) << light.name << ", six sheets";  // a little comes around them
    }
}

TEST(Shadows, ObeyTheFlagsOfLampAndBlocker) {
    const IntegratorSettings settings = direct_only();
    double error;
    const double lit = mean_under(screened(test::diffuse(0.5f), add_point, 0), settings, error);
    EXPECT_GT(lit, 0.0);
    EXPECT_EQ(mean_under(screened(test::diffuse(0.5f), add_point), settings, error), 0.0);
    EXPECT_NEAR(
        mean_under(screened(test::diffuse(0.5f), add_point, kVisibleAll & ~uint32_t(kVisibleShadow)),
                   settings, error),
        lit, 1e-6);
    const auto shadowless = [](SceneMaker& maker) {
        LightDesc light = lamp(LightType::point, test::translation(Vec3(0, 0, 2)));
        light.visibility &= ~uint32_t(kVisibleShadow);
        maker.builder.add_light(light);
    };
    EXPECT_NEAR(mean_under(screened(test::diffuse(0.5f), shadowless), settings, error), lit, 1e-6);
}

// ---- transparent film

TEST(TransparentFilm, AlphaIsWhatHidesTheWorld) {
    IntegratorSettings settings;
    settings.transparent_film = true;
    const auto through = [&](const Graph& material, bool film) {
        SceneMaker maker;
        maker.add(test::square(1.0f), material);
        test::set_world(maker, 2.0f);
        IntegratorSettings own = settings;
        own.transparent_film = film;
        return test::estimate(maker.finish(), own, 20000,
                              test::ray_to({0.1f, 0.2f, 3.0f}, {0.1f, 0.2f, 0.0f}));
    };
    const test::RadianceEstimate solid = through(test::diffuse(0.0f), true);
    EXPECT_EQ(solid.alpha.mean(), 1.0);
    for (const float tint : {1.0f, 0.5f, 0.25f}) {
        const test::RadianceEstimate e = through(test::transparent(tint), true);
        EXPECT_TRUE(test::is_mean(e.alpha, 1.0 - double(tint), kSignificance, 1e-4))
            << "tint " << tint;
        EXPECT_EQ(e.radiance.mean(), 0.0);
        const test::RadianceEstimate opaque = through(test::transparent(tint), false);
        EXPECT_EQ(opaque.alpha.mean(), 1.0);
        EXPECT_TRUE(test::is_mean(opaque.radiance, 2.0 * double(tint), kSignificance, 1e-4))
            << "tint " << tint;
    }
    const test::RadianceEstimate half =
        through(test::combined(test::transparent(1.0f), test::diffuse(0.0f), 0.3f), true);
    EXPECT_TRUE(test::is_mean(half.alpha, 0.3, kSignificance, 1e-6));
    // Glass and mirrors show the world and hide it.
    for (const Graph& material : {test::glass(1.5f), test::mirror()}) {
        const test::RadianceEstimate e = through(material, true);
        EXPECT_EQ(e.alpha.mean(), 1.0);
        EXPECT_NEAR(e.radiance.mean(), 2.0, 1e-3);
    }
}

TEST(TransparentFilm, IsSeenThroughClearGlassWhereAsked) {
    IntegratorSettings settings;
    settings.transparent_film = settings.transparent_glass = true;
    const auto through = [&](float roughness) {
        SceneMaker maker;
        maker.add(test::square(1.0f),
                  roughness > 0.0f ? test::frosted_glass(roughness) : test::glass(1.5f));
        test::set_world(maker, 2.0f);
        return test::estimate(maker.finish(), settings, 20000,
                              test::ray_to({0.1f, 0.2f, 3.0f}, {0.1f, 0.2f, 0.0f}));
    };
    constexpr double kReflected = 0.04;
    const test::RadianceEstimate clear = through(0.0f);
    EXPECT_TRUE(test::is_mean(clear.alpha, kReflected, kSignificance, 1e-4));
    EXPECT_TRUE(test::is_mean(clear.radiance, 2.0 * kReflected, kSignificance, 1e-4));
    settings.transparent_glass_alpha = 0.2f;
    EXPECT_LT(through(0.4f).alpha.mean(), 0.1);
    EXPECT_EQ(through(0.5f).alpha.mean(), 1.0);
}

// ---- holdout

TEST(Holdout, IsAHoleWhereTheCameraSeesItAndNowhereElse) {
    const auto seen_by = [](const Vec3& from, const Vec3& to) {
        SceneMaker maker;
        maker.add(test::square(1.0f), test::mirror());
        maker.add(test::square(1.0f), test::emission(3.0f), test::translation(Vec3(0, 0, 5)));
        maker.builder.add_instance([&] {
            Instance hole;
            hole.mesh = 1;  // glows, too
            hole.materials = {1};
            hole.object_to_world = test::translation(Vec3(0, 0, 4));
            hole.holdout = true;
            return hole;
        }());
        return test::estimate(maker.finish(), {}, 100, test::ray_to(from, to));
    };
    const test::RadianceEstimate hole = seen_by({0, 0, 1}, {0.1f, 0.2f, 4});
    EXPECT_EQ(hole.alpha.mean(), 0.0);
    EXPECT_EQ(hole.radiance.mean(), 0.0);
    const test::RadianceEstimate mirrored = seen_by({0, 0, 1}, {0.1f, 0.2f, 0});
    EXPECT_EQ(mirrored.alpha.mean(), 1.0);
    EXPECT_NEAR(mirrored.radiance.mean(), 3.0, 1e-5);
}

// A scene far from the origin is lit as the same scene at the origin: glowing triangles do not
// block themselves, nor the floor itself. All vertices are numbers that both places can tell.
TEST(DirectLight, EmissiveMeshFarFromTheOrigin) {
    const auto lit_at = [](const Vec3& place) {
        SceneMaker maker;
        Transform floor = test::translation(place), tilted = floor;
        floor.row = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.5f, 0.25f, 1)};
        tilted.row = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.5f, 1, 1)};
        tilted.translation.z += 1.25f;
        maker.add(test::square(8.0f), test::diffuse(kAlbedo), floor);
        maker.add(test::square(0.5f), test::emission(2.0f), tilted);
        const Ray ray{place + Vec3(1.0f, 0.25f, 1.75f), normalize(Vec3(-1.0f, -0.25f, -1.75f)),
                      0.0f, kInfinity};
        return test::estimate(maker.finish(), direct_only(), 80000, ray).radiance;
    };
    const test::MeanEstimate near = lit_at(Vec3(0.0f));
    for (const Vec3& place : {Vec3(8192, 0, 0), Vec3(0, 0, 8192), Vec3(8192, -8192, 8192)}) {
        const test::MeanEstimate far = lit_at(place);
        const double error = std::hypot(near.standard_error(), far.standard_error());
        // Hits are 2^-10 m apart there, and light grows by a few thousandths over that.
        EXPECT_NEAR(far.mean(), near.mean(), 5.0 * error + 5e-3 * near.mean());
        EXPECT_LT(5.0 * error, 0.03 * near.mean()) << "too little power";
    }
}

// A lamp without shadow lights the floor as if nothing stood in between, by whichever rays.
TEST(DirectLight, LampsWithoutShadowShineThroughEverything) {
    const auto below = [](const LightDesc& light, bool blocked) {
        SceneMaker maker;
        maker.add(test::square(10.0f), test::diffuse(kAlbedo));
        if (blocked)
            maker.add(test::square(10.0f), test::diffuse(0.0f), test::translation(Vec3(0, 0, 1.2f)));
        maker.builder.add_light(light);
        return test::estimate(maker.finish(), direct_only(), 20000, kAtOrigin).radiance;
    };
    LightDesc sun = lamp(LightType::sun, {}, 3.0f), bulb = lamp(LightType::point),
              panel = lamp(LightType::area, test::translation(Vec3(0, 0, 2)));
    sun.sun_angle = 1.5f;
    bulb.to_world = test::translation(Vec3(0, 0, 3));
    bulb.radius = 1.4f;
    panel.size = Vec2(4.0f, 4.0f);
    for (const LightDesc& light : {sun, bulb, panel}) {
        LightDesc without = light;
        without.visibility = kVisibleAll & ~uint32_t{kVisibleShadow};
        const test::MeanEstimate free = below(light, false);
        for (const bool blocked : {false, true}) {
            const test::MeanEstimate e = below(without, blocked);
            const double error = std::hypot(e.standard_error(), free.standard_error());
            EXPECT_NEAR(e.mean(), free.mean(), 5.0 * error + 1e-5) << blocked;
            EXPECT_LT(5.0 * error, 0.05 * free.mean()) << "too little power";
        }
    }
}

}  // namespace
}  // namespace spc
