// SPDX-License-Identifier: GPL-3.0-or-later
// Light that goes on below the surface and leaves it elsewhere.
#pragma once

#include "bsdf/lobe.h"

namespace spc {

// How light enters below a surface: as from plaster, through facets, or half of it each way.
enum class SubsurfaceEntry : uint8_t { diffuse, facets, both };

// A medium in which light walks at random until it meets the object's surface again, from where it
// leaves as from a diffuse surface. The closure's weight holds what the surface reflects in all;
// eval() knows nothing of it: an integrator goes below, see integrator/subsurface.h.
struct Subsurface {
    static constexpr ClosureTraits kTraits{
        .reflected = BounceKind::diffuse, .transmitted = BounceKind::diffuse, .enters = true};
    Vec3 n;
    Spectrum albedo;   // what a diffuse surface would reflect
    Spectrum radius;   // m, how far light comes
    float anisotropy;  // mean cosine of a scattering, 0 .. 0.9
    float alpha, ior;  // of facets where light enters
    SubsurfaceEntry entry;
    bool dipole_radius;  // `radius` is that of a dipole's falloff, else 4 pi mean free paths
};

// Coefficients of the medium, one for each channel.
struct SubsurfaceMedium {
    Spectrum extinction;         // 1/m
    Spectrum single_scattering;  // albedo of one scattering
    float anisotropy;
};
SubsurfaceMedium medium_of(const Subsurface& closure);

// A direction below the surface, cosine-distributed or through a facet; empty where the geometry,
// of normal ng, or a total reflection is in its way.
std::optional<Vec3> enter(const Subsurface& closure, const Vec3& ng, const Vec3& wo, float u_entry,
                          const Vec2& u);

// A direction after a scattering, in proportion to the phase function of Henyey and Greenstein.
Vec3 sample_phase(const Vec3& direction, float anisotropy, const Vec2& u);

LobeEval eval_lobe(const Subsurface& c, const Vec3& wo, const Vec3& wi, bool crosses);
std::optional<LobeSample> sample_lobe(const Subsurface& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u);
Spectrum albedo_of(const Subsurface& c, const Vec3& wo);

}  // namespace spc
