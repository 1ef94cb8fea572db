// SPDX-License-Identifier: GPL-3.0-or-later
// Every light, over a ball that reflects and a pane that refracts.
#include "agreement/image_of_light.h"

namespace spc::test {
namespace {

Part panorama() {
    return {"panorama", [](SceneMaker& m) {
                constexpr uint32_t kWidth = 32, kHeight = 16;
                std::vector<float> texels;
                for (uint32_t y = 0; y < kHeight; ++y)
                    for (uint32_t x = 0; x < kWidth; ++x) {
                        const bool bright = y >= 11 && y < 14 && x >= 6 && x < 11;
                        for (int c = 0; c < 3; ++c) texels.push_back(bright ? 20.0f : 0.2f);
                    }
                set_world(m, texels, kWidth, kHeight, kNotDirectly);
            }};
}

// Brighter to one side, and by the distance that its light goes to where it first turns.
Part with_nodes(const std::string& name, const LightDesc& lamp) {
    return {name, [lamp](SceneMaker& m) {
                Graph graph = emission(1.0f);
                graph.nodes.push_back({"Coordinates", "texture_coordinate", kNone});
                graph.nodes.push_back({"Mapping", "mapping", kNone});
                graph.nodes.push_back({"Falloff", "light_falloff", kNone});
                graph.inputs.push_back({3, "Scale", {0.9f, 0.5f, -0.5f, 0}});
                graph.inputs.push_back({3, "Location", {1.0f, 0.6f, 0.5f, 0}});
                graph.inputs.push_back({4, "Strength", {0.7f, 0, 0, 0}});
                graph.links.push_back({2, "Normal", 3, "Vector"});
                graph.links.push_back({3, "Vector", 1, "Color"});
                graph.links.push_back({4, "Linear", 1, "Strength"});
                LightDesc shaded = lamp;
                shaded.material = m.builder.add_material(graph);
                m.builder.add_light(shaded);
            }};
}

std::vector<Part> lights() {
    LightDesc spot = lamp(LightType::spot, 100.0f);
    spot.radius = 0.3f;
    spot.spot_angle = 1.5f;
    spot.spot_blend = 0.4f;
    const LightDesc rectangle = rectangle_lamp();
    LightDesc sheared = rectangle;  // its -Z axis is no longer its normal
    sheared.shape = AreaShape::ellipse;
    for (Vec3& row : sheared.to_world.row) row.z += 0.6f * row.x;
    LightDesc wide_beam = rectangle, narrow_beam = rectangle;
    wide_beam.spread = 1.2f;
    narrow_beam.size = Vec2(1.5f, 1.5f);
    narrow_beam.spread = 0.5f;
    LightDesc disk = lamp(LightType::point, 100.0f);
    disk.radius = 0.7f;
    disk.soft_falloff = true;
    const auto disk_cut_by_a_shade = [disk](SceneMaker& m) {
        m.builder.add_light(disk);
        for (const float side : {0.3f, -0.35f})
            add(m, square(0.25f), diffuse(0.0f),
                translation(disk.position() + Vec3(side, 0.1f, side)),
                kVisibleAll & ~kVisibleCamera, CausticsRole::off);
    };
    return {light("disk", disk),
            {"disk cut by a shade", disk_cut_by_a_shade},
            light("wide beam", wide_beam),
            light("narrow beam", narrow_beam),
            light("spot", spot),
            light("sun", wide_sun()),
            light("rectangle", rectangle),
            with_nodes("spot with nodes", spot),
            with_nodes("rectangle with nodes", rectangle),
            light("sheared ellipse", sheared),
            {"emissive mesh",
             [](SceneMaker& m) {
                 add_glowing(m, flat(square(0.3f)), {0.4f, -0.2f, 1.9f});
             }},
            {"emissive ball between the casters",
             [](SceneMaker& m) {
                 add_glowing(m, sphere(12, 0.15), {0.4f, 0.3f, 0.9f});
             }},
            panorama()};
}

Table over_ball_and_pane() {
    const Part casters{
        "", [](SceneMaker& m) {
            add_ball(m, mirror());
            add_caster(m, square(0.6f), refraction(1.4f), rotation_x(0.3f, {0.4f, 0.0f, 0.4f}));
        }};
    Method by_angles = kManifold;
    by_angles.name = "manifold by differences of angles";
    by_angles.constraint = Constraint::angle_difference;
    std::vector<Claim> claims = of_light_paths();
    claims.push_back({by_angles, claims[0].rounds});
    Table table;
    for (const Part& light : lights())
        table.rows.push_back({.casters = casters, .light = light, .claims = claims});
    for (const Part& caster : casters_under_an_image_of_light())
        table.rows.push_back(
            {.casters = caster, .light = image_of_light(false), .claims = of_light_paths()});
    return table;
}

}  // namespace

SPC_AGREEMENT(Lights, over_ball_and_pane);

}  // namespace spc::test
