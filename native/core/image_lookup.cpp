// SPDX-License-Identifier: GPL-3.0-or-later
// Filtering of texels. The kernels are specialised on texel type and channel count before the first
// texel is read.
#include <cstring>

#include "core/image.h"

namespace spc {
namespace {

// Four floats in one register, on GCC and clang alike; lanes are r, g, b, a.
using Float4 = float __attribute__((vector_size(16)));
using Byte4 = uint8_t __attribute__((vector_size(4)));

Float4 splat(float a) { return Float4{a, a, a, a}; }

// Filtered texel and its derivatives by the coordinates in texels, as far as they were asked for.
struct Filtered {
    Float4 value{}, ds{}, dt{}, dss{}, dst{}, dtt{};
};

// Derivatives that a lookup over T needs.
template <class T>
inline constexpr int kOrder = 0;
template <class S>
inline constexpr int kOrder<Dual<S>> = kOrder<S> + 1;

template <class Texel, int kChannels>
struct Texels {
    const Texel* data;
    int width, height;

    static constexpr float kScale = std::is_same_v<Texel, uint8_t> ? 1.0f / 255.0f : 1.0f;
    static constexpr float kOpaque = std::is_same_v<Texel, uint8_t> ? 255.0f : 1.0f;

    // Unscaled: the filters multiply by kScale once.
    Float4 at(int x, int y) const {
        const Texel* t =
            data + (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) *
                       kChannels;
        if constexpr (kChannels == 1) {
            const float grey = static_cast<float>(t[0]);
            return Float4{grey, grey, grey, kOpaque};
        } else if constexpr (kChannels == 3) {
            return Float4{static_cast<float>(t[0]), static_cast<float>(t[1]),
                          static_cast<float>(t[2]), kOpaque};
        } else if constexpr (std::is_same_v<Texel, uint8_t>) {
            Byte4 bytes;
            std::memcpy(&bytes, t, sizeof(bytes));
            return __builtin_convertvector(bytes, Float4);
        } else {
            Float4 floats;
            std::memcpy(&floats, t, sizeof(floats));
            return floats;
        }
    }
    Float4 at_or_clear(int x, int y) const {
        return x >= 0 && x < width && y >= 0 && y < height ? at(x, y) : Float4{};
    }
};

// ---- coordinates

// Brings a coordinate near the image without changing what is found there, so that the conversion
// to an integer is defined for every input and keeps its fraction. Periods are 1 and 2; beyond one
// image width, extend and clip no longer change.
float fold(float u, Extension extension) {
    switch (extension) {
        case Extension::repeat: u -= std::floor(u); break;
        case Extension::mirror: u -= 2.0f * std::floor(0.5f * u); break;
        case Extension::extend:
            return std::min(std::max(-2.0f, u), 3.0f);  // NaN becomes -2 by the order
        case Extension::clip: return u > -4.0f && u < 5.0f ? u : -4.0f;
    }
    return u >= 0.0f && u <= 2.0f ? u : 0.0f;
}

int wrap(int i, int size, Extension extension) {
    switch (extension) {
        case Extension::repeat: {
            if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
            const int m = i % size;
            return m < 0 ? m + size : m;
        }
        case Extension::mirror: {
            if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
            const int m = (i < 0 ? -1 - i : i) % (2 * size);
            return m < size ? m : 2 * size - 1 - m;
        }
        default: return std::min(std::max(i, 0), size - 1);
    }
}

struct Cell {
    int i;       // left or lower texel
    float frac;  // [0, 1]
};
Cell cell_of(float s) {
    const float floor = std::floor(s);
    return {static_cast<int>(floor), s - floor};
}

// ---- filters

template <class Image4>
Filtered filter_closest(const Image4& image, float u, float v, Extension extension) {
    int x = cell_of(u * static_cast<float>(image.width)).i;
    int y = cell_of(v * static_cast<float>(image.height)).i;
    Filtered result;
    if (extension == Extension::clip) {
        result.value = image.at_or_clear(x, y) * splat(Image4::kScale);
    } else {
        x = wrap(x, image.width, extension);
        y = wrap(y, image.height, extension);
        result.value = image.at(x, y) * splat(Image4::kScale);
    }
    return result;
}

template <int kDerivatives, class Image4>
Filtered filter_linear(const Image4& image, float u, float v, Extension extension) {
    const Cell s = cell_of(u * static_cast<float>(image.width) - 0.5f);
    const Cell t = cell_of(v * static_cast<float>(image.height) - 0.5f);
    Float4 c00, c10, c01, c11;
    if (extension == Extension::clip) {
        c00 = image.at_or_clear(s.i, t.i);
        c10 = image.at_or_clear(s.i + 1, t.i);
        c01 = image.at_or_clear(s.i, t.i + 1);
        c11 = image.at_or_clear(s.i + 1, t.i + 1);
    } else {
        const int x0 = wrap(s.i, image.width, extension), x1 = wrap(s.i + 1, image.width, extension);
        const int y0 = wrap(t.i, image.height, extension),
                  y1 = wrap(t.i + 1, image.height, extension);
        c00 = image.at(x0, y0);
        c10 = image.at(x1, y0);
        c01 = image.at(x0, y1);
        c11 = image.at(x1, y1);
    }
    const Float4 scale = splat(Image4::kScale), fs = splat(s.frac), ft = splat(t.frac);
    const Float4 slope0 = c10 - c00, slope1 = c11 - c01;
    const Float4 row0 = c00 + slope0 * fs, row1 = c01 + slope1 * fs;
    Filtered result;
    result.value = (row0 + (row1 - row0) * ft) * scale;
    if constexpr (kDerivatives > 0) {
        result.ds = (slope0 + (slope1 - slope0) * ft) * scale;
        result.dt = (row1 - row0) * scale;
    }
    if constexpr (kDerivatives > 1) result.dst = (slope1 - slope0) * scale;
    return result;
}

// Uniform cubic B-spline through four texels: it smooths, as Blender's does.
struct CubicWeights {
    float w[4], dw[4], ddw[4];
    explicit CubicWeights(float t) {
        const float r = 1.0f - t;
        w[0] = r * r * r * (1.0f / 6.0f);
        w[1] = (0.5f * t - 1.0f) * t * t + 2.0f / 3.0f;
        w[2] = (0.5f * r - 1.0f) * r * r + 2.0f / 3.0f;
        w[3] = t * t * t * (1.0f / 6.0f);
        dw[0] = -0.5f * r * r;
        dw[1] = (1.5f * t - 2.0f) * t;
        dw[2] = (2.0f - 1.5f * r) * r;
        dw[3] = 0.5f * t * t;
        ddw[0] = r;
        ddw[1] = 3.0f * t - 2.0f;
        ddw[2] = 3.0f * r - 2.0f;
        ddw[3] = t;
    }
};

template <int kDerivatives, class Image4>
Filtered filter_cubic(const Image4& image, float u, float v, Extension extension) {
    const Cell s = cell_of(u * static_cast<float>(image.width) - 0.5f);
    const Cell t = cell_of(v * static_cast<float>(image.height) - 0.5f);
    const CubicWeights ws(s.frac), wt(t.frac);
    Filtered result;
    for (int j = 0; j < 4; ++j) {
        Float4 row{}, slope{}, bend{};
        for (int i = 0; i < 4; ++i) {
            const int x = s.i - 1 + i, y = t.i - 1 + j;
            const Float4 texel =
                extension == Extension::clip
                    ? image.at_or_clear(x, y)
                    : image.at(wrap(x, image.width, extension), wrap(y, image.height, extension));
            row += splat(ws.w[i]) * texel;
            if constexpr (kDerivatives > 0) slope += splat(ws.dw[i]) * texel;
            if constexpr (kDerivatives > 1) bend += splat(ws.ddw[i]) * texel;
        }
        result.value += splat(wt.w[j]) * row;
        if constexpr (kDerivatives > 0) {
            result.ds += splat(wt.w[j]) * slope;
            result.dt += splat(wt.dw[j]) * row;
        }
        if constexpr (kDerivatives > 1) {
            result.dss += splat(wt.w[j]) * bend;
            result.dst += splat(wt.dw[j]) * slope;
            result.dtt += splat(wt.ddw[j]) * row;
        }
    }
    const Float4 scale = splat(Image4::kScale);
    for (Float4* sum :
         {&result.value, &result.ds, &result.dt, &result.dss, &result.dst, &result.dtt})
        *sum *= scale;
    return result;
}

template <int kDerivatives, class Texel, int kChannels>
Filtered filter(const Image& image, const Texel* data, float u, float v,
                Interpolation interpolation, Extension extension) {
    const Texels<Texel, kChannels> texels{data, static_cast<int>(image.width),
                                          static_cast<int>(image.height)};
    switch (interpolation) {
        case Interpolation::closest: return filter_closest(texels, u, v, extension);
        case Interpolation::cubic: return filter_cubic<kDerivatives>(texels, u, v, extension);
        case Interpolation::linear: break;
    }
    return filter_linear<kDerivatives>(texels, u, v, extension);
}

template <int kDerivatives, class Texel>
Filtered filter(const Image& image, const Texel* data, float u, float v,
                Interpolation interpolation, Extension extension) {
    u = fold(u, extension);
    v = fold(v, extension);
    switch (image.channels) {
        case 1: return filter<kDerivatives, Texel, 1>(image, data, u, v, interpolation, extension);
        case 3: return filter<kDerivatives, Texel, 3>(image, data, u, v, interpolation, extension);
        default: return filter<kDerivatives, Texel, 4>(image, data, u, v, interpolation, extension);
    }
}

template <int kDerivatives>
Filtered filter(const Image& image, float u, float v, Interpolation interpolation,
                Extension extension) {
    if (!image.bytes.empty())
        return filter<kDerivatives>(image, image.bytes.data(), u, v, interpolation, extension);
    if (!image.floats.empty())
        return filter<kDerivatives>(image, image.floats.data(), u, v, interpolation, extension);
    return {};
}

// ---- from stored to linear colour

// The transfer function between table entries by a straight line: off by at most 4e-7, some 1/700
// of what 8 bits resolve at their darkest, and five times faster than pow.
constexpr int kSrgbIntervals = 2048;
const std::array<float, kSrgbIntervals + 2> kSrgbTable = [] {
    std::array<float, kSrgbIntervals + 2> table;
    for (int i = 0; i < kSrgbIntervals + 2; ++i)
        table[static_cast<size_t>(i)] = srgb_to_linear(static_cast<float>(i) / kSrgbIntervals);
    return table;
}();

float to_linear(float encoded) {
    const float x = encoded * kSrgbIntervals;
    if (!(x > 0.0f)) return 0.0f;
    if (x > kSrgbIntervals)
        return srgb_to_linear(encoded);  // only where division by alpha went beyond 1
    const int i = static_cast<int>(x);
    const size_t k = static_cast<size_t>(i);
    return kSrgbTable[k] + (kSrgbTable[k + 1] - kSrgbTable[k]) * (x - static_cast<float>(i));
}
template <class S>
Dual<S> to_linear(const Dual<S>& encoded) {
    if (value_of(encoded) < 0.0f) return {};
    if (value_of(encoded) < 0.04045f) return encoded * (1.0f / 12.92f);
    using std::pow;
    const S base = (encoded.v + 0.055f) * (1.0f / 1.055f);
    const S power = pow(base, 1.4f);
    return chain(encoded, S(power * base), S(2.4f / 1.055f * power));
}

template <class T>
Rgba<T> finish(const Image& image, Rgba<T> c, bool straight) {
    const float alpha = value_of(c.a);
    if (straight && image.premultiplied && alpha != 1.0f && alpha != 0.0f) {
        const T inv = T(1.0f) / c.a;
        c.r = c.r * inv;
        c.g = c.g * inv;
        c.b = c.b * inv;
    }
    if (image.srgb_encoded) {
        c.r = to_linear(c.r);
        c.g = to_linear(c.g);
        c.b = to_linear(c.b);
    }
    return c;
}

// One lane of a filtered texel at coordinates that carry derivatives of their own.
struct Lane {
    float value, ds, dt, dss, dst, dtt;
};
template <class T>
T along(const Lane& f, const T& s, const T& t) {
    if constexpr (std::is_same_v<T, float>) {
        return f.value;
    } else {
        const auto by_s = along(Lane{f.ds, f.dss, f.dst, 0, 0, 0}, s.v, t.v);
        const auto by_t = along(Lane{f.dt, f.dst, f.dtt, 0, 0, 0}, s.v, t.v);
        return {along(f, s.v, t.v), by_s * s.du + by_t * t.du, by_s * s.dv + by_t * t.dv};
    }
}

}  // namespace

template <class T>
Rgba<T> lookup(const Image& image, const T& u, const T& v, Interpolation interpolation,
               Extension extension, bool straight) {
    const Filtered c = filter<kOrder<T>>(image, value_of(u), value_of(v), interpolation, extension);
    const float w = static_cast<float>(image.width), h = static_cast<float>(image.height);
    if constexpr (kOrder<T> == 0) {
        return finish(image, Rgba<float>{c.value[0], c.value[1], c.value[2], c.value[3]}, straight);
    } else if constexpr (kOrder<T> == 1) {  // as along(), four lanes at a time
        const Float4 du = c.ds * splat(w * u.du) + c.dt * splat(h * v.du);
        const Float4 dv = c.ds * splat(w * u.dv) + c.dt * splat(h * v.dv);
        const auto lane = [&](int i) { return Dual2(c.value[i], du[i], dv[i]); };
        return finish(image, Rgba<Dual2>{lane(0), lane(1), lane(2), lane(3)}, straight);
    } else {
        const T s = u * T(w), t = v * T(h);
        const auto lane = [&](int i) {
            return along(Lane{c.value[i], c.ds[i], c.dt[i], c.dss[i], c.dst[i], c.dtt[i]}, s, t);
        };
        return finish(image, Rgba<T>{lane(0), lane(1), lane(2), lane(3)}, straight);
    }
}

template Rgba<float> lookup(const Image&, const float&, const float&, Interpolation, Extension,
                            bool);
template Rgba<Dual2> lookup(const Image&, const Dual2&, const Dual2&, Interpolation, Extension,
                            bool);
template Rgba<Dual<Dual2>> lookup(const Image&, const Dual<Dual2>&, const Dual<Dual2>&,
                                  Interpolation, Extension, bool);

Rgba<float> mean(const Image& image, bool straight) {
    double sum[4] = {};
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(image.width);
            const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height);
            const Rgba<float> c =
                lookup(image, u, v, Interpolation::closest, Extension::extend, straight);
            sum[0] += c.r, sum[1] += c.g, sum[2] += c.b, sum[3] += c.a;
        }
    }
    const double inv = 1.0 / std::max(1.0, double(image.width) * image.height);
    return {static_cast<float>(sum[0] * inv), static_cast<float>(sum[1] * inv),
            static_cast<float>(sum[2] * inv), static_cast<float>(sum[3] * inv)};
}

}  // namespace spc
