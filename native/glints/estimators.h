// SPDX-License-Identifier: GPL-3.0-or-later
// Estimators of f |cos| averaged over a footprint, for the light from one direction.
#pragma once

#include "glints/flakes.h"
#include "glints/site.h"

namespace spc {

struct GlintStats {
    uint64_t estimates = 0;
    uint64_t nodes = 0;   // of pyramids, flakes, or slopes on a walk, that were looked at
    uint64_t points = 0;  // of the map, or flakes, at which lobes were evaluated
    uint64_t capped = 0;  // estimates of walks that gave up at the limit of trials
    void add(const GlintStats& other) {
        estimates += other.estimates;
        nodes += other.nodes;
        points += other.points;
        capped += other.capped;
    }
};

// How much noise the search may leave: its variance is at most mean times the larger one of
// mean / points, where the moments of the slopes tell the mean, and `faint`.
struct GlintPrecision {
    float points;
    float faint = 0.0f;  // in units of the estimate
};

// Unbiased.
Spectrum search_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                          const GlintPrecision& precision, uint64_t seed, GlintStats& stats);

// By Newton walks [Zeltner20 Sec. 4.5]: unbiased but for a limit of trials, which is counted; or the
// sum over the solutions that `walks` of them find, which is too little.
Spectrum walk_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                        uint64_t seed, GlintStats& stats);
Spectrum walk_footprint_biased(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                               uint32_t walks, uint64_t seed, GlintStats& stats);

// By Gaussians of position and slope [Yan16]. Draws nothing; biased: flakes are Gaussians on which
// the slope is linear, the pixel's filter is a Gaussian, and lobes are sums of a few.
Spectrum query_flakes(const FlakeField& flakes, const GlintSite& site, const GlintTarget& target,
                      const Vec3& wi, GlintStats& stats);

}  // namespace spc
