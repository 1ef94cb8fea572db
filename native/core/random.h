// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers keyed by what they are for. A Sampler is a value: (seed, pixel, purpose) hashed to
// a key, and the absolute sample index. Each purpose draws from its own Owen-scrambled (0,
// 2)-sequence with a shuffled index [Burley20], so every draw is stratified over the samples of a
// pixel and independent of every other draw.
#pragma once

#include "math/vec.h"

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
    highlight_light,
    highlight_seeds,
    missed_chains,
    folds
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

    float one() const { return first(shuffled(key_), mix_bits(key_)); }
    Vec2 two() const { return draw(key_); }
    Vec3 three() const {
        const uint64_t other = key_ ^ 0xa0761d6478bd642full;
        const Vec2 a = draw(key_);
        return {first(shuffled(other), mix_bits(other)), a.x, a.y};
    }
    // Seed of a stream without end, for trials: differs between samples.
    uint64_t stream_seed() const { return mix_bits(key_ + index_); }

private:
    Sampler(uint64_t key, uint32_t index) : key_(key), index_(index) {}

    uint32_t shuffled(uint64_t key) const {
        return reverse_bits(scramble_reversed(reverse_bits(index_), static_cast<uint32_t>(key)));
    }
    static float first(uint32_t shuffled, uint64_t more) {
        return to_unit_float(reverse_bits(scramble_reversed(shuffled, static_cast<uint32_t>(more))));
    }
    static float second(uint32_t shuffled, uint64_t more) {
        return first(pascal_reversed(shuffled), more >> 32);
    }
    Vec2 draw(uint64_t key) const {
        const uint32_t index = shuffled(key);
        const uint64_t more = mix_bits(key);
        return {first(index, more), second(index, more)};
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
