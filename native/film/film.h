// SPDX-License-Identifier: GPL-3.0-or-later
// Accumulates samples of every pixel, and what light paths splat. Sums depend neither on threads
// and tiles nor on how samples are grouped, so that films of parts of the samples add up to the
// film of all.
#pragma once

#include "film/filter.h"
#include "film/passes.h"
#include "film/sparse_columns.h"

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace spc {

// Whether sums of such values and of their squares are finite; others are dropped and counted.
inline bool can_be_held(const Spectrum& value) {
    constexpr float kBrightest = 1e18f;
    return std::abs(value.x) + std::abs(value.y) + std::abs(value.z) <= kBrightest;
}

// What every film has of a pixel; each sum with what it has rounded away (film/exact_sum.h).
struct PixelSums {
    std::array<double, 3> radiance{}, radiance_squared{};
    double alpha = 0.0;
    std::array<double, 3> radiance_squared_low{};  // squares have twice as many digits
    double alpha_low = 0.0;
    std::array<float, 3> radiance_low{};
    uint32_t count = 0;
};

// Variance of one sample, averaged over pixels and channels. Empty if a pixel has fewer than two
// samples.
std::optional<double> sample_variance(std::span<const PixelSums> pixels);

// Of every second sample of a pixel, to tell its error.
struct HalfSums {
    std::array<double, 3> radiance{};
};
// Error of a pixel's mean as Cycles measures it for adaptive sampling: the difference between the
// means of all and of every second sample, over the root of their sum of channels where that is
// below 1, else over the sum.
float relative_error(const PixelSums& all, const HalfSums& half);

struct FilmSample {
    Spectrum radiance;
    float alpha;
    const PassValues* values = nullptr;  // null where the film has no other passes
};

// What a path adds at a point of the film: radiance times pixels^2.
struct Splat {
    Vec2 film;  // pixels of the full frame
    Spectrum value;
    LobeShares shares = only(Lobe::diffuse);
    uint32_t light_group = kNoGroup;
    bool direct = false;  // light whose only scattering is that towards the camera
    Vec2 u{0.5f};         // uniform, to draw the one pixel that takes it
};

enum class SplatSource : uint8_t { light_paths, camera_chains, missed_camera_chains };
inline constexpr size_t kSplatSources = 3;

// How a splat falls on the pixels whose filter reaches it: on all of them, with less noise in each,
// or on one that is drawn, so that errors of neighbours are independent, as denoisers expect.
enum class SplatSpread : uint8_t { all_pixels, one_pixel };

// Whether splats have sums of their own for the pass. What splats is scattered towards the camera,
// so it is neither emission nor environment; and all that light paths splat is caustics.
bool takes_splats(Pass pass);

inline bool operator==(const CryptoSlot& a, const CryptoSlot& b) {
    return a.id == b.id && a.weight == b.weight;
}

class Film {
public:
    static constexpr uint32_t kTileSize = 16;

    // Has planes for the passes that are asked for alone, and memory where they are not zero.
    Film(uint32_t width, uint32_t height, PassSet passes = PassSet(),
         SplatSpread spread = SplatSpread::all_pixels, CryptoRequest crypto = {},
         bool keeps_halves = false);
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t tile_count() const { return static_cast<uint32_t>(mutexes_.size()); }
    const PassSet& passes() const { return passes_; }
    SplatSpread spread() const { return spread_; }
    // Whether samples need values for passes.
    bool has_planes() const { return !planes_.empty() || crypto_.any(); }
    const CryptoRequest& crypto() const { return crypto_; }

    struct TileBounds {
        uint32_t x0, y0, width, height;
    };
    TileBounds bounds(uint32_t tile) const;
    // A worker takes a copy, adds samples, and puts it back; readers meanwhile see the state
    // before.
    struct TileSums {
        std::vector<PixelSums> pixels;
        std::vector<double> high;  // of the planes, pixel after pixel
        std::vector<float> low;
        std::vector<CryptoSlot> coverage;
        std::vector<HalfSums> halves;
    };
    TileSums copy_tile(uint32_t tile) const;
    void store_tile(uint32_t tile, const TileSums& sums);
    void accumulate(TileSums& tile, size_t pixel, const FilmSample& sample) const;

    // Adds the splats of `estimates` estimates; their positions are relative to the film's corner.
    // A picture is the sum over `per_picture` estimates of a source, always the same, averaged over
    // all estimates that were added.
    void add_splats(SplatSource source, std::span<const Splat> splats, const PixelFilter& filter,
                    uint64_t estimates, double per_picture);

    // A coarse picture, which stands for pixels that have no sample yet: one RGBA for each block of
    // so many pixels, row after row. Not to be called twice.
    void set_preview(uint32_t block, std::vector<std::array<float, 4>> colors);

    // float[height][width][channels], bottom row first. `pass` must have been asked for, or be one
    // of what every film has.
    bool can_read(Pass pass) const;
    // All sums as bytes, and a film of such bytes; throws Error if they are none. No renders may be
    // under way.
    std::vector<std::byte> to_bytes() const;
    static std::unique_ptr<Film> from_bytes(std::span<const std::byte> bytes);
    // Adds the sums of a film of other samples of the same picture; with `earlier`, of samples
    // before these. Throws Error if it has another size or other passes.
    void add(const Film& other, bool earlier);
    void read(Pass pass, std::span<float> out) const;
    // float[height][width][4], bottom row first: crypto_level() of each pixel. The film must have
    // been asked for the kind.
    void read_crypto(CryptoKind kind, uint32_t level, std::span<float> out) const;

private:
    // Where a pass lies in the sums of a pixel. First values lie in `low` alone.
    struct Plane {
        Pass pass;
        Accumulation how;
        size_t slot;  // PassSet::slot()
        uint32_t channels, high, low;
    };
    // What the passes have of a tile.
    struct TilePlanes {
        SparseColumns<double> high;
        SparseColumns<float> low;
        SparseColumns<CryptoSlot> coverage;
    };
    struct SplatSums {
        std::array<double, 3> high{}, low{};  // shares of a splat differ by far
        void add(const Spectrum& value);
        bool operator==(const SplatSums&) const = default;
    };
    // Pixel after pixel; each is empty until a splat has something for it.
    struct SplatTile {
        std::vector<SplatSums> picture, squared;
        std::vector<std::vector<SplatSums>> passes;  // by slot
    };
    struct SplatLayer {
        std::vector<SplatTile> tiles;  // none if there are no splats
        double estimates = 0.0, per_picture = 1.0;
        double pictures() const { return estimates / per_picture; }
        std::array<double, 3> mean(const SplatSums& sums) const;
        std::array<double, 3> variance(const SplatTile& tile, size_t pixel) const;
    };

    SplatLayer& layer_of(SplatSource source);
    size_t byte_count(uint32_t sources) const;
    void add_tile(TileSums& tile, const TileSums& other, bool earlier) const;
    // Visits all sums of a tile that there may be, empty or not.
    template <class Tile, class Visit>
    void each_splat_sums(Tile& tile, const Visit& visit) const;
    const Plane* plane_of(Pass pass) const;
    void add_plane(Pass pass);
    size_t crypto_stride() const;
    // Visits the kinds that are kept, with the place of their first slot in a pixel's.
    template <class Visit>
    void each_crypto_kind(const Visit& visit) const;
    size_t first_pixel(uint32_t tile) const;
    size_t pixel_count(uint32_t tile) const {
        return static_cast<size_t>(bounds(tile).width) * bounds(tile).height;
    }
    // Row after row, of a pixel of a tile.
    size_t place_of(uint32_t tile, size_t in_tile) const {
        const TileBounds b = bounds(tile);
        return (b.y0 + in_tile / b.width) * width_ + b.x0 + in_tile % b.width;
    }
    void write_pixel(Pass pass, size_t pixel, const TilePlanes& planes, size_t in_tile,
                     float* out) const;
    void add_to_pixel(SplatLayer& layer, size_t x, size_t y, const Splat& splat, float weight) const;
    void add_splat_passes(Pass pass, std::span<float> out) const;
    void divide_by_color(Pass pass, std::span<float> out) const;
    void show_preview(std::span<float> combined) const;

    uint32_t width_, height_, tiles_across_;
    PassSet passes_;
    SplatSpread spread_;
    CryptoRequest crypto_;
    std::vector<Plane> planes_;
    uint32_t high_stride_ = 0, low_stride_ = 0;
    // Tile after tile; one block each: too large a frame fails at once.
    std::vector<PixelSums> pixels_;
    std::vector<HalfSums> halves_;  // empty unless they are kept
    std::vector<TilePlanes> tile_planes_;
    mutable std::vector<std::mutex> mutexes_;  // of each tile

    mutable std::mutex splat_mutex_;  // guards them, and the preview
    std::array<SplatLayer, kSplatSources> splats_;
    uint32_t preview_block_ = 0;  // pixels; 0: there is none
    std::vector<std::array<float, 4>> preview_;
};

template <class Tile, class Visit>
void Film::each_splat_sums(Tile& tile, const Visit& visit) const {
    visit(tile.picture);
    visit(tile.squared);
    for (const Plane& plane : planes_)
        if (takes_splats(plane.pass)) visit(tile.passes[plane.slot]);
}

template <class Visit>
void Film::each_crypto_kind(const Visit& visit) const {
    size_t at = 0;
    for (size_t i = 0; i < kCryptoKinds; ++i)
        if (crypto_.has(static_cast<CryptoKind>(i))) {
            visit(i, at);
            at += crypto_.slots();
        }
}

}  // namespace spc
