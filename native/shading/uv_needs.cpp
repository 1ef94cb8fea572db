// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/uv_needs.h"

#include "shading/instruction.h"

namespace spc {

std::vector<UvNeed> uv_needs(const Material& material) {
    std::vector<UvNeed> needs;
    for (const std::string& layer : material.uv_layers) needs.push_back({layer});
    for (const Instruction& i : material.program->instructions)
        if ((traits(i.op).reads & kReadsTangent) != 0) needs[i.index].tangents = true;
    if (material.may_glint() && material.slopes.relief == Relief::normals)
        needs[material.slopes.tangent_layer].tangents = true;
    return needs;
}

}  // namespace spc
