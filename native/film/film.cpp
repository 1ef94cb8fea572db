// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include "core/error.h"
#include "film/exact_sum.h"

#include <bit>

namespace spc {

bool takes_splats(Pass pass) {
    const Accumulation how = describe(pass).accumulation;
    return how == Accumulation::light_by_color ||
           (how == Accumulation::light && pass >= first_of(CustomKind::light_group));
}

Film::Film(uint32_t width, uint32_t height, PassSet passes, SplatSpread spread,
           CryptoRequest crypto, bool keeps_halves)
    : width_(width),
      height_(height),
      tiles_across_(static_cast<uint32_t>((uint64_t{width} + kTileSize - 1) / kTileSize)),
      passes_(passes.with_colors()),
      spread_(spread),
      crypto_(crypto),
      pixels_(static_cast<size_t>(width) * height),
      mutexes_(static_cast<size_t>(tiles_across_) *
               ((uint64_t{height} + kTileSize - 1) / kTileSize)) {
    passes_.each([this](Pass pass) { add_plane(pass); });
    tile_planes_.resize(tile_count());
    if (keeps_halves) halves_.resize(pixels_.size());
}

size_t Film::crypto_stride() const {
    return static_cast<size_t>(std::popcount(crypto_.kinds)) * crypto_.slots();
}

void Film::add_plane(Pass pass) {
    const Accumulation how = describe(pass).accumulation;
    if (how == Accumulation::picture) return;
    const uint32_t channels = how == Accumulation::ratio ? 2 : pass_channels(pass);
    planes_.push_back({pass, how, passes_.slot(pass), channels, high_stride_, low_stride_});
    if (how != Accumulation::first) high_stride_ += channels;
    low_stride_ += channels;
}

const Film::Plane* Film::plane_of(Pass pass) const {
    for (const Plane& plane : planes_)
        if (plane.pass == pass) return &plane;
    return nullptr;
}

Film::TileBounds Film::bounds(uint32_t tile) const {
    const uint32_t x0 = tile % tiles_across_ * kTileSize, y0 = tile / tiles_across_ * kTileSize;
    return {x0, y0, std::min(kTileSize, width_ - x0), std::min(kTileSize, height_ - y0)};
}

// The tiles below fill whole rows; those to the left are as high as this one.
size_t Film::first_pixel(uint32_t tile) const {
    const TileBounds b = bounds(tile);
    return static_cast<size_t>(b.y0) * width_ + static_cast<size_t>(b.x0) * b.height;
}

Film::TileSums Film::copy_tile(uint32_t tile) const {
    const auto begin = static_cast<ptrdiff_t>(first_pixel(tile));
    const size_t count = pixel_count(tile);
    const auto end = begin + static_cast<ptrdiff_t>(count);
    const TilePlanes& planes = tile_planes_[tile];
    const std::lock_guard lock(mutexes_[tile]);
    return {std::vector(pixels_.begin() + begin, pixels_.begin() + end),
            planes.high.load(count, high_stride_), planes.low.load(count, low_stride_),
            planes.coverage.load(count, crypto_stride()),
            halves_.empty() ? std::vector<HalfSums>()
                            : std::vector(halves_.begin() + begin, halves_.begin() + end)};
}

void Film::store_tile(uint32_t tile, const TileSums& sums) {
    SPC_ASSERT(sums.pixels.size() == pixel_count(tile));
    const auto begin = static_cast<ptrdiff_t>(first_pixel(tile));
    TilePlanes& planes = tile_planes_[tile];
    const std::lock_guard lock(mutexes_[tile]);
    std::copy(sums.pixels.begin(), sums.pixels.end(), pixels_.begin() + begin);
    planes.high.store(sums.high, high_stride_);
    planes.low.store(sums.low, low_stride_);
    planes.coverage.store(sums.coverage, crypto_stride());
    if (!halves_.empty())
        std::copy(sums.halves.begin(), sums.halves.end(), halves_.begin() + begin);
}

std::optional<double> sample_variance(std::span<const PixelSums> pixels) {
    double sum = 0.0;
    for (const PixelSums& pixel : pixels) {
        const double n = pixel.count;
        if (n < 2.0) return std::nullopt;
        for (size_t c = 0; c < 3; ++c) {
            const double mean = pixel.radiance[c] / n;
            sum += (pixel.radiance_squared[c] / n - mean * mean) * (n / (n - 1.0));
        }
    }
    return sum / (3.0 * static_cast<double>(pixels.size()));
}

float relative_error(const PixelSums& all, const HalfSums& half) {
    constexpr double kBlack = 1e-4;
    const double n = all.count, n_half = (all.count + 1) / 2;
    double difference = 0.0, sum = 0.0;
    for (size_t c = 0; c < 3; ++c) {
        const double mean = all.radiance[c] / n;
        difference += std::abs(mean - half.radiance[c] / n_half);
        sum += std::abs(mean);
    }
    return static_cast<float>(difference / (kBlack + (sum < 1.0 ? std::sqrt(sum) : sum)));
}

void Film::accumulate(TileSums& tile, size_t index, const FilmSample& sample) const {
    PixelSums& pixel = tile.pixels[index];
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        const double value = static_cast<double>(sample.radiance[c]);
        add_exactly(pixel.radiance[i], pixel.radiance_low[i], value);
        add_exactly(pixel.radiance_squared[i], pixel.radiance_squared_low[i], value * value);
    }
    add_exactly(pixel.alpha, pixel.alpha_low, static_cast<double>(sample.alpha));
    if (has_planes()) {
        double* high = tile.high.data() + index * high_stride_;
        float* low = tile.low.data() + index * low_stride_;
        for (const Plane& plane : planes_) {
            const PassValue& value = sample.values->at(plane.slot);
            for (uint32_t c = 0; c < plane.channels; ++c) {
                const float v = value[c];
                if (plane.how != Accumulation::first)
                    add_exactly(high[plane.high + c], low[plane.low + c], static_cast<double>(v));
                else if (pixel.count == 0)
                    low[plane.low + c] = v;
            }
        }
    }
    if (!tile.halves.empty() && pixel.count % 2 == 0)
        for (int c = 0; c < 3; ++c)
            tile.halves[index].radiance[static_cast<size_t>(c)] +=
                static_cast<double>(sample.radiance[c]);
    if (crypto_.any()) {
        const size_t first = index * crypto_stride();
        each_crypto_kind([&](size_t kind, size_t at) {
            const auto slots = std::span(tile.coverage).subspan(first + at, crypto_.slots());
            for (const Coverage::Part& part : sample.values->coverage.parts())
                add_coverage(slots, part.ids[kind], part.weight);
        });
    }
    ++pixel.count;
}

