// SPDX-License-Identifier: GPL-3.0-or-later
// Forward differentiation in two variables: a value with its derivatives by the surface parameters
// (u, v). Code that must serve both plain evaluation and derivatives is written over T in {float,
// Dual2}.
#pragma once

#include "math/vec.h"

namespace spc {

struct Dual2 {
    float v = 0.0f;   // value
    float du = 0.0f;  // d/du
    float dv = 0.0f;  // d/dv

    constexpr Dual2() = default;
    constexpr Dual2(float value) : v(value) {}  // NOLINT(google-explicit-constructor): a constant
    constexpr Dual2(float value, float by_u, float by_v) : v(value), du(by_u), dv(by_v) {}
};

inline Dual2 operator-(Dual2 a) { return {-a.v, -a.du, -a.dv}; }
inline Dual2 operator+(Dual2 a, Dual2 b) { return {a.v + b.v, a.du + b.du, a.dv + b.dv}; }
inline Dual2 operator-(Dual2 a, Dual2 b) { return {a.v - b.v, a.du - b.du, a.dv - b.dv}; }
inline Dual2 operator*(Dual2 a, Dual2 b) {
    return {a.v * b.v, a.du * b.v + a.v * b.du, a.dv * b.v + a.v * b.dv};
}
inline Dual2 operator/(Dual2 a, Dual2 b) {
    const float inv = 1.0f / b.v, q = a.v * inv;
    return {q, (a.du - q * b.du) * inv, (a.dv - q * b.dv) * inv};
}
inline Dual2& operator+=(Dual2& a, Dual2 b) { return a = a + b; }

// f(a) given f and f' at a.v.
inline Dual2 chain(Dual2 a, float f, float derivative) {
    return {f, derivative * a.du, derivative * a.dv};
}

inline Dual2 sqrt(Dual2 a) {
    const float s = std::sqrt(a.v);
    return chain(a, s, s > 0.0f ? 0.5f / s : 0.0f);
}
inline float value_of(float a) { return a; }
inline float value_of(Dual2 a) { return a.v; }

// A vector over T; Imath's own for T = float would not take Dual2.
template <class T>
struct Vector3 {
    T x{}, y{}, z{};
};
template <class T>
Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vector3<T> operator*(const Vector3<T>& a, const T& s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
Vector3<T> normalize(const Vector3<T>& a) {
    using std::sqrt;
    const T inv = T(1.0f) / sqrt(dot(a, a));
    return a * inv;
}
// Constant linear map (rows) applied to a dual vector.
template <class T>
Vector3<T> apply_rows(const std::array<Vec3, 3>& row, const Vector3<T>& a) {
    const auto component = [&](const Vec3& r) { return T(r.x) * a.x + T(r.y) * a.y + T(r.z) * a.z; };
    return {component(row[0]), component(row[1]), component(row[2])};
}

inline Vector3<float> to_vector(const Vec3& a) { return {a.x, a.y, a.z}; }
inline Vec3 value_of(const Vector3<float>& a) { return {a.x, a.y, a.z}; }
inline Vec3 value_of(const Vector3<Dual2>& a) { return {a.x.v, a.y.v, a.z.v}; }
inline Vec3 derivative_u(const Vector3<Dual2>& a) { return {a.x.du, a.y.du, a.z.du}; }
inline Vec3 derivative_v(const Vector3<Dual2>& a) { return {a.x.dv, a.y.dv, a.z.dv}; }
inline Vector3<Dual2> dual(const Vec3& value, const Vec3& by_u, const Vec3& by_v) {
    return {{value.x, by_u.x, by_v.x}, {value.y, by_u.y, by_v.y}, {value.z, by_u.z, by_v.z}};
}

}  // namespace spc
