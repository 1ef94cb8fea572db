// SPDX-License-Identifier: GPL-3.0-or-later
// Light that rough mirrors and glass throw on.
#include "agreement/parts.h"
#include "support/rough.h"

namespace spc::test {
namespace {

Part panel_of(const std::string& name, float roughness) {
    return {name, [roughness](SceneMaker& m) { add_panel(m, metal(roughness)); }};
}

std::vector<Row> under_each_light() {
    LightDesc area = rectangle_lamp(), ball = lamp(LightType::point, 100.0f);
    ball.radius = 0.3f;
    std::vector<Row> rows;
    for (const Part& part :
         {light("point", lamp(LightType::point, 100.0f)), light("bulb", ball),
          light("sun without size", lamp(LightType::sun, 3.0f)), light("sun", wide_sun()),
          light("area", area), Part{"emissive mesh", [](SceneMaker& m) {
                                        add_glowing(m, flat(square(0.3f)), {0.4f, -0.2f, 1.9f});
                                    }}})
        rows.push_back({.casters = panel_of("metal", 0.2f), .light = part});
    return rows;
}

std::vector<Row> of_each_kind() {
    const Graph half = combined(metal(0.15f), diffuse(0.8f), 0.5f);
    return {
        {.casters = panel_of("smoother metal", 0.1f), .light = bulb("", {0, -0.7f, 2.2f})},
        {.casters = {"ball of metal", [](SceneMaker& m) { add_ball(m, metal(0.2f)); }}},
        {.casters =
             {"two of metal",
              [](SceneMaker& m) {
                  add_panel(m, metal(0.15f));
                  add_caster(m, square(0.5f), metal(0.3f), rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
              }},
         .light = bulb("", {0, -0.2f, 1.8f}, 0.2f)},
        {.casters = {"metal that is diffuse, too", [half](SceneMaker& m) { add_panel(m, half); }},
         .light = bulb("", {0, -0.7f, 2.2f}, 0.2f, kVisibleAll)},
        {.casters = {"frosted slab",
                     [](SceneMaker& m) {
                         add_caster(m, slab(0.6f, 0.2f), frosted_glass(0.2f),
                                    rotation_x(0.4f, {0, 0.1f, 0.8f}));
                     }},
         .light = bulb("", {0.3f, 0.2f, 2.2f}, 0.2f)},
        {.casters = {"metal beside a mirror",
                     [](SceneMaker& m) {
                         add_panel(m, metal(0.15f));
                         add_ball(m, mirror());
                     }},
         .light = bulb("", {0.4f, -0.7f, 2.2f})}};
}

Table table() {
    constexpr uint32_t kRounds = 2000, kReference = 24 * kRounds;
    Table table{under_each_light()};
    for (const Row& row : of_each_kind()) table.rows.push_back(row);
    for (Row& row : table.rows) {
        row.settings.limits.diffuse = 3;  // floor, two interactions with glass, and the light
        row.reference.rounds = kReference;
        row.claims = {{kSheets, kRounds, power(0.6, 0.5)}};
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(RoughCasters, table);

}  // namespace spc::test