namespace {

// Pixels that a point of the film may belong to along one axis, with the share that each takes.
class Neighbours {
public:
    // Replaces those of another point.
    void find(float at, const PixelFilter& filter) {
        first_ = static_cast<int64_t>(std::ceil(at - filter.radius() - 0.5f));
        const auto last = static_cast<int64_t>(std::floor(at + filter.radius() - 0.5f));
        shares_.clear();
        for (int64_t x = first_; x <= last; ++x)
            shares_.push_back(filter.weight(at - static_cast<float>(x) - 0.5f));
    }
    template <class Visit>
    void each(uint32_t size, const Visit& visit) const {
        for (size_t i = 0; i < shares_.size(); ++i) {
            const int64_t x = first_ + static_cast<int64_t>(i);
            if (x >= 0 && x < int64_t{size} && shares_[i] > 0.0f)
                visit(static_cast<size_t>(x), shares_[i]);
        }
    }
    // One of them, drawn by the shares, with the sum of these; outside of the film, -1.
    std::pair<int64_t, float> draw(float u, uint32_t size) const {
        float sum = 0.0f;
        for (const float share : shares_) sum += share;
        float left = u * sum;
        for (size_t i = 0; i < shares_.size(); ++i) {
            left -= shares_[i];
            const int64_t x = first_ + static_cast<int64_t>(i);
            if (left < 0.0f) return {x < int64_t{size} ? x : -1, sum};
        }
        return {-1, 0.0f};
    }

private:
    int64_t first_ = 0;
    std::vector<float> shares_;
};

}  // namespace

