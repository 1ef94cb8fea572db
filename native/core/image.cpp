// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>
#include <memory>

#include "core/error.h"

namespace spc {
namespace {

// Larger images are refused; it also keeps every texel index within 32 bits.
constexpr uint64_t kMaxTexels = uint64_t{1} << 29;

[[noreturn]] void fail(ErrorKind kind, const std::string& name, const std::string& what) {
    throw Error(kind, named("image", name) + ": " + what);
}

void check_size(const std::string& name, uint64_t width, uint64_t height, uint64_t channels) {
    if (width < 1 || height < 1) fail(ErrorKind::invalid_argument, name, "has no pixels");
    if (width > kMaxTexels || height > kMaxTexels || width * height > kMaxTexels)
        fail(ErrorKind::invalid_argument, name, "has more than 2^29 pixels");
    if (channels != 1 && channels != 3 && channels != 4)
        fail(ErrorKind::invalid_argument, name,
             std::to_string(channels) + " channels; 1, 3 or 4 are possible");
}

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
        for (size_t i = 0; i < image.floats.size(); ++i)
            if (image.channels != 4 || i % 4 != 3)
                image.floats[i] = srgb_to_linear(image.floats[i]);
    }
    if (image.channels != 4) return;
    apply_alpha(image.bytes, uint8_t{255}, alpha == AlphaMode::none, associates && !multiplied);
    apply_alpha(image.floats, 1.0f, alpha == AlphaMode::none, associates && !multiplied);
}

// Grey with alpha becomes RGBA, channels after the fourth are dropped.
template <class Texel>
void reduce_channels(std::vector<Texel>& texels, size_t count, size_t from) {
    if (from == 1 || from == 3 || from == 4) return;
    std::vector<Texel> rgba(count * 4);
    for (size_t i = 0; i < count; ++i) {
        const Texel* in = &texels[i * from];
        for (size_t c = 0; c < 4; ++c) rgba[i * 4 + c] = from == 2 ? in[c < 3 ? 0 : 1] : in[c];
    }
    texels = std::move(rgba);
}

// Rows arrive from the top; written with a negative stride they end up bottom first.
template <class Texel>
void read_texels(OIIO::ImageInput& input, const std::string& name, OIIO::TypeDesc type,
                 std::vector<Texel>& texels) {
    const OIIO::ImageSpec spec = input.spec();
    const size_t row = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.nchannels);
    const size_t rows = static_cast<size_t>(spec.height);
    texels.resize(row * rows);
    const auto stride = -static_cast<OIIO::stride_t>(row * sizeof(Texel));
    if (!input.read_image(0, 0, 0, spec.nchannels, type, &texels[(rows - 1) * row],
                          OIIO::AutoStride, stride, OIIO::AutoStride))
        fail(ErrorKind::io, name, "cannot be read: " + input.geterror());
    reduce_channels(texels, static_cast<size_t>(spec.width) * rows,
                    static_cast<size_t>(spec.nchannels));
}

// What is not a number in a file (renders with defects, suns of infinite radiance) must not poison
// a path.
void repair(Image& image) {
    for (size_t texel = 0; texel < image.floats.size(); texel += image.channels) {
        bool finite = true;
        for (size_t c = 0; c < image.channels; ++c)
            finite = finite && std::isfinite(image.floats[texel + c]);
        if (finite) continue;
        for (size_t c = 0; c < image.channels; ++c) image.floats[texel + c] = 0.0f;
        ++image.repaired_texels;
    }
}

// Formats whose reader says nothing of its alpha, but where it is straight.
bool says_nothing_of_straight_alpha(const OIIO::ImageInput& input) {
    const char* format = input.format_name();
    if (!std::strcmp(format, "targa"))
        return input.spec().get_int_attribute("targa:alpha_type", -1) != 4;
    return !std::strcmp(format, "dds") || !std::strcmp(format, "psd");
}

