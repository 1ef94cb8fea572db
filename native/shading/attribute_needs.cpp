// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/attribute_needs.h"

#include "shading/instruction.h"

namespace spc {

std::vector<AttributeNeed> attribute_needs(const Material& material) {
    std::vector<AttributeNeed> needs;
    for (const AttributeName& attribute : material.attributes) needs.push_back({attribute});
    for (const Instruction& i : material.program->instructions)
        if ((traits(i.op).reads & kReadsTangent) != 0) needs[i.index].tangents = true;
    if (material.may_glint() && material.slopes.relief == Relief::normals)
        needs[material.slopes.tangent_layer].tangents = true;
    return needs;
}

}  // namespace spc
