// SPDX-License-Identifier: GPL-3.0-or-later
// What distinguishes instructions of procedural textures, packed into Instruction::mode.
#pragma once

#include "shading/patterns.h"
#include "shading/voronoi.h"

namespace spc {

// Dimensions from 1 to 4; in one the coordinate is W, in four it is the last.
inline uint8_t noise_mode(int dimensions, FractalType type, bool normalized) {
    return static_cast<uint8_t>((dimensions - 1) | static_cast<int>(type) << 2 |
                                (normalized ? 32 : 0));
}
inline int mode_dimensions(uint8_t mode) { return (mode & 3) + 1; }
inline FractalType mode_fractal(uint8_t mode) { return static_cast<FractalType>(mode >> 2 & 7); }
inline bool mode_normalized(uint8_t mode) { return (mode & 32) != 0; }

// The dimensions as of noise. Features that know no metric share the last numbers of a field of
// four bits with those that do.
inline uint8_t voronoi_mode(int dimensions, VoronoiFeature feature, VoronoiMetric metric,
                            bool normalized, VoronoiHash hash) {
    const int f = static_cast<int>(feature), m = static_cast<int>(metric);
    const int field = feature < VoronoiFeature::distance_to_edge ? 4 * f + m : 9 + f;
    return static_cast<uint8_t>((dimensions - 1) | field << 2 | (normalized ? 64 : 0) |
                                (hash == VoronoiHash::pcg ? 128 : 0));
}
inline VoronoiFeature mode_voronoi_feature(uint8_t mode) {
    const int field = mode >> 2 & 15;
    return static_cast<VoronoiFeature>(field < 12 ? field / 4 : field - 9);
}
inline VoronoiMetric mode_voronoi_metric(uint8_t mode) {
    return static_cast<VoronoiMetric>(mode >> 2 & 3);
}
inline bool mode_voronoi_normalized(uint8_t mode) { return (mode & 64) != 0; }
inline VoronoiHash mode_voronoi_hash(uint8_t mode) {
    return (mode & 128) != 0 ? VoronoiHash::pcg : VoronoiHash::lookup3;
}

inline uint8_t wave_mode(WaveShape shape, WaveProfile profile) {
    return static_cast<uint8_t>(static_cast<int>(shape) | static_cast<int>(profile) << 3);
}
inline WaveShape mode_wave_shape(uint8_t mode) { return static_cast<WaveShape>(mode & 7); }
inline WaveProfile mode_wave_profile(uint8_t mode) { return static_cast<WaveProfile>(mode >> 3); }

// Calls function(point) with the point of as many dimensions as a texture has.
template <class T, class Function>
auto in_dimensions(int dimensions, const Vector3<T>& p, const T& w, const Function& function) {
    switch (dimensions) {
        case 1: return function(Point<T, 1>{w});
        case 2: return function(Point<T, 2>{p.x, p.y});
        case 3: return function(Point<T, 3>{p.x, p.y, p.z});
        default: return function(Point<T, 4>{p.x, p.y, p.z, w});
    }
}

// A point's coordinates as (x, y, z, W), 0 where it has none.
template <class T, size_t N>
std::array<T, 4> as_vector_and_w(const Point<T, N>& p) {
    if constexpr (N == 1) {
        return {T(0.0f), T(0.0f), T(0.0f), p[0]};
    } else {
        std::array<T, 4> result{};
        std::copy(p.begin(), p.end(), result.begin());
        return result;
    }
}

template <class T>
Vector3<T> white_noise(int dimensions, const Vector3<T>& p, const T& w) {
    const Vector3<float> at{value_of(p.x), value_of(p.y), value_of(p.z)};
    return in_dimensions(dimensions, at, value_of(w), [](const auto& point) {
        const std::array<float, 3> color = hash_color(point);
        return Vector3<T>{T(color[0]), T(color[1]), T(color[2])};
    });
}

}  // namespace spc