Image image_from_input(const std::string& name, OIIO::ImageInput& input, ColorSpace space,
                       AlphaMode alpha) {
    const OIIO::ImageSpec& spec = input.spec();
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        fail(ErrorKind::io, name, "has no pixels");
    Image image;
    image.name = name;
    image.width = static_cast<uint32_t>(spec.width);
    image.height = static_cast<uint32_t>(spec.height);
    image.channels =
        spec.nchannels == 1 || spec.nchannels == 3 ? static_cast<uint32_t>(spec.nchannels) : 4u;
    check_size(name, image.width, image.height, image.channels);

    bool bytes = spec.format == OIIO::TypeDesc::UINT8;
    for (const OIIO::TypeDesc& format : spec.channelformats)
        bytes = bytes && format == OIIO::TypeDesc::UINT8;
    const bool stored_premultiplied = spec.alpha_channel >= 0 &&
                                      !spec.get_int_attribute("oiio:UnassociatedAlpha", 0) &&
                                      !says_nothing_of_straight_alpha(input);
    if (bytes) {
        read_texels(input, name, OIIO::TypeDesc::UINT8, image.bytes);
    } else {
        read_texels(input, name, OIIO::TypeDesc::FLOAT, image.floats);
        repair(image);
    }
    finish(image, space, alpha, stored_premultiplied);
    return image;
}

// Alpha as it is in the file; association is decided here.
OIIO::ImageSpec raw_alpha() {
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

// OpenImageIO picks a reader by the name's extension; bytes in memory come without a dependable
// one.
const char* extension_by_signature(std::span<const uint8_t> encoded) {
    struct Signature {
        std::string_view bytes;
        const char* extension;
    };
    using std::string_view_literals::operator""sv;
    static constexpr Signature kSignatures[] = {
        {"\x89PNG"sv, ".png"},
        {"\xff\xd8\xff"sv, ".jpg"},
        {"\x76\x2f\x31\x01"sv, ".exr"},
        {"#?"sv, ".hdr"},
        {"II\x2a\x00"sv, ".tif"},
        {"MM\x00\x2a"sv, ".tif"},
        {"BM"sv, ".bmp"},
        {"DDS "sv, ".dds"},
        {"8BPS"sv, ".psd"},
        {"RIFF"sv, ".webp"},
        {"\x00\x00\x00\x0cjP"sv, ".jp2"},
        {"GIF8"sv, ".gif"},
        {"\xff\x4f\xff\x51"sv, ".j2c"},
        {"SDPX"sv, ".dpx"},
        {"XPDS"sv, ".dpx"},
    };
    const std::string_view head(reinterpret_cast<const char*>(encoded.data()), encoded.size());
    for (const Signature& s : kSignatures)
        if (head.starts_with(s.bytes)) return s.extension;
    return ".tga";  // the one common format without a signature
}

}  // namespace

float srgb_to_linear(float encoded) {
    if (encoded < 0.04045f) return encoded < 0.0f ? 0.0f : encoded * (1.0f / 12.92f);
    return std::pow((encoded + 0.055f) * (1.0f / 1.055f), 2.4f);
}

namespace {

// An image of texels in memory, before finish(); `texels` is Image::bytes or Image::floats.
template <class Texel>
Image image_from_texels(const std::string& name, std::span<const Texel> texels, uint32_t width,
                        uint32_t height, uint32_t channels, std::vector<Texel> Image::*member) {
    check_size(name, width, height, channels);
    if (texels.size() != size_t{width} * height * channels)
        fail(ErrorKind::invalid_argument, name, "number of texels does not match its size");
    Image image;
    image.name = name;
    image.width = width;
    image.height = height;
    image.channels = channels;
    (image.*member).assign(texels.begin(), texels.end());
    return image;
}

}  // namespace

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
        if (!std::isfinite(texels[i]))
            fail(ErrorKind::invalid_argument, name,
                 "texel " + std::to_string(i / channels) + " is not finite");
    finish(image, space, alpha, false);
    return image;
}

Image image_from_file(const std::string& name, const std::string& path, ColorSpace space,
                      AlphaMode alpha) {
    const OIIO::ImageSpec config = raw_alpha();
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &config);
    if (!input) fail(ErrorKind::io, name, "cannot open \"" + path + "\": " + OIIO::geterror());
    return image_from_input(name, *input, space, alpha);
}

Image image_from_memory(const std::string& name, std::span<const uint8_t> encoded, ColorSpace space,
                        AlphaMode alpha) {
    OIIO::Filesystem::IOMemReader reader(OIIO::cspan<uint8_t>(
        encoded.data(), static_cast<OIIO::cspan<uint8_t>::index_type>(encoded.size())));
    OIIO::ImageSpec config = raw_alpha();
    // With a configuration, OpenImageIO 2.4 takes the reader from there and not from the argument.
    void* proxy = static_cast<OIIO::Filesystem::IOProxy*>(&reader);
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(
        std::string("memory") + extension_by_signature(encoded), &config, &reader);
    if (!input) fail(ErrorKind::io, name, "cannot decode its bytes: " + OIIO::geterror());
    return image_from_input(name, *input, space, alpha);
}

}  // namespace spc
