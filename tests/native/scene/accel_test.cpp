// SPDX-License-Identifier: GPL-3.0-or-later
// Ray casts against a search through all triangles and lamps.
#include "scene/accel.h"

#include "scene/surface.h"
#include "support/numerics.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

Mesh triangle_soup(uint64_t seed, int count, float extent, float size) {
    Mesh mesh;
    mesh.name = "soup";
    test::Uniforms uniforms(seed);
    for (int i = 0; i < count; ++i) {
        const Vec3 center = (uniforms.three() - Vec3(0.5f)) * (2.0f * extent);
        for (int k = 0; k < 3; ++k)
            mesh.positions.push_back(center + (uniforms.three() - Vec3(0.5f)) * (2.0f * size));
        const auto first = uint32_t(3 * i);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

constexpr uint32_t kVisibilities[] = {kVisibleAll, kVisibleCamera, kVisibleShadow | kVisibleDiffuse,
                                      kVisibleGlossy, 0u};

// Whether meshes keep trees of their own, of which instances are made, or all is in the scene's
// tree.
class Trees : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OfMeshes, Trees, ::testing::Bool());

// A scene that is edited later keeps trees of meshes.
SceneBuilder builder_of(bool trees_of_meshes) {
    return trees_of_meshes ? SceneBuilder(nullptr) : SceneBuilder();
}

// Five instances, two of them of one mesh, and three lamps; a visibility of its own for each
// instance.
std::unique_ptr<Scene> crowded_scene(bool trees_of_meshes) {
    test::SceneMaker maker(builder_of(trees_of_meshes));
    SceneBuilder& builder = maker.builder;
    const uint32_t mirror = builder.add_material(test::mirror());
    const auto instance = [&](uint32_t mesh, const Transform& transform, uint32_t visibility) {
        Instance one;
        one.name = "soup " + std::to_string(visibility);
        one.mesh = mesh;
        one.object_to_world = transform;
        one.materials = {mirror};
        one.visibility = visibility;
        builder.add_instance(one);
    };
    const uint32_t shared = builder.add_mesh(triangle_soup(1, 60, 2.0f, 0.7f));
    Transform skewed = test::rotation_x(0.4f, Vec3(0.5f, 0.0f, -0.5f));
    skewed.row[0] = skewed.row[0] * -1.4f;
    instance(shared, {}, kVisibilities[0]);
    instance(shared, skewed, kVisibilities[1]);
    for (uint32_t i = 2; i < 5; ++i)
        instance(builder.add_mesh(triangle_soup(i, 60, 2.0f, 0.7f)), test::rotation_x(float(i)),
                 kVisibilities[i]);
    LightDesc lamp;
    lamp.name = "bulb";
    lamp.radius = 0.6f;
    lamp.to_world = test::translation(Vec3(0.2f, 0.1f, 0.3f));
    builder.add_light(lamp);
    lamp.visibility = kVisibleDiffuse;
    lamp.to_world = test::translation(Vec3(-1.0f, 0.4f, 0.0f));
    builder.add_light(lamp);
    maker.add_area_light(test::rotation_x(0.3f, Vec3(0.0f, -0.5f, 1.0f)), 1.5f, 10.0f);
    return builder.freeze(2);
}

// [Moeller97] in double; t, or nothing.
std::optional<double> hit_triangle(const std::array<Vec3, 3>& corner, const Ray& ray) {
    const Vec3d o(ray.origin), d(ray.direction), a(corner[0]), e1 = Vec3d(corner[1]) - a,
                                                               e2 = Vec3d(corner[2]) - a;
    const Vec3d p = cross(d, e2);
    const double det = dot(e1, p);
    if (det == 0.0) return std::nullopt;
    const Vec3d s = o - a;
    const double u = dot(s, p) / det;
    const Vec3d q = cross(s, e1);
    const double v = dot(d, q) / det, t = dot(e2, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || t <= double(ray.t_near) || t >= double(ray.t_far))
        return std::nullopt;
    return t;
}

struct Nearest {
    double t = std::numeric_limits<double>::infinity();
    uint32_t instance = kNone, triangle = 0, light = kNone;
};
// `only` restricts the search to one instance, whatever its visibility.
Nearest search(const Scene& scene, const Ray& ray, uint32_t kind, bool lamps, uint32_t only = kNone) {
    Nearest nearest;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (only == kNone ? (scene.instances[i].visibility & kind) == 0 : i != only) continue;
        for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh]->triangles.size(); ++t)
            if (const std::optional<double> at = hit_triangle(scene.triangle_world(i, t), ray);
                at && *at < nearest.t)
                nearest = {*at, i, t, kNone};
    }
    for (uint32_t i = 0; lamps && i < scene.lights.size(); ++i) {
        if ((scene.lights[i].visibility & kind) == 0) continue;
        if (const std::optional<LightSurfaceHit> at = intersect_light(scene.lights[i], ray);
            at && double(at->t) < nearest.t)
            nearest = {double(at->t), kNone, 0, i};
    }
    return nearest;
}

