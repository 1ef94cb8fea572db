// SPDX-License-Identifier: GPL-3.0-or-later
// Imath's vectors under our names, and the few helpers that they lack.
#pragma once

#include <Imath/ImathColor.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

namespace spc {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Vec3d = Imath::V3d;
using Spectrum = Imath::C3f;  // linear Rec.709

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kBelowOne = 0x1.fffffep-1f;  // the largest float that is

template <class T>
T dot(const Imath::Vec3<T>& a, const Imath::Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Imath::Vec3<T> cross(const Imath::Vec3<T>& a, const Imath::Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length_squared(const Imath::Vec3<T>& a) {
    return dot(a, a);
}
template <class T>
T length(const Imath::Vec3<T>& a) {
    return std::sqrt(dot(a, a));
}
// Undefined for the zero vector; use safe_normalize where it can occur.
template <class T>
Imath::Vec3<T> normalize(const Imath::Vec3<T>& a) {
    return a * (T(1) / length(a));
}
template <class T>
Imath::Vec3<T> safe_normalize(const Imath::Vec3<T>& a, const Imath::Vec3<T>& fallback) {
    const T l = length(a);
    return l > T(0) ? a * (T(1) / l) : fallback;
}

inline float sqr(float a) { return a * a; }
inline float clamp01(float a) { return std::min(std::max(a, 0.0f), 1.0f); }
inline float safe_sqrt(float a) { return std::sqrt(std::max(a, 0.0f)); }
inline float lerp(float a, float b, float t) { return a + (b - a) * t; }

// Rec.709 luminance; also how Blender turns a colour socket into a value.
inline float luminance(const Spectrum& c) {
    return 0.2126729f * c.x + 0.7151522f * c.y + 0.0721750f * c.z;
}
inline float max_component(const Spectrum& c) { return std::max(c.x, std::max(c.y, c.z)); }
inline float mean(const Spectrum& c) { return (c.x + c.y + c.z) * (1.0f / 3.0f); }
inline bool is_black(const Spectrum& c) { return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f; }
inline bool is_finite(const Vec3& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

// Orthonormal right-handed frame around a unit z axis [Duff17].
struct Frame {
    Vec3 x, y, z;

    static Frame around(const Vec3& z) {
        const float sign = std::copysign(1.0f, z.z);
        const float a = -1.0f / (sign + z.z);
        const float b = z.x * z.y * a;
        return {Vec3(1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x),
                Vec3(b, sign + z.y * z.y * a, -z.y), z};
    }
    Vec3 to_local(const Vec3& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3 to_world(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
};

// Solves [a b; c d] (x, y) = (e, f). Empty when the matrix is singular to working precision.
inline std::optional<Vec2> solve2x2(float a, float b, float c, float d, float e, float f) {
    const float det = a * d - b * c;
    const float scale = std::max(std::abs(a * d), std::abs(b * c));
    if (!(std::abs(det) > 1e-7f * scale)) return std::nullopt;
    const float inv = 1.0f / det;
    return Vec2((d * e - b * f) * inv, (a * f - c * e) * inv);
}

// Affine map, rows of a 3x4 matrix: p' = linear p + translation.
struct Transform {
    std::array<Vec3, 3> row{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    Vec3 translation{0, 0, 0};

    static Transform from_rows(const float m[12]) {
        Transform t;
        for (int i = 0; i < 3; ++i) {
            t.row[i] = Vec3(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
            t.translation[i] = m[4 * i + 3];
        }
        return t;
    }
    Vec3 vector(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
    Vec3 point(const Vec3& p) const { return vector(p) + translation; }
    // Multiplies by the transpose of the linear part.
    Vec3 transposed(const Vec3& v) const { return row[0] * v.x + row[1] * v.y + row[2] * v.z; }
    float determinant() const { return dot(row[0], cross(row[1], row[2])); }
    Transform inverse() const {
        const float inv_det = 1.0f / determinant();
        const Vec3 c0 = cross(row[1], row[2]) * inv_det, c1 = cross(row[2], row[0]) * inv_det,
                   c2 = cross(row[0], row[1]) * inv_det;  // columns of the inverse
        Transform t;
        t.row = {Vec3(c0.x, c1.x, c2.x), Vec3(c0.y, c1.y, c2.y), Vec3(c0.z, c1.z, c2.z)};
        t.translation = t.vector(translation) * -1.0f;
        return t;
    }
    Vec3 column(int i) const { return {row[0][i], row[1][i], row[2][i]}; }
};

struct Ray {
    Vec3 origin;
    Vec3 direction;  // unit
    float t_near = 0.0f;
    float t_far = kInfinity;
};

// Where a ray goes on that looks through what it met at t. The same ray meets the same surface at
// the same t again, to the last bits of a division: some units in the last place are past it, and
// whatever stands farther behind than single precision can tell is still met.
inline float past(float t) {
    constexpr float kUnits = 0x1p-21f;  // 4 to 8 units in the last place
    return std::max(t * (1.0f + kUnits), std::numeric_limits<float>::min());
}

}  // namespace spc
