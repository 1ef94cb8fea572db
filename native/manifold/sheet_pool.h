// SPDX-License-Identifier: GPL-3.0-or-later
// The light sheets of a render: some for each light that feeds casters, which any estimate may use
// whose own light point lies near.
#pragma once

#include "manifold/sheet.h"

namespace spc {

using SheetPool = std::vector<std::unique_ptr<const LightSheet>>;
// Builds them all, on so many threads (0: all): so many for a light that no point of it is far from
// one of theirs, as the casters see it, up to a limit. Together they have some `emission_cells` parts, but no
// sheet has less than a few. What the budget leaves no time for they do without. None without casters
// or lights that feed them.
SheetPool build_sheets(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                       const ManifoldSettings& settings, uint32_t seed, uint32_t emission_cells,
                       uint32_t threads, const Budget& budget = {});

struct LightSheets {
    std::span<const std::unique_ptr<const LightSheet>> all;
    // A chain that promises to add this much radiance to its pixel is looked for with certainty, a
    // weaker one by a probability in proportion. 0: all are.
    float sure = 0.0f;
};

// The sheet of the light whose point is nearest to y, or null: chains to y differ little from those
// to its neighbours.
const LightSheet* nearest_sheet(const LightSheets& sheets, const LightPoint& y);

}  // namespace spc
