// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/subsurface.h"

#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "math/warp.h"

namespace spc {
namespace {

constexpr float kLeastAlpha = 2e-5f;  // of facets that refract into the medium

// Albedo of one isotropic scattering in a half-space that reflects `albedo` where light enters and
// leaves as from a diffuse surface: the fit of [Wrenninge17] as Cycles has it, without anisotropy.
float scattering_albedo(float albedo) {
    constexpr float kMost = 0.999999f;  // light gets out in the end
    const float dark = 1.8260523782f * std::pow(std::atan(5.1124678f * albedo), 1.09686102424f);
    const float bright = 0.496310210422f * std::pow(std::atan(4.2350090f * albedo), 2.40602999408f);
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
        const float reflected =
            0.5f * a * (1.0f + std::exp(-boundary * root)) * std::exp(-root);
        (reflected < albedo ? low : high) = a;
    }
    return 0.5f * (low + high);
}

}  // namespace

// By similarity, a medium of anisotropy g scatters as an isotropic one of sigma_s (1 - g).
SubsurfaceMedium medium_of(const Subsurface& c) {
    constexpr float kLeastRadius = 1e-8f;  // m
    SubsurfaceMedium medium{Spectrum(0.0f), Spectrum(0.0f), c.anisotropy};
    for (int i = 0; i < 3; ++i) {
        float radius = std::max(c.radius[i], kLeastRadius);
        if (c.dipole_radius)
            radius *= std::sqrt(3.0f * (1.0f - dipole_albedo(c.albedo[i], c.ior)));
        const float reduced = scattering_albedo(c.albedo[i]);
        const float scattered = reduced / (1.0f - c.anisotropy), all = scattered + 1.0f - reduced;
        medium.extinction[i] = all / std::max(radius, kLeastRadius);
        medium.single_scattering[i] = scattered / all;
    }
    return medium;
}

std::optional<Vec3> enter(const Subsurface& c, const Vec3& ng, const Vec3& wo, float u_entry,
                          const Vec2& u) {
    const Frame frame = Frame::around(c.n);
    const bool through_facet = c.entry == SubsurfaceEntry::facets ||
                               (c.entry == SubsurfaceEntry::both && u_entry >= 0.5f);
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
