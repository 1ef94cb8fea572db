// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/subsurface.h"

#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "math/warp.h"

namespace spc {
namespace {

constexpr float kLeastAlpha = 2e-5f;  // of facets that refract into the medium

float polynomial(float x, const std::array<float, 8>& coefficients) {
    float sum = 0.0f;
    for (size_t i = coefficients.size(); i-- > 0;) sum = sum * x + coefficients[i];
    return sum;
}

// Albedo of one scattering in a half-space that reflects `albedo` where light enters and leaves as
// from a diffuse surface, by a fit for anisotropies from 0 to 0.9 [Wrenninge17], with Cycles'
// numbers.
float scattering_albedo(float albedo, float g) {
    constexpr float kMost = 0.999999f;  // light gets out in the end
    const float a =
        polynomial(g, {1.8260523782f, -1.28451056436f, -1.79904629312f, 9.19393289202f,
                       -22.8215585862f, 32.0234874259f, -23.6264803333f, 7.21067002658f});
    const float b =
        4.98511194385f +
        0.127355959438f * std::exp(polynomial(g, {0.0f, 31.1491581433f, -201.847017512f,
                                                  841.576016723f, -2018.09288505f, 2731.71560286f,
                                                  -1935.41424244f, 559.009054474f}));
    const float c =
        polynomial(g, {1.09686102424f, -0.394704063468f, 1.05258115941f, -8.83963712726f,
                       28.8643230661f, -46.8802913581f, 38.5402837518f, -12.7181042538f});
    const float d =
        polynomial(g, {0.496310210422f, 0.360146581622f, -2.15139309747f, 17.8896899217f,
                       -55.2984010333f, 82.065982243f, -58.5106008578f, 15.8478295021f});
    const float e =
        4.23190299701f +
        0.00310603949088f * std::exp(polynomial(g, {0.0f, 76.7316253952f, -594.356773233f,
                                                    2448.8834203f, -5576.68528998f, 7116.60171912f,
                                                    -4763.54467887f, 1303.5318055f}));
    const float f = polynomial(g, {2.40602999408f, -2.51814844609f, 9.18494908356f, -79.2191708682f,
                                   259.082868209f, -403.613804597f, 302.85712436f, -87.4370473567f});
    const float dark = a * std::pow(std::atan(b * albedo), c),
                bright = d * std::pow(std::atan(e * albedo), f);
    return std::clamp(lerp(dark, bright, std::pow(albedo, 0.25f)), 0.0f, kMost);
}

// Reduced albedo at which a dipole reflects `albedo` [Jensen01 Eq. 2], by halving.
float dipole_albedo(float albedo, float ior) {
    const float inv = 1.0f / ior;
    const float f = inv * (-1.440f * inv + 0.710f) + 0.668f + 0.0636f * ior;
    const float boundary = 4.0f / 3.0f * (1.0f + f) / (1.0f - f);
    float low = 0.0f, high = 1.0f;
    for (int i = 0; i < 24; ++i) {
        const float a = 0.5f * (low + high), root = std::sqrt(3.0f * (1.0f - a));
        const float reflected = 0.5f * a * (1.0f + std::exp(-boundary * root)) * std::exp(-root);
        (reflected < albedo ? low : high) = a;
    }
    return 0.5f * (low + high);
}

}  // namespace

SubsurfaceMedium medium_of(const Subsurface& c) {
    constexpr float kLeastRadius = 1e-8f;  // m
    SubsurfaceMedium medium{Spectrum(0.0f), Spectrum(0.0f), c.anisotropy};
    for (int i = 0; i < 3; ++i) {
        float radius = std::max(c.radius[i], kLeastRadius);
        radius *= c.dipole_radius ? std::sqrt(3.0f * (1.0f - dipole_albedo(c.albedo[i], c.ior)))
                                  : 0.25f * kInvPi;  // Cycles' scale
        medium.single_scattering[i] = scattering_albedo(c.albedo[i], c.anisotropy);
        medium.extinction[i] = 1.0f / (std::max(radius, kLeastRadius) * (1.0f - c.anisotropy));
    }
    return medium;
}

std::optional<Vec3> enter(const Subsurface& c, const Vec3& ng, const Vec3& wo, float u_entry,
                          const Vec2& u) {
    const Frame frame = Frame::around(c.n);
    const bool through_facet =
        c.entry == SubsurfaceEntry::facets || (c.entry == SubsurfaceEntry::both && u_entry >= 0.5f);
    Vec3 w = frame.to_world(cosine_hemisphere(u)) * -1.0f;
    if (through_facet) {
        const Vec3 o = frame.to_local(wo);
        if (!(o.z > 0.0f)) return std::nullopt;
        const Vec3 m = frame.to_world(
            sample_visible_normal(MicrofacetModel::ggx, std::max(c.alpha, kLeastAlpha), o, u));
        const std::optional<Vec3> refracted = facet::refracted(wo, m, dot(wo, m), c.ior);
        if (!refracted) return std::nullopt;
        w = *refracted;
    }
    if (!(dot(ng, w) < 0.0f)) return std::nullopt;
    return w;
}

Vec3 sample_phase(const Vec3& direction, float g, const Vec2& u) {
    float cosine = 1.0f - 2.0f * u.x;
    if (std::abs(g) > 1e-3f) {
        const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * u.x);
        cosine = std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
    }
    const float sine = safe_sqrt(1.0f - cosine * cosine);
    const Vec2 c = unit_circle(u.y);
    return normalize(Frame::around(direction).to_world(Vec3(c.x * sine, c.y * sine, cosine)));
}

LobeEval eval_lobe(const Subsurface&, const Vec3&, const Vec3&, bool) { return {}; }

std::optional<LobeSample> sample_lobe(const Subsurface& c, const Vec3&, float, const Vec2&) {
    return LobeSample{c.n * -1.0f, BounceKind::diffuse, true, Spectrum(1.0f)};
}

Spectrum albedo_of(const Subsurface&, const Vec3&) { return Spectrum(1.0f); }

}  // namespace spc
