// SPDX-License-Identifier: GPL-3.0-or-later
// Closures without facets: what scatters about everywhere. `n` is the shading normal on the side of
// wo, as in closure.h. Where nothing else is said they are reflections.
#pragma once

#include "bsdf/lobe.h"

namespace spc {

struct Lambert {
    static constexpr ClosureTraits kTraits{BounceKind::diffuse, BounceKind::diffuse};
    Vec3 n;
};

// Light that leaves on the other side, as if that were Lambert's.
struct Translucent {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::transmission, .crosses = true};
    Vec3 n;
};

// Rough plaster in the form of [Fujii12], of a roughness in [0, 1]. Light that facets exchange is
// lost, or given back with their colour `exchanged` [Portsmouth25].
struct OrenNayar {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .albedo_varies = true};
    Vec3 n;
    float roughness;
    Spectrum exchanged{0.0f};
};

// Fibres on end, scattering many times: a linearly transformed cosine [Zeltner22].
struct Sheen {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .albedo_varies = true};
    Vec3 n;
    float roughness;  // within [kLeastSheenRoughness, 1]
};
inline constexpr float kLeastSheenRoughness = 0.01f;  // the fits of its coefficients begin there
// Share of the light from cos_o that it reflects.
float sheen_albedo(float cos_o, float roughness);

// Blender's other sheen, once Velvet: facets that stand away from the normal [Ashikhmin00b].
struct Velvet {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .albedo_varies = true};
    Vec3 n;
    float sigma;
};

// The Principled BSDF's base until Blender 3.6 [Burley12]: at grazing angles darker than Lambert's
// where it is smooth, brighter where it is rough. It is not bound to keep the energy.
struct BurleyDiffuse {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .albedo_varies = true};
    Vec3 n;
    float roughness;  // in [0, 1]
};

// Its sheen: Schlick's curve alone [Burley12].
struct SchlickSheen {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .albedo_varies = true};
    Vec3 n;
};

// The same light from all directions of a cone, and less and less beyond its edge. A diffuse one
// stands around the normal, a glossy one around the mirrored direction. It is not reciprocal.
template <BounceKind kind>
struct Toon {
    static constexpr ClosureTraits kTraits{
        .reflected = kind, .transmitted = kind, .albedo_varies = true};
    Vec3 n;
    float plateau, fade;  // half angle of the cone, and width of its soft edge; rad
};
using DiffuseToon = Toon<BounceKind::diffuse>;
using GlossyToon = Toon<BounceKind::glossy>;

LobeEval eval_lobe(const Lambert& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const Translucent& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const OrenNayar& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const Sheen& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const Velvet& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const BurleyDiffuse& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const SchlickSheen& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const DiffuseToon& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const GlossyToon& c, const Vec3& wo, const Vec3& wi, bool crosses);

std::optional<LobeSample> sample_lobe(const Lambert& c, const Vec3& wo, float u_lobe, const Vec2& u);
std::optional<LobeSample> sample_lobe(const Translucent& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const OrenNayar& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const Sheen& c, const Vec3& wo, float u_lobe, const Vec2& u);
std::optional<LobeSample> sample_lobe(const Velvet& c, const Vec3& wo, float u_lobe, const Vec2& u);
std::optional<LobeSample> sample_lobe(const BurleyDiffuse& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const SchlickSheen& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const DiffuseToon& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const GlossyToon& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);

// Directional albedos: exact for OrenNayar and Sheen, about right for the others, and for a toon's
// part below the horizon.
Spectrum albedo_of(const OrenNayar& c, const Vec3& wo);
Spectrum albedo_of(const Sheen& c, const Vec3& wo);
Spectrum albedo_of(const Velvet& c, const Vec3& wo);
Spectrum albedo_of(const BurleyDiffuse& c, const Vec3& wo);
Spectrum albedo_of(const SchlickSheen& c, const Vec3& wo);
Spectrum albedo_of(const DiffuseToon& c, const Vec3& wo);
Spectrum albedo_of(const GlossyToon& c, const Vec3& wo);

}  // namespace spc
