// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace spc {

// What a program may read at a point.
enum ProgramReads : uint32_t {
    kReadsAttributes = 1,
    kReadsTangent = 2,
    kReadsPosition = 4,
    kReadsObjectPosition = 8,
    kReadsObjectNormal = 16,
    kReadsHeights = 32,
    kReadsRay = 64,  // but its length
    kReadsView = 128,
    kReadsSides = 256,
    kReadsRayLength = 512
};

}  // namespace spc
