// SPDX-License-Identifier: GPL-3.0-or-later
// How a surface turns slopes of a map into normals.
#pragma once

#include "glints/slope_field.h"

namespace spc {

// Maps a slope (a, b) at a point to the normal W (a, b, 1), not normalised, on the side of wo.
//
// A Bump node of strength s blends that normal, normalised, with the interpolated normal, which is
// W's last column. Let r = |W (a, b, 1)|, and the first two columns lie in the tangent plane. Then
// the blend has the direction of W (k a, k b, 1) with k = s / (s + (1 - s) r), so W takes the
// slopes k (a, b). The field of a normal map includes the strength already.
struct SlopeFrame {
    std::array<Vec3, 3> w;  // columns, world
    float strength = 1.0f;  // (0, 1]

    // The normal of a slope that taken() has scaled.
    Vec3 normal(const Vec2& slope) const { return w[0] * slope.x + w[1] * slope.y + w[2]; }
    float det() const { return dot(cross(w[0], w[1]), w[2]); }
    // W^-1 v.
    Vec3 coordinates(const Vec3& v) const {
        return Vec3(dot(cross(w[1], w[2]), v), dot(cross(w[2], w[0]), v), dot(cross(w[0], w[1]), v)) *
               (1.0f / det());
    }

    // Solid angle of normals per area of scaled slopes, at slope 0.
    float angle_per_slope() const {
        return std::abs(det()) / (length_squared(w[2]) * length(w[2]));
    }

    // A field's slope times k.
    Vec2 taken(const Vec2& slope) const {
        return strength == 1.0f ? slope : slope * factor(rise(slope));
    }
    SlopeJet taken(const SlopeJet& jet) const;
    // A box around all scaled slopes.
    SlopeBounds taken(const SlopeBounds& bounds) const;
    // Approximation with the same k for all slopes.
    SlopeMoments taken(const SlopeMoments& moments) const;

private:
    // Tangent of the normal's angle to W's last column, which has unit length if the strength is
    // below 1.
    float rise(const Vec2& slope) const { return length(w[0] * slope.x + w[1] * slope.y); }
    // k.
    float factor(float rise) const {
        return strength / (strength + (1.0f - strength) * std::sqrt(1.0f + sqr(rise)));
    }
};

}  // namespace spc
