// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>
#include <memory>

namespace spc {

namespace {

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
        fail_image(ErrorKind::io, name, "cannot be read: " + input.geterror());
    reduce_channels(texels, static_cast<size_t>(spec.width) * rows,
                    static_cast<size_t>(spec.nchannels));
}

// Formats whose reader says nothing of its alpha, but where it is straight.
bool says_nothing_of_straight_alpha(const OIIO::ImageInput& input) {
    const char* format = input.format_name();
    if (!std::strcmp(format, "targa"))
        return input.spec().get_int_attribute("targa:alpha_type", -1) != 4;
    return !std::strcmp(format, "dds") || !std::strcmp(format, "psd");
}

ImageFile read(const std::string& name, OIIO::ImageInput& input) {
    const OIIO::ImageSpec& spec = input.spec();
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        fail_image(ErrorKind::io, name, "has no pixels");
    if (spec.depth > 1 || spec.deep) fail_image(ErrorKind::io, name, "is not a flat image");
    Image image;
    image.name = name;
    image.width = static_cast<uint32_t>(spec.width);
    image.height = static_cast<uint32_t>(spec.height);
    image.channels =
        spec.nchannels == 1 || spec.nchannels == 3 ? static_cast<uint32_t>(spec.nchannels) : 4u;
    check_image_size(name, image.width, image.height, image.channels);

    bool bytes = spec.format == OIIO::TypeDesc::UINT8;
    for (const OIIO::TypeDesc& format : spec.channelformats)
        bytes = bytes && format == OIIO::TypeDesc::UINT8;
    const bool stored_premultiplied = spec.alpha_channel >= 0 &&
                                      !spec.get_int_attribute("oiio:UnassociatedAlpha", 0) &&
                                      !says_nothing_of_straight_alpha(input);
    if (bytes) {
        read_texels(input, name, OIIO::TypeDesc::UINT8, image.bytes.writable());
    } else {
        read_texels(input, name, OIIO::TypeDesc::FLOAT, image.floats.writable());
    }
    return {std::move(image), stored_premultiplied};
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

ImageFile read_image(const std::string& name, const std::string& path) {
    const OIIO::ImageSpec config = raw_alpha();
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &config);
    if (!input)
        fail_image(ErrorKind::io, name, "cannot open \"" + path + "\": " + OIIO::geterror());
    return read(name, *input);
}

ImageFile read_image(const std::string& name, std::span<const uint8_t> encoded) {
    OIIO::Filesystem::IOMemReader reader(OIIO::cspan<uint8_t>(
        encoded.data(), static_cast<OIIO::cspan<uint8_t>::index_type>(encoded.size())));
    OIIO::ImageSpec config = raw_alpha();
    // With a configuration, OpenImageIO 2.4 takes the reader from there and not from the argument.
    void* proxy = static_cast<OIIO::Filesystem::IOProxy*>(&reader);
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(
        std::string("memory") + extension_by_signature(encoded), &config, &reader);
    if (!input) fail_image(ErrorKind::io, name, "cannot decode its bytes: " + OIIO::geterror());
    return read(name, *input);
}

}  // namespace spc
