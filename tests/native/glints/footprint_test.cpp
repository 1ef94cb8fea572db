// SPDX-License-Identifier: GPL-3.0-or-later
// Footprints against neighbouring rays.
#include "glints/glint.h"
#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

// Where a ray of the film meets the map, by whatever mirrors and glass it meets before.
struct Landing {
    Vec2 at;                                               // texels
    std::vector<std::pair<uint32_t, uint32_t>> triangles;  // (instance, triangle) on the way
    std::optional<Footprint> footprint;
    Vec3 mapped;  // unit normal of the lobe
};

std::optional<Landing> land(const RenderScene& world, const Vec2& film, const Vec2& lens) {
    const Scene& scene = *world.scene;
    const PixelFilter filter(FilterKind::box, 1.0f);
    const PixelKernel pixel{&filter, film, Vec2(0.0f)};
    Ray ray = scene.camera.ray(film.x, film.y, lens);
    RayDual differential = camera_differential(scene.camera, pixel, lens, ray.direction);
    Landing landing;
    for (int bounce = 0; bounce < 4; ++bounce) {
        const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleCamera);
        if (!hit) return std::nullopt;
        landing.triangles.emplace_back(hit->surface.instance, hit->surface.triangle);
        Surface surface;
        evaluate_surface(scene, hit->surface, ray.direction * -1.0f, surface);
        const auto distance = static_cast<double>(hit->t);
        if (surface.closures.glint_count > 0) {
            const Material& material = scene.material_of(hit->surface);
            const Image& image = scene.images[material.slopes.image];
            landing.footprint = footprint_at(scene, material.slopes, int(image.width),
                                             int(image.height), surface, differential, distance);
            if (!landing.footprint) return std::nullopt;
            landing.at = landing.footprint->at;
            landing.mapped = surface.closures.glints[0].lobe.n;
            return landing;
        }
        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo, Vec3(0.5f));
        if (!next || !next->delta) return std::nullopt;
        if (!pass_delta(scene, hit->surface, distance, next->refracted, differential))
            return std::nullopt;
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi, 0.0f,
               kInfinity};
    }
    return std::nullopt;
}

Graph glinting() {
    Graph graph = test::normal_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {0.2f, 0, 0, 0}}}), {3.0f, 5.0f});
    graph.inputs.push_back({4, "Rotation", {0, 0, 0.4f, 0}});
    graph.inputs.push_back({4, "Location", {0.2f, 0.7f, 0, 0}});
    graph.inputs.push_back({2, "Strength", {0.8f, 0, 0, 0}});
    return graph;
}

using test::SceneMaker;

// At `p`, with the z axis half-way between two points: a mirror there shows one to the other.
Transform mirroring(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Frame frame = Frame::around(normalize(normalize(a - p) + normalize(b - p)));
    Transform m = test::translation(p);
    for (int i = 0; i < 3; ++i)
        m.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
    return m;
}

// Half a metre wide, hollow on the side of +z.
Mesh dish(double radius) {
    const auto normal = [=](double u, double v) {
        const Vec3d p(0.5 * (u - 0.5), 0.5 * (v - 0.5), 0.0);
        return Vec3d(-p.x, -p.y, std::sqrt(radius * radius - dot(p, p))) * (1.0 / radius);
    };
    return test::grid(
        48, [=](double u, double v) { return Vec3d(0.0, 0.0, radius) - normal(u, v) * radius; },
        normal);
}

struct Path {
    const char* name;
    std::function<void(SceneMaker&)> add;
    Vec3 from;  // of the camera, which looks at `towards`
    Vec3 towards{0.0f, 0.0f, 0.0f};
};

