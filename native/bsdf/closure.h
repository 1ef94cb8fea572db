// SPDX-License-Identifier: GPL-3.0-or-later
// Closures: what a surface does to light at one point. A closed variant of parameter structs, and
// the free functions eval / sample that work on a weighted list of them.
//
// Directions are unit, in world space and point away from the surface: wo to where the path came
// from (the camera's side), wi to where it goes on (the light's side). `ng` is the geometric normal
// on the side of wo: dot(ng, wo) >= 0. Each closure carries its own shading normal `n`, on the side
// of wo by the geometry (it may still have dot(n, wo) < 0: then microfacet closures are black
// there; Lambert does not depend on wo).
//
// Radiance is carried as basic radiance (radiance over the squared index of refraction), as Cycles
// does: a refraction does not scale it. Light that would cross the geometric surface on the wrong
// side is black: a reflection needs dot(ng, wi) > 0, a transmission dot(ng, wi) < 0, in path
// tracing and manifold alike.
#pragma once

#include "bsdf/ashikhmin_shirley.h"
#include "bsdf/diffuse.h"
#include "bsdf/hair.h"
#include "bsdf/subsurface.h"
#include "bsdf/terminator.h"

#include <variant>

namespace spc {

// At or below this alpha a microfacet closure is a delta: its lobe is narrower than single
// precision resolves.
inline constexpr float kDeltaAlpha = 2e-5f;

enum class MicrofacetModel : uint8_t { ggx, beckmann };

// A film on an interface, of its thickness times the index of wo's side, and of an index over that
// of wo's side: so it is the same film from both sides.
struct ThinFilm {
    float thickness = 0.0f;  // nm
    float ior = 1.0f;

    bool exists() const { return thickness > 0.1f; }  // Cycles' bound
};

// How much of the light a microfacet reflects, by the cosine between half-vector and wo.
struct Fresnel {
    enum class Kind : uint8_t {
        none,  // f0 at all angles: Blender's Glossy node. Its colour belongs here rather than in the
               // closure's weight, so that energy compensation saturates it as Cycles does
        dielectric,  // exact, unpolarised, eta = ior below the surface / ior above; times f0 as a tint
        dielectric_f0,  // the same curve moved to rise from f0 to 1: Principled's specular layer, whose tint
                        // colours f0 only
        conductor,  // exact, unpolarised, complex index eta + i k per channel
        f82         // Schlick with f0 and an edge tint at 82 degrees, Principled's metal [Kutz21]
    };
    Kind kind = Kind::none;
    float eta = 1.0f;
    Spectrum f0{1.0f};   // f82, dielectric_f0: normal incidence; dielectric: tint; conductor: eta
    Spectrum f82{1.0f};  // f82: tint at 82 degrees; conductor: k
    ThinFilm film{};     // over dielectric_f0, conductor, f82
};
Spectrum fresnel(const Fresnel& fresnel, float cos_wo_h);
// Reflectance of a dielectric interface; eta as above; 1 at total internal reflection.
float fresnel_dielectric(float cos_i, float eta);

// Mirror where alpha <= kDeltaAlpha. Where alpha_y differs, alpha is along the tangent and alpha_y
// across it, and neither is that of a delta. With `energy_compensated` (GGX alone, as in Cycles)
// light that one bounce between the microfacets loses is given back, scaled to the same lobe
// [Turquin19].
struct MicrofacetReflection {
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::glossy,
                                           .transmitted = BounceKind::transmission,
                                           .has_facets = true,
                                           .albedo_varies = true};
    Vec3 n;
    float alpha;
    MicrofacetModel model;
    Fresnel fresnel;
    bool energy_compensated = false;
    float alpha_y = alpha;
    Vec3 tangent{0, 0, 0};  // unit, perpendicular to n; read where the lobe is anisotropic

