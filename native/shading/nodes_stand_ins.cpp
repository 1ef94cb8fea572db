// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes that something simpler stands in for: each says so. docs/nodes.md lists them.
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

void add_diffuse(NodeContext& node, ExprId weight, ExprId normal, ExprId color, bool through) {
    ClosureTerm term;
    term.op = through ? ClosureOp::translucent : ClosureOp::lambert;
    term.node = node.index;
    term.label = node.label();
    term.in = {weight, normal, color};
    node.c.add_term(std::move(term));
}

// Between how much a hair reflects in all and how much it absorbs, by its roughness around the hair
// [Chiang16 Eq. 9]: color = exp(-factor sqrt(absorption)).
ExprId color_factor(NodeContext& node, ExprId roughness) {
    ExprBuilder& e = node.e;
    ExprId sum = e.constant(0.245f);
    for (const float k : {5.574f, -10.73f, 2.532f, -0.215f, 5.969f})
        sum = e.add(e.multiply(sum, roughness), e.constant(k));
    return sum;
}
ExprId color_of_absorption(NodeContext& node, ExprId absorption, ExprId factor) {
    ExprBuilder& e = node.e;
    const ExprId depth = e.scale(e.square_root(e.non_negative(absorption)), factor);
    return e.make(Op::exponent, {e.subtract(e.constant(Vec3(0.0f)), depth)});
}
// Of eumelanin and pheomelanin, in shares of Blender's scale from 0 to 1.
ExprId absorption_of_melanin(NodeContext& node, ExprId melanin, ExprId redness) {
    ExprBuilder& e = node.e;
    const ExprId clear = e.maximum(e.one_minus(melanin), e.constant(1e-4f));
    const ExprId amount = e.subtract(
        e.constant(0.0f), e.make(Op::logarithm, {clear, e.constant(std::numbers::e_v<float>)}));
    const ExprId eumelanin = e.multiply(amount, e.one_minus(redness)),
                 pheomelanin = e.multiply(amount, redness);
    return e.add(e.scale(e.constant(Vec3(0.506f, 0.841f, 1.653f)), eumelanin),
                 e.scale(e.constant(Vec3(0.343f, 0.733f, 1.924f)), pheomelanin));
}

}  // namespace

void hair(NodeContext& node, ExprId weight) {
    enum { kColor, kOffset, kRoughnessU, kRoughnessV };
    node.warn("hair is not supported, it is drawn as a diffuse surface");
    add_diffuse(node, weight, kNoExpr, node.input(kColor), node.option(0) == "Transmission");
}

void principled_hair(NodeContext& node, ExprId weight) {
    enum { kColor, kMelanin, kRedness, kTint, kAbsorption, kRadialRoughness };
    node.warn("hair is not supported, it is drawn as a diffuse surface");
    ExprBuilder& e = node.e;
    const ExprId factor = color_factor(node, node.input(kRadialRoughness));
    const std::string& given = node.option(0);
    ExprId color = node.input(kColor);
    if (given == "ABSORPTION")
        color = color_of_absorption(node, node.input(kAbsorption), factor);
    else if (given == "MELANIN")
        color = e.multiply(
            color_of_absorption(
                node, absorption_of_melanin(node, node.input(kMelanin), node.input(kRedness)),
                factor),
            node.input(kTint));
    add_diffuse(node, weight, kNoExpr, color, false);
}

void ray_portal(NodeContext& node, ExprId weight) {
    node.warn("a portal is not supported, it is looked through");
    ClosureTerm term;
    term.op = ClosureOp::transparent;
    term.node = node.index;
    term.label = node.label();
    term.in = {weight, kNoExpr, node.input(0)};
    node.c.add_term(std::move(term));
}

}  // namespace spc::nodes
