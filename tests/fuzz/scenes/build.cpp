// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes/build.h"

#include "api/handles.h"
#include "light/bench.h"
#include "support/casters.h"
#include "support/radiance.h"

#include <cstdlib>

namespace spc::fuzz {
namespace {

constexpr uint32_t kCells = 24;  // along each side of a curved form

Mesh grid_of(const std::function<Vec3d(double, double)>& position,
             const std::function<Vec3d(double, double)>& normal, uint32_t cells) {
    return test::with_uvs(test::grid(cells, position, normal), cells);
}

Mesh flat_grid(uint32_t cells) {
    return grid_of([](double u, double v) { return Vec3d(2 * u - 1, 2 * v - 1, 0); },
                   [](double, double) { return Vec3d(0, 0, 1); }, cells);
}

Mesh waves() {
    constexpr double kHeight = 0.04, kTurns = 9.0;
    return grid_of(
        [](double u, double v) {
            return Vec3d(2 * u - 1, 2 * v - 1,
                         kHeight * std::sin(kTurns * u) * std::cos(kTurns * v));
        },
        [](double u, double v) {
            const double to_slope = kHeight * kTurns / 2;
            return normalize(Vec3d(-to_slope * std::cos(kTurns * u) * std::cos(kTurns * v),
                                   to_slope * std::sin(kTurns * u) * std::sin(kTurns * v), 1));
        },
        kCells);
}

Mesh bowl() {
    const auto point = [](double u, double v) {
        const double phi = 2.0 * std::numbers::pi * u, theta = std::numbers::pi * (1.0 - 0.5 * v);
        return Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     std::cos(theta));
    };
    return grid_of(point, point, kCells);
}

// Two faces that look away from each other, without sides.
Mesh slab() {
    constexpr float kThickness = 0.15f;
    Mesh mesh = flat_grid(1);
    const auto corners = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t i = 0; i < corners; ++i)
        mesh.positions.push_back(mesh.positions[i] - Vec3(0, 0, kThickness));
    for (const std::array<uint32_t, 3> t : std::vector(mesh.triangles)) {
        mesh.triangles.push_back({t[0] + corners, t[2] + corners, t[1] + corners});
        for (int corner = 0; corner < 3; ++corner) mesh.normals.push_back({0, 0, -1});
    }
    std::vector<float>& uv = mesh.attributes[0].values;
    for (size_t i = 0, n = uv.size(); i < n; ++i) uv.push_back(uv[i]);
    return mesh;
}

Mesh mesh_of(Form form) {
    switch (form) {
        case Form::ball: return test::with_sphere_uvs(test::sphere(kCells, 1.0), kCells);
        case Form::faceted_ball: return test::flat(test::with_uvs(test::sphere(8, 1.0), 8));
        case Form::bowl: return bowl();
        case Form::pane: return flat_grid(1);
        case Form::slab: return slab();
        case Form::block: return test::block(1.0f, 1.0f);
        case Form::waves: return waves();
    }
    std::abort();
}
bool has_uvs(Form form) { return form != Form::block; }

Graph finish_of(const Caster& c) {
    switch (c.finish) {
        case Finish::mirror: return test::mirror(c.roughness);
        case Finish::metal: return test::principled(1.0f, c.roughness);
        case Finish::refraction: return test::refraction(c.ior, c.roughness);
        case Finish::glass:
            return test::single_shader("bsdf_glass", {{1, "Color", {1, 1, 1, 1}},
                                                      {1, "Roughness", {c.roughness, 0, 0, 0}},
                                                      {1, "IOR", {c.ior, 0, 0, 0}}});
    }
    std::abort();
}

Graph material_of(test::SceneMaker& maker, const Caster& c) {
    constexpr uint64_t kSeed = 5;
    Graph graph = finish_of(c);
    if (c.coat > 0.0f) graph = test::combined(graph, test::diffuse(0.5f), c.coat);
    if (c.detail != Detail::none && has_uvs(c.form) && c.coat == 0.0f) {
        const double wavelength = static_cast<double>(c.wavelength),
                     slope = static_cast<double>(c.slope);
        const bool bump = c.detail == Detail::bump;
        const uint32_t image = maker.builder.add_image(
            bump ? test::plane_heights(c.texels, c.texels, wavelength, slope, kSeed)
                 : test::plane_normals(c.texels, wavelength, slope, kSeed));
        graph = bump ? test::bump_mapped(graph, {1, 1}, 2.0f) : test::normal_mapped(graph, {1, 1});
        for (GraphNode& node : graph.nodes)
            if (node.kind == "image_texture") node.image = image;
    }
    if (c.absorption > 0.0f)
        graph = test::absorbing(graph, Spectrum(0.5f * c.absorption, c.absorption, 0.0f));
    return graph;
}

Transform product(const Transform& a, const Transform& b) {
    Transform m;
    for (int i = 0; i < 3; ++i) m.row[i] = b.transposed(a.row[i]);
    m.translation = a.point(b.translation);
    return m;
}

Transform turned(const Vec3& turn) {
    const auto about = [](int axis, float angle) {
        Transform m;
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        m.row[a][a] = m.row[b][b] = std::cos(angle);
        m.row[b][a] = std::sin(angle);
        m.row[a][b] = -m.row[b][a];
        return m;
    };
    return product(about(2, turn.z), product(about(1, turn.y), about(0, turn.x)));
}

