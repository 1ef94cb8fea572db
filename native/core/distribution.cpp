// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distribution.h"

#include "core/error.h"

namespace spc {
namespace {

// Least share of an entry that is not zero: two steps of the table's precision just below 1. So
// every such entry can be drawn with up to 4 million of them, and rarer ones are drawn too often,
// which their probability says.
constexpr double kLeastShare = 0x1p-23;
// A position keeps this distance from its cell's edges, in cells per cell of the row, so that
// rounding cannot move it into the next cell.
constexpr float kEdge = 2.5e-7f;

float inside_cell(float offset, uint32_t count) {
    const float edge = kEdge * static_cast<float>(count);
    return std::min(std::max(offset, edge), 1.0f - edge);
}

// Inverse of the cumulative of a density that is linear from `a` to `b` over [0, 1).
float sample_linear(float u, float a, float b) {
    const float sum = a + b;
    if (!(sum > 0.0f) || !(u > 0.0f)) return u;
    const float start = a / sum, end = b / sum;
    return u / (start + std::sqrt(lerp(start * start, end * end, u)));
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

BilinearMap::BilinearMap(std::vector<float> values, uint32_t width, uint32_t height)
    : width_(width), height_(height), values_(std::move(values)) {
    SPC_ASSERT(values_.size() == static_cast<size_t>(width) * height);
}

BilinearMap::Cells BilinearMap::cells(const Keep& keep) const {
    Cells result;
    std::vector<float> means(width_), row_means(height_ + 1);
    result.rows.reserve(height_ + 1);
    for (uint32_t y = 0; y <= height_; ++y) {
        const auto kept = [&](uint32_t x) {
            return (y > 0 && keep(x, y - 1)) || (y < height_ && keep(x, y));
        };
        for (uint32_t x = 0; x < width_; ++x)
            means[x] = kept(x) || kept((x + 1) % width_) ? corners(x, y).mean() : 0.0f;
        result.rows.emplace_back(means);
        row_means[y] = static_cast<float>(result.rows[y].total() / width_) * row_extent(y);
    }
    result.marginal = DiscreteDistribution(row_means);
    result.mean = result.marginal.total();
    return result;
}

BilinearMap::Corners BilinearMap::corners(uint32_t x, uint32_t y) const {
    const uint32_t next = x + 1 < width_ ? x + 1 : 0;
    const auto row = [&](uint32_t of) { return values_.data() + static_cast<size_t>(of) * width_; };
    Corners c{};
    if (y > 0) c.v00 = row(y - 1)[x], c.v10 = row(y - 1)[next];
    if (y < height_) c.v01 = row(y)[x], c.v11 = row(y)[next];
    return c;
}

float BilinearMap::row_start(uint32_t y) const {
    return y > 0 ? (static_cast<float>(y) - 0.5f) / static_cast<float>(height_) : 0.0f;
}

float BilinearMap::row_extent(uint32_t y) const {
    return (y > 0 && y < height_ ? 1.0f : 0.5f) / static_cast<float>(height_);
}

BilinearMap::Sample BilinearMap::sample(const Cells& cells, const Vec2& u) const {
    const DiscreteDistribution::Sample y = cells.marginal.sample(u.y);
    const DiscreteDistribution::Sample x = cells.rows[y.index].sample(u.x);
    const Corners c = corners(x.index, y.index);
    const float up = inside_cell(sample_linear(y.remapped, c.v00 + c.v10, c.v01 + c.v11), height_);
    const float right = inside_cell(
        sample_linear(x.remapped, lerp(c.v00, c.v01, up), lerp(c.v10, c.v11, up)), width_);
    const float across = (static_cast<float>(x.index) + 0.5f + right) / static_cast<float>(width_);
    const Vec2 position(std::min(across < 1.0f ? across : across - 1.0f, kBelowOne),
                        std::min(row_start(y.index) + row_extent(y.index) * up, kBelowOne));
    return {position, pdf(cells, position)};
}

float BilinearMap::pdf(const Cells& cells, const Vec2& position) const {
    const float columns = static_cast<float>(width_);
    const float shifted = position.x * columns - 0.5f;
    const float across = shifted < 0.0f ? shifted + columns : shifted;
    const uint32_t x = std::min(static_cast<uint32_t>(across), width_ - 1);
    const float rows = std::max(position.y, 0.0f) * static_cast<float>(height_) + 0.5f;
    const uint32_t y = std::min(static_cast<uint32_t>(rows), height_);
    if (cells.rows[y].empty()) return 0.0f;
    const Corners c = corners(x, y);
    const float mean = c.mean();
    if (!(mean > 0.0f)) return 0.0f;
    const float right = std::min(across - static_cast<float>(x), 1.0f);
    const float up = std::min((position.y - row_start(y)) / row_extent(y), 1.0f);
    const float value = lerp(lerp(c.v00, c.v10, right), lerp(c.v01, c.v11, right), up);
    return cells.rows[y].probability(x) * cells.marginal.probability(y) * columns / row_extent(y) *
           (value / mean);
}

}  // namespace spc
