// SPDX-License-Identifier: GPL-3.0-or-later
// What the arithmetic instructions do, over T = float or a dual. The interpreter and the folding of
// constants share it, so that a constant graph and a textured one cannot disagree.
#pragma once

#include "math/dual.h"
#include "shading/instruction.h"

namespace spc {

// ---- the functions of duals that only shading needs

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
// Product with a plain number. Without this the compiler must keep the products with its zero derivatives.
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
// Transpose of constant rows applied to a vector.
template <class T>
Vector3<T> apply_transposed(const std::array<Vec3, 3>& row, const Vector3<T>& a) {
    const auto component = [&](int i) {
        return times(a.x, row[0][i]) + times(a.y, row[1][i]) + times(a.z, row[2][i]);
    };
    return {component(0), component(1), component(2)};
}

// ---- functions of nodes

// Blender's Euler order XYZ: x first. `back` applies the inverse.
template <class T>
Vector3<T> rotate_euler(const Vector3<T>& a, const Vector3<T>& angles, bool back) {
    using std::cos, std::sin;
    const T cx = cos(angles.x), cy = cos(angles.y), cz = cos(angles.z);
    const T sx = sin(angles.x), sy = sin(angles.y), sz = sin(angles.z);
    const Vector3<T> r0{cy * cz, sy * sx * cz - cx * sz, sy * cx * cz + sx * sz};
    const Vector3<T> r1{cy * sz, sy * sx * sz + cx * cz, sy * cx * sz - sx * cz};
    const Vector3<T> r2{T(0.0f) - sy, cy * sx, cy * cx};
    if (back) return r0 * a.x + r1 * a.y + r2 * a.z;
    return {dot(r0, a), dot(r1, a), dot(r2, a)};
}

// Principled's dielectric: Specular IOR Level scales the reflectance at normal incidence, 0.5
// leaves it.
template <class T>
T dielectric_ior(const T& ior, const T& level) {
    if (value_of(level) == 0.5f) return ior;
    const T ratio = (ior - T(1.0f)) / (ior + T(1.0f));
    T f0 = ratio * ratio * T(2.0f) * non_negative(level);
    if (value_of(f0) > 0.99f) f0 = T(0.99f);
    const T root = safe_root(f0);
    const T adjusted = (T(1.0f) + root) / (T(1.0f) - root);
    return value_of(ior) < 1.0f ? T(1.0f) / adjusted : adjusted;
}

// Where a direction falls in an environment image, in Blender's orientation: +X is at the image's
// centre, u falls from there towards +Y, v rises from -Z to +Z.
template <class T>
Vector3<T> equirectangular(const Vector3<T>& direction) {
    using std::atan2;
    const Vector3<T> d = safe_normalize(direction);
    const T azimuth = value_of(d.x) == 0.0f && value_of(d.y) == 0.0f ? T(0.0f) : atan2(d.y, d.x);
    return {T(0.5f) - azimuth * T(0.5f * kInvPi), T(1.0f) - safe_acos(d.z) * T(kInvPi), T(0.0f)};
}
template <class T>
Vector3<T> mirror_ball(const Vector3<T>& direction) {
    const Vector3<T> d = safe_normalize(direction);
    const T y = d.y - T(1.0f);
    const T scale = T(2.0f) * safe_root(T(-0.5f) * y);
    const T inv = value_of(scale) > 0.0f ? T(1.0f) / scale : T(1.0f);
    return {T(0.5f) * (d.x * inv + T(1.0f)), T(0.5f) * (d.z * inv + T(1.0f)), T(0.0f)};
}

// ---- operands and the instructions themselves

template <class T>
struct Registers {
    T* reg;
    const float* constants;

