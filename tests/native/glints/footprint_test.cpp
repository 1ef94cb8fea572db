// SPDX-License-Identifier: GPL-3.0-or-later
// Footprints against neighbouring rays.
#include "glints/glint.h"
#include "support/glints.h"
#include "support/rough.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

// What a path does at a rough surface.
struct Turn {
    Vec3 n, facet, wi;  // unit; the interpolated normal and the facet on the side of wo
    bool diffuse = false, refracted = false;
    float eta = 1.0f;

    // Of a path that comes from `wo` to where the normal is `normal`: its facet leans as far.
    Vec3 likewise(const Vec3& normal, const Vec3& wo) const {
        if (diffuse) return wi;
        const Vec3 m = normalize(facet + normal - n);
        const float cos_o = dot(m, wo);
        if (!refracted) return m * (2.0f * cos_o) - wo;
        const float cos_t = std::sqrt(1.0f - (1.0f - cos_o * cos_o) / (eta * eta));
        return normalize(m * (cos_o / eta - cos_t) - wo * (1.0f / eta));
    }
};

// Where a ray of the film meets the map, by whatever it meets before.
struct Landing {
    std::vector<Turn> turns;                               // at rough surfaces
    Vec2 at;                                               // texels
    std::vector<std::pair<uint32_t, uint32_t>> triangles;  // (instance, triangle) on the way
    std::optional<Footprint> footprint;
    Vec3 mapped;  // unit normal of the lobe
};

// Rough surfaces take it further by random numbers, or as they took another one.
std::optional<Landing> land(const RenderScene& world, const Vec2& film, const Vec2& lens,
                            test::Uniforms* uniforms = nullptr, const Landing* other = nullptr) {
    const Scene& scene = *world.scene;
    const PixelFilter filter(FilterKind::box, 1.0f);
    const PixelKernel pixel{&filter, film, Vec2(0.0f)};
    Ray ray = scene.camera.ray(film.x, film.y, lens);
    PathDifferential differential = camera_differential(scene.camera, pixel, lens, ray.direction);
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
        std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo,
                   uniforms != nullptr ? uniforms->three() : Vec3(0.5f));
        if (!next) return std::nullopt;
        if (!next->delta) {
            const size_t turn = landing.turns.size();
            if (other != nullptr) {
                if (turn >= other->turns.size()) return std::nullopt;
                next->wi = other->turns[turn].likewise(surface.n, surface.wo);
                next->refracted = other->turns[turn].refracted;
            }
            const float eta = next->refracted ? next->eta : 1.0f;
            const Vec3 half = normalize(surface.wo + next->wi * eta);
            landing.turns.push_back({surface.n, dot(half, surface.n) > 0.0f ? half : half * -1.0f,
                                     next->wi, next->kind == BounceKind::diffuse, next->refracted,
                                     eta});
        }
        if (!propagate_through_bounce(scene, surface, *next, distance, differential))
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

// Central differences over a tenth of a pixel; empty unless the three rays meet the same triangles.
// `land_at` follows the path of `middle` from another place of the film.
template <class LandAt>
std::optional<std::array<Vec2, 2>> differences(const Landing& middle, const Vec2& film,
                                               const LandAt& land_at) {
    constexpr float kStep = 0.05f;
    std::array<Vec2, 2> result;
    for (int axis = 0; axis < 2; ++axis) {
        Vec2 step(0.0f);
        step[axis] = kStep;
        const std::optional<Landing> before = land_at(film - step), after = land_at(film + step);
        if (!before || !after || before->triangles != middle.triangles ||
            after->triangles != middle.triangles)
            return std::nullopt;
        const Vec2 d = after->at - before->at;
        // Between them a repeat may begin.
        result[static_cast<size_t>(axis)] =
            (d - Vec2(std::round(d.x / 64.0f), std::round(d.y / 64.0f)) * 64.0f) / (2.0f * kStep);
    }
    return result;
}
void expect_derivative(const Landing& middle, const std::array<Vec2, 2>& expected,
                       const std::string& name) {
    for (size_t axis = 0; axis < 2; ++axis) {
        const Vec2 error = middle.footprint->by_film[axis] - expected[axis];
        EXPECT_LT(error.length(), 0.02f * expected[axis].length() + 0.02f)
            << name << ", axis " << axis << ": " << middle.footprint->by_film[axis] << " and "
            << expected[axis];
    }
}

TEST(Footprint, IsTheDerivativeByTheFilm) {
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
                const auto expected = differences(
                    *middle, film, [&](const Vec2& at) { return land(world, at, lens); });
                if (!expected) continue;
                ++compared;
                expect_derivative(*middle, *expected, name);
            }
            EXPECT_GT(compared, 20) << name;
        }
}

