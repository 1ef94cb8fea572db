// SPDX-License-Identifier: GPL-3.0-or-later
// Axis-aligned bounding boxes.
#pragma once

#include "math/vec.h"

namespace spc {

struct Bounds {
    Vec3 lower{kInfinity}, upper{-kInfinity};  // of nothing

    bool empty() const { return lower.x > upper.x; }
    void extend(const Vec3& p) {
        for (int i = 0; i < 3; ++i) {
            lower[i] = std::min(lower[i], p[i]);
            upper[i] = std::max(upper[i], p[i]);
        }
    }
    void extend(const Bounds& other) {
        if (other.empty()) return;
        extend(other.lower);
        extend(other.upper);
    }
};

}  // namespace spc
