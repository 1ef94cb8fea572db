// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/diffuse.h"

#include "math/warp.h"

namespace spc {
namespace {

LobeSample around_normal(const Vec3& n, const Vec2& u) {
    return {Frame::around(n).to_world(cosine_hemisphere(u)), BounceKind::diffuse};
}

float fifth_power_from_grazing(float cos_theta) {
    const float m = clamp01(1.0f - cos_theta), m2 = m * m;
    return m2 * m2 * m;
}

// Coefficients of [Fujii12]: f = (flat + along t) for white facets, in 1/sr.
struct Fujii {
    float flat, along;
    explicit Fujii(float roughness)
        : flat(1.0f / (kPi + roughness * (0.5f * kPi - 2.0f / 3.0f))), along(roughness * flat) {}

    // Directional albedo, by the integral of t over the hemisphere [Portsmouth25 Eq. 10].
    float albedo(float cos_theta) const { return flat * kPi + along * retro(cos_theta); }
    float mean_albedo() const { return flat * kPi + along * (2.0f * kPi - 5.6f) / 3.0f; }

private:
    static float retro(float c) {
        constexpr float kGrazing = 1e-4f;  // where the tangent has lost its digits
        constexpr float kTwoThirds = 2.0f / 3.0f;
        if (c < kGrazing) return 0.5f * kPi - kTwoThirds - c;
        const float s = safe_sqrt((1.0f - c) * (1.0f + c)), theta = std::acos(std::min(c, 1.0f));
        return s * (theta - s * c - kTwoThirds) + kTwoThirds * s / c * (1.0f - s * s * s);
    }
};

// Light that left a facet for another one, which gives it back [Portsmouth25].
Spectrum exchange_of(const OrenNayar& c, const Fujii& f) {
    const float mean = f.mean_albedo(), lost = 1.0f - mean;
    const Spectrum a = c.exchanged;
    return a * a * (mean / lost) / (Spectrum(1.0f) - a * lost);
}

// Where the clipped cone of a toon ends, and how much light an angle within it has.
template <BounceKind kind>
float edge_of(const Toon<kind>& c) {
    return std::min(c.plateau + c.fade, 0.5f * kPi);
}
template <BounceKind kind>
float brightness(const Toon<kind>& c, float angle) {
    if (angle < c.plateau) return 1.0f;
    return c.fade > 0.0f ? std::max(1.0f - (angle - c.plateau) / c.fade, 0.0f) : 0.0f;
}
template <BounceKind kind>
LobeEval eval_around(const Toon<kind>& c, const Vec3& axis, const Vec3& wi) {
    const float edge = edge_of(c), angle = std::acos(std::clamp(dot(axis, wi), 0.0f, 1.0f));
    if (!(angle < edge)) return {};
    const float pdf = uniform_cone_pdf(one_minus_cos(edge));
    return {Spectrum(pdf * brightness(c, angle)), pdf};
}
template <BounceKind kind>
std::optional<LobeSample> sample_around(const Toon<kind>& c, const Vec3& axis, const Vec2& u) {
    const float edge = edge_of(c);
    if (!(edge > 0.0f)) return std::nullopt;
    return LobeSample{Frame::around(axis).to_world(uniform_cone(u, one_minus_cos(edge))), kind};
}
// Mean brightness over the cone.
template <BounceKind kind>
float mean_brightness(const Toon<kind>& c) {
    const float edge = edge_of(c), solid = one_minus_cos(edge);
    if (!(solid > 0.0f)) return 0.0f;
    if (!(c.fade > 0.0f)) return 1.0f;
    const float last = 1.0f - (edge - c.plateau) / c.fade;
    const float sines = (std::sin(edge) - std::sin(c.plateau)) / c.fade;
    return std::min((1.0f - last * std::cos(edge) - sines) / solid, 1.0f);
}

// The matrix [a 0 b; 0 a 0; 0 0 1] takes the lobe to a cosine's, in the frame whose x axis is wo's.
// Rational fits to the tables of [Zeltner22], by S. Hill for MaterialX.
struct SheenLobe {
    float a, b;
    SheenLobe(float x, float y)
        : a((2.58126f * x + 0.813703f * y) * y / (1.0f + 0.310327f * x * x + 2.60994f * x * y)),
          b(safe_sqrt(1.0f - x) * (y - 1.0f) * y * y * y /
            (0.0000254053f + 1.71228f * x - 1.71506f * x * y + 1.34174f * y * y)) {}
};
Frame sheen_frame(const Vec3& n, const Vec3& wo) {
    constexpr float kSlant = 1e-4f;  // below it rounding turns the plane of wo, and b vanishes
    const Vec3 along = wo - n * dot(n, wo);
    if (!(length_squared(along) > sqr(kSlant))) return Frame::around(n);
    const Vec3 x = normalize(along);
    return {x, cross(n, x), n};
}

// Facets of Velvet by the half-vector's cosine: none along the normal, most across it.
float velvet_density(float cos_h, float sigma) {
    const float cos2 = sqr(cos_h), sin2 = 1.0f - cos2, inv = 1.0f / sqr(sigma);
    return std::exp(-cos2 / sin2 * inv) * inv * kInvPi / sqr(sin2);
}

}  // namespace

// --------------------------------------------------------------------------------------------------
// f |cos| and density

LobeEval eval_lobe(const Lambert& c, const Vec3&, const Vec3& wi, bool crosses) {
    if (crosses) return {};
    const float pdf = cosine_hemisphere_pdf(dot(c.n, wi));
    return {Spectrum(pdf), pdf};
}

LobeEval eval_lobe(const Translucent& c, const Vec3&, const Vec3& wi, bool crosses) {
    if (!crosses) return {};
    const float pdf = cosine_hemisphere_pdf(-dot(c.n, wi));
    return {Spectrum(pdf), pdf};
}

LobeEval eval_lobe(const OrenNayar& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_i = dot(c.n, wi), cos_o = std::max(dot(c.n, wo), 0.0f);
    if (crosses || !(cos_i > 0.0f)) return {};
    const Fujii fujii(c.roughness);
    float t = dot(wi, wo) - cos_i * cos_o;
    if (t > 0.0f) t /= std::max(cos_i, cos_o);
    Spectrum f(fujii.flat + fujii.along * t);
    if (!is_black(c.exchanged))
        f += exchange_of(c, fujii) *
             (kInvPi * (1.0f - fujii.albedo(cos_o)) * (1.0f - fujii.albedo(cos_i)));
    return {f * cos_i, cosine_hemisphere_pdf(cos_i)};
}

LobeEval eval_lobe(const Sheen& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_o = dot(c.n, wo);
    if (crosses || !(cos_o > 0.0f)) return {};
    const Vec3 w = sheen_frame(c.n, wo).to_local(wi);
    if (!(w.z > 0.0f)) return {};
    const SheenLobe lobe(cos_o, c.roughness);
    const float square = sqr(lobe.a * w.x + lobe.b * w.z) + sqr(lobe.a * w.y) + sqr(w.z);
    const float pdf = kInvPi * w.z * sqr(lobe.a / square);
    return {Spectrum(pdf * sheen_albedo(cos_o, c.roughness)), pdf};
}

// f cos_i = D G / (4 cos_o), with the shadowing of V-shaped grooves.
LobeEval eval_lobe(const Velvet& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    constexpr float kAlongNormal = 1.0f - 1e-5f;
    const float cos_o = dot(c.n, wo), cos_i = dot(c.n, wi);
    if (crosses || !(cos_o > 0.0f) || !(cos_i > 0.0f)) return {};
    const float pdf = 0.5f * kInvPi;
    const Vec3 h = normalize(wo + wi);
    const float n_h = dot(c.n, h), o_h = dot(wo, h);
    if (!(n_h < kAlongNormal) || !(o_h > 0.0f)) return {Spectrum(0.0f), pdf};
    const float grooves = std::min(1.0f, 2.0f * n_h / o_h * std::min(cos_o, cos_i));
    return {Spectrum(0.25f * velvet_density(n_h, c.sigma) * grooves / cos_o), pdf};
}

// [Burley12 Sec. 5.3], in the form that tells apart what Schlick's curves take away and what
// roughness gives back.
LobeEval eval_lobe(const BurleyDiffuse& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_i = dot(c.n, wi), cos_o = dot(c.n, wo);
    if (crosses || !(cos_i > 0.0f) || !(cos_o > 0.0f)) return {};
    const float grazing_i = fifth_power_from_grazing(cos_i),
                grazing_o = fifth_power_from_grazing(cos_o);
    const float back = c.roughness * (1.0f + dot(wi, wo));  // 2 roughness cos^2 of wi to h
    const float f = (1.0f - 0.5f * grazing_i) * (1.0f - 0.5f * grazing_o) +
                    back * (grazing_i + grazing_o + grazing_i * grazing_o * (back - 1.0f));
    const float pdf = cosine_hemisphere_pdf(cos_i);
    return {Spectrum(f * pdf), pdf};
}

LobeEval eval_lobe(const SchlickSheen& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_i = dot(c.n, wi);
    if (crosses || !(cos_i > 0.0f) || !(dot(c.n, wo) > 0.0f)) return {};
    const Vec3 h = normalize(wo + wi);
    return {Spectrum(fifth_power_from_grazing(dot(wi, h)) * cos_i), cosine_hemisphere_pdf(cos_i)};
}

LobeEval eval_lobe(const DiffuseToon& c, const Vec3&, const Vec3& wi, bool crosses) {
    return crosses ? LobeEval{} : eval_around(c, c.n, wi);
}

LobeEval eval_lobe(const GlossyToon& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_o = dot(c.n, wo);
    if (crosses || !(cos_o > 0.0f) || !(dot(c.n, wi) > 0.0f)) return {};
    return eval_around(c, c.n * (2.0f * cos_o) - wo, wi);
}

// --------------------------------------------------------------------------------------------------
// directions

std::optional<LobeSample> sample_lobe(const Lambert& c, const Vec3&, float, const Vec2& u) {
    return around_normal(c.n, u);
}

std::optional<LobeSample> sample_lobe(const Translucent& c, const Vec3&, float, const Vec2& u) {
    return LobeSample{around_normal(c.n * -1.0f, u).wi, BounceKind::transmission};
}

std::optional<LobeSample> sample_lobe(const OrenNayar& c, const Vec3&, float, const Vec2& u) {
    return around_normal(c.n, u);
}

std::optional<LobeSample> sample_lobe(const Sheen& c, const Vec3& wo, float, const Vec2& u) {
    const float cos_o = dot(c.n, wo);
    if (!(cos_o > 0.0f)) return std::nullopt;
    const SheenLobe lobe(cos_o, c.roughness);
    const Vec3 d = cosine_hemisphere(u);
    const Vec3 w = normalize(Vec3((d.x - lobe.b * d.z) / lobe.a, d.y / lobe.a, d.z));
    return LobeSample{sheen_frame(c.n, wo).to_world(w), BounceKind::diffuse};
}

std::optional<LobeSample> sample_lobe(const Velvet& c, const Vec3& wo, float, const Vec2& u) {
    if (!(dot(c.n, wo) > 0.0f)) return std::nullopt;
    return LobeSample{Frame::around(c.n).to_world(uniform_cone(u, 1.0f)), BounceKind::diffuse};
}

std::optional<LobeSample> sample_lobe(const BurleyDiffuse& c, const Vec3& wo, float, const Vec2& u) {
    if (!(dot(c.n, wo) > 0.0f)) return std::nullopt;
    return around_normal(c.n, u);
}

std::optional<LobeSample> sample_lobe(const SchlickSheen& c, const Vec3& wo, float, const Vec2& u) {
    if (!(dot(c.n, wo) > 0.0f)) return std::nullopt;
    return around_normal(c.n, u);
}

std::optional<LobeSample> sample_lobe(const DiffuseToon& c, const Vec3&, float, const Vec2& u) {
    return sample_around(c, c.n, u);
}

std::optional<LobeSample> sample_lobe(const GlossyToon& c, const Vec3& wo, float, const Vec2& u) {
    const float cos_o = dot(c.n, wo);
    if (!(cos_o > 0.0f)) return std::nullopt;
    const std::optional<LobeSample> lobe = sample_around(c, c.n * (2.0f * cos_o) - wo, u);
    return lobe && dot(c.n, lobe->wi) > 0.0f ? lobe : std::nullopt;
}

// --------------------------------------------------------------------------------------------------
// albedos

// A Gaussian in the cosine, fitted like the lobe.
float sheen_albedo(float x, float y) {
    const float width = y * (0.0206607f + 1.58491f * y) / (0.0379424f + y * (1.32227f + y));
    const float middle =
        y * (-0.193854f + y * (-1.14885f + y * (1.7932f - 0.95943f * y * y))) / (0.046391f + y);
    const float floor =
        y * (0.000654023f + (-0.0207818f + 0.119681f * y) * y) / (1.26264f + y * (-1.92021f + y));
    const float gaussian =
        std::exp(-0.5f * sqr((x - middle) / width)) / (width * std::sqrt(2.0f * kPi));
    return clamp01(gaussian + floor);
}

Spectrum albedo_of(const OrenNayar& c, const Vec3& wo) {
    const Fujii fujii(c.roughness);
    const float once = fujii.albedo(std::clamp(dot(c.n, wo), 0.0f, 1.0f));
    return Spectrum(once) + exchange_of(c, fujii) * ((1.0f - once) * (1.0f - fujii.mean_albedo()));
}

Spectrum albedo_of(const Sheen& c, const Vec3& wo) {
    const float cos_o = dot(c.n, wo);
    return Spectrum(cos_o > 0.0f ? sheen_albedo(cos_o, c.roughness) : 0.0f);
}

Spectrum albedo_of(const Velvet& c, const Vec3& wo) {
    return Spectrum(dot(c.n, wo) > 0.0f ? 1.0f : 0.0f);
}

Spectrum albedo_of(const BurleyDiffuse& c, const Vec3& wo) {
    const float grazing = fifth_power_from_grazing(dot(c.n, wo));
    return Spectrum(1.0f + (c.roughness - 0.5f) * grazing);  // as if light came from along the normal
}

Spectrum albedo_of(const SchlickSheen& c, const Vec3& wo) {
    const float cos_o = dot(c.n, wo);  // as if light came back to where it went
    return Spectrum(cos_o > 0.0f ? lerp(0.01f, 1.0f, fifth_power_from_grazing(cos_o)) : 0.0f);
}

Spectrum albedo_of(const DiffuseToon& c, const Vec3&) { return Spectrum(mean_brightness(c)); }

Spectrum albedo_of(const GlossyToon& c, const Vec3& wo) {
    return Spectrum(dot(c.n, wo) > 0.0f ? mean_brightness(c) : 0.0f);
}

}  // namespace spc