// The same after rough bounces, for what the film alone does to a path.
TEST(Footprint, AfterRoughBouncesIsTheDerivativeByTheFilm) {
    const Vec3 from(0.0f, -3.0f, 2.0f);
    const auto rough = [](float roughness) {
        return test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}});
    };
    const auto ball = [](SceneMaker& maker, const Graph& graph, const Vec3& at, double r) {
        maker.add(test::sphere(64, r), graph, test::translation(at));
    };
    const std::vector<Path> all{
        {"in a rough ball",
         [=](SceneMaker& maker) {
             ball(maker, rough(0.2f), {0.0f, 0.0f, 1.0f}, 0.5);
         },
         from,
         {0.0f, -0.35f, 0.85f}},
        {"by a diffuse ball",
         [=](SceneMaker& maker) {
             ball(maker, test::diffuse(0.8f), {0.0f, 0.0f, 1.0f}, 0.5);
         },
         from,
         {0.0f, -0.35f, 0.7f}},
        {"through a frosted ball",
         [=](SceneMaker& maker) {
             ball(maker, test::frosted_glass(0.2f), {0.0f, 0.0f, 0.7f}, 0.6);
         },
         {0.5f, -1.0f, 3.0f},
         {0.05f, -0.05f, 0.7f}},
        {"in a rough dish and a smooth ball",
         [=](SceneMaker& maker) {
             const Vec3 first(0.0f, 0.2f, 1.3f), second(0.3f, -0.9f, 2.2f);
             maker.add(dish(1.5), rough(0.1f), mirroring(first, from, second));
             ball(maker, test::mirror(),
                  second + mirroring(second, first, Vec3(0.0f)).column(2) * -0.5f, 0.5);
         },
         from,
         {0.0f, 0.2f, 1.3f}}};
    const Image map = test::plane_normals(64, 0.1, 0.1, 7);
    for (const Path& path : all) {
        SceneMaker maker;
        maker.builder.add_image(map);
        maker.add(test::square(1.0f), glinting());
        path.add(maker);
        Camera camera = test::look_at(path.towards, path.from - path.towards,
                                      length(path.from - path.towards), 0.3f);
        camera.width = camera.height = 60;
        maker.builder.set_camera(camera);
        const RenderScene world = maker.finish();
        test::Uniforms uniforms(5);
        int compared = 0;
        for (int i = 0; i < 4000 && compared < 100; ++i) {
            const Vec2 film = uniforms.two() * 60.0f, lens(0.5f);
            const std::optional<Landing> middle = land(world, film, lens, &uniforms);
            if (!middle || middle->turns.empty()) continue;
            const auto expected = differences(*middle, film, [&](const Vec2& at) {
                return land(world, at, lens, nullptr, &*middle);
            });
            if (!expected) continue;
            ++compared;
            expect_derivative(*middle, *expected, path.name);
        }
        EXPECT_EQ(compared, 100) << path.name;
    }
}

