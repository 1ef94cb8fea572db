// SPDX-License-Identifier: GPL-3.0-or-later
// Colours as hue, saturation and value or lightness, and Blender's ways to blend two of them, over
// T = float or a dual.
#pragma once

#include "shading/functions.h"

namespace spc {

// (hue, saturation, value); hue in [0, 1), 0 of a grey.
template <class T>
Vector3<T> rgb_to_hsv(const Vector3<T>& c) {
    const T most = larger(larger(c.x, c.y), c.z), least = smaller(smaller(c.x, c.y), c.z);
    const T range = most - least;
    const float top = value_of(most);
    if (top == 0.0f || value_of(range) == 0.0f) return {T(0.0f), T(0.0f), most};
    const T saturation = range / most;
    T hue = value_of(c.x) == top   ? (c.y - c.z) / range
            : value_of(c.y) == top ? T(2.0f) + (c.z - c.x) / range
                                   : T(4.0f) + (c.x - c.y) / range;
    hue = times(hue, 1.0f / 6);
    if (value_of(hue) < 0.0f) hue = hue + T(1.0f);
    return {hue, saturation, most};
}

// Each channel of full saturation and value, from 1 at its own hue to 0 beyond a third of the
// circle; `h` counts sixths of it.
template <class T>
Vector3<T> pure_hue(const T& h) {
    const T one(1.0f), two(2.0f);
    return {clamp_unit(absolute(h - T(3.0f)) - one), clamp_unit(two - absolute(h - two)),
            clamp_unit(two - absolute(h - T(4.0f)))};
}
template <class T>
Vector3<T> hsv_to_rgb(const Vector3<T>& hsv) {
    // As in Cycles what lies outside of the circle lies in its last sixth, but for its end.
    const T sixths = value_of(hsv.x) == 1.0f ? T(0.0f) : times(hsv.x, 6.0f);
    const bool inside = value_of(sixths) >= 0.0f && value_of(sixths) < 6.0f;
    const Vector3<T> pure = pure_hue(inside ? sixths : T(5.0f) + fraction(sixths));
    const auto channel = [&](const T& p) { return hsv.z * (T(1.0f) - hsv.y * (T(1.0f) - p)); };
    return {channel(pure.x), channel(pure.y), channel(pure.z)};
}

// (hue, saturation, lightness).
template <class T>
Vector3<T> rgb_to_hsl(const Vector3<T>& c) {
    const T most = larger(larger(c.x, c.y), c.z), least = smaller(smaller(c.x, c.y), c.z);
    const T lightness = smaller(times(most + least, 0.5f), T(1.0f)), range = most - least;
    if (value_of(range) == 0.0f) return {T(0.0f), T(0.0f), lightness};
    const T saturation =
        value_of(lightness) > 0.5f ? range / (T(2.0f) - most - least) : range / (most + least);
    return {rgb_to_hsv(c).x, saturation, lightness};
}
template <class T>
Vector3<T> hsl_to_rgb(const Vector3<T>& hsl) {
    const Vector3<T> pure = pure_hue(times(hsl.x, 6.0f));
    const T chroma = (T(1.0f) - absolute(times(hsl.z, 2.0f) - T(1.0f))) * hsl.y;
    const auto channel = [&](const T& p) { return (p - T(0.5f)) * chroma + hsl.z; };
    return {channel(pure.x), channel(pure.y), channel(pure.z)};
}

// ---- blend types of Mix nodes, in the order of kBlendTypes

enum class Blend : uint8_t {
    mix,
    darken,
    multiply,
    burn,
    lighten,
    screen,
    dodge,
    add,
    overlay,
    soft_light,
    linear_light,
    difference,
    exclusion,
    subtract,
    divide,
    hue,
    saturation,
    color,
    value
};
inline constexpr const char* kBlendTypes =
    "MIX|DARKEN|MULTIPLY|BURN|LIGHTEN|SCREEN|DODGE|ADD|OVERLAY|SOFT_LIGHT|LINEAR_LIGHT|DIFFERENCE|"
    "EXCLUSION|SUBTRACT|DIVIDE|HUE|SATURATION|COLOR|VALUE";

template <class T>
T lerp_to(const T& a, const T& b, const T& t) {
    return a * (T(1.0f) - t) + b * t;
}

// One channel of the types that look at one channel.
template <class T>
T blend_channel(Blend type, const T& a, const T& b, const T& t) {
    const T one(1.0f), two(2.0f), rest = one - t;
    switch (type) {
        case Blend::darken: return lerp_to(a, smaller(a, b), t);
        case Blend::multiply: return lerp_to(a, a * b, t);
        case Blend::burn: {
            const T divisor = rest + t * b;
            if (!(value_of(divisor) > 0.0f)) return T(0.0f);
            return clamp_unit(one - (one - a) / divisor);
        }
        case Blend::lighten: return lerp_to(a, larger(a, b), t);
        case Blend::screen: return one - (rest + t * (one - b)) * (one - a);
        case Blend::dodge: {
            if (value_of(a) == 0.0f) return T(0.0f);
            const T divisor = one - t * b;
            return value_of(divisor) > 0.0f ? smaller(a / divisor, one) : one;
        }
        case Blend::add: return lerp_to(a, a + b, t);
        case Blend::overlay:
            if (value_of(a) < 0.5f) return a * (rest + two * t * b);
            return one - (rest + two * t * (one - b)) * (one - a);
        case Blend::soft_light: {
            const T screened = one - (one - b) * (one - a);
            return rest * a + t * ((one - a) * b * a + a * screened);
        }
        case Blend::linear_light: return a + t * (two * b - one);
        case Blend::difference: return lerp_to(a, absolute(a - b), t);
        case Blend::exclusion: return larger(lerp_to(a, a + b - two * a * b, t), T(0.0f));
        case Blend::subtract: return lerp_to(a, a - b, t);
        case Blend::divide: return value_of(b) != 0.0f ? rest * a + t * a / b : a;
        default: return lerp_to(a, b, t);
    }
}

template <class T>
Vector3<T> blend(Blend type, const Vector3<T>& a, const Vector3<T>& b, const T& t) {
    if (type < Blend::hue)
        return {blend_channel(type, a.x, b.x, t), blend_channel(type, a.y, b.y, t),
                blend_channel(type, a.z, b.z, t)};
    const Vector3<T> from = rgb_to_hsv(a), to = rgb_to_hsv(b);
    if (type == Blend::value)
        return hsv_to_rgb(Vector3<T>{from.x, from.y, lerp_to(from.z, to.z, t)});
    if (type == Blend::saturation) {
        if (value_of(from.y) == 0.0f) return a;
        return hsv_to_rgb(Vector3<T>{from.x, lerp_to(from.y, to.y, t), from.z});
    }
    if (value_of(to.y) == 0.0f) return a;  // a grey has no hue
    const T saturation = type == Blend::color ? to.y : from.y;
    const Vector3<T> other = hsv_to_rgb(Vector3<T>{to.x, saturation, from.z});
    return {lerp_to(a.x, other.x, t), lerp_to(a.y, other.y, t), lerp_to(a.z, other.z, t)};
}

}  // namespace spc
