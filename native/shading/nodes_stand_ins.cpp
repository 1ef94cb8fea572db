// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes that something simpler stands in for: each says so. docs/nodes.md lists them.
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

void add_diffuse(NodeContext& node, ExprId weight, ExprId normal, ExprId color) {
    ClosureTerm term;
    term.op = ClosureOp::lambert;
    term.node = node.index;
    term.label = node.label();
    term.in = {weight, normal, color};
    node.c.add_term(std::move(term));
}

}  // namespace

void subsurface(NodeContext& node, ExprId weight) {
    enum { kColor, kScale, kRadius, kIor, kRoughness, kAnisotropy, kNormal };
    node.warn("subsurface scattering is not supported, light leaves where it enters");
    add_diffuse(node, weight, node.normal(kNormal), node.input(kColor));
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
