// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that compute values from values. Semantics are Cycles'; docs/nodes.md lists what differs.
#include "shading/color_functions.h"
#include "shading/named_ops.h"
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

const NamedOp& find_op(std::span<const NamedOp> ops, std::string_view name) {
    return *std::find_if(ops.begin(), ops.end(), [&](const NamedOp& op) { return op.name == name; });
}

// As a vector, where a Mix has one factor for all lanes.
ExprId mixed(ExprBuilder& e, ExprId a, ExprId b, ExprId t) {
    if (e.is_constant(t, 0.0f)) return a;
    if (e.is_constant(t, 1.0f)) return b;
    return e.make(Op::mix, {a, b, t});
}

ExprId blended(ExprBuilder& e, const std::string& type, ExprId a, ExprId b, ExprId t) {
    if (e.is_constant(t, 0.0f)) return a;
    if (type == "MIX" && e.is_constant(t, 1.0f)) return b;
    return e.make(Op::blend, {a, b, t}, static_cast<uint8_t>(choice_of(kBlendTypes, type)));
}

// Where from + share (to - from) is in Map Range's ways.
ExprId mapped_share(ExprBuilder& e, const std::string& type, ExprId value, ExprId from, ExprId to,
                    ExprId steps) {
    if (type == "SMOOTHSTEP") return e.make(Op::smoothstep, {value, from, to});
    if (type == "SMOOTHERSTEP") return e.make(Op::smootherstep, {value, from, to});
    const ExprId share = e.divide(e.subtract(value, from), e.subtract(to, from));
    if (type == "LINEAR") return share;
    const ExprId one = e.lanes(steps) == 1 ? e.constant(1.0f) : e.constant(Vec3(1.0f));
    return e.divide(e.make(Op::floor, {e.multiply(share, e.add(steps, one))}), steps);
}

// Between bounds in either order.
ExprId clamped_to_range(ExprBuilder& e, ExprId value, ExprId a, ExprId b) {
    return e.make(Op::clamp, {value, e.make(Op::minimum, {a, b}), e.maximum(a, b)});
}

// Curves as Cycles has them, tables whose rows begin with where they are looked up, equally spaced.
ExprId followed(NodeContext& node, ExprId value) {
    enum { kExtend };
    const std::vector<float>& rows = node.array(0);
    const size_t lanes = node.e.lanes(value), columns = lanes + 1, count = rows.size() / columns;
    std::vector<float> block{static_cast<float>(count),
                             node.option(kExtend) == "EXTRAPOLATED" ? 1.0f : 0.0f, rows.front(),
                             rows[rows.size() - columns]};
    if (!(block[3] > block[2])) return value;  // curves of no extent
    for (size_t k = 0; k < count; ++k)
        block.insert(block.end(), rows.begin() + static_cast<std::ptrdiff_t>(k * columns + 1),
                     rows.begin() + static_cast<std::ptrdiff_t>((k + 1) * columns));
    return node.e.make(Op::curves, {value}, static_cast<uint8_t>(Interpolation::linear),
                       node.e.block(block));
}

}  // namespace

ExprId math(NodeContext& node, int) {
    enum { kOperation, kClamp };
    const Op op = find_op(kMathOps, node.option(kOperation)).op;
    std::vector<ExprId> in;
    for (int k = 0; k < traits(op).arity; ++k) in.push_back(node.input(k));
    const ExprId result = node.e.make(op, std::move(in));
    return node.enabled(kClamp) ? node.e.clamp01(result) : result;
}

ExprId vector_math(NodeContext& node, int output) {
    enum { kScale = 3 };
    enum { kVector, kValue };
    ExprBuilder& e = node.e;
    const NamedOp& row = find_op(kVectorMathOps, node.option(0));
    const int arity = traits(row.op).arity;
    std::vector<ExprId> in;
    for (int k = 0; k < arity; ++k)
        in.push_back(node.input(row.scaled && k == arity - 1 ? kScale : k));
    const ExprId result = e.make(row.op, std::move(in));
    // The other output is hidden.
    if (output == kValue) return e.lanes(result) == 1 ? result : e.constant(0.0f);
    return e.lanes(result) == 3 ? result : e.constant(Vec3(0.0f));
}

