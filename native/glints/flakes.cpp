// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/flakes.h"

#include "core/parallel.h"

namespace spc {

namespace {

constexpr float kSteps = 32767.0f;

float most(const Vec2& d) { return std::max(std::abs(d.x), std::abs(d.y)); }

}  // namespace

FlakeField::FlakeField(const SlopeField& field, uint32_t threads, const Budget& budget)
    : width_(field.width()),
      height_(field.height()),
      flakes_(static_cast<size_t>(width_) * static_cast<size_t>(height_)) {
    const auto for_each = [&](const auto& act) {
        parallel_for(threads, static_cast<uint32_t>(height_), [&](uint32_t row) {
            if (budget.is_cancelled()) return;
            const int y = static_cast<int>(row);
            for (int x = 0; x < width_; ++x) act(x, y, jet_at(field.cell(x, y), 0.5f, 0.5f));
        });
    };
    std::vector<float> steepest(static_cast<size_t>(height_), 0.0f);
    for_each([&](int, int y, const SlopeJet& jet) {
        float& row = steepest[static_cast<size_t>(y)];
        row = std::max({row, most(jet.by_s), most(jet.by_t)});
    });
    const float all = *std::max_element(steepest.begin(), steepest.end());
    if (all > 0.0f) step_ = all / kSteps;
    const auto steps = [&](float d) { return static_cast<int16_t>(std::lround(d / step_)); };
    for_each([&](int x, int y, const SlopeJet& jet) {
        flakes_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)] = {
            jet.slope,
            {steps(jet.by_s.x), steps(jet.by_s.y)},
            {steps(jet.by_t.x), steps(jet.by_t.y)}};
    });
    SlopeBounds whole = bounds(0, 0);
    for (int y = 0; y < height_ && !budget.is_cancelled(); ++y)
        for (int x = 0; x < width_; ++x) whole.extend(bounds(x, y));
    pyramid_ = SlopePyramid(
        width_, height_, whole,
        [&](int y, std::span<SlopeBounds> row) {
            if (budget.is_cancelled()) return;
            for (int x = 0; x < width_; ++x) row[static_cast<size_t>(x)] = bounds(x, y);
        },
        threads);
}

SlopeJet FlakeField::flake(int x, int y) const {
    const Flake& f =
        flakes_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
    const auto value = [&](const int16_t(&d)[2]) {
        return Vec2(static_cast<float>(d[0]), static_cast<float>(d[1])) * step_;
    };
    return {f.slope, value(f.by_s), value(f.by_t)};
}

SlopeBounds FlakeField::bounds(int x, int y) const {
    const SlopeJet f = flake(x, y);
    constexpr float kRadius = kGaussianRadius * kFlakeSigma;
    const Vec2 extent =
        Vec2(std::hypot(f.by_s.x, f.by_t.x), std::hypot(f.by_s.y, f.by_t.y)) * kRadius;
    return {f.slope - extent, f.slope + extent};
}

size_t FlakeField::memory_bytes() const {
    return flakes_.size() * sizeof(Flake) + pyramid_.memory_bytes();
}

}  // namespace spc
