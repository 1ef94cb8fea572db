// SPDX-License-Identifier: GPL-3.0-or-later
// What happens at one flat facet: Fresnel's equations, the mirrored and the refracted direction.
// Inline for the closures; closure.h offers the two public functions. Directions point away from
// the surface, cosines are those of wo, eta = ior on the far side / ior on the side of wo.
#pragma once

#include "bsdf/closure.h"

namespace spc::facet {

// eta times the cosine of the refracted direction, squared; zero or less at total internal
// reflection.
inline float refracted_cos_squared(float cos_o, float eta) {
    return (eta - 1.0f) * (eta + 1.0f) + cos_o * cos_o;
}

// Unpolarised reflectance; exactly 1 where refracted_cos_squared <= 0, exactly 0 for eta = 1. The
// amplitudes of both polarisations are written with g = eta cos_t, which avoids cancellation
// [Walter07]: (c - g)/(c + g) and (eta^2 c - g)/(eta^2 c + g).
inline float dielectric(float cos_o, float eta) {
    if (eta == 1.0f) return 0.0f;
    const float c = std::min(std::abs(cos_o), 1.0f);
    const float g2 = refracted_cos_squared(c, eta);
    if (!(g2 > 0.0f)) return 1.0f;
    const float g = std::sqrt(g2);
    const float c_eta2 = eta * eta * c;
    const float inv = 1.0f / ((c + g) * (c_eta2 + g));
    const float s = (c - g) * (c_eta2 + g) * inv;
    const float p = (c_eta2 - g) * (c + g) * inv;
    return std::min(0.5f * (s * s + p * p), 1.0f);
}
// Reflectance at normal incidence.
inline float dielectric_f0(float eta) { return sqr((eta - 1.0f) / (eta + 1.0f)); }

inline Vec3 mirrored(const Vec3& wo, const Vec3& m, float cos_o) { return m * (2.0f * cos_o) - wo; }

// Empty at total internal reflection. cos_o = dot(wo, m) > 0.
inline std::optional<Vec3> refracted(const Vec3& wo, const Vec3& m, float cos_o, float eta) {
    if (eta == 1.0f) return -wo;
    const float g2 = refracted_cos_squared(cos_o, eta);
    if (!(g2 > 0.0f)) return std::nullopt;
    return normalize(m * (cos_o - std::sqrt(g2)) - wo);
}

inline Spectrum saturate(const Spectrum& c) { return {clamp01(c.x), clamp01(c.y), clamp01(c.z)}; }

// Coefficient b of the dip -b c (1-c)^6 that the F82 model adds to Schlick's curve [Kutz21]: it
// vanishes at both ends and is largest at cos = 1/7, where it must scale Schlick's value by f82.
inline Spectrum f82_dip(const Spectrum& f0, const Spectrum& f82) {
    constexpr float kFifth = 7776.0f / 16807.0f;                // (6/7)^5
    constexpr float kShape = (1.0f / 7) * (6.0f / 7) * kFifth;  // c (1-c)^6 at c = 1/7
    const Spectrum schlick = f0 + (Spectrum(1.0f) - f0) * kFifth;
    return schlick * (Spectrum(1.0f) - f82) * (1.0f / kShape);
}

// The tint of an F82 model by what it reflects at 82 degrees.
inline Spectrum f82_tint(const Spectrum& f0, const Spectrum& at_82) {
    return at_82 / (f0 + (Spectrum(1.0f) - f0) * (7776.0f / 16807.0f));
}

// Share of the light that a facet of a dielectric reflects, whatever it does with it.
Spectrum reflectance(const MicrofacetDielectric& c, float cos_o);

}  // namespace spc::facet
