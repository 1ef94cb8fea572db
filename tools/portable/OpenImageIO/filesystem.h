// SPDX-License-Identifier: GPL-3.0-or-later
// See OpenImageIOConfig.cmake.
#pragma once

#include <cstddef>
#include <cstdint>

namespace OIIO {

template <class T>
struct cspan {
    using index_type = ptrdiff_t;
    cspan(const T*, index_type) {}
};

namespace Filesystem {

struct IOProxy {};

struct IOMemReader : IOProxy {
    explicit IOMemReader(cspan<uint8_t>) {}
};

}  // namespace Filesystem
}  // namespace OIIO
