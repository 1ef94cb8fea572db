// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that tell from where a point is seen and what lies there. Semantics are Cycles';
// docs/nodes.md lists what differs.
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

// Reflectance of an interface of this index, which is its inverse on back faces.
ExprId fresnel_of(NodeContext& node, ExprId front_index, ExprId normal) {
    ExprBuilder& e = node.e;
    const ExprId one = e.constant(1.0f);
    const ExprId index =
        e.make(Op::mix, {front_index, e.divide(one, front_index), e.make(Op::backfacing, {})});
    return e.make(Op::fresnel, {e.make(Op::facing, {normal}), index});
}

bool refused_in_world(NodeContext& node) {
    if (node.c.is_world()) node.warn(std::string(node.label()) + " has no meaning in a background");
    return node.c.is_world();
}

}  // namespace

ExprId fresnel(NodeContext& node, int) {
    enum { kIor, kNormal };
    if (refused_in_world(node)) return node.e.constant(0.0f);
    const ExprId index = node.e.maximum(node.input(kIor), node.e.constant(1e-5f));
    return fresnel_of(node, index, node.normal(kNormal));
}

ExprId layer_weight(NodeContext& node, int output) {
    enum { kBlend, kNormal };
    enum { kFresnel, kFacing };
    if (refused_in_world(node)) return node.e.constant(0.0f);
    ExprBuilder& e = node.e;
    const ExprId one = e.constant(1.0f), normal = node.normal(kNormal);
    if (output == kFresnel) {
        const ExprId inverse = e.maximum(e.one_minus(node.input(kBlend)), e.constant(1e-5f));
        return fresnel_of(node, e.divide(one, inverse), normal);
    }
    // The exponent rises from 0 through 1, at a half, to where the weight is 1 but head-on.
    const ExprId blend =
        e.make(Op::clamp, {node.input(kBlend), e.constant(0.0f), e.constant(1.0f - 1e-5f)});
    const ExprId half = e.constant(0.5f);
    const ExprId exponent = e.make(Op::mix, {e.divide(half, e.one_minus(blend)),
                                             e.add(blend, blend), e.make(Op::less, {blend, half})});
    const ExprId cosine = e.make(Op::absolute, {e.make(Op::facing, {normal})});
    return e.one_minus(e.make(Op::power, {cosine, exponent}));
}

ExprId geometry(NodeContext& node, int output) {
    enum { kPosition, kNormal, kTrueNormal, kIncoming, kBackfacing };
    ExprBuilder& e = node.e;
    const bool world = node.c.is_world();
    if (output == kBackfacing) return world ? e.constant(0.0f) : e.make(Op::backfacing, {});
    const ExprId position = e.make(Op::position, {});
    if (output == kPosition) return position;
    if (world) return e.scale(position, e.constant(-1.0f));
    if (output == kNormal && node.c.surface_normal() != kNoExpr) return node.c.surface_normal();
    const Op op = output == kNormal       ? Op::normal
                  : output == kTrueNormal ? Op::true_normal
                                          : Op::incoming;
    return e.make(op, {});
}

}  // namespace spc::nodes
