// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distribution.h"

#include "core/error.h"

namespace spc {
namespace {

// The largest float below 1.
constexpr float kBelowOne = 0x1.fffffep-1f;
// Least share of an entry that is not zero: two steps of the table's precision just below 1. So
// every such entry can be drawn with up to 4 million of them, and rarer ones are drawn too often,
// which their probability says.
constexpr double kLeastShare = 0x1p-23;
// A position keeps this distance from its cell's edges, in cells per cell of the row, so that
// rounding cannot move it into the next cell.
constexpr float kEdge = 2.5e-7f;

float position_in_cell(uint32_t cell, float offset, uint32_t count) {
    const float edge = kEdge * static_cast<float>(count);
    const float inside = std::min(std::max(offset, edge), 1.0f - edge);
    return std::min((static_cast<float>(cell) + inside) / static_cast<float>(count), kBelowOne);
}

uint32_t cell_of(float position, uint32_t count) {
    const float scaled = std::max(position, 0.0f) * static_cast<float>(count);
    return std::min(static_cast<uint32_t>(scaled), count - 1);
}

}  // namespace

DiscreteDistribution::DiscreteDistribution(std::span<const float> weights) {
    double sum = 0.0;
    for (const float weight : weights) {
        SPC_ASSERT(weight >= 0.0f && std::isfinite(weight));
        sum += weight;
    }
    total_ = sum;
    if (!(sum > 0.0)) return;

    const double least = kLeastShare * sum;
    const auto lifted = [&](float weight) {
        return weight > 0.0f ? std::max<double>(weight, least) : 0.0;
    };
    double lifted_sum = 0.0;
    size_t last = 0;  // entry that is not zero
    for (size_t i = 0; i < weights.size(); ++i) {
        lifted_sum += lifted(weights[i]);
        if (weights[i] > 0.0f) last = i;
    }
    cumulative_.resize(weights.size() + 1);
    double running = 0.0;
    for (size_t i = 0; i < weights.size(); ++i) {
        cumulative_[i] = static_cast<float>(std::min(running / lifted_sum, 1.0));
        running += lifted(weights[i]);
    }
    std::fill(cumulative_.begin() + static_cast<std::ptrdiff_t>(last) + 1, cumulative_.end(), 1.0f);
}

float DiscreteDistribution::probability(size_t i) const {
    return cumulative_[i + 1] - cumulative_[i];
}

DiscreteDistribution::Sample DiscreteDistribution::sample(float u) const {
    SPC_ASSERT(!empty());
    // Bisection for the last value <= u; entries of no width are never that.
    size_t low = 0, length = cumulative_.size() - 1;
    while (length > 1) {
        const size_t half = length / 2;
        low = cumulative_[low + half] <= u ? low + half : low;
        length -= half;
    }
    const float probability = cumulative_[low + 1] - cumulative_[low];
    return {static_cast<uint32_t>(low), probability,
            std::min((u - cumulative_[low]) / probability, kBelowOne)};
}

Distribution2D::Distribution2D(std::span<const float> values, uint32_t width, uint32_t height)
    : width_(width), height_(height) {
    SPC_ASSERT(values.size() == static_cast<size_t>(width) * height);
    std::vector<float> row_means(height);
    rows_.reserve(height);
    for (uint32_t y = 0; y < height; ++y) {
        rows_.emplace_back(values.subspan(static_cast<size_t>(y) * width, width));
        row_means[y] = static_cast<float>(rows_[y].total() / width);
    }
    marginal_ = DiscreteDistribution(row_means);
    mean_ = marginal_.total() / height;
    if (marginal_.empty()) rows_.clear();
}

Distribution2D::Sample Distribution2D::sample(const Vec2& u) const {
    const DiscreteDistribution::Sample y = marginal_.sample(u.y);
    const DiscreteDistribution::Sample x = rows_[y.index].sample(u.x);
    const float cells = static_cast<float>(width_) * static_cast<float>(height_);
    return {{position_in_cell(x.index, x.remapped, width_),
             position_in_cell(y.index, y.remapped, height_)},
            x.probability * y.probability * cells};
}

float Distribution2D::pdf(const Vec2& position) const {
    const uint32_t y = cell_of(position.y, height_);
    if (rows_[y].empty()) return 0.0f;
    const float cells = static_cast<float>(width_) * static_cast<float>(height_);
    return rows_[y].probability(cell_of(position.x, width_)) * marginal_.probability(y) * cells;
}

}  // namespace spc
