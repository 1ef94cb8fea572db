// SPDX-License-Identifier: GPL-3.0-or-later
// Which objects, materials and assets a pixel shows, and how much of each: Cryptomatte
// [Friedman15].
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace spc {

enum class CryptoKind : uint8_t { object, material, asset };
inline constexpr size_t kCryptoKinds = 3;
// Identifiers of what a surface is, one of each kind; 0: none.
using CryptoIds = std::array<float, kCryptoKinds>;

// What a film keeps: the kinds whose bits 1 << CryptoKind are set, and how many identifiers a pixel
// shows of each.
struct CryptoRequest {
    uint32_t kinds = 0, ranks = 0;
    bool any() const { return kinds != 0 && ranks > 0; }
    bool has(CryptoKind kind) const { return (kinds >> static_cast<uint32_t>(kind) & 1u) != 0; }
    // Twice as many are counted as are shown: what is small at first may grow.
    uint32_t slots() const { return 2 * ranks; }
    bool operator==(const CryptoRequest&) const = default;
};
inline constexpr uint32_t kMostCryptoRanks = 16;

// A share of a pixel, as a whole number, so that sums do not depend on their order.
struct CryptoSlot {
    float id = 0.0f;
    uint32_t weight = 0;  // in kCryptoUnit
};
inline constexpr float kCryptoUnit = 0x1p-14f;

// Adds to the slot of the identifier, or to an empty one; a pixel with more identifiers than slots
// loses the last that come.
void add_coverage(std::span<CryptoSlot> slots, float id, uint32_t weight);

// What a sample shows, in the order of its surfaces.
class Coverage {
public:
    struct Part {
        CryptoIds ids;
        uint32_t weight;
    };
    // `share` of the sample; further surfaces than kMost are lost.
    void add(const CryptoIds& ids, float share);
    void clear() { count_ = 0; }
    std::span<const Part> parts() const { return {parts_.data(), count_}; }

private:
    static constexpr size_t kMost = 8;
    std::array<Part, kMost> parts_;
    size_t count_ = 0;
};

// Of the two ranks from 2 * `level` on: identifier, share, identifier, share; the largest share
// first.
std::array<float, 4> crypto_level(std::span<const CryptoSlot> slots, uint32_t level,
                                  uint32_t samples);

}  // namespace spc
