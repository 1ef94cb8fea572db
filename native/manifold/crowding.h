// SPDX-License-Identifier: GPL-3.0-or-later
// How many chains at once each caster sends to a point. The more there are, the more a search costs
// and the more rarely it finds each of them. Light paths and path tracing do not depend on the
// number. Once a budget is cancelled the numbers are of no use.
#pragma once

#include "manifold/sheet_pool.h"

namespace spc {

// Whether path tracing can hit every light that feeds casters, so that it finds what neither the
// manifold nor light paths do. It cannot hit lights without extent, nor those that cast no shadow.
bool rays_find_all(const Scene& scene, const LightSet& lights);

// For each caster of the set, about how many chains its normal map makes; 0 without a map. If
// slopes vary fast, this is the mean number of places that have the slope which light needs
// [Rice44]: mean |det d slope / d p| times the area on which the needed slopes are in the map's
// range. The area grows with the distances to the lights and to where the caster's light falls,
// which some rays measure.
std::vector<double> chains_by_maps(const Scene& scene, const LightSet& lights,
                                   const CasterSet& casters, uint32_t seed,
                                   const Budget& budget = {});

// For each caster of the set, the number of sheet seeds at a point, averaged over the light that
// the sheets bring. This includes shapes and maps, as far as the grids of rays resolve them.
std::vector<double> chains_by_sheets(const CasterSet& casters, const SheetPool& sheets,
                                     uint32_t seed, const Budget& budget = {});

}  // namespace spc
