// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bsdf/lobe.h"

namespace spc {

// A Phong lobe around the half-vector, wider along one axis where the alphas differ, without
// Fresnel [Ashikhmin00]. No alpha is that of a delta. Its facets are none of microfacet.h: no chain
// turns there.
struct AshikhminShirley {
    static constexpr ClosureTraits kTraits{.reflected = BounceKind::glossy,
                                           .transmitted = BounceKind::glossy,
                                           .has_facets = true,
                                           .albedo_varies = true};
    Vec3 n;
    float alpha;
    float alpha_y = alpha;
    Vec3 tangent{0, 0, 0};  // unit, perpendicular to n; read where the lobe is anisotropic

    float mean_alpha() const { return std::sqrt(alpha * alpha_y); }
};

LobeEval eval_lobe(const AshikhminShirley& c, const Vec3& wo, const Vec3& wi, bool crosses);
std::optional<LobeSample> sample_lobe(const AshikhminShirley& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
Spectrum albedo_of(const AshikhminShirley& c, const Vec3& wo);  // about

}  // namespace spc
