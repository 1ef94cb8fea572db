// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_patch.h"

namespace spc {

namespace {

// Bezier points, on the interval between the middle ones of four coefficients, of the uniform cubic
// B-spline that they make.
std::array<float, 4> spline(const std::array<float, 4>& p) {
    constexpr float kSixth = 1.0f / 6.0f;
    return {(p[0] + 4.0f * p[1] + p[2]) * kSixth, (4.0f * p[1] + 2.0f * p[2]) * kSixth,
            (2.0f * p[1] + 4.0f * p[2]) * kSixth, (p[1] + 4.0f * p[2] + p[3]) * kSixth};
}

// Bezier points of the spline's derivative, a quadratic raised to a cubic. Differences of the
// coefficients are exact where differences of the points above would lose digits.
std::array<float, 4> spline_derivative(const std::array<float, 4>& p) {
    constexpr float kSixth = 1.0f / 6.0f;
    const float d0 = p[1] - p[0], d1 = p[2] - p[1], d2 = p[3] - p[2];
    return {(d0 + d1) * 0.5f, (d0 + 5.0f * d1) * kSixth, (5.0f * d1 + d2) * kSixth,
            (d1 + d2) * 0.5f};
}

// Bernstein polynomials and their derivatives.
struct Bernstein {
    std::array<float, 4> b, d;
    explicit Bernstein(float t) {
        const float r = 1.0f - t;
        b = {r * r * r, 3.0f * t * r * r, 3.0f * t * t * r, t * t * t};
        d = {-3.0f * r * r, 3.0f * r * (r - 2.0f * t), 3.0f * t * (2.0f * r - t), 3.0f * t * t};
    }
};

Vec2 combined(const HeightPatch::Row& points, const std::array<float, 4>& weights) {
    return points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2] +
           points[3] * weights[3];
}

// Bezier points of the lower or upper half.
HeightPatch::Row halved(const HeightPatch::Row& p, bool upper) {
    const Vec2 a = (p[0] + p[1]) * 0.5f, b = (p[1] + p[2]) * 0.5f, c = (p[2] + p[3]) * 0.5f;
    const Vec2 ab = (a + b) * 0.5f, bc = (b + c) * 0.5f, middle = (ab + bc) * 0.5f;
    if (upper) return {middle, bc, c, p[3]};
    return {p[0], a, ab, middle};
}

}  // namespace

SlopeJet NormalPatch::jet(float s, float t) const {
    const Vec3 lower = corner[0] + (corner[1] - corner[0]) * s,
               upper = corner[2] + (corner[3] - corner[2]) * s,
               left = corner[0] + (corner[2] - corner[0]) * t,
               right = corner[1] + (corner[3] - corner[1]) * t;
    const Vec3 n = lower + (upper - lower) * t;
    const Vec2 slope = slope_of(n);
    const auto by = [&](const Vec3& d) {  // of a quotient
        return (Vec2(d.x, d.y) - slope * d.z) * (1.0f / n.z);
    };
    return {slope, by(right - left), by(upper - lower)};
}

SlopeBounds NormalPatch::bounds() const {
    const Vec2 first = slope_of(corner[0]);
    SlopeBounds bounds{first, first};
    for (size_t i = 1; i < 4; ++i) bounds.extend(slope_of(corner[i]));
    return bounds;
}

NormalPatch NormalPatch::quarter(int i) const {
    const Vec3 left = (corner[0] + corner[2]) * 0.5f, right = (corner[1] + corner[3]) * 0.5f,
               lower = (corner[0] + corner[1]) * 0.5f, upper = (corner[2] + corner[3]) * 0.5f,
               middle = (left + right) * 0.5f;
    switch (i) {
        case 0: return {{corner[0], lower, left, middle}};
        case 1: return {{lower, corner[1], middle, right}};
        case 2: return {{left, middle, corner[2], upper}};
        default: return {{middle, right, upper, corner[3]}};
    }
}

HeightPatch::Column::Column(const std::array<float, 4>& texels)
    : height(spline(texels)), slope(spline_derivative(texels)) {}

HeightPatch HeightPatch::of_columns(const Column& a, const Column& b, const Column& c,
                                    const Column& d) {
    HeightPatch patch;
    for (size_t j = 0; j < 4; ++j) {
        const std::array<float, 4> along = spline_derivative(
                                       {a.height[j], b.height[j], c.height[j], d.height[j]}),
                                   across = spline({a.slope[j], b.slope[j], c.slope[j], d.slope[j]});
        for (size_t i = 0; i < 4; ++i) patch.control[j][i] = {along[i], across[i]};
    }
    return patch;
}

SlopeJet HeightPatch::jet(float s, float t) const {
    const Bernstein along(s), across(t);
    Row value, by_s;
    for (size_t j = 0; j < 4; ++j) {
        value[j] = combined(control[j], along.b);
        by_s[j] = combined(control[j], along.d);
    }
    return {combined(value, across.b), combined(by_s, across.b), combined(value, across.d)};
}

SlopeBounds HeightPatch::bounds() const {
    SlopeBounds bounds{control[0][0], control[0][0]};
    for (const Row& row : control)
        for (const Vec2& slope : row) bounds.extend(slope);
    return bounds;
}

HeightPatch HeightPatch::quarter(int i) const {
    std::array<Row, 4> columns;  // of the half along s
    for (size_t j = 0; j < 4; ++j) {
        const Row row = halved(control[j], (i & 1) != 0);
        for (size_t k = 0; k < 4; ++k) columns[k][j] = row[k];
    }
    HeightPatch quarter;
    for (size_t k = 0; k < 4; ++k) {
        const Row column = halved(columns[k], (i >> 1) != 0);
        for (size_t j = 0; j < 4; ++j) quarter.control[j][k] = column[j];
    }
    return quarter;
}

}  // namespace spc
