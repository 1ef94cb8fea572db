// SPDX-License-Identifier: GPL-3.0-or-later
// Closures without Smith facets: what they are sampled by, how much they scatter, and the formulas
// of their papers in terms of angles, in double.
#include "bsdf/closure.h"
#include "math/warp.h"
#include "support/chi_square.h"

#include <string>

namespace spc::test {
namespace {

const Vec3 kNormal = normalize(Vec3(0.3f, -0.5f, 0.8f));
constexpr float kDegree = kPi / 180.0f;

struct Case {
    std::string text;
    ClosureKind kind;
    bool reciprocal = true;
};

std::vector<Case> cases() {
    const Vec3 n = kNormal;
    const Vec3 tangent = Frame::around(n).x;
    std::vector<Case> all{
        {"translucent", Translucent{n}},
        {"rough 0.3", OrenNayar{n, 0.3f}},
        {"rough 1", OrenNayar{n, 1.0f}},
        {"rough 1, exchanging", OrenNayar{n, 1.0f, Spectrum(1.0f)}},
        {"sheen 0.1", Sheen{n, 0.1f}, false},
        {"sheen 0.5", Sheen{n, 0.5f}, false},
        {"sheen 1", Sheen{n, 1.0f}, false},
        {"velvet 0.3", Velvet{n, 0.3f}},
        {"velvet 1", Velvet{n, 1.0f}},
        {"Burley's base", BurleyDiffuse{n, 0.4f}},
        {"Schlick sheen", SchlickSheen{n}},
        {"diffuse toon", DiffuseToon{n, 40 * kDegree, 30 * kDegree}, false},
        {"soft diffuse toon", DiffuseToon{n, 30 * kDegree, 80 * kDegree}, false},
        {"glossy toon", GlossyToon{n, 4 * kDegree, 5 * kDegree}, false},
        {"Ashikhmin-Shirley 0.2", AshikhminShirley{n, 0.2f}},
        {"Ashikhmin-Shirley 0.2, 0.6", AshikhminShirley{n, 0.2f, 0.6f, tangent}},
    };
    return all;
}

Vec3 seen_from(double degrees) {
    return to_float(direction(Frame::around(kNormal), degrees * std::numbers::pi / 180, 0.7));
}

ClosureList list_of(const ClosureKind& kind, const Vec3& wo) {
    ClosureList list;
    list.add(Spectrum(1.0f), kind, wo, false);
    return list;
}

double f_cos(const ClosureKind& kind, const Vec3& wo, const Vec3& wi) {
    return static_cast<double>(eval(list_of(kind, wo), kNormal, wo, wi).f_cos.x);
}

// Hypothesis: sample() draws from eval()'s density. 5 % family.
TEST(DiffuseSlow, SamplersFollowTheirDensities) {
    const std::vector<Case> all = cases();
    const double significance = sidak(0.05, static_cast<int>(4 * all.size()));
    uint64_t seed = 300;
    for (const Case& c : all)
        for (const double degrees : {0.0, 40.0, 75.0, 88.0}) {
            const Vec3 wo = seen_from(degrees);
            const ClosureList list = list_of(c.kind, wo);
            Uniforms uniforms(seed++);
            const Vec3 mirrored = kNormal * (2.0f * dot(kNormal, wo)) - wo;
            const bool crosses = traits(c.kind).crosses;
            const ChiSquare fit = chi_square_sphere(
                SphereGrid{Frame::around(crosses ? wo * -1.0f : mirrored), 12, 16, 2}, 60000,
                [&]() -> std::optional<Vec3> {
                    const auto s = sample(list, kNormal, wo, uniforms.three());
                    if (!s) return std::nullopt;
                    return s->wi;
                },
                [&](const Vec3& wi) { return eval(list, kNormal, wo, wi).pdf_omega; });
            EXPECT_TRUE(fit.passes(significance))
                << c.text << " at " << degrees << ": " << fit.text();
        }
}

// What a closure scatters in all is the mean weight of its samples, and no more than came in.
TEST(Diffuse, SamplesBringWhatIsScattered) {
    uint64_t seed = 500;
    for (const Case& c : cases())
        for (const double degrees : {5.0, 50.0, 80.0}) {
            const Vec3 wo = seen_from(degrees);
            const ClosureList list = list_of(c.kind, wo);
            Uniforms uniforms(seed++);
            MeanEstimate mean;
            for (int i = 0; i < 40000; ++i) {
                const auto s = sample(list, kNormal, wo, uniforms.three());
                mean.add(s ? static_cast<double>(s->weight.x) : 0.0);
            }
            const bool glossy = traits(c.kind).reflected == BounceKind::glossy;
            const Vec3 middle = glossy ? kNormal * (2.0f * dot(kNormal, wo)) - wo : kNormal;
            const double scattered = integrate_sphere(
                Frame::around(middle), [&](const Vec3& wi) { return f_cos(c.kind, wo, wi); }, 1e-4);
            EXPECT_TRUE(is_mean(mean, scattered, sidak(0.01, 45), 2e-3)) << c.text << " " << degrees;
            EXPECT_LE(scattered, 1.0 + 2e-3) << c.text << " " << degrees;
        }
}

// Where albedo() claims to be exact.
TEST(Diffuse, AlbedosAreThoseOfTheLobes) {
    for (const float roughness : {0.2f, 1.0f})
        for (const float exchanged : {0.0f, 0.5f, 1.0f})
            for (const double degrees : {5.0, 50.0, 85.0}) {
                const Vec3 wo = seen_from(degrees);
                const ClosureKind kind = OrenNayar{kNormal, roughness, Spectrum(exchanged)};
                const double all = integrate_sphere(
                    Frame::around(kNormal), [&](const Vec3& wi) { return f_cos(kind, wo, wi); },
                    1e-5);
                EXPECT_NEAR(albedo(kind, wo).x, all, 2e-3) << roughness << " " << degrees;
                if (exchanged == 1.0f) {
                    EXPECT_NEAR(all, 1.0, 2e-3);  // a white wall keeps nothing
                }
            }
}

TEST(Diffuse, IsReciprocal) {
    for (const Case& c : cases()) {
        if (!c.reciprocal || traits(c.kind).crosses) continue;
        Uniforms uniforms(12);
        for (int i = 0; i < 200; ++i) {
            const Vec3 a = Frame::around(kNormal).to_world(cosine_hemisphere(uniforms.two())),
                       b = Frame::around(kNormal).to_world(cosine_hemisphere(uniforms.two()));
            const double there = f_cos(c.kind, a, b) / static_cast<double>(dot(kNormal, b)),
                         back = f_cos(c.kind, b, a) / static_cast<double>(dot(kNormal, a));
            EXPECT_NEAR(there, back, 1e-3 * (1 + back)) << c.text;
        }
    }
}

// [Fujii12]: f = (1 + sigma s / t) / (pi + (pi / 2 - 2 / 3) sigma), in angles.
TEST(Diffuse, RoughSurfacesMatchThePaper) {
    const Frame frame = Frame::around(kNormal);
    for (const double sigma : {0.2, 0.7, 1.0})
        for (const double to : {0.1, 0.8, 1.4})
            for (const double ti : {0.2, 0.9, 1.5})
                for (const double phi : {0.0, 1.0, 2.5}) {
                    const double s = std::sin(ti) * std::sin(to) * std::cos(phi);
                    const double t = s > 0 ? std::max(std::cos(ti), std::cos(to)) : 1;
                    const double expected =
                        (1 + sigma * s / t) /
                        (std::numbers::pi + (std::numbers::pi / 2 - 2.0 / 3) * sigma) * std::cos(ti);
                    const OrenNayar rough{kNormal, static_cast<float>(sigma)};
                    EXPECT_NEAR(f_cos(rough, to_float(direction(frame, to, 0)),
                                      to_float(direction(frame, ti, phi))),
                                expected, 1e-5);
                }
}

// [Ashikhmin00] with both exponents alike: the half-vector's density is that of a power of its
// cosine.
TEST(Diffuse, PhongLobesMatchThePaper) {
    const Frame frame = Frame::around(kNormal);
    for (const double alpha : {0.1, 0.5})
        for (const double to : {0.1, 0.8})
            for (const double ti : {0.15, 0.7})
                for (const double phi : {0.0, 0.4, 2.5}) {
                    const double n = 2 / (alpha * alpha) - 2;
                    const Vec3d o = direction(frame, to, 0),
                                i = direction(frame, ti, std::numbers::pi + phi);
                    const Vec3d h = normalize(o + i);
                    const Vec3d z(kNormal.x, kNormal.y, kNormal.z);
                    const double expected =
                        (n + 1) / (8 * std::numbers::pi) * std::pow(dot(z, h), n) /
                        (dot(o, h) * std::max(std::cos(to), std::cos(ti))) * std::cos(ti);
                    const AshikhminShirley lobe{kNormal, static_cast<float>(alpha)};
                    EXPECT_NEAR(f_cos(lobe, to_float(o), to_float(i)), expected,
                                2e-4 * (1 + expected));
                }
}

TEST(Diffuse, ToonsAreBrightWithinTheirCone) {
    const Vec3 wo = seen_from(30);
    const DiffuseToon hard{kNormal, 30 * kDegree, 0.0f}, toon{kNormal, 30 * kDegree, 20 * kDegree};
    EXPECT_NEAR(f_cos(hard, wo, seen_from(29)), 1 / (2 * std::numbers::pi * (1 - std::sqrt(0.75))),
                1e-5);
    EXPECT_EQ(f_cos(hard, wo, seen_from(31)), 0);
    const double bright = f_cos(toon, wo, seen_from(10));
    EXPECT_NEAR(bright, 1 / (2 * std::numbers::pi * (1 - std::cos(50 * std::numbers::pi / 180))),
                1e-5);
    EXPECT_NEAR(f_cos(toon, wo, seen_from(29)), bright, 1e-5);
    EXPECT_NEAR(f_cos(toon, wo, seen_from(40)), bright / 2, 1e-3);
    EXPECT_EQ(f_cos(toon, wo, seen_from(51)), 0);
}

TEST(Diffuse, TranslucentLightLeavesOnTheOtherSide) {
    const Vec3 wo = seen_from(30), through = kNormal * -1.0f;
    const ClosureList list = list_of(Translucent{kNormal}, wo);
    EXPECT_TRUE(has_smooth_transmission(list));
    EXPECT_NEAR(f_cos(Translucent{kNormal}, wo, through), 1 / std::numbers::pi, 1e-5);
    EXPECT_EQ(f_cos(Translucent{kNormal}, wo, kNormal), 0);
    const auto s = sample(list, kNormal, wo, Vec3(0.5f, 0.3f, 0.2f));
    ASSERT_TRUE(s);
    EXPECT_EQ(s->kind, BounceKind::transmission);
    EXPECT_FALSE(s->facets);
}

// A glossy toon is gone where caustics are switched off, what is diffuse stays.
TEST(Diffuse, CausticsAreOfWhatIsGlossy) {
    const Vec3 wo = seen_from(30);
    ClosureList list;
    const std::vector<Case> all = cases();
    for (auto c = all.rbegin(); c != all.rend() && list.count < kMaxClosures; ++c)
        list.add(Spectrum(1.0f), c->kind, wo, false);
    const auto count_of = [&](BounceKind kind) {
        int count = 0;
        for (int i = 0; i < list.count; ++i)
            count += traits(list.closures[i].kind).reflected == kind;
        return count;
    };
    const int diffuse = count_of(BounceKind::diffuse);
    ASSERT_GT(list.count, diffuse);
    drop_caustics(list, false, true);
    EXPECT_EQ(list.count, diffuse);
    EXPECT_EQ(count_of(BounceKind::diffuse), diffuse);
}

}  // namespace
}  // namespace spc::test
