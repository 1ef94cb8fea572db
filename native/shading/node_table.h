// SPDX-License-Identifier: GPL-3.0-or-later
// Every kind of node that a graph may use: one row each, from which validation, compilation and the
// text of spc_node_kinds() follow. Not seen outside of shading/.
#pragma once

#include <span>
#include <string_view>

#include "shading/expression.h"

namespace spc {

class NodeContext;  // compiler.h

enum class SocketType : uint8_t { scalar, color, vector, shader };

// What a shader describes: Blender has one type of socket for both.
enum class ShaderPart : uint8_t { surface, volume, both };

// What an unlinked input reads. Only those with a constant of their own can be given one.
enum class Unlinked : uint8_t {
    constant,
    normal,     // the interpolated normal
    incoming,   // to where the point is seen from, in the object's space
    tangent,    // around the Z axis of the object
    uv,         // the active UV layer
    generated,  // the position within the object's bounds
    direction   // of a background; elsewhere the position
};

struct InputSocket {
    const char* name;
    std::array<float, 3> value{};
    SocketType type = SocketType::scalar;
    Unlinked unlinked = Unlinked::constant;
};
struct OutputSocket {
    const char* name;
    SocketType type;
};
struct NodeOption {
    const char* name;
    const char* values;  // "A|B|C", the first is the default; "" = any text, by default none
};

// Numbers that a node is given, such as the colours of a ramp.
struct NodeArray {
    const char* name;
    uint32_t columns;  // numbers of each row; at least two rows
    bool optional = false;
};

struct NodeKind {
    const char* name;
    const char* label;  // as Blender calls it; for messages
    std::span<const InputSocket> inputs{};
    std::span<const OutputSocket> outputs{};
    std::span<const NodeOption> options{};
    std::span<const NodeArray> arrays{};
    bool reads_image = false;
    // One of them: the value of an output, or what a shader adds to its part under a weight (a
    // scalar).
    ExprId (*value)(NodeContext&, int output) = nullptr;
    void (*shade)(NodeContext&, ExprId weight) = nullptr;
    ShaderPart part = ShaderPart::surface;
};

std::span<const NodeKind> node_table();
// Which of "A|B|C" a value is; -1 if none.
int choice_of(std::string_view choices, std::string_view value);
const char* type_name(SocketType type);  // "float", "color", "vector", "shader"

}  // namespace spc
