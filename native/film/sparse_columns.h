// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of the pixels of a tile. Most passes have none in most tiles: what scatters diffusely
// has no light by transmission, and sums of few bits have no low part.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace spc {

// A table with a row for each pixel. Columns of nothing but zeros take no memory.
template <class T>
class SparseColumns {
public:
    // Takes rows of `columns` values each, instead of what there was.
    void store(std::span<const T> rows, size_t columns) {
        const size_t pixels = columns > 0 ? rows.size() / columns : 0;
        std::vector<uint16_t> places(columns, kNone);
        for (size_t pixel = 0; pixel < pixels; ++pixel)
            for (size_t c = 0; c < columns; ++c)
                if (rows[pixel * columns + c] != T{}) places[c] = 0;
        uint16_t used = 0;
        for (uint16_t& place : places)
            if (place != kNone) place = used++;
        if (values_.size() != used * pixels) values_ = std::vector<T>(used * pixels);
        for (size_t c = 0; c < columns; ++c)
            for (size_t pixel = 0; places[c] != kNone && pixel < pixels; ++pixel)
                values_[places[c] * pixels + pixel] = rows[pixel * columns + c];
        places_ = std::move(places);
        pixels_ = pixels;
    }

    // Rows as they were stored; of zeros if nothing was.
    std::vector<T> load(size_t pixels, size_t columns) const {
        std::vector<T> rows(pixels * columns);
        for (size_t c = 0; c < places_.size(); ++c) {
            const std::span<const T> values = column(c);
            for (size_t pixel = 0; pixel < values.size(); ++pixel)
                rows[pixel * columns + c] = values[pixel];
        }
        return rows;
    }

    // A value for each pixel, or none if all are zero.
    std::span<const T> column(size_t c) const {
        if (c >= places_.size() || places_[c] == kNone) return {};
        return std::span(values_).subspan(places_[c] * pixels_, pixels_);
    }
    T at(size_t pixel, size_t c) const {
        const std::span<const T> values = column(c);
        return values.empty() ? T{} : values[pixel];
    }

private:
    static constexpr uint16_t kNone = std::numeric_limits<uint16_t>::max();
    std::vector<T> values_;         // column after column
    std::vector<uint16_t> places_;  // of each column among those that are kept
    size_t pixels_ = 0;
};

}  // namespace spc
