// SPDX-License-Identifier: GPL-3.0-or-later
// Normals of triangles, however small.
#pragma once

#include "math/vec.h"

namespace spc {

// Unit, to the side from which the edges e1 and e2 from one corner turn counter-clockwise; +z for a
// triangle without area.
inline Vec3 unit_normal(const Vec3& e1, const Vec3& e2) {
    const Vec3 n = cross(e1, e2);
    const float squared = length_squared(n);
    if (squared >= std::numeric_limits<float>::min()) return n * (1.0f / std::sqrt(squared));
    const Vec3d fine = safe_normalize(cross(Vec3d(e1), Vec3d(e2)), Vec3d(0.0, 0.0, 1.0));
    return Vec3(fine);
}

}  // namespace spc
