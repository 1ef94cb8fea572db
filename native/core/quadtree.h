// SPDX-License-Identifier: GPL-3.0-or-later
// A density over the unit square, constant in the leaves of a quadtree that is finer where there is
// more of it, as the directions of [Mueller17].
#pragma once

#include "math/vec.h"

#include <span>
#include <vector>

namespace spc {

struct WeightedPoint {
    Vec2 p;        // in [0, 1)^2
    float weight;  // >= 0
};

class QuadtreeDensity {
public:
    QuadtreeDensity() = default;  // uniform
    // Follows the weight of the points, which it reorders, in leaves of a side of `finest` or more;
    // `floor` of all samples is uniform over the square.
    QuadtreeDensity(std::span<WeightedPoint> points, float floor, float finest = 0.0f);

    struct Sample {
        Vec2 p;
        float pdf;  // by area of the unit square, > 0
    };
    Sample sample(Vec2 u) const;
    float pdf(Vec2 p) const;

private:
    struct Node {
        uint32_t children = 0;         // index of the first of four, x fastest; 0: a leaf
        float left = 0.0f;             // share of the left half
        std::array<float, 2> below{};  // of the lower quarter within the left and the right half
    };
    struct Limits {  // below which a cell is not split
        double weight;
        float size;
    };
    void refine(uint32_t node, std::span<WeightedPoint> points, const Vec2& corner, float size,
                const Limits& limits);
    float tree_pdf(Vec2 p) const;
    static float density_in_quarter(const Node& node, bool right, bool above);

    std::vector<Node> nodes_{Node{}};
    float floor_ = 1.0f;
};

}  // namespace spc