Ray random_ray(test::Uniforms& uniforms) {
    const auto point = [&] { return (uniforms.three() - Vec3(0.5f)) * 6.0f; };
    const Vec3 origin = point();
    const float t_near = uniforms() < 0.5f ? 0.0f : uniforms();
    return {origin, normalize(point() - origin), t_near,
            uniforms() < 0.5f ? kInfinity : t_near + 3.0f * uniforms()};
}

TEST_P(Trees, NearestHitForEveryKindOfRay) {
    const std::unique_ptr<Scene> scene = crowded_scene(GetParam());
    test::Uniforms uniforms(7);
    int lamps = 0, shared = 0, baked = 0, disputed = 0, kinds_with_hit = 0;
    constexpr int kRays = 600;
    for (const uint32_t kind :
         {kVisibleCamera, kVisibleDiffuse, kVisibleGlossy, kVisibleTransmission, kVisibleShadow}) {
        int hits = 0;
        for (int i = 0; i < kRays; ++i) {
            const Ray ray = random_ray(uniforms);
            // Shadow rays do not see lamps, whatever their flags say of shadows.
            const Nearest expected = search(*scene, ray, kind, kind != kVisibleShadow);
            const std::optional<Hit> hit = scene->accel->intersect(ray, kind);
            const Nearest no_lamps = search(*scene, ray, kind, false);
            if (scene->accel->occluded(ray, kind) != (no_lamps.instance != kNone)) ++disputed;
            if (hit.has_value() != std::isfinite(expected.t)) {
                ++disputed;  // an edge, or the end of the ray
                continue;
            }
            if (!hit) continue;
            ++hits;
            if (std::abs(double(hit->t) - expected.t) > 1e-4 * (1 + expected.t)) {
                ++disputed;
                continue;
            }
            EXPECT_EQ(hit->light, expected.light);
            if (hit->light != kNone) {
                ++lamps;
                continue;
            }
            EXPECT_EQ(hit->surface.instance, expected.instance);
            EXPECT_EQ(hit->surface.triangle, expected.triangle);
            ++(hit->surface.instance < 2 ? shared : baked);
            EXPECT_NE(scene->instances[hit->surface.instance].visibility & kind, 0u);
            // The barycentrics weigh the corners as documented.
            EXPECT_LT(length(surface_position(*scene, hit->surface) -
                             (ray.origin + ray.direction * hit->t)),
                      2e-4f);
        }
        kinds_with_hit += hits > 0;
    }
    EXPECT_EQ(kinds_with_hit, 5);
    EXPECT_GT(lamps, 50);
    EXPECT_GT(shared, 50);
    EXPECT_GT(baked, 50);
    EXPECT_LE(disputed, 3) << "of " << 5 * kRays << " rays; only grazed edges may differ";
}

TEST_P(Trees, CasterAloneIgnoresEverythingElse) {
    const std::unique_ptr<Scene> scene = crowded_scene(GetParam());
    test::Uniforms uniforms(8);
    int casters = 0;
    for (uint32_t instance = 0; instance < 4; ++instance) {
        if (!scene->instances[instance].caster) continue;  // hidden from scattered rays
        ++casters;
        int hits = 0, behind_others = 0, disputed = 0;
        for (int i = 0; i < 1000; ++i) {
            const Ray ray = random_ray(uniforms);
            const Nearest expected = search(*scene, ray, 0, false, instance);
            const std::optional<Hit> hit = scene->accel->intersect_alone(instance, ray);
            if (hit.has_value() != std::isfinite(expected.t) ||
                (hit && std::abs(double(hit->t) - expected.t) > 1e-4 * (1 + expected.t))) {
                ++disputed;
                continue;
            }
            if (!hit) continue;
            ++hits;
            EXPECT_EQ(hit->surface.instance, instance);
            EXPECT_EQ(hit->surface.triangle, expected.triangle);
            EXPECT_EQ(hit->light, kNone);
            if (search(*scene, ray, kVisibleAll, true).t < expected.t) ++behind_others;
        }
        EXPECT_GT(hits, 100) << "instance " << instance;
        EXPECT_GT(behind_others, 20) << "instance " << instance;
        EXPECT_LE(disputed, 2) << "instance " << instance;
    }
    EXPECT_GE(casters, 1);
}

