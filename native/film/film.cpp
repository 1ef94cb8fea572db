// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include "core/error.h"
#include "film/exact_sum.h"

#include <bit>

namespace spc {

Film::Film(uint32_t width, uint32_t height, PassSet passes, SplatSpread spread,
           CryptoRequest crypto, bool keeps_halves)
    : width_(width),
      height_(height),
      tiles_across_(static_cast<uint32_t>((uint64_t{width} + kTileSize - 1) / kTileSize)),
      passes_(passes.with_colors()),
      spread_(spread),
      crypto_(crypto),
      mutexes_(static_cast<size_t>(tiles_across_) *
               ((uint64_t{height} + kTileSize - 1) / kTileSize)) {
    passes_.each([this](Pass pass) { add_plane(pass); });
    const size_t pixels = static_cast<size_t>(width) * height;
    pixels_.resize(pixels);
    high_.resize(pixels * high_stride_);
    low_.resize(pixels * low_stride_);
    coverage_.resize(pixels * crypto_stride());
    if (keeps_halves) halves_.resize(pixels);
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
    const TileBounds b = bounds(tile);
    const size_t begin = first_pixel(tile), count = static_cast<size_t>(b.width) * b.height;
    const auto part = [&](const auto& all, size_t stride) {
        const auto first = all.begin() + static_cast<ptrdiff_t>(begin * stride);
        return std::vector(first, first + static_cast<ptrdiff_t>(count * stride));
    };
    const std::lock_guard lock(mutexes_[tile]);
    return {part(pixels_, 1), part(high_, high_stride_), part(low_, low_stride_),
            part(coverage_, crypto_stride()), part(halves_, halves_.empty() ? 0 : 1)};
}

void Film::store_tile(uint32_t tile, const TileSums& sums) {
    SPC_ASSERT(sums.pixels.size() == size_t{bounds(tile).width} * bounds(tile).height);
    const auto begin = static_cast<ptrdiff_t>(first_pixel(tile));
    const std::lock_guard lock(mutexes_[tile]);
    std::copy(sums.pixels.begin(), sums.pixels.end(), pixels_.begin() + begin);
    std::copy(sums.high.begin(), sums.high.end(), high_.begin() + begin * high_stride_);
    std::copy(sums.low.begin(), sums.low.end(), low_.begin() + begin * low_stride_);
    std::copy(sums.coverage.begin(), sums.coverage.end(),
              coverage_.begin() + begin * static_cast<ptrdiff_t>(crypto_stride()));
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

void Film::add_to_pixel(SplatLayer& layer, size_t pixel, const Splat& splat, float weight) const {
    const Spectrum value = splat.value * weight;
    layer.picture[pixel].add(value);
    layer.squared[pixel].add(value * value);
    const auto add = [&](Pass pass, const Spectrum& part) {
        std::vector<SplatSums>& sums = layer.passes[passes_.slot(pass)];
        if (!sums.empty()) sums[pixel].add(part);
    };
    add(Pass::caustics, value);
    if (splat.light_group != kNoGroup)
        add(pass_of(CustomKind::light_group, splat.light_group), value);
    if (!passes_.tell_lobes()) return;
    const Pass first = splat.direct ? Pass::diffuse_direct : Pass::diffuse_indirect;
    for (size_t i = 0; i < kLobes; ++i)
        if (splat.shares[i] != Spectrum(0.0f))
            add(pass_of(first, static_cast<Lobe>(i)), value * splat.shares[i]);
}

// Camera chains are no caustics, and no splat is seen by the camera without a scattering.
Film::SplatLayer& Film::layer_of(SplatSource source) {
    SplatLayer& layer = splats_[static_cast<size_t>(source)];
    if (!layer.picture.empty()) return layer;
    layer.picture.resize(pixels_.size());
    layer.squared.resize(pixels_.size());
    layer.passes.resize(passes_.slots());
    for (const Plane& plane : planes_) {
        const bool takes = plane.pass == Pass::caustics
                               ? source == SplatSource::light_paths
                               : plane.how == Accumulation::light_by_color ||
                                     plane.pass >= first_of(CustomKind::light_group);
        if (takes && plane.how != Accumulation::mean)
            layer.passes[plane.slot].resize(pixels_.size());
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
                add_to_pixel(layer, static_cast<size_t>(y) * width_ + static_cast<size_t>(x), splat,
                             x_share * y_share);
            continue;
        }
        rows.each(height_, [&](size_t y, float y_share) {
            columns.each(width_, [&](size_t x, float x_share) {
                add_to_pixel(layer, y * width_ + x, splat, x_share * y_share);
            });
        });
    }
}

std::array<double, 3> Film::SplatLayer::mean(const std::vector<SplatSums>& sums, size_t pixel) const {
    std::array<double, 3> result = sums[pixel].high;
    for (double& value : result) value /= pictures();
    return result;
}

std::array<double, 3> Film::SplatLayer::variance(size_t pixel) const {
    std::array<double, 3> result{};
    for (size_t c = 0; c < 3; ++c) {
        const double sum = picture[pixel].high[c];
        result[c] = std::max(squared[pixel].high[c] - sum * sum / estimates, 0.0) /
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
