// SPDX-License-Identifier: GPL-3.0-or-later
// A rectangle seen from a point: its solid angle, and points uniform in it [Urena13].
#pragma once

#include "math/vec.h"

namespace spc {

// Below this solid angle (sr) single precision can move samples by more than some thousandths of
// the rectangle.
inline constexpr float kLeastRectangleSolidAngle = 0.02f;

// The viewer is the origin: the rectangle spans [x0, x1] x [y0, y1] at distance z > 0.
struct SphericalRectangle {
    float x0, x1, y0, y1, z;
    float solid_angle;  // sr

    SphericalRectangle(float from_x, float to_x, float from_y, float to_y, float distance)
        : x0(from_x), x1(to_x), y0(from_y), y1(to_y), z(distance) {
        start = corner(x0, y1) - corner(x0, y0);
        solid_angle = corner(x1, y1) - corner(x1, y0) - start;
    }

    // Position (x, y), uniform in solid angle; only where that is at least
    // kLeastRectangleSolidAngle.
    //
    // The part between the planes x = 0 and x has the solid angle W = asin(c b1) + asin(c b0) with
    // c = x / |(x, z)| and b the like for y1 and -y0. Solved for c: c = sin W / sqrt((b1 + b0 cos
    // W)^2 + (b0 sin W)^2).
    Vec2 sample(const Vec2& u) const {
        const float angle = start + u.x * solid_angle;
        const float b0 = -y0 / std::sqrt(y0 * y0 + z * z), b1 = y1 / std::sqrt(y1 * y1 + z * z);
        const float c = std::cos(angle), s = std::sin(angle);
        const float f = b1 + c * b0;
        const float x_over_z = s / safe_sqrt(f * f - s * s * (z * z / (y0 * y0 + z * z)));
        const float x = std::min(std::max(std::copysign(1.0f, f) * z * x_over_z, x0), x1);
        // Given x, the solid angle grows with the sine of the elevation over the plane y = 0.
        const float d2 = x * x + z * z;
        const float h = lerp(y0 / std::sqrt(d2 + y0 * y0), y1 / std::sqrt(d2 + y1 * y1), u.y);
        constexpr float kLeast =
            1e-12f;  // the elevation may reach a right angle by rounding; y1 bounds it then
        const float y = h * std::sqrt(d2 / std::max(1.0f - h * h, kLeast));
        return {x, std::min(std::max(y, y0), y1)};
    }

private:
    float start;  // W at x0

    // Signed solid angle between the foot of the perpendicular and one corner.
    float corner(float x, float y) const {
        return std::atan(x * y / (z * std::sqrt(x * x + y * y + z * z)));
    }
};

}  // namespace spc
