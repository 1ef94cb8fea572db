// SPDX-License-Identifier: GPL-3.0-or-later
// What a pixel covers of a normal or height map: ray differentials from the camera through mirrors and glass
// to the surface.
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

RayDual camera_differential(const Camera& camera, const PixelKernel& pixel, const Vec2& lens,
                            const Vec3& direction);

// Goes on to `hit`, at `distance`, and takes its delta lobe on the caster's normal. False where
// there is no way on, or no one knows how the normal varies.
bool pass_delta(const Scene& scene, const SurfaceHit& hit, double distance, bool refracted,
                RayDual& ray);

// Where a pixel's ray meets the map, in texels as SlopeField counts them, and how that moves with
// the film, per pixel. In the first tile.
struct Footprint {
    Vec2 at;
    std::array<Vec2, 2> by_film;
    SlopeFrame frame;

    float texels_per_pixel() const {
        return std::abs(by_film[0].x * by_film[1].y - by_film[0].y * by_film[1].x);
    }
};
// `map` is that of the material at the hit, with an image of `width` x `height`. Empty where the
// mesh lacks the UV layers, or the surface is seen edge-on or bumped across its own normal.
std::optional<Footprint> footprint_at(const Scene& scene, const SlopeMap& map, int width, int height,
                                      const Surface& surface, const RayDual& ray, double distance);

}  // namespace spc
