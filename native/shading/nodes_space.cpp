// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that read the camera, the object's space and the shape of triangles. Semantics are Cycles';
// docs/nodes.md lists what differs.
#include "shading/node_table.h"
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

ExprId read_point(NodeContext& node, Op op) { return node.e.make(op, {}); }

ExprId to_world(NodeContext& node, ExprId object_normal) {
    return node.e.make(
        Op::transform, {object_normal},
        transform_mode(VectorSpace::object, VectorSpace::world, VectorMeaning::normal));
}

// The part of a tangent that lies in the surface.
ExprId along_surface(NodeContext& node, ExprId tangent) {
    const ExprId normal = read_point(node, Op::normal);
    const ExprId across = node.e.normalize(node.e.make(Op::cross, {tangent, normal}));
    return node.e.make(Op::cross, {normal, across});
}

VectorSpace space_of(const std::string& name) {
    return name == "OBJECT"   ? VectorSpace::object
           : name == "CAMERA" ? VectorSpace::camera
                              : VectorSpace::world;
}

}  // namespace

// Around an axis through the middle of the undeformed mesh.
ExprId radial_tangent(NodeContext& node, int axis) {
    ExprBuilder& e = node.e;
    const ExprId generated = node.attribute(AttributeKind::generated);
    const auto from_middle = [&](uint8_t lane) {
        return e.subtract(e.lane(generated, lane), e.constant(0.5f));
    };
    const auto opposite = [&](uint8_t lane) {
        return e.subtract(e.constant(0.5f), e.lane(generated, lane));
    };
    const ExprId zero = e.constant(0.0f);
    const ExprId around = axis == 0   ? e.combine(zero, opposite(2), from_middle(1))
                          : axis == 1 ? e.combine(opposite(2), zero, from_middle(0))
                                      : e.combine(opposite(1), from_middle(0), zero);
    return along_surface(node, to_world(node, around));
}

ExprId tangent(NodeContext& node, int) {
    enum { kDirection, kAxis, kUvMap };
    if (node.c.is_world()) {
        node.warn("a background has no tangent");
        return node.e.constant(Vec3(0.0f));
    }
    if (node.option(kDirection) == "RADIAL")
        return radial_tangent(node, node.option(kAxis)[0] - 'X');
    return along_surface(node,
                         node.e.make(Op::mesh_tangent, {}, 0,
                                     node.c.attribute(AttributeKind::uv, node.option(kUvMap))));
}

ExprId camera_data(NodeContext& node, int output) {
    enum { kVector, kDepth, kDistance };
    const ExprId at = read_point(node, Op::view_position);
    if (output == kDepth) return node.e.lane(at, 2);
    return output == kVector ? node.e.normalize(at) : node.e.make(Op::length, {at});
}

ExprId vector_transform(NodeContext& node, int) {
    enum { kMeaning, kFrom, kTo };
    const std::string& name = node.option(kMeaning);
    const VectorMeaning meaning = name == "POINT"    ? VectorMeaning::point
                                  : name == "NORMAL" ? VectorMeaning::normal
                                                     : VectorMeaning::vector;
    return node.e.make(
        Op::transform, {node.input(0)},
        transform_mode(space_of(node.option(kFrom)), space_of(node.option(kTo)), meaning));
}

ExprId wireframe(NodeContext& node, int) {
    if (node.c.is_world()) return node.e.constant(0.0f);
    return node.e.make(Op::wireframe, {node.input(0)}, node.enabled(0) ? 1 : 0);
}

}  // namespace spc::nodes
