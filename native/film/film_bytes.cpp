// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of a film as bytes, for renders that are divided, merged and gone on with.
#include "core/error.h"
#include "film/exact_sum.h"
#include "film/film.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace spc {

namespace {

constexpr uint32_t kMagic = 0x73637073, kFormat = 3;

struct Header {
    uint32_t magic = kMagic, format = kFormat;
    uint32_t width = 0, height = 0;
    uint64_t passes = 0;
    CustomCounts custom;
    uint32_t spread = 0;
    uint32_t sources = 0;  // bits of those that have splats
    CryptoRequest crypto{};
    uint32_t unused = 0;  // no bytes lie between fields
};
static_assert(sizeof(Header) == 4 * 4 + 8 + 4 * kCustomKinds + 2 * 4 + 2 * 4 + 4);

[[noreturn]] void refuse(const char* why) { throw Error(ErrorKind::invalid_argument, why); }

class Writer {
public:
    explicit Writer(size_t bytes) { bytes_.reserve(bytes); }
    template <class T>
    void one(const T& value) {
        many(&value, 1);
    }
    template <class T>
    void many(const T* values, size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* begin = reinterpret_cast<const std::byte*>(values);
        bytes_.insert(bytes_.end(), begin, begin + count * sizeof(T));
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    std::vector<std::byte> bytes_;
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <class T>
    void one(T& value) {
        many(&value, 1);
    }
    template <class T>
    void many(T* values, size_t count) {
        if (bytes_.size() < count * sizeof(T)) refuse("sums end too early");
        if (count > 0)  // of none there is no address
            std::memcpy(static_cast<void*>(values), bytes_.data(), count * sizeof(T));
        bytes_ = bytes_.subspan(count * sizeof(T));
    }
    bool at_end() const { return bytes_.empty(); }

private:
    std::span<const std::byte> bytes_;
};

}  // namespace

size_t Film::byte_count(uint32_t sources) const {
    const size_t of_pixel = sizeof(PixelSums) + high_stride_ * sizeof(double) +
                            low_stride_ * sizeof(float) + crypto_stride() * sizeof(CryptoSlot);
    const auto passes =
        std::ranges::count_if(planes_, [](const Plane& plane) { return takes_splats(plane.pass); });
    const size_t splats = (2 + static_cast<size_t>(passes)) * sizeof(SplatSums);
    const auto layers = static_cast<size_t>(std::popcount(sources));
    return sizeof(Header) + pixels_.size() * (of_pixel + layers * splats) +
           layers * 2 * sizeof(double);
}

std::vector<std::byte> Film::to_bytes() const {
    static_assert(sizeof(PixelSums) == 11 * 8 + 3 * 4 + 4, "bytes between fields would be written");
    const std::lock_guard lock(splat_mutex_);
    Header header;
    header.width = width_;
    header.height = height_;
    header.passes = passes_.bits();
    header.custom = passes_.custom();
    header.spread = static_cast<uint32_t>(spread_);
    header.crypto = crypto_;
    for (size_t i = 0; i < kSplatSources; ++i)
        if (!splats_[i].tiles.empty()) header.sources |= 1u << i;
    Writer writer(byte_count(header.sources));
    writer.one(header);
    for (uint32_t t = 0; t < tile_count(); ++t) {
        const TileSums tile = copy_tile(t);
        writer.many(tile.pixels.data(), tile.pixels.size());
        writer.many(tile.high.data(), tile.high.size());
        writer.many(tile.low.data(), tile.low.size());
        writer.many(tile.coverage.data(), tile.coverage.size());
    }
    const std::vector<SplatSums> none(size_t{kTileSize} * kTileSize);
    for (const SplatLayer& layer : splats_) {
        if (layer.tiles.empty()) continue;
        writer.one(layer.estimates);
        writer.one(layer.per_picture);
        for (uint32_t t = 0; t < tile_count(); ++t)
            each_splat_sums(layer.tiles[t], [&](const std::vector<SplatSums>& sums) {
                writer.many((sums.empty() ? none : sums).data(), pixel_count(t));
            });
    }
    return writer.take();
}

std::unique_ptr<Film> Film::from_bytes(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    Header header;
    reader.one(header);
    if (header.magic != kMagic || header.format != kFormat) refuse("these are no sums of a film");
    const PassSet passes(header.passes, header.custom);
    const uint64_t pixels = uint64_t{header.width} * header.height;
    constexpr size_t kLeastBytes =
        sizeof(double) + sizeof(float);  // that a custom pass has of a pixel
    if (header.passes >> kPasses != 0 || header.sources >> kSplatSources != 0 || header.spread > 1 ||
        std::ranges::any_of(header.custom.of, [](uint32_t n) { return n > kMostCustom; }) ||
        header.crypto.kinds >> kCryptoKinds != 0 || header.crypto.ranks > kMostCryptoRanks ||
        pixels == 0 ||
        pixels > bytes.size() / (sizeof(PixelSums) + kLeastBytes * header.custom.sum()))
        refuse("the sums' header is damaged");
    auto film = std::make_unique<Film>(header.width, header.height, passes,
                                       static_cast<SplatSpread>(header.spread), header.crypto);
    for (uint32_t t = 0; t < film->tile_count(); ++t) {
        TileSums tile = film->copy_tile(t);
        reader.many(tile.pixels.data(), tile.pixels.size());
        reader.many(tile.high.data(), tile.high.size());
        reader.many(tile.low.data(), tile.low.size());
        reader.many(tile.coverage.data(), tile.coverage.size());
        film->store_tile(t, tile);
    }
    for (size_t i = 0; i < kSplatSources; ++i) {
        if ((header.sources & 1u << i) == 0) continue;
        SplatLayer& layer = film->layer_of(static_cast<SplatSource>(i));
        reader.one(layer.estimates);
        reader.one(layer.per_picture);
        for (uint32_t t = 0; t < film->tile_count(); ++t)
            film->each_splat_sums(layer.tiles[t], [&](std::vector<SplatSums>& sums) {
                std::vector<SplatSums> read(film->pixel_count(t));
                reader.many(read.data(), read.size());
                if (std::ranges::any_of(read,
                                        [](const SplatSums& one) { return one != SplatSums{}; }))
                    sums = std::move(read);
            });
    }
    if (!reader.at_end()) refuse("sums are longer than they should be");
    return film;
}

namespace {

template <class High, class Low>
void add_all(High& high, Low& low, const High& other_high, const Low& other_low) {
    for (size_t i = 0; i < high.size(); ++i) {
        add_exactly(high[i], low[i], other_high[i]);
        add_exactly(high[i], low[i], static_cast<double>(other_low[i]));
    }
}

}  // namespace

void Film::add(const Film& other, bool earlier) {
    if (other.width_ != width_ || other.height_ != height_ || other.passes_ != passes_ ||
        other.spread_ != spread_ || other.crypto_ != crypto_)
        refuse("the sums are those of another picture");
    for (uint32_t t = 0; t < tile_count(); ++t) {
        TileSums tile = copy_tile(t);
        add_tile(tile, other.copy_tile(t), earlier);
        store_tile(t, tile);
    }
    for (size_t i = 0; i < kSplatSources; ++i) {
        const SplatLayer& from = other.splats_[i];
        if (from.tiles.empty()) continue;
        SplatLayer& to = layer_of(static_cast<SplatSource>(i));
        if (to.estimates > 0.0 && to.per_picture != from.per_picture)
            refuse("the sums have other numbers of light paths");
        to.estimates += from.estimates;
        to.per_picture = from.per_picture;
        const auto add_sums = [](std::vector<SplatSums>& sums, const std::vector<SplatSums>& others) {
            if (sums.size() < others.size()) sums.resize(others.size());
            for (size_t at = 0; at < others.size(); ++at)
                add_all(sums[at].high, sums[at].low, others[at].high, others[at].low);
        };
        for (uint32_t t = 0; t < tile_count(); ++t) {
            add_sums(to.tiles[t].picture, from.tiles[t].picture);
            add_sums(to.tiles[t].squared, from.tiles[t].squared);
            for (size_t slot = 0; slot < passes_.slots(); ++slot)
                add_sums(to.tiles[t].passes[slot], from.tiles[t].passes[slot]);
        }
    }
}

void Film::add_tile(TileSums& tile, const TileSums& other, bool earlier) const {
    for (size_t at = 0; at < tile.pixels.size(); ++at) {
        PixelSums& to = tile.pixels[at];
        const PixelSums& from = other.pixels[at];
        const bool takes_first = from.count > 0 && (earlier || to.count == 0);
        add_all(to.radiance, to.radiance_low, from.radiance, from.radiance_low);
        add_all(to.radiance_squared, to.radiance_squared_low, from.radiance_squared,
                from.radiance_squared_low);
        add_exactly(to.alpha, to.alpha_low, from.alpha);
        add_exactly(to.alpha, to.alpha_low, from.alpha_low);
        to.count += from.count;
        for (const Plane& plane : planes_)
            for (uint32_t c = 0; c < plane.channels; ++c) {
                const size_t low = at * low_stride_ + plane.low + c;
                if (plane.how == Accumulation::first) {
                    if (takes_first) tile.low[low] = other.low[low];
                    continue;
                }
                const size_t high = at * high_stride_ + plane.high + c;
                add_exactly(tile.high[high], tile.low[low], other.high[high]);
                add_exactly(tile.high[high], tile.low[low], static_cast<double>(other.low[low]));
            }
    }
    for (size_t at = 0; at < tile.coverage.size(); at += crypto_.slots())
        for (const CryptoSlot& slot : std::span(other.coverage).subspan(at, crypto_.slots()))
            if (slot.weight > 0)
                add_coverage(std::span(tile.coverage).subspan(at, crypto_.slots()), slot.id,
                             slot.weight);
}

}  // namespace spc
