// SPDX-License-Identifier: GPL-3.0-or-later
// Tabulated densities: discrete ones by a cumulative table with bisection (monotone in u, so that
// stratified samples stay stratified, as the alias method would not leave them), and piecewise
// constant ones in two dimensions.
#pragma once

#include "math/vec.h"

#include <span>
#include <vector>

namespace spc {

class DiscreteDistribution {
public:
    DiscreteDistribution() = default;
    // Weights finite and >= 0. All zero gives an empty distribution.
    explicit DiscreteDistribution(std::span<const float> weights);

    bool empty() const { return cumulative_.empty(); }
    size_t size() const { return cumulative_.empty() ? 0 : cumulative_.size() - 1; }
    float probability(size_t i) const;
    double total() const { return total_; }

    struct Sample {
        uint32_t index;
        float probability;
        float remapped;  // u, rescaled to [0, 1) within the chosen entry
    };
    Sample sample(float u) const;

private:
    std::vector<float> cumulative_;  // size + 1 values from 0 to 1
    double total_ = 0.0;
};

// Piecewise constant density over [0, 1)^2, values[y * width + x].
class Distribution2D {
public:
    Distribution2D() = default;
    Distribution2D(std::span<const float> values, uint32_t width, uint32_t height);

    bool empty() const { return rows_.empty(); }
    double mean() const { return mean_; }
    struct Sample {
        Vec2 position;  // in [0, 1)^2
        float pdf;      // by area of the unit square
    };
    Sample sample(const Vec2& u) const;
    float pdf(const Vec2& position) const;

private:
    uint32_t width_ = 0, height_ = 0;
    DiscreteDistribution marginal_;
    std::vector<DiscreteDistribution> rows_;
    double mean_ = 0.0;
};

}  // namespace spc
