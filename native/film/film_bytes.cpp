// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of a film as bytes, for renders that are divided, merged and gone on with.
#include "core/error.h"
#include "film/exact_sum.h"
#include "film/film.h"

#include <algorithm>
#include <cstring>

namespace spc {

namespace {

constexpr uint32_t kMagic = 0x73637073, kFormat = 2;

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

// Visits all numbers of the splats of one source, in one order for reading and writing.
template <class Way, class Layer>
void exchange(Way& way, Layer& layer) {
    way.one(layer.estimates);
    way.one(layer.per_picture);
    const auto all = [&](auto& sums) {
        for (auto& pixel : sums) {
            way.many(pixel.high.data(), pixel.high.size());
            way.many(pixel.low.data(), pixel.low.size());
        }
    };
    all(layer.picture);
    all(layer.squared);
    for (auto& pass : layer.passes) all(pass);
}

}  // namespace

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
        if (!splats_[i].picture.empty()) header.sources |= 1u << i;
    Writer writer;
    writer.one(header);
    writer.many(pixels_.data(), pixels_.size());
    writer.many(high_.data(), high_.size());
    writer.many(low_.data(), low_.size());
    writer.many(coverage_.data(), coverage_.size());
    for (const SplatLayer& layer : splats_)
        if (!layer.picture.empty()) exchange(writer, layer);
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
    reader.many(film->pixels_.data(), film->pixels_.size());
    reader.many(film->high_.data(), film->high_.size());
    reader.many(film->low_.data(), film->low_.size());
    reader.many(film->coverage_.data(), film->coverage_.size());
    for (size_t i = 0; i < kSplatSources; ++i)
        if ((header.sources & 1u << i) != 0)
            exchange(reader, film->layer_of(static_cast<SplatSource>(i)));
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
    for (size_t at = 0; at < pixels_.size(); ++at) {
        PixelSums& to = pixels_[at];
        const PixelSums& from = other.pixels_[at];
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
                    if (takes_first) low_[low] = other.low_[low];
                    continue;
                }
                double& high = high_[at * high_stride_ + plane.high + c];
                add_exactly(high, low_[low], other.high_[at * high_stride_ + plane.high + c]);
                add_exactly(high, low_[low], static_cast<double>(other.low_[low]));
            }
    }
    for (size_t at = 0; at < coverage_.size(); at += crypto_.slots())
        for (const CryptoSlot& slot : std::span(other.coverage_).subspan(at, crypto_.slots()))
            if (slot.weight > 0)
                add_coverage(std::span(coverage_).subspan(at, crypto_.slots()), slot.id,
                             slot.weight);
    for (size_t i = 0; i < kSplatSources; ++i) {
        const SplatLayer& from = other.splats_[i];
        if (from.picture.empty()) continue;
        SplatLayer& to = layer_of(static_cast<SplatSource>(i));
        if (to.estimates > 0.0 && to.per_picture != from.per_picture)
            refuse("the sums have other numbers of light paths");
        to.estimates += from.estimates;
        to.per_picture = from.per_picture;
        const auto all = [](std::vector<SplatSums>& sums, const std::vector<SplatSums>& others) {
            for (size_t at = 0; at < sums.size(); ++at)
                add_all(sums[at].high, sums[at].low, others[at].high, others[at].low);
        };
        all(to.picture, from.picture);
        all(to.squared, from.squared);
        for (size_t slot = 0; slot < passes_.slots(); ++slot)
            all(to.passes[slot], from.passes[slot]);
    }
}

}  // namespace spc
