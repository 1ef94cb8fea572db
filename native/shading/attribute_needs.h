// SPDX-License-Identifier: GPL-3.0-or-later
// What a compiled material reads from the mesh and the object that it is on.
#pragma once

#include "shading/program.h"

namespace spc {

struct AttributeNeed {
    AttributeName attribute;
    bool tangents = false;  // its tangents, too
};

// In the order of Material::attributes.
std::vector<AttributeNeed> attribute_needs(const Material& material);

}  // namespace spc
