// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers keyed by what they are for. A Sampler is a value: (seed, pixel, purpose) hashed to
// a key, and the absolute sample index. Each purpose draws from its own Owen-scrambled Sobol
// sequence with a shuffled index [Burley20], so every draw is stratified over the samples of a
// pixel, in all its dimensions together, and independent of every other draw.
#pragma once

#include "math/vec.h"

#include <array>
#include <bit>

namespace spc {

// What a draw is for; one entry per decision of a path vertex.
enum class Domain : uint32_t {
    film,
    closure,
    light,
    roulette,
    manifold_light,
    manifold_caster,
    manifold_seeds,
    lens,
    light_point,
    light_direction,
    manifold_activation,
    light_goes_on,
    glints,
    rough_chain_light,
    rough_chain_seeds,
    rough_chain_activation,
    camera_chain_light,
    camera_chain_seeds,
    missed_chains,
    folds,
    even_light,
    splat,
    subsurface
};

inline uint64_t mix_bits(uint64_t x) {  // a bijection with good avalanche, [Stafford11] variant 13
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

inline uint32_t reverse_bits(uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
}

// Owen scrambling of a number whose bits are reversed, [Laine11] with the constants of [Vegdahl21].
inline uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Pascal's triangle modulo 2 applied to the index: the second dimension of Sobol's sequence, bits
// reversed.
inline uint32_t pascal_reversed(uint32_t x) {
    x ^= x >> 16;
    x ^= (x & 0xff00ff00u) >> 8;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xaaaaaaaau) >> 1;
    return x;
}

// For each byte of an index what its bits add, modulo 2, to the third dimension of Sobol's sequence
// [JoeKuo08], bits reversed.
struct ThirdDimension {
    std::array<std::array<uint32_t, 256>, 4> of_byte{};

    constexpr ThirdDimension() {
        std::array<uint32_t, 32> of_bit{1u, 3u};
        for (size_t i = 2; i < 32; ++i)  // the primitive polynomial x^2 + x + 1
            of_bit[i] = of_bit[i - 1] ^ of_bit[i - 2] ^ of_bit[i - 2] << 2;
        for (size_t byte = 0; byte < 4; ++byte)
            for (size_t value = 0; value < 256; ++value)
                for (size_t bit = 0; bit < 8; ++bit)
                    if ((value >> bit & 1u) != 0) of_byte[byte][value] ^= of_bit[8 * byte + bit];
    }
};

inline uint32_t third_reversed(uint32_t x) {
    static constexpr ThirdDimension kThird;
    return kThird.of_byte[0][x & 0xffu] ^ kThird.of_byte[1][x >> 8 & 0xffu] ^
           kThird.of_byte[2][x >> 16 & 0xffu] ^ kThird.of_byte[3][x >> 24];
}

// [0, 1), exactly representable.
inline float to_unit_float(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// The i-th of points in the unit cube that lie evenly however many there are, moved by `shift`: the
// additive recurrence of [Roberts18] for three dimensions. Each by itself is as random as `shift`.
inline Vec3 lattice_point(const Vec3& shift, uint32_t i) {
    constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
        const double at = static_cast<double>(shift[k]) + kStep[k] * i;
        p[k] = std::min(static_cast<float>(at - std::floor(at)), 1.0f - 0x1p-24f);
    }
    return p;
}

class Sampler {
public:
    Sampler(uint32_t seed, uint32_t pixel, uint32_t sample_index)
        : key_(mix_bits((static_cast<uint64_t>(seed) << 32 | pixel) + 0x9e3779b97f4a7c15ull)),
          index_(sample_index) {}

    // Streams of the path's n-th vertex, and of one purpose there.
    Sampler vertex(uint32_t n) const {
        return {mix_bits(key_ + 0x632be59bd9b4e019ull * (n + 1)), index_};
    }
    Sampler operator[](Domain domain) const {
        return {mix_bits(key_ ^ (static_cast<uint64_t>(domain) + 1) * 0xd6e8feb86659fd93ull),
                index_};
    }

    float one() const { return scrambled(shuffled(), mix_bits(key_)); }
    Vec2 two() const {
        const uint32_t index = shuffled();
        const uint64_t more = mix_bits(key_);
        return {scrambled(index, more), scrambled(pascal_reversed(index), more >> 32)};
    }
    // (y, z) are those of two().
    Vec3 three() const {
        const uint32_t index = shuffled();
        const Vec2 yz = two();
        return {scrambled(third_reversed(index), mix_bits(mix_bits(key_))), yz.x, yz.y};
    }
    // Seed of a stream without end, for trials: differs between samples.
    uint64_t stream_seed() const { return mix_bits(key_ + index_); }

private:
    Sampler(uint64_t key, uint32_t index) : key_(key), index_(index) {}

    uint32_t shuffled() const {
        return reverse_bits(scramble_reversed(reverse_bits(index_), static_cast<uint32_t>(key_)));
    }
    static float scrambled(uint32_t reversed, uint64_t seed) {
        return to_unit_float(reverse_bits(scramble_reversed(reversed, static_cast<uint32_t>(seed))));
    }

    uint64_t key_;
    uint32_t index_;
};

// For what no pixel owns: apart from the pixels' streams, and from those of another `purpose`, by
// their seed.
inline Sampler sampler_beside_pixels(uint32_t seed, uint64_t purpose, uint64_t index) {
    constexpr uint64_t kSequence = 1u << 20;
    return {static_cast<uint32_t>(mix_bits(seed ^ purpose)),
            static_cast<uint32_t>(index / kSequence), static_cast<uint32_t>(index % kSequence)};
}

// One of the estimates that belong to a sample of the whole picture. Their numbers are the same
// whatever other samples a render takes, and however many estimates each has.
struct SplatIndex {
    uint32_t sample;
    uint64_t number;  // within the sample
};
// Blocks of numbers share a sequence, so that estimates of one sample and of consecutive ones are
// stratified together.
inline Sampler sampler_beside_pixels(uint32_t seed, uint64_t purpose, const SplatIndex& index) {
    constexpr uint32_t kBlock = 1u << 8;
    return {static_cast<uint32_t>(mix_bits(seed ^ purpose)),
            static_cast<uint32_t>(index.number / kBlock),
            index.sample * kBlock + static_cast<uint32_t>(index.number % kBlock)};
}

// PCG32 [ONeill14], for draws without a fixed number: Bernoulli trials.
class Pcg {
public:
    explicit Pcg(uint64_t seed) : state_(mix_bits(seed)) { bits(); }
    uint32_t bits() {
        const uint64_t old = state_;
        state_ = old * 6364136223846793005ull + 1442695040888963407ull;
        return std::rotr(static_cast<uint32_t>(((old >> 18) ^ old) >> 27),
                         static_cast<int>(old >> 59));
    }
    float one() { return to_unit_float(bits()); }
    Vec2 two() {
        const float x = one();
        return {x, one()};
    }

private:
    uint64_t state_;
};

}  // namespace spc