void Film::SplatSums::add(const Spectrum& value) {
    for (int c = 0; c < 3; ++c)
        add_exactly(high[static_cast<size_t>(c)], low[static_cast<size_t>(c)],
                    static_cast<double>(value[c]));
}

void Film::add_to_pixel(SplatLayer& layer, size_t x, size_t y, const Splat& splat,
                        float weight) const {
    const size_t index = y / kTileSize * tiles_across_ + x / kTileSize;
    const TileBounds b = bounds(static_cast<uint32_t>(index));
    const size_t pixel = (y - b.y0) * b.width + (x - b.x0);
    SplatTile& tile = layer.tiles[index];
    const auto add_to = [&](std::vector<SplatSums>& sums, const Spectrum& part) {
        if (sums.empty()) sums.resize(size_t{b.width} * b.height);
        sums[pixel].add(part);
    };
    const auto add = [&](Pass pass, const Spectrum& part) {
        if (passes_.has(pass)) add_to(tile.passes[passes_.slot(pass)], part);
    };
    const Spectrum value = splat.value * weight;
    add_to(tile.picture, value);
    add_to(tile.squared, value * value);
    if (splat.light_group != kNoGroup)
        add(pass_of(CustomKind::light_group, splat.light_group), value);
    if (!passes_.tell_lobes()) return;
    const Pass first = splat.direct ? Pass::diffuse_direct : Pass::diffuse_indirect;
    for (size_t i = 0; i < kLobes; ++i)
        if (splat.shares[i] != Spectrum(0.0f))
            add(pass_of(first, static_cast<Lobe>(i)), value * splat.shares[i]);
}

Film::SplatLayer& Film::layer_of(SplatSource source) {
    SplatLayer& layer = splats_[static_cast<size_t>(source)];
    if (layer.tiles.empty()) {
        layer.tiles.resize(tile_count());
        for (SplatTile& tile : layer.tiles) tile.passes.resize(passes_.slots());
    }
    return layer;
}

void Film::add_splats(SplatSource source, std::span<const Splat> splats, const PixelFilter& filter,
                      uint64_t estimates, double per_picture) {
    const std::lock_guard lock(splat_mutex_);
    SplatLayer& layer = layer_of(source);
    layer.estimates += static_cast<double>(estimates);
    layer.per_picture = per_picture;
    Neighbours columns, rows;
    for (const Splat& splat : splats) {
        columns.find(splat.film.x, filter);
        rows.find(splat.film.y, filter);
        if (spread_ == SplatSpread::one_pixel) {
            const auto [x, x_share] = columns.draw(splat.u.x, width_);
            const auto [y, y_share] = rows.draw(splat.u.y, height_);
            if (x >= 0 && y >= 0)
                add_to_pixel(layer, static_cast<size_t>(x), static_cast<size_t>(y), splat,
                             x_share * y_share);
            continue;
        }
        rows.each(height_, [&](size_t y, float y_share) {
            columns.each(width_, [&](size_t x, float x_share) {
                add_to_pixel(layer, x, y, splat, x_share * y_share);
            });
        });
    }
}

std::array<double, 3> Film::SplatLayer::mean(const SplatSums& sums) const {
    std::array<double, 3> result = sums.high;
    for (double& value : result) value /= pictures();
    return result;
}

std::array<double, 3> Film::SplatLayer::variance(const SplatTile& tile, size_t pixel) const {
    std::array<double, 3> result{};
    for (size_t c = 0; c < 3; ++c) {
        const double sum = tile.picture[pixel].high[c];
        result[c] = std::max(tile.squared[pixel].high[c] - sum * sum / estimates, 0.0) /
                    (pictures() * pictures());
    }
    return result;
}

void Film::set_preview(uint32_t block, std::vector<std::array<float, 4>> colors) {
    const std::lock_guard lock(splat_mutex_);
    preview_ = std::move(colors);
    preview_block_ = block;
}

}  // namespace spc
