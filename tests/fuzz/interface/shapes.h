// SPDX-License-Identifier: GPL-3.0-or-later
// Random meshes and transforms.
#pragma once

#include "dice.h"
#include "specula/specula.h"

namespace spc::fuzz {

// With the storage for what it points to.
struct Shape {
    std::vector<float> positions, normals, uv, tangents;
    std::vector<uint32_t> triangles, slots;
    std::vector<spc_attribute> attributes;
    spc_mesh_desc desc{};
};
Shape random_shape(Dice& dice, Spoiler& spoiler);

// Turned, scaled, moved, rarely far or tiny.
void random_transform(Dice& dice, Spoiler& spoiler, float (&rows)[12]);

}  // namespace spc::fuzz
