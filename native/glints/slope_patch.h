// SPDX-License-Identifier: GPL-3.0-or-later
// Slopes on a rectangle within a cell of a map, between four texels. A patch can be evaluated at
// every point, bounded, and split into quarters.
#pragma once

#include "glints/slope_pyramid.h"

#include <variant>

namespace spc {

// A slope and its derivatives by the coordinates.
struct SlopeJet {
    Vec2 slope, by_s, by_t;
};

inline Vec2 slope_of(const Vec3& n) { return Vec2(n.x, n.y) * (1.0f / n.z); }

// A patch of a normal map: bilinear between the normals at the corners, which are not normalised.
// The slope is a quotient and lies in the hull of the corners' slopes.
struct NormalPatch {
    std::array<Vec3, 4> corner;  // lower left and right, upper left and right

    SlopeJet jet(float s, float t) const;  // s, t in [0, 1]
    SlopeBounds bounds() const;
    NormalPatch quarter(int i) const;  // in the order of the corners
};

// A patch of a height map that is filtered by cubic B-splines: its gradient as a bicubic Bezier
// patch, which lies in the hull of its control points.
struct HeightPatch {
    // Bezier points of height and slope between the middle two of four texels in a column.
    struct Column {
        std::array<float, 4> height, slope;
        explicit Column(const std::array<float, 4>& texels);
    };
    using Row = std::array<Vec2, 4>;
    std::array<Row, 4> control;  // rows along s, from the lower one

    // The patch between the middle two of four columns.
    static HeightPatch of_columns(const Column& a, const Column& b, const Column& c,
                                  const Column& d);

    SlopeJet jet(float s, float t) const;
    SlopeBounds bounds() const;
    HeightPatch quarter(int i) const;
};

using SlopePatch = std::variant<NormalPatch, HeightPatch>;

inline SlopeJet jet_at(const SlopePatch& patch, float s, float t) {
    return std::visit([&](const auto& p) { return p.jet(s, t); }, patch);
}
inline Vec2 slope_at(const SlopePatch& patch, float s, float t) {
    return jet_at(patch, s, t).slope;
}
inline SlopeBounds bounds_of(const SlopePatch& patch) {
    return std::visit([](const auto& p) { return p.bounds(); }, patch);
}

}  // namespace spc