void add(test::SceneMaker& maker, const Caster& c) {
    Instance instance;
    instance.name = c.name;
    instance.mesh = maker.builder.add_mesh(mesh_of(c.form));
    instance.materials = {maker.builder.add_material(material_of(maker, c))};
    instance.visibility = c.visibility;
    instance.role = c.role;
    const Transform turn = turned(c.turn);
    const auto place = [&](const Vec3& position, float size) {
        Transform scale;
        for (int i = 0; i < 3; ++i) scale.row[i][i] = c.scale[i] * size;
        if (c.flipped) scale.row[0][0] *= -1.0f;
        instance.object_to_world = product(turn, scale);
        instance.object_to_world.translation = position;
        maker.builder.add_instance(instance);
    };
    constexpr float kInside = 0.6f, kBeside = 1.3f;
    for (uint32_t copy = 0; copy < c.copies; ++copy) {
        const float shift = kBeside * c.scale.x * static_cast<float>(copy);
        const Vec3 position = c.position + Vec3(shift, 0.3f * shift, 0.0f);
        place(position, 1.0f);
        if (c.filled) place(position, kInside);
    }
}

void add(test::SceneMaker& maker, const Receiver& r) {
    Graph graph = test::diffuse(r.albedo);
    if (r.gloss > 0.0f) graph = test::combined(graph, test::mirror(0.5f), r.gloss);
    const Transform upright = test::rotation_x(0.5f * kPi, {0.0f, 1.6f, 0.0f});
    maker.add(test::square(4.0f), graph, r.wall ? upright : Transform(), CausticsRole::automatic,
              r.visibility);
}

void add(test::SceneMaker& maker, const Lamp& l) {
    const Vec3 axis = normalize(l.target - l.position);
    if (l.kind == LampKind::mesh) {
        const float half = 0.5f * l.extent, strength = l.power / (kPi * l.extent * l.extent);
        maker.add(test::square(half), test::emission(strength), test::facing(l.position, axis),
                  CausticsRole::automatic, l.visibility);
        return;
    }
    LightDesc light;
    switch (l.kind) {
        case LampKind::sun: light = test::sun_lamp(l.power, l.extent, axis); break;
        case LampKind::rectangle:
        case LampKind::ellipse:
            light = test::area_lamp(
                l.power, l.kind == LampKind::ellipse ? AreaShape::ellipse : AreaShape::rectangle,
                {l.extent, l.extent * l.stretch});
            light.spread = l.beam;
            break;
        case LampKind::spot:
            light = test::spot_lamp(l.power, l.extent, l.beam, l.blend);
            light.soft_falloff = l.soft;
            break;
        default: light = test::point_lamp(l.power, l.extent); light.soft_falloff = l.soft;
    }
    light.name = l.name;
    light.to_world = test::facing(l.position, axis);
    light.visibility = l.visibility;
    light.feeds_caustics = l.feeds_caustics;
    maker.builder.add_light(light);
}

void set_sky(test::SceneMaker& maker, Sky sky) {
    if (sky == Sky::none) return;
    if (sky == Sky::even) return test::set_world(maker, 0.5f);
    constexpr uint32_t kWidth = 32, kHeight = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const bool peak = y >= 11 && y < 14 && x >= 6 && x < 11;
            for (const float part : {1.0f, 0.9f, 0.8f})
                texels.push_back((peak ? 20.0f : 0.2f) * part);
        }
    const uint32_t image = maker.builder.add_image(
        image_from_floats("sky", texels, kWidth, kHeight, 3, ColorSpace::linear, AlphaMode::none));
    Graph graph = test::background(1, 1, 1);
    graph.nodes.push_back({"Sky", "environment_texture", image});
    graph.links.push_back({2, "Color", 1, "Color"});
    maker.builder.set_environment({maker.builder.add_material(graph), kVisibleAll, true});
}

void set_camera(test::SceneMaker& maker, const Plan& plan, uint32_t side) {
    constexpr Vec3 kTarget(0.0f, 0.2f, 0.3f);
    Camera camera;
    const Vec3 axis = normalize(kTarget - plan.eye);
    const Vec3 right = normalize(cross(axis, Vec3(0, 0, 1))), up = cross(right, axis);
    for (int i = 0; i < 3; ++i) camera.to_world.row[i] = Vec3(right[i], up[i], -axis[i]);
    camera.to_world.translation = plan.eye;
    camera.width = camera.height = side;
    camera.crop = {0, 0, side, side};
    const float distance = length(kTarget - plan.eye);
    const float half = plan.half_view * (plan.orthographic ? distance : 1.0f);
    camera.viewplane = {-half, half, -half, half};
    if (plan.orthographic) camera.projection = Projection::orthographic;
    camera.aperture_radius = plan.aperture;
    camera.focus_distance = distance;
    maker.builder.set_camera(camera);
}

}  // namespace

test::ScenePtr build(const Plan& plan, uint32_t side) {
    test::SceneMaker maker;
    for (const Caster& caster : plan.casters) add(maker, caster);
    for (const Receiver& receiver : plan.receivers) add(maker, receiver);
    for (const Lamp& lamp : plan.lamps) add(maker, lamp);
    set_sky(maker, plan.sky);
    set_camera(maker, plan, side);
    spc_scene* scene = nullptr;
    if (spc_scene_create(&scene) != SPC_OK) std::abort();
    test::ScenePtr owned(scene);
    *scene->builder = std::move(maker.builder);
    if (spc_scene_commit(scene, 1) != SPC_OK) {
        std::fprintf(stderr, "FUZZ: %s\n", spc_last_error());
        std::abort();
    }
    return owned;
}

}  // namespace spc::fuzz