ExprId mix(NodeContext& node, int output) {
    enum { kFactor, kFactorVector, kA, kB, kAVector, kBVector, kAColor, kBColor };
    enum { kFactorMode, kBlend, kClampFactor, kClampResult };
    enum { kFloat, kVector, kColor };
    ExprBuilder& e = node.e;
    const bool by_lane = output == kVector && node.option(kFactorMode) == "NON_UNIFORM";
    ExprId t = node.input(by_lane ? kFactorVector : kFactor);
    if (node.enabled(kClampFactor)) t = e.clamp01(t);
    if (output == kFloat) return mixed(e, node.input(kA), node.input(kB), t);
    if (output == kVector)
        return mixed(e, node.input(kAVector), node.input(kBVector), by_lane ? t : e.splat(t));
    const ExprId color =
        blended(e, node.option(kBlend), node.input(kAColor), node.input(kBColor), t);
    return node.enabled(kClampResult) ? e.clamp01(color) : color;
}

ExprId mix_rgb(NodeContext& node, int) {
    enum { kFac, kColor1, kColor2 };
    enum { kBlend, kClamp };
    const ExprId color = blended(node.e, node.option(kBlend), node.input(kColor1),
                                 node.input(kColor2), node.e.clamp01(node.input(kFac)));
    return node.enabled(kClamp) ? node.e.clamp01(color) : color;
}

ExprId map_range(NodeContext& node, int output) {
    enum { kFirstOfVector = 6 };
    enum { kValue, kFromMin, kFromMax, kToMin, kToMax, kSteps };
    enum { kInterpolation, kClamp };
    ExprBuilder& e = node.e;
    const auto in = [&](int i) { return node.input(output == 0 ? i : kFirstOfVector + i); };
    const std::string& type = node.option(kInterpolation);
    const ExprId from = in(kFromMin), to = in(kFromMax), low = in(kToMin), high = in(kToMax);
    const ExprId share = mapped_share(e, type, in(kValue), from, to, in(kSteps));
    const ExprId mapped = e.add(low, e.multiply(share, e.subtract(high, low)));
    // A float that comes from an empty range is 0, whatever it is mapped to.
    const bool empty = output == 0 && e.is_constant(e.subtract(to, from), 0.0f);
    const ExprId result = empty ? e.constant(0.0f) : mapped;
    const bool steep = type == "LINEAR" || type == "STEPPED";
    return node.enabled(kClamp) && steep ? clamped_to_range(e, result, low, high) : result;
}

ExprId clamp(NodeContext& node, int) {
    enum { kValue, kMin, kMax };
    const ExprId value = node.input(kValue), min = node.input(kMin), max = node.input(kMax);
    if (node.option(0) == "RANGE") return clamped_to_range(node.e, value, min, max);
    return node.e.make(Op::clamp, {value, min, max});
}

ExprId separate_xyz(NodeContext& node, int output) {
    return node.e.lane(node.input(0), static_cast<uint8_t>(output));
}

ExprId combine_xyz(NodeContext& node, int) {
    return node.e.combine(node.input(0), node.input(1), node.input(2));
}

ExprId separate_color(NodeContext& node, int output) {
    const std::string& mode = node.option(0);
    ExprId color = node.input(0);
    if (mode == "HSV") color = node.e.make(Op::rgb_to_hsv, {color});
    if (mode == "HSL") color = node.e.make(Op::rgb_to_hsl, {color});
    return node.e.lane(color, static_cast<uint8_t>(output));
}

ExprId combine_color(NodeContext& node, int output) {
    const std::string& mode = node.option(0);
    const ExprId color = combine_xyz(node, output);
    if (mode == "HSV") return node.e.make(Op::hsv_to_rgb, {color});
    return mode == "HSL" ? node.e.make(Op::hsl_to_rgb, {color}) : color;
}

