// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/closure.h"

#include "bsdf/albedo.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "core/error.h"

namespace spc {
namespace {

// Refraction at index eta maps half-vectors to directions by |eta - 1|. Where the lobe of
// transmitted directions, about alpha |eta - 1| wide, is narrower than this, the rounding of two
// unit vectors (1e-7) is a tenth of it.
constexpr float kMatchedWidth = 1e-6f;
// Least share of its weight with which a closure is sampled: tables are approximate, a closure that
// scatters must not have a vanishing probability.
constexpr float kMinSampledAlbedo = 1e-3f;

template <class C>
bool is_delta_kind(const C&) {
    return C::kTraits.straight || C::kTraits.enters;
}
bool is_delta_kind(const MicrofacetReflection& c) { return c.alpha <= kDeltaAlpha; }
bool is_delta_kind(const MicrofacetDielectric& c) {
    return c.alpha <= kDeltaAlpha ||
           (c.refracts && c.alpha * std::abs(c.eta - 1.0f) <= kMatchedWidth);
}

// How a facet of a dielectric divides the light, and how often sample() follows the reflected part.
struct Division {
    Spectrum reflected, transmitted;
    float p_reflect, p_transmit;
};
Division divide(const MicrofacetDielectric& c, float cos_facet) {
    const Spectrum f = facet::reflectance(c, cos_facet);
    const Spectrum none(0.0f), all_of_it(1.0f);
    const bool passes = c.refracts && facet::refracted_cos_squared(cos_facet, c.eta) > 0.0f;
    const Spectrum r = !c.reflects ? none : c.fresnel_weighted ? f : all_of_it;
    const Spectrum t = !passes ? none : c.fresnel_weighted ? all_of_it - f : all_of_it;
    Division d{c.reflection_tint * r, c.transmission_tint * t, 0.0f, 0.0f};
    const float reflected = mean(d.reflected), transmitted = mean(d.transmitted),
                all = reflected + transmitted;
    if (all > 0.0f) {
        d.p_reflect = reflected / all;
        d.p_transmit = transmitted / all;
    }
    return d;
}

// f cos_i = F D G2 / (4 cos_o), pdf = D G1 / (4 cos_o)  [Walter07 Eq. 20], [Heitz18 Eq. 17].
template <class Reflectance>
LobeEval eval_reflection(const Vec3& n, MicrofacetModel model, float alpha, const Vec3& wo,
                         const Vec3& wi, const Reflectance& reflectance) {
    const float cos_o = dot(n, wo), cos_i = dot(n, wi);
    if (!(cos_o > 0.0f) || !(cos_i > 0.0f)) return {};
    const Vec3 h = wo + wi;
    const float d = normal_density(model, alpha, sqr(dot(n, h)), length_squared(cross(n, h)));
    const Masking g = masking(model, alpha, std::min(cos_o, 1.0f), std::min(cos_i, 1.0f));
    const auto [f, p] = reflectance(dot(wo, h) / length(h));
    return {f * (0.25f * d * g.g2_by_cos_o), p * (0.25f * d * g.g1_by_cos_o)};
}

Frame frame_of(const MicrofacetReflection& c) {
    return c.is_isotropic() ? Frame::around(c.n) : Frame{c.tangent, cross(c.n, c.tangent), c.n};
}

// As eval_reflection(), in the closure's own frame.
LobeEval eval_anisotropic(const MicrofacetReflection& c, const Vec3& wo, const Vec3& wi) {
    const Frame frame = frame_of(c);
    const Vec3 o = frame.to_local(wo), i = frame.to_local(wi), h = o + i;
    if (!(o.z > 0.0f) || !(i.z > 0.0f)) return {};
    const Vec2 alpha(c.alpha, c.alpha_y);
    const Masking g = masking(c.model, alpha_towards(alpha, o), alpha_towards(alpha, i),
                              std::min(o.z, 1.0f), std::min(i.z, 1.0f));
    const float d = normal_density(c.model, alpha, h);
    return {fresnel(c.fresnel, dot(o, h) / length(h)) * (0.25f * d * g.g2_by_cos_o),
            0.25f * d * g.g1_by_cos_o};
}

LobeEval eval_lobe(const MicrofacetReflection& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    if (crosses || is_delta_kind(c)) return {};
    if (!c.is_isotropic()) return eval_anisotropic(c, wo, wi);
    return eval_reflection(c.n, c.model, c.alpha, wo, wi, [&](float cos_facet) {
        return std::pair(fresnel(c.fresnel, cos_facet), 1.0f);
    });
}

// With H = wo + eta wi, m = H/|H| towards wo, and |dm/dwi| = eta^2 |wi.m| / |H|^2 [Walter07 Eq.
// 17]: f cos_i = (1-F) D G2 (wo.m) / cos_o |dm/dwi|, without the eta^-2 of radiance [Walter07 Eq.
// 21].
LobeEval eval_transmission(const MicrofacetDielectric& c, const Vec3& wo, const Vec3& wi) {
    const float cos_o = dot(c.n, wo), cos_i = -dot(c.n, wi);
    if (!(cos_o > 0.0f) || !(cos_i > 0.0f)) return {};
    const Vec3 h = (wo + wi * c.eta) * (c.eta > 1.0f ? -1.0f : 1.0f);
    const float o_h = dot(wo, h), i_h = -dot(wi, h), n_h = dot(c.n, h);
    // A facet that faces away from wo or wi, or from the outside, belongs to the reflection's root
    // of the half-vector.
    if (!(o_h > 0.0f) || !(i_h > 0.0f) || !(n_h > 0.0f)) return {};
    const float h2 = length_squared(h);
    const Division part = divide(c, o_h / std::sqrt(h2));
    const float d = normal_density(c.model, c.alpha, n_h * n_h, length_squared(cross(c.n, h)));
    const Masking g = masking(c.model, c.alpha, std::min(cos_o, 1.0f), std::min(cos_i, 1.0f));
    const float common = d * (o_h / h2) * (i_h / h2) * sqr(c.eta);
    return {part.transmitted * (common * g.g2_by_cos_o), part.p_transmit * (common * g.g1_by_cos_o)};
}

LobeEval eval_lobe(const MicrofacetDielectric& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    if (is_delta_kind(c) || !(crosses ? c.refracts : c.reflects)) return {};
    if (crosses) return eval_transmission(c, wo, wi);
    return eval_reflection(c.n, c.model, c.alpha, wo, wi, [&](float cos_facet) {
        const Division part = divide(c, cos_facet);
        return std::pair(part.reflected, part.p_reflect);
    });
}

LobeEval eval_lobe(const Transparent&, const Vec3&, const Vec3&, bool) { return {}; }

std::optional<LobeSample> sample_lobe(const MicrofacetReflection& c, const Vec3& wo, float,
                                      const Vec2& u) {
    const float cos_o = dot(c.n, wo);
    if (!(cos_o > 0.0f)) return std::nullopt;
    if (is_delta_kind(c))
        return LobeSample{facet::mirrored(wo, c.n, cos_o), BounceKind::glossy, true,
                          fresnel(c.fresnel, cos_o)};
    const Frame frame = frame_of(c);
    const Vec3 o = frame.to_local(wo);
    const Vec3 m = frame.to_world(
        c.is_isotropic() ? sample_visible_normal(c.model, c.alpha, o, u)
                         : sample_visible_normal(c.model, Vec2(c.alpha, c.alpha_y), o, u));
    const Vec3 wi = facet::mirrored(wo, m, dot(wo, m));
    if (!(dot(c.n, wi) > 0.0f)) return std::nullopt;
    return LobeSample{wi, BounceKind::glossy};
}

std::optional<LobeSample> sample_lobe(const MicrofacetDielectric& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u) {
    const float cos_o = dot(c.n, wo);
    if (!(cos_o > 0.0f)) return std::nullopt;
    const bool delta = is_delta_kind(c);
    Vec3 m = c.n;
    if (!delta) {
        const Frame frame = Frame::around(c.n);
        m = frame.to_world(sample_visible_normal(c.model, c.alpha, frame.to_local(wo), u));
    }
    const float cos_facet = dot(wo, m);
    const Division part = divide(c, cos_facet);
    if (u_lobe < part.p_reflect) {
        const Vec3 wi = facet::mirrored(wo, m, cos_facet);
        if (!(dot(c.n, wi) > 0.0f)) return std::nullopt;
        return LobeSample{wi, BounceKind::glossy, delta, part.reflected, part.p_reflect};
    }
    if (is_black(part.transmitted)) return std::nullopt;
    const std::optional<Vec3> wi = facet::refracted(wo, m, cos_facet, c.eta);
    if (!wi || !(dot(c.n, *wi) < 0.0f)) return std::nullopt;
    return LobeSample{*wi, BounceKind::transmission, delta, part.transmitted, part.p_transmit};
}

std::optional<LobeSample> sample_lobe(const Transparent&, const Vec3& wo, float, const Vec2&) {
    return LobeSample{-wo, BounceKind::transparent, true, Spectrum(1.0f)};
}

// Alpha, and index of the far side over that of wo, of closures that have them.
template <class C>
float alpha_of(const C&) {
    return 0.0f;
}
float alpha_of(const MicrofacetReflection& c) { return c.mean_alpha(); }
float alpha_of(const MicrofacetDielectric& c) { return c.alpha; }
float alpha_of(const AshikhminShirley& c) { return c.mean_alpha(); }
template <class C>
float eta_of(const C&) {
    return 1.0f;
}
float eta_of(const MicrofacetDielectric& c) { return c.eta; }

// Whether a closure sends light to the other side by what is not a delta.
template <class C>
bool is_smooth_across(const C&) {
    return C::kTraits.crosses;
}
bool is_smooth_across(const MicrofacetDielectric& c) { return c.refracts && !is_delta_kind(c); }

// Takes away glossy reflection, or refraction; false where nothing is left.
template <class C>
bool restrict_glossy(C&, bool reflective, bool) {
    return C::kTraits.reflected != BounceKind::glossy || reflective;
}
// As in Cycles hair is no caustic.
bool restrict_glossy(HairFibre&, bool, bool) { return true; }
bool restrict_glossy(HairLobe&, bool, bool) { return true; }
bool restrict_glossy(MicrofacetDielectric& c, bool reflective, bool refractive) {
    c.reflects = c.reflects && reflective;
    c.refracts = c.refracts && refractive;
    return c.reflects || c.refracts;
}

template <class C>
Vec3 normal_of(const C& c) {
    return c.n;
}
// Of what has none.
Vec3 normal_of(const Transparent&) { return Vec3(0.0f); }
Vec3 normal_of(const HairFibre&) { return Vec3(0.0f); }

// Of the terminator, for light that is not a delta's. Lobes that glint have the normals of their
// map.
float fade_of(const Terminator& terminator, const Closure& closure, const Vec3& wi) {
    if (!terminator.fades() || closure.glints) return 1.0f;
    return std::visit([&](const auto& c) { return fade(terminator, c.kTraits, normal_of(c), wi); },
                      closure.kind);
}

float total_sample_weight(const ClosureList& list) {
    float total = 0.0f;
    for (int i = 0; i < list.count; ++i) total += list.closures[i].sample_weight;
    return total;
}

// The kind of bounce by which a closure scatters to one side of the geometry.
BounceKind kind_of(const Closure& closure, bool crosses) {
    const ClosureTraits& row = traits(closure.kind);
    return crosses ? row.transmitted : row.reflected;
}

// The bit of the closures that are sampled together: a kind_bit(), or kGlintsBit.
uint32_t group_of(const ClosureList& list, const Closure& closure, bool crosses) {
    return list.glints_apart && closure.glints ? kGlintsBit : kind_bit(kind_of(closure, crosses));
}

// Throughput and probability, within the closure, of the delta lobe that reflects or refracts at
// the normal.
struct DeltaPart {
    Spectrum throughput{0.0f};
    float probability = 0.0f;
};
template <class C>
DeltaPart delta_part(const C&, const Vec3&, bool) {
    return {};
}
DeltaPart delta_part(const MicrofacetReflection& c, const Vec3& wo, bool refracted) {
    const float cos_o = dot(c.n, wo);
    if (refracted || !is_delta_kind(c) || !(cos_o > 0.0f)) return {};
    return {fresnel(c.fresnel, cos_o), 1.0f};
}
DeltaPart delta_part(const MicrofacetDielectric& c, const Vec3& wo, bool refracted) {
    const float cos_o = dot(c.n, wo);
    if (!is_delta_kind(c) || !(cos_o > 0.0f)) return {};
    const Division part = divide(c, cos_o);
    if (!refracted) return {part.reflected, part.p_reflect};
    if (is_black(part.transmitted)) return {};
    return {part.transmitted, part.p_transmit};
}

}  // namespace

bool is_delta(const ClosureKind& kind) {
    return std::visit([](const auto& c) { return is_delta_kind(c); }, kind);
}

bool has_smooth_closure(const ClosureList& list) {
    for (int i = 0; i < list.count; ++i)
        if (!is_delta(list.closures[i].kind)) return true;
    return false;
}

float smooth_albedo(const ClosureList& list) {
    float sum = 0.0f;
    for (int i = 0; i < list.count; ++i)
        if (!is_delta(list.closures[i].kind)) sum += list.closures[i].sample_weight;
    return sum;
}

bool has_smooth_transmission(const ClosureList& list) {
    for (int i = 0; i < list.count; ++i)
        if (std::visit([](const auto& c) { return is_smooth_across(c); }, list.closures[i].kind))
            return true;
    return false;
}

void ClosureList::clear() {
    count = 0;
    emission = Spectrum(0.0f);
    transparency = Spectrum(0.0f);
    holdout = Spectrum(0.0f);
    glint_count = 0;
    glints_apart = false;
    terminator = {};
}

Fresnel coat_fresnel(float ior) { return {Fresnel::Kind::dielectric, ior}; }

// Light is assumed to enter along the path by which it leaves. That is longer than the coat's
// thickness by 1 / cos of the refracted wo, and the tint is raised to that power.
Spectrum coat_transmittance(const Coat& coat, const Vec3& n, const Vec3& wo) {
    const MicrofacetReflection lobe{n, coat.alpha, MicrofacetModel::ggx, coat_fresnel(coat.ior),
                                    true};
    const Spectrum passed(clamp01(1.0f - coat.share * albedo(lobe, wo).x));
    if (coat.tint == Spectrum(1.0f)) return passed;
    const float cos_o = std::clamp(dot(n, wo), 0.0f, 1.0f);
    const float length = coat.ior / std::sqrt(facet::refracted_cos_squared(cos_o, coat.ior));
    const Spectrum tint(std::pow(coat.tint.x, length), std::pow(coat.tint.y, length),
                        std::pow(coat.tint.z, length));
    return passed * (Spectrum(1.0f - coat.share) + tint * coat.share);
}

void ClosureList::add_glints(const Spectrum& weight, const GlintLobe& glint, const Vec3& wo,
                             bool on_caster_normal) {
    const int before = count;
    add(weight, glint.lobe, wo, on_caster_normal);
    if (is_delta_kind(glint.lobe)) return;
    if (count > before) closures[before].glints = true;
    glints[glint_count++] = glint;
}

Spectrum eval_glint(const GlintLobe& glint, const Vec3& n, const Vec3& wo, const Vec3& wi) {
    MicrofacetReflection lobe = glint.lobe;
    lobe.n = n;
    const LobeEval value = eval_lobe(lobe, wo, wi, false);
    Spectrum result = glint.weight * value.f_cos;
    if (!(value.pdf_omega > 0.0f)) return result;
    if (glint.coat) result *= coat_transmittance(*glint.coat, n, wo);
    if (lobe.energy_compensated) result *= energy_compensation(lobe, wo);
    return result;
}

void ClosureList::add(const Spectrum& weight, const ClosureKind& kind, const Vec3& wo,
                      bool on_caster_normal) {
    SPC_ASSERT(count < kMaxClosures);
    // In this order std::max keeps a NaN, which the integrator counts; dropping it here would hide
    // it.
    const Spectrum w(std::max(weight.x, 0.0f), std::max(weight.y, 0.0f), std::max(weight.z, 0.0f));
    if (is_black(w) || count >= kMaxClosures) return;
    const ClosureTraits& row = traits(kind);
    if (row.straight) transparency += w;

    Closure& closure = closures[count];
    closure.kind = kind;
    closure.on_caster_normal = on_caster_normal;
    closure.glints = false;
    closure.weight = w;
    closure.sample_weight = mean(w);
    if (row.albedo_varies) {
        const Spectrum scattered = w * albedo(kind, wo);
        if (is_black(scattered)) return;
        closure.weight = w * energy_compensation(kind, wo);
        closure.sample_weight = std::max(mean(scattered), kMinSampledAlbedo * mean(w));
    }
    ++count;
}

ClosureEval eval(const ClosureList& list, const Vec3& ng, const Vec3& wo, const Vec3& wi,
                 uint32_t kinds) {
    const float side = dot(ng, wi);
    ClosureEval result;
    if (side == 0.0f || list.count == 0) return result;
    const bool crosses = side < 0.0f;
    float total = 0.0f;
    for (int i = 0; i < list.count; ++i) {
        const Closure& closure = list.closures[i];
        total += closure.sample_weight;
        const LobeEval lobe =
            std::visit([&](const auto& c) { return eval_lobe(c, wo, wi, crosses); }, closure.kind);
        const float pdf = closure.sample_weight * lobe.pdf_omega;
        result.pdf_omega += pdf;
        if ((kinds & group_of(list, closure, crosses)) == 0) continue;
        result.pdf_of_kinds += pdf;
        result.f_cos += closure.weight * lobe.f_cos * fade_of(list.terminator, closure, wi);
    }
    result.pdf_omega *= 1.0f / total;
    result.pdf_of_kinds *= 1.0f / total;
    return result;
}

void drop_caustics(ClosureList& list, bool reflective, bool refractive) {
    int kept = 0;
    for (int i = 0; i < list.count; ++i) {
        Closure& closure = list.closures[i];
        if (!std::visit([&](auto& c) { return restrict_glossy(c, reflective, refractive); },
                        closure.kind))
            continue;
        if (kept != i) list.closures[kept] = closure;
        ++kept;
    }
    list.count = kept;
    if (!reflective) list.glint_count = 0;
}

std::optional<ClosureSample> sample(const ClosureList& list, const Vec3& ng, const Vec3& wo,
                                    const Vec3& u) {
    if (list.count == 0) return std::nullopt;
    const float total = total_sample_weight(list);
    float rest = u.x * total;
    int chosen = 0;
    while (chosen + 1 < list.count && rest >= list.closures[chosen].sample_weight)
        rest -= list.closures[chosen++].sample_weight;
    const Closure& closure = list.closures[chosen];
    const float u_lobe = std::min(rest / closure.sample_weight, kBelowOne);

    const std::optional<LobeSample> lobe = std::visit(
        [&](const auto& c) { return sample_lobe(c, wo, u_lobe, Vec2(u.y, u.z)); }, closure.kind);
    if (!lobe) return std::nullopt;
    const float side = dot(ng, lobe->wi);
    const BounceKind kind =
        traits(closure.kind).all_around ? kind_of(closure, side < 0.0f) : lobe->kind;
    ClosureSample result{
        .wi = lobe->wi,
        .weight = Spectrum(0.0f),
        .pdf_omega = 0.0f,
        .probability = 0.0f,
        .delta = lobe->delta,
        .on_caster_normal = closure.on_caster_normal,
        .refracted = kind == BounceKind::transmission,
        .facets = traits(closure.kind).has_facets,
        .alpha = std::visit([](const auto& c) { return alpha_of(c); }, closure.kind),
        .eta = std::visit([](const auto& c) { return eta_of(c); }, closure.kind),
        .glints = list.glints_apart && closure.glints,
        .below = std::get_if<Subsurface>(&closure.kind),
        .kind = kind};
    if (result.below != nullptr) {
        result.probability = closure.sample_weight / total;
        result.weight = closure.weight * (1.0f / result.probability);
        return result;
    }
    if (lobe->delta) {
        const bool crosses = lobe->kind == BounceKind::transmission;
        if (lobe->kind != BounceKind::transparent && !(crosses ? side < 0.0f : side > 0.0f))
            return std::nullopt;
        result.probability = closure.sample_weight / total * lobe->probability;
        result.weight = closure.weight * lobe->throughput * (1.0f / result.probability);
        return result;
    }
    // A direction on the wrong side for its lobe may still be right for another closure of the
    // list, but then it is drawn from outside the density that eval() states.
    const bool above = side > 0.0f;
    if (above != (kind != BounceKind::transmission)) return std::nullopt;
    const ClosureEval sum = eval(list, ng, wo, lobe->wi, group_of(list, closure, !above));
    if (!(sum.pdf_of_kinds > 0.0f)) return std::nullopt;
    result.pdf_omega = sum.pdf_omega;
    result.weight = sum.f_cos * (1.0f / sum.pdf_of_kinds);
    return result;
}

DeltaLobe delta_lobe(const ClosureList& list, const Vec3& ng, const Vec3& wo, const Vec3& wi,
                     bool refracted) {
    DeltaLobe result;
    const float side = dot(ng, wi);
    if (!(refracted ? side < 0.0f : side > 0.0f)) return result;
    for (int i = 0; i < list.count; ++i) {
        const Closure& closure = list.closures[i];
        if (!closure.on_caster_normal) continue;
        const DeltaPart part =
            std::visit([&](const auto& c) { return delta_part(c, wo, refracted); }, closure.kind);
        result.throughput += closure.weight * part.throughput;
        result.probability += closure.sample_weight * part.probability;
    }
    if (result.probability > 0.0f) result.probability /= total_sample_weight(list);
    return result;
}

}  // namespace spc
