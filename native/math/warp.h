// SPDX-License-Identifier: GPL-3.0-or-later
// Warps of the unit square to the shapes that a path tracer samples, each with its density. All
// take u in [0, 1)^2, preserve area, and keep neighbours together so that stratification survives.
#pragma once

#include "math/vec.h"

namespace spc {

namespace detail {
// (cos, sin) of an angle of at most pi/4, to 3e-8: Taylor series, cheaper than the library's
// reduction.
inline Vec2 cos_sin_octant(float angle) {
    const float x2 = angle * angle;
    const float c =
        1 + x2 * (-1.0f / 2 + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
    const float s =
        1 + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880))));
    return {c, angle * s};
}
}  // namespace detail

// (cos, sin) of u turns, u in [0, 1].
inline Vec2 unit_circle(float u) {
    // u is not negative, and halfway either quarter will do.
    const int quarter = static_cast<int>(4.0f * u + 0.5f);  // NOLINT(bugprone-incorrect-roundings)
    const Vec2 p = detail::cos_sin_octant((u - 0.25f * static_cast<float>(quarter)) * (2.0f * kPi));
    switch (quarter & 3) {
        case 0: return p;
        case 1: return {-p.y, p.x};
        case 2: return {-p.x, -p.y};
        default: return {p.y, -p.x};
    }
}

// Unit disk by concentric squares [Shirley97]. Density 1/pi per unit of area.
inline Vec2 concentric_disk(const Vec2& u) {
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f};
    if (std::abs(a) > std::abs(b)) return detail::cos_sin_octant(kPi / 4 * (b / a)) * a;
    const Vec2 p = detail::cos_sin_octant(kPi / 4 * (a / b)) * b;
    return {p.y, p.x};
}

// The inverse of concentric_disk().
inline Vec2 concentric_square(const Vec2& p) {
    const float radius = std::sqrt(p.x * p.x + p.y * p.y);
    if (radius == 0.0f) return {0.5f, 0.5f};
    const bool by_x = std::abs(p.x) > std::abs(p.y);
    const float a = std::copysign(radius, by_x ? p.x : p.y);
    const float b = a * (4.0f * kInvPi) * (by_x ? std::atan(p.y / p.x) : std::atan(p.x / p.y));
    return by_x ? Vec2(0.5f * (a + 1.0f), 0.5f * (b + 1.0f))
                : Vec2(0.5f * (b + 1.0f), 0.5f * (a + 1.0f));
}

// Directions around +z in proportion to their cosine.
inline Vec3 cosine_hemisphere(const Vec2& u) {
    const Vec2 d = concentric_disk(u);
    return {d.x, d.y, safe_sqrt(1.0f - d.x * d.x - d.y * d.y)};
}
inline float cosine_hemisphere_pdf(float cos_theta) {
    return std::max(cos_theta, 0.0f) * kInvPi;
}  // 1/sr

// Directions uniform over the sphere.
inline Vec3 uniform_sphere(const Vec2& u) {
    const float radius = 2.0f * safe_sqrt(u.x * (1.0f - u.x));
    const Vec2 c = unit_circle(u.y);
    return {c.x * radius, c.y * radius, 1.0f - 2.0f * u.x};
}
inline constexpr float kUniformSpherePdf = 0.25f * kInvPi;  // 1/sr

// Directions uniform within a cone around +z. Its opening is given as 1 - cos(half angle), which
// keeps its digits for the half degree of a sun; one_minus_cos() computes it.
inline Vec3 uniform_cone(const Vec2& u, float one_minus_cos) {
    const float h = u.x * one_minus_cos;  // 1 - cos theta
    const float radius = safe_sqrt(h * (2.0f - h));
    const Vec2 c = unit_circle(u.y);
    return {c.x * radius, c.y * radius, 1.0f - h};
}
inline float uniform_cone_pdf(float one_minus_cos) {
    return 0.5f * kInvPi / one_minus_cos;
}  // 1/sr
inline float one_minus_cos(float half_angle) { return 2.0f * sqr(std::sin(0.5f * half_angle)); }

// Barycentric coordinates (b1, b2) of a point in a triangle, b0 = 1 - b1 - b2 [Heitz19]. Density
// 1/area.
inline Vec2 uniform_triangle(const Vec2& u) {
    if (u.y > u.x) {
        const float b1 = 0.5f * u.x;
        return {b1, u.y - b1};
    }
    const float b2 = 0.5f * u.y;
    return {u.x - b2, b2};
}

}  // namespace spc
