// SPDX-License-Identifier: GPL-3.0-or-later
// Slopes on a rectangle within a cell of a map, between four texels: exact at every point, bounded,
// and quartered.
#pragma once

#include "glints/slope_pyramid.h"

#include <variant>

namespace spc {

// A slope and how it varies with the coordinates.
struct SlopeJet {
    Vec2 slope, by_s, by_t;
};

inline Vec2 slope_of(const Vec3& n) { return Vec2(n.x, n.y) * (1.0f / n.z); }

// Of a normal map: the normals at the corners, not normalised. In between they are bilinear, and the
// slope is a quotient, which lies in the hull of those at the corners.
struct NormalPatch {
    std::array<Vec3, 4> corner;  // lower left and right, upper left and right

    SlopeJet jet(float s, float t) const;  // s, t in [0, 1]
    SlopeBounds bounds() const;
    NormalPatch quarter(int i) const;  // in the order of the corners
};

// Of a height map that is filtered by cubic B-splines: its gradient, a bicubic Bezier patch. It lies
// in the hull of the patch's control points.
struct HeightPatch {
    // Bezier points, across, of what four texels one above the other give between the middle ones.
    struct Column {
        std::array<float, 4> height, slope;
        explicit Column(const std::array<float, 4>& texels);
    };
    using Row = std::array<Vec2, 4>;
    std::array<Row, 4> control;  // rows along s, from the lower one

    // The cell is between the middle ones.
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