std::vector<Path> paths() {
    const auto smooth_ball = [](SceneMaker& maker, const Graph& graph, const Vec3& at, double r) {
        maker.add(test::sphere(64, r), graph, test::translation(at));
    };
    Transform stretched;  // uneven, turned and mirrored
    stretched.row = {Vec3(0.8f, 0.3f, 0.0f), Vec3(0.4f, -1.4f, 0.0f), Vec3(0.0f, 0.0f, 0.7f)};
    return {
        {"seen directly", [](SceneMaker&) {}, {1.0f, -2.0f, 3.0f}},
        {"from below", [](SceneMaker&) {}, {1.0f, -2.0f, -3.0f}},
        {"instances",
         [=](SceneMaker& maker) {
             for (const float z : {0.3f, 0.6f}) {
                 Instance instance;
                 instance.name = "another";
                 instance.mesh = 0;
                 instance.materials = {0};
                 instance.object_to_world = stretched;
                 instance.object_to_world.translation = Vec3(0.0f, 0.0f, z);
                 maker.builder.add_instance(instance);
             }
         },
         {1.0f, -2.0f, 3.0f}},
        {"in a convex mirror",
         [=](SceneMaker& maker) {
             smooth_ball(maker, test::mirror(), {0.0f, 0.0f, 1.0f}, 0.5);
         },
         {0.0f, -3.0f, 2.0f},
         {0.0f, -0.35f, 0.85f}},
        {"through a ball of water",
         [=](SceneMaker& maker) {
             smooth_ball(maker, test::refraction(1.33f), {0.0f, 0.0f, 0.7f}, 0.6);
         },
         {0.5f, -1.0f, 3.0f},
         {0.05f, -0.05f, 0.7f}},
        {"through a pane",
         [=](SceneMaker& maker) {
             maker.add(test::square(3.0f), test::refraction(1.5f),
                       test::rotation_x(0.3f, Vec3(0.0f, 0.0f, 1.0f)));
         },
         {0.5f, -1.5f, 3.0f}},
        {"through a closed pane",
         [=](SceneMaker& maker) {
             maker.add(test::block(3.0f, 0.4f), test::refraction(1.5f),
                       test::rotation_x(0.3f, Vec3(0.0f, 0.0f, 1.2f)));
         },
         {0.5f, -1.5f, 3.0f}},
        {"in an instance of a mirror",
         [=](SceneMaker& maker) {
             smooth_ball(maker, test::mirror(), {5.0f, 0.0f, 1.0f}, 0.5);
             Instance instance;
             instance.name = "another";
             instance.mesh = 1;
             instance.materials = {1};
             instance.object_to_world = stretched;
             instance.object_to_world.translation = Vec3(0.0f, 0.0f, 1.0f);
             maker.builder.add_instance(instance);
         },
         {0.0f, -3.0f, 2.0f},
         {0.0f, -0.45f, 0.8f}},
        {"in a concave mirror",
         [=](SceneMaker& maker) {
             const Vec3 at(0.0f, 0.3f, 1.2f);
             maker.add(dish(0.8), test::mirror(), mirroring(at, {0.0f, -3.0f, 2.0f}, Vec3(0.0f)));
         },
         {0.0f, -3.0f, 2.0f},
         {0.0f, 0.3f, 1.2f}},
        {"in two mirrors",
         [=](SceneMaker& maker) {
             const Vec3 from(0.0f, -3.0f, 1.2f), first(0.0f, 0.2f, 1.3f), second(0.3f, -0.9f, 2.2f);
             maker.add(dish(1.5), test::mirror(), mirroring(first, from, second));
             maker.add(
                 test::sphere(64, 0.5), test::mirror(),
                 test::translation(second + mirroring(second, first, Vec3(0.0f)).column(2) * -0.5f));
         },
         {0.0f, -3.0f, 1.2f},
         {0.0f, 0.2f, 1.3f}}};
}

struct Model {
    const char* name;
    Projection projection;
    float aperture;
};

