// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include "core/error.h"

#include <utility>

namespace spc {

void accumulate(PixelSums& pixel, const FilmSample& sample) {
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        const double value = static_cast<double>(sample.radiance[c]);
        pixel.radiance[i] += value;
        pixel.radiance_squared[i] += value * value;
        pixel.caustics[i] += sample.caustics[c];
        pixel.normal[i] += sample.normal[c];
        if (pixel.count == 0) pixel.position[i] = sample.position[c];
    }
    if (pixel.count == 0) pixel.depth = sample.depth;  // means of distances lie where no surface is
    pixel.alpha += sample.alpha;
    pixel.walks.add(sample.walks);
    ++pixel.count;
}

uint32_t pass_channels(Pass pass) {
    switch (pass) {
        case Pass::combined: return 4;
        case Pass::depth:
        case Pass::walk_success:
        case Pass::walk_trials: return 1;
        case Pass::position:
        case Pass::normal:
        case Pass::caustics:
        case Pass::variance: return 3;
        case Pass::count: break;
    }
    return 0;
}

namespace {

float ratio(uint64_t part, uint64_t whole) {
    return whole > 0 ? static_cast<float>(static_cast<double>(part) / static_cast<double>(whole))
                     : 0.0f;
}

// The weights of a narrow filter may lift variances beyond single precision, with room for a sum.
float to_float(double value) { return static_cast<float>(std::min(value, 1e37)); }

void write_pixel(Pass pass, const PixelSums& pixel, float* out) {
    const double n = pixel.count;
    const auto mean = [n](double sum) { return static_cast<float>(sum / n); };
    switch (pass) {
        case Pass::combined:
            for (size_t c = 0; c < 3; ++c) out[c] = mean(pixel.radiance[c]);
            out[3] = mean(static_cast<double>(pixel.alpha));
            break;
        case Pass::depth: out[0] = pixel.depth; break;
        case Pass::position: std::copy(pixel.position.begin(), pixel.position.end(), out); break;
        case Pass::normal:
            for (size_t c = 0; c < 3; ++c) out[c] = mean(static_cast<double>(pixel.normal[c]));
            break;
        case Pass::caustics:
            for (size_t c = 0; c < 3; ++c) out[c] = mean(static_cast<double>(pixel.caustics[c]));
            break;
        case Pass::variance:
            for (size_t c = 0; c < 3; ++c) {
                const double m = pixel.radiance[c] / n;
                const double spread = std::max(pixel.radiance_squared[c] / n - m * m, 0.0);
                out[c] = pixel.count > 1 ? static_cast<float>(spread / (n - 1.0)) : 0.0f;
            }
            break;
        case Pass::walk_success: out[0] = ratio(pixel.walks.converged, pixel.walks.walks); break;
        case Pass::walk_trials:
            out[0] = ratio(pixel.walks.trials, pixel.walks.trial_estimates);
            break;
        case Pass::count: break;
    }
}

}  // namespace

Film::Film(uint32_t width, uint32_t height)
    : width_(width),
      height_(height),
      tiles_across_(static_cast<uint32_t>((uint64_t{width} + kTileSize - 1) / kTileSize)),
      pixels_(static_cast<size_t>(width) * height),
      mutexes_(static_cast<size_t>(tiles_across_) *
               ((uint64_t{height} + kTileSize - 1) / kTileSize)) {}

Film::TileBounds Film::bounds(uint32_t tile) const {
    const uint32_t x0 = tile % tiles_across_ * kTileSize, y0 = tile / tiles_across_ * kTileSize;
    return {x0, y0, std::min(kTileSize, width_ - x0), std::min(kTileSize, height_ - y0)};
}

// The tiles below fill whole rows; those to the left are as high as this one.
std::span<const PixelSums> Film::tile_pixels(uint32_t tile) const {
    const TileBounds b = bounds(tile);
    const size_t begin = static_cast<size_t>(b.y0) * width_ + static_cast<size_t>(b.x0) * b.height;
    return std::span(pixels_).subspan(begin, static_cast<size_t>(b.width) * b.height);
}
std::span<PixelSums> Film::tile_pixels(uint32_t tile) {
    const std::span<const PixelSums> pixels = std::as_const(*this).tile_pixels(tile);
    return {const_cast<PixelSums*>(pixels.data()), pixels.size()};
}

std::vector<PixelSums> Film::copy_tile(uint32_t tile) const {
    const std::span<const PixelSums> pixels = tile_pixels(tile);
    const std::lock_guard lock(mutexes_[tile]);
    return {pixels.begin(), pixels.end()};
}

void Film::store_tile(uint32_t tile, std::span<const PixelSums> pixels) {
    const std::span<PixelSums> out = tile_pixels(tile);
    SPC_ASSERT(pixels.size() == out.size());
    const std::lock_guard lock(mutexes_[tile]);
    std::copy(pixels.begin(), pixels.end(), out.begin());
}

