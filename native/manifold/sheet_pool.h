// SPDX-License-Identifier: GPL-3.0-or-later
// The light sheets of a render: some for each light point that matters, which any estimate may use
// whose own light point lies near.
#pragma once

#include "manifold/sheet.h"

namespace spc {

// Those that there are; any light may have some.
using LightSheets = std::span<const std::unique_ptr<const LightSheet>>;

// The sheet of the light whose point is nearest to y, or null: chains to y differ little from those
// to its neighbours.
const LightSheet* nearest_sheet(const LightSheets& sheets, const LightPoint& y);

class SheetPool {
public:
    // Draws light points for `count` sheets of `tiles` parts; builds none. All that it is given must
    // outlive the pool.
    SheetPool(const Scene& scene, const LightSet& lights, const CasterSet& casters,
              const ManifoldSettings& settings, uint32_t seed, uint32_t count, uint32_t tiles);

    uint32_t size() const { return static_cast<uint32_t>(sheets_.size()); }
    // Builds one; any may be under way at a time. Returns the rays that it took.
    uint64_t build(uint32_t index);
    // Whether the first n have been built; then they may be used.
    bool has_first(uint32_t n) const;
    LightSheets first(uint32_t n) const { return LightSheets(sheets_).first(n); }

private:
    void measure_reach(uint32_t seed);
    std::optional<LightPoint> draw(Domain domain, uint32_t seed, uint32_t index) const;

    const Scene& scene_;
    const LightSet& lights_;
    const CasterSet& casters_;
    const EmissionGuide guide_;
    const ManifoldSettings& settings_;
    const uint32_t tiles_;
    std::vector<std::optional<LightPoint>> points_;
    std::vector<float> reach_;  // of each, see LightSheet
    std::vector<std::unique_ptr<const LightSheet>> sheets_;
    std::vector<std::atomic<bool>> done_;
};

}  // namespace spc