    bool is_isotropic() const { return alpha_y == alpha; }
    // For tables, which know one alpha: that of facets as densely spread.
    float mean_alpha() const { return is_isotropic() ? alpha : std::sqrt(alpha * alpha_y); }
};
// A dielectric interface: reflects, refracts or both (the dropped half is black: Blender's
// Refraction node transmits everything but total internal reflection, without Fresnel, when
// `fresnel_weighted` is false: then just one of `reflects` and `refracts` is set). Delta where
// alpha <= kDeltaAlpha, and where it refracts at an index so near to 1 that the half-vector of two
// float directions has no digits left (see is_delta). Compensated as above, as a whole, for glass
// of both halves; the coloured loss follows transmission_tint.
struct MicrofacetDielectric {
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::glossy,
                                           .transmitted = BounceKind::transmission,
                                           .has_facets = true,
                                           .albedo_varies = true};
    Vec3 n;
    float alpha;
    MicrofacetModel model;
    float eta;  // ior on the far side / ior on the side of wo; already inverted on back faces
    bool reflects, refracts;
    bool fresnel_weighted;
    Spectrum reflection_tint, transmission_tint;
    bool energy_compensated = false;
    ThinFilm film{};  // read where it is fresnel_weighted, as is
    // what colours the reflectance at normal incidence, but not total reflection; what it takes
    // from the reflection is transmitted.
    Spectrum normal_tint{1.0f};
};
struct Transparent {  // a delta
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::transparent,
                                           .transmitted = BounceKind::transparent,
                                           .straight = true};
};

using ClosureKind =
    std::variant<Lambert, MicrofacetReflection, MicrofacetDielectric, Transparent, Translucent,
                 OrenNayar, Sheen, Velvet, BurleyDiffuse, SchlickSheen, DiffuseToon, GlossyToon,
                 AshikhminShirley, Subsurface, HairFibre, HairLobe>;
inline const ClosureTraits& traits(const ClosureKind& kind) {
    return *std::visit([](const auto& c) { return &c.kTraits; }, kind);
}

struct Closure {
    Spectrum weight;
    float sample_weight;  // >= 0, relative probability to be sampled; set by ClosureList::add
    // Shares the normal that the manifold walks on (shading/program.h).
    bool on_caster_normal = false;
    bool glints = false;  // also one of ClosureList::glints
    ClosureKind kind;
};

// A dielectric layer over other closures: what it does not reflect they have, tinted.
struct Coat {
    float share;  // of the surface that it covers
    float alpha;
    float ior;
    Spectrum tint;  // what is left of light that crosses it, in and out, at normal incidence
};
// Fresnel term of a coat's reflection, which is GGX with compensation, the same from both sides.
Fresnel coat_fresnel(float ior);
// Share of their light towards wo that closures below the coat keep.
Spectrum coat_transmittance(const Coat& coat, const Vec3& n, const Vec3& wo);

// A narrow lobe whose normal comes from a slope map (shading/program.h): as it is for any normal of
// the map.
struct GlintLobe {
    Spectrum weight;             // before energy compensation, which depends on the normal
    MicrofacetReflection lobe;   // its normal is that of one point
    std::optional<Coat> coat{};  // above it, of the same normal; not yet part of the weight
};
// f |cos| of the lobe if its normal were `n`, unit.
Spectrum eval_glint(const GlintLobe& glint, const Vec3& n, const Vec3& wo, const Vec3& wi);

// What a surface offers at one point. At most kMaxClosures; more are refused when the material is
// compiled.
inline constexpr int kMaxClosures = 12;
inline constexpr int kMaxGlints = 4;  // further ones are closures like any other
struct ClosureList {
    std::array<Closure, kMaxClosures> closures;
    int count = 0;
    Spectrum emission{0.0f};      // radiance towards wo
    Spectrum transparency{0.0f};  // sum of the weights of Transparent closures
    Spectrum holdout{0.0f};       // a hole in the picture, where a camera sees it
    std::array<GlintLobe, kMaxGlints> glints;
    int glint_count = 0;
    // Closures with `glints` are a kind of scattering of their own: whoever connects to light looks
    // at them through a footprint instead (native/glints/).
    bool glints_apart = false;
    Terminator terminator;

