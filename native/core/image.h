// SPDX-License-Identifier: GPL-3.0-or-later
// Images as the host hands them over, and their lookup.
#pragma once

#include "core/shared.h"
#include "math/dual.h"

#include <span>
#include <string>
#include <vector>

namespace spc {

enum class ColorSpace : uint8_t { linear, srgb, data };
enum class AlphaMode : uint8_t {
    straight,       // colour is stored as it is and gets multiplied by alpha
    premultiplied,  // it is multiplied already
    none,           // alpha reads as 1
    packed          // alpha is a fourth value with no bearing on the colour
};

// Decoded texels, bottom row first. 8-bit sRGB stays encoded and is linearised after filtering, as
// Cycles does; everything else is stored ready to use. Colour is premultiplied by alpha (of encoded
// bytes: as encoded) unless the space is `data` or the mode `packed`. Copies share the texels.
struct Image {
    std::string name;
    uint32_t width = 0, height = 0;
    uint32_t channels = 0;         // 1, 3 or 4 as stored; lookups always give RGBA
    SharedArray<uint8_t> bytes;    // [height][width][channels], or empty
    SharedArray<float> floats;     // the same, or empty
    bool srgb_encoded = false;     // only with bytes
    bool premultiplied = false;    // colour is multiplied by an alpha channel
    uint64_t repaired_texels = 0;  // of a file: were not finite and read as 0
    // Tells texels from those of another image, as long as either lives.
    const void* texels() const {
        return bytes.empty() ? static_cast<const void*>(floats.data()) : bytes.data();
    }
    size_t memory_bytes() const { return bytes.size() + floats.size() * sizeof(float); }
};

// Sources. All throw Error naming `name` (io: unreadable; invalid_argument: size, channels or
// numbers). A file's own word on its alpha goes before `alpha`: what is stored premultiplied
// (OpenEXR) is not multiplied again.
Image image_from_bytes(const std::string& name, std::span<const uint8_t> texels, uint32_t width,
                       uint32_t height, uint32_t channels, ColorSpace space, AlphaMode alpha);
Image image_from_floats(const std::string& name, std::span<const float> texels, uint32_t width,
                        uint32_t height, uint32_t channels, ColorSpace space, AlphaMode alpha);
Image image_from_file(const std::string& name, const std::string& path, ColorSpace space,
                      AlphaMode alpha);
Image image_from_memory(const std::string& name, std::span<const uint8_t> encoded, ColorSpace space,
                        AlphaMode alpha);

enum class Interpolation : uint8_t { linear, closest, cubic };
enum class Extension : uint8_t { repeat, extend, clip, mirror };

template <class T>
struct Rgba {
    T r{}, g{}, b{}, a{};
};

// Texture lookup at (u, v), (0, 0) the bottom left corner of the image, in Blender's conventions
// (texel centres at half-integers; clip is transparent black outside). With T = Dual2 the result
// carries the exact derivative of the interpolant inside its cell (zero for `closest`). A NaN reads
// as 0, or as outside with `clip`. `straight` divides the filtered colour by the filtered alpha
// where the image is premultiplied: what Cycles does for a texture node whose alpha is used.
template <class T>
Rgba<T> lookup(const Image& image, const T& u, const T& v, Interpolation interpolation,
               Extension extension, bool straight = false);

extern template Rgba<float> lookup(const Image&, const float&, const float&, Interpolation,
                                   Extension, bool);
extern template Rgba<Dual2> lookup(const Image&, const Dual2&, const Dual2&, Interpolation,
                                   Extension, bool);
extern template Rgba<Dual<Dual2>> lookup(const Image&, const Dual<Dual2>&, const Dual<Dual2>&,
                                         Interpolation, Extension, bool);

// Mean over all texels of what a lookup at their centres gives.
Rgba<float> mean(const Image& image, bool straight = false);

// The sRGB transfer function, decoded; exact, extended to values outside [0, 1] as Cycles does.
float srgb_to_linear(float encoded);

}  // namespace spc
