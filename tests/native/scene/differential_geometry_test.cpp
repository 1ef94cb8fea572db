// SPDX-License-Identifier: GPL-3.0-or-later
// The surface record that walks and transport read: against hand-made geometry, and its derivatives
// against differences of neighbouring hits, for every kind of instance.
#include "scene/surface.h"

#include "support/numerics.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

enum class Map { none, tangent_given, tangent_derived, no_uv, object_space, bump, both };

struct GeometryCase {
    std::string name;
    Transform transform;
    bool smooth = true;
    bool shared = false;
    Map map = Map::none;
    float strength = 1.0f;
};

double height(double x, double y) { return 0.3 * std::sin(2.0 * x + 1.0) * std::cos(1.5 * y); }
Vec3d slope_normal(double x, double y) {
    const double dx = 0.6 * std::cos(2.0 * x + 1.0) * std::cos(1.5 * y),
                 dy = -0.45 * std::sin(2.0 * x + 1.0) * std::sin(1.5 * y);
    return normalize(Vec3d(-dx, -dy, 1.0));
}

Mesh bumpy_mesh(const GeometryCase& c) {
    Mesh mesh = test::grid(
        3, [](double u, double v) { return Vec3d(u, v, height(u, v)); }, slope_normal);
    if (!c.smooth) mesh.normals.clear();
    if (c.map == Map::no_uv) return mesh;
    Attribute layer = test::uv_layer({});
    for (const auto& triangle : mesh.triangles)
        for (const uint32_t k : triangle) {
            const Vec3 p = mesh.positions[k];
            layer.values.insert(layer.values.end(),
                                {1.3f * p.x + 0.2f * p.y, 0.9f * p.y - 0.1f * p.x});
            if (c.map != Map::tangent_given && c.map != Map::both) continue;
            layer.tangents.push_back(normalize(Vec3(1.0f, 0.1f * p.y, 0.3f * p.x)));
            layer.tangent_signs.push_back(-1.0f);
        }
    mesh.attributes = {layer};
    return mesh;
}

// Slopes that vary smoothly from texel to texel.
Image wavy_normals() {
    constexpr uint32_t kSide = 8;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const float a = float(x) * 0.785f, b = float(y) * 0.785f;
            const Vec3 n = normalize(Vec3(0.3f * std::sin(a), 0.25f * std::cos(a + b), 1.0f));
            for (int i = 0; i < 3; ++i) texels.push_back(0.5f * n[i] + 0.5f);
        }
    return image_from_floats("waves", texels, kSide, kSide, 3, ColorSpace::data, AlphaMode::none);
}

Graph mapped_mirror(Map map, float strength) {
    if (map == Map::none) return test::mirror();
    Graph graph;
    graph.name = "mapped mirror";
    graph.nodes = {{"Out", "output", kNone},
                   {"Gloss", "bsdf_glossy", kNone},
                   {"Map", "normal_map", kNone},
                   {"Tex", "image_texture", 0}};
    graph.inputs = {{1, "Roughness", {0, 0, 0, 0}}, {2, "Strength", {strength, 0, 0, 0}}};
    if (map == Map::object_space) graph.options = {{2, "space", "OBJECT"}};
    graph.links = {{1, "BSDF", 0, "Surface"}, {2, "Normal", 1, "Normal"}, {3, "Color", 2, "Color"}};
    if (map != Map::bump && map != Map::both) return graph;
    graph.nodes.push_back({"Bump", "bump", kNone});
    graph.inputs.push_back({4, "Strength", {strength, 0, 0, 0}});
    graph.inputs.push_back({4, "Distance", {0.4f, 0, 0, 0}});
    graph.links[1] = {4, "Normal", 1, "Normal"};
    graph.links.push_back({3, "Color", 4, "Height"});
    if (map == Map::both) graph.links.push_back({2, "Normal", 4, "Normal"});
    return graph;
}

// The instance under test is number 0.
std::unique_ptr<Scene> geometry_scene(const GeometryCase& c) {
    // Trees that are kept for later scenes are those of meshes.
    SceneBuilder builder = c.shared ? SceneBuilder(nullptr) : SceneBuilder();
    builder.set_camera(Camera{});
    builder.add_image(wavy_normals());
    Instance instance;
    instance.name = c.name;
    instance.mesh = builder.add_mesh(bumpy_mesh(c));
    instance.object_to_world = c.transform;
    instance.materials = {builder.add_material(mapped_mirror(c.map, c.strength))};
    builder.add_instance(instance);
    if (c.shared) {
        instance.object_to_world.translation = Vec3(50.0f);
        builder.add_instance(instance);
    }
    return builder.freeze(1);
}

Transform scaled(Transform t, const Vec3& scale) {
    for (Vec3& row : t.row) row = Vec3(row.x * scale.x, row.y * scale.y, row.z * scale.z);
    return t;
}

