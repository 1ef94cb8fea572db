// SPDX-License-Identifier: GPL-3.0-or-later
// The light sheets of a render: several for each light that feeds casters. An estimate uses the one
// whose light point is nearest to its own.
#pragma once

#include "manifold/sheet.h"

namespace spc {

using SheetPool = std::vector<std::unique_ptr<const LightSheet>>;
// Builds all sheets on `threads` threads (0: all). A light gets as many as it takes for none of its
// points to be far from a sheet's, as the casters see it, up to a limit. Together the sheets have
// about `emission_cells` cells, each at least a few. What does not fit into the budget is left out.
// Empty without casters or lights that feed them.
SheetPool build_sheets(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                       const ManifoldSettings& settings, uint32_t seed, uint32_t emission_cells,
                       uint32_t threads, const Budget& budget = {});

struct LightSheets {
    std::span<const std::unique_ptr<const LightSheet>> all;
    // A chain that is expected to add this radiance to its pixel is shot with certainty, a weaker
    // one with a proportional probability. 0: all are shot.
    float sure = 0.0f;
};

// The sheet of y's light whose point is nearest to y, or null. Chains to y differ little from those
// to points near it.
const LightSheet* nearest_sheet(const LightSheets& sheets, const LightPoint& y);

}  // namespace spc
