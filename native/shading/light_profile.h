// SPDX-License-Identifier: GPL-3.0-or-later
// The brightness of a lamp by direction as its maker measured it [LM-63]. Semantics are Cycles'.
#pragma once

#include "math/vec.h"

#include <algorithm>
#include <array>
#include <vector>

namespace spc {

// A table as a block of constants: the numbers of azimuths and polar angles, those angles (rad),
// and a row of values over the polar angles for each azimuth. Azimuths go from 0 to 2 pi, both ends
// included, or less far: it is dark beyond.
class LightProfile {
public:
    explicit LightProfile(const float* block)
        : azimuth_count_(static_cast<int>(block[0])),
          polar_count_(static_cast<int>(block[1])),
          azimuths_(block + 2),
          polars_(azimuths_ + azimuth_count_),
          values_(polars_ + polar_count_) {}

    static bool is_valid(const std::vector<float>& block) {
        if (block.size() < 2 || !is_count(block[0]) || !is_count(block[1])) return false;
        const auto azimuths = static_cast<size_t>(block[0]), polars = static_cast<size_t>(block[1]);
        if (block.size() != 2 + azimuths + polars + azimuths * polars) return false;
        const auto first = block.begin() + 2, middle = first + static_cast<long>(azimuths);
        return std::is_sorted(first, middle) &&
               std::is_sorted(middle, middle + static_cast<long>(polars));
    }

    // Towards a direction in the lamp's space, of any length; polar angles are counted from its -Z.
    // 0 beyond the first and last angles.
    float at(const Vec3& direction) const {
        const Vec3 d = safe_normalize(direction, Vec3(0, 0, -1));
        const float polar = std::acos(std::clamp(-d.z, -1.0f, 1.0f));
        if (!(polar >= polars_[0] && polar < polars_[polar_count_ - 1])) return 0.0f;
        const float azimuth = std::atan2(d.x, d.y) + kPi;
        if (!(azimuth >= azimuths_[0] && azimuth <= azimuths_[azimuth_count_ - 1])) return 0.0f;
        const Place row = place(azimuths_, azimuth_count_, azimuth),
                    column = place(polars_, polar_count_, polar);
        std::array<float, 4> rows;
        for (int k = 0; k < 4; ++k)
            rows[static_cast<size_t>(k)] = in_row(around(row.index + k - 1), column);
        return std::max(spline(rows, row.fraction), 0.0f);
    }

    // Over all directions, where each polar angle stands for those half way to its neighbours.
    double mean() const {
        double sum = 0.0;
        for (int j = 0; j < polar_count_; ++j) {
            const double from = std::cos(j == 0 ? polars_[0] : 0.5 * (polars_[j - 1] + polars_[j]));
            const double to =
                std::cos(j + 1 == polar_count_ ? polars_[j] : 0.5 * (polars_[j] + polars_[j + 1]));
            double ring = 0.0;
            for (int i = 0; i + 1 < azimuth_count_; ++i)
                ring += 0.5 * (azimuths_[i + 1] - azimuths_[i]) * (value(i, j) + value(i + 1, j));
            sum += ring * (from - to);
        }
        return sum / (4.0 * kPi);
    }

private:
    struct Place {
        int index;  // of the entry before
        float fraction;
    };

    static bool is_count(float number) {
        constexpr float kMost = 1 << 12;
        return number >= 2.0f && number <= kMost && number == std::floor(number);
    }
    static Place place(const float* angles, int count, float angle) {
        const auto next = std::lower_bound(angles + 1, angles + count - 1, angle);
        const float before = next[-1], step = *next - before;
        return {static_cast<int>(next - angles) - 1, step > 0.0f ? (angle - before) / step : 0.0f};
    }
    // Through the second and third of four values [CatmullRom74].
    static float spline(const std::array<float, 4>& v, float t) {
        const float slope_1 = 0.5f * (v[2] - v[0]), slope_2 = 0.5f * (v[3] - v[1]);
        const float rise = v[2] - v[1], s = t * t * (3.0f - 2.0f * t);
        return v[1] + rise * s + t * (1.0f - t) * (slope_1 * (1.0f - t) - slope_2 * t);
    }
    // Where azimuths go round, the last one is the first again.
    int around(int row) const {
        constexpr float kTurn = 2.0f * kPi * 0.9999f;
        const int last = azimuth_count_ - 1;
        return azimuths_[last] > kTurn ? (row + last) % last : std::clamp(row, 0, last);
    }
    float in_row(int row, const Place& column) const {
        const int before_first = polars_[0] > 0.0f ? 0 : 1;  // lamps look alike around the pole
        std::array<float, 4> v;
        for (int k = 0; k < 4; ++k) {
            const int at = column.index + k - 1;
            v[static_cast<size_t>(k)] =
                value(row, at < 0 ? before_first : std::min(at, polar_count_ - 1));
        }
        return spline(v, column.fraction);
    }
    float value(int row, int column) const { return values_[row * polar_count_ + column]; }

    int azimuth_count_, polar_count_;
    const float *azimuths_, *polars_, *values_;
};

}  // namespace spc
