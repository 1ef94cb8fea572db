// SPDX-License-Identifier: GPL-3.0-or-later
// Facets of rough vertices: their distribution, their derivatives, and the density of what they
// scatter.
#include "manifold/facet.h"

#include "bsdf/microfacet.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

SpecularInterface rough(MicrofacetModel model, float alpha, float ior = 1.5f) {
    SpecularInterface interface;
    interface.reflects = interface.refracts = true;
    interface.alpha = alpha;
    interface.model = model;
    interface.ior = ior;
    return interface;
}
constexpr MicrofacetModel kModels[] = {MicrofacetModel::ggx, MicrofacetModel::beckmann};

// Of a surface that bends and twists, at (u, v).
DifferentialGeometry bent_geometry(float u, float v) {
    const Vec3 n0(0.3f, -0.2f, 0.9f), a(0.4f, 0.1f, -0.2f), b(-0.1f, 0.5f, 0.3f);
    const Vec3 sum = n0 + a * u + b * v;
    const float l = length(sum);
    DifferentialGeometry geometry{};
    geometry.n = sum * (1.0f / l);
    geometry.dn_du = (a - geometry.n * dot(geometry.n, a)) * (1.0f / l);
    geometry.dn_dv = (b - geometry.n * dot(geometry.n, b)) * (1.0f / l);
    return geometry;
}

Vec3 mirrored(const Vec3& w, const Vec3& m) { return m * (2.0f * dot(w, m)) - w; }

// P(tan > t) = 1 / (1 + (t / alpha)^2) of GGX, exp(-(t / alpha)^2) of Beckmann: the integrals of D
// cos.
TEST(Facets, HaveTheDistributionOfTheLobe) {
    constexpr int kCount = 100000;
    constexpr double kAlpha = 0.07;
    for (const MicrofacetModel model : kModels) {
        Pcg pcg(3);
        const SpecularInterface interface = rough(model, float(kAlpha));
        for (const double t : {0.5 * kAlpha, kAlpha, 2.0 * kAlpha}) {
            int steeper = 0, east = 0;
            for (int i = 0; i < kCount; ++i) {
                const Vec2 slope = sample_facet(interface, pcg.two());
                steeper += double(slope.length()) > t;
                east += slope.x > 0.0f;
            }
            const double r2 = t * t / (kAlpha * kAlpha);
            const double expected = model == MicrofacetModel::ggx ? 1.0 / (1.0 + r2) : std::exp(-r2);
            EXPECT_NEAR(double(steeper) / kCount, expected, 0.008);  // five standard errors
            EXPECT_NEAR(double(east) / kCount, 0.5, 0.008);
        }
    }
}

TEST(Facets, AreFoundAgainBetweenTheirDirections) {
    Pcg pcg(5);
    for (int i = 0; i < 200; ++i) {
        const Vec2 slope = (pcg.two() - Vec2(0.5f, 0.5f)) * 0.4f;
        const DifferentialGeometry geometry = bent_geometry(pcg.one(), pcg.one());
        DifferentialGeometry leaning = geometry;
        lean(leaning, slope);
        EXPECT_NEAR(length(leaning.n), 1.0f, 1e-6f);
        const Vec3 wi = normalize(leaning.n + Vec3(pcg.one(), pcg.one(), pcg.one()) * 0.3f);
        const std::optional<Vec2> reflecting =
            facet_between(geometry, Interaction::reflection, 1.5f, wi, mirrored(wi, leaning.n));
        ASSERT_TRUE(reflecting);
        EXPECT_LT((*reflecting - slope).length(), 1e-5f);
        // Snell's law: wo = -wi / eta + (cos_i / eta - cos_t) m.
        const float eta = 1.5f, cos_i = dot(wi, leaning.n);
        const float cos_t = std::sqrt(1.0f - (1.0f - cos_i * cos_i) / (eta * eta));
        const Vec3 wo = wi * (-1.0f / eta) + leaning.n * (cos_i / eta - cos_t);
        const std::optional<Vec2> refracting =
            facet_between(geometry, Interaction::refraction, eta, wi, wo);
        ASSERT_TRUE(refracting);
        EXPECT_LT((*refracting - slope).length(), 2e-5f);
    }
}

TEST(Facets, TurnWithTheSurface) {
    constexpr float kStep = 1e-2f;
    Pcg pcg(7);
    for (int i = 0; i < 50; ++i) {
        const Vec2 slope = (pcg.two() - Vec2(0.5f, 0.5f)) * 0.6f, at = pcg.two();
        const auto facet = [&](float u, float v) {
            DifferentialGeometry geometry = bent_geometry(u, v);
            lean(geometry, slope);
            return geometry;
        };
        const DifferentialGeometry here = facet(at.x, at.y);
        const Vec3 by_u =
                       (facet(at.x + kStep, at.y).n - facet(at.x - kStep, at.y).n) * (0.5f / kStep),
                   by_v =
                       (facet(at.x, at.y + kStep).n - facet(at.x, at.y - kStep).n) * (0.5f / kStep);
        EXPECT_LT(length(here.dn_du - by_u), 1e-3f) << i;
        EXPECT_LT(length(here.dn_dv - by_v), 1e-3f) << i;
    }
}

// The density of directions against the facets that are drawn: the share of those that send light
// into a cone.
TEST(Facets, ScatterWithTheirDensity) {
    constexpr int kCount = 200000;
    constexpr float kEta = 1.4f;
    const DifferentialGeometry geometry = bent_geometry(0.2f, 0.7f);
    const Frame frame = Frame::around(geometry.n);
    for (const MicrofacetModel model : kModels)
        for (const Interaction interaction : {Interaction::reflection, Interaction::refraction}) {
            const SpecularInterface interface = rough(model, 0.1f, kEta);
            const Vec3 wi = frame.to_world(normalize(Vec3(0.5f, 0.2f, 0.8f)));
            const auto scattered = [&](const Vec3& m) {
                if (interaction == Interaction::reflection) return mirrored(wi, m);
                const float cos_i = dot(wi, m),
                            cos_t = std::sqrt(1.0f - (1.0f - cos_i * cos_i) / (kEta * kEta));
                return wi * (-1.0f / kEta) + m * (cos_i / kEta - cos_t);
            };
            // Beside the peak.
            const Vec3 axis = normalize(scattered(geometry.n) + frame.x * 0.08f);
            constexpr float kCone = 1e-3f;  // 1 - cos
            Pcg pcg(11);
            int inside = 0;
            double integral = 0.0;
            for (int i = 0; i < kCount; ++i) {
                DifferentialGeometry leaning = geometry;
                lean(leaning, sample_facet(interface, pcg.two()));
                inside += dot(scattered(leaning.n), axis) > 1.0f - kCone;
                const Vec3 wo = Frame::around(axis).to_world(uniform_cone(pcg.two(), kCone));
                integral += double(facet_pdf(interface, geometry, interaction, kEta, wi, wo));
            }
            const double expected = integral / kCount / double(uniform_cone_pdf(kCone));
            const double share = double(inside) / kCount;
            EXPECT_GT(share, 0.01);
            EXPECT_NEAR(share, expected, 5.0 * std::sqrt(share / kCount) + 0.005 * share);
        }
}

}  // namespace
}  // namespace spc
