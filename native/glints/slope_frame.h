// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface makes of the slopes of a map.
#pragma once

#include "glints/slope_field.h"

namespace spc {

// The slopes of a map at a point as normals: W (a, b, 1), not normalised, on the side of wo.
//
// A Bump node blends between that, normalised, and the interpolated normal, W's last column, by its
// strength s. With r = |W (a, b, 1)|, and the first two columns in the tangent plane, this is the
// direction of W (k a, k b, 1) for k = s / (s + (1 - s) r): W takes the slopes k (a, b). Of a normal
// map the field has the strength already.
struct SlopeFrame {
    std::array<Vec3, 3> w;  // columns, world
    float strength = 1.0f;  // (0, 1]

    // Of slopes as W takes them.
    Vec3 normal(const Vec2& slope) const { return w[0] * slope.x + w[1] * slope.y + w[2]; }
    float det() const { return dot(cross(w[0], w[1]), w[2]); }
    // What W makes into v.
    Vec3 coordinates(const Vec3& v) const {
        return Vec3(dot(cross(w[1], w[2]), v), dot(cross(w[2], w[0]), v), dot(cross(w[0], w[1]), v)) *
               (1.0f / det());
    }

    // The solid angle of normals over the area of slopes as W takes them, at slope 0.
    float angle_per_slope() const {
        return std::abs(det()) / (length_squared(w[2]) * length(w[2]));
    }

    // Of a field's slopes those that W takes.
    Vec2 taken(const Vec2& slope) const {
        return strength == 1.0f ? slope : slope * factor(rise(slope));
    }
    SlopeJet taken(const SlopeJet& jet) const;
    // A box that holds them all.
    SlopeBounds taken(const SlopeBounds& bounds) const;
    // As if k were the same for all.
    SlopeMoments taken(const SlopeMoments& moments) const;

private:
    // The tangent of the angle to W's last column, which has unit length unless the strength is 1.
    float rise(const Vec2& slope) const { return length(w[0] * slope.x + w[1] * slope.y); }
    // k.
    float factor(float rise) const {
        return strength / (strength + (1.0f - strength) * std::sqrt(1.0f + sqr(rise)));
    }
};

}  // namespace spc
