// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/filter.h"

namespace spc {

namespace {

double density(FilterKind kind, double x, double width) {
    switch (kind) {
        case FilterKind::box: return std::abs(x) <= 0.5 ? 1.0 : 0.0;
        case FilterKind::gaussian: return std::exp(-8.0 * x * x / (width * width));
        case FilterKind::blackman_harris: {
            const double v = 2.0 * std::numbers::pi * (x / (2.0 * width) + 0.5);
            return 0.35875 - 0.48829 * std::cos(v) + 0.14128 * std::cos(2.0 * v) -
                   0.01168 * std::cos(3.0 * v);
        }
    }
    return 0.0;
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind, float width) {
    constexpr int kCells = 1024;
    const double w = static_cast<double>(width);
    reach_ = kind == FilterKind::box ? 0.5 : kind == FilterKind::gaussian ? 1.5 * w : w;
    cumulative_.assign(1, 0.0);
    for (int i = 0; i < kCells; ++i)
        cumulative_.push_back(cumulative_.back() +
                              density(kind, reach_ * ((2 * i + 1.0) / kCells - 1.0), w));
    for (double& c : cumulative_) c /= cumulative_.back();
}

float PixelFilter::weight(float offset) const {
    const auto cells = static_cast<double>(cumulative_.size() - 1);
    const double at = 0.5 * (static_cast<double>(offset) / reach_ + 1.0) * cells;
    if (!(at >= 0.0 && at < cells)) return 0.0f;
    const auto cell = static_cast<size_t>(at);
    return static_cast<float>((cumulative_[cell + 1] - cumulative_[cell]) * cells / (2.0 * reach_));
}

// By search instead of a table of the inverse: that would be coarse in the tails, where it is
// steep.
float PixelFilter::invert(float u) const {
    const auto above =
        std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, static_cast<double>(u));
    const double from = *(above - 1), to = *above;
    const double cell = static_cast<double>(above - 1 - cumulative_.begin()) +
                        (static_cast<double>(u) - from) / (to - from);
    return static_cast<float>(reach_ *
                              (2.0 * cell / static_cast<double>(cumulative_.size() - 1) - 1.0));
}

}  // namespace spc
