// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over the cells of a coarse grid on the picture, for what is learned of it before it is
// rendered.
#pragma once

#include "math/vec.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace spc {

class CoarsePicture {
public:
    static constexpr size_t kSide = 8, kCells = kSide * kSide;

    // `crop`: of the film, as Camera has it.
    explicit CoarsePicture(const std::array<uint32_t, 4>& crop) : crop_(crop) {}

    // What lies beside the crop counts for the cell next to it.
    void add(const Vec2& film, double value) {
        cells_[index(film.y, crop_[1], crop_[3]) * kSide + index(film.x, crop_[0], crop_[2])] +=
            value;
    }
    void add(const CoarsePicture& other) {
        for (size_t i = 0; i < kCells; ++i) cells_[i] += other.cells_[i];
    }
    void scale(double factor) {
        for (double& cell : cells_) cell *= factor;
    }
    double operator[](size_t cell) const { return cells_[cell]; }

private:
    static size_t index(float at, uint32_t begin, uint32_t size) {
        const float u = (at - static_cast<float>(begin)) / static_cast<float>(size);
        return std::min(static_cast<size_t>(std::max(u, 0.0f) * static_cast<float>(kSide)),
                        kSide - 1);
    }

    std::array<uint32_t, 4> crop_;
    std::array<double, kCells> cells_{};
};

}  // namespace spc
