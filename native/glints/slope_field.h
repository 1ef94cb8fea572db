// SPDX-License-Identifier: GPL-3.0-or-later
// The slopes of a normal or height map: exact at every point, bounded and averaged over regions.
#pragma once

#include "core/image.h"
#include "glints/slope_patch.h"

namespace spc {

// Mean and covariance of slopes [Olano10].
struct SlopeMoments {
    Vec2 mean{0, 0};
    float aa = 0.0f, ab = 0.0f, bb = 0.0f;
};

// Sources of a field's slopes: the texels of an image that repeats.
struct NormalTexels {
    Image image;
    float strength;

    Vec3 normal(int x, int y) const;        // as map_normal() reads it, not normalised
    NormalPatch cell(int x, int y) const;   // the cell with the lower left texel (x, y)
    std::vector<Vec2> slopes(int y) const;  // slopes of a row of texels
    void bounds(int y, std::span<SlopeBounds> row) const;  // bounds of a row of cells
    // Bounds of all slopes. Empty if a normal points into the surface, or nearly so.
    std::optional<SlopeBounds> extent(uint32_t threads) const;
};
struct HeightTexels {
    Image image;

    float height(int x, int y) const;
    HeightPatch cell(int x, int y) const;
    std::vector<Vec2> slopes(int y) const;
    void bounds(int y, std::span<SlopeBounds> row) const;
    SlopeBounds extent(uint32_t threads) const;  // bounds of all slopes

private:
    // Heights of a row, with one texel more before it and two after it.
    std::vector<float> heights(int y) const;
};

// Slopes (a, b) of a map: its normal is W (a, b, 1) for columns W that depend on the surface
// (SlopeFrame). Coordinates are texels between their centres: (0, 0) is the centre of the first
// texel, (width, height) the same one repeat farther.
//
// In a normal map in tangent space the normal is interpolated between texels, and the slope is a
// quotient. In a height map the slope is the gradient of the luminance, per texel, filtered by
// cubic B-splines as the heights of a Bump node are.
class SlopeField {
public:
    // `threads` 0 = all. Empty where a normal of the map points into the surface, or nearly so.
    static std::optional<SlopeField> of_normals(const Image& image, float strength,
                                                uint32_t threads);
    static SlopeField of_heights(const Image& image, uint32_t threads);

    int width() const { return width_; }
    int height() const { return height_; }
    // Returns act(texels), where `texels` is of either kind.
    template <class Act>
    auto visit_texels(const Act& act) const {
        return std::visit(act, texels_);
    }
    // The slopes of one cell, which may lie in any repeat.
    SlopePatch cell(int x, int y) const {
        return visit_texels([&](const auto& texels) { return SlopePatch(texels.cell(x, y)); });
    }

    // Bounds of slopes over blocks of cells.
    const SlopePyramid& pyramid() const { return pyramid_; }
    // Moments over a rectangle, approximated by whole nodes that are smaller than it.
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

    template <class Texels>
    SlopeField(const Texels& texels, const SlopeBounds& extent, uint32_t threads);
    template <class Texels>
    void build_sums(const Texels& texels, uint32_t threads);

    std::variant<NormalTexels, HeightTexels> texels_;
    int width_, height_;
    SlopePyramid pyramid_;
    std::vector<SumLevel> sums_;  // from level kFirstSums on
};

}  // namespace spc
