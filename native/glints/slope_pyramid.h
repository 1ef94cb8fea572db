// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of slopes over the nodes of a pyramid.
#pragma once

#include "math/vec.h"

#include <functional>
#include <span>
#include <vector>

namespace spc {

struct SlopeBounds {
    Vec2 lower, upper;
    void extend(const Vec2& slope) {
        lower = {std::min(lower.x, slope.x), std::min(lower.y, slope.y)};
        upper = {std::max(upper.x, slope.x), std::max(upper.y, slope.y)};
    }
    void extend(const SlopeBounds& other) {
        extend(other.lower);
        extend(other.upper);
    }
};

// A node of level l > 0 covers 2^l x 2^l leaves, fewer at the upper ends. The leaves, level 0, are
// not stored.
class SlopePyramid {
public:
    SlopePyramid() = default;
    // Writes the bounds of the leaves (0, y) to (width - 1, y).
    using LeafRow = std::function<void(int y, std::span<SlopeBounds> row)>;
    // `all` bounds the slopes of all width x height leaves. `leaves` is called for each row, on
    // `threads` threads; 0 = all.
    SlopePyramid(int width, int height, const SlopeBounds& all, const LeafRow& leaves,
                 uint32_t threads);

    int levels() const { return static_cast<int>(levels_.size()) + 1; }
    SlopeBounds bounds(int level, int x, int y) const;  // level > 0
    size_t memory_bytes() const;

private:
    // In steps of a common grid, rounded outwards.
    struct Node {
        uint16_t lower[2], upper[2];
        void extend(const Node& other);
    };
    struct Level {
        int width, height;
        std::vector<Node> nodes;
        const Node& at(int x, int y) const {
            return nodes[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
        }
    };
    Node rounded(const SlopeBounds& bounds) const;

    Vec2 origin_{0, 0}, step_{1, 1};  // of the grid
    std::vector<Level> levels_;
};

}  // namespace spc
