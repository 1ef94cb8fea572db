// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes of hair, and what it tells of itself. The host makes tubes of strands, whose
// attributes are called by the names below.
#include "shading/node_table.h"
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

// Along the strand, world; zero on what is none.
ExprId strand_tangent(NodeContext& node) {
    return node.e.make(Op::direction_to_world,
                       {node.attribute(AttributeKind::named, ".strand_tangent")});
}
ExprId is_strand(NodeContext& node) {
    return node.e.make(Op::greater,
                       {node.e.make(Op::length, {strand_tangent(node)}), node.e.constant(0.0f)});
}
enum StrandLane : uint8_t { kIntercept, kLength, kThickness, kRandom };
// Zero on what is none, whose attribute would have an alpha of 1.
ExprId strand_value(NodeContext& node, StrandLane lane) {
    const ExprId value = node.e.lane(node.attribute(AttributeKind::named, ".strand"), lane);
    return lane == kRandom ? node.e.multiply(value, is_strand(node)) : value;
}

// Light that a tube's front sends through the hair leaves at its back as it came there.
ExprId front_of_tubes(NodeContext& node, ExprId weight) {
    ExprBuilder& e = node.e;
    const ExprId behind = e.multiply(e.make(Op::backfacing, {}), is_strand(node));
    ClosureTerm out;
    out.op = ClosureOp::transparent;
    out.node = node.index;
    out.label = node.label();
    out.in = {e.multiply(weight, behind), kNoExpr, e.constant(Vec3(1.0f))};
    node.c.add_term(std::move(out));
    return e.multiply(weight, e.one_minus(behind));
}

ClosureTerm term(NodeContext& node, ClosureOp op, std::vector<ExprId> operands) {
    ClosureTerm t;
    t.op = op;
    t.node = node.index;
    t.label = node.label();
    t.in = std::move(operands);
    return t;
}

// Between what a hair reflects in all and what it absorbs, by its roughness around the hair
// [Chiang16 Eq. 9]: absorption = (log(color) / factor)^2.
ExprId absorption_of_color(NodeContext& node, ExprId color, ExprId roughness) {
    ExprBuilder& e = node.e;
    ExprId factor = e.constant(0.245f);
    for (const float k : {5.574f, -10.73f, 2.532f, -0.215f, 5.969f})
        factor = e.add(e.multiply(factor, roughness), e.constant(k));
    const auto depth = [&](uint8_t lane) {
        const ExprId channel = e.maximum(e.lane(color, lane), e.constant(1e-10f));
        const ExprId log = e.make(Op::logarithm, {channel, e.constant(std::numbers::e_v<float>)});
        const ExprId ratio = e.divide(log, factor);
        return e.multiply(ratio, ratio);
    };
    return e.combine(depth(0), depth(1), depth(2));
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
    const bool through = node.option(0) == "Transmission";
    weight = front_of_tubes(node, weight);
    node.c.add_term(term(node, through ? ClosureOp::hair_transmission : ClosureOp::hair_reflection,
                         {weight, kNoExpr, node.input(kColor), strand_tangent(node),
                          node.input(kRoughnessU), node.input(kRoughnessV), node.input(kOffset)}));
}

void principled_hair(NodeContext& node, ExprId weight) {
    enum {
        kColor,
        kMelanin,
        kRedness,
        kTint,
        kAbsorption,
        kRoughness,
        kRadialRoughness,
        kCoat,
        kIor,
        kOffset,
        kRandomColor,
        kRandomRoughness,
        kRandomInput
    };
    ExprBuilder& e = node.e;
    const bool elliptic = node.option(1) == "HUANG";
    if (elliptic) node.warn("Huang's model of hair is not supported, Chiang's is used");
    ExprId random = node.input(kRandomInput);
    if (!node.linked(kRandomInput))
        random = e.make(Op::mix, {random, strand_value(node, kRandom), is_strand(node)});
    // Within a share of it to both sides.
    const auto varied = [&](ExprId value, int share) {
        const ExprId by = e.multiply(
            e.subtract(e.multiply(random, e.constant(2.0f)), e.constant(1.0f)), node.input(share));
        return e.multiply(value, e.add(e.constant(1.0f), by));
    };
    const ExprId roughness = varied(node.input(kRoughness), kRandomRoughness);
    const ExprId around =
        elliptic ? roughness : varied(node.input(kRadialRoughness), kRandomRoughness);
    const std::string& given = node.option(0);
    ExprId absorption = node.input(kAbsorption);
    if (given == "COLOR")
        absorption = absorption_of_color(node, node.input(kColor), around);
    else if (given == "MELANIN")
        absorption = e.add(absorption_of_melanin(node, varied(node.input(kMelanin), kRandomColor),
                                                 node.input(kRedness)),
                           absorption_of_color(node, node.input(kTint), around));
    weight = front_of_tubes(node, weight);
    node.c.add_term(term(node, ClosureOp::hair_fibre,
                         {weight, kNoExpr, strand_tangent(node), absorption, roughness, around,
                          elliptic ? e.constant(0.0f) : node.input(kCoat),
                          e.maximum(node.input(kIor), e.constant(1e-5f)), node.input(kOffset)}));
}

ExprId hair_info(NodeContext& node, int output) {
    enum { kIsStrandOut, kInterceptOut, kLengthOut, kThicknessOut, kTangentNormalOut, kRandomOut };
    ExprBuilder& e = node.e;
    if (node.c.is_world())
        return output == kTangentNormalOut ? e.constant(Vec3(0.0f)) : e.constant(0.0f);
    switch (output) {
        case kIsStrandOut: return is_strand(node);
        case kInterceptOut: return strand_value(node, kIntercept);
        case kLengthOut: return strand_value(node, kLength);
        case kThicknessOut: return strand_value(node, kThickness);
        case kRandomOut: return strand_value(node, kRandom);
        default: break;
    }
    // Across the strand, towards the viewer.
    const ExprId along = e.normalize(strand_tangent(node)), wo = e.make(Op::incoming, {});
    return e.normalize(e.subtract(wo, e.make(Op::project, {wo, along})));
}

}  // namespace spc::nodes
