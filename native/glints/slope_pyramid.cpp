// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_pyramid.h"

#include "core/parallel.h"

namespace spc {

namespace {

constexpr float kSteps = 65535.0f;

}  // namespace

void SlopePyramid::Node::extend(const Node& other) {
    for (int i = 0; i < 2; ++i) {
        lower[i] = std::min(lower[i], other.lower[i]);
        upper[i] = std::max(upper[i], other.upper[i]);
    }
}

SlopePyramid::Node SlopePyramid::rounded(const SlopeBounds& bounds) const {
    Node node;
    for (int i = 0; i < 2; ++i) {
        const float down = std::floor((bounds.lower[i] - origin_[i]) / step_[i]),
                    up = std::ceil((bounds.upper[i] - origin_[i]) / step_[i]);
        node.lower[i] = static_cast<uint16_t>(std::clamp(down, 0.0f, kSteps));
        node.upper[i] = static_cast<uint16_t>(std::clamp(up, 0.0f, kSteps));
    }
    return node;
}

// The grid is a little wider than needed: rounding must not push the last step beyond the end.
SlopePyramid::SlopePyramid(int width, int height, const SlopeBounds& all, const LeafRow& leaves,
                           uint32_t threads)
    : origin_(all.lower),
      step_((all.upper - all.lower) * (1.0001f / kSteps) + Vec2(1e-12f, 1e-12f)) {
    // row_below(y, act) calls act(x, node) along a row of the level below.
    const auto add_level = [&](int below_width, int below_height, const auto& row_below) {
        Level level{(below_width + 1) / 2, (below_height + 1) / 2, {}};
        const auto w = static_cast<size_t>(level.width), h = static_cast<size_t>(level.height);
        level.nodes.resize(w * h, Node{{UINT16_MAX, UINT16_MAX}, {0, 0}});
        parallel_for(threads, static_cast<uint32_t>(h), [&](uint32_t row) {
            Node* nodes = level.nodes.data() + row * w;
            const int y = 2 * static_cast<int>(row);
            const auto extend = [&](int x, const Node& node) { nodes[x / 2].extend(node); };
            row_below(y, extend);
            if (y + 1 < below_height) row_below(y + 1, extend);
        });
        levels_.push_back(std::move(level));
    };
    add_level(width, height, [&](int y, const auto& act) {
        std::vector<SlopeBounds> row(static_cast<size_t>(width));
        leaves(y, row);
        for (int x = 0; x < width; ++x) act(x, rounded(row[static_cast<size_t>(x)]));
    });
    while (levels_.back().nodes.size() > 1) {
        const Level& below = levels_.back();
        add_level(below.width, below.height, [&](int y, const auto& act) {
            for (int x = 0; x < below.width; ++x) act(x, below.at(x, y));
        });
    }
}

SlopeBounds SlopePyramid::bounds(int level, int x, int y) const {
    const Node& node = levels_[static_cast<size_t>(level - 1)].at(x, y);
    const auto value = [&](const uint16_t(&q)[2]) {
        return origin_ +
               Vec2(step_.x * static_cast<float>(q[0]), step_.y * static_cast<float>(q[1]));
    };
    return {value(node.lower), value(node.upper)};
}

size_t SlopePyramid::memory_bytes() const {
    size_t bytes = 0;
    for (const Level& level : levels_) bytes += level.nodes.size() * sizeof(Node);
    return bytes;
}

}  // namespace spc
