// SPDX-License-Identifier: GPL-3.0-or-later
// Footprints: what a pixel, or a path after rough bounces, covers of a normal or height map, by ray
// differentials from the camera to the surface.
#pragma once

#include "film/filter.h"
#include "glints/slope_frame.h"
#include "manifold/chain.h"

namespace spc {

// The pixel and filter that a camera ray samples.
struct PixelKernel {
    const PixelFilter* filter;
    Vec2 film;    // the ray's position on the film, pixels of the full frame
    Vec2 offset;  // the same relative to the pixel's centre
};

// Path differential [Suykens01]: derivatives of a camera path by what it was drawn from.
struct PathDifferential {
    // By the film, per pixel. The tilt of microfacets against the interpolated normal, and the
    // direction that a diffuse surface scatters to, are held.
    RayDual film;
    // By the direction of its widest rough bounce, per standard deviation of the directions that it
    // stands for. Empty while all bounces are deltas.
    std::optional<RayDual> lobe{};
};

PathDifferential camera_differential(const Camera& camera, const PixelKernel& pixel,
                                     const Vec2& lens, const Vec3& direction);

// Transfers the differential by `distance` m to the surface and scatters it as `next` does. False
// if that is impossible, or if it is unknown how the normal of a delta lobe varies.
bool propagate_through_bounce(const Scene& scene, const Surface& surface, const ClosureSample& next,
                              double distance, PathDifferential& path);

// Where a path meets the map, in texels (SlopeField's coordinates, first repeat), with derivatives
// per pixel of the film and per standard deviation of the lobe.
struct Footprint {
    Vec2 at;
    std::array<Vec2, 2> by_film;
    std::array<Vec2, 2> by_lobe{Vec2(0.0f), Vec2(0.0f)};
    // How far the half-vector turns against the interpolated normal, rad per standard deviation of
    // the lobe, for light from near the mirror direction. 0 without a lobe.
    float lobe_turn = 0.0f;
    SlopeFrame frame;

    // Axes of the whole footprint for a kernel with `variance` along each axis: the film's own, or
    // axes with the covariance of film and lobe together. The lobe is narrowed until it turns the
    // half-vector by at most `most_turn`, rad.
    std::array<Vec2, 2> axes(float variance, float most_turn) const;
};
// `map` is the map of the surface's material, with an image of `width` x `height`. Empty if the
// mesh lacks the UV layer, or if the surface is seen edge-on or bumped across its own normal.
std::optional<Footprint> footprint_at(const Scene& scene, const SlopeMap& map, int width,
                                      int height, const Surface& surface,
                                      const PathDifferential& path, double distance);

}  // namespace spc
