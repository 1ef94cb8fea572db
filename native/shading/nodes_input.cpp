// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that tell from where a point is seen and what lies there. Semantics are Cycles';
// docs/nodes.md lists what differs.
#include "shading/node_table.h"
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

SocketType type_of(NodeContext& node, int output) {
    return node.c.node(node.index).kind->outputs[static_cast<size_t>(output)].type;
}

ExprId zero(NodeContext& node, int output) {
    return type_of(node, output) == SocketType::scalar ? node.e.constant(0.0f)
                                                       : node.e.constant(Vec3(0.0f));
}

// What the object has under the name of an output.
ExprId of_object(NodeContext& node, AttributeKind kind, int output) {
    const OutputSocket& socket = node.c.node(node.index).kind->outputs[static_cast<size_t>(output)];
    const ExprId value = node.attribute(kind, socket.name);
    return socket.type == SocketType::scalar ? node.e.lane(value, 0) : value;
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
    enum {
        kPosition,
        kNormal,
        kTangent,
        kTrueNormal,
        kIncoming,
        kParametric,
        kBackfacing,
        kPointiness,
        kIsland
    };
    ExprBuilder& e = node.e;
    const bool world = node.c.is_world();
    if (output == kPointiness || output == kIsland) {
        if (world) return e.constant(0.0f);
        return e.lane(
            node.attribute(output == kIsland ? AttributeKind::island : AttributeKind::pointiness),
            0);
    }
    if (output == kTangent || output == kParametric) {
        if (world) return e.constant(Vec3(0.0f));
        return output == kParametric ? e.make(Op::barycentric, {}) : radial_tangent(node, 2);
    }
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

ExprId light_path(NodeContext& node, int output) {
    enum {
        kCamera,
        kShadow,
        kDiffuse,
        kGlossy,
        kSingular,
        kReflection,
        kTransmission,
        kVolumeScatter,
        kLength,
        kDepth,
        kDiffuseDepth,
        kGlossyDepth,
        kTransparentDepth,
        kTransmissionDepth,
        kPortalDepth
    };
    ExprBuilder& e = node.e;
    const auto depth = [&](RayDepth of) {
        return e.make(Op::ray_depth, {}, static_cast<uint8_t>(of));
    };
    switch (output) {
        case kVolumeScatter:  // there is neither
        case kPortalDepth: return e.constant(0.0f);
        case kLength: return e.make(Op::ray_length, {});
        case kDepth: return depth(RayDepth::total);
        case kDiffuseDepth: return depth(RayDepth::diffuse);
        case kGlossyDepth: return depth(RayDepth::glossy);
        case kTransparentDepth: return depth(RayDepth::transparent);
        case kTransmissionDepth: return depth(RayDepth::transmission);
        default: return e.make(Op::ray_kind, {}, static_cast<uint8_t>(1 << output));
    }
}

// What falls off as the square of the distance is left as it is; the others make up for it.
ExprId light_falloff(NodeContext& node, int output) {
    enum { kStrength, kSmooth };
    enum { kQuadratic, kLinear, kConstant };
    ExprBuilder& e = node.e;
    const ExprId length = e.make(Op::ray_length, {}), square = e.multiply(length, length);
    ExprId strength = node.input(kStrength);
    if (!e.is_constant(node.input(kSmooth), 0.0f))
        strength = e.multiply(strength, e.divide(square, e.add(node.input(kSmooth), square)));
    if (output == kQuadratic) return strength;
    return e.multiply(strength, output == kLinear ? length : square);
}

namespace {

// The colour of a table at `factor`, which runs from 0 to 1 over it.
ExprId looked_up(NodeContext& node, ExprId factor) {
    return node.e.make(Op::ramp, {node.e.clamp01(factor)},
                       static_cast<uint8_t>(Interpolation::linear), node.ramp(0));
}

}  // namespace

// The table is even in the inverse temperature, by which colours change evenly.
ExprId blackbody(NodeContext& node, int) {
    constexpr float kColdest = 800.0f, kHottest = 12000.0f;  // K
    constexpr float kAtHottest = 1.0f / kHottest, kRange = 1.0f / kColdest - kAtHottest;
    ExprBuilder& e = node.e;
    const ExprId inverse =
        e.divide(e.constant(1.0f),
                 e.make(Op::clamp, {node.input(0), e.constant(kColdest), e.constant(kHottest)}));
    return looked_up(
        node, e.multiply(e.subtract(inverse, e.constant(kAtHottest)), e.constant(1.0f / kRange)));
}

ExprId wavelength(NodeContext& node, int) {
    constexpr float kShortest = 380.0f, kLongest = 780.0f;  // nm
    ExprBuilder& e = node.e;
    return looked_up(node, e.multiply(e.subtract(node.input(0), e.constant(kShortest)),
                                      e.constant(1.0f / (kLongest - kShortest))));
}

// Nothing is looked for around the point: edges stay sharp, and everything is open.
ExprId bevel(NodeContext& node, int) {
    enum { kRadius, kNormal };
    const ExprId normal = node.normal(kNormal);
    if (normal != kNoExpr) return normal;
    return node.c.is_world() ? node.e.constant(Vec3(0.0f)) : node.e.make(Op::normal, {});
}

ExprId ambient_occlusion(NodeContext& node, int output) {
    enum { kColor, kOcclusion };
    return output == kOcclusion ? node.e.constant(1.0f) : node.input(kColor);
}

// Of points and volumes on a mesh, which is neither.
ExprId absent_info(NodeContext& node, int output) { return zero(node, output); }

ExprId attribute(NodeContext& node, int output) {
    enum { kColor, kVector, kFac, kAlpha };
    enum { kType, kName };
    if (refused_in_world(node)) return zero(node, output);
    const std::string& type = node.option(kType);
    const AttributeKind kind = type == "OBJECT"       ? AttributeKind::object
                               : type == "INSTANCER"  ? AttributeKind::instancer
                               : type == "VIEW_LAYER" ? AttributeKind::view_layer
                                                      : AttributeKind::named;
    const ExprId value = node.attribute(kind, node.option(kName));
    if (output == kAlpha) return node.e.lane(value, 3);
    return output == kFac ? node.e.mean(value) : value;
}

ExprId vertex_color(NodeContext& node, int output) {
    enum { kColor, kAlpha };
    if (refused_in_world(node)) return zero(node, output);
    const ExprId color = node.attribute(AttributeKind::color, node.option(0));
    return output == kAlpha ? node.e.lane(color, 3) : color;
}

ExprId object_info(NodeContext& node, int output) {
    enum { kLocation, kColor, kAlpha, kObjectIndex, kMaterialIndex, kRandom };
    if (output == kMaterialIndex) return node.input(0);
    if (refused_in_world(node)) return zero(node, output);
    if (output == kAlpha)
        return node.e.lane(of_object(node, AttributeKind::object_info, kColor), 3);
    return of_object(node, AttributeKind::object_info, output);
}

ExprId particle_info(NodeContext& node, int output) {
    if (refused_in_world(node)) return zero(node, output);
    return of_object(node, AttributeKind::particle_info, output);
}

}  // namespace spc::nodes
