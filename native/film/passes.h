// SPDX-License-Identifier: GPL-3.0-or-later
// The passes of a picture: one table of their names, channels, and how they come from samples.
#pragma once

#include "film/cryptomatte.h"
#include "math/vec.h"

#include <array>
#include <cstdint>

namespace spc {

// Those of specula.h, with the same numbers.
enum class Pass : uint32_t {
    combined,
    depth,
    position,
    normal,
    caustics,
    variance,
    walk_success,
    walk_trials,
    uv,
    mist,
    object_index,
    material_index,
    emission,
    environment,
    diffuse_direct,
    glossy_direct,
    transmission_direct,
    diffuse_indirect,
    glossy_indirect,
    transmission_indirect,
    diffuse_color,
    glossy_color,
    transmission_color,
    denoising_albedo,
    denoising_normal,
    denoising_depth,
    sample_count,
    count
};
inline constexpr size_t kPasses = static_cast<size_t>(Pass::count);

enum class Accumulation : uint8_t {
    picture,        // of the sums that every film has
    mean,           // of the samples
    first,          // the value of the first sample: means of positions lie where no surface is
    ratio,          // sum of the values' x over that of their y
    light,          // mean, and what splats add
    light_by_color  // the same, divided by the mean of the lobe's colour
};

struct PassDesc {
    const char* name;      // as in Blender 5
    const char* channels;  // a letter each; at most 3 but for Combined
    Accumulation accumulation;
};
const PassDesc& describe(Pass pass);
uint32_t pass_channels(Pass pass);  // 0 for Pass::count

// The kinds of scattering that have passes of their own.
enum class Lobe : uint8_t { diffuse, glossy, transmission };
inline constexpr size_t kLobes = 3;
constexpr Pass pass_of(Pass of_diffuse, Lobe lobe) {
    return static_cast<Pass>(static_cast<uint32_t>(of_diffuse) + static_cast<uint32_t>(lobe));
}
// What part of some light each lobe scatters to the camera; the parts sum to one.
using LobeShares = std::array<Spectrum, kLobes>;
inline LobeShares only(Lobe lobe) {
    LobeShares shares{Spectrum(0.0f), Spectrum(0.0f), Spectrum(0.0f)};
    shares[static_cast<size_t>(lobe)] = Spectrum(1.0f);
    return shares;
}

class PassSet {
public:
    PassSet() = default;
    explicit PassSet(uint64_t bits) : bits_(bits) {}
    bool has(Pass pass) const { return (bits_ & bit(pass)) != 0; }
    bool has_any(Pass first, Pass last) const {  // of those from one to another
        return (bits_ & ((bit(last) << 1) - bit(first))) != 0;
    }
    void add(Pass pass) { bits_ |= bit(pass); }
    uint64_t bits() const { return bits_; }
    // Whether some pass asks by which lobe light comes to the camera.
    bool tell_lobes() const { return has_any(Pass::emission, Pass::transmission_indirect); }
    bool tell_colors() const { return has_any(Pass::diffuse_color, Pass::transmission_color); }
    bool tell_features() const { return has_any(Pass::denoising_albedo, Pass::denoising_depth); }
    // With the colours that others are divided by.
    PassSet with_colors() const;

private:
    static constexpr uint64_t bit(Pass pass) { return uint64_t{1} << static_cast<uint32_t>(pass); }
    uint64_t bits_ = 0;
};
static_assert(kPasses < 64);

// What one sample has for each pass; of fewer channels than three the first count.
class PassValues {
public:
    explicit PassValues(PassSet asked, bool wants_coverage = false)
        : asked_(asked), wants_coverage_(wants_coverage) {
        values_.fill(Vec3(0.0f));
    }
    PassSet asked() const { return asked_; }
    bool wants_coverage() const { return wants_coverage_; }
    Coverage coverage;
    Vec3& operator[](Pass pass) { return values_[static_cast<size_t>(pass)]; }
    const Vec3& operator[](Pass pass) const { return values_[static_cast<size_t>(pass)]; }

    // Adds light that lobes scatter to the camera, to the passes of direct or of indirect light.
    void add_scattered(const Spectrum& value, const LobeShares& shares, bool direct) {
        const Pass first = direct ? Pass::diffuse_direct : Pass::diffuse_indirect;
        for (size_t i = 0; i < kLobes; ++i)
            (*this)[pass_of(first, static_cast<Lobe>(i))] += value * shares[i];
    }

private:
    PassSet asked_;
    bool wants_coverage_;
    std::array<Vec3, kPasses> values_;
};

}  // namespace spc
