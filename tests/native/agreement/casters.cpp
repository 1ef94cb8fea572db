// SPDX-License-Identifier: GPL-3.0-or-later
// Every caster, under a bulb.
#include "agreement/parts.h"

namespace spc::test {
namespace {

const Vec3 kBesideBall(0.8f, -0.8f, 0.7f), kBeforePanel(0.0f, -0.7f, 2.2f);

Part ball_of(const std::string& name, const Graph& graph) {
    return {name, [graph](SceneMaker& m) { add_ball(m, graph); }};
}
Part panel_of(const std::string& name, const Image& image, const Graph& graph) {
    return {name, [=](SceneMaker& m) {
                m.builder.add_image(image);
                add_caster(m, panel_with_uvs(1.4), graph, rotation_x(1.3f, Vec3(0.0f, 0.9f, 0.6f)));
            }};
}

// Whose film makes light interfere.
Graph filmed(const std::string& shader, float nanometres) {
    return single_shader(shader, {{1, "Roughness", {0, 0, 0, 0}},
                                  {1, "Thin Film Thickness", {nanometres, 0, 0, 0}},
                                  {1, "Thin Film IOR", {1.33f, 0, 0, 0}}});
}

std::vector<Row> rows() {
    const Graph sheet = combined(transparent(0.8f), diffuse(0.5f), 0.4f);
    return {
        {.casters = ball_of("mirror ball", mirror()), .light = bulb("", kBesideBall)},
        {.casters = {"mirror", [](SceneMaker& m) { add_panel(m, mirror()); }},
         .light = bulb("", kBeforePanel, 0.3f, kVisibleAll)},
        {.casters = {"metal with a film",
                     [](SceneMaker& m) { add_panel(m, filmed("bsdf_metallic", 350.0f)); }},
         .light = bulb("", kBeforePanel)},
        {.casters = {"glass slab with a film",
                     [](SceneMaker& m) {
                         add_caster(m, slab(2.0f, 0.3f), filmed("bsdf_glass", 250.0f),
                                    translation({0, 0, 1.2f}));
                     }},
         .light = bulb("", {0.7f, 0.2f, 2.5f}, 0.6f),
         .camera = camera_from("", kLowEye, 0.4f)},
        {.casters = panel_of("normal-mapped mirror", gentle_waves(),
                             normal_mapped(mirror(), Vec2(1.0f, 1.0f))),
         .light = bulb("", kBeforePanel)},
        {.casters = panel_of("bumped mirror", gentle_hills(), bumped(mirror(), 0.1f)),
         .light = bulb("", kBeforePanel)},
        {.casters = {"glass slab",
                     [](SceneMaker& m) {
                         add_caster(m, slab(2.0f, 0.3f), glass(1.5f), translation({0, 0, 1.2f}));
                     }},
         .light = bulb("", {0.7f, 0.2f, 2.5f}, 0.6f),
         .camera = camera_from("", kLowEye, 0.4f)},
        {.casters = ball_of("glass ball", glass(1.5f)),
         .light = bulb("", kBesideBall, 0.6f)},  // few walks are unlucky
        {.casters = {"mirror ball behind sheets",
                     [sheet](SceneMaker& m) {
                         add_ball(m, mirror());
                         m.add(flat(square(1.5f)), sheet, translation({0, 0, 0.15f}));
                         m.add(flat(square(0.6f)), sheet, rotation_x(0.9f, {0.0f, -1.2f, 0.9f}));
                     }},
         .light = bulb("", kBesideBall)},
        // What is seen through it belongs to path tracing alone.
        {.casters = {"mirror ball behind a transparent mirror",
                     [](SceneMaker& m) {
                         add_caster(m, square(0.5f), combined(transparent(1.0f), mirror(), 0.3f),
                                    translation({0, 0, 0.3f}));
                         add_ball(m, mirror());
                     }},
         .light = bulb("", kBesideBall)},
        {.casters =
             {"mirror and glass",
              [](SceneMaker& m) {
                  add_panel(m, mirror());
                  add_caster(m, slab(0.7f, 0.2f), glass(1.5f), rotation_x(0.2f, {0, 0.1f, 0.9f}));
              }},
         .light = bulb("", kBeforePanel)}};
}

Table table() {
    constexpr uint32_t kMissedRounds = 2000;
    std::vector<Claim> claims = of_light_paths();
    const Claim alone = claims[0], beside = claims[1];
    claims.push_back({kMnee, alone.rounds});
    claims.push_back({kMneeAndLight, beside.rounds});
    // Whatever the weights of chains that sheets miss, all of them are found.
    claims.push_back({kMissed, kMissedRounds});
    Table table{rows()};
    for (Row& row : table.rows) {
        row.reference.rounds = 16000;
        row.claims = claims;
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(Casters, table);

}  // namespace spc::test
