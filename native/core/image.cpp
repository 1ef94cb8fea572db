// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image.h"

#include "core/image_file.h"
#include "core/limits.h"

namespace spc {

void fail_image(ErrorKind kind, const std::string& name, const std::string& what) {
    throw Error(kind, named("image", name) + ": " + what);
}

// Larger images are refused; it also keeps every texel index within 32 bits.
constexpr uint64_t kMaxTexels = uint64_t{1} << 29;

void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t channels) {
    if (width < 1 || height < 1) fail_image(ErrorKind::invalid_argument, name, "has no pixels");
    if (width > kMaxTexels || height > kMaxTexels || width * height > kMaxTexels)
        fail_image(ErrorKind::invalid_argument, name, "has more than 2^29 pixels");
    if (channels != 1 && channels != 3 && channels != 4)
        fail_image(ErrorKind::invalid_argument, name,
                   std::to_string(channels) + " channels; 1, 3 or 4 are possible");
}

namespace {

uint8_t multiply(uint8_t a, uint8_t b) { return static_cast<uint8_t>((a * b + 127) / 255); }
float multiply(float a, float b) { return a * b; }

// Alpha is read as 1, or the colour is multiplied by it, or neither.
template <class Texel>
void apply_alpha(std::vector<Texel>& texels, Texel one, bool ignore, bool multiply_color) {
    for (size_t i = 0; i + 3 < texels.size(); i += 4) {
        if (ignore) texels[i + 3] = one;
        if (!multiply_color) continue;
        for (size_t c = 0; c < 3; ++c) texels[i + c] = multiply(texels[i + c], texels[i + 3]);
    }
}

// From raw texels to what lookups expect. `stored_premultiplied`: by the file's own word.
void finish(Image& image, ColorSpace space, AlphaMode alpha, bool stored_premultiplied) {
    const bool has_alpha = image.channels == 4 && alpha != AlphaMode::none;
    const bool associates = has_alpha && space != ColorSpace::data && alpha != AlphaMode::packed;
    const bool multiplied = stored_premultiplied || alpha == AlphaMode::premultiplied;
    image.premultiplied = associates;

    image.srgb_encoded = space == ColorSpace::srgb && !image.bytes.empty();
    if (space == ColorSpace::srgb && !image.floats.empty()) {
        std::vector<float>& texels = image.floats.writable();
        for (size_t i = 0; i < texels.size(); ++i)
            if (image.channels != 4 || i % 4 != 3) texels[i] = srgb_to_linear(texels[i]);
    }
    if (image.channels != 4) return;
    apply_alpha(image.bytes.writable(), uint8_t{255}, alpha == AlphaMode::none,
                associates && !multiplied);
    apply_alpha(image.floats.writable(), 1.0f, alpha == AlphaMode::none, associates && !multiplied);
}

// What is not a number in a file (renders with defects, suns of infinite radiance) must not poison
// a path.
void repair(Image& image) {
    std::vector<float>& texels = image.floats.writable();
    for (size_t texel = 0; texel < texels.size(); texel += image.channels) {
        bool finite = true;
        for (size_t c = 0; c < image.channels; ++c)
            finite = finite && std::abs(texels[texel + c]) <= kLargestNumber;
        if (finite) continue;
        for (size_t c = 0; c < image.channels; ++c) texels[texel + c] = 0.0f;
        ++image.repaired_texels;
    }
}

// An image of texels in memory, before finish(); `texels` is Image::bytes or Image::floats.
template <class Texel>
Image image_from_texels(const std::string& name, std::span<const Texel> texels, uint32_t width,
                        uint32_t height, uint32_t channels, SharedArray<Texel> Image::*member) {
    check_image_size(name, width, height, channels);
    if (texels.size() != size_t{width} * height * channels)
        fail_image(ErrorKind::invalid_argument, name, "number of texels does not match its size");
    Image image;
    image.name = name;
    image.width = width;
    image.height = height;
    image.channels = channels;
    (image.*member).writable().assign(texels.begin(), texels.end());
    return image;
}

// From what a file holds.
Image image_from(ImageFile&& file, ColorSpace space, AlphaMode alpha) {
    repair(file.image);
    finish(file.image, space, alpha, file.premultiplied);
    return std::move(file.image);
}

}  // namespace

float srgb_to_linear(float encoded) {
    if (encoded < 0.04045f) return encoded < 0.0f ? 0.0f : encoded * (1.0f / 12.92f);
    return std::pow((encoded + 0.055f) * (1.0f / 1.055f), 2.4f);
}

Image image_from_bytes(const std::string& name, std::span<const uint8_t> texels, uint32_t width,
                       uint32_t height, uint32_t channels, ColorSpace space, AlphaMode alpha) {
    Image image = image_from_texels(name, texels, width, height, channels, &Image::bytes);
    finish(image, space, alpha, false);
    return image;
}

Image image_from_floats(const std::string& name, std::span<const float> texels, uint32_t width,
                        uint32_t height, uint32_t channels, ColorSpace space, AlphaMode alpha) {
    Image image = image_from_texels(name, texels, width, height, channels, &Image::floats);
    for (size_t i = 0; i < texels.size(); ++i)
        if (!(std::abs(texels[i]) <= kLargestNumber))
            fail_image(ErrorKind::invalid_argument, name,
                       "texel " + std::to_string(i / channels) +
                           (std::isfinite(texels[i]) ? " exceeds 1e+15" : " is not finite"));
    finish(image, space, alpha, false);
    return image;
}

Image image_from_file(const std::string& name, const std::string& path, ColorSpace space,
                      AlphaMode alpha) {
    return image_from(read_image(name, path), space, alpha);
}

Image image_from_memory(const std::string& name, std::span<const uint8_t> encoded, ColorSpace space,
                        AlphaMode alpha) {
    return image_from(read_image(name, encoded), space, alpha);
}

}  // namespace spc
