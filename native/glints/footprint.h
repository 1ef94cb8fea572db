// SPDX-License-Identifier: GPL-3.0-or-later
// What a pixel covers of a normal or height map, and what a path covers that comes to it after rough
// bounces: ray differentials from the camera to the surface.
#pragma once

#include "film/filter.h"
#include "glints/slope_frame.h"
#include "manifold/chain.h"

namespace spc {

// The pixel that a camera's ray stands for.
struct PixelKernel {
    const PixelFilter* filter;
    Vec2 film;    // where the ray passes, pixels of the full frame
    Vec2 offset;  // the same from the pixel's centre
};

// How a path from the camera moves with what it was drawn from: a path differential [Suykens01].
struct PathDifferential {
    // With the film, per pixel, if all else stays: the tilt of microfacets against the interpolated
    // normal, and the direction that a diffuse surface scatters to.
    RayDual film;
    // With the direction that its widest rough bounce took, per standard deviation of those nearby
    // that stand for it; empty while all bounces are deltas.
    std::optional<RayDual> lobe{};
};

PathDifferential camera_differential(const Camera& camera, const PixelKernel& pixel,
                                     const Vec2& lens, const Vec3& direction);

// Goes on to the surface, at `distance`, and scatters there as `next` does. False where there is no
// way on, or no one knows how the normal of a delta lobe varies.
bool propagate_through_bounce(const Scene& scene, const Surface& surface, const ClosureSample& next,
                              double distance, PathDifferential& path);

// Where a path meets the map, in texels as SlopeField counts them, and how that moves, per pixel of
// the film and per standard deviation of the lobe. In the first repeat.
struct Footprint {
    Vec2 at;
    std::array<Vec2, 2> by_film;
    std::array<Vec2, 2> by_lobe{Vec2(0.0f), Vec2(0.0f)};
    // How far the half-vector turns with the lobe against the interpolated normal, rad per standard
    // deviation, for light from about the mirrored direction; 0 without a lobe.
    float lobe_turn = 0.0f;
    SlopeFrame frame;

    // Axes of both together, for a kernel that has `variance` along each: the film's own, or those
    // of as much covariance as film and lobe have, of which the latter turns the half-vector by
    // `most_turn` at most, rad.
    std::array<Vec2, 2> axes(float variance, float most_turn) const;
};
// `map` is that of the material at the hit, with an image of `width` x `height`. Empty where the
// mesh lacks the UV layers, or the surface is seen edge-on or bumped across its own normal.
std::optional<Footprint> footprint_at(const Scene& scene, const SlopeMap& map, int width,
                                      int height, const Surface& surface,
                                      const PathDifferential& path, double distance);

}  // namespace spc
