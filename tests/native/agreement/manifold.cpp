// SPDX-License-Identifier: GPL-3.0-or-later
// What walks alone have to get right, beside other tables: many casters, lobes that share a chain,
// receivers seen from their back, walks in a medium.
#include "agreement/parts.h"

namespace spc::test {
namespace {

// What is seen around one point.
Part camera_at(const Vec3& from, const Vec3& to) {
    return {"", [=](SceneMaker& m) {
                constexpr float kHalfView = 1e-3f;
                Camera camera;
                const Frame frame = Frame::around(normalize(from - to));
                camera.to_world = translation(from);
                for (int i = 0; i < 3; ++i)
                    camera.to_world.row[i] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
                camera.width = camera.height = kSide;
                camera.crop = {0, 0, kSide, kSide};
                camera.viewplane = {-kHalfView, kHalfView, -kHalfView, kHalfView};
                m.builder.set_camera(camera);
            }};
}
IntegratorSettings all_bounces() {
    IntegratorSettings settings;
    settings.limits = {1000, 1000, 1000, 1000, 1000};
    return settings;
}
Part large_bulb(float radius, const Vec3& p = {0.9f, 0.2f, 2.5f}) {
    return bulb("", p, radius, kVisibleAll);
}

Row many_mirrors() {
    return {.casters = {"sixty mirror balls",
                        [](SceneMaker& m) {
                            for (uint64_t i = 0; i < 60; ++i) {
                                Pcg pcg(i + 100);
                                const Vec3 p(4.0f * pcg.one() - 2.0f, 4.0f * pcg.one() - 2.0f,
                                             0.15f + 0.5f * pcg.one());
                                add_caster(m, sphere(12, 0.1), mirror(), translation(p));
                            }
                        }},
            .light = bulb("", {0.9f, 0.2f, 2.5f}),
            .reference = {6000},
            .claims = {{kManifold, 3000, 0.4}}};
}

// Frosted glass seen from below scatters what a sheet of clear glass above it refracts.
Row from_behind() {
    return {.casters =
                {"pane",
                 [](SceneMaker& m) {
                     add_caster(m, square(4.0f), refraction(1.4f), translation({0.0f, 0.0f, 0.6f}));
                 }},
            .light = large_bulb(0.3f),
            .receiver = {"over frosted glass",
                         [](SceneMaker& m) {
                             m.add(square(4.0f), refraction(1.3f, 0.4f), {}, CausticsRole::receiver);
                         }},
            .camera = camera_at({0.0f, -0.5f, -1.5f}, {0.3f, 0.1f, 0.0f}),
            .reference = {15000},
            .claims = {{kManifold, 1500, 0.3, 0.3}},
            .settings = all_bounces()};
}

// Several delta closures on one normal share a chain; so do chains of a surface that lost some to a
// switch.
Row lobes(const std::string& name, const Graph& graph, bool refractions) {
    Row row{.casters = {name, [graph](SceneMaker& m) { add_panel(m, graph); }},
            .light = bulb("", {0, -0.7f, 2.2f}),
            .reference = {12000},
            .claims = {{kManifold, 3000, 0.4}}};
    row.settings.manifold.refractions = refractions;
    return row;
}

// Under a sheet of glass all light is refracted: a share that is wrong by a twentieth shows.
Row under_glass() {
    return {.casters =
                {"sheet over all",
                 [](SceneMaker& m) {
                     add_caster(m, square(4.0f), refraction(1.4f), translation({0.0f, 0.0f, 0.6f}));
                 }},
            .light = large_bulb(0.2f),
            .camera = camera_at({0.0f, -1.0f, 0.4f}, {0.2f, 0.1f, 0.0f}),
            .reference = {187500},
            .claims = {{kManifold, 15000, 0.05, 0.3}},
            .settings = all_bounces()};
}

// Through water from above, where light paths do not find what the camera sees.
Row through_water() {
    LightDesc desc = lamp(LightType::point, 10.0f);
    desc.to_world = translation({0.3f, 0.1f, 2.2f});
    desc.radius = 0.35f;
    desc.visibility = kVisibleAll & ~uint32_t{kVisibleCamera};
    Row row{.casters = {"coloured water",
                        [](SceneMaker& m) {
                            m.add(flat(square(1.5f)),
                                  absorbing(glass(1.33f), Spectrum(0.2f, 0.7f, 2.0f)),
                                  translation({0, 0, 0.8f}));
                        }},
            .light = light("", desc),
            .receiver = {"", [](SceneMaker& m) { m.add(square(1.2f), diffuse(0.5f)); }},
            .camera = camera_at({1.0f, 0.2f, 2.0f}, {0.4f, 0.2f, 0.8f}),
            .reference = {6000},
            .claims = {{kManifold, 3000, 0.5, 0.2}},
            .settings = all_bounces()};
    row.settings.limits.total = 2;  // into the water, at the floor: lit through the surface
    return row;
}

Table table() {
    const Graph two = combined(mirror(),
                               single_shader("bsdf_glossy", {{1, "Color", {0.9f, 0.6f, 0.3f, 1}},
                                                             {1, "Roughness", {0, 0, 0, 0}}}),
                               0.5f);
    return {{many_mirrors(), from_behind(), under_glass(), lobes("two mirrors in one", two, true),
             lobes("glass without refraction", glass(2.0f), false), through_water()}};
}

}  // namespace

SPC_AGREEMENT(Manifold, table);

}  // namespace spc::test