std::vector<GeometryCase> all_cases() {
    const Transform turned = test::rotation_x(0.7f, Vec3(0.3f, -2.0f, 1.0f));
    const std::pair<const char*, Transform> transforms[] = {
        {"identity", {}},
        {"rotated", turned},
        {"uneven", scaled(turned, Vec3(2.0f, 0.5f, 1.3f))},
        {"mirrored", scaled({}, Vec3(-1.0f, 1.0f, 1.0f))},
        {"mirrored, uneven", scaled(turned, Vec3(0.7f, 1.5f, -0.4f))}};
    const std::tuple<const char*, Map, float> maps[] = {
        {"plain", Map::none, 1.0f},
        {"given tangents", Map::tangent_given, 1.0f},
        {"given tangents, weak", Map::tangent_given, 0.4f},
        {"given tangents, strong", Map::tangent_given, 1.8f},
        {"derived tangents", Map::tangent_derived, 0.7f},
        {"no UVs", Map::no_uv, 1.0f},
        {"object space", Map::object_space, 0.6f},
        {"bump", Map::bump, 1.0f},
        {"bump, weak", Map::bump, 0.6f},
        {"bump over given tangents", Map::both, 0.8f}};
    std::vector<GeometryCase> cases;
    for (const auto& [where, transform] : transforms)
        for (const auto& [what, map, strength] : maps)
            for (const bool smooth : {true, false})
                for (const bool shared : {false, true})
                    cases.push_back({std::string(where) + ", " + what +
                                         (smooth ? ", smooth" : ", flat") +
                                         (shared ? ", shared" : ""),
                                     transform, smooth, shared, map, strength});
    return cases;
}

Vec3 by_inverse_transpose(const Transform& t, const Vec3& n) {
    // Cofactors: det times the inverse transpose, sign included, without the code under test.
    const Vec3 world = Vec3(dot(cross(t.row[1], t.row[2]), n), dot(cross(t.row[2], t.row[0]), n),
                            dot(cross(t.row[0], t.row[1]), n));
    return normalize(world) * (t.determinant() < 0.0f ? -1.0f : 1.0f);
}

SurfaceHit random_hit(test::Uniforms& uniforms, const Scene& scene) {
    const auto triangles = float(scene.meshes[scene.instances[0].mesh]->triangles.size());
    const auto triangle = uint32_t(uniforms() * triangles);
    const float a = 0.02f + 0.9f * uniforms(), b = 0.02f + 0.9f * uniforms();
    return a + b < 0.97f ? SurfaceHit{0, triangle, a, b}
                         : SurfaceHit{0, triangle, 0.97f - a, 0.97f - b};
}

TEST(DifferentialGeometry, LiesOnTheTransformedMesh) {
    for (const GeometryCase& c : all_cases()) {
        SCOPED_TRACE(c.name);
        const Mesh mesh = bumpy_mesh(c);
        const std::unique_ptr<Scene> scene = geometry_scene(c);
        EXPECT_EQ(scene->instances[0].world_positions.empty(), c.shared);
        test::Uniforms uniforms(1);
        for (int i = 0; i < 20; ++i) {
            const SurfaceHit hit = random_hit(uniforms, *scene);
            const auto& index = mesh.triangles[hit.triangle];
            const float w = 1.0f - hit.u - hit.v;
            const Vec3 p = mesh.positions[index[0]] * w + mesh.positions[index[1]] * hit.u +
                           mesh.positions[index[2]] * hit.v;
            const Vec3 face = cross(mesh.positions[index[1]] - mesh.positions[index[0]],
                                    mesh.positions[index[2]] - mesh.positions[index[0]]);
            const Vec3 smooth = mesh.normals.empty()
                                    ? face
                                    : mesh.normals[3 * hit.triangle] * w +
                                          mesh.normals[3 * hit.triangle + 1] * hit.u +
                                          mesh.normals[3 * hit.triangle + 2] * hit.v;
            for (const bool base : {false, true}) {
                const DifferentialGeometry geometry = evaluate_caster(*scene, hit, base);
                EXPECT_LT(length(geometry.p - c.transform.point(p)), 1e-5f);
                EXPECT_NEAR_ANGLE(geometry.ng, by_inverse_transpose(c.transform, normalize(face)),
                                  1e-5);
                EXPECT_NEAR(length(geometry.n), 1.0f, 1e-5f);
                const Vec3 unmapped = by_inverse_transpose(c.transform, normalize(smooth));
                if (base || c.map == Map::none) {
                    EXPECT_NEAR_ANGLE(geometry.n, unmapped, 1e-5);
                } else if (c.map == Map::tangent_given || c.map == Map::bump) {
                    EXPECT_GT(test::angle_between(geometry.n, unmapped), 1e-4) << "no map";
                }
            }
        }
    }
}

