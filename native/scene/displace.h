// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes whose materials move their vertices.
#pragma once

#include "scene/scene.h"

namespace spc {

// Gives each instance with such a material a mesh of its own, displaced; those with the same mesh
// and the same materials share one, which is displaced as the first of them stands. The meshes that
// they came with stay as they are. Needs the layers of UV resolved.
void displace(Scene& scene, uint32_t threads);

}  // namespace spc
