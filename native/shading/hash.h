// SPDX-License-Identifier: GPL-3.0-or-later
// The hashes behind procedural textures, as in Blender, so that the same cells get the same numbers:
// Jenkins' lookup3 of one to four words, and PCG of two to four, which Voronoi cells have since 5.0.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace spc {

// http://burtleburtle.net/bob/c/lookup3.c
template <size_t N>
uint32_t lookup3(const std::array<uint32_t, N>& word) {
    static_assert(N >= 1 && N <= 4);
    uint32_t a = 0xdeadbeefu + (static_cast<uint32_t>(N) << 2) + 13u, b = a, c = a;
    // One step: subtracts and mixes in a rotated neighbour, in the hash's two ways.
    const auto stir = [](uint32_t& to, uint32_t& from, uint32_t& other, int bits) {
        to -= from;
        to ^= std::rotl(from, bits);
        from += other;
    };
    const auto finish = [](uint32_t& to, uint32_t from, int bits) {
        to ^= from;
        to -= std::rotl(from, bits);
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
template <class... Floats>
float hash_unit(Floats... values) {
    const std::array<uint32_t, sizeof...(Floats)> words{std::bit_cast<uint32_t>(values)...};
    return static_cast<float>(lookup3(words)) * (1.0f / 4294967295.0f);
}

// N numbers and three numbers of that kind for a point of N coordinates.
template <size_t N>
std::array<float, N> hash_point(const std::array<float, N>& k) {
    if constexpr (N == 1) return {hash_unit(k[0])};
    if constexpr (N == 2) return {hash_unit(k[0], k[1]), hash_unit(k[0], k[1], 1.0f)};
    if constexpr (N == 3)
        return {hash_unit(k[0], k[1], k[2]), hash_unit(k[0], k[1], k[2], 1.0f),
                hash_unit(k[0], k[1], k[2], 2.0f)};
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

// M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020; of signed words, as
// Blender has it: shifts keep the sign, which is dropped at the end.
template <size_t N>
std::array<float, N> pcg_unit(const std::array<int32_t, N>& words) {
    static_assert(N >= 2 && N <= 4);
    constexpr uint32_t kFactor = 1664525u, kIncrement = 1013904223u;
    std::array<uint32_t, N> v;
    for (size_t k = 0; k < N; ++k) v[k] = static_cast<uint32_t>(words[k]) * kFactor + kIncrement;
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
    for (uint32_t& word : v) word ^= static_cast<uint32_t>(static_cast<int32_t>(word) >> 16);
    stir();
    std::array<float, N> result;
    for (size_t k = 0; k < N; ++k)
        result[k] = static_cast<float>(v[k] & 0x7fffffffu) * (1.0f / 2147483647.0f);
    return result;
}

}  // namespace spc
