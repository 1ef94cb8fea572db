// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/terminator.h"

#include "bsdf/closure.h"
#include "math/warp.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

const Vec3 kUp(0, 0, 1);
constexpr ClosureTraits kDiffuse{BounceKind::diffuse, BounceKind::diffuse};

Vec3 tilted(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {static_cast<float>(std::sin(a)), 0.0f, static_cast<float>(std::cos(a))};
}

float mirrored_height(const Vec3& n, const Vec3& wo) { return 2.0f * dot(n, wo) * n.z - wo.z; }

// The mirrored direction leaves the surface, just, and by the smallest turn in the plane of both
// normals.
TEST(Terminator, BentNormalsMirrorAboveTheSurface) {
    Uniforms uniforms(3);
    int bent = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = cosine_hemisphere(uniforms.two()), n = uniform_sphere(uniforms.two());
        if (n.z < 0.05f || wo.z < 1e-3f) continue;
        const Vec3 b = bent_normal(kUp, wo, n);
        const float least = std::min(0.9f * wo.z, 0.01f);
        EXPECT_NEAR(length(b), 1.0f, 1e-5f);
        if (mirrored_height(n, wo) >= least) {
            EXPECT_EQ(b, n);
            continue;
        }
        ++bent;
        EXPECT_NEAR(mirrored_height(b, wo), least, 2e-4f);
        EXPECT_NEAR(dot(b, cross(kUp, n)), 0.0f, 1e-5f);
        EXPECT_GE(b.z, n.z - 1e-5f);
    }
    EXPECT_GT(bent, 300);
}

// [Chiang19]: with g = cos(smooth, wi) / (cos(n, wi) cos(smooth, n)), the light is -g^3 + g^2 + g.
TEST(Terminator, SmoothedFadesByTheCubic) {
    const Terminator terminator{BumpCorrection::smoothed, 1.0f, kUp};
    for (const double light : {-60.0, 10.0, 50.0, 80.0, 89.0}) {
        const double turn = 40 * std::numbers::pi / 180, at = light * std::numbers::pi / 180;
        const double g = std::cos(at) / (std::cos(at - turn) * std::cos(turn));
        const double expected = g >= 1 ? 1 : g < 0 ? 0 : -g * g * g + g * g + g;
        EXPECT_NEAR(fade(terminator, kDiffuse, tilted(40), tilted(light)), expected, 1e-5) << light;
    }
    EXPECT_EQ(fade(terminator, kDiffuse, tilted(40), tilted(95)), 0.0f);
}

// [Estevez19]: G1 of GGX with alpha^2 = tan^2 / 8 of the angle between the normals.
TEST(Terminator, MicrofacetFadesByTheMasking) {
    const Terminator terminator{BumpCorrection::microfacet, 1.0f, kUp};
    for (const double light : {0.0, 50.0, 80.0, 89.0}) {
        const double alpha2 = std::pow(std::tan(40 * std::numbers::pi / 180), 2) / 8;
        const double tan2 = std::pow(std::tan(light * std::numbers::pi / 180), 2);
        EXPECT_NEAR(fade(terminator, kDiffuse, tilted(40), tilted(light)),
                    2 / (1 + std::sqrt(1 + alpha2 * tan2)), 1e-5)
            << light;
    }
    // Light from below the smooth surface that the mapped normal faces.
    EXPECT_EQ(fade(terminator, kDiffuse, tilted(40), tilted(95)), 0.0f);
}

TEST(Terminator, LeavesTheSmoothNormalAndGlossyClosuresAlone) {
    constexpr ClosureTraits kGlossy{BounceKind::glossy, BounceKind::transmission};
    for (const BumpCorrection bump : {BumpCorrection::smoothed, BumpCorrection::microfacet}) {
        const Terminator terminator{bump, 1.0f, kUp};
        EXPECT_EQ(fade(terminator, kDiffuse, kUp, tilted(85)), 1.0f);
        EXPECT_EQ(fade(terminator, kGlossy, tilted(40), tilted(85)), 1.0f);
    }
}

// Samples carry the same light as eval() states, and an offset takes light at grazing angles alone.
TEST(Terminator, SamplesFadeToo) {
    const Vec3 wo = tilted(-20);
    ClosureList list;
    list.terminator = {BumpCorrection::microfacet, 1.25f, kUp};
    list.add(Spectrum(1.0f), Lambert{tilted(30)}, wo, false);
    Uniforms uniforms(5);
    for (int i = 0; i < 100; ++i) {
        const auto s = sample(list, kUp, wo, uniforms.three());
        if (!s) continue;
        const ClosureEval e = eval(list, kUp, wo, s->wi);
        EXPECT_FLOAT_EQ(s->weight.x * s->pdf_omega, e.f_cos.x);
    }
    const Terminator offset{BumpCorrection::none, 1.25f, kUp};
    EXPECT_NEAR(fade(offset, kDiffuse, kUp, kUp), 1.0f, 1e-6f);
    EXPECT_NEAR(fade(offset, kDiffuse, kUp, tilted(60)),
                std::cos(75 * std::numbers::pi / 180) / 0.5, 1e-5);
    EXPECT_EQ(fade(offset, kDiffuse, kUp, tilted(73)), 0.0f);
}

}  // namespace
}  // namespace spc::test