// Central differences over a tenth of a pixel, where the three rays meet the same triangles.
TEST(Footprint, IsTheDerivativeByTheFilm) {
    constexpr float kStep = 0.05f;
    const Image map = test::plane_normals(64, 0.1, 0.1, 7);
    for (const Model& model : {Model{"pinhole", Projection::perspective, 0.0f},
                               Model{"lens", Projection::perspective, 0.05f},
                               Model{"orthographic", Projection::orthographic, 0.0f},
                               Model{"orthographic lens", Projection::orthographic, 0.05f}})
        for (const Path& path : paths()) {
            const std::string name = std::string(model.name) + ", " + path.name;
            SceneMaker maker;
            maker.builder.add_image(map);
            maker.add(test::square(1.0f), glinting());
            path.add(maker);
            Camera camera;
            camera.projection = model.projection;
            const Frame frame = Frame::around(normalize(path.from - path.towards));
            camera.to_world = test::translation(path.from);
            for (int i = 0; i < 3; ++i)
                camera.to_world.row[static_cast<size_t>(i)] =
                    Vec3(frame.x[i], frame.y[i], frame.z[i]);
            camera.width = 60;
            camera.height = 40;
            const float half = model.projection == Projection::perspective ? 0.06f : 0.2f;
            camera.viewplane = {-half, half, -0.7f * half, 0.7f * half};
            camera.clip_far = kInfinity;
            camera.aperture_radius = model.aperture;
            camera.focus_distance = 2.0f;
            maker.builder.set_camera(camera);
            const RenderScene world = maker.finish();

            test::Uniforms uniforms(5);
            int compared = 0;
            for (int i = 0; i < 400; ++i) {
                const Vec2 film = uniforms.two() * Vec2(60.0f, 40.0f), lens = uniforms.two();
                const std::optional<Landing> middle = land(world, film, lens);
                if (!middle) continue;
                bool comparable = true;
                std::array<Vec2, 2> expected;
                for (int axis = 0; axis < 2; ++axis) {
                    Vec2 step(0.0f);
                    step[axis] = kStep;
                    const std::optional<Landing> before = land(world, film - step, lens),
                                                 after = land(world, film + step, lens);
                    comparable = comparable && before && after &&
                                 before->triangles == middle->triangles &&
                                 after->triangles == middle->triangles;
                    if (!comparable) break;
                    const Vec2 d = after->at - before->at;
                    // Between them a tile may begin.
                    expected[static_cast<size_t>(axis)] =
                        (d - Vec2(std::round(d.x / 64.0f), std::round(d.y / 64.0f)) * 64.0f) /
                        (2.0f * kStep);
                }
                if (!comparable) continue;
                ++compared;
                for (size_t axis = 0; axis < 2; ++axis) {
                    const Vec2 error = middle->footprint->by_film[axis] - expected[axis];
                    EXPECT_LT(error.length(), 0.02f * expected[axis].length() + 0.02f)
                        << name << ", axis " << axis << ": " << middle->footprint->by_film[axis]
                        << " and " << expected[axis];
                }
            }
            EXPECT_GT(compared, 20) << name;
        }
}

// The frame makes of the field's slopes the normals that closures are evaluated with.
TEST(Footprint, FrameGivesTheMappedNormals) {
    const Image map = test::plane_normals(64, 0.1, 0.3, 7);
    for (const Path& path : paths()) {
        SceneMaker maker;
        maker.builder.add_image(map);
        maker.add(test::square(1.0f), glinting());
        path.add(maker);
        Camera camera;
        const Frame frame = Frame::around(normalize(path.from - path.towards));
        camera.to_world = test::translation(path.from);
        for (int i = 0; i < 3; ++i)
            camera.to_world.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
        camera.viewplane = {-0.06f, 0.06f, -0.06f, 0.06f};
        camera.clip_far = kInfinity;
        maker.builder.set_camera(camera);
        const RenderScene world = maker.finish();
        const SlopeField field = *SlopeField::of_normals(world.scene->images[0], 0.8f, 2);
        test::Uniforms uniforms(6);
        int compared = 0;
        for (int i = 0; i < 100; ++i) {
            const std::optional<Landing> landing = land(world, uniforms.two(), Vec2(0.5f));
            if (!landing) continue;
            ++compared;
            const Vec2 at = landing->at;
            const int x = std::min(int(at.x), 63), y = std::min(int(at.y), 63);
            const Vec3 n = normalize(landing->footprint->frame.normal(
                slope_at(field.cell(x, y), at.x - float(x), at.y - float(y))));
            EXPECT_LT(test::angle_between(n, landing->mapped), 2e-3) << path.name;
        }
        EXPECT_GT(compared, 20) << path.name;
    }
}

}  // namespace
}  // namespace spc
