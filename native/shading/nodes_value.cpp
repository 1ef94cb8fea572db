// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that give values. Semantics are Cycles'; docs/nodes.md lists what differs.
#include "core/error.h"
#include "shading/nodes.h"

#include <fmt/format.h>

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

// Where a direction from the middle of the unit cube meets a sphere's or a tube's picture.
ExprId projected(ExprBuilder& e, ExprId at, const std::string& projection) {
    if (projection == "FLAT") return at;
    const auto scaled = [&](ExprId a, float by) { return e.multiply(a, e.constant(by)); };
    const ExprId from_middle = e.subtract(e.scale(at, e.constant(2.0f)), e.constant(Vec3(1.0f)));
    const ExprId around = e.make(Op::arctan2, {e.lane(from_middle, 0), e.lane(from_middle, 1)});
    const ExprId u = e.subtract(e.constant(0.5f), scaled(around, 0.5f * kInvPi));
    const ExprId height = e.lane(from_middle, 2);
    const ExprId v =
        projection == "TUBE"
            ? scaled(e.add(height, e.constant(1.0f)), 0.5f)
            : e.one_minus(scaled(
                  e.make(Op::arccosine, {e.divide(height, e.make(Op::length, {from_middle}))}),
                  kInvPi));
    return e.combine(u, v, e.constant(0.0f));
}

// The picture on one side of a box, turned so that none is mirrored.
ExprId on_side(ExprBuilder& e, ExprId at, ExprId normal, uint8_t side) {
    constexpr std::array<uint8_t, 3> kAcross{1, 0, 1}, kUp{2, 2, 0};
    const ExprId across = e.lane(at, kAcross[side]), zero = e.constant(0.0f);
    const ExprId mirrored = e.make(side == 0 ? Op::less : Op::greater, {e.lane(normal, side), zero});
    return e.combine(e.make(Op::mix, {across, e.one_minus(across), mirrored}),
                     e.lane(at, kUp[side]), zero);
}

// The block of Op::tiled_image.
uint32_t tiles(NodeContext& node) {
    std::vector<float> block{0.0f};
    const std::vector<float>& rows = node.array(0);
    for (size_t i = 0; i < rows.size(); i += 2) {
        const float image = rows[i + 1];
        if (!(image >= 0.0f && image < static_cast<float>(node.c.images().size())) ||
            image != std::floor(image))
            throw Error(
                ErrorKind::invalid_argument,
                where(node.c.material_name(), *node.c.node(node.index).graph) +
                    fmt::format(": a tile names image {} of {}", image, node.c.images().size()));
        const bool is_known = std::any_of(
            block.begin() + 1, block.end(),
            [&, k = size_t{0}](float tile) mutable { return k++ % 2 == 0 && tile == rows[i]; });
        if (!is_known) block.insert(block.end(), {rows[i], image});
    }
    block[0] = static_cast<float>(block.size() / 2);
    return node.e.block(block);
}

}  // namespace

ExprId image_texture(NodeContext& node, int output) {
    enum { kVector, kBlend };
    enum { kInterpolation, kExtension, kProjection };
    enum { kColor, kAlpha };
    ExprBuilder& e = node.e;
    const ExprId linked = node.input(kVector);
    const ExprId at = linked != kNoExpr ? linked : uv(node, "");
    const std::string& projection = node.option(kProjection);
    // Cycles takes the alpha out of the colour where, and only where, the alpha is used by itself.
    const uint8_t mode = image_mode(interpolation_of(node.option(kInterpolation)),
                                    extension_of(node.option(kExtension)), node.output_used(kAlpha));
    const auto texel = [&](ExprId place) {
        if (node.has_array(0)) return e.make(Op::tiled_image, {place}, mode, tiles(node));
        return e.make(Op::image, {place}, mode, node.image());
    };
    if (projection != "BOX") {
        const ExprId image = texel(projected(e, at, projection));
        return output == kColor ? image : e.lane(image, 3);
    }
    const ExprId normal = node.c.is_world() ? e.scale(read_point(e, Op::position), e.constant(-1.0f))
                                            : e.make(Op::normal_object, {node.c.surface_normal()});
    const ExprId weights = e.make(Op::box_weights, {normal, node.input(kBlend)});
    ExprId sum = kNoExpr;
    for (uint8_t side = 0; side < 3; ++side) {
        const ExprId weight = e.lane(weights, side), image = texel(on_side(e, at, normal, side));
        const ExprId part =
            output == kColor ? e.scale(image, weight) : e.multiply(e.lane(image, 3), weight);
        sum = sum == kNoExpr ? part : e.add(sum, part);
    }
    return sum;
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
    const ExprId strength = node.input(kStrength);
    ExprId color = node.input(kColor);
    if (space.starts_with("BLENDER")) {  // whose y and z look the other way
        const auto opposite = [&](uint8_t lane) {
            return node.e.one_minus(node.e.lane(color, lane));
        };
        color = node.e.combine(node.e.lane(color, 0), opposite(1), opposite(2));
    }
    if (space == "TANGENT")
        return node.e.make(Op::tangent_normal, {strength, color}, 0,
                           node.c.attribute(AttributeKind::uv, node.option(kUvMap)));
    const NormalSpace in = space.ends_with("OBJECT") ? NormalSpace::object : NormalSpace::world;
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
    enum { kGenerated, kNormal, kUv, kObject, kCamera, kWindow, kReflection };
    const bool world = node.c.is_world();
    if (node.enabled(0) && !world && (output == kUv || output == kGenerated))
        return node.attribute(AttributeKind::object_info,
                              output == kUv ? "Instance UV" : "Instance Generated");
    switch (output) {
        case kUv: return uv(node, "");
        case kNormal:
            if (world)
                return node.e.scale(read_point(node.e, Op::position), node.e.constant(-1.0f));
            return node.e.make(Op::normal_object, {node.c.surface_normal()});
        case kGenerated:
            if (!world) return node.attribute(AttributeKind::generated);
            break;
        case kObject:
            if (!node.has_array(0)) break;
            return node.e.make(Op::affine, {read_point(node.e, Op::position)}, 0,
                               node.e.block(node.array(0)));
        case kCamera: return read_point(node.e, Op::view_position);
        case kWindow: return read_point(node.e, Op::window);
        case kReflection: {
            const ExprId opposite = node.e.constant(-1.0f);
            if (world) return node.e.scale(read_point(node.e, Op::position), opposite);
            return node.e.scale(node.e.make(Op::reflect, {read_point(node.e, Op::incoming),
                                                          read_point(node.e, Op::normal)}),
                                opposite);
        }
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
