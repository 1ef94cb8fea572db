// SPDX-License-Identifier: GPL-3.0-or-later
// What the rows of the node table are written with, and the parts of the table, a file for each.
#pragma once

#include "shading/node_table.h"
#include "shading/nodes.h"

namespace spc::rows {

using enum SocketType;

constexpr InputSocket color_input(float r, float g, float b, const char* name = "Color") {
    return {name, {r, g, b}, color};
}
constexpr InputSocket grey_input(float grey, const char* name = "Color") {
    return color_input(grey, grey, grey, name);
}
constexpr InputSocket scalar_input(const char* name, float value) {
    return {name, {value, 0, 0}, scalar};
}
constexpr InputSocket vector_input(const char* name, float value) {
    return {name, {value, value, value}, vector};
}
constexpr InputSocket shader_input(const char* name) { return {name, {}, shader}; }
inline constexpr InputSocket kNormalInput{"Normal", {}, vector, Unlinked::normal};

inline constexpr OutputSocket kColorAlphaOut[] = {{"Color", color}, {"Alpha", scalar}};
inline constexpr OutputSocket kColorOut[] = {{"Color", color}};
inline constexpr OutputSocket kVectorOut[] = {{"Vector", vector}};
inline constexpr OutputSocket kFacOut[] = {{"Fac", scalar}};
inline constexpr OutputSocket kValueOut[] = {{"Value", scalar}};

std::span<const NodeKind> surface();
std::span<const NodeKind> volume();
std::span<const NodeKind> value();
std::span<const NodeKind> input();
std::span<const NodeKind> converter();
std::span<const NodeKind> texture();

}  // namespace spc::rows