TEST(DifferentialGeometry, DerivativesMatchDifferencesOfNeighbours) {
    constexpr float h = 1e-3f;
    for (const GeometryCase& c : all_cases()) {
        SCOPED_TRACE(c.name);
        const std::unique_ptr<Scene> scene = geometry_scene(c);
        test::Uniforms uniforms(2);
        int kinks = 0, curved = 0;
        constexpr int kHits = 24;
        for (int i = 0; i < kHits; ++i) {
            const SurfaceHit hit = random_hit(uniforms, *scene);
            for (const bool base : {false, true})
                for (const bool along_u : {true, false}) {
                    const auto at = [&](float step) {
                        SurfaceHit near = hit;
                        (along_u ? near.u : near.v) += step;
                        return evaluate_caster(*scene, near, base);
                    };
                    const DifferentialGeometry here = at(0.0f), next = at(h), before = at(-h);
                    const Vec3 dp = along_u ? here.dp_du : here.dp_dv,
                               dn = along_u ? here.dn_du : here.dn_dv;
                    const Vec3 p_difference = (next.p - before.p) * (0.5f / h),
                               n_difference = (next.n - before.n) * (0.5f / h);
                    EXPECT_LT(length(dp - p_difference), 2e-3f * length(dp) + 1e-3f);
                    // Texels meet in kinks: there the two sides differ, and the record is of one of
                    // them.
                    const Vec3 kink = (next.n - here.n) - (here.n - before.n);
                    if (length(kink) > 0.05f * h) {
                        ++kinks;
                        continue;
                    }
                    EXPECT_LT(length(dn - n_difference), 1e-2f * length(dn) + 3e-3f)
                        << dn << " and " << n_difference;
                    EXPECT_NEAR(dot(dn, here.n), 0.0f, 1e-4f * (1.0f + length(dn)))
                        << "a unit vector's derivative is orthogonal to it";
                    if (length(dn) > 0.05f) ++curved;
                }
        }
        EXPECT_LT(kinks, kHits);
        if (c.smooth || c.map == Map::tangent_given || c.map == Map::bump) {
            EXPECT_GT(curved, kHits) << "nothing to differentiate";
        }
    }
}

// What transport sees at the same hit: the normal of its mirror is the walk's normal, on the side
// of wo.
TEST(DifferentialGeometry, NormalIsTheClosuresNormal) {
    for (const GeometryCase& c : all_cases()) {
        SCOPED_TRACE(c.name);
        const std::unique_ptr<Scene> scene = geometry_scene(c);
        test::Uniforms uniforms(3);
        for (int i = 0; i < 20; ++i) {
            const SurfaceHit hit = random_hit(uniforms, *scene);
            const DifferentialGeometry geometry = evaluate_caster(*scene, hit, false),
                                       base = evaluate_caster(*scene, hit, true);
            for (const float side : {1.0f, -1.0f}) {
                Surface surface;
                evaluate_surface(*scene, hit, normalize(geometry.ng + geometry.n) * side, surface);
                EXPECT_EQ(surface.backfacing, side < 0.0f);
                EXPECT_NEAR_ANGLE(surface.ng, geometry.ng * side, 1e-6);
                EXPECT_NEAR_ANGLE(surface.n, base.n * side, 1e-5);
                EXPECT_LT(length(surface.p - geometry.p), 1e-5f);
                ASSERT_EQ(surface.closures.count, 1);
                const auto& mirror =
                    std::get<MicrofacetReflection>(surface.closures.closures[0].kind);
                EXPECT_TRUE(surface.closures.closures[0].on_caster_normal);
                EXPECT_NEAR_ANGLE(mirror.n, geometry.n * side, 2e-5);
            }
        }
    }
}

// One user or many is the host's affair: the record must not show it.
TEST(DifferentialGeometry, SharedMeshesAreTheSameSurface) {
    for (GeometryCase c : all_cases()) {
        if (c.shared) continue;
        SCOPED_TRACE(c.name);
        const std::unique_ptr<Scene> single = geometry_scene(c);
        c.shared = true;
        const std::unique_ptr<Scene> shared = geometry_scene(c);
        test::Uniforms uniforms(4);
        for (int i = 0; i < 10; ++i) {
            const SurfaceHit hit = random_hit(uniforms, *single);
            const DifferentialGeometry a = evaluate_caster(*single, hit, false),
                                       b = evaluate_caster(*shared, hit, false);
            for (const auto& [x, y] : {std::pair{a.p, b.p},
                                       {a.dp_du, b.dp_du},
                                       {a.dp_dv, b.dp_dv},
                                       {a.n, b.n},
                                       {a.dn_du, b.dn_du},
                                       {a.dn_dv, b.dn_dv},
                                       {a.ng, b.ng}})
                EXPECT_LT(length(x - y), 1e-5f * (1.0f + length(x)));
        }
        // Rays find the same places.
        for (int i = 0; i < 50; ++i) {
            const Vec3 target = surface_position(*single, random_hit(uniforms, *single));
            const Vec3 origin = target + normalize(uniforms.three() - Vec3(0.5f)) * 3.0f;
            const Ray ray{origin, normalize(target - origin)};
            const std::optional<Hit> a = single->accel->intersect(ray, kVisibleCamera),
                                     b = shared->accel->intersect(ray, kVisibleCamera);
            ASSERT_EQ(a.has_value(), b.has_value());
            if (!a) continue;
            EXPECT_NEAR(a->t, b->t, 1e-4f);
            EXPECT_LT(length(surface_position(*single, a->surface) -
                             surface_position(*shared, b->surface)),
                      1e-4f);
            EXPECT_EQ(b->surface.instance, 0u);
        }
    }
}

}  // namespace
}  // namespace spc