// Where directions of a rough surface land, against the lobe's footprint: Beckmann's facets lean by
// alpha / sqrt(2) along each axis, of which the footprint has a quarter of alpha; and diffuse ones
// around a direction by as much as it has.
TEST(Footprint, LobeIsAShareOfTheSpreadOfDirections) {
    constexpr int kDirections = 40000;
    const auto beckmann = [](const char* type, float roughness) {
        return test::single_shader(type, {{1, "Roughness", {roughness, 0, 0, 0}}},
                                   {{1, "distribution", "BECKMANN"}});
    };
    struct Lobe {
        const char* name;
        Graph graph;
        Vec3 from, at;  // the surface is half-way between `from` and straight down, or a pane
        bool pane;
        double share;
    };
    const double facets = 0.25 * std::numbers::sqrt2;
    for (const Lobe& lobe :
         {Lobe{"mirror",
               beckmann("bsdf_glossy", 0.12f),
               {0.0f, -2.0f, 0.5f},
               {0.1f, 0.0f, 1.0f},
               false,
               facets},
          Lobe{"pane",
               beckmann("bsdf_refraction", 0.12f),
               {0.0f, -1.0f, 2.5f},
               {0.1f, -0.2f, 1.0f},
               true,
               facets},
          Lobe{"diffuse", test::diffuse(0.8f), {0.0f, -2.0f, 0.5f}, {0.1f, 0.0f, 1.0f}, false, 10.0}}) {
        SceneMaker maker;
        maker.builder.add_image(test::plane_normals(64, 0.1, 0.1, 7));
        maker.add(
            test::square(1.0f),
            test::normal_mapped(
                test::single_shader("bsdf_glossy", {{1, "Roughness", {0.2f, 0, 0, 0}}}), {1, 1}));
        maker.add(test::square(0.2f), lobe.graph,
                  lobe.pane ? test::translation(lobe.at)
                            : mirroring(lobe.at, lobe.from, {0.1f, 0.0f, -2.0f}));
        Camera camera =
            test::look_at(lobe.at, lobe.from - lobe.at, length(lobe.from - lobe.at), 0.1f);
        maker.builder.set_camera(camera);
        const RenderScene world = maker.finish();
        const Scene& scene = *world.scene;
        const Ray ray = scene.camera.ray(0.5f, 0.5f, Vec2(0.5f));
        const Hit hit = *scene.accel->intersect(ray, kVisibleCamera);
        Surface first;
        evaluate_surface(scene, hit.surface, ray.direction * -1.0f, first);
        const PixelFilter filter(FilterKind::box, 1.0f);
        const PathDifferential seen = camera_differential(
            scene.camera, {&filter, Vec2(0.5f), Vec2(0.0f)}, Vec2(0.5f), ray.direction);
        const auto meets = [&](const ClosureSample& next) -> std::optional<Footprint> {
            PathDifferential path = seen;
            const Ray on{offset_origin({first.p, first.ng, first.p_error}, next.wi), next.wi, 0.0f,
                         kInfinity};
            const std::optional<Hit> floor = scene.accel->intersect(on, kVisibleCamera);
            if (!floor || floor->surface.instance != 0 ||
                !propagate_through_bounce(scene, first, next, double(hit.t), path))
                return std::nullopt;
            Surface surface;
            evaluate_surface(scene, floor->surface, next.wi * -1.0f, surface);
            const Image& image = scene.images[0];
            return footprint_at(scene, scene.material_of(floor->surface).slopes, int(image.width),
                                int(image.height), surface, path, double(floor->t));
        };
        // Straight down, but for the pane, where it is what facets without a tilt make.
        test::Uniforms uniforms(3);
        std::optional<ClosureSample> middle;
        for (int i = 0; i < 1000 && !middle; ++i)
            middle = sample(first.closures, first.ng, first.wo, uniforms.three());
        ASSERT_TRUE(middle) << lobe.name;
        const Turn flat{first.n, first.n,   {0.0f, 0.0f, -1.0f},
                        false,   lobe.pane, lobe.pane ? middle->eta : 1.0f};
        middle->wi = flat.likewise(first.n, first.wo);
        const std::optional<Footprint> footprint = meets(*middle);
        ASSERT_TRUE(footprint) << lobe.name;

        double xx = 0.0, xy = 0.0, yy = 0.0;
        Vec2 sum(0.0f);
        std::vector<Vec2> landings;
        const Frame around = Frame::around(middle->wi);
        for (int i = 0; i < kDirections; ++i) {
            std::optional<ClosureSample> next =
                sample(first.closures, first.ng, first.wo, uniforms.three());
            if (!next) continue;
            // A hundredth of a radian around the middle; its coordinates are from [-sqrt(3),
            // sqrt(3)].
            if (next->kind == BounceKind::diffuse) {
                const Vec2 u = (uniforms.two() - Vec2(0.5f)) * (2.0f * std::sqrt(3.0f) * 0.01f);
                next->wi = normalize(middle->wi + around.x * u.x + around.y * u.y);
            }
            const std::optional<Footprint> landing = meets(*next);
            if (!landing) continue;
            landings.push_back(landing->at);
            sum += landing->at;
        }
        EXPECT_GT(landings.size(), 0.98 * kDirections) << lobe.name;
        const Vec2 mean = sum / float(landings.size());
        for (const Vec2& at : landings) {
            const Vec2 d = at - mean;
            xx += double(d.x * d.x) / double(landings.size());
            xy += double(d.x * d.y) / double(landings.size());
            yy += double(d.y * d.y) / double(landings.size());
        }
        const auto& [a, b] = footprint->by_lobe;
        const double share2 = lobe.share * lobe.share, scale = share2 * std::sqrt(xx * yy);
        EXPECT_NEAR(double(a.x * a.x + b.x * b.x), share2 * xx, 0.05 * scale) << lobe.name;
        EXPECT_NEAR(double(a.y * a.y + b.y * b.y), share2 * yy, 0.05 * scale) << lobe.name;
        EXPECT_NEAR(double(a.x * a.y + b.x * b.y), share2 * xy, 0.05 * scale) << lobe.name;
    }
}

// The kernel has the covariance of film and lobe together, no more turn than it may, and without a
// lobe it is the film's.
TEST(Footprint, AxesAddFilmAndLobe) {
    Footprint footprint;
    footprint.by_film = {Vec2(3.0f, 1.0f), Vec2(-0.5f, 2.0f)};
    EXPECT_EQ(footprint.axes(0.1f, 1.0f), footprint.by_film);
    footprint.by_lobe = {Vec2(0.4f, 0.2f), Vec2(0.1f, -0.3f)};
    footprint.lobe_turn = 0.02f;
    constexpr float kVariance = 0.1f;
    for (const float most : {1.0f, 0.01f}) {
        const float share = most < 0.02f ? 0.25f : 1.0f;
        const auto product = [](const std::array<Vec2, 2>& v, int i, int j) {
            return v[0][i] * v[0][j] + v[1][i] * v[1][j];
        };
        const std::array<Vec2, 2> axes = footprint.axes(kVariance, most);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                EXPECT_NEAR(kVariance * product(axes, i, j),
                            kVariance * product(footprint.by_film, i, j) +
                                share * product(footprint.by_lobe, i, j),
                            1e-5f);
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