    T scalar(Operand i) const { return i >= 0 ? reg[i] : T(constants[~i]); }
    Vector3<T> vector(Operand i) const {
        if (i >= 0) return {reg[i], reg[i + 1], reg[i + 2]};
        const float* c = constants + ~i;
        return {T(c[0]), T(c[1]), T(c[2])};
    }
    void store(Operand out, const T& a) const { reg[out] = a; }
    void store(Operand out, const Vector3<T>& a) const {
        reg[out] = a.x;
        reg[out + 1] = a.y;
        reg[out + 2] = a.z;
    }
};

template <class T, class Function>
void each_lane(const Registers<T>& r, const Instruction& i, const Function& function) {
    if (i.lanes == 1) return r.store(i.out, function(r.scalar(i.in[0])));
    const Vector3<T> a = r.vector(i.in[0]);
    r.store(i.out, Vector3<T>{function(a.x), function(a.y), function(a.z)});
}
template <class T, class Function>
void each_lane2(const Registers<T>& r, const Instruction& i, const Function& function) {
    if (i.lanes == 1) return r.store(i.out, function(r.scalar(i.in[0]), r.scalar(i.in[1])));
    const Vector3<T> a = r.vector(i.in[0]), b = r.vector(i.in[1]);
    r.store(i.out, Vector3<T>{function(a.x, b.x), function(a.y, b.y), function(a.z, b.z)});
}

// Instructions that read a point are not for here: they do nothing.
template <class T>
void run_arithmetic(const Instruction& i, const Registers<T>& r) {
    switch (i.op) {
        case Op::add: return each_lane2(r, i, [](T a, T b) { return a + b; });
        case Op::subtract: return each_lane2(r, i, [](T a, T b) { return a - b; });
        case Op::multiply: return each_lane2(r, i, [](T a, T b) { return a * b; });
        case Op::divide: return each_lane2(r, i, [](T a, T b) { return safe_divide(a, b); });
        case Op::scale: return r.store(i.out, r.vector(i.in[0]) * r.scalar(i.in[1]));
        case Op::one_minus: return each_lane(r, i, [](T a) { return T(1.0f) - a; });
        case Op::clamp01: return each_lane(r, i, [](T a) { return clamp_unit(a); });
        case Op::non_negative: return each_lane(r, i, [](T a) { return non_negative(a); });
        case Op::maximum:
            return each_lane2(r, i, [](T a, T b) { return value_of(a) > value_of(b) ? a : b; });
        case Op::square_root: return each_lane(r, i, [](T a) { return safe_root(a); });
        case Op::luminance: {
            const Vector3<T> c = r.vector(i.in[0]);
            return r.store(
                i.out, times(c.x, 0.2126729f) + times(c.y, 0.7151522f) + times(c.z, 0.0721750f));
        }
        case Op::mean: {
            const Vector3<T> a = r.vector(i.in[0]);
            return r.store(i.out, times(a.x + a.y + a.z, 1.0f / 3.0f));
        }
        case Op::splat: {
            const T a = r.scalar(i.in[0]);
            return r.store(i.out, Vector3<T>{a, a, a});
        }
        case Op::normalize: return r.store(i.out, safe_normalize(r.vector(i.in[0])));
        case Op::affine: {
            const Vector3<T> a = r.vector(i.in[0]);
            const float* m = r.constants + i.index;
            const auto row = [&](const float* k) {
                return times(a.x, k[0]) + times(a.y, k[1]) + times(a.z, k[2]) + T(k[3]);
            };
            return r.store(i.out, Vector3<T>{row(m), row(m + 4), row(m + 8)});
        }
        case Op::rotate:
            return r.store(i.out, rotate_euler(r.vector(i.in[0]), r.vector(i.in[1]), false));
        case Op::rotate_back:
            return r.store(i.out, rotate_euler(r.vector(i.in[0]), r.vector(i.in[1]), true));
        case Op::dielectric_ior:
            return r.store(i.out, dielectric_ior(r.scalar(i.in[0]), r.scalar(i.in[1])));
        case Op::combine:
            return r.store(i.out,
                           Vector3<T>{r.scalar(i.in[0]), r.scalar(i.in[1]), r.scalar(i.in[2])});
        case Op::equirectangular: return r.store(i.out, equirectangular(r.vector(i.in[0])));
        case Op::mirror_ball: return r.store(i.out, mirror_ball(r.vector(i.in[0])));
        default: return;
    }
}

}  // namespace spc
