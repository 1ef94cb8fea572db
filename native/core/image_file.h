// SPDX-License-Identifier: GPL-3.0-or-later
// Reading image files: one of two sources implements it. image_file.cpp is the only user of
// OpenImageIO; without_image_files.cpp stands in for it where a package cannot bring OpenImageIO
// and the host decodes images itself (CMake option SPECULA_IMAGE_FILES).
#pragma once

#include "core/error.h"
#include "core/image.h"

namespace spc {

// Throws Error, naming the image.
[[noreturn]] void fail_image(ErrorKind kind, const std::string& name, const std::string& what);
// 1, 3 or 4 channels, neither empty nor too large.
void check_image_size(const std::string& name, uint64_t width, uint64_t height, uint64_t channels);

// Texels as a file has them, bottom row first.
struct ImageFile {
    Image image;
    bool premultiplied;  // by the file's own word
};
ImageFile read_image(const std::string& name, const std::string& path);
ImageFile read_image(const std::string& name, std::span<const uint8_t> encoded);

}  // namespace spc
