// SPDX-License-Identifier: GPL-3.0-or-later
// Rough vertices of chains: light turns at a microfacet whose normal m has been drawn from the
// lobe's distribution, with density D(m) (n.m), and is kept while a chain is looked for
// [Zeltner20 Sec. 4.4]. A rough surface is then a mirror, or an interface, with another normal.
#pragma once

#include "core/random.h"
#include "manifold/chain.h"

namespace spc {

// Slopes of a facet along the two axes of a frame around the surface's normal. The frame turns with
// the normal as one fixed direction has it, so that a slope names one facet everywhere.
Vec2 sample_facet(const SpecularInterface& interface, const Vec2& u);
// Of the facet that takes light between wi and wo, which lie as the interaction demands; eta as
// ChainVertex has it. Empty where there is none.
std::optional<Vec2> facet_between(const DifferentialGeometry& geometry, Interaction interaction,
                                  float eta, const Vec3& wi, const Vec3& wo);
// Makes the normal of the geometry that of the facet, with its derivatives.
void lean(DifferentialGeometry& geometry, const Vec2& slope);

// Density of wo, 1/sr, where light from wi turns at facets that have been drawn so.
float facet_pdf(const SpecularInterface& interface, const DifferentialGeometry& geometry,
                Interaction interaction, float eta, const Vec3& wi, const Vec3& wo);

}  // namespace spc
