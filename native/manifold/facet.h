// SPDX-License-Identifier: GPL-3.0-or-later
// Rough vertices of chains. The normal m of a microfacet is drawn from the lobe's distribution,
// with density D(m) (n.m), and kept while a chain is looked for [Zeltner20 Sec. 4.4]. The rough
// surface then acts as a mirror, or a refracting interface, with that normal.
#pragma once

#include "core/random.h"
#include "manifold/chain.h"

namespace spc {

// Draws the slopes of a facet along the two axes of a frame around the surface's normal. One fixed
// direction orients the frame, so that a slope means the same facet at every point.
Vec2 sample_facet(const SpecularInterface& interface, const Vec2& u);
// Slopes of the facet that takes light between wi and wo; both lie on the sides that the
// interaction demands. eta: see ChainVertex. Empty if there is no such facet.
std::optional<Vec2> facet_between(const DifferentialGeometry& geometry, Interaction interaction,
                                  float eta, const Vec3& wi, const Vec3& wo);
// Replaces the normal of the geometry and its derivatives by those of the facet.
void lean(DifferentialGeometry& geometry, const Vec2& slope);

// Density of wo (1/sr) if light from wi turns at facets drawn by sample_facet().
float facet_pdf(const SpecularInterface& interface, const DifferentialGeometry& geometry,
                Interaction interaction, float eta, const Vec3& wi, const Vec3& wo);

}  // namespace spc
