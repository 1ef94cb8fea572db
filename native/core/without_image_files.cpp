// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image_file.h"

namespace spc {

namespace {

constexpr const char* kReadsNone = "this build of Specula reads no image files";

}  // namespace

ImageFile read_image(const std::string& name, const std::string&) {
    fail_image(ErrorKind::io, name, kReadsNone);
}

ImageFile read_image(const std::string& name, std::span<const uint8_t>) {
    fail_image(ErrorKind::io, name, kReadsNone);
}

}  // namespace spc
