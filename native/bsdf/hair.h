// SPDX-License-Identifier: GPL-3.0-or-later
// Closures of hair: fibres thinner than what is seen of them, with light all around. The angle of a
// direction along the fibre is that to its cross-section, phi runs around its tangent, from wo.
#pragma once

#include "bsdf/lobe.h"

namespace spc {

// A dielectric fibre that absorbs inside, with scales on its surface [Chiang16]: light is
// reflected, goes through, comes back after one reflection inside, or after more.
struct HairFibre {
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::glossy,
                                           .transmitted = BounceKind::transmission,
                                           .crosses = true,
                                           .all_around = true,
                                           .albedo_varies = true};
    Vec3 tangent;         // unit
    float h;              // across the fibre, -1 to 1, of where wo's line meets it
    Spectrum absorption;  // within the fibre, over its radius
    float eta;
    float tilt;                      // of the scales, rad
    float variance, first_variance;  // of the angle along; of what is reflected at once
    float scale;                     // of the logistic lobes around
};
// From what artists set: roughness along and around the fibre, in [0, 1], and the share of the
// former that the first reflection lacks.
HairFibre hair_fibre(const Vec3& tangent, float h, const Spectrum& absorption, float roughness,
                     float radial_roughness, float coat, float eta, float tilt);

// Blender's Hair BSDF: one lobe, either reflected or let through, of a Cauchy distribution along
// the fibre. It ends where the side of the normal does.
struct HairLobe {
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::glossy,
                                           .transmitted = BounceKind::transmission,
                                           .crosses = true,
                                           .all_around = true,
                                           .albedo_varies = true};
    Vec3 n;               // unit, on the side of wo
    Vec3 tangent;         // unit
    float along, around;  // widths, in [0.001, 1]
    float offset;         // rad
    bool transmits;
};

LobeEval eval_lobe(const HairFibre& c, const Vec3& wo, const Vec3& wi, bool crosses);
LobeEval eval_lobe(const HairLobe& c, const Vec3& wo, const Vec3& wi, bool crosses);
std::optional<LobeSample> sample_lobe(const HairFibre& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
std::optional<LobeSample> sample_lobe(const HairLobe& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
Spectrum albedo_of(const HairFibre& c, const Vec3& wo);
Spectrum albedo_of(const HairLobe& c, const Vec3& wo);  // as if none were lost

// Across a fibre, -1 to 1, of a point on it with the surface's unit normal `n`, as seen from wo.
float across_fibre(const Vec3& tangent, const Vec3& n, const Vec3& wo);
// The same of a point on a tube of kTubeSides that stands for the fibre: `ng` is the normal of its
// side, `n` the direction from the fibre's middle.
inline constexpr int kTubeSides = 6;  // those that addon/export/strands.py makes; a test compares
float across_tube(const Vec3& tangent, const Vec3& n, const Vec3& ng, const Vec3& wo);

}  // namespace spc
