// SPDX-License-Identifier: GPL-3.0-or-later
// The slopes of a normal map: exact at every point, bounded and averaged over regions.
#pragma once

#include "core/image.h"
#include "glints/slope_pyramid.h"

namespace spc {

// Mean and covariance of slopes [Olano10].
struct SlopeMoments {
    Vec2 mean{0, 0};
    float aa = 0.0f, ab = 0.0f, bb = 0.0f;
};

// A slope and how it varies with the coordinates.
struct SlopeJet {
    Vec2 slope, by_s, by_t;
};

// The normals at the corners of a rectangle within a cell, not normalised: strength times red and
// green, and blue. Bilinear in between.
struct SlopePatch {
    std::array<Vec3, 4> corner;  // lower left and right, upper left and right

    Vec2 slope(float s, float t) const { return jet(s, t).slope; }  // s, t in [0, 1]
    SlopeJet jet(float s, float t) const;
    SlopeBounds bounds() const;
    SlopePatch quarter(int i) const;  // in the order of the corners
};
inline Vec2 slope_of(const Vec3& n) { return Vec2(n.x, n.y) * (1.0f / n.z); }

// Slopes (a, b) of a tangent-space normal map: its normal is T a + B b + N. Coordinates are texels
// between their centres: (0, 0) is the centre of the first texel, (width, height) the same one tile
// farther. Between texels red, green and blue are interpolated and the slope is a quotient: over
// any rectangle within a cell it lies in the hull of the slopes at its corners.
class SlopeField {
public:
    // Of image(texel) as map_normal() reads it. The image must outlive the field. Empty where a
    // normal of the map points into the surface, or nearly so.
    static std::optional<SlopeField> build(const Image& image, float strength);

    int width() const { return width_; }
    int height() const { return height_; }
    // Of one cell, 0 <= x < width, 0 <= y < height; the last ones reach into the next tile.
    SlopePatch cell(int x, int y) const;
    // Wherever it is: maps repeat.
    SlopePatch cell_in_any_tile(int x, int y) const;

    // Of the cells.
    const SlopePyramid& pyramid() const { return pyramid_; }
    // Of a rectangle, in the same coordinates; from whole nodes of a size below its own.
    SlopeMoments moments(const Vec2& lower, const Vec2& upper) const;

    size_t memory_bytes() const;

private:
    // Sums over texels.
    struct Sums {
        float a, b, aa, ab, bb, count;
        void add(const Sums& other) {
            a += other.a;
            b += other.b;
            aa += other.aa;
            ab += other.ab;
            bb += other.bb;
            count += other.count;
        }
    };
    struct SumLevel {
        int width, height;
        std::vector<Sums> nodes;
    };

    Vec3 texel(int x, int y) const;  // wraps one tile
    void build_sums();

    const Image* image_ = nullptr;
    float strength_ = 1.0f;
    int width_ = 0, height_ = 0;
    SlopePyramid pyramid_;
    std::vector<SumLevel> sums_;  // from level kFirstSums on
};

}  // namespace spc
