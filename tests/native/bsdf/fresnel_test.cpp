// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/fresnel.h"

#include "math/warp.h"
#include "support/numerics.h"

#include <complex>

namespace spc::test {
namespace {

// Fresnel's equations as the textbooks print them, for any complex index [BornWolf99].
double textbook(double cos_i, std::complex<double> index) {
    const std::complex<double> sin_t = std::sqrt(1 - cos_i * cos_i) / index;
    const std::complex<double> cos_t = std::sqrt(1.0 - sin_t * sin_t);
    const double s = std::norm((cos_i - index * cos_t) / (cos_i + index * cos_t));
    const double p = std::norm((index * cos_i - cos_t) / (index * cos_i + cos_t));
    return 0.5 * (s + p);
}

TEST(FresnelDielectric, MatchesTheTextbookAtAllAngles) {
    for (const float eta : {1.0001f, 1.01f, 1.33f, 1.5f, 2.4f, 5.0f, 0.99f, 0.75f, 1 / 1.5f, 0.3f})
        for (int i = 0; i <= 200; ++i) {
            const float c = static_cast<float>(i) / 200;
            EXPECT_NEAR(fresnel_dielectric(c, eta), textbook(c, double(eta)), 5e-6)
                << c << " " << eta;
        }
}

TEST(FresnelDielectric, SpecialAngles) {
    for (const float eta : {1.33f, 1.5f, 2.4f, 1 / 1.5f}) {
        EXPECT_NEAR_REL(fresnel_dielectric(1.0f, eta), std::pow((eta - 1.0) / (eta + 1.0), 2), 1e-5);
        EXPECT_EQ(fresnel_dielectric(0.0f, eta), 1.0f);
        // Brewster's angle, tan = eta: the p polarisation vanishes, s gives ((1 - eta^2) / (1 +
        // eta^2))^2 / 2.
        const double e2 = double(eta) * eta;
        EXPECT_NEAR_REL(fresnel_dielectric(static_cast<float>(1 / std::sqrt(1 + e2)), eta),
                        0.5 * std::pow((1 - e2) / (1 + e2), 2), 1e-5);
    }
    const float critical = std::sqrt(1 - 1 / sqr(1.5f));
    EXPECT_EQ(fresnel_dielectric(critical * 0.9999f, 1 / 1.5f), 1.0f);
    EXPECT_LT(fresnel_dielectric(critical * 1.0001f, 1 / 1.5f), 0.98f);
}

TEST(FresnelDielectric, IndexOneReflectsNothing) {
    for (const float c : {0.0f, 1e-20f, 0.5f, 1.0f}) EXPECT_EQ(fresnel_dielectric(c, 1.0f), 0.0f);
}

TEST(FresnelDielectric, IsTheSameFromBothSides) {
    for (int i = 1; i <= 50; ++i) {
        const float c = static_cast<float>(i) / 50, eta = 1.5f;
        const float cos_t = std::sqrt(1 - (1 - c * c) / (eta * eta));
        EXPECT_NEAR(fresnel_dielectric(c, eta), fresnel_dielectric(cos_t, 1 / eta), 1e-5);
    }
}

TEST(FresnelConductor, MatchesTheTextbook) {
    const Spectrum etas[] = {{0.2f, 0.9f, 1.5f}, {0.04f, 3.0f, 1.0f}};
    const Spectrum ks[] = {{3.9f, 2.4f, 1.9f}, {4.8f, 0.0f, 0.5f}};
    for (int m = 0; m < 2; ++m) {
        const Fresnel f{Fresnel::Kind::conductor, 1.0f, etas[m], ks[m]};
        for (int i = 0; i <= 100; ++i) {
            const float c = static_cast<float>(i) / 100;
            const Spectrum r = fresnel(f, c);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(r[k], textbook(c, {etas[m][k], ks[m][k]}), 1e-5)
                    << c << " " << m << " " << k;
        }
    }
    // No interface.
    const Spectrum none =
        fresnel({Fresnel::Kind::conductor, 1.0f, Spectrum(1.0f), Spectrum(0.0f)}, 0.0f);
    EXPECT_TRUE(is_finite(none));
}

TEST(FresnelF82, MeetsItsThreePoints) {
    const Spectrum f0(0.9f, 0.6f, 0.3f), tint(0.8f, 1.0f, 0.5f);
    const Fresnel f{Fresnel::Kind::f82, 1.0f, f0, tint};
    const Spectrum normal = fresnel(f, 1.0f), grazing = fresnel(f, 0.0f),
                   edge = fresnel(f, 1.0f / 7);
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(normal[k], f0[k], 1e-6);
        EXPECT_NEAR(grazing[k], 1.0f, 1e-6);
        EXPECT_NEAR_REL(edge[k], tint[k] * (f0[k] + (1 - f0[k]) * std::pow(6.0 / 7, 5)), 1e-5);
    }
}

TEST(FresnelDielectricF0, IsTheExactCurveForItsOwnF0AndRisesFromAnyOther) {
    const float natural = facet::dielectric_f0(1.5f);
    for (int i = 0; i <= 50; ++i) {
        const float c = static_cast<float>(i) / 50;
        const Fresnel same{Fresnel::Kind::dielectric_f0, 1.5f, Spectrum(natural), Spectrum(1.0f)};
        EXPECT_NEAR(fresnel(same, c).x, fresnel_dielectric(c, 1.5f), 1e-6);
    }
    const Fresnel tinted{Fresnel::Kind::dielectric_f0, 1.5f, Spectrum(0.0f, 0.02f, 0.08f),
                         Spectrum(1.0f)};
    EXPECT_NEAR(fresnel(tinted, 1.0f).y, 0.02f, 1e-6);
    EXPECT_NEAR(fresnel(tinted, 0.0f).x, 1.0f, 1e-6);
}

TEST(FresnelNone, IsItsColour) {
    EXPECT_EQ(fresnel({}, 0.3f), Spectrum(1.0f));
    EXPECT_EQ(fresnel({Fresnel::Kind::none, 1.0f, Spectrum(0.1f, 0.2f, 0.3f), Spectrum(1.0f)}, 0.3f),
              Spectrum(0.1f, 0.2f, 0.3f));
}

// Snell's law in vector form: the tangential parts of wo and eta wi cancel, and both lie in one
// plane.
TEST(FacetDirections, ObeySnellAndMirror) {
    Uniforms uniforms(7);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 m = uniform_sphere(uniforms.two());
        const Vec3 wo = Frame::around(m).to_world(cosine_hemisphere(uniforms.two()));
        const float c = dot(wo, m);
        const float eta = 0.4f + 2.0f * uniforms();
        EXPECT_NEAR_ANGLE(facet::mirrored(wo, m, c) + wo, m, c > 0.01f ? 1e-4 : 1.0);
        const std::optional<Vec3> wi = facet::refracted(wo, m, c, eta);
        EXPECT_EQ(wi.has_value(), fresnel_dielectric(c, eta) < 1.0f);
        if (!wi) continue;
        EXPECT_NEAR(length(*wi), 1.0f, 1e-5f);
        EXPECT_LE(dot(*wi, m), 0.0f);
        EXPECT_NEAR(length(cross(wo + *wi * eta, m)), 0.0f, 1e-5f);
        EXPECT_EQ(*facet::refracted(wo, m, c, 1.0f), -wo);
    }
}

}  // namespace
}  // namespace spc::test
