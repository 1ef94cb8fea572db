// SPDX-License-Identifier: GPL-3.0-or-later
// See OpenImageIOConfig.cmake. No image can be opened, so no member of an ImageInput is ever called.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "OpenImageIO/filesystem.h"

namespace OIIO {

using stride_t = int64_t;
inline constexpr stride_t AutoStride = 0;

enum class TypeDesc { UNKNOWN, UINT8, FLOAT, PTR };

struct ImageSpec {
    int width = 0, height = 0, nchannels = 0, alpha_channel = -1;
    TypeDesc format = TypeDesc::UNKNOWN;
    std::vector<TypeDesc> channelformats;

    void attribute(const char*, int) {}
    void attribute(const char*, TypeDesc, const void*) {}
    int get_int_attribute(const char*, int otherwise) const { return otherwise; }
};

class ImageInput {
public:
    static std::unique_ptr<ImageInput> open(const std::string&, const ImageSpec*,
                                            Filesystem::IOProxy* = nullptr) {
        return nullptr;
    }
    const ImageSpec& spec() const { return spec_; }
    const char* format_name() const { return ""; }
    bool read_image(int, int, int, int, TypeDesc, void*, stride_t, stride_t, stride_t) {
        return false;
    }
    std::string geterror() const { return ""; }

private:
    ImageSpec spec_;
};

inline std::string geterror() { return "this build of Specula reads no image files"; }

}  // namespace OIIO
