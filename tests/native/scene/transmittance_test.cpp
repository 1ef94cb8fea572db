// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between two points: all that stands before the far one, and not what that lies on.
#include "scene/transmittance.h"

#include "support/numerics.h"
#include "support/radiance.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

struct Place {
    float scale;     // of the surface, m
    float distance;  // of the surface from the world's origin, m
};

// A surface whose points are seen from wherever `inside` or outside of it is.
struct Form {
    const char* name;
    Mesh mesh;
    bool inside;
};
std::vector<Form> forms() {
    const Mesh flat_grid = test::grid(
        8, [](double u, double v) { return Vec3d(2 * u - 1, 2 * v - 1, 0); },
        [](double, double) { return Vec3d(0, 0, 1); });
    return {{"triangle pair", test::square(1.0f), false},
            {"grid", flat_grid, false},
            {"ball", test::sphere(24, 1.0), false},
            {"hollow ball", test::sphere(24, 1.0), true}};
}

// `shared`: through a tree in object space, and stretched there.
std::unique_ptr<Scene> scene_of(const Form& form, const Place& place, test::Uniforms& uniforms,
                                bool shared) {
    test::SceneMaker maker;
    Instance one;
    one.mesh = maker.builder.add_mesh(form.mesh);
    one.object_to_world = test::rotation_x(
        uniforms() * 6.0f, (uniforms.three() - Vec3(0.5f)) * (2.0f * place.distance));
    for (Vec3& row : one.object_to_world.row)
        row = Vec3(row.x * place.scale * (shared ? 0.2f : 1.0f), row.y * place.scale,
                   row.z * place.scale);
    one.materials = {maker.builder.add_material(test::diffuse(0.5f))};
    maker.builder.add_instance(one);
    if (shared) {
        one.visibility = 0;
        maker.builder.add_instance(one);
    }
    return maker.builder.freeze(1);
}

SurfaceHit random_hit(const Mesh& mesh, test::Uniforms& uniforms) {
    const float a = std::sqrt(uniforms()), b = uniforms();
    const auto triangle = uint32_t(uniforms() * float(mesh.triangles.size()));
    const bool on_edge = uniforms() < 0.25f;
    return {0, triangle, on_edge ? 0.0f : a * (1.0f - b), a * b};
}

bool is_blocked(const Scene& scene, const Vec3& from, const RayEnd& end) {
    uint32_t transparent_left = 0;
    Media media{};
    uint64_t rays = 0;
    return is_black(transmittance(scene, {from, Vec3(0, 0, 1), 0.0f}, end, kVisibleShadow,
                                  transparent_left, media, rays));
}

class FarEnd : public ::testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(Places, FarEnd,
                         ::testing::Values(Place{1e-5f, 0.0f}, Place{1e-4f, 1e-3f},
                                           Place{1e-2f, 0.1f}, Place{1.0f, 0.0f}, Place{1.0f, 8.0f},
                                           Place{1e4f, 8e4f}, Place{1.0f, 1e3f}));

// From near and far, above and grazing, on edges and beside neighbours in the same plane or rising
// behind an edge.
TEST_P(FarEnd, ItsOwnSurfaceHidesNothing) {
    const Place place = GetParam();
    test::Uniforms uniforms(31);
    for (const Form& form : forms())
        for (const bool shared : {false, true}) {
            int blocked = 0, blocked_at_p = 0, rays = 0;
            for (int i = 0; i < 20; ++i) {
                const std::unique_ptr<Scene> scene = scene_of(form, place, uniforms, shared);
                const Transform& to_world = scene->instances[0].object_to_world;
                for (int k = 0; k < 1000; ++k) {
                    const SurfaceHit hit = random_hit(scene->meshes[0], uniforms);
                    const Vec3 p = surface_position(*scene, hit),
                               ng = front_normal(*scene, 0, hit.triangle);
                    Vec3 w = normalize(uniforms.three() - Vec3(0.5f));
                    if (dot(w, ng) < 0.0f) w = w * -1.0f;
                    const float away = place.scale * std::exp2(uniforms() * 20.0f - 10.0f);
                    const Vec3 from = form.inside
                                          ? to_world.point((uniforms.three() - Vec3(0.5f)) * 0.9f)
                                          : p + w * away;
                    const RayEnd end = end_on(*scene, hit, p);
                    if (std::abs(dot(from - p, ng)) < end.error) continue;  // may lie behind it
                    blocked += is_blocked(*scene, from, end) ? 1 : 0;
                    blocked_at_p += is_blocked(*scene, from, {end.at, end.ng}) ? 1 : 0;
                    ++rays;
                }
            }
            EXPECT_GT(blocked_at_p, rays / 4) << "too little power";
            EXPECT_EQ(blocked, 0) << "of " << rays << " rays, " << form.name
                                  << (shared ? ", instanced" : "");
        }
}

