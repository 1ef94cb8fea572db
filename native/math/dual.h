// SPDX-License-Identifier: GPL-3.0-or-later
// Forward differentiation in two variables: a value with its derivatives by the surface parameters
// (u, v). Code that must serve both plain evaluation and derivatives is written over T in {float,
// Dual2}; where derivatives of derivatives are asked for, over Dual<Dual2> too.
#pragma once

#include "math/vec.h"

namespace spc {

template <class S>
struct Dual {
    S v{};   // value
    S du{};  // d/du
    S dv{};  // d/dv

    constexpr Dual() = default;
    constexpr Dual(float value) : v(value) {}  // NOLINT(google-explicit-constructor): a constant
    constexpr Dual(const S& value, const S& by_u, const S& by_v) : v(value), du(by_u), dv(by_v) {}

    friend Dual operator-(const Dual& a) { return {-a.v, -a.du, -a.dv}; }
    friend Dual operator+(const Dual& a, const Dual& b) {
        return {a.v + b.v, a.du + b.du, a.dv + b.dv};
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        return {a.v - b.v, a.du - b.du, a.dv - b.dv};
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        return {a.v * b.v, a.du * b.v + a.v * b.du, a.dv * b.v + a.v * b.dv};
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        const S inv = S(1.0f) / b.v, q = a.v * inv;
        return {q, (a.du - q * b.du) * inv, (a.dv - q * b.dv) * inv};
    }
    friend Dual& operator+=(Dual& a, const Dual& b) { return a = a + b; }
};
using Dual2 = Dual<float>;

inline float value_of(float a) { return a; }
template <class S>
float value_of(const Dual<S>& a) {
    return value_of(a.v);
}

// f(a) given f and f' at a.v.
template <class S>
Dual<S> chain(const Dual<S>& a, const S& f, const S& derivative) {
    return {f, derivative * a.du, derivative * a.dv};
}

template <class S>
Dual<S> sqrt(const Dual<S>& a) {
    using std::sqrt;
    const S s = sqrt(a.v);
    return chain(a, s, value_of(s) > 0.0f ? S(0.5f) / s : S(0.0f));
}
template <class S>
Dual<S> pow(const Dual<S>& a, float exponent) {
    using std::pow;
    return chain(a, S(pow(a.v, exponent)), S(exponent) * S(pow(a.v, exponent - 1.0f)));
}

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
template <class T>
Vec3 value_of(const Vector3<T>& a) {
    return {value_of(a.x), value_of(a.y), value_of(a.z)};
}
inline Vec3 derivative_u(const Vector3<Dual2>& a) { return {a.x.du, a.y.du, a.z.du}; }
inline Vec3 derivative_v(const Vector3<Dual2>& a) { return {a.x.dv, a.y.dv, a.z.dv}; }
inline Vector3<Dual2> dual(const Vec3& value, const Vec3& by_u, const Vec3& by_v) {
    return {{value.x, by_u.x, by_v.x}, {value.y, by_u.y, by_v.y}, {value.z, by_u.z, by_v.z}};
}

}  // namespace spc
