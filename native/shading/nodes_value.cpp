// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that give values. Semantics are Cycles'; docs/nodes.md lists what differs.
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

ExprId read_point(ExprBuilder& e, Op op, uint32_t index = 0) { return e.make(op, {}, 0, index); }

ExprId uv(NodeContext& node, const std::string& layer) {
    if (!node.c.is_world()) return node.attribute(AttributeKind::uv, layer);
    node.warn("a background has no UV map; (0, 0) is used");
    return node.e.constant(Vec3(0.0f));
}

Interpolation interpolation_of(const std::string& name) {
    if (name == "Closest") return Interpolation::closest;
    return name == "Linear" ? Interpolation::linear
                            : Interpolation::cubic;  // Smart magnifies as Cubic does
}
Extension extension_of(const std::string& name) {
    if (name == "EXTEND") return Extension::extend;
    if (name == "CLIP") return Extension::clip;
    return name == "MIRROR" ? Extension::mirror : Extension::repeat;
}

}  // namespace

ExprId image_texture(NodeContext& node, int output) {
    enum { kVector };
    enum { kInterpolation, kExtension };
    enum { kColor, kAlpha };
    const ExprId linked = node.input(kVector);
    const ExprId at = linked != kNoExpr ? linked : uv(node, "");
    // Cycles takes the alpha out of the colour where, and only where, the alpha is used by itself.
    const uint8_t mode = image_mode(interpolation_of(node.option(kInterpolation)),
                                    extension_of(node.option(kExtension)), node.output_used(kAlpha));
    const ExprId image = node.e.make(Op::image, {at}, mode, node.image());
    return output == kColor ? image : node.e.lane(image, 3);
}

ExprId environment_texture(NodeContext& node, int) {
    enum { kVector };
    enum { kProjection, kInterpolation };
    const ExprId linked = node.input(kVector);
    const ExprId direction = linked != kNoExpr ? linked : read_point(node.e, Op::position);
    const Op projection =
        node.option(kProjection) == "MIRROR_BALL" ? Op::mirror_ball : Op::equirectangular;
    const ExprId at = node.e.make(projection, {direction});
    const uint8_t mode =
        image_mode(interpolation_of(node.option(kInterpolation)), Extension::repeat, false);
    return node.e.make(Op::image, {at}, mode, node.image());
}

ExprId normal_map(NodeContext& node, int) {
    enum { kStrength, kColor };
    enum { kSpace, kUvMap };
    if (node.c.is_world()) {
        node.warn("a background has no normal to map");
        return node.e.constant(Vec3(0.0f));
    }
    const std::string& space = node.option(kSpace);
    const ExprId strength = node.input(kStrength), color = node.input(kColor);
    if (space == "TANGENT")
        return node.e.make(Op::tangent_normal, {strength, color}, 0,
                           node.c.attribute(AttributeKind::uv, node.option(kUvMap)));
    const NormalSpace in = space == "OBJECT" ? NormalSpace::object : NormalSpace::world;
    return node.e.make(Op::space_normal, {strength, color}, static_cast<uint8_t>(in));
}

ExprId bump(NodeContext& node, int) {
    enum { kStrength, kDistance, kHeight, kNormal };
    enum { kInvert };
    if (node.c.is_world()) {
        node.warn("a background has no normal to bump");
        return node.e.constant(Vec3(0.0f));
    }
    ExprBuilder& e = node.e;
    ExprId height = node.input(kHeight);
    if (e.derivatives(height) < 2) {
        node.warn("a height that depends on another bump is not supported; the surface is flat");
        height = e.constant(0.0f);
    }
    const ExprId normal = node.normal(kNormal);
    if (e.is_constant(height) || e.is_constant(node.input(kStrength), 0.0f))
        return normal != kNoExpr ? normal : e.constant(Vec3(0.0f));
    const uint8_t inverted = node.option(kInvert) == "True" ? 1 : 0;
    return e.make(Op::bump, {node.input(kStrength), node.input(kDistance), normal}, inverted,
                  static_cast<uint32_t>(height));
}

ExprId uv_map(NodeContext& node, int) {
    enum { kLayer, kFromInstancer };
    if (node.enabled(kFromInstancer) && !node.c.is_world())
        return node.attribute(AttributeKind::object_info, "Instance UV");
    return uv(node, node.option(kLayer));
}

ExprId texture_coordinate(NodeContext& node, int output) {
    enum { kGenerated, kNormal, kUv, kObject };
    const bool world = node.c.is_world();
    if (node.enabled(0) && !world && (output == kUv || output == kGenerated))
        return node.attribute(AttributeKind::object_info,
                              output == kUv ? "Instance UV" : "Instance Generated");
    switch (output) {
        case kUv: return uv(node, "");
        case kNormal:
            if (world)
                return node.e.scale(read_point(node.e, Op::position), node.e.constant(-1.0f));
            return read_point(node.e, Op::normal_object);
        case kGenerated:
            if (!world) return node.attribute(AttributeKind::generated);
            break;
        default: break;
    }
    return read_point(node.e, world ? Op::position : Op::position_object);
}

ExprId mapping(NodeContext& node, int) {
    enum { kVector, kLocation, kRotation, kScale };
    ExprBuilder& e = node.e;
    const std::string& type = node.option(0);
    const ExprId vector = node.input(kVector), rotation = node.input(kRotation),
                 scale = node.input(kScale);
    // A VECTOR and a NORMAL are not moved; Blender hides the socket.
    const bool moves = type == "POINT" || type == "TEXTURE";
    const ExprId location = moves ? node.input(kLocation) : e.constant(Vec3(0.0f));

    const auto rotate = [&](ExprId a, Op op) { return e.make(op, {a, rotation}); };
    const auto linear = [&](ExprId a) {
        if (type == "TEXTURE") return e.divide(rotate(a, Op::rotate_back), scale);
        if (type == "NORMAL") return rotate(e.divide(a, scale), Op::rotate);
        return rotate(e.multiply(a, scale), Op::rotate);
    };
    const auto whole = [&](ExprId a) {
        return type == "TEXTURE" ? linear(e.subtract(a, location)) : e.add(linear(a), location);
    };
    ExprId mapped = kNoExpr;
    if (e.is_constant(rotation) && e.is_constant(scale) && e.is_constant(location)) {
        std::array<float, 12> rows;
        const Vec3 origin = e.vector(whole(e.constant(Vec3(0.0f))));
        for (int column = 0; column < 4; ++column) {
            Vec3 axis(0.0f);
            if (column < 3) axis[column] = 1.0f;
            const Vec3 image = column < 3 ? e.vector(linear(e.constant(axis))) : origin;
            for (int row = 0; row < 3; ++row)
                rows[4 * static_cast<size_t>(row) + static_cast<size_t>(column)] = image[row];
        }
        constexpr std::array<float, 12> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        mapped = rows == kIdentity ? vector : e.affine(vector, rows);
    } else {
        mapped = whole(vector);
    }
    return type == "NORMAL" ? e.normalize(mapped) : mapped;
}

ExprId same_as_input(NodeContext& node, int) { return node.input(0); }

}  // namespace spc::nodes
