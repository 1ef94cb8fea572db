// SPDX-License-Identifier: GPL-3.0-or-later
// Tabulated densities: discrete ones, and piecewise bilinear ones in two dimensions. Discrete ones
// are sampled by bisection of a cumulative table. That is monotone in u, so that stratified samples
// stay stratified, which the alias method would not leave them.
#pragma once

#include "math/vec.h"

#include <functional>
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

// Densities over [0, 1)^2 in proportion to an image of width x height texels. Between the centres
// of texels they are bilinear, as the image is when it is looked up, so that it is sampled exactly.
// They are periodic in x and fall to zero at y = 0 and y = 1.
class BilinearMap {
public:
    BilinearMap() = default;
    // values[y * width + x] finite and >= 0.
    BilinearMap(std::vector<float> values, uint32_t width, uint32_t height);

    // A density over some of the cells between centres of texels.
    struct Cells {
        DiscreteDistribution marginal;
        std::vector<DiscreteDistribution> rows;  // height + 1 of them
        double mean = 0.0;  // over the square: of the values in these cells, zero elsewhere

        bool empty() const { return marginal.empty(); }
    };
    // The density over the cells with a corner that `keep` picks. Empty if the image is zero in all
    // of them.
    using Keep = std::function<bool(uint32_t x, uint32_t y)>;
    Cells cells(const Keep& keep) const;

    struct Sample {
        Vec2 position;  // in [0, 1)^2
        float pdf;      // by area of the unit square
    };
    Sample sample(const Cells& cells, const Vec2& u) const;
    float pdf(const Cells& cells, const Vec2& position) const;

private:
    // The cell (x, y) lies between columns x and x + 1 of centres, and rows y - 1 and y.
    struct Corners {
        float v00, v10, v01, v11;
        float mean() const { return 0.25f * (v00 + v10 + v01 + v11); }
    };
    Corners corners(uint32_t x, uint32_t y) const;
    float row_start(uint32_t y) const;
    float row_extent(uint32_t y) const;

    uint32_t width_ = 0, height_ = 0;
    std::vector<float> values_;
};

}  // namespace spc
