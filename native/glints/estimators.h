// SPDX-License-Identifier: GPL-3.0-or-later
// Estimators of f |cos| averaged over a footprint, for the light from one direction.
#pragma once

#include "glints/flakes.h"
#include "glints/site.h"

namespace spc {

struct GlintStats {
    uint64_t estimates = 0;
    uint64_t nodes = 0;   // nodes of pyramids, flakes, or slopes along walks that were visited
    uint64_t points = 0;  // points of the map, or flakes, at which lobes were evaluated
    uint64_t capped = 0;  // estimates by walks that reached the limit of trials
    void add(const GlintStats& other) {
        estimates += other.estimates;
        nodes += other.nodes;
        points += other.points;
        capped += other.capped;
    }
};

// How much noise the search may leave: its variance is at most mean * max(mean / points, faint),
// with the mean as the moments of the slopes predict it.
struct GlintPrecision {
    float points;
    float faint = 0.0f;  // in units of the estimate
};

// Searches a pyramid of slopes for those that reflect light to the camera. Unbiased.
Spectrum search_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                          const GlintPrecision& precision, uint64_t seed, GlintStats& stats);

// Newton walks on the map [Zeltner20 Sec. 4.5]. Unbiased up to the limit of trials, which is
// counted. The biased variant is the sum over the solutions that `walks` walks find, which is too
// dark.
Spectrum walk_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                        uint64_t seed, GlintStats& stats);
Spectrum walk_footprint_biased(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                               uint32_t walks, uint64_t seed, GlintStats& stats);

// Gaussians of position and slope [Yan16]. Deterministic, but biased: a flake is a Gaussian on
// which the slope is linear, the pixel filter a Gaussian, and a lobe a sum of a few Gaussians.
Spectrum query_flakes(const FlakeField& flakes, const GlintSite& site, const GlintTarget& target,
                      const Vec3& wi, GlintStats& stats);

}  // namespace spc
