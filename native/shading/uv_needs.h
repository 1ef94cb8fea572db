// SPDX-License-Identifier: GPL-3.0-or-later
// What a compiled material reads from the mesh that it is on.
#pragma once

#include "shading/program.h"

namespace spc {

struct UvNeed {
    std::string layer;      // "": the active one
    bool tangents = false;  // its tangents, too
};

// In the order of Material::uv_layers.
std::vector<UvNeed> uv_needs(const Material& material);

}  // namespace spc
