// SPDX-License-Identifier: GPL-3.0-or-later
// Paths from the light through casters to a surface that the camera sees.
#pragma once

#include "film/film.h"
#include "integrator/path.h"

#include <atomic>

namespace spc {

struct LightPathStats {
    uint64_t paths = 0;
    uint64_t splats = 0;
    uint64_t rays = 0;
    uint64_t nan_splats = 0;
    void add(const LightPathStats& other) {
        paths += other.paths;
        splats += other.splats;
        rays += other.rays;
        nan_splats += other.nan_splats;
    }
};

// One light path; appends what it adds within the camera's crop and `margin` pixels around it. A
// picture is the sum over settings.light_tracing.paths of them.
void trace_light_path(const RenderScene& world, const IntegratorSettings& settings, float margin,
                      uint32_t seed, uint64_t index, std::vector<Splat>& splats,
                      LightPathStats& stats);

// What a pilot has learned.
struct LightPilot {
    EmissionGuide guide;
    double luminance;  // that light tracing alone would add to the picture, summed over its pixels
    double rays;       // of a light path
};
// Sends light paths to learn where those begin that add to the picture. Does not depend on
// `threads`. Null where no light reaches the camera that way, or `cancelled` was set meanwhile.
std::unique_ptr<const LightPilot> learn_emission(const RenderScene& world,
                                                 IntegratorSettings settings, float margin,
                                                 uint32_t seed, uint32_t threads,
                                                 const std::atomic<bool>& cancelled,
                                                 LightPathStats& stats);

}  // namespace spc
