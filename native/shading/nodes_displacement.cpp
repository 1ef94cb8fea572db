// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that say where points of the surface move, m, world. Semantics are Cycles'; docs/nodes.md
// lists what differs.
#include "shading/nodes.h"

namespace spc::nodes {

// Along a normal. In object space its length goes with the object's scale.
ExprId displacement(NodeContext& node, int) {
    enum { kHeight, kMidlevel, kScale, kNormal };
    ExprBuilder& e = node.e;
    if (node.c.is_world()) return e.constant(Vec3(0.0f));
    const ExprId amount =
        e.multiply(e.subtract(node.input(kHeight), node.input(kMidlevel)), node.input(kScale));
    const ExprId normal = node.normal(kNormal);
    if (node.option(0) == "OBJECT") {
        const ExprId in_object = e.make(Op::normal_object, {normal}, kHeldStill);
        return e.scale(e.make(Op::direction_to_world, {in_object}), amount);
    }
    return e.scale(normal != kNoExpr ? normal : e.make(Op::normal, {}, kHeldStill), amount);
}

// Of three coordinates. In tangent space the second goes along the normal.
ExprId vector_displacement(NodeContext& node, int) {
    enum { kVector, kMidlevel, kScale };
    ExprBuilder& e = node.e;
    if (node.c.is_world()) return e.constant(Vec3(0.0f));
    const ExprId offset = e.scale(e.subtract(node.input(kVector), e.splat(node.input(kMidlevel))),
                                  node.input(kScale));
    if (node.option(0) == "WORLD") return offset;
    if (node.option(0) == "OBJECT") return e.make(Op::direction_to_world, {offset});
    const ExprId normal = e.make(Op::normal_object, {kNoExpr}, kHeldStill);
    const ExprId tangent = e.make(Op::tangent_object, {}, 0, node.c.attribute(AttributeKind::uv));
    const ExprId bitangent =
        e.scale(e.normalize(e.make(Op::cross, {normal, tangent})), e.lane(tangent, 3));
    const ExprId along =
        e.add(e.scale(tangent, e.lane(offset, 0)), e.scale(normal, e.lane(offset, 1)));
    return e.make(Op::direction_to_world, {e.add(along, e.scale(bitangent, e.lane(offset, 2)))});
}

}  // namespace spc::nodes
