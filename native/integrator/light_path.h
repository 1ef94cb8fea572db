// SPDX-License-Identifier: GPL-3.0-or-later
// Paths from the light through casters to a surface that the camera sees.
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
    // Sums of the splats' squares, means of the channels: at the receiver, and behind it, with the
    // rays that went there.
    double squares = 0.0, squares_behind = 0.0;
    uint64_t rays_behind = 0;
    // Luminance that the splats' paths carry, whoever shares it, and the manifold's share of that.
    double carried = 0.0, carried_for_manifold = 0.0;
    // Of what glints throw on: that luminance, and it times LightTracing::beside_glints as this light
    // by itself would have it.
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

// One light path; appends what it adds within the camera's crop and `margin` pixels around it. A
// picture is the sum over settings.light_tracing.paths of them.
void trace_light_path(const RenderScene& world, const IntegratorSettings& settings, float margin,
                      uint32_t seed, uint64_t index, std::vector<Splat>& splats,
                      LightPathStats& stats);

// What a pilot has learned.
struct LightPilot {
    EmissionGuide guide;
    double goes_on;         // as LightTracing has it, for the least variance of the work
    CoarsePicture squares;  // second moment of what one path would add to the picture by itself
    double rays;            // of one path
    double come_through;    // share of the paths that add to the picture
    double mean_search_trials, manifold_share, beside_glints;  // as LightTracing has them
};
// Where fewer come through to the camera it sees little of the caustics directly, and few light paths
// will be shot: what the first generations learned is good enough for those.
inline constexpr double kFewComeThrough = 1.0 / 32;
// Enough to show where the light comes from, few beside a render of a second.
constexpr uint32_t kLeastPilotPaths = 1u << 16;
// Sends so many light paths, a quarter or half of them where few come through to the camera, to learn
// where those begin that add to the picture, and which of their chains `sheets` lead to, if there are
// any. Where the budget is spent before, it ends with what it has by then. Does not depend on `threads`.
// Null where no light reaches the camera that way, or the budget was cancelled.
std::unique_ptr<const LightPilot> learn_emission(const RenderScene& world,
                                                 IntegratorSettings settings,
                                                 const LightSheets& sheets, float margin,
                                                 uint32_t paths, uint32_t seed, uint32_t threads,
                                                 const Budget& budget, LightPathStats& stats);

}  // namespace spc
