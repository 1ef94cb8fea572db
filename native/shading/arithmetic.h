// SPDX-License-Identifier: GPL-3.0-or-later
// What the arithmetic instructions do, over T = float or a dual. The interpreter and the folding of
// constants share it, so that a constant graph and a textured one cannot disagree.
#pragma once

#include "bsdf/fresnel.h"
#include "shading/color_functions.h"
#include "shading/instruction.h"
#include "shading/light_profile.h"
#include "shading/textures.h"

namespace spc {

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

// About an axis, counter-clockwise where it points to the viewer; without one nothing turns.
template <class T>
Vector3<T> rotate_axis(const Vector3<T>& a, const Vector3<T>& axis, const T& angle) {
    using std::cos, std::sin;
    const Vector3<T> k = safe_normalize(axis);
    if (value_of(dot(k, k)) == 0.0f) return a;
    const T c = cos(angle), s = sin(angle);
    return a * c + cross(k, a) * s + k * (dot(k, a) * (T(1.0f) - c));
}

// Of a direction at a plane with any normal, which is normalised.
template <class T>
Vector3<T> reflected(const Vector3<T>& a, const Vector3<T>& normal) {
    const Vector3<T> n = safe_normalize(normal);
    return a - n * times(dot(n, a), 2.0f);
}
// Zero at total internal reflection.
template <class T>
Vector3<T> refracted(const Vector3<T>& a, const Vector3<T>& normal, const T& ratio) {
    const Vector3<T> n = safe_normalize(normal);
    const T cos_a = dot(n, a);
    const T k = T(1.0f) - ratio * ratio * (T(1.0f) - cos_a * cos_a);
    if (value_of(k) < 0.0f) return {};
    return a * ratio - n * (ratio * cos_a + safe_root(k));
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

// Entry number `at` of `count` equally spaced ones, between them by a step, a line or a cubic
// B-spline; beyond the ends they hold.
template <class T, class Entry>
T look_up(const Entry& entry, int count, const T& at, Interpolation interpolation) {
    const float last = static_cast<float>(count - 1);
    const int i = static_cast<int>(std::min(non_negative(value_of(at)), last));
    const auto value = [&](int k) { return T(entry(std::clamp(k, 0, count - 1))); };
    if (interpolation == Interpolation::closest) return value(i);
    const T t = value_of(at) < last ? non_negative(at) - T(static_cast<float>(i)) : T(0.0f);
    if (interpolation == Interpolation::linear) return value(i) + (value(i + 1) - value(i)) * t;
    const T s = T(1.0f) - t;
    const T w0 = s * s * s, w3 = t * t * t;
    const T w1 = T(4.0f) + t * t * (T(3.0f) * t - T(6.0f)),
            w2 = T(4.0f) + s * s * (T(3.0f) * s - T(6.0f));
    return times(value(i - 1) * w0 + value(i) * w1 + value(i + 1) * w2 + value(i + 2) * w3,
                 1.0f / 6);
}

// ---- operands and the instructions themselves

// Where an instruction finds its operands, number k of instruction `i`.
template <class T>
struct Registers {
    T* reg;
    const float* constants;
    const Operand* operands;
    const float* blocks;

    Operand operand(const Instruction& i, int k) const {
        return operands[i.operands + static_cast<uint32_t>(k)];
    }
    T scalar(const Instruction& i, int k) const { return scalar(operand(i, k)); }
    Vector3<T> vector(const Instruction& i, int k) const { return vector(operand(i, k)); }
    T scalar(Operand i) const { return i >= 0 ? reg[i] : T(constants[~i]); }
    Vector3<T> vector(Operand i) const {
        if (i >= 0) return {reg[i], reg[i + 1], reg[i + 2]};
        const float* c = constants + ~i;
        return {T(c[0]), T(c[1]), T(c[2])};
    }
    T lane(Operand i, int lane) const { return i >= 0 ? reg[i + lane] : T(constants[~i + lane]); }
    void store(Operand out, const T& a) const { reg[out] = a; }
    void store(Operand out, const Vector3<T>& a) const {
        reg[out] = a.x;
        reg[out + 1] = a.y;
        reg[out + 2] = a.z;
    }
};

template <class T, class Function>
void each_lane(const Registers<T>& r, const Instruction& i, const Function& function) {
    if (i.lanes == 1) return r.store(i.out, function(r.scalar(i, 0)));
    const Vector3<T> a = r.vector(i, 0);
    r.store(i.out, Vector3<T>{function(a.x), function(a.y), function(a.z)});
}
template <class T, class Function>
void each_lane2(const Registers<T>& r, const Instruction& i, const Function& function) {
    if (i.lanes == 1) return r.store(i.out, function(r.scalar(i, 0), r.scalar(i, 1)));
    const Vector3<T> a = r.vector(i, 0), b = r.vector(i, 1);
    r.store(i.out, Vector3<T>{function(a.x, b.x), function(a.y, b.y), function(a.z, b.z)});
}

template <class T, class Function>
void each_lane3(const Registers<T>& r, const Instruction& i, const Function& function) {
    if (i.lanes == 1)
        return r.store(i.out, function(r.scalar(i, 0), r.scalar(i, 1), r.scalar(i, 2)));
    const Vector3<T> a = r.vector(i, 0), b = r.vector(i, 1), c = r.vector(i, 2);
    r.store(i.out,
            Vector3<T>{function(a.x, b.x, c.x), function(a.y, b.y, c.y), function(a.z, b.z, c.z)});
}

// The block is the number of rows, then the rows.
template <class T>
void run_ramp(const Instruction& i, const Registers<T>& r) {
    const float* block = r.blocks + i.index;
    const int count = static_cast<int>(block[0]);
    const T at = times(clamp_unit(r.scalar(i, 0)), static_cast<float>(count - 1));
    for (int lane = 0; lane < 4; ++lane)
        r.store(static_cast<Operand>(i.out + lane),
                look_up([&](int k) { return block[1 + 4 * k + lane]; }, count, at,
                        mode_interpolation(i.mode)));
}

// The operands of noise from its third one on.
template <class T>
Fractal<T> read_fractal(const Instruction& i, const Registers<T>& r) {
    return {.type = mode_fractal(i.mode),
            .normalized = mode_normalized(i.mode),
            .detail = r.scalar(i, 2),
            .roughness = non_negative(r.scalar(i, 3)),
            .lacunarity = r.scalar(i, 4),
            .offset = r.scalar(i, 5),
            .gain = r.scalar(i, 6)};
}
template <class T>
Wave<T> read_wave(const Instruction& i, const Registers<T>& r) {
    return {.shape = mode_wave_shape(i.mode),
            .profile = mode_wave_profile(i.mode),
            .distortion = r.scalar(i, 1),
            .detail = r.scalar(i, 2),
            .detail_scale = r.scalar(i, 3),
            .detail_roughness = non_negative(r.scalar(i, 4)),
            .phase = r.scalar(i, 5)};
}
template <class T>
Voronoi<T> read_voronoi(const Instruction& i, const Registers<T>& r) {
    const T none(0.0f);
    return {.feature = mode_voronoi_feature(i.mode),
            .metric = mode_voronoi_metric(i.mode),
            .hash = mode_voronoi_hash(i.mode),
            .normalized = mode_voronoi_normalized(i.mode),
            .detail = clamped(r.scalar(i, 2), none, T(kMostDetail)),
            .roughness = clamp_unit(r.scalar(i, 3)),
            .lacunarity = r.scalar(i, 4),
            .smoothness = clamped(times(r.scalar(i, 5), 0.5f), none, T(0.5f)),
            .exponent = r.scalar(i, 6),
            .randomness = clamp_unit(r.scalar(i, 7))};
}
template <class T>
void run_voronoi(const Instruction& i, const Registers<T>& r) {
    const Voronoi<T> v = read_voronoi(i, r);
    in_dimensions(mode_dimensions(i.mode), r.vector(i, 0), r.scalar(i, 1), [&](const auto& p) {
        const auto found = voronoi_at(v, p);
        if (i.op == Op::voronoi) return r.store(i.out, found.distance);
        if (i.op == Op::voronoi_color) return r.store(i.out, found.color);
        const std::array<T, 4> position = as_vector_and_w(found.position);
        for (int lane = 0; lane < 4; ++lane)
            r.store(static_cast<Operand>(i.out + lane), position[static_cast<size_t>(lane)]);
    });
}
// The block is offset, its frequency, squash, its frequency.
template <class T>
Brick<T> read_brick(const Instruction& i, const Registers<T>& r) {
    const float* block = r.blocks + i.index;
    return {.mortar_size = r.scalar(i, 1),
            .mortar_smooth = r.scalar(i, 2),
            .bias = r.scalar(i, 3),
            .width = r.scalar(i, 4),
            .row_height = r.scalar(i, 5),
            .offset = block[0],
            .squash = block[2],
            .offset_every = static_cast<int>(block[1]),
            .squash_every = static_cast<int>(block[3])};
}

// The block is the number of rows, whether curves go on straight beyond their ends, where they
// begin and end, then the rows.
template <class T>
T follow_curve(const float* block, int lanes, int lane, const T& a, Interpolation interpolation) {
    const int count = static_cast<int>(block[0]);
    const float last = static_cast<float>(count - 1), begin = block[2], end = block[3];
    const auto entry = [&](int k) { return block[4 + lanes * k + lane]; };
    const T at = times(a - T(begin), last / (end - begin));
    const T inside = look_up(entry, count, at, interpolation);
    const float place = value_of(at);
    if (block[1] == 0.0f || (place >= 0.0f && place <= last)) return inside;
    const float edge = place < 0.0f ? 0.0f : last;
    const float slope = place < 0.0f ? entry(1) - entry(0) : entry(count - 1) - entry(count - 2);
    return inside + times(at - T(edge), slope);
}

template <class T>
void run_curves(const Instruction& i, const Registers<T>& r) {
    const float* block = r.blocks + i.index;
    const Interpolation interpolation = mode_interpolation(i.mode);
    const auto follow = [&](const T& a, int lane) {
        return follow_curve(block, i.lanes, lane, a, interpolation);
    };
    if (i.lanes == 1) return r.store(i.out, follow(r.scalar(i, 0), 0));
    const Vector3<T> a = r.vector(i, 0);
    r.store(i.out, Vector3<T>{follow(a.x, 0), follow(a.y, 1), follow(a.z, 2)});
}

// Operations that vary with the point are not for here: they do nothing.
template <class T>
void run_arithmetic(const Instruction& i, const Registers<T>& r) {
    using std::atan, std::atan2, std::cos, std::cosh, std::exp, std::sin, std::sinh, std::tan,
        std::tanh;
    switch (i.op) {
        case Op::add: return each_lane2(r, i, [](T a, T b) { return a + b; });
        case Op::subtract: return each_lane2(r, i, [](T a, T b) { return a - b; });
        case Op::multiply: return each_lane2(r, i, [](T a, T b) { return a * b; });
        case Op::divide: return each_lane2(r, i, [](T a, T b) { return safe_divide(a, b); });
        case Op::scale: return r.store(i.out, r.vector(i, 0) * r.scalar(i, 1));
        case Op::one_minus: return each_lane(r, i, [](T a) { return T(1.0f) - a; });
        case Op::clamp01: return each_lane(r, i, [](T a) { return clamp_unit(a); });
        case Op::non_negative: return each_lane(r, i, [](T a) { return non_negative(a); });
        case Op::maximum:
            return each_lane2(r, i, [](T a, T b) { return value_of(a) > value_of(b) ? a : b; });
        case Op::square_root: return each_lane(r, i, [](T a) { return safe_root(a); });
        case Op::luminance: {
            const Vector3<T> c = r.vector(i, 0);
            return r.store(
                i.out, times(c.x, 0.2126729f) + times(c.y, 0.7151522f) + times(c.z, 0.0721750f));
        }
        case Op::mean: {
            const Vector3<T> a = r.vector(i, 0);
            return r.store(i.out, times(a.x + a.y + a.z, 1.0f / 3.0f));
        }
        case Op::splat: {
            const T a = r.scalar(i, 0);
            return r.store(i.out, Vector3<T>{a, a, a});
        }
        case Op::normalize: return r.store(i.out, safe_normalize(r.vector(i, 0)));
        case Op::affine: {
            const Vector3<T> a = r.vector(i, 0);
            const float* m = r.blocks + i.index;
            const auto row = [&](const float* k) {
                return times(a.x, k[0]) + times(a.y, k[1]) + times(a.z, k[2]) + T(k[3]);
            };
            return r.store(i.out, Vector3<T>{row(m), row(m + 4), row(m + 8)});
        }
        case Op::rotate: return r.store(i.out, rotate_euler(r.vector(i, 0), r.vector(i, 1), false));
        case Op::rotate_back:
            return r.store(i.out, rotate_euler(r.vector(i, 0), r.vector(i, 1), true));
        case Op::dielectric_ior:
            return r.store(i.out, dielectric_ior(r.scalar(i, 0), r.scalar(i, 1)));
        case Op::combine:
            return r.store(i.out, Vector3<T>{r.scalar(i, 0), r.scalar(i, 1), r.scalar(i, 2)});
        case Op::equirectangular: return r.store(i.out, equirectangular(r.vector(i, 0)));
        case Op::curves: return run_curves(i, r);
        case Op::ramp: return run_ramp(i, r);
        case Op::light_profile: {
            const Vector3<T> at = r.vector(i, 0);
            const Vec3 direction(value_of(at.x), value_of(at.y), value_of(at.z));
            return r.store(i.out, T(LightProfile(r.blocks + i.index).at(direction)));
        }
        case Op::box_weights: return r.store(i.out, box_weights(r.vector(i, 0), r.scalar(i, 1)));
        case Op::absolute: return each_lane(r, i, [](T a) { return absolute(a); });
        case Op::exponent: return each_lane(r, i, [](T a) { return T(exp(a)); });
        case Op::sign:
            return each_lane(r, i, [](T a) {
                return T(static_cast<float>((value_of(a) > 0.0f) - (value_of(a) < 0.0f)));
            });
        case Op::round: return each_lane(r, i, [](T a) { return floor_of(a + T(0.5f)); });
        case Op::floor: return each_lane(r, i, [](T a) { return floor_of(a); });
        case Op::ceil: return each_lane(r, i, [](T a) { return T(std::ceil(value_of(a))); });
        case Op::truncate: return each_lane(r, i, [](T a) { return T(std::trunc(value_of(a))); });
        case Op::fraction: return each_lane(r, i, [](T a) { return fraction(a); });
        case Op::sine: return each_lane(r, i, [](T a) { return T(sin(a)); });
        case Op::cosine: return each_lane(r, i, [](T a) { return T(cos(a)); });
        case Op::tangent: return each_lane(r, i, [](T a) { return T(tan(a)); });
        case Op::arcsine: return each_lane(r, i, [](T a) { return safe_asin(a); });
        case Op::arccosine: return each_lane(r, i, [](T a) { return safe_acos(a); });
        case Op::arctangent: return each_lane(r, i, [](T a) { return T(atan(a)); });
        case Op::sinh: return each_lane(r, i, [](T a) { return T(sinh(a)); });
        case Op::cosh: return each_lane(r, i, [](T a) { return T(cosh(a)); });
        case Op::tanh: return each_lane(r, i, [](T a) { return T(tanh(a)); });
        case Op::inverse_root: return each_lane(r, i, [](T a) { return inverse_root(a); });
        case Op::radians: return each_lane(r, i, [](T a) { return times(a, kPi / 180.0f); });
        case Op::degrees: return each_lane(r, i, [](T a) { return times(a, 180.0f * kInvPi); });
        case Op::power: return each_lane2(r, i, [](T a, T b) { return safe_power(a, b); });
        case Op::logarithm: return each_lane2(r, i, [](T a, T b) { return safe_log(a, b); });
        case Op::minimum: return each_lane2(r, i, [](T a, T b) { return smaller(a, b); });
        case Op::less:
            return each_lane2(r, i,
                              [](T a, T b) { return T(value_of(a) < value_of(b) ? 1.0f : 0.0f); });
        case Op::greater:
            return each_lane2(r, i,
                              [](T a, T b) { return T(value_of(a) > value_of(b) ? 1.0f : 0.0f); });
        case Op::modulo: return each_lane2(r, i, [](T a, T b) { return modulo(a, b); });
        case Op::floored_modulo:
            return each_lane2(r, i, [](T a, T b) { return floored_modulo(a, b); });
        case Op::snap: return each_lane2(r, i, [](T a, T b) { return snapped(a, b); });
        case Op::ping_pong: return each_lane2(r, i, [](T a, T b) { return ping_pong(a, b); });
        case Op::arctan2:
            return each_lane2(r, i, [](T a, T b) {
                return value_of(a) == 0.0f && value_of(b) == 0.0f ? T(0.0f) : T(atan2(a, b));
            });
        case Op::multiply_add: return each_lane3(r, i, [](T a, T b, T c) { return a * b + c; });
        case Op::compare:
            return each_lane3(r, i, [](T a, T b, T c) {
                const float far = std::max(value_of(c), std::numeric_limits<float>::epsilon());
                return T(std::abs(value_of(a) - value_of(b)) <= far ? 1.0f : 0.0f);
            });
        case Op::smooth_min:
            return each_lane3(r, i, [](T a, T b, T c) { return smooth_min(a, b, c); });
        case Op::smooth_max:
            return each_lane3(r, i, [](T a, T b, T c) {
                const T zero(0.0f);
                return zero - smooth_min(zero - a, zero - b, c);
            });
        case Op::wrap: return each_lane3(r, i, [](T a, T b, T c) { return wrapped(a, b, c); });
        case Op::clamp: return each_lane3(r, i, [](T a, T b, T c) { return clamped(a, b, c); });
        case Op::mix: return each_lane3(r, i, [](T a, T b, T t) { return lerp_to(a, b, t); });
        case Op::smoothstep:
            return each_lane3(r, i, [](T a, T b, T c) { return smoothstep(a, b, c); });
        case Op::smootherstep:
            return each_lane3(r, i, [](T a, T b, T c) { return smootherstep(a, b, c); });
        case Op::dot: return r.store(i.out, dot(r.vector(i, 0), r.vector(i, 1)));
        case Op::length: {
            const Vector3<T> a = r.vector(i, 0);
            return r.store(i.out, safe_root(dot(a, a)));
        }
        case Op::distance: {
            const Vector3<T> a = r.vector(i, 0) - r.vector(i, 1);
            return r.store(i.out, safe_root(dot(a, a)));
        }
        case Op::cross: return r.store(i.out, cross(r.vector(i, 0), r.vector(i, 1)));
        case Op::project: {
            const Vector3<T> onto = r.vector(i, 1);
            return r.store(i.out, onto * safe_divide(dot(r.vector(i, 0), onto), dot(onto, onto)));
        }
        case Op::reflect: return r.store(i.out, reflected(r.vector(i, 0), r.vector(i, 1)));
        case Op::refract:
            return r.store(i.out, refracted(r.vector(i, 0), r.vector(i, 1), r.scalar(i, 2)));
        case Op::face_forward: {
            const bool away = value_of(dot(r.vector(i, 2), r.vector(i, 1))) < 0.0f;
            return r.store(i.out, times(r.vector(i, 0), away ? 1.0f : -1.0f));
        }
        case Op::rotate_axis:
            return r.store(i.out, rotate_axis(r.vector(i, 0), r.vector(i, 1), r.scalar(i, 2)));
        case Op::rgb_to_hsv: return r.store(i.out, rgb_to_hsv(r.vector(i, 0)));
        case Op::hsv_to_rgb: return r.store(i.out, hsv_to_rgb(r.vector(i, 0)));
        case Op::rgb_to_hsl: return r.store(i.out, rgb_to_hsl(r.vector(i, 0)));
        case Op::hsl_to_rgb: return r.store(i.out, hsl_to_rgb(r.vector(i, 0)));
        case Op::blend:
            return r.store(i.out, blend(static_cast<Blend>(i.mode), r.vector(i, 0), r.vector(i, 1),
                                        r.scalar(i, 2)));
        case Op::gamma: {
            const T exponent = r.scalar(i, 1);
            const Vector3<T> c = r.vector(i, 0);
            const auto channel = [&](const T& a) {
                if (value_of(exponent) == 0.0f) return T(1.0f);
                return value_of(a) > 0.0f ? safe_power(a, exponent) : a;
            };
            return r.store(i.out, Vector3<T>{channel(c.x), channel(c.y), channel(c.z)});
        }
        case Op::fresnel:
            if constexpr (std::is_same_v<T, float>)
                r.store(i.out, facet::dielectric(r.scalar(i, 0), r.scalar(i, 1)));
            return;
        case Op::sheen_albedo:
            if constexpr (std::is_same_v<T, float>)
                r.store(i.out, sheen_albedo(clamp01(r.scalar(i, 0)),
                                            std::clamp(r.scalar(i, 1), kLeastSheenRoughness, 1.0f)));
            return;
        case Op::checker: return r.store(i.out, checker(r.vector(i, 0)));
        case Op::gradient:
            return r.store(i.out, gradient(static_cast<GradientType>(i.mode), r.vector(i, 0)));
        case Op::wave: return r.store(i.out, wave(read_wave(i, r), r.vector(i, 0)));
        case Op::magic:
            return r.store(i.out, magic(i.mode, r.vector(i, 0), r.scalar(i, 1), r.scalar(i, 2)));
        case Op::brick: {
            const BrickPoint<T> found = brick(read_brick(i, r), r.vector(i, 0));
            return r.store(i.out, Vector3<T>{found.tint, found.mortar, T(0.0f)});
        }
        case Op::white_noise:
            return r.store(i.out,
                           white_noise(mode_dimensions(i.mode), r.vector(i, 0), r.scalar(i, 1)));
        case Op::noise:
            return r.store(i.out, in_dimensions(mode_dimensions(i.mode), r.vector(i, 0),
                                                r.scalar(i, 1), [&](const auto& p) {
                                                    return noise_value(read_fractal(i, r), p,
                                                                       r.scalar(i, 7));
                                                }));
        case Op::noise_color:
            return r.store(i.out, in_dimensions(mode_dimensions(i.mode), r.vector(i, 0),
                                                r.scalar(i, 1), [&](const auto& p) {
                                                    return noise_color(read_fractal(i, r), p,
                                                                       r.scalar(i, 7));
                                                }));
        case Op::voronoi:
        case Op::voronoi_color:
        case Op::voronoi_position: return run_voronoi(i, r);
        case Op::lane: return r.store(i.out, r.lane(r.operand(i, 0), i.mode));
        case Op::mirror_ball: return r.store(i.out, mirror_ball(r.vector(i, 0)));
        default: return;
    }
}

}  // namespace spc
