// SPDX-License-Identifier: GPL-3.0-or-later
// How much a rough closure scatters in all, from tables, and what energy compensation makes of it.
#pragma once

#include "bsdf/closure.h"

namespace spc {

// Factor on a closure's weight that restores the light lost between its microfacets, for light seen
// from wo; 1 where the closure is not compensated. For a reflector [Kulla17], [Turquin19], as
// Cycles weighs it: with E the share that a white lobe reflects once, the rest 1 - E returns after
// further bounces coloured by F_ms = F E_avg / (1 - F (1 - E_avg)), F the mean Fresnel reflectance,
// so that the factor is 1 + F_ms (1 - E) / E.
Spectrum energy_compensation(const ClosureKind& kind, const Vec3& wo);

// Share of wo's light that a reflection keeps from the layer below: its albedo, or, where light
// between its facets is lost, the mean reflectance of the facets, as in Cycles.
Spectrum kept_from_below(const MicrofacetReflection& layer, const Vec3& wo);

}  // namespace spc
