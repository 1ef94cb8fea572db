// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/fresnel.h"

#include "bsdf/thin_film.h"
#include "core/error.h"

namespace spc {
namespace {

// Exact reflectance at a conductor of index eta + i k, seen from vacuum. With a^2 + b^2 = |t|, t =
// (eta + ik)^2 - sin^2, the two polarisations are real rational functions of a, |t| and the angle
// [BornWolf99 Sec. 14.2].
float conductor(float cos_o, float eta, float k) {
    const float c2 = cos_o * cos_o, s2 = 1.0f - c2;
    const float t = eta * eta - k * k - s2;
    const float norm = std::sqrt(t * t + 4.0f * eta * eta * k * k);
    const float a_c = 2.0f * cos_o * safe_sqrt(0.5f * (norm + t));
    const float s = (norm + c2 - a_c) / (norm + c2 + a_c);
    const float p_base = c2 * norm + s2 * s2, p_mixed = a_c * s2;
    // At grazing incidence on an index of 1 both are 0/0; there is no interface then.
    if (!(norm + c2 + a_c > 0.0f) || !(p_base + p_mixed > 0.0f))
        return clamp01(s > 0.0f ? s : 0.0f);
    return clamp01(0.5f * s * (1.0f + (p_base - p_mixed) / (p_base + p_mixed)));
}

// With a film some colours may reflect less than at normal incidence without one: what a tint f0
// says of that is scaled, the less the nearer to total reflection, as in Cycles.
Spectrum film_with_f0(const Fresnel& f, float cos_o) {
    const float natural = facet::dielectric_f0(f.eta);
    const Spectrum filmed = facet::film_over_dielectric(f.film, cos_o, f.eta);
    if (!(natural > 1e-5f)) return filmed;
    const Spectrum share = facet::saturate((Spectrum(1.0f) - filmed) * (1.0f / (1.0f - natural)));
    return filmed * (Spectrum(1.0f) + (f.f0 * (1.0f / natural) - Spectrum(1.0f)) * share);
}

Spectrum with_film(const Fresnel& f, float cos_o) {
    switch (f.kind) {
        case Fresnel::Kind::dielectric_f0: return film_with_f0(f, cos_o);
        case Fresnel::Kind::conductor:
            return facet::film_over_conductor(f.film, cos_o, f.f0, f.f82);
        case Fresnel::Kind::f82: {
            const Fresnel bare{f.kind, f.eta, f.f0, f.f82};
            return facet::film_over_f82(f.film, cos_o, f.f0, fresnel(bare, 1.0f / 7.0f));
        }
        case Fresnel::Kind::none:
        case Fresnel::Kind::dielectric: break;
    }
    SPC_ASSERT(false);
    return Spectrum(0.0f);
}

}  // namespace

Spectrum facet::reflectance(const MicrofacetDielectric& c, float cos_o) {
    if (c.normal_tint != Spectrum(1.0f)) {
        const Spectrum f0 = saturate(c.normal_tint * dielectric_f0(c.eta));
        return fresnel(Fresnel{Fresnel::Kind::dielectric_f0, c.eta, f0, {}, c.film}, cos_o);
    }
    if (c.film.exists()) return film_over_dielectric(c.film, cos_o, c.eta);
    return Spectrum(dielectric(cos_o, c.eta));
}

float fresnel_dielectric(float cos_i, float eta) { return facet::dielectric(cos_i, eta); }

Spectrum fresnel(const Fresnel& f, float cos_wo_h) {
    const float c = clamp01(std::abs(cos_wo_h));
    if (f.film.exists()) return with_film(f, c);
    switch (f.kind) {
        case Fresnel::Kind::none: return f.f0;
        case Fresnel::Kind::dielectric: return f.f0 * facet::dielectric(c, f.eta);
        case Fresnel::Kind::dielectric_f0: {
            const float f0 = facet::dielectric_f0(f.eta);
            const float rise = clamp01((facet::dielectric(c, f.eta) - f0) / (1.0f - f0));
            return f.f0 + (Spectrum(1.0f) - f.f0) * rise;
        }
        case Fresnel::Kind::conductor:
            return {conductor(c, f.f0.x, f.f82.x), conductor(c, f.f0.y, f.f82.y),
                    conductor(c, f.f0.z, f.f82.z)};
        case Fresnel::Kind::f82: {
            const float m = 1.0f - c, m2 = m * m, m5 = m2 * m2 * m;
            return facet::saturate(f.f0 + (Spectrum(1.0f) - f.f0) * m5 -
                                   facet::f82_dip(f.f0, f.f82) * (c * m5 * m));
        }
    }
    return Spectrum(0.0f);
}

}  // namespace spc
