// SPDX-License-Identifier: GPL-3.0-or-later
// From the sums of a film to the passes that are looked at.
#include "core/error.h"
#include "film/film.h"

#include <algorithm>

namespace spc {

namespace {

// The weights of a narrow filter may lift variances beyond single precision, with room for a sum.
float to_float(double value) { return static_cast<float>(std::min(value, 1e37)); }

void write_picture(Pass pass, const PixelSums& pixel, float* out) {
    const double n = pixel.count;
    const auto mean = [n](double sum) { return static_cast<float>(sum / n); };
    if (pass == Pass::combined) {
        for (size_t c = 0; c < 3; ++c) out[c] = mean(pixel.radiance[c]);
        out[3] = mean(pixel.alpha);
    } else if (pass == Pass::variance) {
        for (size_t c = 0; c < 3; ++c) {
            const double m = pixel.radiance[c] / n;
            const double spread = std::max(pixel.radiance_squared[c] / n - m * m, 0.0);
            out[c] = pixel.count > 1 ? static_cast<float>(spread / (n - 1.0)) : 0.0f;
        }
    } else {
        SPC_ASSERT(pass == Pass::sample_count);
        out[0] = static_cast<float>(n);
    }
}

}  // namespace

bool Film::can_read(Pass pass) const {
    return describe(pass).accumulation == Accumulation::picture || plane_of(pass) != nullptr;
}

void Film::write_pixel(Pass pass, size_t pixel, const TilePlanes& planes, size_t in_tile,
                       float* out) const {
    const PixelSums& sums = pixels_[pixel];
    const Plane* plane = plane_of(pass);
    if (plane == nullptr) return write_picture(pass, sums, out);
    const auto sum = [&](uint32_t channel) {
        return planes.high.at(in_tile, plane->high + channel);
    };
    if (plane->how == Accumulation::ratio) {
        const double whole = sum(1);
        out[0] = whole > 0.0 ? static_cast<float>(sum(0) / whole) : 0.0f;
        return;
    }
    for (uint32_t c = 0; c < plane->channels; ++c)
        out[c] = plane->how == Accumulation::first ? planes.low.at(in_tile, plane->low + c)
                                                   : static_cast<float>(sum(c) / sums.count);
}

void Film::read(Pass pass, std::span<float> out) const {
    SPC_ASSERT(can_read(pass));
    const size_t channels = pass_channels(pass);
    SPC_ASSERT(out.size() == channels * width_ * height_);
    std::fill(out.begin(), out.end(), 0.0f);
    for (uint32_t t = 0; t < tile_count(); ++t) {
        const size_t begin = first_pixel(t), count = pixel_count(t);
        const std::lock_guard lock(mutexes_[t]);
        for (size_t i = 0; i < count; ++i)
            if (pixels_[begin + i].count > 0)
                write_pixel(pass, begin + i, tile_planes_[t], i,
                            out.data() + place_of(t, i) * channels);
    }
    {
        const std::lock_guard lock(splat_mutex_);
        add_splat_passes(pass, out);
        if (pass == Pass::combined && preview_block_ > 0) show_preview(out);
    }
    if (describe(pass).accumulation == Accumulation::light_by_color) divide_by_color(pass, out);
}

void Film::read_crypto(CryptoKind wanted, uint32_t level, std::span<float> out) const {
    SPC_ASSERT(crypto_.has(wanted) && out.size() == size_t{4} * width_ * height_);
    std::fill(out.begin(), out.end(), 0.0f);
    each_crypto_kind([&](size_t kind, size_t at) {
        if (kind != static_cast<size_t>(wanted)) return;
        std::vector<CryptoSlot> slots(crypto_.slots());
        for (uint32_t t = 0; t < tile_count(); ++t) {
            const size_t begin = first_pixel(t), count = pixel_count(t);
            const std::lock_guard lock(mutexes_[t]);
            for (size_t i = 0; i < count; ++i) {
                for (size_t slot = 0; slot < slots.size(); ++slot)
                    slots[slot] = tile_planes_[t].coverage.at(i, at + slot);
                const auto value = crypto_level(slots, level, pixels_[begin + i].count);
                std::ranges::copy(value, out.begin() + 4 * static_cast<ptrdiff_t>(place_of(t, i)));
            }
        }
    });
}

// With the lock.
void Film::add_splat_passes(Pass pass, std::span<float> out) const {
    const size_t channels = pass_channels(pass);
    for (size_t source = 0; source < kSplatSources; ++source) {
        const SplatLayer& layer = splats_[source];
        const bool is_caustics = source == static_cast<size_t>(SplatSource::light_paths);
        const bool of_picture = pass == Pass::combined || (pass == Pass::caustics && is_caustics);
        for (uint32_t t = 0; t < layer.tiles.size(); ++t) {
            const SplatTile& tile = layer.tiles[t];
            const bool is_variance = pass == Pass::variance;
            const std::vector<SplatSums>& sums =
                of_picture || is_variance ? tile.picture : tile.passes[passes_.slot(pass)];
            for (size_t i = 0; i < sums.size(); ++i) {
                const std::array<double, 3> value =
                    is_variance ? layer.variance(tile, i) : layer.mean(sums[i]);
                float* to = out.data() + place_of(t, i) * channels;
                for (size_t c = 0; c < 3; ++c) to[c] += to_float(value[c]);
            }
        }
    }
}

// As Cycles does, so that colour times light gives the picture.
void Film::divide_by_color(Pass pass, std::span<float> out) const {
    const Pass of_diffuse =
        pass < Pass::diffuse_indirect ? Pass::diffuse_direct : Pass::diffuse_indirect;
    const auto lobe =
        static_cast<Lobe>(static_cast<uint32_t>(pass) - static_cast<uint32_t>(of_diffuse));
    std::vector<float> color(out.size());
    read(pass_of(Pass::diffuse_color, lobe), color);
    for (size_t i = 0; i < out.size(); ++i) out[i] = color[i] > 0.0f ? out[i] / color[i] : 0.0f;
}

// Where there is no sample. What splats there is part of the preview already. With the lock.
void Film::show_preview(std::span<float> combined) const {
    const uint32_t across = (width_ + preview_block_ - 1) / preview_block_;
    for (uint32_t t = 0; t < tile_count(); ++t) {
        const size_t begin = first_pixel(t), count = pixel_count(t);
        const std::lock_guard lock(mutexes_[t]);
        for (size_t i = 0; i < count; ++i) {
            if (pixels_[begin + i].count > 0) continue;
            const size_t place = place_of(t, i);
            const size_t x = place % width_, y = place / width_;
            const std::array<float, 4>& color =
                preview_[y / preview_block_ * across + x / preview_block_];
            std::ranges::copy(color, combined.begin() + 4 * static_cast<ptrdiff_t>(place));
        }
    }
}

}  // namespace spc
