// SPDX-License-Identifier: GPL-3.0-or-later
// Every receiver: walls whose caustics the floor shows, screens lit from behind, and what few see.
#include "agreement/parts.h"

namespace spc::test {
namespace {

// What casters throw at a wall beside the floor.
constexpr Vec3 kWall(0.0f, 1.2f, 0.0f);
const Part kBeforeWall = bulb("", {0.0f, 0.5f, 1.6f}, 0.25f);

Graph satin() {
    return combined(diffuse(0.9f),
                    single_shader("bsdf_glossy", {{1, "Color", {0.9f, 0.9f, 0.9f, 1}},
                                                  {1, "Roughness", {0.5f, 0, 0, 0}}}),
                    0.5f);
}
void add_wall(SceneMaker& maker, const Graph& graph, uint32_t visibility = kVisibleAll) {
    add(maker, flat(square(1.5f)), graph, rotation_x(0.5f * kPi, kWall), visibility,
        CausticsRole::receiver);
}
// The floor shows what comes from the wall; its own caustics are path tracing's.
Part wall(const std::string& name, const Graph& graph, uint32_t visibility = kVisibleAll) {
    return {name, [=](SceneMaker& m) {
                add_floor(m, CausticsRole::off);
                add_wall(m, graph, visibility);
            }};
}
void add_bumpy_wall(SceneMaker& m) {
    m.builder.add_image(gentle_waves());
    Mesh mesh = square(1.5f);
    mesh.normals.assign(6, Vec3(0, 0, 1));
    m.add(mesh, normal_mapped(diffuse(0.9f), Vec2(1.0f, 1.0f)), rotation_x(0.5f * kPi, kWall),
          CausticsRole::receiver);
}
void add_projector(SceneMaker& m) {  // a mirror that faces the wall
    add_caster(m, square(0.5f), mirror(), rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
}
const Part kProjector{"by a mirror", add_projector};

std::vector<Row> walls() {
    return {{.casters = kProjector, .light = kBeforeWall, .receiver = wall("wall", diffuse(0.9f))},
            {.casters = kProjector,
             .light = kBeforeWall,
             .receiver = {"bumpy wall",
                          [](SceneMaker& m) {
                              add_floor(m, CausticsRole::off);
                              add_bumpy_wall(m);
                          }}},
            {.casters = {"by glass",
                         [](SceneMaker& m) {
                             add_caster(m, slab(0.6f, 0.2f), glass(1.5f),
                                        rotation_x(0.9f, {0.0f, 0.4f, 1.2f}));
                         }},
             .light = bulb("", {0.0f, -0.4f, 2.0f}, 0.25f),
             .receiver = wall("satin wall", satin())},
            {.casters =
                 {"from behind",
                  [](SceneMaker& m) {
                      add_caster(m, square(0.6f), mirror(), rotation_x(1.3f, {0.0f, 2.4f, 0.8f}));
                  }},
             // Not seen through the screen itself.
             .light = bulb("", {0.0f, 1.6f, 1.5f}, 0.25f, kVisibleGlossy | kVisibleShadow),
             .receiver = wall("screen", combined(refraction(1.2f, 0.6f), diffuse(0.6f), 0.3f))},
            {.casters = {"by a mirror behind a sheet",
                         [](SceneMaker& m) {
                             m.add(flat(square(1.0f)),
                                   combined(transparent(0.8f), diffuse(0.5f), 0.4f),
                                   rotation_x(1.0f, {0.0f, 0.9f, 0.4f}));
                             add_projector(m);
                         }},
             .light = kBeforeWall,
             .receiver = wall("wall", diffuse(0.9f))},
            {.casters = kProjector,
             .light = kBeforeWall,
             .receiver = wall("wall that the camera does not see", diffuse(0.9f),
                              kVisibleAll & ~uint32_t{kVisibleCamera})}};
}

// Light from the wall comes to the floor by way of more casters.
std::vector<Row> walls_behind_casters() {
    const auto behind = [](const char* name, const Graph& graph, const Transform& transform) {
        return Row{.casters = {name,
                               [=](SceneMaker& m) {
                                   add_projector(m);
                                   add_caster(m, square(0.9f), graph, transform);
                               }},
                   .light = bulb("", {0.0f, 0.5f, 1.6f}, 0.35f),
                   .receiver = wall("satin wall", satin())};
    };
    return {behind("behind a sheet that refracts", refraction(1.3f),
                   rotation_x(0.5f * kPi, {0.0f, 0.9f, 0.9f})),
            behind("in a mirror", mirror(), rotation_x(-0.5f * kPi, {0.0f, -1.0f, 0.9f}))};
}

IntegratorSettings more_bounces() {
    IntegratorSettings settings = few_bounces();
    settings.limits.diffuse = 3;
    return settings;
}
// Light that comes in one way and another; few of the paths go on.
IntegratorSettings few_going_on() {
    IntegratorSettings settings = more_bounces();
    settings.light_tracing.goes_on = 0.3;
    return settings;
}

Table indirect() {
    Table table{walls()};
    for (const Row& row : walls_behind_casters()) table.rows.push_back(row);
    for (Row& row : table.rows) {
        row.reference.rounds = 80000;
        row.claims = of_light_paths();
        row.settings = more_bounces();
    }
    return table;
}

Table direct_and_indirect() {
    return {{{.casters = {"by a mirror ball", [](SceneMaker& m) { add_ball(m, mirror()); }},
              .light = bulb("", {0.8f, -0.8f, 0.7f}),
              .receiver = {"floor and satin wall",
                           [](SceneMaker& m) {
                               add_floor(m);
                               add_wall(m, satin());
                           }},
              .claims = of_light_paths(),
              .settings = few_going_on()},
             {.casters = kProjector,
              .light = kBeforeWall,
              .receiver = {"floor and bumpy wall",
                           [](SceneMaker& m) {
                               add_floor(m);
                               add_bumpy_wall(m);
                           }},
              .claims = of_light_paths(),
              .settings = few_going_on()}}};
}

// What a camera does not see shows no caustic; what nothing else sees shows its own all the same.
Table seen_by_few() {
    const auto floor_of = [](const std::string& name, uint32_t visibility) {
        return Row{.casters = {"", [](SceneMaker& m) { add_panel(m, mirror()); }},
                   .light = bulb("", {0, -0.7f, 2.2f}),
                   .receiver = {name,
                                [visibility](SceneMaker& m) {
                                    add_floor(m);
                                    add(m, square(0.5f), diffuse(0.8f), translation({0, 0, 0.1f}),
                                        visibility, CausticsRole::receiver);
                                }},
                   .claims = of_light_paths()};
    };
    return {{floor_of("floor for the camera", kVisibleCamera),
             floor_of("floor for all but the camera", kVisibleAll & ~uint32_t{kVisibleCamera})}};
}

// ---- lights that path tracing never finds

Table under_lights_without_size() {
    constexpr uint32_t kReference = 1000, kRounds = 3000;
    // One interaction alone, for that is all that walks can.
    IntegratorSettings one_interaction = few_bounces();
    one_interaction.limits = {2, 1, 1, 1, 16};
    LightDesc spot = lamp(LightType::spot, 50.0f);
    spot.spot_angle = 1.5f;
    Table table;
    for (const Part& lamp : {light("point", lamp(LightType::point, 50.0f)), light("spot", spot),
                             light("sun without size", lamp(LightType::sun, 3.0f))}) {
        table.rows.push_back({.casters = {"mirror and pane",
                                          [](SceneMaker& m) {
                                              add_panel(m, mirror());
                                              add_caster(m, square(0.6f), refraction(1.4f),
                                                         rotation_x(0.3f, {0.2f, 0.0f, 0.4f}));
                                          }},
                              .light = lamp,
                              .settings = one_interaction});
        table.rows.push_back(
            {.casters =
                 {"by a mirror",
                  [](SceneMaker& m) {
                      // Lit from above, it throws the light at the wall alone.
                      add_caster(m, square(0.5f), mirror(), rotation_x(-0.7f, {0.0f, -0.3f, 0.6f}));
                  }},
             .light = lamp,
             .receiver = wall("wall", diffuse(0.9f)),
             .settings = few_going_on()});
    }
    for (Row& row : table.rows) {
        row.reference = {kReference, kManifold};
        row.claims = {{kLightPaths, kRounds, 0.5}, {kAll, kRounds, 0.5}};
        row.blind_path_tracing = true;
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(IndirectReceivers, indirect);
SPC_AGREEMENT(AllReceivers, direct_and_indirect);
SPC_AGREEMENT(ReceiversThatFewSee, seen_by_few);
SPC_AGREEMENT(LightsWithoutSize, under_lights_without_size);

}  // namespace spc::test
