// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/sheet_pool.h"

namespace spc {

const LightSheet* nearest_sheet(const LightSheets& sheets, const LightPoint& y) {
    const LightSheet* nearest = nullptr;
    float least = kInfinity;
    for (const std::unique_ptr<const LightSheet>& sheet : sheets) {
        if (!sheet || sheet->light_point().light != y.light) continue;
        const float d2 = length_squared(shift_between(sheet->light_point(), y));
        if (nearest != nullptr && !(d2 < least)) continue;
        nearest = sheet.get();
        least = d2;
    }
    return nearest;
}

SheetPool::SheetPool(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                     const ManifoldSettings& settings, uint32_t seed, uint32_t count, uint32_t tiles)
    : scene_(scene),
      lights_(lights),
      casters_(casters),
      guide_(aim_at_casters(scene, lights, casters)),
      settings_(settings),
      tiles_(tiles),
      reach_(count, 0.0f),
      sheets_(count),
      done_(count) {
    // Stratified over all sheets.
    for (uint32_t i = 0; i < count; ++i) points_.push_back(draw(Domain::manifold_light, seed, i));
    measure_reach(seed);
}

std::optional<LightPoint> SheetPool::draw(Domain domain, uint32_t seed, uint32_t index) const {
    return sample_light_point(lights_, scene_, Sampler(seed, kNone, index)[domain].three());
}

// Nine tenths of the light points that are nearest to a sheet lie within its reach.
void SheetPool::measure_reach(uint32_t seed) {
    constexpr uint32_t kProbes = 1024;
    std::vector<std::vector<float>> distances(points_.size());
    for (uint32_t i = 0; i < kProbes; ++i) {
        const std::optional<LightPoint> y = draw(Domain::light_point, seed, i);
        if (!y) continue;
        size_t nearest = points_.size();
        float least = kInfinity;
        for (size_t k = 0; k < points_.size(); ++k) {
            if (!points_[k] || points_[k]->light != y->light) continue;
            const float distance = length(shift_between(*points_[k], *y));
            if (distance >= least) continue;
            nearest = k;
            least = distance;
        }
        if (nearest < points_.size()) distances[nearest].push_back(least);
    }
    for (size_t k = 0; k < points_.size(); ++k) {
        std::vector<float>& all = distances[k];
        if (all.empty()) continue;
        const auto most = all.begin() + static_cast<long>(all.size() * 9 / 10);
        std::nth_element(all.begin(), most, all.end());
        reach_[k] = *most;
    }
}

uint64_t SheetPool::build(uint32_t index) {
    if (const std::optional<LightPoint>& y = points_[index])
        sheets_[index] = std::make_unique<const LightSheet>(
            SheetWorld{scene_, lights_, casters_, guide_, settings_.longest_chain,
                       settings_.cancelled},
            *y, tiles_, reach_[index]);
    done_[index] = true;
    return sheets_[index] ? sheets_[index]->rays() : 0;
}

bool SheetPool::has_first(uint32_t n) const {
    return std::all_of(done_.begin(), done_.begin() + n,
                       [](const std::atomic<bool>& done) { return done.load(); });
}

}  // namespace spc
