// SPDX-License-Identifier: GPL-3.0-or-later
// Blender's pixel filters by importance: a sample belongs to one pixel and is displaced by the
// filter's density, so pixels stay independent of each other.
#pragma once

#include "math/vec.h"

#include <vector>

namespace spc {

enum class FilterKind : uint8_t { box, gaussian, blackman_harris };

class PixelFilter {
public:
    // `width` as Blender states it, in pixels: its filters reach further than that (Gaussian 3,
    // Blackman-Harris 2 times in all); the box is always one pixel.
    PixelFilter(FilterKind kind, float width);
    // Offset from the pixel's centre for uniform u.
    Vec2 sample(const Vec2& u) const { return {invert(u.x), invert(u.y)}; }
    // Density of those offsets along one axis, 1/pixel: the share of what falls there that a pixel
    // takes.
    float weight(float offset) const {
        const float at = (offset + radius()) * cells_per_pixel_;
        return at >= 0.0f && at < static_cast<float>(density_.size())
                   ? density_[static_cast<size_t>(at)]
                   : 0.0f;
    }
    float radius() const { return static_cast<float>(radius_); }  // offsets lie within +-radius
    float variance() const { return variance_; }  // of offsets along one axis, pixels^2

private:
    float invert(float u) const;
    double radius_;
    std::vector<double> cumulative_;    // of the density, at equal steps
    std::vector<float> density_;        // between those, 1/pixel
    std::vector<uint16_t> first_cell_;  // where u = k / size falls, of each k
    float cells_per_pixel_;
    float variance_;
};

}  // namespace spc
