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
            return 0.35875 - 0.48829 * std::cos(v) + 0.14128 * std::cos(2.0 * v) - 0.01168 * std::cos(3.0 * v);
        }
    }
    return 0.0;
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind, float width) {
    constexpr int kFine = 8192, kCoarse = 1024;
    const double reach = kind == FilterKind::box ? 0.5 : kind == FilterKind::gaussian ? 1.5 * width : 1.0 * width;
    std::vector<double> cumulative(kFine + 1, 0.0);
    const double step = 2.0 * reach / kFine;
    for (int i = 0; i < kFine; ++i)
        cumulative[static_cast<size_t>(i) + 1] =
            cumulative[static_cast<size_t>(i)] + density(kind, -reach + (i + 0.5) * step, width);
    size_t cell = 0;
    for (int i = 0; i <= kCoarse; ++i) {
        const double target = cumulative.back() * i / kCoarse;
        while (cell + 1 < kFine && cumulative[cell + 1] < target) ++cell;
        const double inside = cumulative[cell + 1] - cumulative[cell];
        const double t = inside > 0.0 ? std::clamp((target - cumulative[cell]) / inside, 0.0, 1.0) : 0.0;
        inverse_.push_back(static_cast<float>(-reach + (static_cast<double>(cell) + t) * step));
    }
}

float PixelFilter::invert(float u) const {
    const float at = u * static_cast<float>(inverse_.size() - 1);
    const auto i = std::min(static_cast<size_t>(at), inverse_.size() - 2);
    return lerp(inverse_[i], inverse_[i + 1], at - static_cast<float>(i));
}

}  // namespace spc
