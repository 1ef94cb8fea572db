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

// Gradients of lattice points side by side, chosen by their hashes.
template <size_t N, class Words>
auto lattice_gradients(const Words& hash) {
    using Floats = typename LikeWord<Words>::Floats;
    const Floats zero{}, one = zero + 1.0f;
    const auto sign = [&](uint32_t bit) { return (hash & bit) != 0 ? -one : one; };
    if constexpr (N == 1) {
        return Point<Floats, 1>{sign(8) * (LikeWord<Words>::to_floats(hash & 7) + 1.0f)};
    } else if constexpr (N == 2) {
        const auto steep_y = (hash & 7) < 4;
        const Floats slight = sign(1), steep = sign(2) * 2.0f;
        return Point<Floats, 2>{steep_y ? slight : steep, steep_y ? steep : slight};
    } else if constexpr (N == 3) {
        const Words h = hash & 15;
        const Floats a = sign(1), b = sign(2);
        const auto b_along_y = h < 4, b_along_x = (h == 12) | (h == 14);
        return Point<Floats, 3>{(h < 8 ? a : zero) + (b_along_x ? b : zero),
                                (h < 8 ? zero : a) + (b_along_y ? b : zero),
                                b_along_x | b_along_y ? zero : b};
    } else {
        const Words h = hash & 31;
        const Floats a = sign(1), b = sign(2), c = sign(4);
        return Point<Floats, 4>{h < 24 ? a : zero, (h < 24 ? zero : a) + (h < 16 ? b : zero),
                                (h < 16 ? zero : b) + (h < 8 ? c : zero), h < 8 ? zero : c};
    }
}

// Noise at a point, its slopes, and theirs.
template <size_t N>
struct NoiseJet {
    float value;
    std::array<float, N> slope;
    std::array<std::array<float, N>, N> curvature;
};

// As far as `Order` says; all corners of a cell are looked at side by side.
template <size_t Order, size_t N>
NoiseJet<N> noise_jet(const Point<float, N>& p) {
    constexpr std::array<float, 4> kScale{0.25f, 0.6616f, 0.982f, 0.8344f};
    constexpr size_t kCorners = size_t{1} << N;
    using Floats = typename LanesOf<kCorners>::Floats;
    using Words = typename LanesOf<kCorners>::Words;
    std::array<Words, N> lattice;
    Point<Floats, N> way;
    // Of each axis a corner's share of the noise, and its derivatives.
    std::array<Point<Floats, N>, Order + 1> share;
    for (size_t k = 0; k < N; ++k) {
        Words step;
        for (size_t corner = 0; corner < kCorners; ++corner) step[corner] = corner >> k & 1;
        const float floor = std::floor(p[k]), t = p[k] - floor;
        lattice[k] = step + static_cast<uint32_t>(static_cast<int32_t>(floor));
        way[k] = t - LikeWord<Words>::to_floats(step);
        const auto both = [&](float of_far, float of_near) {
            return step != 0 ? Floats{} + of_far : Floats{} + of_near;
        };
        const float far = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
        share[0][k] = both(far, 1.0f - far);
        if constexpr (Order >= 1) {
            const float rise = 30.0f * t * t * (t - 1.0f) * (t - 1.0f);
            share[1][k] = both(rise, -rise);
        }
        if constexpr (Order >= 2) {
            const float bend = 60.0f * t * (t - 1.0f) * (2.0f * t - 1.0f);
            share[2][k] = both(bend, -bend);
        }
    }
    const Point<Floats, N> gradient = lattice_gradients<N>(lookup3(lattice));
    Floats height = gradient[0] * way[0];
    for (size_t k = 1; k < N; ++k) height += gradient[k] * way[k];

    // The corners' shares, differentiated so many times along each axis.
    const auto shares = [&](const std::array<size_t, N>& times) {
        Floats product = share[times[0]][0];
        for (size_t k = 1; k < N; ++k) product *= share[times[k]][k];
        return product;
    };
    const auto total = [&](const Floats& lanes) {
        float sum = 0.0f;
        for (size_t corner = 0; corner < kCorners; ++corner) sum += lanes[corner];
        return sum * kScale[N - 1];
    };
    NoiseJet<N> jet;
    const Floats plain = shares({});
    jet.value = total(plain * height);
    if constexpr (Order >= 1) {
        std::array<Floats, N> risen;
        for (size_t k = 0; k < N; ++k) {
            std::array<size_t, N> once{};
            once[k] = 1;
            risen[k] = shares(once);
            jet.slope[k] = total(plain * gradient[k] + risen[k] * height);
        }
        if constexpr (Order >= 2)
            for (size_t k = 0; k < N; ++k)
                for (size_t j = 0; j < N; ++j) {
                    std::array<size_t, N> twice{};
                    ++twice[k];
                    ++twice[j];
                    jet.curvature[k][j] = total(risen[k] * gradient[j] + risen[j] * gradient[k] +
                                                shares(twice) * height);
                }
    }
    return jet;
}

// A function's value and slopes at p, over duals.
template <size_t N>
Dual2 lifted(float value, const std::array<float, N>& slope, const Point<Dual2, N>& p) {
    Dual2 result(value);
    for (size_t k = 0; k < N; ++k) {
        result.du += slope[k] * p[k].du;
        result.dv += slope[k] * p[k].dv;
    }
    return result;
}

// About 0; nearly all within [-1, 1].
template <class T, size_t N>
T perlin(const Point<T, N>& p) {
    Point<T, N> at;
    Point<float, N> value;
    for (size_t k = 0; k < N; ++k) {
        at[k] = lattice_coordinate(p[k]);
        value[k] = value_of(at[k]);
    }
    if constexpr (std::is_same_v<T, float>) {
        return noise_jet<0>(value).value;
    } else if constexpr (std::is_same_v<T, Dual2>) {
        const NoiseJet<N> jet = noise_jet<1>(value);
        return lifted(jet.value, jet.slope, at);
    } else {
        const NoiseJet<N> jet = noise_jet<2>(value);
        Point<Dual2, N> inner;
        for (size_t k = 0; k < N; ++k) inner[k] = at[k].v;
        T result(lifted(jet.value, jet.slope, inner), {}, {});
        for (size_t k = 0; k < N; ++k) {
            const Dual2 slope = lifted(jet.slope[k], jet.curvature[k], inner);
            result.du += slope * at[k].du;
            result.dv += slope * at[k].dv;
        }
        return result;
    }
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
