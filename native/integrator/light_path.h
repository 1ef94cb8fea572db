// SPDX-License-Identifier: GPL-3.0-or-later
// Light tracing: paths from a light through casters to surfaces that the camera sees.
#pragma once

#include "core/budget.h"
#include "film/coarse_picture.h"
#include "film/film.h"
#include "integrator/path.h"

namespace spc {

struct LightPathStats {
    uint64_t paths = 0;
    uint64_t splats = 0;
    uint64_t rays = 0;
    uint64_t nan_splats = 0;
    // Sums of the splats' squared values, means of the channels: of splats at the receiver, and of
    // those that took a scattering there, with the rays that these took.
    double squares = 0.0, squares_behind = 0.0;
    uint64_t rays_behind = 0;
    // Luminance that the splats' paths carry before weights, and the manifold's share of it.
    double carried = 0.0, carried_for_manifold = 0.0;
    // The same luminance of paths that glints reflect, and that times the value of
    // LightTracing::beside_glints that would be best for this light alone.
    double carried_by_glints = 0.0, beside_glints = 0.0;

    void add(const LightPathStats& other) {
        paths += other.paths;
        splats += other.splats;
        rays += other.rays;
        nan_splats += other.nan_splats;
        squares += other.squares;
        squares_behind += other.squares_behind;
        rays_behind += other.rays_behind;
        carried += other.carried;
        carried_for_manifold += other.carried_for_manifold;
        carried_by_glints += other.carried_by_glints;
        beside_glints += other.beside_glints;
    }
};

// Traces one light path. Appends the splats that lie in the camera's crop or at most `margin`
// pixels beside it. A sample of the picture is the sum over settings.light_tracing.paths of them.
void trace_light_path(const RenderScene& world, const IntegratorSettings& settings, float margin,
                      uint32_t seed, const SplatIndex& index, std::vector<Splat>& splats,
                      LightPathStats& stats);

// What the pilot, light paths that are traced before rendering, has learned.
struct LightPilot {
    EmissionGuide guide;
    double goes_on;         // LightTracing::goes_on of least variance times work
    CoarsePicture squares;  // second moment of what one path adds to each part of the picture
    double rays;            // mean number of a path's rays
    double come_through;    // share of the paths that add to the picture
    double mean_search_trials, manifold_share, beside_glints;  // see LightTracing
};
// If fewer of the pilot's paths come through, the camera sees little of the caustics directly and
// few light paths will be traced, so the pilot ends early.
inline constexpr double kFewComeThrough = 1.0 / 32;
// Least number of pilot paths: enough to show where the light comes from, few beside a second's
// work.
constexpr uint32_t kLeastPilotPaths = 1u << 16;
// Traces `paths` light paths, or a quarter or half of them if few come through to the camera.
// Learns where those begin that add to the picture, and which of their chains the sheets find. Ends
// early when the budget is spent. The result does not depend on `threads`. Null if no light reaches
// the camera this way, or if the budget was cancelled.
std::unique_ptr<const LightPilot> learn_emission(const RenderScene& world,
                                                 IntegratorSettings settings,
                                                 const LightSheets& sheets, float margin,
                                                 uint32_t paths, uint32_t seed, uint32_t threads,
                                                 const Budget& budget, LightPathStats& stats);

}  // namespace spc
