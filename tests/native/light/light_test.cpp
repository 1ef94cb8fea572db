// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/bench.h"
#include "support/chi_square.h"

#include <string>

namespace spc::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr double kSignificance = 0.01;  // of each test, over all of its comparisons
constexpr int64_t kSamples = 100000;
constexpr float kPower = 10.0f;
const Vec3 kOrigin(0, 0, 0), kUp(0, 0, 1);

// ---------------------------------------------------------------------------------------- samplers
// against densities

struct SamplerCase {
    std::string text;
    Lit lit;
    Vec3 p{0.0f};
    Vec3 peak{0.0f, 0.0f, 1.0f};  // where the density is
    double focus = 2;
};

Transform sheared() {
    Transform m;
    m.row = {Vec3(1.0f, 0.5f, 0), Vec3(0, 1.0f, 0), Vec3(0, 0, 1)};
    m.translation = {0, 0, 1};
    return m;
}

std::vector<SamplerCase> sampler_cases() {
    std::vector<SamplerCase> cases;
    const auto add = [&](const std::string& text, Lit lit, const Vec3& p = kOrigin,
                         const Vec3& peak = kUp, double focus = 2) {
        cases.push_back({text, std::move(lit), p, peak, focus});
    };
    constexpr auto kRectangle = AreaShape::rectangle;
    constexpr auto kEllipse = AreaShape::ellipse;
    add("sphere", lit_by({point_lamp(kPower, 0.4f)}));
    add("small sphere", lit_by({point_lamp(kPower, 0.02f)}), kOrigin, kUp, 5);
    add("sphere, just outside", lit_by({point_lamp(kPower, 0.99f)}), kOrigin, kUp, 1);
    add("sphere, inside", lit_by({point_lamp(kPower, 3.0f)}), kOrigin, kUp, 1);
    add("spot of some radius", lit_by({spot_lamp(kPower, 0.3f, 1.5f, 0.3f, {0.3f, 0.1f, -1})}));
    add("narrow beam of a large spot",
        lit_by({spot_lamp(kPower, 0.7f, 0.5f, 0.5f, {0.3f, 0.1f, -1})}));
    add("beam of uneven scale",
        lit_by({spot_lamp(kPower, 0.7f, 0.5f, 0.5f, {0, 0.1f, -1}, {2, 1, 1.5f})}));
    add("disk that faces the receiver", lit_by({soft(point_lamp(kPower, 0.4f))}));
    add("disk that faces the receiver, small", lit_by({soft(point_lamp(kPower, 0.02f))}), kOrigin,
        kUp, 5);
    add("disk that faces the receiver, wide", lit_by({soft(point_lamp(kPower, 3.0f))}), kOrigin,
        kUp, 1);
    add("disk of a spot", lit_by({soft(spot_lamp(kPower, 0.3f, 1.5f, 0.3f, {0.3f, 0.1f, -1}))}));
    add("narrow beam of a large disk",
        lit_by({soft(spot_lamp(kPower, 1.7f, 0.5f, 0.5f, {0.3f, 0.1f, -1}))}));
    add("sun", lit_by({sun_lamp(3, 0.5f, {0.4f, 0.2f, -1})}), kOrigin,
        normalize(Vec3(-0.4f, -0.2f, 1)), 3);
    add("half a sky of sun", lit_by({sun_lamp(3, kPi)}), kOrigin, kUp, 1);
    add("square", lit_by({area_lamp(kPower, kRectangle, {1, 1})}));
    add("rectangle from the side",
        lit_by({area_lamp(kPower, kRectangle, {2, 0.5f}, {1, 0.5f, 1}, {0.5f, 0, -1})}), kOrigin,
        normalize(Vec3(1, 0.5f, 1)));
    add("rectangle, very near", lit_by({area_lamp(kPower, kRectangle, {2, 2}, {0.5f, 0, 0.05f})}),
        kOrigin, kUp, 1);
    add("rectangle, grazing", lit_by({area_lamp(kPower, kRectangle, {1, 1}, {2, 0, 0.2f})}),
        kOrigin, normalize(Vec3(2, 0, 0.2f)), 3);
    add("rectangle, far", lit_by({area_lamp(kPower, kRectangle, {0.1f, 0.1f}, {0, 0, 3})}), kOrigin,
        kUp, 5);
    add("rectangle, scaled and mirrored",
        lit_by({area_lamp(kPower, kRectangle, {1, 1}, {0, 0, 1}, {0.2f, 0, -1}, {-2, 0.7f, 1})}));
    add("disk", lit_by({area_lamp(kPower, kEllipse, {1, 1})}));
    add("ellipse from the side",
        lit_by({area_lamp(kPower, kEllipse, {2, 0.5f}, {1, 0.5f, 1}, {0.5f, 0, -1})}), kOrigin,
        normalize(Vec3(1, 0.5f, 1)));
    LightDesc shear = area_lamp(kPower, kRectangle, {1, 1});
    shear.to_world = sheared();
    add("parallelogram", lit_by({shear}));
    const Vec3 low(0, 0, 0.5f), leaning(0.1f, 0, -1);
    add("beam narrower than its square",
        lit_by({beam(area_lamp(kPower, kRectangle, {1, 1}, low, leaning), 1.0f)}));
    add("beam narrower than its ellipse",
        lit_by({beam(area_lamp(kPower, kEllipse, {2, 0.7f}, low, leaning), 1.2f)}));
    add("beam that covers half of a square",
        lit_by({beam(area_lamp(kPower, kRectangle, {0.6f, 0.6f}, {0.3f, 0, 1}), 0.9f)}));
    add("beam of a far square",
        lit_by({beam(area_lamp(kPower, kRectangle, {0.1f, 0.1f}, {0, 0, 3}, leaning), 0.6f)}),
        kOrigin, kUp, 5);
    add("beam of a parallelogram", lit_by({beam(shear, 0.7f)}));
    add("mesh", lit_by(square(0.5f), emission(1, 1, 1, 5),
                       facing({0.2f, 0, 1}, {0.3f, 0, -1}, {1.5f, 1, 1})));
    add("mesh from behind", lit_by(square(0.5f), emission(1, 1, 1, 5),
                                   facing({0.2f, 0, 1}, {0.3f, 0, 1}, {-1.5f, 1, 1})));
    SceneMaker all;
    for (const LightDesc& lamp :
         {point_lamp(20, 0.3f), sun_lamp(0.5f, 0.6f, {1, 0, -1}),
          area_lamp(kPower, kRectangle, {1, 1}, {-1, 0.5f, 1}), point_lamp(5, 0)})
        all.builder.add_light(lamp);
    all.add(square(0.3f), emission(1, 0.5f, 0.2f, 5), facing({0.3f, -1, 0.6f}, {0, 1, -1}));
    add("all together", freeze(all), kOrigin, kUp, 1);
    return cases;
}

