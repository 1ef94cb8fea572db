// SPDX-License-Identifier: GPL-3.0-or-later
// By how many chains at once light comes to a point by way of each caster. A search costs as much as there
// are, and comes to each of them as rarely; light paths and path tracing do not mind how many there are.
#pragma once

#include "manifold/sheet_pool.h"

namespace spc {

// Whether path tracing comes to every light that feeds casters, so that it finds what neither the manifold nor
// light paths do: not to lights without extent, nor to those that shine through everything.
bool rays_find_all(const Scene& scene, const LightSet& lights);

// Of each caster of the set, about: those that its normal map makes. For slopes that vary fast, the mean
// number of places where a map has the slope that light needs [Rice44]: mean |det d slope / d p| times the
// area on which the slopes that light needs are those that the map has.
// That area grows with the distances to where the caster's light falls, and to the lights, which some
// rays measure. 0 without a map.
std::vector<double> chains_by_maps(const Scene& scene, const LightSet& lights,
                                   const CasterSet& casters, uint32_t seed);

// Of each caster of the set: chain seeds of the sheets at a point that they light, the mean over that light.
// This knows of shapes as well as of maps, as far as the grids of rays resolve them.
std::vector<double> chains_by_sheets(const CasterSet& casters, const SheetPool& sheets,
                                     uint32_t seed);

}  // namespace spc
