// SPDX-License-Identifier: GPL-3.0-or-later
// Perlin's gradient noise in one to four dimensions and the fractals that sum it, over T = float or
// a dual. Lattice, gradients and scales are Blender's.
//   K. Perlin, "Improving Noise", SIGGRAPH 2002.
//   F. K. Musgrave, in Ebert et al., "Texturing and Modeling: A Procedural Approach", chapter 16.
#pragma once

#include "shading/functions.h"
#include "shading/hash.h"

namespace spc {

template <class T, size_t N>
using Point = std::array<T, N>;

template <class T, size_t N>
Point<T, N> scaled(Point<T, N> p, const T& factor) {
    for (T& x : p) x = x * factor;
    return p;
}
template <class T, size_t N>
Point<T, N> moved(Point<T, N> p, const Point<float, N>& by) {
    for (size_t k = 0; k < N; ++k) p[k] = p[k] + T(by[k]);
    return p;
}

// Where the lattice repeats, for the sake of precision; 0 for what is not finite.
template <class T>
T lattice_coordinate(const T& x) {
    constexpr float kPeriod = 100000.0f;
    const float value = value_of(x);
    if (!std::isfinite(value)) return T(0.0f);
    return std::abs(value) < kPeriod ? x : x - T(value - std::fmod(value, kPeriod));
}

// A corner's gradient, which its hash chooses, times the way from there.
template <class T, size_t N>
T corner_slope(uint32_t hash, const Point<T, N>& d) {
    const auto flip = [&](const T& x, uint32_t bit) { return hash & bit ? T(0.0f) - x : x; };
    if constexpr (N == 1) {
        return flip(times(d[0], 1.0f + static_cast<float>(hash & 7)), 8);
    } else if constexpr (N == 2) {
        const bool steep_y = (hash & 7) < 4;
        return flip(d[steep_y ? 0 : 1], 1) + flip(times(d[steep_y ? 1 : 0], 2.0f), 2);
    } else if constexpr (N == 3) {
        const uint32_t h = hash & 15;
        const T& v = h < 4 ? d[1] : h == 12 || h == 14 ? d[0] : d[2];
        return flip(d[h < 8 ? 0 : 1], 1) + flip(v, 2);
    } else {
        const uint32_t h = hash & 31;
        return flip(d[h < 24 ? 0 : 1], 1) + flip(d[h < 16 ? 1 : 2], 2) + flip(d[h < 8 ? 2 : 3], 4);
    }
}

// About 0; nearly all within [-1, 1].
template <class T, size_t N>
T perlin(const Point<T, N>& p) {
    constexpr std::array<float, 4> kScale{0.25f, 0.6616f, 0.982f, 0.8344f};
    constexpr size_t kCorners = size_t{1} << N;
    std::array<int, N> cell;
    Point<T, N> local, share;
    for (size_t k = 0; k < N; ++k) {
        const T x = lattice_coordinate(p[k]);
        cell[k] = static_cast<int>(std::floor(value_of(x)));
        local[k] = x - T(static_cast<float>(cell[k]));
        const T& t = local[k];
        share[k] = t * t * t * (t * (times(t, 6.0f) - T(15.0f)) + T(10.0f));
    }
    std::array<T, kCorners> value;
    for (size_t corner = 0; corner < kCorners; ++corner) {
        std::array<uint32_t, N> lattice;
        Point<T, N> way = local;
        for (size_t k = 0; k < N; ++k) {
            const int step = static_cast<int>(corner >> k & 1);
            lattice[k] = static_cast<uint32_t>(cell[k] + step);
            if (step != 0) way[k] = way[k] - T(1.0f);
        }
        value[corner] = corner_slope(lookup3(lattice), way);
    }
    for (size_t k = 0; k < N; ++k)
        for (size_t corner = 0; corner < kCorners >> (k + 1); ++corner)
            value[corner] =
                value[2 * corner] + (value[2 * corner + 1] - value[2 * corner]) * share[k];
    return times(value[0], kScale[N - 1]);
}

enum class FractalType : uint8_t { fbm, multifractal, hybrid, ridged, hetero_terrain };

template <class T>
struct Fractal {
    FractalType type = FractalType::fbm;
    bool normalized = true;  // to [0, 1], of fbm
    T detail{};              // octaves above the first; the last one fades in
    T roughness{}, lacunarity{}, offset{}, gain{};
};

inline constexpr float kMostDetail = 15.0f;

namespace fractal {

template <class T, size_t N>
struct Octaves {
    Point<T, N> at;
    T lacunarity;
    // Noise of the current octave, and on to the next.
    T next() {
        const T noise = perlin(at);
        at = scaled(at, lacunarity);
        return noise;
    }
};

template <class T, size_t N>
T fbm(const Fractal<T>& f, Octaves<T, N> octaves, int count, const T& rest) {
    T amplitude(1.0f), largest(0.0f), sum(0.0f);
    const auto result = [&] { return f.normalized ? times(sum / largest, 0.5f) + T(0.5f) : sum; };
    const auto add_octave = [&] {
        sum += octaves.next() * amplitude;
        largest += amplitude;
        amplitude = amplitude * f.roughness;
    };
    for (int i = 0; i <= count; ++i) add_octave();
    const T whole = result();
    if (value_of(rest) == 0.0f) return whole;
    add_octave();
    return whole + (result() - whole) * rest;
}

template <class T, size_t N>
T multifractal(const Fractal<T>& f, Octaves<T, N> octaves, int count, const T& rest) {
    T product(1.0f), power(1.0f);
    for (int i = 0; i <= count; ++i) {
        product = product * (power * octaves.next() + T(1.0f));
        power = power * f.roughness;
    }
    if (value_of(rest) == 0.0f) return product;
    return product * (rest * power * octaves.next() + T(1.0f));
}

template <class T, size_t N>
T hetero_terrain(const Fractal<T>& f, Octaves<T, N> octaves, int count, const T& rest) {
    T power = f.roughness, height = f.offset + octaves.next();
    const auto rise = [&] { return (octaves.next() + f.offset) * power * height; };
    for (int i = 1; i <= count; ++i) {
        height += rise();
        power = power * f.roughness;
    }
    return value_of(rest) == 0.0f ? height : height + rest * rise();
}

template <class T, size_t N>
T hybrid(const Fractal<T>& f, Octaves<T, N> octaves, int count, const T& rest) {
    constexpr float kLeastWeight = 0.001f;
    T power(1.0f), sum(0.0f), weight(1.0f);
    for (int i = 0; i <= count + 1 && value_of(weight) > kLeastWeight; ++i) {
        const bool last = i > count;
        if (last && value_of(rest) == 0.0f) break;
        weight = smaller(weight, T(1.0f));
        const T signal = (octaves.next() + f.offset) * power;
        sum += last ? rest * weight * signal : weight * signal;
        weight = weight * f.gain * signal;
        power = power * f.roughness;
    }
    return sum;
}

// Whole octaves alone.
template <class T, size_t N>
T ridged(const Fractal<T>& f, Octaves<T, N> octaves, int count) {
    const auto ridge = [&] {
        const T signal = f.offset - absolute(octaves.next());
        return signal * signal;
    };
    T signal = ridge(), sum = signal, power = f.roughness;
    for (int i = 1; i <= count; ++i) {
        const T weight = clamp_unit(signal * f.gain);
        signal = ridge() * weight;
        sum += signal * power;
        power = power * f.roughness;
    }
    return sum;
}

}  // namespace fractal

template <class T, size_t N>
T fractal_noise(const Fractal<T>& f, const Point<T, N>& p) {
    const T detail = clamped(f.detail, T(0.0f), T(kMostDetail));
    const int count = static_cast<int>(value_of(detail));
    const T rest = detail - T(static_cast<float>(count));
    const fractal::Octaves<T, N> octaves{p, f.lacunarity};
    switch (f.type) {
        case FractalType::fbm: return fractal::fbm(f, octaves, count, rest);
        case FractalType::multifractal: return fractal::multifractal(f, octaves, count, rest);
        case FractalType::hybrid: return fractal::hybrid(f, octaves, count, rest);
        case FractalType::ridged: return fractal::ridged(f, octaves, count);
        case FractalType::hetero_terrain: return fractal::hetero_terrain(f, octaves, count, rest);
    }
    return T(0.0f);
}

// ---- the Noise Texture: its coordinates moved by another noise, and two more noises for a colour

// How far away from the first one the noise number `seed` lies.
template <size_t N>
Point<float, N> noise_offset(float seed) {
    Point<float, N> offset;
    for (size_t k = 0; k < N; ++k) {
        const float unit = N == 1 ? hash_unit(seed) : hash_unit(seed, static_cast<float>(k));
        offset[k] = 100.0f + 100.0f * unit;
    }
    return offset;
}

template <class T, size_t N>
Point<T, N> distorted(const Point<T, N>& p, const T& distortion) {
    if (value_of(distortion) == 0.0f) return p;
    Point<T, N> result = p;
    for (size_t k = 0; k < N; ++k)
        result[k] = p[k] + perlin(moved(p, noise_offset<N>(static_cast<float>(k)))) * distortion;
    return result;
}

// The value, and the colour whose red it is.
template <class T, size_t N>
T noise_value(const Fractal<T>& f, const Point<T, N>& p, const T& distortion) {
    return fractal_noise(f, distorted(p, distortion));
}
template <class T, size_t N>
Vector3<T> noise_color(const Fractal<T>& f, const Point<T, N>& p, const T& distortion) {
    const Point<T, N> at = distorted(p, distortion);
    const auto other = [&](float seed) {
        return fractal_noise(f, moved(at, noise_offset<N>(seed)));
    };
    constexpr float kFirst = static_cast<float>(N);
    return {fractal_noise(f, at), other(kFirst), other(kFirst + 1.0f)};
}

}  // namespace spc
