// SPDX-License-Identifier: GPL-3.0-or-later
// A material as the host describes it: typed nodes, constants, options, arrays and links, by name.
// compile() in program.h validates it.
#pragma once

#include "bsdf/terminator.h"
#include "math/vec.h"

#include <string>
#include <vector>

namespace spc {

inline constexpr uint32_t kNone = 0xffffffffu;

struct GraphNode {
    std::string name;
    std::string kind;
    uint32_t image = kNone;
};
struct GraphInput {
    uint32_t node;
    std::string socket;
    std::array<float, 4> value;
};
struct GraphOption {
    uint32_t node;
    std::string option;
    std::string value;
};
struct GraphArray {
    uint32_t node;
    std::string name;
    std::vector<float> values;
};
struct GraphLink {
    uint32_t from_node;
    std::string from_socket;
    uint32_t to_node;
    std::string to_socket;
};
// Whether narrow lobes on a normal or bump map are looked at through the pixel's footprint.
enum class GlintsMode : uint8_t { automatic, on, off };

// What the output's Displacement does: turns normals, moves vertices, or both.
enum class DisplacementMode : uint8_t { bump, vertices, both };

struct Graph {
    std::string name;
    DisplacementMode displacement = DisplacementMode::bump;
    uint32_t pass_index = 0;  // what its pass shows
    float crypto = 0.0f;      // identifier, 0: none
    GlintsMode glints = GlintsMode::automatic;
    BumpCorrection bump_correction = BumpCorrection::none;
    std::vector<GraphNode> nodes;
    std::vector<GraphInput> inputs;
    std::vector<GraphOption> options;
    std::vector<GraphArray> arrays;
    std::vector<GraphLink> links;
};

// The text behind spc_node_kinds(): one line per kind from the table that compile() uses.
const char* node_kinds_text();

}  // namespace spc