std::optional<DirectSample> draw(const SamplerCase& c, Uniforms& uniforms) {
    return sample_direct(c.lit.lights, *c.lit.scene, c.p, uniforms.three());
}

// Counts of directions on a polar grid about c.peak, against the density at jittered points of
// finer cells: it has edges, which an adaptive quadrature's nodes straddle, and which may lie along
// the grid.
ChiSquare fit_density(const SamplerCase& c, uint64_t seed) {
    constexpr int kRings = 14, kSectors = 12, kFiner = 64;
    const Frame frame = Frame::around(c.peak);
    const auto polar = [&](double ring) { return kPiD * std::pow(ring / kRings, c.focus); };
    std::vector<int64_t> observed(kRings * kSectors + 1);
    Uniforms uniforms(seed);
    for (int64_t i = 0; i < kSamples; ++i) {
        const std::optional<DirectSample> s = draw(c, uniforms);
        if (!s || s->delta) {  // a delta's direction has no density
            ++observed.back();
            continue;
        }
        const Vec3 w = frame.to_local(s->wi);
        const double theta = std::atan2(std::hypot(w.x, w.y), w.z),
                     turn = std::atan2(w.y, w.x) / (2 * kPiD) + 0.5;
        const int ring =
            std::min(static_cast<int>(std::pow(theta / kPiD, 1 / c.focus) * kRings), kRings - 1);
        ++observed[ring * kSectors + std::min(static_cast<int>(turn * kSectors), kSectors - 1)];
    }
    std::vector<double> expected(observed.size());
    double integral = 0;
    for (int i = 0; i < kRings * kFiner; ++i) {
        const double theta0 = polar(double(i) / kFiner), theta1 = polar(double(i + 1) / kFiner);
        const double z0 = std::cos(theta0), z1 = std::cos(theta1);
        const double area = (z0 - z1) * 2 * kPiD / (kSectors * kFiner);
        for (int j = 0; j < kSectors * kFiner; ++j) {
            const double theta = std::acos(z0 + (z1 - z0) * uniforms());
            const double phi = 2 * kPiD * (j + double(uniforms())) / (kSectors * kFiner) - kPiD;
            const double share =
                look(c.lit, c.p, to_float(direction(frame, theta, phi))).pdf_direct * area;
            expected[i / kFiner * kSectors + j / kFiner] += static_cast<double>(kSamples) * share;
            integral += share;
        }
    }
    // The sum is good to some 1e-4: shares of declined samples below a percent are only checked for
    // being small.
    const double declined = static_cast<double>(observed.back()) / static_cast<double>(kSamples);
    EXPECT_NEAR(integral + declined, 1.0, 3e-3) << c.text;
    expected.back() = static_cast<double>(kSamples) * (declined < 0.01 ? declined : 1 - integral);
    ChiSquare fit = chi_square(observed, expected);
    fit.integral = integral;
    return fit;
}

