// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes: what each adds to what lies behind a surface. Semantics are Cycles'; docs/nodes.md
// lists what differs.
#include "shading/nodes.h"

namespace spc::nodes {

// A colour is what is left of white light, to first order: sigma = density (1 - color).
void volume_absorption(NodeContext& node, ExprId weight) {
    enum { kColor, kDensity };
    ExprBuilder& e = node.e;
    const ExprId absorbed = e.one_minus(e.clamp01(node.input(kColor)));
    node.c.add_absorption(e.scale(absorbed, e.non_negative(node.input(kDensity))), weight);
}

// What is not scattered is absorbed, less the root of the absorption colour.
void volume_principled(NodeContext& node, ExprId weight) {
    enum { kColor, kDensity, kAbsorptionColor };
    ExprBuilder& e = node.e;
    const ExprId color = node.input(kColor);
    if (!e.is_constant(color, 0.0f) && !e.is_constant(node.input(kDensity), 0.0f))
        node.warn("scattering is not supported, the volume only absorbs");
    const ExprId not_scattered = e.one_minus(e.clamp01(color));
    const ExprId absorbed = e.one_minus(e.square_root(e.clamp01(node.input(kAbsorptionColor))));
    node.c.add_absorption(
        e.scale(e.multiply(not_scattered, absorbed), e.non_negative(node.input(kDensity))), weight);
}

}  // namespace spc::nodes
