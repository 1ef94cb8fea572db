// SPDX-License-Identifier: GPL-3.0-or-later
// A map as a sum of Gaussians over positions and slopes [Yan16]: one flake for each cell between
// four texels. The slope is linear on a flake, whose weight is a Gaussian around the cell's middle.
#pragma once

#include "core/budget.h"
#include "glints/slope_field.h"

namespace spc {

// Standard deviation of a flake's weight, texels: that of a uniform cell. The flakes of [Yan16],
// 0.42 wide, overlap more, which spreads the slopes: waves of 5 texels came out 10 % too dark
// around their mean slope, and 0.2 % with these.
inline constexpr float kFlakeSigma = 0.288675f;
// A Gaussian is taken for zero beyond so many standard deviations; its mass there is exp(-6.1).
inline constexpr float kGaussianRadius = 3.5f;

class FlakeField {
public:
    // `threads` 0 = all. The slope field need not outlive the flakes, which are of no use once the
    // budget is cancelled.
    FlakeField(const SlopeField& field, uint32_t threads, const Budget& budget = {});

    int width() const { return width_; }
    int height() const { return height_; }
    // The flake with its middle at (x + 0.5, y + 0.5), for 0 <= x < width, 0 <= y < height.
    SlopeJet flake(int x, int y) const;
    // Bounds of the slopes of flakes within kGaussianRadius.
    const SlopePyramid& pyramid() const { return pyramid_; }

    size_t memory_bytes() const;

private:
    // Derivatives are stored in steps of step_.
    struct Flake {
        Vec2 slope;
        int16_t by_s[2], by_t[2];
    };
    SlopeBounds bounds(int x, int y) const;

    int width_, height_;
    float step_ = 1.0f;
    std::vector<Flake> flakes_;
    SlopePyramid pyramid_;
};

using FlakeSet = std::vector<FlakeField>;  // one for each field of a GlintSet

}  // namespace spc