void Film::add_splats(SplatSource source, std::span<const Splat> splats, const PixelFilter& filter,
                      uint64_t estimates, double per_picture) {
    const std::lock_guard lock(splat_mutex_);
    SplatLayer& layer = splats_[static_cast<size_t>(source)];
    if (layer.pixels.empty()) layer.pixels.resize(pixels_.size());
    layer.estimates += static_cast<double>(estimates);
    layer.pictures += static_cast<double>(estimates) / per_picture;
    const auto pixels_near = [&](float at, uint32_t size) {
        const float first = std::ceil(at - filter.radius() - 0.5f);
        const float last = std::floor(at + filter.radius() - 0.5f);
        return std::array{static_cast<int64_t>(std::max(first, 0.0f)),
                          static_cast<int64_t>(std::min(last, static_cast<float>(size) - 1.0f))};
    };
    std::vector<float> row;  // the weights of each column
    for (const Splat& splat : splats) {
        const auto [x0, x1] = pixels_near(splat.film.x, width_);
        const auto [y0, y1] = pixels_near(splat.film.y, height_);
        row.clear();
        for (int64_t x = x0; x <= x1; ++x)
            row.push_back(filter.weight(splat.film.x - static_cast<float>(x) - 0.5f));
        for (int64_t y = y0; y <= y1; ++y) {
            const float wy = filter.weight(splat.film.y - static_cast<float>(y) - 0.5f);
            for (int64_t x = x0; x <= x1; ++x) {
                const float w = wy * row[static_cast<size_t>(x - x0)];
                SplatSums& sums =
                    layer.pixels[static_cast<size_t>(y) * width_ + static_cast<size_t>(x)];
                for (int c = 0; c < 3; ++c) {
                    const auto value = static_cast<double>(w * splat.value[c]);
                    sums.value[static_cast<size_t>(c)] += value;
                    sums.squared[static_cast<size_t>(c)] += value * value;
                }
            }
        }
    }
}

Film::SplatMean Film::SplatLayer::mean(size_t pixel) const {
    SplatMean result;
    const SplatSums& sums = pixels[pixel];
    for (size_t c = 0; c < 3; ++c) {
        result.value[c] = sums.value[c] / pictures;
        result.variance[c] =
            std::max(sums.squared[c] - sums.value[c] * sums.value[c] / estimates, 0.0) /
            (pictures * pictures);
    }
    return result;
}

void Film::set_preview(uint32_t block, std::vector<std::array<float, 4>> colors) {
    const std::lock_guard lock(splat_mutex_);
    preview_ = std::move(colors);
    preview_block_ = block;
}

// Where there is no sample. What splats there is part of the preview already.
void Film::show_preview(std::span<float> combined) const {
    const uint32_t across = (width_ + preview_block_ - 1) / preview_block_;
    for (uint32_t t = 0; t < tile_count(); ++t) {
        const TileBounds b = bounds(t);
        const std::span<const PixelSums> pixels = tile_pixels(t);
        const std::lock_guard lock(mutexes_[t]);
        for (uint32_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].count > 0) continue;
            const uint32_t x = b.x0 + i % b.width, y = b.y0 + i / b.width;
            const std::array<float, 4>& color =
                preview_[static_cast<size_t>(y / preview_block_) * across + x / preview_block_];
            std::copy(color.begin(), color.end(),
                      combined.begin() + 4 * (static_cast<ptrdiff_t>(y) * width_ + x));
        }
    }
}

void Film::read(Pass pass, std::span<float> out) const {
    const size_t channels = pass_channels(pass);
    SPC_ASSERT(out.size() == channels * width_ * height_);
    std::fill(out.begin(), out.end(), 0.0f);
    for (uint32_t t = 0; t < tile_count(); ++t) {
        const TileBounds b = bounds(t);
        const std::span<const PixelSums> pixels = tile_pixels(t);
        const std::lock_guard lock(mutexes_[t]);
        for (uint32_t y = 0; y < b.height; ++y)
            for (uint32_t x = 0; x < b.width; ++x) {
                const PixelSums& pixel = pixels[static_cast<size_t>(y) * b.width + x];
                const size_t at = static_cast<size_t>(b.y0 + y) * width_ + b.x0 + x;
                if (pixel.count > 0) write_pixel(pass, pixel, out.data() + at * channels);
            }
    }
    const std::lock_guard lock(splat_mutex_);
    if (pass != Pass::combined && pass != Pass::caustics && pass != Pass::variance) return;
    for (const SplatSource source : {SplatSource::light_paths, SplatSource::camera_chains,
                                     SplatSource::missed_camera_chains}) {
        if (pass == Pass::caustics && source != SplatSource::light_paths) continue;
        const SplatLayer& layer = splats_[static_cast<size_t>(source)];
        for (size_t at = 0; at < layer.pixels.size(); ++at) {
            const SplatMean mean = layer.mean(at);
            for (size_t c = 0; c < 3; ++c)
                out[at * channels + c] +=
                    to_float(pass == Pass::variance ? mean.variance[c] : mean.value[c]);
        }
    }
    if (pass == Pass::combined && preview_block_ > 0) show_preview(out);
}

}  // namespace spc
