// SPDX-License-Identifier: GPL-3.0-or-later
// What a graph reads of the mesh or the object that it is on.
#pragma once

#include <cstdint>
#include <string>

namespace spc {

enum class AttributeKind : uint8_t {
    // Of a mesh.
    named,       // found by its name alone
    uv,          // the active UV layer, or the one of that name
    color,       // the active colour, or the one of that name
    generated,   // the place in the undeformed mesh's box
    pointiness,  // how convex the mesh is
    island,      // a random number for each connected part
    // Of an object, the same all over it.
    object,         // a property of the object
    instancer,      // a property of what makes the instance
    object_info,    // an output of the Object Info node
    particle_info,  // likewise
    view_layer,     // a property of the view layer, the scene or the world
};

constexpr bool is_of_object(AttributeKind kind) { return kind >= AttributeKind::object; }

struct AttributeName {
    AttributeKind kind = AttributeKind::named;
    std::string name;

    bool operator==(const AttributeName&) const = default;

    // Whether an attribute called this is what a graph that asks for `wanted` reads.
    bool answers(const AttributeName& wanted) const {
        if (is_of_object(kind)) return *this == wanted;
        const bool by_name = wanted.kind <= AttributeKind::color && !wanted.name.empty();
        return by_name ? name == wanted.name : kind == wanted.kind && kind != AttributeKind::named;
    }
};

}  // namespace spc
