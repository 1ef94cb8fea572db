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
    radius_ = kind == FilterKind::box ? 0.5 : kind == FilterKind::gaussian ? 1.5 * w : w;
    cumulative_.assign(1, 0.0);
    for (int i = 0; i < kCells; ++i)
        cumulative_.push_back(cumulative_.back() +
                              density(kind, radius_ * ((2 * i + 1.0) / kCells - 1.0), w));
    const double total = cumulative_.back();
    for (double& c : cumulative_) c /= total;
    const double cells_per_pixel = kCells / (2.0 * radius_);
    cells_per_pixel_ = static_cast<float>(cells_per_pixel);
    double variance = 0.0;
    for (size_t i = 0; i < kCells; ++i) {
        const double mass = cumulative_[i + 1] - cumulative_[i];
        const double at = (static_cast<double>(i) + 0.5) / cells_per_pixel - radius_;
        density_.push_back(static_cast<float>(mass * cells_per_pixel));
        variance += mass * at * at;
    }
    variance_ = static_cast<float>(variance);
    for (size_t k = 0, cell = 0; k < kCells; ++k) {
        while (cumulative_[cell + 1] <= static_cast<double>(k) / kCells) ++cell;
        first_cell_.push_back(static_cast<uint16_t>(cell));
    }
}

// By search instead of a table of the inverse: that would be coarse in the tails, where it is
// steep. A table says where the search begins, a cell or two before its end but in the tails.
float PixelFilter::invert(float u) const {
    const auto wanted = static_cast<double>(u);
    size_t cell = first_cell_[static_cast<size_t>(u * static_cast<float>(first_cell_.size()))];
    while (cell + 1 < density_.size() && cumulative_[cell + 1] <= wanted) ++cell;
    const double from = cumulative_[cell], to = cumulative_[cell + 1];
    const double at = static_cast<double>(cell) + (wanted - from) / (to - from);
    return static_cast<float>(radius_ * (2.0 * at / static_cast<double>(density_.size()) - 1.0));
}

}  // namespace spc