    // Drops closures that are black from wo; negative weights count as zero. The sample weight
    // follows the closure's albedo, and energy compensation, which depends on wo alone, is folded
    // into the stored weight.
    void add(const Spectrum& weight, const ClosureKind& kind, const Vec3& wo, bool on_caster_normal);
    // Its lobe, with all of its weight at the lobe's own normal; also among `glints`, where it
    // stays whatever that normal is.
    void add_glints(const Spectrum& weight, const GlintLobe& glint, const Vec3& wo,
                    bool on_caster_normal);
    void clear();
};

bool is_delta(const ClosureKind& kind);
// Any closure that next event estimation can connect to.
bool has_smooth_closure(const ClosureList& list);
// Albedo of the smooth closures towards wo, about.
float smooth_albedo(const ClosureList& list);
// Any of those that sends light through the surface.
bool has_smooth_transmission(const ClosureList& list);

// Sets of kinds of scattering, bits 1 << BounceKind.
inline constexpr uint32_t kind_bit(BounceKind kind) { return 1u << static_cast<uint32_t>(kind); }
// Bit of closures with glints while ClosureList::glints_apart is set.
inline constexpr uint32_t kGlintsBit = 16;
inline constexpr uint32_t kAllKinds = ~0u;

struct ClosureEval {
    Spectrum f_cos{0.0f};       // sum of weight f |cos|, smooth closures of `kinds`, 1/sr times cos
    float pdf_omega = 0.0f;     // of sample() over the whole list, smooth part, 1/sr
    float pdf_of_kinds = 0.0f;  // the part of it that closures of `kinds` sample
};
// With fewer than all `kinds`: what light contributes that shows itself to rays of those kinds
// alone. Weights of multiple importance sampling may take pdf_omega all the same: they need only be
// functions of the path, the same for all estimators.
ClosureEval eval(const ClosureList& list, const Vec3& ng, const Vec3& wo, const Vec3& wi,
                 uint32_t kinds = kAllKinds);

// Takes away what reflects glossily, or refracts: what a diffuse ray
// finds where caustics are switched off.
void drop_caustics(ClosureList& list, bool reflective, bool refractive);

struct ClosureSample {
    Vec3 wi;
    // f |cos| / pdf, already divided, the choice of closure included. A smooth sample carries the
    // sum over the smooth closures of its kind of scattering (one-sample MIS) over their density
    // alone: rays of each kind see their own scene, and answer for their own closures. A delta one
    // carries its own.
    Spectrum weight;
    float pdf_omega;    // as eval() gives it, over the whole list, 1/sr; 0 for a delta
    float probability;  // of a delta's lobe; 0 for a smooth sample
    bool delta;
    bool on_caster_normal;    // of the closure that was sampled
    bool refracted;           // crossed the surface with a change of direction
    bool facets;              // the closure has facets that turned wi; else it goes anywhere
    float alpha;              // of the closure that was sampled; 0 where it has none
    float eta;                // likewise, on the far side over that of wo; 1 where it has none
    bool glints;              // of closures with glints, where they are apart
    const Subsurface* below;  // light goes on there, in the list that was sampled; null: it does not
    BounceKind kind;
};
// u[0] chooses closure and lobe, u[1], u[2] the direction; all in [0, 1). Empty where nothing is
// scattered.
std::optional<ClosureSample> sample(const ClosureList& list, const Vec3& ng, const Vec3& wo,
                                    const Vec3& u);

// What the list's delta closures on the caster's normal do with one given direction, reflected or
// refracted exactly at that normal: their summed throughput, and the probability with which
// sample() takes them. The caller guarantees that wi is the mirrored or refracted wo at that
// normal. Zero probability if there is none.
struct DeltaLobe {
    Spectrum throughput{0.0f};
    float probability = 0.0f;
};
DeltaLobe delta_lobe(const ClosureList& list, const Vec3& ng, const Vec3& wo, const Vec3& wi,
                     bool refracted);

// Directional albedo of one closure (weight 1) with its energy compensation, for layering and
// sample weights: exact for Lambert and deltas, from tables for rough microfacets, whose first use
// builds the tables (some ms); diffuse.h says of which others it is but about right.
Spectrum albedo(const ClosureKind& kind, const Vec3& wo);

}  // namespace spc
