// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.h"

#include <numbers>

namespace spc::fuzz {
namespace {

void add_vertex(Shape& shape, float x, float y, float z) {
    shape.positions.insert(shape.positions.end(), {x, y, z});
}

// A grid of quads, flat or closed to a ball.
void add_grid(Dice& dice, Shape& shape) {
    const uint32_t across = dice.from(1, 8), up = dice.from(1, 6);
    const bool ball = dice.chance(0.5);
    for (uint32_t j = 0; j <= up; ++j)
        for (uint32_t i = 0; i <= across; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(across),
                        v = static_cast<float>(j) / static_cast<float>(up);
            const float a = 2.0f * std::numbers::pi_v<float> * u, b = std::numbers::pi_v<float> * v;
            if (ball)
                add_vertex(shape, std::cos(a) * std::sin(b), std::sin(a) * std::sin(b),
                           -std::cos(b));
            else
                add_vertex(shape, 4.0f * u - 2.0f, 4.0f * v - 2.0f, 0.0f);
        }
    for (uint32_t j = 0; j < up; ++j)
        for (uint32_t i = 0; i < across; ++i) {
            const uint32_t a = j * (across + 1) + i, b = a + across + 1;
            shape.triangles.insert(shape.triangles.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
}

void add_soup(Dice& dice, Shape& shape) {
    const uint32_t vertices = dice.from(1, 12), triangles = dice.from(1, 20);
    for (uint32_t i = 0; i < vertices; ++i)
        add_vertex(shape, dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
    for (uint32_t i = 0; i < 3 * triangles; ++i) shape.triangles.push_back(dice.below(vertices));
}

std::vector<float> random_numbers(Dice& dice, size_t count, float least, float most) {
    std::vector<float> values(count);
    for (float& value : values) value = dice.between(least, most);
    return values;
}

}  // namespace

Shape random_shape(Dice& dice, Spoiler& spoiler) {
    Shape shape;
    if (dice.chance(0.8))
        add_grid(dice, shape);
    else
        add_soup(dice, shape);
    spoiler.numbers(shape.positions);
    for (uint32_t& index : shape.triangles)
        if (spoiler.strikes() && dice.chance(0.05)) index = spoiler.count(index);
    const size_t corners = shape.triangles.size();
    spc_mesh_desc& desc = shape.desc;
    desc.struct_size = spoiler.struct_size(sizeof(desc));
    desc.name = "Pebble";
    desc.positions = spoiler.pointer(shape.positions.data());
    desc.vertex_count = static_cast<uint32_t>(shape.positions.size() / 3);
    desc.triangles = spoiler.pointer(shape.triangles.data());
    desc.triangle_count = static_cast<uint32_t>(corners / 3);
    desc.slot_count = dice.chance(0.2) ? 2 : 1;
    if (dice.chance(0.4)) {
        shape.normals = random_numbers(dice, 3 * corners, -1.0f, 1.0f);
        spoiler.numbers(shape.normals);
        desc.normals = shape.normals.data();
    }
    if (dice.chance(0.4)) {
        shape.slots.assign(corners / 3, 0);
        for (uint32_t& slot : shape.slots) slot = dice.below(desc.slot_count);
        desc.material_slots = shape.slots.data();
    }
    if (dice.chance(0.7)) {
        shape.uv = random_numbers(dice, 2 * corners, 0.0f, 1.0f);
        spoiler.numbers(shape.uv);
        shape.tangents = random_numbers(dice, 4 * corners, -1.0f, 1.0f);
        spoiler.numbers(shape.tangents);
        shape.attributes = {
            {"UVMap", SPC_ATTRIBUTE_UV, SPC_DOMAIN_CORNER, 2, shape.uv.data(), nullptr},
            {"Other", SPC_ATTRIBUTE_NAMED, SPC_DOMAIN_CORNER, 2, shape.uv.data(),
             shape.tangents.data()},
            // Fewer numbers than there are.
            {"Shade", SPC_ATTRIBUTE_COLOR, SPC_DOMAIN_TRIANGLE, dice.from(1, 4), shape.uv.data(),
             nullptr}};
        for (spc_attribute& attribute : shape.attributes) {
            attribute.kind = spoiler.count(attribute.kind);
            attribute.values = spoiler.pointer(attribute.values);
        }
        desc.attributes = shape.attributes.data();
        desc.attribute_count = dice.from(1, 3);
    }
    return shape;
}

void random_transform(Dice& dice, Spoiler& spoiler, float (&rows)[12]) {
    const float a = dice.between(-3.2f, 3.2f), b = dice.between(-3.2f, 3.2f);
    const float scale = spoiler.number(dice.between(0.3f, 1.5f));
    const bool turned = dice.chance(0.6);
    const float ca = turned ? std::cos(a) : 1.0f, sa = turned ? std::sin(a) : 0.0f,
                cb = turned ? std::cos(b) : 1.0f, sb = turned ? std::sin(b) : 0.0f;
    const float linear[9] = {ca, -sa * cb, sa * sb, sa, ca * cb, -ca * sb, 0.0f, sb, cb};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) rows[4 * i + j] = linear[3 * i + j] * scale;
        rows[4 * i + 3] = dice.between(-1.0f, 1.0f);
    }
    spoiler.numbers(rows, 12);
}

}  // namespace spc::fuzz