TEST(Lights, SampleDirectHasItsDensity) {
    const std::vector<SamplerCase> cases = sampler_cases();
    const double significance = sidak(kSignificance, static_cast<int>(cases.size()));
    uint64_t seed = 0;
    for (const SamplerCase& c : cases) {
        const ChiSquare fit = fit_density(c, ++seed);
        EXPECT_TRUE(fit.passes(significance)) << c.text << ": " << fit.text();
    }
}

TEST(Lights, DensityOfASampleIsThatOfItsDirection) {
    for (const SamplerCase& c : sampler_cases()) {
        if (c.text == "all together") continue;  // overlapping lights share directions
        Uniforms uniforms(7);
        int compared = 0, different = 0;
        for (int i = 0; i < 20000; ++i) {
            const std::optional<DirectSample> s = draw(c, uniforms);
            if (!s) continue;
            const Seen seen = look(c.lit, c.p, s->wi);
            ++compared;
            const bool same = std::abs(seen.pdf_direct - s->density) <= 2e-3f * s->density &&
                              std::abs(seen.radiance.y - s->radiance.y) <= 2e-3f * s->radiance.y;
            if (!same) ++different;
            if (s->distance == kInfinity) continue;
            const Vec3 q = c.p + s->wi * s->distance;
            const std::optional<LightSurfaceHit> hit =
                c.lit.scene->lights.empty() ? std::nullopt
                                            : intersect_light(c.lit.scene->lights[0], {c.p, s->wi});
            if (hit) {
                EXPECT_NEAR(length(q - hit->p), 0.0f, 2e-3f * hit->t) << c.text;
            }
        }
        EXPECT_GT(compared, 1000) << c.text;
        EXPECT_LE(different, compared / 500) << c.text;  // directions along an edge miss by rounding
    }
}

TEST(Lights, ReceiversBehindAnAreaLightGetNothing) {
    const Lit lit = lit_by({area_lamp(kPower, AreaShape::rectangle, {1, 1})});
    Uniforms uniforms(1);
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(sample_direct(lit.lights, *lit.scene, Vec3(0.1f, 0.2f, 1.5f), uniforms.three()));
        EXPECT_FALSE(sample_direct(lit.lights, *lit.scene, Vec3(0.1f, 0.2f, 1.0f), uniforms.three()));
    }
}

// ----------------------------------------------------------------------- irradiance in closed form

