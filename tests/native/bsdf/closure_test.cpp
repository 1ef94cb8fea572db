// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/closure.h"

#include "bsdf/fresnel.h"
#include "bsdf/reference.h"
#include "math/warp.h"
#include "support/chi_square.h"

#include <string>

namespace spc::test {
namespace {

constexpr auto kGgx = MicrofacetModel::ggx;
constexpr auto kBeckmann = MicrofacetModel::beckmann;
const Vec3 kNormal = normalize(Vec3(0.3f, -0.5f, 0.8f));
const Vec3 kTilted =
    normalize(Vec3(0.45f, -0.45f, 0.8f));  // a shading normal some 9 degrees off kNormal

MicrofacetReflection mirror(const Vec3& n, MicrofacetModel model, float alpha,
                            const Fresnel& f = {}) {
    return {n, alpha, model, f};
}
// Brushed along an axis across n that is some 40 degrees from that of Frame::around.
MicrofacetReflection brushed(const Vec3& n, MicrofacetModel model, float ax, float ay) {
    const Frame frame = Frame::around(n);
    MicrofacetReflection lobe = mirror(n, model, ax);
    lobe.alpha_y = ay;
    lobe.tangent = normalize(frame.x * 0.8f + frame.y * 0.6f);
    return lobe;
}
MicrofacetDielectric glass(const Vec3& n, MicrofacetModel model, float alpha, float eta) {
    return {n, alpha, model, eta, true, true, true, Spectrum(1.0f), Spectrum(1.0f)};
}
MicrofacetDielectric refraction(const Vec3& n, MicrofacetModel model, float alpha, float eta) {
    return {n, alpha, model, eta, false, true, false, Spectrum(0.0f), Spectrum(1.0f)};
}

// wo at a polar angle from n.
Vec3 outgoing(const Vec3& n, double degrees) {
    return to_float(direction(Frame::around(n), degrees * std::numbers::pi / 180, 0.7));
}

ClosureList list_of(const Vec3& wo, std::initializer_list<ClosureKind> kinds) {
    ClosureList list;
    for (const ClosureKind& kind : kinds) list.add(Spectrum(0.8f, 0.6f, 0.9f), kind, wo, true);
    return list;
}

std::string name(MicrofacetModel model) { return model == kGgx ? "GGX" : "Beckmann"; }

// ----------------------------------------------------------------------------------------------
// samplers

struct SamplerCase {
    std::string text;
    ClosureList list;
    Vec3 ng, wo, peak;
    double focus = 2;
};

std::vector<SamplerCase> sampler_cases() {
    std::vector<SamplerCase> cases;
    const Vec3 n = kNormal;
    const auto add = [&](const std::string& what, std::initializer_list<ClosureKind> kinds,
                         double degrees, bool transmits = false, double focus = 2,
                         const Vec3& geometric = kNormal) {
        const Vec3 wo = outgoing(geometric, degrees);
        const Vec3 peak = transmits ? -wo : facet::mirrored(wo, n, dot(wo, n));
        cases.push_back({what + " at " + std::to_string(degrees), list_of(wo, kinds), geometric, wo,
                         peak, focus});
    };
    for (const double degrees : {0.0, 50.0, 85.0, 89.9}) {
        add("Lambert", {Lambert{n}}, degrees, false, 1);
        for (const MicrofacetModel model : {kGgx, kBeckmann}) {
            for (const float alpha : {0.05f, 0.3f, 1.0f}) {
                const std::string text = name(model) + " alpha " + std::to_string(alpha);
                add(text + " reflection", {mirror(n, model, alpha)}, degrees);
                add(text + " glass 1.5", {glass(n, model, alpha, 1.5f)}, degrees, true);
                add(text + " glass 1/1.5", {glass(n, model, alpha, 1 / 1.5f)}, degrees, true);
            }
            add(name(model) + " refraction 1.33", {refraction(n, model, 0.2f, 1.33f)}, degrees,
                true);
            // At grazing angles this lobe is a sliver along the horizon, too thin for the grid's
            // quadrature.
            if (degrees < 85.1)
                add(name(model) + " refraction 1/1.33", {refraction(n, model, 0.2f, 1 / 1.33f)},
                    degrees, true);
            add(name(model) + " brushed", {brushed(n, model, 0.1f, 0.5f)}, degrees);
            add(name(model) + " brushed across", {brushed(n, model, 0.4f, 0.05f)}, degrees);
            add(name(model) + " narrow", {mirror(n, model, 0.003f)}, degrees, false, 5);
        }
        add("near index 1", {refraction(n, kGgx, 0.5f, 1.05f)}, degrees, true, 4);
        const Fresnel coat{Fresnel::Kind::dielectric, 1.5f, Spectrum(1.0f), Spectrum(1.0f)};
        add("coat over Lambert", {mirror(n, kGgx, 0.1f, coat), Lambert{n}}, degrees);
        add("all with other shading normals",
            {mirror(n, kGgx, 0.3f), Lambert{kTilted}, glass(kTilted, kGgx, 0.4f, 1.5f)}, degrees);
        add("below the geometry", {mirror(n, kGgx, 0.5f), glass(n, kBeckmann, 0.4f, 1.5f)}, degrees,
            false, 2, kTilted);
    }
    return cases;
}

ChiSquare fit(const SamplerCase& c, const ClosureList& sampled, int64_t samples, uint64_t seed) {
    Uniforms uniforms(seed);
    const SphereGrid grid{Frame::around(c.peak), 12, 16, c.focus};
    return chi_square_sphere(
        grid, samples,
        [&]() -> std::optional<Vec3> {
            const std::optional<ClosureSample> s = sample(sampled, c.ng, c.wo, uniforms.three());
            if (!s) return std::nullopt;
            return s->wi;
        },
        [&](const Vec3& wi) { return eval(c.list, c.ng, c.wo, wi).pdf_omega; });
}

// Hypothesis: sample() draws from eval()'s density and declines as often as that density leaves
// room. 5 % family.
TEST(ClosureSlow, SamplersFollowTheirDensities) {
    const std::vector<SamplerCase> cases = sampler_cases();
    const double significance = sidak(0.05, static_cast<int>(cases.size()));
    uint64_t seed = 100;
    for (const SamplerCase& c : cases) {
        const ChiSquare result = fit(c, c.list, 60000, seed++);
        EXPECT_TRUE(result.passes(significance)) << c.text << ": " << result.text();
        EXPECT_LE(result.integral, 1 + 1e-3) << c.text;
    }
}

// Power: roughness 5 % off in the sampler alone is found out.
TEST(Closure, ChiSquareFindsASamplerSkewedByFivePercent) {
    const Vec3 wo = outgoing(kNormal, 50);
    for (const MicrofacetModel model : {kGgx, kBeckmann}) {
        const SamplerCase c{"", list_of(wo, {mirror(kNormal, model, 0.3f)}),    kNormal,
                            wo, facet::mirrored(wo, kNormal, dot(wo, kNormal)), 2};
        EXPECT_TRUE(fit(c, c.list, 60000, 1).passes(1e-3));
        EXPECT_FALSE(
            fit(c, list_of(wo, {mirror(kNormal, model, 0.3f * 1.05f)}), 60000, 1).passes(1e-3));
    }
}

// A sample's weight and density are eval()'s at its direction, for its kind of scattering.
TEST(Closure, SampleAgreesWithEval) {
    Uniforms uniforms(11);
    for (const SamplerCase& c : sampler_cases())
        for (int i = 0; i < 50; ++i) {
            const std::optional<ClosureSample> s = sample(c.list, c.ng, c.wo, uniforms.three());
            if (!s) continue;
            ASSERT_FALSE(s->delta);
            const ClosureEval e = eval(c.list, c.ng, c.wo, s->wi, kind_bit(s->kind)),
                              all = eval(c.list, c.ng, c.wo, s->wi);
            EXPECT_EQ(s->pdf_omega, all.pdf_omega) << c.text;
            EXPECT_EQ(e.pdf_omega, all.pdf_omega) << c.text;
            EXPECT_EQ(all.pdf_of_kinds, all.pdf_omega) << c.text;
            EXPECT_LE(e.pdf_of_kinds, all.pdf_omega) << c.text;
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR_REL(s->weight[k] * e.pdf_of_kinds, e.f_cos[k], 1e-6);
            EXPECT_EQ(s->refracted, dot(c.ng, s->wi) < 0.0f) << c.text;
        }
}

// ----------------------------------------------------------------------------------------------
// values

TEST(Closure, EvalMatchesThePapers) {
    Uniforms uniforms(12);
    const Vec3d n = to_double(kNormal);
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
        const MicrofacetModel model = uniforms() < 0.5f ? kGgx : kBeckmann;
        const float alpha = std::pow(uniforms(), 2.0f) * 0.95f + 0.05f;
        const float eta = uniforms() < 0.5f ? 1.1f + uniforms() : 1 / (1.1f + uniforms());
        const Vec3 wo = Frame::around(kNormal).to_world(cosine_hemisphere(uniforms.two()));
        const Vec3 wi = uniform_sphere(uniforms.two());
        const auto f = [&](double c) { return reference_fresnel(c, eta); };
        const auto t = [&](double c) { return 1 - f(c); };
        const auto one = [](double) { return 1.0; };
        const auto once = [&](double c) { return f(c) < 1 ? 1.0 : 0.0; };
        const Vec3d o = to_double(wo), w = to_double(wi);
        const auto value = [&](const ClosureKind& kind) {
            ClosureList list;
            list.add(Spectrum(1.0f), kind, wo, false);
            return eval(list, kNormal, wo, wi).f_cos.x;
        };
        const auto compare = [&](double actual, double expected) {
            // Within rounding of total internal reflection, and far out in a tail, only the order
            // of magnitude is left.
            EXPECT_NEAR(actual, expected, 1e-3 * expected + 2e-4)
                << name(model) << " " << alpha << " " << eta;
            compared += expected > 1e-3;
        };
        const Fresnel dielectric{Fresnel::Kind::dielectric, eta, Spectrum(1.0f), Spectrum(1.0f)};
        compare(value(mirror(kNormal, model, alpha)),
                reference_reflection(model, alpha, n, o, w, one));
        compare(value(mirror(kNormal, model, alpha, dielectric)),
                reference_reflection(model, alpha, n, o, w, f));
        const MicrofacetReflection lobe = brushed(kNormal, model, alpha, 0.2f);
        const Frame frame{lobe.tangent, cross(kNormal, lobe.tangent), kNormal};
        const Vec3d ol = to_double(frame.to_local(wo)), wl = to_double(frame.to_local(wi));
        const auto lambda = [&](const Vec3d& d) {
            return reference_lambda(model, reference_alpha(alpha, 0.2, d), d.z);
        };
        compare(value(lobe), wl.z > 0 ? reference_d(model, alpha, 0.2, normalize(ol + wl)) /
                                            (4 * ol.z * (1 + lambda(ol) + lambda(wl)))
                                      : 0.0);
        compare(value(glass(kNormal, model, alpha, eta)),
                reference_reflection(model, alpha, n, o, w, f) +
                    reference_transmission(model, alpha, eta, n, o, w, t));
        compare(value(refraction(kNormal, model, alpha, eta)),
                reference_transmission(model, alpha, eta, n, o, w, once));
        compare(value(Lambert{kNormal}), std::max(dot(n, w), 0.0) / std::numbers::pi);
    }
    EXPECT_GT(compared, 5000);
}

double albedo_by_sampling(const ClosureKind& kind, const Vec3& wo, uint64_t seed, int samples,
                          MeanEstimate& mean) {
    ClosureList list;
    list.add(Spectrum(1.0f), kind, wo, false);
    Uniforms uniforms(seed);
    for (int i = 0; i < samples; ++i) {
        // Stratified along the closure's own choice; the z-test then overstates the error, which is
        // the safe side.
        const std::optional<ClosureSample> s = sample(list, kNormal, wo, uniforms.three());
        mean.add(s ? s->weight.x : 0.0);
    }
    return mean.mean();
}

// What a rough closure scatters in all: the papers' f integrated over the sphere = mean weight of
// sample() = albedo(), which interpolates a table; never above 1. The table is good to 1 % for GGX
// seen from outside, which is what layering uses, and to 0.07 for what serves sample weights alone:
// Beckmann, whose integration is coarse, and the inside of a dielectric, whose critical angle it
// smooths. 1 % family over the z-tests.
TEST(ClosureSlow, AlbedoMatchesQuadratureOfThePapers) {
    const Vec3d n = to_double(kNormal);
    const Frame frame = Frame::around(kNormal);
    uint64_t seed = 1000;
    int tests = 0;
    for (const MicrofacetModel model : {kGgx, kBeckmann})
        for (const float alpha : {0.1f, 0.37f, 0.9f})
            for (const double degrees : {3.0, 48.0, 78.0, 87.0})
                for (const float eta : {1.4f, 1 / 1.4f}) {
                    ++tests;
                    const Vec3 wo = outgoing(kNormal, degrees);
                    const Vec3d o = to_double(wo);
                    const auto f = [&](double c) { return reference_fresnel(c, eta); };
                    const auto t = [&](double c) { return 1 - f(c); };
                    const auto one = [](double) { return 1.0; };
                    const double white = integrate_sphere(
                        Frame::around(facet::mirrored(wo, kNormal, dot(wo, kNormal))),
                        [&](const Vec3& w) {
                            return reference_reflection(model, alpha, n, o, to_double(w), one);
                        },
                        1e-4, 5);
                    const double reflected = integrate_sphere(
                        Frame::around(facet::mirrored(wo, kNormal, dot(wo, kNormal))),
                        [&](const Vec3& w) {
                            return reference_reflection(model, alpha, n, o, to_double(w), f);
                        },
                        1e-4, 5);
                    const double transmitted = integrate_sphere(
                        Frame::around(
                            facet::refracted(wo, kNormal, dot(wo, kNormal), eta).value_or(frame.x)),
                        [&](const Vec3& w) {
                            return reference_transmission(model, alpha, eta, n, o, to_double(w), t);
                        },
                        1e-4, 5);
                    const std::string text = name(model) + " " + std::to_string(alpha) + " " +
                                             std::to_string(degrees) + " " + std::to_string(eta);
                    const auto check = [&](const ClosureKind& kind, double expected) {
                        EXPECT_LE(expected, 1 + 1e-3) << text;
                        const bool fine = model == kGgx && eta > 1.0f;
                        EXPECT_NEAR(albedo(kind, wo).x, expected,
                                    fine ? 0.01 * std::max(expected, 0.1) : 0.07)
                            << text;
                        MeanEstimate mean;
                        albedo_by_sampling(kind, wo, seed++, 20000, mean);
                        EXPECT_TRUE(is_mean(mean, expected, sidak(0.01, 144), 2e-3 * expected))
                            << text;
                    };
                    const Fresnel dielectric{Fresnel::Kind::dielectric, eta, Spectrum(1.0f),
                                             Spectrum(1.0f)};
                    check(mirror(kNormal, model, alpha), white);
                    check(mirror(kNormal, model, alpha, dielectric), reflected);
                    check(glass(kNormal, model, alpha, eta), reflected + transmitted);
                }
    EXPECT_EQ(tests * 3, 144);
}

TEST(Closure, AlbedoOfMetalsFollowsTheLobe) {
    const Fresnel f82{Fresnel::Kind::f82, 1.0f, Spectrum(0.9f, 0.6f, 0.3f),
                      Spectrum(0.7f, 0.9f, 0.4f)};
    const Fresnel gold{Fresnel::Kind::conductor, 1.0f, Spectrum(0.14f, 0.37f, 1.44f),
                       Spectrum(3.98f, 2.38f, 1.60f)};
    for (const Fresnel& f : {f82, gold})
        for (const float alpha : {0.0f, 0.1f, 0.5f})
            for (const double degrees : {10.0, 60.0, 80.0}) {
                const Vec3 wo = outgoing(kNormal, degrees);
                const ClosureKind kind = mirror(kNormal, kGgx, alpha, f);
                ClosureList list;
                list.add(Spectrum(1.0f), kind, wo, false);
                Uniforms uniforms(13);
                Spectrum sum(0.0f);
                constexpr int kSamples = 20000;
                for (int i = 0; i < kSamples; ++i)
                    if (const auto s = sample(list, kNormal, wo, uniforms.three()))
                        sum += s->weight;
                for (int k = 0; k < 3; ++k)
                    EXPECT_NEAR(sum[k] / kSamples, albedo(kind, wo)[k],
                                f.kind == Fresnel::Kind::f82 ? 0.01 : 0.03)
                        << alpha << " " << degrees << " " << k;
            }
}

// By Snell's law and Beer's, straight.
TEST(Closure, CoatLetsThroughWhatItDoesNotReflectOrAbsorb) {
    for (const double degrees : {0.0, 40.0, 75.0, 89.0}) {
        const Vec3 wo = outgoing(kNormal, degrees);
        const double cos_o = std::cos(degrees * std::numbers::pi / 180), ior = 1.6;
        const double reflected = reference_fresnel(cos_o, ior);
        const double cos_t = std::sqrt(1 - (1 - cos_o * cos_o) / (ior * ior));
        const Coat clear{0.75f, 0.0f, 1.6f, Spectrum(1.0f)};
        Coat tinted = clear;
        tinted.tint = Spectrum(0.5f, 1.0f, 0.0f);
        const double passed = 1 - 0.75 * reflected;
        const Spectrum all = coat_transmittance(clear, kNormal, wo),
                       some = coat_transmittance(tinted, kNormal, wo);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(all[k], passed, 1e-5);
        EXPECT_NEAR(some.x, passed * (0.25 + 0.75 * std::pow(0.5, 1 / cos_t)), 1e-5);
        EXPECT_NEAR(some.y, passed, 1e-5);
        EXPECT_NEAR(some.z, passed * 0.25, 1e-5);
        for (const float alpha : {0.1f, 0.6f, 1.0f}) {
            const Coat rough{1.0f, alpha, 1.6f, Spectrum(1.0f)};
            MicrofacetReflection lobe = mirror(kNormal, kGgx, alpha, coat_fresnel(1.6f));
            lobe.energy_compensated = true;
            EXPECT_EQ(coat_transmittance(rough, kNormal, wo).x, 1.0f - albedo(lobe, wo).x);
        }
    }
    // Where nothing bends and nothing comes back, and where the normal is turned away.
    const Coat none{1.0f, 0.0f, 1.0f, Spectrum(0.5f)};
    for (const double degrees : {0.0, 90.0, 100.0})
        EXPECT_TRUE(is_finite(coat_transmittance(none, kNormal, outgoing(kNormal, degrees))));
    EXPECT_FLOAT_EQ(coat_transmittance(none, kNormal, kNormal).x, 0.5f);
}

TEST(Closure, WhiteFurnaceOfLambertAndDeltasIsExact) {
    Uniforms uniforms(14);
    for (const double degrees : {0.0, 30.0, 60.0, 89.0})
        for (const float eta : {1.5f, 1 / 1.5f, 1.0f}) {
            const Vec3 wo = outgoing(kNormal, degrees);
            for (const ClosureKind& kind :
                 {ClosureKind(Lambert{kNormal}), ClosureKind(glass(kNormal, kGgx, 0.0f, eta)),
                  ClosureKind(mirror(kNormal, kBeckmann, 0.0f)), ClosureKind(Transparent{})}) {
                ClosureList list;
                list.add(Spectrum(1.0f), kind, wo, true);
                for (int i = 0; i < 100; ++i) {
                    const std::optional<ClosureSample> s =
                        sample(list, kNormal, wo, uniforms.three());
                    ASSERT_TRUE(s.has_value());
                    for (int k = 0; k < 3; ++k) EXPECT_NEAR(s->weight[k], 1.0f, 5e-7f);
                }
                EXPECT_FLOAT_EQ(albedo(kind, wo).x, 1.0f);
            }
        }
}

// A compensated white closure gives everything back, from every angle at every roughness.
TEST(ClosureSlow, CompensatedClosuresLoseNothing) {
    for (const float alpha : {0.01f, 0.15f, 0.5f, 1.0f})
        for (const double degrees : {0.0, 40.0, 75.0, 86.0}) {
            const Vec3 wo = outgoing(kNormal, degrees);
            std::vector<ClosureKind> kinds;
            MicrofacetReflection metal = mirror(kNormal, kGgx, alpha);
            metal.energy_compensated = true;
            kinds.push_back(metal);
            for (const float eta : {1.45f, 1 / 1.45f}) {
                MicrofacetDielectric clear = glass(kNormal, kGgx, alpha, eta);
                clear.energy_compensated = true;
                kinds.push_back(clear);
            }
            for (const ClosureKind& kind : kinds) {
                MeanEstimate mean;
                albedo_by_sampling(kind, wo, 15, 40000, mean);
                EXPECT_NEAR(mean.mean(), 1.0, 0.015 + 3 * mean.standard_error())
                    << alpha << " " << degrees << " " << kind.index();
                EXPECT_NEAR(albedo(kind, wo).x, 1.0, 0.01) << alpha << " " << degrees;
            }
        }
}

// A coloured metal gets back more than it reflects at once and saturates: the darker channel gains
// less.
TEST(Closure, CompensationSaturatesColours) {
    const Vec3 wo = outgoing(kNormal, 60);
    MicrofacetReflection metal =
        mirror(kNormal, kGgx, 1.0f,
               {Fresnel::Kind::none, 1.0f, Spectrum(1.0f, 0.5f, 0.1f), Spectrum(1.0f)});
    const Spectrum once = albedo(metal, wo);
    metal.energy_compensated = true;
    const Spectrum all = albedo(metal, wo);
    EXPECT_GT(all.x / once.x, all.y / once.y + 0.02f);
    EXPECT_GT(all.y / once.y, all.z / once.z + 0.02f);
    EXPECT_GE(all.z, once.z);
    EXPECT_LE(all.x, 1.0f + 1e-5f);
}

// ----------------------------------------------------------------------------------------------
// symmetry

TEST(Closure, ReflectionAndRefractionAreReciprocal) {
    Uniforms uniforms(16);
    int compared = 0;
    for (int i = 0; i < 5000; ++i) {
        const MicrofacetModel model = i % 2 ? kGgx : kBeckmann;
        const float alpha = 0.1f + 0.9f * uniforms(), eta = 0.5f + 1.5f * uniforms();
        const Vec3 wo = Frame::around(kNormal).to_world(cosine_hemisphere(uniforms.two()));
        const Vec3 wi = uniform_sphere(uniforms.two());
        const bool crosses = dot(kNormal, wi) < 0.0f;
        // Seen from wi, a transmission's normal and index are turned over.
        const Vec3 back = crosses ? -kNormal : kNormal;
        ClosureList there, here;
        there.add(Spectrum(1.0f), glass(kNormal, model, alpha, eta), wo, false);
        here.add(Spectrum(1.0f), glass(back, model, alpha, crosses ? 1 / eta : eta), wi, false);
        const double f_there = eval(there, kNormal, wo, wi).f_cos.x / std::abs(dot(kNormal, wi));
        const double f_here = eval(here, back, wi, wo).f_cos.x / std::abs(dot(kNormal, wo));
        // In basic radiance f / (index of the side of wi)^2 is symmetric.
        const double scaled = crosses ? f_there / (double(eta) * eta) : f_there;
        EXPECT_NEAR(scaled, f_here, 2e-3 * f_here + 1e-5) << alpha << " " << eta << " " << crosses;
        compared += f_here > 1e-2;
    }
    EXPECT_GT(compared, 1000);
}

// ----------------------------------------------------------------------------------------------
// deltas

TEST(Closure, DeltaLobeAgreesWithSample) {
    const Fresnel coat{Fresnel::Kind::dielectric, 1.4f, Spectrum(1.0f), Spectrum(1.0f)};
    MicrofacetDielectric tinted = glass(kNormal, kGgx, 0.0f, 1.5f);
    tinted.transmission_tint = Spectrum(0.9f, 0.5f, 0.2f);
    for (const double degrees : {10.0, 70.0}) {
        const Vec3 wo = outgoing(kNormal, degrees);
        ClosureList list;
        list.add(Spectrum(0.3f, 0.2f, 0.1f), Lambert{kNormal}, wo, false);
        list.add(Spectrum(0.5f, 0.4f, 0.3f), mirror(kNormal, kGgx, 0.0f, coat), wo, true);
        list.add(Spectrum(0.2f), Transparent{}, wo, true);
        list.add(Spectrum(0.4f), tinted, wo, true);
        list.add(Spectrum(0.1f), mirror(kNormal, kGgx, 0.0f), wo,
                 false);  // not on the caster's normal
        list.add(Spectrum(0.1f), mirror(kNormal, kGgx, 0.2f), wo, true);  // not a delta
        Uniforms uniforms(17);
        std::array<MeanEstimate, 2> probability;
        std::array<std::array<MeanEstimate, 3>, 2> throughput;
        const std::array<Vec3, 2> wi = {facet::mirrored(wo, kNormal, dot(wo, kNormal)),
                                        *facet::refracted(wo, kNormal, dot(wo, kNormal), 1.5f)};
        for (int i = 0; i < 100000; ++i) {
            const std::optional<ClosureSample> s = sample(list, kNormal, wo, uniforms.three());
            for (int side = 0; side < 2; ++side) {
                const bool is_it = s && s->delta && s->on_caster_normal &&
                                   s->kind != BounceKind::transparent && s->refracted == (side == 1);
                if (is_it) {
                    ASSERT_LT(angle_between(s->wi, wi[side]), 1e-5);
                }
                probability[side].add(is_it ? 1 : 0);
                for (int k = 0; k < 3; ++k) throughput[side][k].add(is_it ? s->weight[k] : 0);
            }
        }
        for (int side = 0; side < 2; ++side) {
            const DeltaLobe lobe = delta_lobe(list, kNormal, wo, wi[side], side == 1);
            const double significance = sidak(0.01, 16);
            EXPECT_GT(lobe.probability, 0.01f);
            EXPECT_TRUE(is_mean(probability[side], lobe.probability, significance));
            for (int k = 0; k < 3; ++k)
                EXPECT_TRUE(is_mean(throughput[side][k], lobe.throughput[k], significance));
        }
    }
}

// As Blender says it: the reflectance at normal incidence is tinted, total reflection is white.
TEST(Closure, WhatATintTakesFromTheReflectionPasses) {
    const Spectrum tint(0.2f, 0.6f, 1.5f);
    for (const double eta : {1.5, 1 / 1.5})
        for (const double degrees : {5.0, 35.0, 60.0, 85.0}) {
            const auto expected = [&](double cos_facet, double channel_tint) {
                const double f0 = reference_fresnel(1, eta);
                const double rise = (reference_fresnel(cos_facet, eta) - f0) / (1 - f0);
                return f0 * channel_tint * (1 - rise) + rise;
            };
            const Vec3 wo = outgoing(kNormal, degrees);
            const float cos_o = dot(wo, kNormal);
            MicrofacetDielectric tinted = glass(kNormal, kGgx, 0.0f, float(eta));
            tinted.normal_tint = tint;
            ClosureList smooth, rough;
            smooth.add(Spectrum(1.0f), tinted, wo, true);
            tinted.alpha = 0.3f;
            rough.add(Spectrum(1.0f), tinted, wo, true);
            const Vec3 mirrored = facet::mirrored(wo, kNormal, cos_o);
            const std::optional<Vec3> refracted = facet::refracted(wo, kNormal, cos_o, float(eta));
            const Vec3 aside = outgoing(kNormal, 20.0);
            const Vec3d o = to_double(wo), i = to_double(aside);
            for (int k = 0; k < 3; ++k) {
                const double reflects = expected(cos_o, tint[k]);
                EXPECT_NEAR(delta_lobe(smooth, kNormal, wo, mirrored, false).throughput[k],
                            reflects, 1e-5);
                if (refracted) {
                    EXPECT_NEAR(delta_lobe(smooth, kNormal, wo, *refracted, true).throughput[k],
                                1 - reflects, 1e-5);
                } else {
                    EXPECT_NEAR(reflects, 1, 1e-12);
                }
                const double f = reference_reflection(
                    kGgx, 0.3, to_double(kNormal), o, i,
                    [&](double cos_facet) { return expected(cos_facet, tint[k]); });
                EXPECT_NEAR(eval(rough, kNormal, wo, aside).f_cos[k], f, 1e-5 + 1e-4 * f);
            }
        }
}

TEST(Closure, DeltaLobeIsEmptyWhereSampleNeverGoes) {
    const Vec3 wo = outgoing(kNormal, 70);
    const Vec3 mirrored = facet::mirrored(wo, kNormal, dot(wo, kNormal));
    ClosureList rough = list_of(wo, {mirror(kNormal, kGgx, 0.3f), Lambert{kNormal}, Transparent{}});
    EXPECT_EQ(delta_lobe(rough, kNormal, wo, mirrored, false).probability, 0.0f);
    // Total internal reflection: nothing refracted, all reflected.
    ClosureList inside = list_of(wo, {glass(kNormal, kGgx, 0.0f, 1 / 1.5f)});
    EXPECT_EQ(delta_lobe(inside, kNormal, wo, -wo, true).probability, 0.0f);
    EXPECT_FLOAT_EQ(delta_lobe(inside, kNormal, wo, mirrored, false).probability, 1.0f);
    // A mirrored direction below the geometry.
    ClosureList list = list_of(wo, {mirror(kNormal, kGgx, 0.0f)});
    EXPECT_EQ(delta_lobe(list, normalize(wo - mirrored * 0.95f), wo, mirrored, false).probability,
              0.0f);
    EXPECT_FALSE(sample(list, normalize(wo - mirrored * 0.95f), wo, Vec3(0.5f)).has_value());
}

TEST(Closure, DeltaAndKindsOfBounce) {
    EXPECT_TRUE(is_delta(mirror(kNormal, kGgx, kDeltaAlpha)));
    EXPECT_FALSE(is_delta(mirror(kNormal, kGgx, 2 * kDeltaAlpha)));
    EXPECT_TRUE(is_delta(glass(kNormal, kGgx, 0.3f, 1.0f)));
    EXPECT_FALSE(is_delta(glass(kNormal, kGgx, 0.3f, 1.01f)));
    EXPECT_TRUE(is_delta(Transparent{}));
    EXPECT_FALSE(is_delta(Lambert{kNormal}));
    const Vec3 wo = outgoing(kNormal, 30);
    EXPECT_TRUE(has_smooth_closure(list_of(wo, {Transparent{}, Lambert{kNormal}})));
    EXPECT_FALSE(has_smooth_closure(list_of(wo, {Transparent{}, glass(kNormal, kGgx, 0, 1.5f)})));

    const auto kind = [&](const ClosureKind& closure, float u) {
        return sample(list_of(wo, {closure}), kNormal, wo, Vec3(u, 0.4f, 0.3f))->kind;
    };
    EXPECT_EQ(kind(Lambert{kNormal}, 0.5f), BounceKind::diffuse);
    EXPECT_EQ(kind(mirror(kNormal, kGgx, 0.1f), 0.5f), BounceKind::glossy);
    EXPECT_EQ(kind(mirror(kNormal, kGgx, 0.0f), 0.5f), BounceKind::glossy);
    EXPECT_EQ(kind(glass(kNormal, kGgx, 0.1f, 1.5f), 0.0f), BounceKind::glossy);
    EXPECT_EQ(kind(glass(kNormal, kGgx, 0.1f, 1.5f), 0.99f), BounceKind::transmission);
    EXPECT_EQ(kind(glass(kNormal, kGgx, 0.0f, 1.5f), 0.99f), BounceKind::transmission);
    EXPECT_EQ(kind(Transparent{}, 0.99f), BounceKind::transparent);
}

TEST(Closure, IndexOneGoesStraightOn) {
    const Vec3 wo = outgoing(kNormal, 80);
    for (const float alpha : {0.0f, 0.5f}) {
        const ClosureList list = list_of(wo, {glass(kNormal, kGgx, alpha, 1.0f)});
        for (const float u : {0.0f, 0.5f, 0.99f}) {
            const std::optional<ClosureSample> s = sample(list, kNormal, wo, Vec3(u, 0.2f, 0.9f));
            ASSERT_TRUE(s.has_value());
            EXPECT_TRUE(s->delta && s->refracted);
            EXPECT_EQ(s->wi, -wo);
        }
        ClosureList reflection;
        MicrofacetDielectric half = glass(kNormal, kGgx, alpha, 1.0f);
        half.refracts = false;
        reflection.add(Spectrum(1.0f), half, wo, true);
        EXPECT_FALSE(reflection.count && sample(reflection, kNormal, wo, Vec3(0.5f)));
    }
}

// ----------------------------------------------------------------------------------------------
// the list

TEST(ClosureList, DropsWhatIsBlackAndKeepsTheRest) {
    const Vec3 wo = outgoing(kNormal, 30);
    ClosureList list;
    list.add(Spectrum(0.0f), Lambert{kNormal}, wo, false);
    list.add(Spectrum(-1.0f), Lambert{kNormal}, wo, false);
    list.add(Spectrum(1.0f), mirror(-kNormal, kGgx, 0.1f), wo,
             false);  // seen from below its normal
    EXPECT_EQ(list.count, 0);
    EXPECT_FALSE(sample(list, kNormal, wo, Vec3(0.5f)).has_value());
    EXPECT_EQ(eval(list, kNormal, wo, wo).pdf_omega, 0.0f);
    list.add(Spectrum(1.0f, -1.0f, 0.5f), Lambert{kNormal}, wo, true);
    EXPECT_EQ(list.closures[0].weight, Spectrum(1.0f, 0.0f, 0.5f));
    list.add(Spectrum(0.25f, 0.5f, 0.75f), Transparent{}, wo, false);
    EXPECT_EQ(list.transparency, Spectrum(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(list.count, 2);
    // A NaN from a texture must surface in the integrator's count, not vanish here.
    list.add(Spectrum(std::numeric_limits<float>::quiet_NaN(), 1.0f, 1.0f), Lambert{kNormal}, wo,
             false);
    EXPECT_EQ(list.count, 3);
    list.clear();
    EXPECT_EQ(list.count, 0);
    EXPECT_EQ(list.transparency, Spectrum(0.0f));
}

// Past the critical angle only rare facets transmit; a table that misses them must not drop them.
TEST(ClosureList, KeepsARoughTransmissionPastTheCriticalAngle) {
    for (const MicrofacetModel model : {kGgx, kBeckmann})
        for (const double degrees : {50.0, 70.0, 89.0})
            for (const bool weighted : {false, true}) {
                MicrofacetDielectric half = refraction(kNormal, model, 0.02f, 1 / 2.0f);
                half.fresnel_weighted = weighted;
                EXPECT_EQ(list_of(outgoing(kNormal, degrees), {half}).count, 1) << degrees;
            }
}

TEST(ClosureList, LambertDoesNotAskWhereItIsSeenFrom) {
    const Vec3 wo = outgoing(kNormal, 89), n = normalize(kNormal * 0.9f - wo * 0.3f);
    ASSERT_LT(dot(n, wo), 0.0f);
    const ClosureList list = list_of(wo, {Lambert{n}});
    ASSERT_EQ(list.count, 1);
    EXPECT_GT(eval(list, kNormal, wo, kNormal).f_cos.x, 0.1f);
}

// Nothing that a scene can ask for yields a NaN, an infinity, a direction on the wrong side or a
// weight above one.
TEST(Closure, SurvivesExtremes) {
    const float alphas[] = {0.0f, kDeltaAlpha, 2.1e-5f, 1e-4f, 1e-2f, 0.5f, 1.0f};
    const float etas[] = {1.0f, 1.0f + 1e-7f, 1.0001f, 0.9999f, 1.01f,
                          1.5f, 1 / 1.5f,     100.0f,  0.01f};
    const double angles[] = {0, 1e-3, 45, 89.9, 89.99999, 90};
    const float edge = 1.0f - 0x1p-24f;
    const Vec3 us[] = {{0, 0, 0},       {edge, edge, edge}, {0.5f, 0, 0.5f},
                       {edge, edge, 0}, {0.3f, 0.5f, edge}, {0, edge, 0.25f}};
    const Vec3 normals[] = {kNormal, kTilted, Vec3(0, 0, 1), Vec3(0, 0, -1)};
    Uniforms uniforms(18);
    for (const MicrofacetModel model : {kGgx, kBeckmann})
        for (const float alpha : alphas)
            for (const float eta : etas)
                for (const double angle : angles)
                    for (const Vec3& n : normals) {
                        const Vec3 wo = outgoing(n, angle);
                        const Vec3 ng = dot(kNormal, wo) >= 0.0f ? kNormal : -kNormal;
                        const Fresnel dielectric{Fresnel::Kind::dielectric, eta, Spectrum(1.0f),
                                                 Spectrum(1.0f)};
                        const Fresnel conductor{Fresnel::Kind::conductor, 1.0f, Spectrum(eta),
                                                Spectrum(alpha)};
                        MicrofacetDielectric compensated = glass(n, model, alpha, eta);
                        compensated.energy_compensated = true;
                        for (const ClosureKind& kind :
                             {ClosureKind(mirror(n, model, alpha)),
                              ClosureKind(mirror(n, model, alpha, dielectric)),
                              ClosureKind(mirror(n, model, alpha, conductor)),
                              ClosureKind(glass(n, model, alpha, eta)),
                              ClosureKind(refraction(n, model, alpha, eta)),
                              ClosureKind(compensated)}) {
                            ClosureList list;
                            list.add(Spectrum(1.0f), kind, wo, true);
                            const Spectrum all = albedo(kind, wo);
                            ASSERT_TRUE(is_finite(all) && all.x >= 0.0f && all.x <= 1.02f)
                                << all.x << " " << kind.index();
                            for (int i = 0; i < 8; ++i) {
                                const Vec3 u = i < 6 ? us[i] : uniforms.three();
                                if (const auto s = sample(list, ng, wo, u)) {
                                    ASSERT_TRUE(is_finite(s->weight) && is_finite(s->wi));
                                    ASSERT_NEAR(length(s->wi), 1.0f, 1e-4f);
                                    ASSERT_GT(s->delta ? s->probability : s->pdf_omega, 0.0f);
                                    ASSERT_EQ(dot(ng, s->wi) < 0.0f, s->refracted);
                                    if (list.closures[0].weight.x == 1.0f) {
                                        ASSERT_LE(s->weight.x, 1.001f)
                                            << alpha << " " << eta << " " << angle;
                                    }
                                }
                                const ClosureEval e =
                                    eval(list, ng, wo, uniform_sphere(Vec2(u.x, u.y)));
                                ASSERT_TRUE(is_finite(e.f_cos) && std::isfinite(e.pdf_omega));
                                ASSERT_GE(e.f_cos.x, 0.0f);
                            }
                        }
                    }
}

}  // namespace
}  // namespace spc::test
