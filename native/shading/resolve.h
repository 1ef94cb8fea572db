// SPDX-License-Identifier: GPL-3.0-or-later
// A graph by names turned into one by indices, checked on the way. Not seen outside of shading/.
#pragma once

#include "shading/graph.h"
#include "shading/node_table.h"

namespace spc {

struct ResolvedInput {
    uint32_t from_node = kNone;  // kNone: unlinked
    int from_output = 0;
    bool given = false;  // `value` replaces the default
    std::array<float, 3> value{};
};

struct ResolvedNode {
    const GraphNode* graph = nullptr;
    const NodeKind* kind = nullptr;
    std::vector<ResolvedInput> inputs;  // as kind->inputs
    std::vector<std::string> options;   // as kind->options; the default where none is given
    std::vector<const std::vector<float>*> arrays;  // as kind->arrays; of the graph
    bool live = false;                              // the output or an AOV depends on it
    std::vector<bool> used_outputs;                 // by live nodes
};

struct ResolvedGraph {
    std::string name;
    std::vector<ResolvedNode> nodes;
    uint32_t output = kNone;
    std::vector<uint32_t> aovs;   // nodes that write AOVs
    std::vector<uint32_t> order;  // live nodes, each before those that it reads; the output first
};

// Throws Error (invalid_argument) naming material, node and socket or option.
ResolvedGraph resolve(const Graph& graph, size_t image_count);

// `material "M", node "N"` or, with a socket, `material "M", node "N", socket "S"`.
std::string where(const std::string& material, const GraphNode& node, std::string_view socket = {});

}  // namespace spc