// Some hundred-thousandths of the coordinates and of the way are enough to tell two surfaces apart.
TEST_P(FarEnd, ACloseScreenHidesIt) {
    const Place place = GetParam();
    test::Uniforms uniforms(32);
    for (const bool shared : {false, true}) {
        const float relative = shared ? 1e-4f : 1e-5f;
        int blocked = 0, blocked_behind = 0, rays = 0;
        for (int i = 0; i < 200; ++i) {
            const float away = place.scale * std::exp2(uniforms() * 10.0f - 5.0f);
            const std::unique_ptr<Scene> scene = scene_of(forms()[0], place, uniforms, shared);
            const Vec3 ng = front_normal(*scene, 0, 0);
            for (int k = 0; k < 100; ++k) {
                SurfaceHit hit = random_hit(scene->meshes[0], uniforms);
                hit.u = 0.25f + 0.25f * hit.u, hit.v = 0.25f + 0.25f * hit.v;  // far from the edge
                const Vec3 p = surface_position(*scene, hit);
                // The surface itself is the screen of what is a little behind it.
                const float gap = relative * (place.scale + place.distance + away);
                if (gap > 0.1f * away || gap > 0.2f * place.scale) continue;
                for (const float side : {-1.0f, 1.0f}) {
                    const RayEnd end{{false, p + ng * (gap * side), Vec3(0.0f)},
                                     ng,
                                     position_error(*scene, 0, 0),
                                     ray_error(*scene, 0)};
                    const Vec3 w = normalize(ng + (uniforms.three() - Vec3(0.5f)) * 0.5f);
                    (side < 0.0f ? blocked : blocked_behind) +=
                        is_blocked(*scene, end.at.p + w * away, end) ? 1 : 0;
                }
                ++rays;
            }
        }
        EXPECT_GT(rays, 5000);
        EXPECT_EQ(blocked, rays) << (shared ? "instanced" : "");
        EXPECT_EQ(blocked_behind, 0) << "what lies behind the far end hides nothing";
    }
}

TEST(FarEnd, OfACameraIsItsClip) {
    test::SceneMaker maker;
    maker.add(test::square(1.0f), test::diffuse(0.5f));
    const std::unique_ptr<Scene> scene = maker.builder.freeze(1);
    const RayEnd camera{.at = {false, {0.0f, 0.0f, -0.1f}, Vec3(0.0f)}, .clip = 0.1f};
    const auto from_clip = [&](float off) {
        RayEnd end = camera;
        end.clip += off;
        return is_blocked(*scene, {0.2f, 0.1f, 100.0f}, end);
    };
    EXPECT_TRUE(from_clip(-2e-4f));
    EXPECT_FALSE(from_clip(2e-4f));
}

// Panes one above the other, each lets through a share of its own; the ray crosses both of a pane's
// triangles on their common edge.
class Panes : public ::testing::TestWithParam<bool> {
protected:
    static constexpr int kCount = 40;  // more than a ray notes at once
    static float share(int pane) { return 1.0f - 0.005f * static_cast<float>(pane); }

    // `solid`: of the panes, one that lets nothing through, or none.
    std::unique_ptr<Scene> scene(int solid = -1) const {
        test::SceneMaker maker;
        const bool shared = GetParam();
        const uint32_t mesh = maker.builder.add_mesh(test::square(1.0f));
        for (int i = 0; i < kCount; ++i) {
            Instance pane;
            pane.mesh = shared ? mesh : maker.builder.add_mesh(test::square(1.0f));
            pane.object_to_world.translation = Vec3(0, 0, 1.0f + 0.25f * static_cast<float>(i));
            pane.materials = {maker.builder.add_material(i == solid ? test::diffuse(0.5f)
                                                                    : test::transparent(share(i)))};
            maker.builder.add_instance(pane);
        }
        return maker.builder.freeze(1);
    }
    static float through(const Scene& scene, const Vec3& to, uint32_t most, uint32_t& left) {
        Media media{};
        uint64_t rays = 0;
        left = most;
        const Vec3 from(0.25f, 0.25f, 0.0f);
        return transmittance(scene, {from, Vec3(0, 0, 1), 0.0f},
                             {{false, to, Vec3(0.0f)}, Vec3(0.0f)}, kVisibleShadow, left, media,
                             rays)
            .x;
    }
};
INSTANTIATE_TEST_SUITE_P(Shared, Panes, ::testing::Bool());

TEST_P(Panes, LetThroughTheProductOfTheirShares) {
    const std::unique_ptr<Scene> clear = scene();
    for (const Vec3& to : {Vec3(0.25f, 0.25f, 20.0f), Vec3(0.3f, -0.4f, 20.0f)}) {
        uint32_t left;
        double product = 1.0;
        for (int i = 0; i < kCount; ++i) product *= static_cast<double>(share(i));
        EXPECT_NEAR(through(*clear, to, 64, left), product, 1e-5);
        EXPECT_EQ(left, 64u - kCount);
        EXPECT_NEAR(through(*clear, to, kCount, left), product, 1e-5);
        EXPECT_EQ(through(*clear, to, kCount - 1, left), 0.0f) << "one more blocks";
    }
    uint32_t left;
    EXPECT_FLOAT_EQ(through(*clear, Vec3(0.25f, 0.25f, 1.3f), 8, left), share(0) * share(1));
    EXPECT_EQ(left, 6u);
}

TEST_P(Panes, ASolidOneAmongThemBlocks) {
    for (const int solid : {0, 20, kCount - 1}) {
        uint32_t left;
        const std::unique_ptr<Scene> mixed = scene(solid);
        EXPECT_EQ(through(*mixed, Vec3(0.25f, 0.25f, 20.0f), 64, left), 0.0f);
        // Up to it all is clear.
        const float below = 0.9f + 0.25f * static_cast<float>(solid);
        EXPECT_GT(through(*mixed, Vec3(0.25f, 0.25f, below), 64, left), 0.01f);
        EXPECT_EQ(left, 64u - static_cast<uint32_t>(solid));
    }
}

}  // namespace
}  // namespace spc
