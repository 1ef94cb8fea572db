// SPDX-License-Identifier: GPL-3.0-or-later
// Accumulates samples of every pixel, and what light paths splat, in the order of their index, so
// that sums do not depend on threads or tiles.
#pragma once

#include "film/filter.h"
#include "math/vec.h"

#include <mutex>
#include <span>
#include <vector>

namespace spc {

// Whether sums of such values and of their squares are finite; others are dropped and counted.
inline bool can_be_held(const Spectrum& value) {
    constexpr float kBrightest = 1e18f;
    return std::abs(value.x) + std::abs(value.y) + std::abs(value.z) <= kBrightest;
}

// Newton walks and Bernoulli trials that the manifold made for a sample or a pixel.
struct WalkCounts {
    uint64_t walks = 0, converged = 0;
    uint64_t trial_estimates = 0, trials = 0;

    void add(const WalkCounts& other) {
        walks += other.walks;
        converged += other.converged;
        trial_estimates += other.trial_estimates;
        trials += other.trials;
    }
};

struct PixelSums {
    std::array<double, 3> radiance{}, radiance_squared{};
    std::array<float, 3> caustics{}, normal{}, position{};
    float alpha = 0.0f;
    float depth = 1e10f;
    WalkCounts walks;
    uint32_t count = 0;
};

struct FilmSample {
    Spectrum radiance, caustics;
    Vec3 position, normal;
    float alpha, depth;
    WalkCounts walks;
};
void accumulate(PixelSums& pixel, const FilmSample& sample);

// The passes of specula.h, with the same numbers.
enum class Pass : uint32_t {
    combined,
    depth,
    position,
    normal,
    caustics,
    variance,
    walk_success,
    walk_trials,
    count
};
uint32_t pass_channels(Pass pass);

// What a path adds at a point of the film: radiance times pixels^2.
struct Splat {
    Vec2 film;  // pixels of the full frame
    Spectrum value;
};

enum class SplatSource : uint8_t { light_paths, camera_chains, missed_camera_chains };

class Film {
public:
    static constexpr uint32_t kTileSize = 16;

    Film(uint32_t width, uint32_t height);
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t tile_count() const { return static_cast<uint32_t>(mutexes_.size()); }

    struct TileBounds {
        uint32_t x0, y0, width, height;
    };
    TileBounds bounds(uint32_t tile) const;
    // A worker takes a copy, adds samples, and puts it back; readers meanwhile see the state
    // before.
    std::vector<PixelSums> copy_tile(uint32_t tile) const;
    void store_tile(uint32_t tile, std::span<const PixelSums> pixels);

    // Adds the splats of `estimates` estimates; their positions are relative to the film's corner. A picture
    // is the sum over `per_picture` estimates of a source, averaged over all estimates that were added.
    void add_splats(SplatSource source, std::span<const Splat> splats, const PixelFilter& filter,
                    uint64_t estimates, double per_picture);

    // A coarse picture, which stands for pixels that have no sample yet: one RGBA for each block of so
    // many pixels, row after row. Not to be called twice.
    void set_preview(uint32_t block, std::vector<std::array<float, 4>> colors);

    // float[height][width][channels], bottom row first.
    void read(Pass pass, std::span<float> out) const;

private:
    void show_preview(std::span<float> combined) const;
    std::span<PixelSums> tile_pixels(uint32_t tile);
    std::span<const PixelSums> tile_pixels(uint32_t tile) const;

    uint32_t width_, height_, tiles_across_;
    std::vector<PixelSums> pixels_;  // tile after tile; one block: too large a frame fails at once
    mutable std::vector<std::mutex> mutexes_;  // of each tile

    // Row after row; no pixels until there are some.
    struct SplatSums {
        std::array<double, 3> value{}, squared{};
    };
    struct SplatMean {  // of a pixel
        std::array<double, 3> value{}, variance{};
    };
    struct SplatLayer {
        std::vector<SplatSums> pixels;
        double estimates = 0.0, pictures = 0.0;
        SplatMean mean(size_t pixel) const;
    };
    mutable std::mutex splat_mutex_;    // guards them, and the preview
    std::array<SplatLayer, 3> splats_;  // of each SplatSource
    uint32_t preview_block_ = 0;        // pixels; 0: there is none
    std::vector<std::array<float, 4>> preview_;
};

}  // namespace spc
