// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/hair.h"

#include "bsdf/closure.h"
#include "bsdf/fresnel.h"
#include "bsdf/reference.h"
#include "math/warp.h"
#include "support/chi_square.h"

#include <string>

namespace spc::test {
namespace {

const Vec3 kTangent = normalize(Vec3(0.3f, -0.5f, 0.8f));

// From the fibre's cross-section towards its tangent.
Vec3 outgoing(float degrees) {
    const Frame frame = Frame::around(kTangent);
    const float theta = degrees * kPi / 180;
    return kTangent * std::sin(theta) + frame.x * std::cos(theta);
}

HairFibre fibre(float h, float absorption, float roughness, float around, float tilt = 0.035f,
                float coat = 0.0f) {
    return hair_fibre(kTangent, h, Spectrum(absorption), roughness, around, coat, 1.55f, tilt);
}

// The side of wo, as the geometry's normal has it.
Vec3 side_of(const Vec3& wo) { return normalize(wo - kTangent * dot(kTangent, wo)); }

struct Case {
    std::string text;
    ClosureKind kind;
    Vec3 wo;
};
std::vector<Case> cases() {
    std::vector<Case> all;
    for (const float degrees : {0.0f, -35.0f, 70.0f})
        for (const float h : {-0.9f, 0.0f, 0.5f}) {
            const std::string text = std::to_string(degrees) + " h " + std::to_string(h);
            all.push_back({"rough " + text, fibre(h, 0.3f, 0.6f, 0.7f), outgoing(degrees)});
            all.push_back({"smooth " + text, fibre(h, 0.1f, 0.35f, 0.3f), outgoing(degrees)});
            if (std::abs(degrees) <
                50)  // else beyond the ends, where the grid is too coarse for the density
                all.push_back({"tilted, coated " + text, fibre(h, 1.0f, 0.5f, 0.5f, 0.3f, 0.4f),
                               outgoing(degrees)});
        }
    for (const bool transmits : {false, true})
        for (const float degrees : {0.0f, 50.0f})
            all.push_back(
                {"lobe", HairLobe{side_of(outgoing(degrees)), kTangent, 0.3f, 0.6f, 0.1f, transmits},
                 outgoing(degrees)});
    return all;
}

ClosureList list_of(const Case& c) {
    ClosureList list;
    list.add(Spectrum(1.0f), c.kind, c.wo, false);
    return list;
}

// Hypothesis: sample() draws from eval()'s density. 5 % family.
TEST(HairSlow, SamplersFollowTheirDensities) {
    const std::vector<Case> all = cases();
    const double significance = sidak(0.05, static_cast<int>(all.size()));
    uint64_t seed = 700;
    for (const Case& c : all) {
        const ClosureList list = list_of(c);
        const Vec3 ng = side_of(c.wo);
        Uniforms uniforms(seed++);
        const SphereGrid grid{Frame::around(kTangent), 12, 16, 1};
        const ChiSquare result = chi_square_sphere(
            grid, 60000,
            [&]() -> std::optional<Vec3> {
                const auto s = sample(list, ng, c.wo, uniforms.three());
                if (!s) return std::nullopt;
                EXPECT_EQ(s->refracted, dot(ng, s->wi) < 0.0f);
                return s->wi;
            },
            [&](const Vec3& wi) { return eval(list, ng, c.wo, wi).pdf_omega; });
        EXPECT_TRUE(result.passes(significance)) << c.text << ": " << result.text();
        EXPECT_LE(result.integral, 1 + 1e-3) << c.text;
    }
}

// A white hair between equally bright surroundings is not seen.
TEST(Hair, AClearFibreKeepsAllLight) {
    for (const float degrees : {0.0f, -40.0f, 65.0f})
        for (const float h : {-0.8f, 0.1f})
            for (const float roughness : {0.3f, 0.8f}) {
                const HairFibre c = fibre(h, 0.0f, roughness, roughness);
                const Vec3 wo = outgoing(degrees);
                EXPECT_NEAR(albedo(c, wo).x, 1.0f, 1e-5);
                const double all = integrate_sphere(
                    Frame::around(kTangent),
                    [&](const Vec3& wi) { return double(eval_lobe(c, wo, wi, false).f_cos.y); },
                    1e-4, 1);
                EXPECT_NEAR(all, 1.0, 2e-3) << degrees << " " << h << " " << roughness;
            }
}

// The ray through a circle of index eta, bent at its wall by Snell's law: reflected, let through
// and sent back it leaves in these directions, in which a smooth fibre's lobes have their peaks.
TEST(Hair, LobesPointWhereRaysThroughACircleGo) {
    const float eta = 1.55f;
    for (const float h : {-0.7f, -0.2f, 0.4f}) {
        HairFibre c = fibre(h, 0.0f, 0.1f, 0.1f, 0.0f);
        const Vec3 wo = outgoing(0.0f), y = side_of(wo), z = cross(kTangent, y);
        const float gamma = std::asin(h), gamma_t = std::asin(h / eta);
        float f = facet::dielectric(std::cos(gamma), eta);
        float share = f;
        for (int p = 0; p < 3; ++p) {
            // Where it leaves the circle, turned by each of the chords that it has gone, and bent
            // out again.
            const float phi = -gamma + float(p) * (kPi + 2 * gamma_t) - gamma;
            const Vec3 peak = y * std::cos(phi) + z * std::sin(phi);
            Vec3 aside = y * std::cos(phi + 0.15f) + z * std::sin(phi + 0.15f);
            const float at = eval_lobe(c, wo, peak, false).f_cos.x,
                        beside = eval_lobe(c, wo, aside, false).f_cos.x;
            if (share > 0.02f) {
                EXPECT_GT(at, 1.05f * beside) << h << " " << p;
            }
            share = p == 0 ? sqr(1 - f) : share * f;
        }
    }
}

// Beer's law on the chord: what goes through once, over what a clear fibre lets through.
TEST(Hair, AbsorbsAlongTheChord) {
    const float h = 0.3f, eta = 1.55f;
    const Vec3 wo = outgoing(0.0f);
    const float cos_t = std::sqrt(1 - sqr(h / eta)),
                f = facet::dielectric(std::sqrt(1 - h * h), eta);
    const double passed = std::exp(-0.7 * 2 * cos_t);
    double expected = f, through = (1.0 - f) * (1.0 - f) * passed;
    for (int i = 0; i < 60; ++i) {
        expected += through;
        through *= passed * f;
    }
    EXPECT_NEAR(albedo(fibre(h, 0.7f, 0.3f, 0.3f), wo).x, expected, 1e-5);
}

// Points that lie evenly over the visible width of a tube are even across the fibre.
TEST(Hair, ATubeIsAsWideAsItsFibre) {
    const Frame frame = Frame::around(kTangent);
    const float half = kPi / kTubeSides;
    for (const float turn : {0.1f, 0.4f, 0.7f, 1.3f}) {
        const Vec3 wo = frame.x * std::cos(turn) + frame.y * std::sin(turn);
        const Vec3 z = cross(kTangent, wo);
        float widest = 0.0f;
        for (int k = 0; k < kTubeSides; ++k) {
            const float at = half * static_cast<float>(2 * k + 1);
            const Vec3 corner = frame.x * std::cos(at) + frame.y * std::sin(at);
            widest = std::max(widest, dot(corner, z) / std::cos(half));
        }
        for (const float t : {-0.9f, -0.3f, 0.2f, 0.8f}) {
            const Vec3 place =
                frame.x + frame.y * (t * std::tan(half));  // on the side whose normal is x
            const Vec3 n = normalize(place);
            EXPECT_NEAR(across_tube(kTangent, n, frame.x, wo), -dot(place, z) / widest, 1e-5);
        }
    }
    EXPECT_NEAR(across_fibre(kTangent, frame.y, frame.x), -1.0f, 1e-6);
}

}  // namespace
}  // namespace spc::test
