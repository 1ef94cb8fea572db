// SPDX-License-Identifier: GPL-3.0-or-later
// The camera as graphs see it.
#pragma once

#include "math/vec.h"

#include <array>

namespace spc {

// Coordinates of the world and the camera here are those that the host gave.
struct ViewSpace {
    Transform from_world, to_world;  // orthonormal; x is right, y up, z away from the camera
    bool perspective = true;
    // Left, right, bottom, top of the frame: at distance 1, of parallel rays in m.
    std::array<float, 4> viewplane{-1, 1, -1, 1};
    float pixel = 0.0f;  // width of one, likewise
    Vec3 origin{0.0f};   // of the scene's world coordinates
};

}  // namespace spc
