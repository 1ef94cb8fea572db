// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/quadtree.h"

#include <algorithm>

namespace spc {

namespace {

// A cell is split while it holds more than this share of the weight, and points enough to tell how
// the weight lies in it.
constexpr double kLeastShare = 1.0 / 1024;
constexpr size_t kLeastPoints = 32;
constexpr float kLeastSize = 0x1p-17f;  // coordinates have 2^-24

double total(std::span<const WeightedPoint> points) {
    double sum = 0.0;
    for (const WeightedPoint& point : points) sum += static_cast<double>(point.weight);
    return sum;
}

float share(double part, double whole) {
    return whole > 0.0 ? static_cast<float>(part / whole) : 0.5f;
}

// Takes u to one of two halves, `first` of which go to the lower one; u is stretched to [0, 1).
bool choose_upper(float& u, float first) {
    constexpr float kLargest = 1.0f - 0x1p-24f;
    const bool upper = u >= first;
    u = upper ? (u - first) / (1.0f - first) : u / first;
    u = std::min(u, kLargest);
    return upper;
}

}  // namespace

// Over that of the whole cell.
float QuadtreeDensity::density_in_quarter(const Node& node, bool right, bool above) {
    const float column = right ? 1.0f - node.left : node.left;
    const float below = node.below[right ? 1 : 0];
    return 4.0f * column * (above ? 1.0f - below : below);
}

QuadtreeDensity::QuadtreeDensity(std::span<WeightedPoint> points, float floor, float finest) {
    const double sum = total(points);
    if (!(sum > 0.0)) return;
    floor_ = floor;
    refine(0, points, Vec2(0.0f), 1.0f, {kLeastShare * sum, std::max(2.0f * finest, kLeastSize)});
}

void QuadtreeDensity::refine(uint32_t node, std::span<WeightedPoint> points, const Vec2& corner,
                             float size, const Limits& limits) {
    const double weight = total(points);
    if (points.size() < kLeastPoints || weight <= limits.weight || size < limits.size) return;
    const float half = 0.5f * size;
    const Vec2 middle = corner + Vec2(half, half);
    const auto split = [](std::span<WeightedPoint> part, auto is_lower) {
        const auto at = std::partition(part.begin(), part.end(), is_lower);
        return static_cast<size_t>(at - part.begin());
    };
    const size_t left = split(points, [&](const WeightedPoint& q) { return q.p.x < middle.x; });
    const std::array<std::span<WeightedPoint>, 2> columns{points.first(left), points.subspan(left)};
    std::array<std::span<WeightedPoint>, 4> quarters;
    const auto first_child = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 4);
    nodes_[node].children = first_child;
    nodes_[node].left = share(total(columns[0]), weight);
    for (size_t i = 0; i < 2; ++i) {
        const std::span<WeightedPoint> column = columns[i];
        const size_t low = split(column, [&](const WeightedPoint& q) { return q.p.y < middle.y; });
        quarters[i] = column.first(low);
        quarters[2 + i] = column.subspan(low);
        nodes_[node].below[i] = share(total(quarters[i]), total(column));
    }
    for (uint32_t k = 0; k < 4; ++k) {
        const Vec2 at((k & 1) != 0 ? middle.x : corner.x, (k & 2) != 0 ? middle.y : corner.y);
        refine(first_child + k, quarters[k], at, half, limits);
    }
}

QuadtreeDensity::Sample QuadtreeDensity::sample(Vec2 u) const {
    if (!choose_upper(u.x, floor_)) return {u, pdf(u)};
    Vec2 corner(0.0f);
    float size = 1.0f, density = 1.0f;
    for (uint32_t node = 0; nodes_[node].children != 0;) {
        const bool right = choose_upper(u.x, nodes_[node].left);
        const bool above = choose_upper(u.y, nodes_[node].below[right ? 1 : 0]);
        density *= density_in_quarter(nodes_[node], right, above);
        size *= 0.5f;
        corner += Vec2(right ? size : 0.0f, above ? size : 0.0f);
        node = nodes_[node].children + (right ? 1 : 0) + (above ? 2 : 0);
    }
    return {corner + u * size, floor_ + (1.0f - floor_) * density};
}

float QuadtreeDensity::pdf(Vec2 p) const { return floor_ + (1.0f - floor_) * tree_pdf(p); }

float QuadtreeDensity::tree_pdf(Vec2 p) const {
    float density = 1.0f;
    for (uint32_t node = 0; nodes_[node].children != 0;) {
        p *= 2.0f;
        const bool right = p.x >= 1.0f, above = p.y >= 1.0f;
        p -= Vec2(right ? 1.0f : 0.0f, above ? 1.0f : 0.0f);
        density *= density_in_quarter(nodes_[node], right, above);
        node = nodes_[node].children + (right ? 1 : 0) + (above ? 2 : 0);
    }
    return density;
}

}  // namespace spc
