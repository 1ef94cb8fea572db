// SPDX-License-Identifier: GPL-3.0-or-later
// The hashes behind procedural textures, as in Blender, so that the same cells get the same
// numbers: Jenkins' lookup3 of one to four words, and PCG of two to four, which Voronoi cells have
// since 5.0.
#pragma once

#include <array>
#include <bit>
#include <type_traits>

#include "math/lanes.h"

namespace spc {

// Signed words and floats that go with a word, or with words side by side.
template <class Word>
struct LikeWord {
    static constexpr size_t kCount = sizeof(Word) / sizeof(uint32_t);
    using Ints = typename LanesOf<kCount>::Ints;
    using Floats = typename LanesOf<kCount>::Floats;
    static Floats to_floats(const Ints& a) { return __builtin_convertvector(a, Floats); }
    static Floats to_floats(const Word& a) { return __builtin_convertvector(a, Floats); }
    static Word from_whole(const Floats& a) {
        return std::bit_cast<Word>(__builtin_convertvector(a, Ints));
    }
};
template <>
struct LikeWord<uint32_t> {
    using Ints = int32_t;
    using Floats = float;
    static float to_floats(int32_t a) { return static_cast<float>(a); }
    static float to_floats(uint32_t a) { return static_cast<float>(a); }
    static uint32_t from_whole(float a) { return static_cast<uint32_t>(static_cast<int32_t>(a)); }
};
template <class Float>
using WordLike = std::conditional_t<std::is_same_v<Float, float>, uint32_t,
                                    typename LanesOf<sizeof(Float) / sizeof(float)>::Words>;

template <class Word>
Word rotated(const Word& a, int bits) {
    return (a << bits) | (a >> (32 - bits));
}

// http://burtleburtle.net/bob/c/lookup3.c
template <size_t N, class Word = uint32_t>
Word lookup3(const std::array<Word, N>& word) {
    static_assert(N >= 1 && N <= 4);
    Word a = Word{} + (0xdeadbeefu + (static_cast<uint32_t>(N) << 2) + 13u), b = a, c = a;
    // One step: subtracts and mixes in a rotated neighbour, in the hash's two ways.
    const auto stir = [](Word& to, Word& from, const Word& other, int bits) {
        to -= from;
        to ^= rotated(from, bits);
        from += other;
    };
    const auto finish = [](Word& to, const Word& from, int bits) {
        to ^= from;
        to -= rotated(from, bits);
    };
    a += word[0];
    if constexpr (N >= 2) b += word[1];
    if constexpr (N >= 3) c += word[2];
    if constexpr (N == 4) {
        stir(a, c, b, 4);
        stir(b, a, c, 6);
        stir(c, b, a, 8);
        stir(a, c, b, 16);
        stir(b, a, c, 19);
        stir(c, b, a, 4);
        a += word[3];
    }
    finish(c, b, 14);
    finish(a, c, 11);
    finish(b, a, 25);
    finish(c, b, 16);
    finish(a, c, 4);
    finish(b, a, 14);
    finish(c, b, 24);
    return c;
}

// A number in [0, 1] for the bits of one to four floats.
template <class Float, class... Floats>
Float hash_unit(const Float& first, const Floats&... others) {
    using Word = WordLike<Float>;
    const std::array<Word, 1 + sizeof...(Floats)> words{std::bit_cast<Word>(first),
                                                        std::bit_cast<Word>(others)...};
    return LikeWord<Word>::to_floats(lookup3(words)) * (1.0f / 4294967295.0f);
}

// N numbers and three numbers of that kind for a point of N coordinates.
template <size_t N, class Float>
std::array<Float, N> hash_point(const std::array<Float, N>& k) {
    const Float one = Float{} + 1.0f, two = Float{} + 2.0f;
    if constexpr (N == 1) return {hash_unit(k[0])};
    if constexpr (N == 2) return {hash_unit(k[0], k[1]), hash_unit(k[0], k[1], one)};
    if constexpr (N == 3)
        return {hash_unit(k[0], k[1], k[2]), hash_unit(k[0], k[1], k[2], one),
                hash_unit(k[0], k[1], k[2], two)};
    if constexpr (N == 4)
        return {hash_unit(k[0], k[1], k[2], k[3]), hash_unit(k[3], k[0], k[1], k[2]),
                hash_unit(k[2], k[3], k[0], k[1]), hash_unit(k[1], k[2], k[3], k[0])};
}
template <size_t N>
std::array<float, 3> hash_color(const std::array<float, N>& k) {
    if constexpr (N == 1) return {hash_unit(k[0]), hash_unit(k[0], 1.0f), hash_unit(k[0], 2.0f)};
    if constexpr (N == 2)
        return {hash_unit(k[0], k[1]), hash_unit(k[0], k[1], 1.0f), hash_unit(k[0], k[1], 2.0f)};
    if constexpr (N == 3) return hash_point(k);
    if constexpr (N == 4)
        return {hash_unit(k[0], k[1], k[2], k[3]), hash_unit(k[2], k[0], k[3], k[1]),
                hash_unit(k[3], k[2], k[1], k[0])};
}

// M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020; of signed words,
// as Blender has it: shifts keep the sign, which is dropped at the end.
template <size_t N, class Word>
std::array<typename LikeWord<Word>::Floats, N> pcg_unit(const std::array<Word, N>& words) {
    static_assert(N >= 2 && N <= 4);
    using Ints = typename LikeWord<Word>::Ints;
    constexpr uint32_t kFactor = 1664525u, kIncrement = 1013904223u;
    std::array<Word, N> v;
    for (size_t k = 0; k < N; ++k) v[k] = words[k] * kFactor + kIncrement;
    const auto stir = [&v] {
        if constexpr (N == 2) {
            v[0] += v[1] * kFactor;
            v[1] += v[0] * kFactor;
        } else {
            v[0] += v[1] * v[N - 1];
            v[1] += v[2] * v[0];
            v[2] += v[0] * v[1];
            if constexpr (N == 4) v[3] += v[1] * v[2];
        }
    };
    stir();
    for (Word& word : v) word ^= std::bit_cast<Word>(std::bit_cast<Ints>(word) >> 16);
    stir();
    std::array<typename LikeWord<Word>::Floats, N> result;
    for (size_t k = 0; k < N; ++k)
        result[k] = LikeWord<Word>::to_floats(std::bit_cast<Ints>(v[k] & 0x7fffffffu)) *
                    (1.0f / 2147483647.0f);
    return result;
}

}  // namespace spc
