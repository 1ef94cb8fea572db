// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/thin_film.h"

#include "bsdf/fresnel.h"
#include "core/color_matching.h"
#include "math/warp.h"
#include "support/numerics.h"

#include <complex>

namespace spc::test {
namespace {

using Complex = std::complex<double>;

// What a film of index `film` and thickness d (nm) on an index `below`, seen from an index `above`,
// reflects of one wavelength: amplitudes of all reflections in it summed in closed form [BornWolf99
// Sec. 1.6].
double at_wavelength(double wavelength, double cos_1, double above, double film, double d,
                     Complex below) {
    const Complex n1 = above, n2 = film, n3 = below;
    const Complex sine = n1 * std::sqrt(1 - cos_1 * cos_1);
    const Complex c1 = cos_1, c2 = std::sqrt(1.0 - sine * sine / (n2 * n2)),
                  c3 = std::sqrt(1.0 - sine * sine / (n3 * n3));
    const Complex turn = std::exp(Complex(0, 4 * std::numbers::pi * film * d / wavelength) * c2);
    const auto both = [&](Complex a, Complex b) {
        return std::norm((a + b * turn) / (1.0 + a * b * turn));
    };
    const double s =
        both((n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), (n2 * c2 - n3 * c3) / (n2 * c2 + n3 * c3));
    const double p =
        both((n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2), (n3 * c2 - n2 * c3) / (n3 * c2 + n2 * c3));
    return 0.5 * (s + p);
}

// A bound of what the terms of the series after the third come to: a geometric series in what both
// sides reflect.
double neglected(double cos_1, double film, double below) {
    const double cos_2 = std::sqrt(1 - (1 - cos_1 * cos_1) / (film * film));
    const double sine = std::sqrt(1 - cos_1 * cos_1) / below;
    if (sine >= 1) return 0;
    const double cos_3 = std::sqrt(1 - sine * sine);
    const auto s = [](double n, double c, double to, double d) {
        return std::abs((n * c - to * d) / (n * c + to * d));
    };
    const double both = std::max(s(1, cos_1, film, cos_2) * s(film, cos_2, below, cos_3),
                                 s(film, cos_1, 1, cos_2) * s(below, cos_2, film, cos_3));
    return 2 * std::pow(both, 4) / (1 - both);
}

// The mean of that as a channel sees it.
template <class AtWavelength>
double seen(int channel, const AtWavelength& f) {
    double sum = 0, weights = 0;
    for (size_t w = 0; w < kColorMatching.size(); ++w) {
        const auto [x, y, z] = kColorMatching[w];
        const double weight = rec709_of_xyz({float(x), float(y), float(z)})[channel];
        sum += weight * f(double(kFirstWavelength) + double(kWavelengthStep) * double(w));
        weights += weight;
    }
    return sum / weights;
}

TEST(ThinFilm, OverADielectricIsTheMeanOverWavelengths) {
    double range = 0;
    for (const float below : {1.5f, 2.4f, 1.0f})
        for (const float index : {1.33f, 1.8f})
            for (const float d : {80.0f, 300.0f, 550.0f, 1200.0f})
                for (const float c : {0.25f, 0.5f, 0.8f, 1.0f}) {
                    const Spectrum r = facet::film_over_dielectric({d, index}, c, below);
                    for (int k = 0; k < 3; ++k) {
                        const double expected = std::clamp(
                            seen(k,
                                 [&](double w) {
                                     return at_wavelength(w, c, 1, index, d, double(below));
                                 }),
                            0.0, 1.0);
                        EXPECT_NEAR(r[k], expected, 0.003 + neglected(c, index, below))
                            << below << " " << index << " " << d << " " << c << " " << k;
                        range = std::max(range, std::abs(expected - fresnel_dielectric(c, below)));
                    }
                }
    EXPECT_GT(range, 0.2);  // the film makes a difference
}

TEST(ThinFilm, OverAConductorIsTheMeanOverWavelengths) {
    const Spectrum eta(0.2f, 0.9f, 1.5f), k(3.9f, 2.4f, 1.9f);
    for (const float index : {1.33f, 1.8f})
        for (const float d : {80.0f, 300.0f, 900.0f})
            for (const float c : {0.4f, 0.8f, 1.0f}) {
                const Spectrum r = facet::film_over_conductor({d, index}, c, eta, k);
                for (int i = 0; i < 3; ++i) {
                    const double expected = std::clamp(
                        seen(i,
                             [&](double w) {
                                 return at_wavelength(w, c, 1, index, d, Complex(eta[i], k[i]));
                             }),
                        0.0, 1.0);
                    EXPECT_NEAR(r[i], expected, 0.02) << index << " " << d << " " << c << " " << i;
                }
            }
}

// An F82 model that a conductor's values make has its phases.
TEST(ThinFilm, OverAMetalByItsColourIsNearTheConductor) {
    const Spectrum eta(0.2f, 0.9f, 1.5f), k(3.9f, 2.4f, 1.9f);
    const Fresnel gold{Fresnel::Kind::conductor, 1.0f, eta, k};
    const Spectrum f0 = fresnel(gold, 1.0f), at_82 = fresnel(gold, 1.0f / 7);
    for (const float d : {150.0f, 400.0f}) {
        const Spectrum exact = facet::film_over_conductor({d, 1.5f}, 1.0f, eta, k),
                       model = facet::film_over_f82({d, 1.5f}, 1.0f, f0, at_82);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(model[i], exact[i], 0.08) << d << " " << i;
    }
}

TEST(ThinFilm, OfAnIndexBesideItIsNone) {
    for (const float eta : {1.5f, 1 / 1.5f})
        for (const float index : {1.0f, eta})
            for (int i = 1; i <= 40; ++i) {
                const float c = static_cast<float>(i) / 40;
                const Spectrum r = facet::film_over_dielectric({500.0f, index}, c, eta);
                for (int k = 0; k < 3; ++k)
                    EXPECT_NEAR(r[k], fresnel_dielectric(c, eta), 2e-5) << c << " " << eta;
            }
}

TEST(ThinFilm, FadesToNoneAsItsThicknessDoes) {
    EXPECT_FALSE((ThinFilm{0.0f, 1.33f}).exists());
    for (const float c : {0.2f, 0.6f, 1.0f}) {
        const Spectrum r = facet::film_over_dielectric({0.1f, 1.33f}, c, 1.5f);
        EXPECT_NEAR(r.x, fresnel_dielectric(c, 1.5f), 1e-3);
        const Fresnel f82{Fresnel::Kind::f82, 1.0f, Spectrum(0.9f, 0.6f, 0.3f), Spectrum(0.8f)};
        Fresnel filmed = f82;
        filmed.film = {0.1001f, 1.33f};
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(fresnel(filmed, c)[k], fresnel(f82, c)[k], 0.01);
    }
}

TEST(ThinFilm, IsTheSameFromBothSides) {
    const float eta = 1.5f, index = 1.33f, d = 420.0f;
    for (int i = 1; i <= 50; ++i) {
        const float c = static_cast<float>(i) / 50;
        const float cos_t = std::sqrt(1 - (1 - c * c) / (eta * eta));
        const Spectrum above = facet::film_over_dielectric({d, index}, c, eta);
        const Spectrum below = facet::film_over_dielectric({d * eta, index / eta}, cos_t, 1 / eta);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(above[k], below[k], 2e-4) << c << " " << k;
    }
    EXPECT_EQ(facet::film_over_dielectric({d * eta, index / eta}, 0.5f, 1 / eta), Spectrum(1.0f));
}

// A facet's reflected and refracted light add up, and a delta's part is what samples carry.
TEST(ThinFilm, GlassKeepsTheLight) {
    Uniforms uniforms(3);
    const Vec3 n(0, 0, 1);
    for (const float eta : {1.5f, 1 / 1.5f})
        for (int i = 0; i < 200; ++i) {
            const Vec3 wo = cosine_hemisphere(uniforms.two());
            MicrofacetDielectric glass{n,    0.0f, MicrofacetModel::ggx, eta,           true,
                                       true, true, Spectrum(1.0f),       Spectrum(1.0f)};
            glass.film = {uniforms() * 800.0f, 0.8f + uniforms()};
            ClosureList list;
            list.add(Spectrum(1.0f), glass, wo, true);
            const Vec3 up = facet::mirrored(wo, n, wo.z);
            const DeltaLobe mirrored = delta_lobe(list, n, wo, up, false);
            Spectrum all = mirrored.throughput;
            double probability = mirrored.probability;
            if (const auto down = facet::refracted(wo, n, wo.z, eta)) {
                const DeltaLobe refracted = delta_lobe(list, n, wo, *down, true);
                all += refracted.throughput;
                probability += refracted.probability;
            }
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(all[k], 1.0f, 1e-6);
            EXPECT_NEAR(probability, 1.0, 1e-6);
        }
}

}  // namespace
}  // namespace spc::test
