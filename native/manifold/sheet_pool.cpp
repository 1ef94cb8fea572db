// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/sheet_pool.h"

namespace spc {

namespace {

constexpr uint32_t kMostSheets = 16, kMostOfLight = 8;
constexpr uint32_t kFewestCells = 64;  // of a sheet

// Light points, and the points of their light for which they are the nearest.
struct SheetPoint {
    LightPoint y;
    float reach;  // how far those lie, m or, of a distant light, as a difference of directions
    std::vector<LightPoint> around;  // some of them, far apart
};

float distance_between(const LightPoint& a, const LightPoint& b) {
    return length(shift_between(a, b));
}

// Points of the light, spread over it by its power.
std::vector<LightPoint> points_of(const Scene& scene, const LightSet& lights, uint32_t light,
                                  uint32_t seed) {
    constexpr uint32_t kProbes = 256;
    std::vector<LightPoint> points;
    for (uint32_t i = 0; i < kProbes; ++i) {
        const Vec2 u = Sampler(seed, light, i)[Domain::manifold_light].two();
        if (const std::optional<LightPoint> y = sample_point_of_light(lights, scene, light, u))
            points.push_back(*y);
    }
    return points;
}

// Each further one is the point that lies farthest from y and those there are.
std::vector<LightPoint> far_points(const LightPoint& y, const std::vector<LightPoint>& points) {
    constexpr size_t kMost = 6;
    std::vector<LightPoint> result;
    std::vector<float> distance;
    for (const LightPoint& point : points) distance.push_back(distance_between(point, y));
    while (result.size() < kMost && !points.empty()) {
        const auto farthest = std::max_element(distance.begin(), distance.end());
        if (!(*farthest > 0.0f)) break;
        result.push_back(points[static_cast<size_t>(farthest - distance.begin())]);
        for (size_t i = 0; i < points.size(); ++i)
            distance[i] = std::min(distance[i], distance_between(points[i], result.back()));
    }
    return result;
}

// Starts in the middle; each further sheet point is the point that lies farthest from those there
// are.
std::vector<SheetPoint> sheet_points_of(const std::vector<LightPoint>& points,
                                        const EmissionGuide& guide, size_t most) {
    constexpr float kFar = 1.0f / 16;  // rad, as the casters see it
    std::vector<SheetPoint> sheet_points;
    if (points.empty()) return sheet_points;
    const LightPoint* next = &points.front();
    float least = kInfinity;
    for (const LightPoint& y : points) {
        float sum = 0.0f;
        for (const LightPoint& other : points) sum += distance_between(y, other);
        if (sum >= least) continue;
        least = sum;
        next = &y;
    }
    std::vector<float> distance(points.size(), kInfinity);
    std::vector<size_t> nearest(points.size(), 0);
    for (;;) {
        const LightPoint y = *next;
        size_t farthest = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            const float d = distance_between(points[i], y);
            if (d < distance[i]) {
                distance[i] = d;
                nearest[i] = sheet_points.size();
            }
            if (distance[i] > distance[farthest]) farthest = i;
        }
        sheet_points.push_back({y, 0.0f, {}});
        const float far = y.distant ? kFar : kFar * length(y.p - guide.center);
        if (sheet_points.size() == most || !(distance[farthest] > far)) break;
        next = &points[farthest];
    }
    for (size_t s = 0; s < sheet_points.size(); ++s) {
        std::vector<LightPoint> own;
        for (size_t i = 0; i < points.size(); ++i) {
            if (nearest[i] != s) continue;
            own.push_back(points[i]);
            sheet_points[s].reach = std::max(sheet_points[s].reach, distance[i]);
        }
        sheet_points[s].around = far_points(sheet_points[s].y, own);
    }
    return sheet_points;
}

}  // namespace

const LightSheet* nearest_sheet(const LightSheets& sheets, const LightPoint& y) {
    const LightSheet* nearest = nullptr;
    float least = kInfinity;
    for (const std::unique_ptr<const LightSheet>& sheet : sheets.all) {
        if (sheet->light_point().light != y.light) continue;
        const float d2 = length_squared(shift_between(sheet->light_point(), y));
        if (nearest != nullptr && !(d2 < least)) continue;
        nearest = sheet.get();
        least = d2;
    }
    return nearest;
}

SheetPool build_sheets(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                       const ManifoldSettings& settings, uint32_t seed, uint32_t emission_cells,
                       uint32_t threads, const Budget& budget) {
    if (casters.empty() || lights.caustic_selection.empty()) return {};
    std::vector<uint32_t> feeding;
    for (uint32_t i = 0; i < lights.count(); ++i)
        if (lights.caustic_selection.probability(i) > 0.0f) feeding.push_back(i);
    std::stable_sort(feeding.begin(), feeding.end(), [&](uint32_t a, uint32_t b) {
        return lights.caustic_selection.probability(a) > lights.caustic_selection.probability(b);
    });
    // A sheet serves the points around its own, too, from which the beam goes elsewhere.
    const EmissionGuide guide = aim_at_casters(scene, lights, casters, Squares::of_casters);
    std::vector<SheetPoint> sheet_points;
    for (const uint32_t light : feeding) {
        const size_t most = std::min<size_t>(kMostOfLight, kMostSheets - sheet_points.size());
        if (most == 0) break;
        const std::vector<SheetPoint> more =
            sheet_points_of(points_of(scene, lights, light, seed), guide, most);
        sheet_points.insert(sheet_points.end(), more.begin(), more.end());
    }
    const auto count = static_cast<uint32_t>(sheet_points.size());
    const SheetWorld world{scene,
                           lights,
                           casters,
                           guide,
                           settings.longest_chain,
                           threads,
                           budget,
                           budget.work() / static_cast<double>(count)};
    SheetPool sheets;
    uint64_t rays = 0;
    for (const SheetPoint& sheet_point : sheet_points) {
        if (budget.is_spent(rays)) break;
        sheets.push_back(std::make_unique<const LightSheet>(
            world, sheet_point.y, std::max(kFewestCells, emission_cells / count), sheet_point.reach,
            sheet_point.around));
        rays += sheets.back()->rays();
    }
    return sheets;
}

}  // namespace spc
