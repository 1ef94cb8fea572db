// SPDX-License-Identifier: GPL-3.0-or-later
// The passes of a picture: one table of their names, channels, and how they come from samples.
#pragma once

#include "film/cryptomatte.h"
#include "math/vec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

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

// Passes whose number the artist chooses. Their values of Pass lie beyond those of the table: those
// of each kind follow one another from first_of() on.
enum class CustomKind : uint8_t { light_group, color_aov, value_aov };
inline constexpr size_t kCustomKinds = 3;
inline constexpr uint32_t kMostCustom = 256;  // of a kind
constexpr Pass first_of(CustomKind kind) {
    return static_cast<Pass>((static_cast<uint32_t>(kind) + 1) * kMostCustom);
}
constexpr Pass pass_of(CustomKind kind, uint32_t index) {
    return static_cast<Pass>(static_cast<uint32_t>(first_of(kind)) + index);
}
static_assert(kPasses <= kMostCustom);

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
    const char* channels;  // a letter each; at most 4
    Accumulation accumulation;
};
const PassDesc& describe(Pass pass);  // of a custom one, what its kind has
bool is_pass(uint32_t number);        // of the table or custom
uint32_t pass_channels(Pass pass);

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

inline constexpr uint32_t kNoGroup = 0xffffffffu;  // of lights that are in no group

// How many there are of each kind.
struct CustomCounts {
    std::array<uint32_t, kCustomKinds> of{};

    uint32_t operator[](CustomKind kind) const { return of[static_cast<size_t>(kind)]; }
    uint32_t sum() const { return of[0] + of[1] + of[2]; }
    bool operator==(const CustomCounts&) const = default;
};

class PassSet {
public:
    PassSet() = default;
    // `bits`: of the table's, `custom`: the others.
    explicit PassSet(uint64_t bits, CustomCounts custom = {}) : bits_(bits), custom_(custom) {}
    bool operator==(const PassSet&) const = default;
    bool has(Pass pass) const {
        if (pass < Pass::count) return (bits_ & bit(pass)) != 0;
        return custom_index(pass) < custom_[kind_of(pass)];
    }
    bool has_any(Pass first, Pass last) const {  // of those from one to another
        return (bits_ & ((bit(last) << 1) - bit(first))) != 0;
    }
    void add(Pass pass) { bits_ |= bit(pass); }
    uint64_t bits() const { return bits_; }
    const CustomCounts& custom() const { return custom_; }
    // All values of passes lie in a row: those of the table, asked for or not, then the custom
    // ones.
    size_t slots() const { return kPasses + custom_.sum(); }
    size_t slot(Pass pass) const {
        if (pass < Pass::count) return static_cast<size_t>(pass);
        size_t first = kPasses;
        for (size_t kind = 0; kind < static_cast<size_t>(kind_of(pass)); ++kind)
            first += custom_.of[kind];
        return first + custom_index(pass);
    }
    // Visits those that are asked for, in the order of their slots.
    template <class Visit>
    void each(const Visit& visit) const {
        for (uint32_t i = 0; i < kPasses; ++i)
            if (has(static_cast<Pass>(i))) visit(static_cast<Pass>(i));
        for (size_t kind = 0; kind < kCustomKinds; ++kind)
            for (uint32_t i = 0; i < custom_.of[kind]; ++i)
                visit(pass_of(static_cast<CustomKind>(kind), i));
    }
    // Whether some pass takes light apart.
    bool tell_light() const { return tell_lobes() || custom_[CustomKind::light_group] > 0; }
    bool tell_aovs() const {
        return custom_[CustomKind::color_aov] + custom_[CustomKind::value_aov] > 0;
    }
    // Whether some pass asks by which lobe light comes to the camera.
    bool tell_lobes() const { return has_any(Pass::emission, Pass::transmission_indirect); }
    bool tell_colors() const { return has_any(Pass::diffuse_color, Pass::transmission_color); }
    bool tell_features() const { return has_any(Pass::denoising_albedo, Pass::denoising_depth); }
    // With the colours that others are divided by.
    PassSet with_colors() const;

private:
    static constexpr uint64_t bit(Pass pass) { return uint64_t{1} << static_cast<uint32_t>(pass); }
    static constexpr CustomKind kind_of(Pass pass) {
        return static_cast<CustomKind>(static_cast<uint32_t>(pass) / kMostCustom - 1);
    }
    static constexpr uint32_t custom_index(Pass pass) {
        return static_cast<uint32_t>(pass) % kMostCustom;
    }
    uint64_t bits_ = 0;
    CustomCounts custom_;
};
static_assert(kPasses < 64);

// What one sample has for a pass; of fewer channels than four the first count.
struct PassValue {
    Vec3 rgb{0.0f};
    float alpha = 0.0f;

    float operator[](uint32_t channel) const {
        return channel < 3 ? rgb[static_cast<int>(channel)] : alpha;
    }
};

// What one sample has for each pass.
class PassValues {
public:
    explicit PassValues(const PassSet& asked, bool wants_coverage = false)
        : asked_(asked), wants_coverage_(wants_coverage), values_(asked.slots()) {}
    const PassSet& asked() const { return asked_; }
    bool wants_coverage() const { return wants_coverage_; }
    // For another sample.
    void clear() {
        coverage.clear();
        std::fill(values_.begin(), values_.end(), PassValue{});
    }
    Coverage coverage;
    Vec3& operator[](Pass pass) { return value(pass).rgb; }
    const Vec3& operator[](Pass pass) const { return values_[asked_.slot(pass)].rgb; }
    PassValue& value(Pass pass) { return values_[asked_.slot(pass)]; }
    const PassValue& at(size_t slot) const { return values_[slot]; }

    // Adds light that lobes scatter to the camera, to the passes of direct or of indirect light.
    void add_scattered(const Spectrum& value, const LobeShares& shares, bool direct) {
        const Pass first = direct ? Pass::diffuse_direct : Pass::diffuse_indirect;
        for (size_t i = 0; i < kLobes; ++i)
            (*this)[pass_of(first, static_cast<Lobe>(i))] += value * shares[i];
    }
    // Adds light of a group of lights, or of none.
    void add_to_group(uint32_t group, const Spectrum& value) {
        if (group != kNoGroup) (*this)[pass_of(CustomKind::light_group, group)] += value;
    }

private:
    PassSet asked_;
    bool wants_coverage_;
    std::vector<PassValue> values_;  // by slot
};

}  // namespace spc