ExprId vector_rotate(NodeContext& node, int) {
    enum { kVector, kCenter, kAxis, kAngle, kRotation };
    enum { kType, kInvert };
    ExprBuilder& e = node.e;
    const std::string& type = node.option(kType);
    const bool back = node.enabled(kInvert);
    const ExprId center = node.input(kCenter), arm = e.subtract(node.input(kVector), center);
    if (type == "EULER_XYZ")
        return e.add(e.make(back ? Op::rotate_back : Op::rotate, {arm, node.input(kRotation)}),
                     center);
    const ExprId axis = type == "X_AXIS"   ? e.constant(Vec3(1, 0, 0))
                        : type == "Y_AXIS" ? e.constant(Vec3(0, 1, 0))
                        : type == "Z_AXIS" ? e.constant(Vec3(0, 0, 1))
                                           : node.input(kAxis);
    const ExprId angle = node.input(kAngle);
    return e.add(
        e.make(Op::rotate_axis, {arm, axis, back ? e.multiply(angle, e.constant(-1.0f)) : angle}),
        center);
}

ExprId rgb_to_bw(NodeContext& node, int) { return node.e.luminance(node.input(0)); }

ExprId invert(NodeContext& node, int) {
    enum { kFac, kColor };
    ExprBuilder& e = node.e;
    const ExprId color = node.input(kColor);
    return mixed(e, color, e.one_minus(color), e.splat(node.input(kFac)));
}

ExprId gamma(NodeContext& node, int) {
    return node.e.make(Op::gamma, {node.input(0), node.input(1)});
}

ExprId bright_contrast(NodeContext& node, int) {
    enum { kColor, kBright, kContrast };
    ExprBuilder& e = node.e;
    const ExprId contrast = node.input(kContrast);
    const ExprId gain = e.add(contrast, e.constant(1.0f));
    const ExprId offset = e.subtract(node.input(kBright), e.multiply(contrast, e.constant(0.5f)));
    return e.non_negative(e.add(e.scale(node.input(kColor), gain), e.splat(offset)));
}

ExprId hue_saturation(NodeContext& node, int) {
    enum { kHue, kSaturation, kValue, kFac, kColor };
    ExprBuilder& e = node.e;
    const ExprId color = node.input(kColor), hsv = e.make(Op::rgb_to_hsv, {color});
    const ExprId hue =
        e.make(Op::fraction, {e.add(e.lane(hsv, 0), e.add(node.input(kHue), e.constant(0.5f)))});
    const ExprId saturation = e.clamp01(e.multiply(e.lane(hsv, 1), node.input(kSaturation)));
    const ExprId value = e.multiply(e.lane(hsv, 2), node.input(kValue));
    const ExprId turned = e.make(Op::hsv_to_rgb, {e.combine(hue, saturation, value)});
    return e.non_negative(mixed(e, color, turned, e.splat(node.input(kFac))));
}

// As in Cycles a table of the ramp, which the host evaluates.
ExprId color_ramp(NodeContext& node, int output) {
    enum { kColor, kAlpha };
    const Interpolation interpolation =
        node.option(0) == "CONSTANT" ? Interpolation::closest : Interpolation::linear;
    const ExprId ramp =
        node.e.make(Op::ramp, {node.input(0)}, static_cast<uint8_t>(interpolation), node.ramp(0));
    return output == kColor ? ramp : node.e.lane(ramp, 3);
}

ExprId curves(NodeContext& node, int) {
    enum { kFac, kValue };
    ExprBuilder& e = node.e;
    const ExprId value = node.input(kValue), fac = node.input(kFac);
    return mixed(e, value, followed(node, value), e.lanes(value) == 3 ? e.splat(fac) : fac);
}

// A direction that is set, and its cosine to another.
ExprId normal(NodeContext& node, int output) {
    enum { kNormal, kDirection };
    enum { kNormalOut, kDot };
    ExprBuilder& e = node.e;
    const ExprId direction = e.normalize(node.input(kDirection));
    if (output == kNormalOut) return direction;
    return e.make(Op::dot, {direction, e.normalize(node.input(kNormal))});
}

}  // namespace spc::nodes
