// SPDX-License-Identifier: GPL-3.0-or-later
// A panel that emits what an image has.
#pragma once

#include "agreement/parts.h"

namespace spc::test {

// The image's corners, bottom row first: one is bright, one dim, two have colours of their own.
inline constexpr float kCornersOfLight[4][3] = {
    {60.0f, 40.0f, 20.0f}, {10.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 10.0f}, {0.5f, 0.5f, 0.5f}};
inline constexpr float kPanelOfLight = 0.6f;  // half its side, m

// Hangs from `transform` with its front below. Turned, it has its UVs along its edges; else these
// go round by a quarter.
inline void add_panel_of_light(SceneMaker& maker, const Transform& transform, bool turned = false) {
    constexpr uint32_t kTexels = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kTexels; ++y)
        for (uint32_t x = 0; x < kTexels; ++x)
            for (const float value : kCornersOfLight[2 * (2 * y / kTexels) + 2 * x / kTexels])
                texels.push_back(value);
    const uint32_t image = maker.builder.add_image(image_from_floats(
        "light", texels, kTexels, kTexels, 3, ColorSpace::linear, AlphaMode::none));
    Graph graph = emission(1.0f);
    graph.name = "image of light";
    graph.nodes.push_back({"Image", "image_texture", image});
    graph.options.push_back({2, "interpolation", "Closest"});
    graph.links.push_back({2, "Color", 1, "Color"});
    Mesh mesh = flat(square(kPanelOfLight));
    std::vector<float>& uv = mesh.attributes[0].values;
    for (size_t i = 0; i < uv.size() && !turned; i += 2)
        uv[i] = 1.0f - std::exchange(uv[i + 1], uv[i]);
    add(maker, mesh, graph, transform, kVisibleAll & ~uint32_t{kVisibleCamera}, CausticsRole::off);
}
inline Part image_of_light(bool turned) {
    return {"image of light", [turned](SceneMaker& m) {
                add_panel_of_light(m, rotation_x(kPi + 0.2f, {0.3f, -0.2f, 1.7f}), turned);
            }};
}
inline std::vector<Part> casters_under_an_image_of_light() {
    return {{"mirror", [](SceneMaker& m) { add_panel(m, mirror()); }},
            {"glass", [](SceneMaker& m) {
                 add_caster(m, slab(0.5f, 0.2f), glass(1.5f), translation({0.1f, 0, 0.7f}));
             }}};
}

}  // namespace spc::test
