// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/thin_film.h"

#include "bsdf/fresnel.h"
#include "core/color_matching.h"

#include <complex>

namespace spc::facet {
namespace {

using Complex = std::complex<float>;

// The mean of exp(2 pi i path / wavelength) over wavelengths, as each channel weighs them, by the
// optical path in nm.
class Sensitivity {
public:
    Sensitivity() {
        std::array<std::array<std::complex<double>, 3>, kNodes> sums{};
        for (size_t w = 0; w < kColorMatching.size(); ++w) {
            const auto [x, y, z] = kColorMatching[w];
            const Spectrum weight =
                rec709_of_xyz({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
            const double wavelength = kFirstWavelength + kWavelengthStep * static_cast<double>(w);
            for (size_t node = 0; node < kNodes; ++node) {
                const double turns = kStep * static_cast<double>(node) / wavelength;
                for (int k = 0; k < 3; ++k)
                    sums[node][static_cast<size_t>(k)] +=
                        std::polar<double>(1.0, 2.0 * std::numbers::pi * turns) *
                        static_cast<double>(weight[k]);
            }
        }
        for (size_t node = 0; node < kNodes; ++node)
            for (size_t k = 0; k < 3; ++k) table_[node][k] = Complex(sums[node][k] / sums[0][k]);
    }

    std::array<Complex, 3> operator()(float path) const {
        const float position = std::min(path / kStep, static_cast<float>(kNodes - 1));
        const size_t low = std::min(static_cast<size_t>(position), kNodes - 2);
        const float t = position - static_cast<float>(low);
        std::array<Complex, 3> result;
        for (size_t k = 0; k < 3; ++k)
            result[k] = table_[low][k] * (1.0f - t) + table_[low + 1][k] * t;
        return result;
    }

private:
    // Up to the longest path, beyond which hardly anything is left but the mean.
    static constexpr size_t kNodes = 512;
    static constexpr float kStep = 60000.0f / (2.0f * kPi) / static_cast<float>(kNodes - 1);  // nm
    std::array<std::array<Complex, 3>, kNodes> table_;
};

constexpr int kTerms = 3;  // of the series; Cycles' number
using Sensitivities = std::array<std::array<Complex, 3>, kTerms>;

// At each multiple of the path by which light that crosses the film and comes back is late.
Sensitivities sensitivities(float path) {
    static const Sensitivity sensitivity;
    Sensitivities result;
    for (int m = 0; m < kTerms; ++m)
        result[static_cast<size_t>(m)] = sensitivity(static_cast<float>(m + 1) * path);
    return result;
}

// Both polarisations, s and p, of what one side of the film reflects.
template <class T>
struct Polarised {
    T s, p;
};

// Amplitudes at the upper side; `cos_2` is the cosine in the film.
Polarised<float> upper_side(float cos_1, float eta, float cos_2) {
    return {(cos_1 - eta * cos_2) / (cos_1 + eta * cos_2),
            (eta * cos_1 - cos_2) / (eta * cos_1 + cos_2)};
}
// Amplitudes at the lower side, to what has a complex index relative to that of the film.
Polarised<Complex> lower_side(float cos_2, Complex eta) {
    const Complex eta2 = eta * eta, eta_cos_3 = std::sqrt(eta2 - (1.0f - cos_2 * cos_2));
    return {(cos_2 - eta_cos_3) / (cos_2 + eta_cos_3),
            (eta2 * cos_2 - eta_cos_3) / (eta2 * cos_2 + eta_cos_3)};
}

// The series of one polarisation and channel k: a mean and `kTerms` waves. `upper` is an amplitude,
// `lower` a reflectance and `turn` the phase that comes with it, as a unit number.
float airy(float upper, float lower, Complex turn, const Sensitivities& seen, size_t k) {
    const float r12 = upper * upper, once = 1.0f - r12, both = r12 * lower;
    const float below = once * once * lower / std::max(1.0f - both, 1e-6f);
    const float decay = std::sqrt(both);
    if (upper > 0.0f) turn = -turn;  // from within the film its upper side turns it
    float sum = r12 + below, amplitude = below - once;
    Complex phase = turn;
    for (const auto& term : seen) {
        amplitude *= decay;
        sum += 2.0f * amplitude * (phase * term[k]).real();
        phase *= turn;
    }
    return sum;
}
float airy(float upper, Complex lower, const Sensitivities& seen, size_t k) {
    const float magnitude = std::abs(lower);
    const Complex turn = magnitude > 0.0f ? lower / magnitude : Complex(1.0f);
    return airy(upper, magnitude * magnitude, turn, seen, k);
}

// What lies below: its channels' amplitudes at the film, by the cosine there.
template <class Lower>
Spectrum reflectance(const ThinFilm& film, float cos_o, const Lower& lower) {
    const float c = std::min(std::abs(cos_o), 1.0f);
    const float g2 = refracted_cos_squared(c, film.ior);
    if (!(g2 > 0.0f)) return Spectrum(1.0f);
    const float cos_2 = std::sqrt(g2) / film.ior;
    const Polarised<float> upper = upper_side(c, film.ior, cos_2);
    const Sensitivities seen = sensitivities(2.0f * film.thickness * film.ior * cos_2);
    Spectrum result;
    for (int k = 0; k < 3; ++k) result[k] = clamp01(lower(k, cos_2, upper, seen));
    return result;
}

// Films of less than a nanometre fade: three terms do not sum up to nothing.
Spectrum faded(const ThinFilm& film, const Spectrum& bare, const Spectrum& filmed) {
    const float t = clamp01(film.thickness);
    return bare + (filmed - bare) * (t * t * (3.0f - 2.0f * t));
}

}  // namespace

Spectrum film_over_dielectric(const ThinFilm& film, float cos_o, float eta) {
    const float bare = dielectric(cos_o, eta);
    if (bare >= 1.0f) return Spectrum(1.0f);
    const Spectrum filmed = reflectance(
        film, cos_o,
        [&](int k, float cos_2, const Polarised<float>& upper, const Sensitivities& seen) {
            const Polarised<Complex> lower = lower_side(cos_2, eta / film.ior);
            const auto channel = static_cast<size_t>(k);
            return 0.5f *
                   (airy(upper.s, lower.s, seen, channel) + airy(upper.p, lower.p, seen, channel));
        });
    return faded(film, Spectrum(bare), filmed);
}

Spectrum film_over_conductor(const ThinFilm& film, float cos_o, const Spectrum& eta,
                             const Spectrum& k) {
    const Spectrum filmed = reflectance(
        film, cos_o,
        [&](int i, float cos_2, const Polarised<float>& upper, const Sensitivities& seen) {
            const Polarised<Complex> lower = lower_side(cos_2, Complex(eta[i], k[i]) / film.ior);
            const auto channel = static_cast<size_t>(i);
            return 0.5f *
                   (airy(upper.s, lower.s, seen, channel) + airy(upper.p, lower.p, seen, channel));
        });
    return faded(film, fresnel({Fresnel::Kind::conductor, 1.0f, eta, k}, cos_o), filmed);
}

Spectrum film_over_f82(const ThinFilm& film, float cos_o, const Spectrum& f0, const Spectrum& at_82) {
    const Spectrum bare_tint = f82_tint(f0, at_82);
    const Spectrum filmed = reflectance(film, cos_o, [&](int i, float cos_2, const Polarised<float>& upper, const Sensitivities& seen) {
        const float r = std::min(f0[i], 0.999f), root = std::sqrt(r);
        const float eta = lerp((1.0f + root) / (1.0f - root), (1.0f - r) / (1.0f + r), at_82[i]);
        const float k = safe_sqrt((r * sqr(eta + 1.0f) - sqr(eta - 1.0f)) / (1.0f - r));
        const Complex index = Complex(eta, k) / film.ior;
        const Polarised<Complex> lower = lower_side(cos_2, index);
        const Spectrum below(std::norm((index - 1.0f) / (index + 1.0f)));
        const Fresnel model{Fresnel::Kind::f82, 1.0f, below, f82_tint(below, Spectrum(at_82[i]))};
        const float reflected = fresnel(model, cos_2).x;
        const auto channel = static_cast<size_t>(i);
        const auto turn = [](Complex amplitude) {
            const float magnitude = std::abs(amplitude);
            return magnitude > 0.0f ? amplitude / magnitude : Complex(1.0f);
        };
        return 0.5f * (airy(upper.s, reflected, turn(lower.s), seen, channel) +
                       airy(upper.p, reflected, turn(lower.p), seen, channel));
    });
    return faded(film, fresnel({Fresnel::Kind::f82, 1.0f, f0, bare_tint}, cos_o), filmed);
}

}  // namespace spc::facet
