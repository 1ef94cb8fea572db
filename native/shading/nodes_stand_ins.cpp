// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes that something simpler stands in for: each says so. docs/nodes.md lists them.
#include "shading/nodes.h"

namespace spc::nodes {

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