TEST(Accel, AnEmptySceneAndOneOfLampsAlone) {
    test::SceneMaker empty;
    const std::unique_ptr<Scene> nothing = empty.builder.freeze(1);
    const Ray down{{0, 0, 5}, {0, 0, -1}};
    EXPECT_FALSE(nothing->accel->intersect(down, kVisibleCamera));
    EXPECT_FALSE(nothing->accel->occluded(down, kVisibleShadow));
    test::SceneMaker lit;
    Transform up = test::rotation_x(kPi);  // shines along +z
    lit.add_area_light(up, 1.0f, 1.0f);
    const std::unique_ptr<Scene> lamps = lit.builder.freeze(1);
    ASSERT_TRUE(lamps->accel->intersect(down, kVisibleCamera));
    EXPECT_EQ(lamps->accel->intersect(down, kVisibleCamera)->light, 0u);
    EXPECT_FALSE(lamps->accel->occluded(down, kVisibleShadow));
}

// Whatever it is that went wrong before: Embree itself would end the program.
TEST(Accel, RaysThatCannotBeCastAreCounted) {
    test::SceneMaker maker;
    maker.add_area_light(test::rotation_x(kPi), 1.0f, 1.0f);  // shines along +z
    const std::unique_ptr<Scene> scene = maker.builder.freeze(1);
    const Accel& accel = *scene->accel;
    const Vec3 origin(0, 0, 5), down(0, 0, -1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> impossible;
    for (const float bad : {nan, kInfinity, -kInfinity, 1e19f})
        for (int axis = 0; axis < 3; ++axis) {
            impossible.push_back({origin, down});
            impossible.back().origin[axis] = bad;
            impossible.push_back({origin, down});
            impossible.back().direction[axis] = bad;
        }
    impossible.push_back({origin, down, nan, kInfinity});
    impossible.push_back({origin, down, -1.0f, kInfinity});
    impossible.push_back({origin, down, 0.0f, nan});
    for (const Ray& ray : impossible) {
        EXPECT_FALSE(accel.intersect(ray, kVisibleCamera));
        EXPECT_TRUE(accel.occluded(ray, kVisibleShadow));
    }
    EXPECT_EQ(accel.lost_rays(), 2 * impossible.size());
    // And those at the bounds are cast.
    EXPECT_TRUE(accel.intersect({{0, 0, 1e8f}, down}, kVisibleCamera));
    EXPECT_FALSE(accel.occluded({{1e8f, 1e8f, 1e8f}, down}, kVisibleShadow));
    EXPECT_FALSE(accel.occluded({origin, down, 0.0f, kInfinity}, kVisibleShadow));
    EXPECT_EQ(accel.lost_rays(), 2 * impossible.size());
}

// Rays that leave a triangle must not meet it again, in scenes of every size, near the origin and
// far from it, baked and instanced; and the offset must be small against the scene and its
// coordinates.
struct Place {
    float scale;     // of the triangles, m
    float distance;  // of the triangles from the origin, m
};
class OffsetOrigin : public ::testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(Places, OffsetOrigin,
                         ::testing::Values(Place{1e-4f, 0.0f}, Place{1e-4f, 1e-3f},
                                           Place{1e-2f, 0.1f}, Place{1.0f, 0.0f}, Place{1.0f, 8.0f},
                                           Place{1e4f, 0.0f}, Place{1e4f, 8e4f}, Place{1.0f, 1e4f}));

// One triangle, turned and moved; `shared`: through a tree in object space.
std::unique_ptr<Scene> lone_triangle(uint64_t seed, const Place& place, const Graph& graph,
                                     bool shared) {
    test::Uniforms uniforms(seed);
    test::SceneMaker maker(builder_of(shared));
    Instance one;
    one.mesh = maker.builder.add_mesh(triangle_soup(seed, 1, 2.0f * place.scale, place.scale));
    one.object_to_world = test::rotation_x(
        uniforms() * 6.0f, (uniforms.three() - Vec3(0.5f)) * (2.0f * place.distance));
    one.materials = {maker.builder.add_material(graph)};
    maker.builder.add_instance(one);
    if (shared) {
        one.visibility = 0;
        maker.builder.add_instance(one);
    }
    return maker.builder.freeze(1);
}

SurfaceHit random_hit(test::Uniforms& uniforms) {
    const float a = std::sqrt(uniforms()), b = uniforms();
    return {0, 0, a * (1.0f - b), a * b};
}

TEST_P(OffsetOrigin, NeverMeetsItsOwnTriangle) {
    const Place place = GetParam();
    test::Uniforms uniforms(17);
    for (const bool shared : {false, true}) {
        int again = 0, rays = 0;
        double farthest = 0.0;
        for (uint64_t i = 0; i < 200; ++i) {
            const std::unique_ptr<Scene> scene =
                lone_triangle(100 + i, place, test::diffuse(0.5f), shared);
            for (int k = 0; k < 100; ++k) {
                const SurfaceHit hit = random_hit(uniforms);
                const Vec3 p = surface_position(*scene, hit), ng = front_normal(*scene, 0, 0);
                const Vec3 direction = normalize(uniforms.three() - Vec3(0.5f));
                const Vec3 origin = offset_origin({p, ng, position_error(*scene, 0, 0)}, direction);
                again +=
                    scene->accel->intersect({origin, direction, 0.0f, kInfinity}, kVisibleDiffuse)
                        ? 1
                        : 0;
                farthest = std::max(farthest, double(length(origin - p)));
                ++rays;
            }
        }
        EXPECT_EQ(again, 0) << "of " << rays << " rays" << (shared ? ", instanced" : "");
        EXPECT_LT(farthest, 1e-4 * double(place.scale + place.distance)) << "an offset that shows";
    }
}

// A ray that looks through a surface meets it once, and what stands a little behind it.
TEST_P(OffsetOrigin, PastASurfaceIsNeverTheSameSurface) {
    const Place place = GetParam();
    test::Uniforms uniforms(18);
    for (const bool shared : {false, true}) {
        int again = 0, hits = 0;
        for (uint64_t i = 0; i < 200; ++i) {
            const std::unique_ptr<Scene> scene =
                lone_triangle(400 + i, place, test::diffuse(0.5f), shared);
            for (int k = 0; k < 100; ++k) {
                const Vec3 target = surface_position(*scene, random_hit(uniforms));
                const Vec3 direction = normalize(uniforms.three() - Vec3(0.5f));
                const float away = place.scale * std::exp2(uniforms() * 20.0f - 10.0f);
                Ray ray{target - direction * away, direction, 0.0f, kInfinity};
                const std::optional<Hit> hit = scene->accel->intersect(ray, kVisibleDiffuse);
                if (!hit) continue;
                ++hits;
                ray.t_near = past(hit->t);
                again += scene->accel->intersect(ray, kVisibleDiffuse) ? 1 : 0;
            }
        }
        EXPECT_GT(hits, 10000);
        EXPECT_EQ(again, 0) << "of " << hits << " rays" << (shared ? ", instanced" : "");
    }
}

TEST(Past, ThinPairsAtADistanceAreTwoSurfaces) {
    test::SceneMaker maker;
    maker.add(test::square(1.0f), test::diffuse(0.5f));
    maker.add(test::square(1.0f), test::diffuse(0.5f), test::translation({0, 0, -1e-4f}));
    const std::unique_ptr<Scene> scene = maker.builder.freeze(1);
    Ray ray{{0.2f, 0.1f, 100.0f}, {0, 0, -1}};
    for (const uint32_t sheet : {0u, 1u}) {
        const std::optional<Hit> hit = scene->accel->intersect(ray, kVisibleCamera);
        ASSERT_TRUE(hit) << sheet;
        EXPECT_EQ(hit->surface.instance, sheet);
        ray.t_near = past(hit->t);
    }
    EXPECT_FALSE(scene->accel->intersect(ray, kVisibleCamera));
}

}  // namespace
}  // namespace spc
