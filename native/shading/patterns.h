// SPDX-License-Identifier: GPL-3.0-or-later
// Regular patterns, over T = float or a dual: what the Checker, Gradient, Wave, Magic and Brick
// textures show. Facts of the patterns are Blender's.
#pragma once

#include <cstdlib>

#include "shading/noise.h"

namespace spc {

// Cells' faces lie beside whole numbers, where a surface often does.
template <class T>
T off_whole_numbers(const T& x) {
    return times(x + T(1e-6f), 0.999999f);
}

inline bool is_odd_cell(float x) { return std::fmod(std::floor(x), 2.0f) != 0.0f; }

// 1 or 0 in cells of unit edges.
template <class T>
T checker(const Vector3<T>& p) {
    const auto odd = [](const T& x) { return is_odd_cell(off_whole_numbers(value_of(x))); };
    return T((odd(p.x) == odd(p.y)) == odd(p.z) ? 1.0f : 0.0f);
}

enum class GradientType : uint8_t {
    linear,
    quadratic,
    easing,
    diagonal,
    spherical,
    quadratic_sphere,
    radial
};

// In [0, 1].
template <class T>
T gradient(GradientType type, const Vector3<T>& p) {
    using std::atan2;
    const auto sphere = [&] { return non_negative(T(0.999999f) - safe_root(dot(p, p))); };
    const auto square = [](const T& a) { return a * a; };
    switch (type) {
        case GradientType::linear: return clamp_unit(p.x);
        case GradientType::quadratic: return clamp_unit(square(non_negative(p.x)));
        case GradientType::easing: return smoothstep(p.x, T(0.0f), T(1.0f));
        case GradientType::diagonal: return clamp_unit(times(p.x + p.y, 0.5f));
        case GradientType::spherical: return clamp_unit(sphere());
        case GradientType::quadratic_sphere: return clamp_unit(square(sphere()));
        case GradientType::radial:
            return clamp_unit(times(T(atan2(p.y, p.x)), 0.5f * kInvPi) + T(0.5f));
    }
    return T(0.0f);
}

// ---- Wave

enum class WaveShape : uint8_t {
    bands_x,
    bands_y,
    bands_z,
    bands_diagonal,
    rings_x,
    rings_y,
    rings_z,
    rings_spherical
};
enum class WaveProfile : uint8_t { sine, saw, triangle };

template <class T>
struct Wave {
    WaveShape shape = WaveShape::bands_x;
    WaveProfile profile = WaveProfile::sine;
    T distortion{}, detail{}, detail_scale{}, detail_roughness{}, phase{};
};

// In radians, before it is distorted.
template <class T>
T wave_angle(WaveShape shape, const Vector3<T>& p) {
    const auto ring = [](const T& a, const T& b) { return times(safe_root(a * a + b * b), 20.0f); };
    switch (shape) {
        case WaveShape::bands_x: return times(p.x, 20.0f);
        case WaveShape::bands_y: return times(p.y, 20.0f);
        case WaveShape::bands_z: return times(p.z, 20.0f);
        case WaveShape::bands_diagonal: return times(p.x + p.y + p.z, 10.0f);
        case WaveShape::rings_x: return ring(p.y, p.z);
        case WaveShape::rings_y: return ring(p.x, p.z);
        case WaveShape::rings_z: return ring(p.x, p.y);
        case WaveShape::rings_spherical: return times(safe_root(dot(p, p)), 20.0f);
    }
    return T(0.0f);
}

// In [0, 1].
template <class T>
T wave(const Wave<T>& w, const Vector3<T>& coordinates) {
    using std::sin;
    const Vector3<T> p{off_whole_numbers(coordinates.x), off_whole_numbers(coordinates.y),
                       off_whole_numbers(coordinates.z)};
    T angle = wave_angle(w.shape, p) + w.phase;
    if (value_of(w.distortion) != 0.0f) {
        const Fractal<T> f{
            .detail = w.detail, .roughness = w.detail_roughness, .lacunarity = T(2.0f)};
        const Point<T, 3> at{p.x * w.detail_scale, p.y * w.detail_scale, p.z * w.detail_scale};
        angle += w.distortion * (times(fractal_noise(f, at), 2.0f) - T(1.0f));
    }
    const T turns = times(angle, 0.5f * kInvPi);
    switch (w.profile) {
        case WaveProfile::sine: return T(0.5f) + times(T(sin(angle - T(0.5f * kPi))), 0.5f);
        case WaveProfile::saw: return fraction(turns);
        case WaveProfile::triangle: return times(absolute(turns - floor_of(turns + T(0.5f))), 2.0f);
    }
    return T(0.0f);
}

// ---- Magic

inline constexpr int kMostMagic = 10;  // turbulence

// Waves that bend one another: each step replaces one of three by a wave of their sum or
// difference.
template <class T>
Vector3<T> magic(int depth, const Vector3<T>& p, const T& scale, const T& distortion) {
    using std::cos, std::sin;
    struct Step {
        int replaced;
        bool cosine;
        float sign, x, y, z;
    };
    constexpr std::array<Step, kMostMagic> kSteps{{{1, true, -1, 1, -1, 1},
                                                   {0, true, 1, 1, -1, -1},
                                                   {2, false, 1, -1, -1, -1},
                                                   {0, true, -1, -1, 1, -1},
                                                   {1, false, -1, -1, 1, 1},
                                                   {1, true, -1, -1, 1, 1},
                                                   {0, true, 1, 1, 1, 1},
                                                   {2, false, 1, 1, 1, -1},
                                                   {0, true, -1, -1, -1, 1},
                                                   {1, false, -1, 1, -1, 1}}};
    const auto turn = [](const T& x) {
        return x - T(value_of(x) - std::fmod(value_of(x), 2 * kPi));
    };
    const T x = turn(p.x), y = turn(p.y), z = turn(p.z);
    const T frequency = times(scale, 5.0f);
    std::array<T, 3> w{T(sin((x + y + z) * frequency)), T(cos((y - x - z) * frequency)),
                       T(0.0f) - T(cos((z - x - y) * frequency))};
    if (depth > 0)
        for (T& value : w) value = value * distortion;
    for (int i = 0; i < std::min(depth, kMostMagic); ++i) {
        const Step& step = kSteps[static_cast<size_t>(i)];
        const T angle = times(w[0], step.x) + times(w[1], step.y) + times(w[2], step.z);
        w[static_cast<size_t>(step.replaced)] =
            times(step.cosine ? T(cos(angle)) : T(sin(angle)), step.sign) * distortion;
    }
    const T divisor = value_of(distortion) != 0.0f ? times(distortion, 2.0f) : T(1.0f);
    return {T(0.5f) - w[0] / divisor, T(0.5f) - w[1] / divisor, T(0.5f) - w[2] / divisor};
}

// ---- Brick

// A number in [0, 1] for a brick, by integers that wrap.
inline float brick_hash(uint32_t n) {
    n = (n + 1013u) & 0x7fffffffu;
    n = (n >> 13) ^ n;
    const uint32_t mixed = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
    return 0.5f * (static_cast<float>(mixed) / 1073741824.0f);
}

template <class T>
struct Brick {
    T mortar_size{}, mortar_smooth{}, bias{}, width{}, row_height{};
    float offset = 0.5f, squash = 1.0f;  // of every offset_every-th and squash_every-th row
    int offset_every = 2, squash_every = 2;
};
template <class T>
struct BrickPoint {
    T tint;    // share of the second colour
    T mortar;  // share of mortar
};

inline int whole_or_zero(float x) {
    return std::abs(x) < 2e9f ? static_cast<int>(std::floor(x)) : 0;
}

template <class T>
BrickPoint<T> brick(const Brick<T>& b, const Vector3<T>& p) {
    const int row = whole_or_zero(value_of(p.y) / value_of(b.row_height));
    T width = b.width, offset(0.0f);
    if (b.offset_every != 0 && b.squash_every != 0) {
        if (row % b.squash_every == 0) width = times(width, b.squash);
        if (row % b.offset_every == 0) offset = times(width, b.offset);
    }
    const T along = p.x + offset;
    const int number = whole_or_zero(value_of(along) / value_of(width));
    const T x = along - times(width, static_cast<float>(number));
    const T y = p.y - times(b.row_height, static_cast<float>(row));
    const float tint =
        brick_hash((static_cast<uint32_t>(row) << 16) + (static_cast<uint32_t>(number) & 0xffffu));
    const T nearest = smaller(smaller(x, y), smaller(width - x, b.row_height - y));
    T mortar(0.0f);
    if (value_of(nearest) < value_of(b.mortar_size))
        mortar = value_of(b.mortar_smooth) == 0.0f
                     ? T(1.0f)
                     : smoothstep((T(1.0f) - nearest / b.mortar_size) / b.mortar_smooth, T(0.0f),
                                  T(1.0f));
    return {clamp_unit(T(tint) + b.bias), mortar};
}

}  // namespace spc
