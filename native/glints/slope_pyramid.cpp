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

// A little wider than needed: rounding must not push the last step beyond the end.
SlopePyramid::SlopePyramid(int width, int height, const SlopeBounds& all,
                           const std::function<SlopeBounds(int x, int y)>& leaf)
    : origin_(all.lower),
      step_((all.upper - all.lower) * (1.0001f / kSteps) + Vec2(1e-12f, 1e-12f)) {
    int w = width, h = height;
    while (w > 1 || h > 1 || levels_.empty()) {
        const int below_w = w, below_h = h;
        w = (w + 1) / 2;
        h = (h + 1) / 2;
        Level level{w, h, std::vector<Node>(static_cast<size_t>(w) * static_cast<size_t>(h))};
        parallel_for(0, static_cast<uint32_t>(h), [&](uint32_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < w; ++x) {
                Node node{{UINT16_MAX, UINT16_MAX}, {0, 0}};
                for (int k = 0; k < 4; ++k) {
                    const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
                    if (cx >= below_w || cy >= below_h) continue;
                    node.extend(levels_.empty() ? rounded(leaf(cx, cy)) : levels_.back().at(cx, cy));
                }
                level.nodes[static_cast<size_t>(row) * static_cast<size_t>(w) +
                            static_cast<size_t>(x)] = node;
            }
        });
        levels_.push_back(std::move(level));
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
