// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of single numbers that shading needs, over T = float or a dual. They hold everywhere:
// where mathematics has no value they give Cycles' one, and derivatives that are not finite are 0.
#pragma once

#include "math/dual.h"

namespace spc {

template <class S>
Dual<S> cos(const Dual<S>& a);
template <class S>
Dual<S> sin(const Dual<S>& a) {
    using std::cos, std::sin;
    return chain(a, S(sin(a.v)), S(cos(a.v)));
}
template <class S>
Dual<S> cos(const Dual<S>& a) {
    using std::cos, std::sin;
    return chain(a, S(cos(a.v)), S(-sin(a.v)));
}
template <class S>
Dual<S> atan2(const Dual<S>& y, const Dual<S>& x) {
    using std::atan2;
    const S r2 = x.v * x.v + y.v * y.v;
    const S inv = value_of(r2) > 0.0f ? S(1.0f) / r2 : S(0.0f);
    return {atan2(y.v, x.v), (x.v * y.du - y.v * x.du) * inv, (x.v * y.dv - y.v * x.dv) * inv};
}
inline float safe_acos(float a) { return std::acos(std::min(std::max(a, -1.0f), 1.0f)); }
template <class S>
Dual<S> safe_acos(const Dual<S>& a) {
    using std::sqrt;
    const S s2 = S(1.0f) - a.v * a.v;
    return chain(a, safe_acos(a.v), value_of(s2) > 0.0f ? S(-1.0f) / S(sqrt(s2)) : S(0.0f));
}
// Product with a plain number. Without this the compiler must keep the products with its zero
// derivatives.
inline float times(float a, float s) { return a * s; }
template <class S>
Dual<S> times(const Dual<S>& a, float s) {
    return {times(a.v, s), times(a.du, s), times(a.dv, s)};
}
template <class T>
Vector3<T> times(const Vector3<T>& a, float s) {
    return {times(a.x, s), times(a.y, s), times(a.z, s)};
}
// Zero for a NaN too.
template <class T>
T non_negative(const T& a) {
    return value_of(a) > 0.0f ? a : T(0.0f);
}
template <class T>
T clamp_unit(const T& a) {
    return value_of(a) < 1.0f ? non_negative(a) : value_of(a) >= 1.0f ? T(1.0f) : T(0.0f);
}
template <class T>
T safe_divide(const T& a, const T& b) {
    return value_of(b) != 0.0f ? a / b : T(0.0f);
}
template <class T>
T safe_root(const T& a) {
    using std::sqrt;
    return value_of(a) > 0.0f ? sqrt(a) : T(0.0f);
}
template <class T>
Vector3<T> safe_normalize(const Vector3<T>& a) {
    using std::sqrt;
    const T l2 = dot(a, a);
    return value_of(l2) > 0.0f ? a * (T(1.0f) / sqrt(l2)) : Vector3<T>{};
}

// ---- more functions of duals, by the chain rule

inline float finite_or_zero(float a) { return std::isfinite(a) ? a : 0.0f; }
template <class S>
Dual<S> finite_or_zero(const Dual<S>& a) {
    return {a.v, finite_or_zero(a.du), finite_or_zero(a.dv)};
}
template <class S>
Dual<S> exp(const Dual<S>& a) {
    using std::exp;
    const S e = exp(a.v);
    return chain(a, e, e);
}
template <class S>
Dual<S> log(const Dual<S>& a) {
    using std::log;
    return chain(a, S(log(a.v)), S(1.0f) / a.v);
}
template <class S>
Dual<S> tan(const Dual<S>& a) {
    using std::tan;
    const S t = tan(a.v);
    return chain(a, t, S(1.0f) + t * t);
}
template <class S>
Dual<S> atan(const Dual<S>& a) {
    using std::atan;
    return chain(a, S(atan(a.v)), S(1.0f) / (S(1.0f) + a.v * a.v));
}
template <class S>
Dual<S> cosh(const Dual<S>& a);
template <class S>
Dual<S> sinh(const Dual<S>& a) {
    using std::cosh, std::sinh;
    return chain(a, S(sinh(a.v)), S(cosh(a.v)));
}
template <class S>
Dual<S> cosh(const Dual<S>& a) {
    using std::cosh, std::sinh;
    return chain(a, S(cosh(a.v)), S(sinh(a.v)));
}
template <class S>
Dual<S> tanh(const Dual<S>& a) {
    using std::tanh;
    const S t = tanh(a.v);
    return chain(a, t, S(1.0f) - t * t);
}

// ---- what steps has no derivative

template <class T>
T floor_of(const T& a) {
    return T(std::floor(value_of(a)));
}
template <class T>
T smaller(const T& a, const T& b) {
    return value_of(a) < value_of(b) ? a : b;
}
template <class T>
T larger(const T& a, const T& b) {
    return value_of(a) > value_of(b) ? a : b;
}
template <class T>
T absolute(const T& a) {
    return value_of(a) < 0.0f ? T(0.0f) - a : a;
}
template <class T>
T fraction(const T& a) {
    return a - floor_of(a);
}

// ---- Math's

// Of a negative number for whole exponents alone; 0 elsewhere.
template <class T>
T safe_power(const T& a, const T& b) {
    using std::exp, std::log;
    const float base = value_of(a), exponent = value_of(b);
    if (exponent == 0.0f) return T(1.0f);
    if (base == 0.0f) return T(0.0f);
    if (base < 0.0f && exponent != std::trunc(exponent)) return T(0.0f);
    const float power = std::pow(base, exponent);
    if constexpr (std::is_same_v<T, float>) {
        return power;
    } else {
        // d(a^b) = a^b (b da / a + log |a| db)
        const T slope = b * log(absolute(a));
        const T magnitude = exp(slope);
        T result =
            base < 0.0f && std::fmod(exponent, 2.0f) != 0.0f ? T(0.0f) - magnitude : magnitude;
        return finite_or_zero(result);
    }
}
template <class T>
T safe_log(const T& a, const T& base) {
    using std::log;
    if (!(value_of(a) > 0.0f) || !(value_of(base) > 0.0f)) return T(0.0f);
    return safe_divide(T(log(a)), T(log(base)));
}
template <class T>
T inverse_root(const T& a) {
    return value_of(a) > 0.0f ? T(1.0f) / safe_root(a) : T(0.0f);
}
template <class T>
T safe_asin(const T& a) {
    return T(0.5f * kPi) - safe_acos(a);
}
// Of the sign of a.
template <class T>
T modulo(const T& a, const T& b) {
    const float dividend = value_of(a), divisor = value_of(b);
    if (divisor == 0.0f) return T(0.0f);
    const float rest = std::fmod(dividend, divisor);
    if constexpr (std::is_same_v<T, float>) return rest;
    return a - b * T(std::round((dividend - rest) / divisor));
}
// Of the sign of b.
template <class T>
T floored_modulo(const T& a, const T& b) {
    return value_of(b) != 0.0f ? a - b * floor_of(a / b) : T(0.0f);
}
template <class T>
T wrapped(const T& a, const T& max, const T& min) {
    const T range = max - min;
    return value_of(range) != 0.0f ? a - range * floor_of((a - min) / range) : min;
}
template <class T>
T ping_pong(const T& a, const T& scale) {
    if (value_of(scale) == 0.0f) return T(0.0f);
    const T twice = scale * T(2.0f);
    return absolute(fraction((a - scale) / twice) * twice - scale);
}
template <class T>
T snapped(const T& a, const T& step) {
    return floor_of(safe_divide(a, step)) * step;
}
template <class T>
T clamped(const T& a, const T& min, const T& max) {
    return smaller(larger(a, min), max);
}
// From 0 to 1 between two values in either order, by a cubic or a polynomial of degree five.
template <class T>
T smoothstep(const T& a, const T& from, const T& to) {
    const T t = clamp_unit(safe_divide(a - from, to - from));
    return t * t * (T(3.0f) - times(t, 2.0f));
}
template <class T>
T smootherstep(const T& a, const T& from, const T& to) {
    const T t = clamp_unit(safe_divide(a - from, to - from));
    return t * t * t * (t * (times(t, 6.0f) - T(15.0f)) + T(10.0f));
}
// The smaller one, rounded by a cubic over the distance k.
template <class T>
T smooth_min(const T& a, const T& b, const T& k) {
    if (value_of(k) == 0.0f) return smaller(a, b);
    const T h = larger(k - absolute(a - b), T(0.0f)) / k;
    return smaller(a, b) - h * h * h * k * T(1.0f / 6);
}

// Shares of the pictures on a box's sides, by the normal of what they are thrown on. Within a
// `blend` of the edges two of them mix, at the corners all three.
template <class T>
Vector3<T> box_weights(const Vector3<T>& normal, const T& blend) {
    std::array<T, 3> n{absolute(normal.x), absolute(normal.y), absolute(normal.z)};
    const T sum = n[0] + n[1] + n[2], one(1.0f), half(0.5f);
    for (T& a : n) a = safe_divide(a, sum);
    const T limit = (one + blend) * half;
    const float most = value_of(limit);
    std::array<T, 3> weights{T(0.0f), T(0.0f), T(0.0f)};
    const auto result = [&] { return Vector3<T>{weights[0], weights[1], weights[2]}; };
    for (size_t i = 0; i < 3; ++i) {
        const float own = value_of(n[i]), next = value_of(n[(i + 1) % 3]),
                    last = value_of(n[(i + 2) % 3]);
        if (!(own > most * (own + next) && own > most * (own + last))) continue;
        weights[i] = one;
        return result();
    }
    if (!(value_of(blend) > 0.0f)) {
        weights[0] = one;
        return result();
    }
    for (const auto& [a, b, without] : {std::array<size_t, 3>{0, 1, 2}, {1, 2, 0}, {0, 2, 1}}) {
        const T both = n[a] + n[b];
        if (!(value_of(n[without]) < (1.0f - most) * value_of(both))) continue;
        weights[a] = clamped((n[a] / both - (one - blend) * half) / blend, T(0.0f), one);
        weights[b] = one - weights[a];
        return result();
    }
    for (size_t i = 0; i < 3; ++i)
        weights[i] = (n[i] * (T(2.0f) - limit) + limit - one) / (limit * T(2.0f) - one);
    return result();
}

}  // namespace spc
