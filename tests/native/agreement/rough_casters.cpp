// SPDX-License-Identifier: GPL-3.0-or-later
// What rough mirrors and glass throw on: light paths find it.
#include "agreement/parts.h"
#include "support/rough.h"

namespace spc::test {
namespace {

const Vec3 kBeforePanel(0, -0.7f, 2.2f);

Part panel(const std::string& name, const Graph& graph) {
    return {name, [graph](SceneMaker& m) { add_panel(m, graph); }};
}

std::vector<Row> every_light() {
    LightDesc bulb = lamp(LightType::point, 100.0f);
    bulb.radius = 0.3f;
    std::vector<Row> rows;
    for (const Part& light : {light("point", lamp(LightType::point, 100.0f)), light("bulb", bulb),
                              light("sun without size", lamp(LightType::sun, 3.0f)),
                              light("sun", wide_sun()), light("rectangle", rectangle_lamp()),
                              Part{"emissive mesh", [](SceneMaker& m) {
                                       add_glowing(m, flat(square(0.3f)), {0.4f, -0.2f, 1.9f});
                                   }}})
        rows.push_back({.casters = panel("", metal(0.2f)), .light = light});
    return rows;
}

std::vector<Row> every_caster() {
    return {
        {.casters = panel("smoother metal", metal(0.1f)), .light = bulb("", kBeforePanel)},
        {.casters = {"ball of metal", [](SceneMaker& m) { add_ball(m, metal(0.2f)); }},
         .light = bulb("", {0.8f, -0.8f, 0.7f})},
        {.casters =
             {"two of metal",
              [](SceneMaker& m) {
                  add_panel(m, metal(0.15f));
                  add_caster(m, square(0.5f), metal(0.3f), rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
              }},
         .light = bulb("", {0, -0.2f, 1.8f}, 0.2f)},
        {.casters = panel("metal that is diffuse, too", combined(metal(0.15f), diffuse(0.8f), 0.5f)),
         .light = bulb("", kBeforePanel, 0.2f, kVisibleAll)},
        {.casters = {"frosted slab",
                     [](SceneMaker& m) {
                         add_caster(m, slab(0.6f, 0.2f), frosted_glass(0.2f),
                                    rotation_x(0.4f, {0, 0.1f, 0.8f}));
                     }},
         .light = bulb("", {0.3f, 0.2f, 2.2f}, 0.2f)},
        {.casters = {"beside a mirror",
                     [](SceneMaker& m) {
                         add_panel(m, metal(0.15f));
                         add_ball(m, mirror());
                     }},
         .light = bulb("", {0.4f, -0.7f, 2.2f})}};
}

Table table() {
    constexpr uint32_t kRounds = 2000;
    Table table{every_light()};
    for (const Row& row : every_caster()) table.rows.push_back(row);
    for (Row& row : table.rows) {
        row.reference.rounds = 24 * kRounds;
        row.claims = {{kSheets, kRounds, power(0.6, 0.5)}};
        row.settings.limits.diffuse = 3;  // floor, two interactions with glass, and the light
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(RoughCasters, table);

}  // namespace spc::test
