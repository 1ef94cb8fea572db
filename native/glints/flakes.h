// SPDX-License-Identifier: GPL-3.0-or-later
// A map as a distribution of positions and slopes made of Gaussians [Yan16]: one flake for
// each cell between four texels, on which the slope is linear, with a weight around its middle.
#pragma once

#include "glints/slope_field.h"

namespace spc {

// Standard deviation of the weight, texels: that of a cell. Flakes of [Yan16], 0.42 wide, overlap
// more, which makes slopes between texels vary too much: waves of 5 texels came out 10 % too dark
// around their mean slope, and 0.2 % with these.
inline constexpr float kFlakeSigma = 0.288675f;
// Beyond so many standard deviations a Gaussian is taken for zero; its mass there is exp(-6.1).
inline constexpr float kGaussianRadius = 3.5f;

class FlakeField {
public:
    // `threads` 0 = all. The field need not outlive it.
    FlakeField(const SlopeField& field, uint32_t threads);

    int width() const { return width_; }
    int height() const { return height_; }
    // 0 <= x < width, 0 <= y < height; its middle is at (x + 0.5, y + 0.5).
    SlopeJet flake(int x, int y) const;
    // Of the flakes, as far as they reach.
    const SlopePyramid& pyramid() const { return pyramid_; }

    size_t memory_bytes() const;

private:
    // Derivatives in steps that all flakes share.
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