// On the axis of a rectangle of half sides a, b at distance d, parallel to it.
double rectangle_irradiance(double radiance, double a, double b, double d) {
    const double x = a / d, y = b / d, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return radiance * 2 * (x / p * std::atan(y / p) + y / q * std::atan(x / q));
}
double disk_irradiance(double radiance, double r, double d) {
    return radiance * kPiD * r * r / (r * r + d * d);
}
double spot_profile(double cos, double angle, double blend) {
    const double cos_half = std::cos(angle / 2);
    const double t = std::clamp((cos - cos_half) / ((1 - cos_half) * blend), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

struct IrradianceCase {
    std::string text;
    Lit lit;
    double expected;
    double numerical_error = 2e-4;  // relative
    Vec3 n = kUp;
};

std::vector<IrradianceCase> irradiance_cases() {
    std::vector<IrradianceCase> cases;
    const auto add = [&](const std::string& text, Lit lit, double expected, double error = 2e-4,
                         const Vec3& n = kUp) {
        cases.push_back({text, std::move(lit), expected, error, n});
    };
    const double p = kPower;
    constexpr auto kRectangle = AreaShape::rectangle;
    constexpr auto kEllipse = AreaShape::ellipse;
    add("point", lit_by({point_lamp(kPower, 0)}), p / (4 * kPiD));
    add("point at 3 m", lit_by({point_lamp(kPower, 0, {0, 0, 3})}), p / (36 * kPiD));
    add("sphere", lit_by({point_lamp(kPower, 0.5f)}), p / (4 * kPiD));
    add("small sphere", lit_by({point_lamp(kPower, 1e-4f)}), p / (4 * kPiD));
    const Vec3 tilted = normalize(Vec3(0, 0.6f, 0.8f));
    add("sphere, tilted receiver", lit_by({point_lamp(kPower, 0.3f)}), 0.8 * p / (4 * kPiD), 2e-4,
        tilted);
    for (const double r : {0.02, 0.2, 0.4, 2.0})
        add((r > 1 ? "inside a disk's reach, " : "disk that faces the receiver, ") +
                std::to_string(r),
            lit_by({soft(point_lamp(kPower, static_cast<float>(r)))}), p / (4 * kPiD) / (1 + r * r));
    add("disk, tilted receiver", lit_by({soft(point_lamp(kPower, 0.3f))}),
        0.8 * p / (4 * kPiD) / 1.09, 2e-4, tilted);
    add("inside a sphere", lit_by({point_lamp(kPower, 2)}), p / (4 * kPiD * 4));
    add("spot on the axis", lit_by({spot_lamp(kPower, 0, 1, 0.15f)}), p / (4 * kPiD));
    for (const float off : {0.45f, 0.47f, 0.49f, 0.52f})
        add("spot off the axis by " + std::to_string(off),
            lit_by({spot_lamp(kPower, 0, 1, 0.15f, {0, std::sin(off), -std::cos(off)})}),
            p / (4 * kPiD) * spot_profile(std::cos(off), 1, 0.15));
    add("spot without blend",
        lit_by({spot_lamp(kPower, 0, 1, 0, {0, std::sin(0.49f), -std::cos(0.49f)})}),
        p / (4 * kPiD));
    add("half-space spot",
        lit_by({spot_lamp(kPower, 0, kPi, 0.5f, {0, std::sin(1.2f), -std::cos(1.2f)})}),
        p / (4 * kPiD) * spot_profile(std::cos(1.2), kPiD, 0.5));
    add("sun", lit_by({sun_lamp(3, 0)}), 3);
    add("sun of 60 degrees", lit_by({sun_lamp(3, 0, {0, std::sqrt(3.0f), -1})}), 1.5);
    for (const float angle : {1e-4f, 0.01f, 0.5f, 2.0f, kPi})
        add("sun of angle " + std::to_string(angle), lit_by({sun_lamp(3, angle)}), 3);
    add("square", lit_by({area_lamp(kPower, kRectangle, {1, 1})}),
        rectangle_irradiance(p / kPiD, 0.5, 0.5, 1));
    add("rectangle", lit_by({area_lamp(kPower, kRectangle, {2, 0.5f})}),
        rectangle_irradiance(p / kPiD, 1, 0.25, 1));
    add("far square", lit_by({area_lamp(kPower, kRectangle, {0.5f, 0.5f}, {0, 0, 20})}),
        rectangle_irradiance(p / (kPiD * 0.25), 0.25, 0.25, 20));
    add("square, scaled",
        lit_by({area_lamp(kPower, kRectangle, {1, 1}, {0, 0, 1}, {0, 0, -1}, {2, 3, 1})}),
        rectangle_irradiance(p / (6 * kPiD), 1, 1.5, 1));
    add("square, mirrored",
        lit_by({area_lamp(kPower, kRectangle, {1, 1}, {0, 0, 1}, {0, 0, -1}, {-2, 1, 1})}),
        rectangle_irradiance(p / (2 * kPiD), 1, 0.5, 1));
    add("disk", lit_by({area_lamp(kPower, kEllipse, {1, 1})}),
        disk_irradiance(p / (kPiD * kPiD * 0.25), 0.5, 1));
    const double ellipse = integrate_2d(
        [](double r, double phi) {
            const double x = r * std::cos(phi), y = 0.25 * r * std::sin(phi);
            return 0.25 * r / sqr(static_cast<float>(x * x + y * y + 1));
        },
        0, 1, 0, 2 * kPiD, 1e-7);
    add("ellipse", lit_by({area_lamp(kPower, kEllipse, {2, 0.5f})}),
        p / (kPiD * kPiD * 0.25) * ellipse);
    // A beam lights the receiver from a disk of radius tan h alone, 1 m above it.
    for (const double spread : {3.141, 2.5, 1.5, 0.9, 0.1, 0.01}) {
        const double half = spread / 2, tan_half = std::tan(half);
        const double from_disk =
            2 * kPiD / (tan_half - half) *
            integrate([&](double r) { return r * (tan_half - r) / std::pow(1 + r * r, 2); }, 0,
                      std::min(tan_half, 0.5), 1e-12);
        add((spread < 0.5 ? "narrow beam " : "beam ") + std::to_string(spread) + " of a disk",
            lit_by({beam(area_lamp(kPower, kEllipse, {1, 1}), static_cast<float>(spread))}),
            p / (kPiD * kPiD * 0.25) * from_disk);
    }
    add("mesh", lit_by(square(0.5f), emission(1, 1, 1, 5), facing({0, 0, 1}, {0, 0, 1})),
        rectangle_irradiance(5, 0.5, 0.5, 1));
    add("mesh, back side", lit_by(square(0.5f), emission(1, 1, 1, 5), facing({0, 0, 1}, {0, 0, -1})),
        rectangle_irradiance(5, 0.5, 0.5, 1));
    return cases;
}

TEST(Lights, IrradianceByNextEventEstimation) {
    const std::vector<IrradianceCase> cases = irradiance_cases();
    const double significance = sidak(kSignificance, static_cast<int>(cases.size()));
    for (const IrradianceCase& c : cases) {
        const MeanEstimate e = irradiance_direct(c.lit, kOrigin, c.n, 4 * kSamples, 11);
        EXPECT_TRUE(is_mean(e, c.expected, significance, c.numerical_error * c.expected)) << c.text;
        if (c.expected == 0) continue;
        EXPECT_FALSE(is_mean(e, 1.02 * c.expected, significance, c.numerical_error * c.expected))
            << c.text;
    }
}

TEST(Lights, IrradianceByPointsOfTheLight) {
    const std::vector<IrradianceCase> cases = irradiance_cases();
    const double significance = sidak(kSignificance, static_cast<int>(cases.size()));
    for (const IrradianceCase& c : cases) {
        if (c.text.starts_with("inside")) continue;  // the manifold sees spheres from outside alone
        if (c.text.starts_with("narrow")) continue;  // few points of the light have it
        const MeanEstimate e = irradiance_light_point(c.lit, kOrigin, c.n, 4 * kSamples, 12);
        EXPECT_TRUE(is_mean(e, c.expected, significance, c.numerical_error * c.expected)) << c.text;
        if (c.expected == 0) continue;
        EXPECT_FALSE(is_mean(e, 1.02 * c.expected, significance, c.numerical_error * c.expected))
            << c.text;
    }
}

// What Cycles 5.0.1 shows on a white diffuse plane (its pixel times pi), 2048 samples a pixel.
TEST(Lights, MatchCycles) {
    const auto off_axis = [](float off) { return Vec3(0, std::sin(off), -std::cos(off)); };
    struct Case {
        std::string text;
        LightDesc lamp;
        double irradiance;
    };
    const std::vector<Case> cases = {
        {"sphere", point_lamp(kPower, 0.5f), 0.795774},
        {"inside", point_lamp(kPower, 2), 0.198939},
        {"disk", soft(point_lamp(kPower, 0.5f)), 0.636620},
        {"wide disk", soft(point_lamp(kPower, 2)), 0.159155},
        {"spot 0.49", spot_lamp(kPower, 0, 1, 0.15f, off_axis(0.49f)), 0.132230},
        {"spot blend 1", spot_lamp(kPower, 0, 1, 1, off_axis(0.4f)), 0.229840},
        {"spot 2.5", spot_lamp(kPower, 0, 2.5f, 0.5f, off_axis(0.9f)), 0.771158},
        {"spot of uneven scale", spot_lamp(kPower, 0, 1, 0.8f, off_axis(0.3f)), 0.708334},
        {"sun", sun_lamp(3, 0.5f), 3.0},
        {"square", area_lamp(kPower, AreaShape::rectangle, {1, 1}), 2.39469},
        {"ellipse", area_lamp(kPower, AreaShape::ellipse, {2, 0.5f}), 2.18352},
        {"scaled",
         area_lamp(kPower, AreaShape::rectangle, {1, 1}, {0, 0, 1}, {0, 0, -1}, {2, 3, 1}), 1.05847},
    };
    for (const Case& c : cases) {
        LightDesc lamp = c.lamp;
        if (c.text == "spot of uneven scale") {
            // Scaled by (2, 1, 1) in the axes of a lamp that is tilted about x.
            lamp.to_world = rotation_x(0.3f, {0, 0, 1});
            for (Vec3& row : lamp.to_world.row) row.x *= 2;
        }
        const MeanEstimate e = irradiance_direct(lit_by({lamp}), kOrigin, kUp, kSamples, 13);
        EXPECT_NEAR_REL(e.mean(), c.irradiance, 4 * e.standard_error() / c.irradiance + 3e-4)
            << c.text;
    }
}

// -------------------------------------------------------------------------------- choice of lights

TEST(Lights, WithoutPowerTheyAreNeverChosen) {
    LightDesc hidden = point_lamp(5, 0);
    hidden.visibility = kVisibleCamera | kVisibleShadow;
    LightDesc no_caustics = point_lamp(5, 0);
    no_caustics.feeds_caustics = false;
    const Lit lit = lit_by({point_lamp(0, 0.1f), point_lamp(1, 0), hidden, sun_lamp(0, 0),
                            no_caustics, area_lamp(0, AreaShape::ellipse, {1, 1})});
    Uniforms uniforms(1);
    std::vector<int> direct(6), caustic(6);
    for (int i = 0; i < 20000; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        ASSERT_TRUE(s);
        ++direct[s->light];
        ++caustic[sample_light_point(lit.lights, *lit.scene, uniforms.three())->light];
    }
    for (const int dark : {0, 2, 3, 5}) EXPECT_EQ(direct[dark] + caustic[dark], 0) << dark;
    EXPECT_GT(direct[1], 0);
    EXPECT_GT(direct[4], direct[1]);
    EXPECT_EQ(caustic[4], 0);
    EXPECT_EQ(caustic[1], 20000);
}

TEST(Lights, NoLightsNoSamples) {
    const Lit lit = lit_by(std::vector<LightDesc>{});
    EXPECT_FALSE(sample_direct(lit.lights, *lit.scene, kOrigin, {0.5f, 0.5f, 0.5f}));
    EXPECT_FALSE(sample_light_point(lit.lights, *lit.scene, {0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(lit.lights.count(), 0u);
    EXPECT_EQ(pdf_direct_world(lit.lights, kOrigin, kUp), 0.0f);
    EXPECT_EQ(pdf_light_point_world(lit.lights, kUp), 0.0f);
    EXPECT_TRUE(is_black(world_radiance(lit.lights, *lit.scene, kUp)));
}

TEST(Lights, DarkMeshesAreNoLightsAndLeaveTheirTrianglesAlone) {
    SceneMaker maker;
    maker.add(square(1), diffuse(0.5f));
    maker.add(square(1), emission(1, 1, 1, 0), translation({0, 0, 1}));
    Mesh two = square(1);  // one triangle shines, one does not
    two.slots = {0, 1};
    two.slot_count = 2;
    Instance instance;
    instance.mesh = maker.builder.add_mesh(two);
    instance.object_to_world = translation({0, 0, 2});
    instance.materials = {maker.builder.add_material(diffuse(0.5f)),
                          maker.builder.add_material(emission(1, 1, 1, 2))};
    maker.builder.add_instance(instance);
    const Lit lit = freeze(maker);
    ASSERT_EQ(lit.lights.emissive.size(), 1u);
    EXPECT_EQ(lit.lights.emissive_of_instance, (std::vector<uint32_t>{kNone, kNone, 0}));
    EXPECT_EQ(lit.lights.emissive[0].inv_area, (std::vector<float>{0.0f, 0.5f}));
    Uniforms uniforms(1);
    for (int i = 0; i < 1000; ++i) {
        const std::optional<LightPoint> y =
            sample_light_point(lit.lights, *lit.scene, uniforms.three());
        ASSERT_TRUE(y);
        EXPECT_EQ(y->surface.triangle, 1u);
        EXPECT_NEAR(y->pdf, 0.5f, 1e-6f);
        EXPECT_NEAR(length(surface_position(*lit.scene, y->surface) - y->p), 0.0f, 1e-6f);
    }
    EXPECT_EQ(pdf_light_point_surface(lit.lights, {2, 0, 0.2f, 0.2f}), 0.0f);
    EXPECT_EQ(pdf_light_point_surface(lit.lights, {0, 0, 0.2f, 0.2f}), 0.0f);
}

TEST(Lights, TrianglesAreChosenByFlux) {
    // Two materials of one mesh, a dim large triangle and a bright small one: irradiance is still
    // exact.
    SceneMaker maker;
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {2, 0, 0}, {2.1f, 0, 0}, {2, 0.1f, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    mesh.slots = {0, 1};
    mesh.slot_count = 2;
    Instance instance;
    instance.mesh = maker.builder.add_mesh(mesh);
    instance.object_to_world = translation({0, 0, 1});
    instance.materials = {maker.builder.add_material(emission(1, 1, 1, 1)),
                          maker.builder.add_material(emission(1, 1, 1, 1e3f))};
    maker.builder.add_instance(instance);
    const Lit lit = freeze(maker);
    EXPECT_NEAR(lit.lights.emissive[0].triangles.probability(1), 5.0 / 7.0, 1e-6);
    // E = integral of L cos^2 / d^2 over both triangles
    const auto over = [&](double x, double y, double leg, double radiance) {
        return integrate_2d(
            [&](double s, double t) {
                const double a = x + leg * s, b = y + leg * t * (1 - s), d2 = a * a + b * b + 1;
                return radiance * leg * leg * (1 - s) / (d2 * d2);
            },
            0, 1, 0, 1, 1e-8);
    };
    const double expected = over(-1, -1, 2, 1) + over(2, 0, 0.1, 1e3);
    EXPECT_TRUE(is_mean(irradiance_direct(lit, kOrigin, kUp, kSamples, 5), expected, kSignificance,
                        1e-4 * expected));
    EXPECT_TRUE(is_mean(irradiance_light_point(lit, kOrigin, kUp, kSamples, 6), expected,
                        kSignificance, 1e-4 * expected));
}

TEST(Lights, SpectrumOfTwelveOrdersOfMagnitude) {
    // Spheres, suns, areas and meshes of 1e-6 to 1e6 W, each of its own colour channel: every one
    // is found, nothing overflows, and the sum is right.
    std::vector<LightDesc> lamps;
    for (int i = -6; i <= 6; ++i) {
        const float power = std::pow(10.0f, static_cast<float>(i));
        lamps.push_back(point_lamp(power, 1e-3f));
        lamps.push_back(point_lamp(power, 0));
        lamps.push_back(sun_lamp(power, 0.01f));
        lamps.push_back(area_lamp(power, AreaShape::rectangle, {1e-3f, 1e-3f}));
    }
    lamps[0].power = {1e-6f, 0, 0};  // the only red one
    for (size_t i = 1; i < lamps.size(); ++i) lamps[i].power.x = 0;
    const Lit lit = lit_by(lamps);
    std::vector<int> chosen(lamps.size());
    Uniforms uniforms(3);
    for (int i = 0; i < 100000; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        if (!s) continue;
        ++chosen[s->light];
        ASSERT_TRUE(std::isfinite(s->density) && s->density > 0) << s->light;
        ASSERT_TRUE(std::isfinite(max_component(s->radiance))) << s->light;
    }
    for (size_t i = 0; i < lamps.size(); ++i)
        EXPECT_GT(chosen[i], 100) << i;  // a tenth of 1900 by the even share alone
    EXPECT_TRUE(is_mean(irradiance_direct(lit, kOrigin, kUp, kSamples, 4, 0), 1e-6 / (4 * kPiD),
                        kSignificance, 1e-10));
}

TEST(Lights, AThousandAreChosenByPowerAndDistance) {
    std::vector<LightDesc> lamps;
    Uniforms uniforms(1);
    double total = 0;
    for (int i = 0; i < 1000; ++i) {
        lamps.push_back(point_lamp(uniforms(), 0, {uniforms(), uniforms(), 1}));
        total += lamps.back().power.y;
    }
    const Lit lit = lit_by(lamps);
    double expected = 0;
    for (const LightDesc& lamp : lamps) {
        const Vec3 d = lamp.position();
        expected += lamp.power.y / (4 * kPiD) * d.z / std::pow(length_squared(d), 1.5);
    }
    const MeanEstimate direct = irradiance_direct(lit, kOrigin, kUp, kSamples, 2),
                       light_point = irradiance_light_point(lit, kOrigin, kUp, kSamples, 2);
    EXPECT_TRUE(is_mean(direct, expected, kSignificance));
    EXPECT_TRUE(is_mean(light_point, expected, kSignificance));
    // The one knows how far away the lamps are, the other chooses by their power.
    EXPECT_LT(direct.standard_error(), 0.6 * light_point.standard_error());
    for (size_t i = 0; i < lamps.size(); ++i)
        EXPECT_NEAR(lit.lights.caustic_selection.probability(i),
                    0.8 * lamps[i].power.y / total + 0.2 / 1000, 1e-6);
}

TEST(Lights, DeltasHaveNoDensityAndNoSurface) {
    const Lit lit = lit_by({point_lamp(1, 0), sun_lamp(1, 0), spot_lamp(1, 0, 1, 0.1f)});
    EXPECT_TRUE(lit.lights.disc_suns.empty());
    for (uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(pdf_direct_lamp(lit.lights, kOrigin, kUp, {1, i, {}}), 0.0f);
        EXPECT_EQ(pdf_light_point_lamp(lit.lights, {1, i, {}}), 0.0f);
        EXPECT_TRUE(is_black(lamp_radiance(lit.lights.lamps[i], {0, 0, 1}, {0, 0, -1})));
    }
    Uniforms uniforms(1);
    for (int i = 0; i < 100; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, kOrigin, uniforms.three());
        ASSERT_TRUE(s);
        EXPECT_TRUE(s->delta);
        EXPECT_EQ(s->density, lit.lights.tree.probability(s->light, kOrigin));
        const std::optional<LightPoint> y =
            sample_light_point(lit.lights, *lit.scene, uniforms.three());
        ASSERT_TRUE(y);
        EXPECT_TRUE(y->delta);
        EXPECT_EQ(y->distant, y->light == 1);
        EXPECT_EQ(y->pdf, lit.lights.caustic_selection.probability(y->light));
    }
}

TEST(Lights, VisibilityIsTheirsAndOnlyLampsCanDoWithoutShadows) {
    SceneMaker maker;
    LightDesc lamp = point_lamp(1, 0);
    lamp.visibility = kVisibleDiffuse;
    maker.builder.add_light(lamp);
    Instance instance;
    instance.mesh = maker.builder.add_mesh(square(1));
    instance.materials = {maker.builder.add_material(emission(1, 1, 1, 1))};
    instance.visibility = kVisibleGlossy;
    maker.builder.add_instance(instance);
    maker.builder.set_environment(
        {maker.builder.add_material(background(1, 1, 1)), kVisibleTransmission, true});
    const Lit lit = freeze(maker);
    EXPECT_EQ(lit.lights.count(), 3u);
    EXPECT_EQ(light_visibility(lit.lights, 0), kVisibleDiffuse);
    EXPECT_EQ(light_visibility(lit.lights, 1), kVisibleGlossy | kVisibleShadow);
    EXPECT_EQ(light_visibility(lit.lights, 2), kVisibleTransmission | kVisibleShadow);
}

TEST(Lights, PointsOfTheLightHaveTheDensityOfAHit) {
    for (const SamplerCase& c : sampler_cases()) {
        if (c.text == "all together" || c.text == "sphere, inside" ||
            c.text == "sphere, just outside" || c.text.find("disk") == 0 ||
            c.text.find("large disk") != std::string::npos)
            continue;
        Uniforms uniforms(9);
        int compared = 0, different = 0;
        for (int i = 0; i < 5000; ++i) {
            const std::optional<LightPoint> y =
                sample_light_point(c.lit.lights, *c.lit.scene, uniforms.three());
            ASSERT_TRUE(y) << c.text;
            const Vec3 wi = y->distant ? y->direction : normalize(y->p - c.p);
            if (!y->distant) {
                EXPECT_NEAR(length(y->n), 1.0f, 1e-5f) << c.text;
            }
            const Seen seen = look(c.lit, c.p, wi);
            if (!y->distant && c.text.find("mesh") == std::string::npos && dot(y->n, wi) > -1e-3f)
                continue;  // other side
            ++compared;
            if (std::abs(seen.pdf_light_point - y->pdf) > 1e-4f * y->pdf) ++different;
        }
        EXPECT_GT(compared, 500) << c.text;
        EXPECT_LE(different, compared / 100) << c.text;
    }
}

}  // namespace
}  // namespace spc::test
