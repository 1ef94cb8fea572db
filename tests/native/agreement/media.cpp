// SPDX-License-Identifier: GPL-3.0-or-later
// Water between the floor and the light, and media that absorb.
#include "agreement/parts.h"

namespace spc::test {
namespace {

const Part kUnderWater = camera_from("", kLowEye, 0.4f);

Part water(const std::string& name, float angle) {
    return {name, [angle](SceneMaker& m) {
                add_caster(m, flat(square(4.0f)), glass(1.33f), rotation_x(angle, {0, 0, 0.8f}));
            }};
}

// Colours of media: chains of all lengths lose a good part of their light.
const Spectrum kTea(0.2f, 1.5f, 4.0f), kSmoke(0.3f, 0.5f, 0.8f);  // 1/m

// All rays see what absorbs; the camera looks by it where it is a caster.
void add_absorbing(SceneMaker& maker, const Mesh& mesh, const Graph& graph, const Vec3& at,
                   const Spectrum& sigma = kTea) {
    add(maker, mesh, absorbing(graph, sigma), translation(at), kVisibleAll, CausticsRole::automatic);
}
// The smoke does not bend light: what passes between casters has to enter and to leave it.
Part ball_in_smoke(const std::string& name, float top) {
    return {name, [top](SceneMaker& m) {
                add_ball(m, mirror());
                add_absorbing(m, block(2.5f, 3.0f), transparent(1.0f), {0, 0, top}, kSmoke);
            }};
}

Table clear() {
    const Part over_water = bulb("", {0.4f, 0.3f, 2.2f}, 0.5f);
    return {{{.casters = water("camera under water", 0.0f),
              .light = over_water,
              .camera = kUnderWater,
              .claims = of_light_paths()},
             {.casters = water("lamp under water", kPi),
              .light = over_water,
              .camera = kUnderWater,
              .claims = of_light_paths()}}};
}

Table coloured() {
    Table table{
        {{.casters = {"floor and camera under coloured water",
                      [](SceneMaker& m) {
                          add_absorbing(m, block(4.0f, 1.0f), glass(1.33f), {0, 0, 0.8f});
                      }},
          .light = bulb("", {0.4f, 0.3f, 2.2f}, 0.5f),
          .camera = kUnderWater},
         {.casters = {"coloured glass slab",
                      [](SceneMaker& m) {
                          add_absorbing(m, block(1.2f, 0.3f), glass(1.5f), {0, 0, 1.2f});
                      }},
          .light = bulb("", {0.3f, 0.2f, 2.5f}, 0.6f),
          .camera = camera_from("", kLowEye, 0.3f)},
         {.casters = {"coloured glass ball",
                      [](SceneMaker& m) {
                          add_absorbing(m, sphere(24, 0.4), glass(1.5f), {-0.1f, 0.1f, 0.8f});
                      }},
          .light = bulb("", {0.1f, -0.2f, 2.2f}, 0.4f),
          .camera = camera_from("", {0.0f, -1.0f, 0.5f}, 0.12f)},
         {.casters = ball_in_smoke("mirror ball and lamp in smoke", 1.5f),
          .light = bulb("", {0.8f, -0.8f, 0.7f})},
         {.casters = ball_in_smoke("mirror ball in smoke", 1.3f),
          .light = light("sun", wide_sun())}}};
    for (Row& row : table.rows) {
        row.reference.rounds = 32000;
        row.claims = of_light_paths();
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(Media, clear);
SPC_AGREEMENT(AbsorbingMedia, coloured);

}  // namespace spc::test
