// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_field.h"

#include "core/parallel.h"

namespace spc {

namespace {

// Finest level with sums. Below it a region is described by the node around it.
constexpr int kFirstSums = 3;
// Least z of a normal before normalisation. Slopes steeper than 1 / kLeastHeight are artefacts of a
// file.
constexpr float kLeastHeight = 0.02f;

int halved(int n) { return (n + 1) / 2; }
int wrapped(int i, int n) {
    if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
    const int m = i % n;
    return m < 0 ? m + n : m;
}

Vec3 color(const Image& image, int x, int y) {
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    const size_t at = (static_cast<size_t>(wrapped(y, height)) * image.width +
                       static_cast<size_t>(wrapped(x, width))) *
                      image.channels;
    Vec3 c;
    for (int i = 0; i < 3; ++i) {
        const size_t k = at + (image.channels == 1 ? 0 : static_cast<size_t>(i));
        c[i] = image.bytes.empty() ? image.floats[k]
                                   : static_cast<float>(image.bytes[k]) * (1.0f / 255.0f);
    }
    return c;
}

// The bounds of what bounds_of_row(y) gives for all rows.
template <class BoundsOfRow>
SlopeBounds bounds_of_all(const Image& image, uint32_t threads, const BoundsOfRow& bounds_of_row) {
    std::vector<SlopeBounds> rows(image.height);
    parallel_for(threads, image.height,
                 [&](uint32_t y) { rows[y] = bounds_of_row(static_cast<int>(y)); });
    SlopeBounds all = rows[0];
    for (const SlopeBounds& row : rows) all.extend(row);
    return all;
}

}  // namespace

Vec3 NormalTexels::normal(int x, int y) const {
    const Vec3 c = color(image, x, y) * 2.0f - Vec3(1.0f);
    return {c.x * strength, c.y * strength, 1.0f + (c.z - 1.0f) * clamp01(strength)};
}

NormalPatch NormalTexels::cell(int x, int y) const {
    return {{normal(x, y), normal(x + 1, y), normal(x, y + 1), normal(x + 1, y + 1)}};
}

std::vector<Vec2> NormalTexels::slopes(int y) const {
    std::vector<Vec2> row(image.width);
    for (size_t x = 0; x < row.size(); ++x) row[x] = slope_of(normal(static_cast<int>(x), y));
    return row;
}

void NormalTexels::bounds(int y, std::span<SlopeBounds> row) const {
    const std::vector<Vec2> lower = slopes(y), upper = slopes(y + 1);
    const auto at = [&](size_t x) {
        SlopeBounds both{lower[x], lower[x]};
        both.extend(upper[x]);
        return both;
    };
    for (size_t x = 0; x < row.size(); ++x) {
        row[x] = at(x);
        row[x].extend(at(x + 1 < row.size() ? x + 1 : 0));
    }
}

std::optional<SlopeBounds> NormalTexels::extent(uint32_t threads) const {
    std::atomic<bool> outwards{true};
    const SlopeBounds all = bounds_of_all(image, threads, [&](int y) {
        SlopeBounds bounds{slope_of(normal(0, y)), slope_of(normal(0, y))};
        for (int x = 0; x < static_cast<int>(image.width); ++x) {
            const Vec3 n = normal(x, y);
            if (!(n.z >= kLeastHeight)) outwards = false;
            bounds.extend(slope_of(n));
        }
        return bounds;
    });
    if (!outwards) return std::nullopt;
    return all;
}

float HeightTexels::height(int x, int y) const {
    const Vec3 c = color(image, x, y);
    return luminance(Spectrum(c.x, c.y, c.z));
}

HeightPatch HeightTexels::cell(int x, int y) const {
    const auto column = [&](int i) {
        return HeightPatch::Column(
            {height(i, y - 1), height(i, y), height(i, y + 1), height(i, y + 2)});
    };
    return HeightPatch::of_columns(column(x - 1), column(x), column(x + 1), column(x + 2));
}

std::vector<float> HeightTexels::heights(int y) const {
    std::vector<float> row(image.width + 3);
    for (size_t i = 0; i < row.size(); ++i) row[i] = height(static_cast<int>(i) - 1, y);
    return row;
}

// The spline's gradient at texels.
std::vector<Vec2> HeightTexels::slopes(int y) const {
    const std::vector<float> below = heights(y - 1), at = heights(y), above = heights(y + 1);
    const auto across = [&](size_t i) { return (above[i] - below[i]) * 0.5f; };
    std::vector<Vec2> row(image.width);
    for (size_t x = 0; x < row.size(); ++x) {
        const auto along = [&](const std::vector<float>& h) { return (h[x + 2] - h[x]) * 0.5f; };
        row[x] = Vec2(along(below) + 4.0f * along(at) + along(above),
                      across(x) + 4.0f * across(x + 1) + across(x + 2)) *
                 (1.0f / 6.0f);
    }
    return row;
}

void HeightTexels::bounds(int y, std::span<SlopeBounds> row) const {
    const std::vector<float> h[4] = {heights(y - 1), heights(y), heights(y + 1), heights(y + 2)};
    const auto column = [&](size_t i) {
        return HeightPatch::Column({h[0][i], h[1][i], h[2][i], h[3][i]});
    };
    std::array<HeightPatch::Column, 4> columns{column(0), column(0), column(1), column(2)};
    for (size_t x = 0; x < row.size(); ++x) {
        std::shift_left(columns.begin(), columns.end(), 1);
        columns[3] = column(x + 3);
        row[x] = HeightPatch::of_columns(columns[0], columns[1], columns[2], columns[3]).bounds();
    }
}

// The derivatives of a spline are means of its coefficients' differences.
SlopeBounds HeightTexels::extent(uint32_t threads) const {
    return bounds_of_all(image, threads, [&](int y) {
        const std::vector<float> at = heights(y), above = heights(y + 1);
        const auto difference = [&](size_t i) { return Vec2(at[i + 1] - at[i], above[i] - at[i]); };
        SlopeBounds bounds{difference(1), difference(1)};
        for (size_t i = 1; i <= image.width; ++i) bounds.extend(difference(i));
        return bounds;
    });
}

std::optional<SlopeField> SlopeField::of_normals(const Image& image, float strength,
                                                 uint32_t threads) {
    const NormalTexels texels{image, strength};
    const std::optional<SlopeBounds> extent = texels.extent(threads);
    if (!extent) return std::nullopt;
    return SlopeField(texels, *extent, threads);
}

SlopeField SlopeField::of_heights(const Image& image, uint32_t threads) {
    const HeightTexels texels{image};
    return SlopeField(texels, texels.extent(threads), threads);
}

template <class Texels>
SlopeField::SlopeField(const Texels& texels, const SlopeBounds& extent, uint32_t threads)
    : texels_(texels),
      width_(static_cast<int>(texels.image.width)),
      height_(static_cast<int>(texels.image.height)),
      pyramid_(
          width_, height_, extent,
          [&](int y, std::span<SlopeBounds> row) { texels.bounds(y, row); }, threads) {
    build_sums(texels, threads);
}

template <class Texels>
void SlopeField::build_sums(const Texels& texels, uint32_t threads) {
    int w = width_, h = height_;
    for (int l = 0; l < kFirstSums; ++l) {
        w = halved(w);
        h = halved(h);
    }
    SumLevel finest{w, h,
                    std::vector<Sums>(static_cast<size_t>(w) * static_cast<size_t>(h), Sums{})};
    parallel_for(threads, static_cast<uint32_t>(h), [&](uint32_t row) {
        const int first = static_cast<int>(row) << kFirstSums;
        for (int y = first; y < std::min(first + (1 << kFirstSums), height_); ++y) {
            const std::vector<Vec2> slopes = texels.slopes(y);
            for (int x = 0; x < width_; ++x) {
                const Vec2 s = slopes[static_cast<size_t>(x)];
                Sums& sums = finest.nodes[static_cast<size_t>(row) * static_cast<size_t>(w) +
                                          static_cast<size_t>(x >> kFirstSums)];
                sums.add({s.x, s.y, s.x * s.x, s.x * s.y, s.y * s.y, 1.0f});
            }
        }
    });
    sums_.push_back(std::move(finest));
    while (w > 1 || h > 1) {
        const SumLevel& below = sums_.back();
        w = halved(w);
        h = halved(h);
        SumLevel level{w, h,
                       std::vector<Sums>(static_cast<size_t>(w) * static_cast<size_t>(h), Sums{})};
        for (int y = 0; y < below.height; ++y)
            for (int x = 0; x < below.width; ++x) {
                const Sums& from =
                    below.nodes[static_cast<size_t>(y) * static_cast<size_t>(below.width) +
                                static_cast<size_t>(x)];
                level
                    .nodes[static_cast<size_t>(y / 2) * static_cast<size_t>(w) +
                           static_cast<size_t>(x / 2)]
                    .add(from);
            }
        sums_.push_back(std::move(level));
    }
}

SlopeMoments SlopeField::moments(const Vec2& lower, const Vec2& upper) const {
    // The first level at which two nodes span the rectangle along both axes.
    const float extent = std::max(upper.x - lower.x, upper.y - lower.y);
    size_t l = 0;
    while (l + 1 < sums_.size() && extent > 2.0f * static_cast<float>(1 << (kFirstSums + l))) ++l;
    const SumLevel& level = sums_[l];
    Sums all{};
    const auto add = [&](int x, int y) {
        all.add(level.nodes[static_cast<size_t>(y) * static_cast<size_t>(level.width) +
                            static_cast<size_t>(x)]);
    };
    const auto cell_size = static_cast<float>(1 << (kFirstSums + l));
    const auto first = [&](float at) { return static_cast<int>(std::floor(at / cell_size)); };
    if (level.nodes.size() == 1) {
        add(0, 0);
    } else {
        // Where width or height are not multiples of a node's size, repeats are counted as if they
        // were: this serves estimates alone.
        for (int y = first(lower.y); y <= first(upper.y); ++y)
            for (int x = first(lower.x); x <= first(upper.x); ++x)
                add(wrapped(x, level.width), wrapped(y, level.height));
    }
    const float inv = 1.0f / all.count;
    SlopeMoments m;
    m.mean = Vec2(all.a, all.b) * inv;
    m.aa = std::max(all.aa * inv - m.mean.x * m.mean.x, 0.0f);
    m.bb = std::max(all.bb * inv - m.mean.y * m.mean.y, 0.0f);
    const float most = std::sqrt(m.aa * m.bb);
    m.ab = std::clamp(all.ab * inv - m.mean.x * m.mean.y, -most, most);
    return m;
}

size_t SlopeField::memory_bytes() const {
    size_t bytes = pyramid_.memory_bytes();
    for (const SumLevel& level : sums_) bytes += level.nodes.size() * sizeof(Sums);
    return bytes;
}

}  // namespace spc
