// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's rays against pinholes and lenses made by hand, and the way back against the rays.
#include "support/chi_square.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

// What the scene keeps of it.
Camera built(const Camera& camera) {
    test::SceneMaker maker;
    maker.builder.set_camera(camera);
    return maker.finish().scene->camera;
}

struct Model {
    const char* name;
    Projection projection;
    float aperture_radius;
    uint32_t blades;
    float rotation = 0.0f, ratio = 1.0f;
};
void PrintTo(const Model& model, std::ostream* out) { *out << model.name; }

constexpr auto kPerspective = Projection::perspective, kOrthographic = Projection::orthographic;

class Cameras : public ::testing::TestWithParam<Model> {
protected:
    // Turned, moved, scaled and sometimes mirrored.
    static Camera random_camera(test::Uniforms& uniforms) {
        const Model& model = GetParam();
        Camera camera;
        camera.projection = model.projection;
        const float scale = 0.1f + 5.0f * uniforms(), mirror_x = uniforms() < 0.3f ? -1.0f : 1.0f,
                    mirror_y = uniforms() < 0.3f ? -1.0f : 1.0f;
        camera.to_world = test::rotation_x(6.0f * uniforms(), uniforms.three() * 10.0f);
        for (Vec3& row : camera.to_world.row)
            row = Vec3(row.x * mirror_x, row.y * mirror_y, row.z) * scale;
        camera.width = 160;
        camera.height = 90;
        camera.crop = {20, 30, 50, 40};
        const Vec2 shift = uniforms.two() - Vec2(0.5f);
        const float half = 0.2f + uniforms();
        camera.viewplane = {shift.x - half, shift.x + half, shift.y - half, shift.y + half};
        camera.clip_near = 0.5f;
        camera.clip_far = 20.0f;
        camera.aperture_radius = model.aperture_radius;
        camera.focus_distance = 1.0f + 5.0f * uniforms();
        camera.aperture_blades = model.blades;
        camera.aperture_rotation = model.rotation;
        camera.aperture_ratio = model.ratio;
        return built(camera);
    }
};
INSTANTIATE_TEST_SUITE_P(
    All, Cameras,
    ::testing::Values(Model{"pinhole", kPerspective, 0.0f, 0}, Model{"lens", kPerspective, 0.3f, 0},
                      Model{"anamorphic lens of five blades", kPerspective, 0.2f, 5, 0.3f, 1.7f},
                      Model{"orthographic", kOrthographic, 0.0f, 0},
                      Model{"orthographic lens", kOrthographic, 0.4f, 0},
                      Model{"orthographic lens of three blades", kOrthographic, 0.4f, 3, 1.0f,
                            0.5f}));

// ---- rays, in the camera's own space, where scale plays no part

TEST(Camera, RaysAreThoseOfAPinhole) {
    test::Uniforms uniforms(6);
    for (int i = 0; i < 50; ++i) {
        const float angle = 6.0f * uniforms(), scale = 0.1f + 5.0f * uniforms();
        const bool flipped = i % 3 == 0;
        Camera camera;
        camera.to_world = test::rotation_x(angle, uniforms.three() * 10.0f);
        for (Vec3& row : camera.to_world.row)
            row = Vec3(row.x, row.y * (flipped ? -1.0f : 1.0f), row.z) * scale;
        camera.width = 160;
        camera.height = 90;
        camera.crop = {20, 30, 50, 40};
        const float shift_x = uniforms() - 0.5f, shift_y = uniforms() - 0.5f,
                    tan_half = 0.2f + uniforms();
        camera.viewplane = {shift_x - tan_half, shift_x + tan_half, shift_y - tan_half,
                            shift_y + tan_half};
        const float x = 160.0f * uniforms(), y = 90.0f * uniforms();
        const double px = double(shift_x) + (2 * double(x) / 160 - 1) * double(tan_half),
                     py = double(shift_y) + (2 * double(y) / 90 - 1) * double(tan_half);
        const double c = std::cos(double(angle)), s = std::sin(double(angle));
        const auto to_world = [&](const Vec3d& v) {
            const double v_y = flipped ? -v.y : v.y;
            return Vec3(Vec3d(v.x, c * v_y - s * v.z, s * v_y + c * v.z));
        };
        const Ray ray = built(camera).ray(x, y, uniforms.two());
        EXPECT_NEAR_ANGLE(ray.direction, to_world(normalize(Vec3d(px, py, -1.0))), 1e-5);
        EXPECT_EQ(ray.origin, camera.to_world.translation);
        camera.projection = Projection::orthographic;
        const Ray parallel = built(camera).ray(x, y, uniforms.two());
        EXPECT_NEAR_ANGLE(parallel.direction, to_world(Vec3d(0, 0, -1)), 1e-5);
        const Vec3 origin = camera.to_world.translation + to_world(Vec3d(px, py, 0));
        EXPECT_NEAR(length(parallel.origin - origin), 0.0f, 1e-5f);
    }
}

TEST_P(Cameras, RaysByAPointOfTheLensAreTheSameAndLeadBackToTheFilm) {
    if (GetParam().projection == kOrthographic) return;  // has directions of its own
    test::Uniforms uniforms(9);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(uniforms);
        const Vec2 film(160.0f * uniforms(), 90.0f * uniforms());
        const Ray ray = camera.ray(film.x, film.y, uniforms.two()),
                  again = camera.ray_from(ray.origin, film);
        EXPECT_NEAR(length(again.origin - ray.origin), 0.0f, 1e-5f);
        EXPECT_NEAR_ANGLE(again.direction, ray.direction, 1e-5);
        EXPECT_NEAR((camera.film_towards(ray.origin, ray.direction) - film).length(), 0.0f, 1e-2f);
    }
}

TEST_P(Cameras, ClipsAndDepthAreAlongTheAxis) {
    test::Uniforms uniforms(7);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(uniforms);
        const Ray ray = camera.ray(160.0f * uniforms(), 90.0f * uniforms(), uniforms.two());
        EXPECT_NEAR(length(ray.direction), 1.0f, 1e-5f);
        const Vec3 start = ray.origin, d = ray.direction;
        EXPECT_NEAR(camera.depth(start), 0.0f, 1e-5f);
        EXPECT_NEAR(camera.depth(start + d * ray.t_near), camera.clip_near, 1e-4f);
        EXPECT_NEAR(camera.depth(start + d * ray.t_far), camera.clip_far, 1e-3f);
    }
}

// All rays of a point of the film meet in the focal plane, where the pinhole's ray goes.
TEST_P(Cameras, RaysMeetInTheFocalPlane) {
    test::Uniforms uniforms(8);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(uniforms);
        Camera pinhole = camera;
        pinhole.aperture_radius = 0.0f;
        const float x = 160.0f * uniforms(), y = 90.0f * uniforms();
        const auto in_focus = [&](const Camera& of) {
            const Ray ray = of.ray(x, y, uniforms.two());
            return ray.origin + ray.direction * (ray.t_near * camera.focus_distance / 0.5f);
        };
        EXPECT_NEAR(length(in_focus(camera) - in_focus(pinhole)), 0.0f, 2e-5f);
    }
}

TEST(Camera, ClipsWhatItSees) {
    test::SceneMaker maker;
    maker.add(test::square(1.0f), test::diffuse(0.5f));
    Camera camera;
    camera.to_world = test::translation(Vec3(0, 0, 3));
    for (const auto& [clip_near, clip_far, seen] : {std::tuple{0.0f, kInfinity, true},
                                                    {2.9f, 3.1f, true},
                                                    {3.1f, 10.0f, false},
                                                    {0.1f, 2.9f, false}}) {
        camera.clip_near = clip_near;
        camera.clip_far = clip_far;
        test::SceneMaker maker_of_one;
        maker_of_one.add(test::square(1.0f), test::diffuse(0.5f));
        maker_of_one.builder.set_camera(camera);
        const RenderScene world = maker_of_one.finish();
        EXPECT_EQ(world.scene->accel
                      ->intersect(world.scene->camera.ray(0.4f, 0.6f, {0.5f, 0.5f}), kVisibleCamera)
                      .has_value(),
                  seen)
            << clip_near << ", " << clip_far;
    }
}

// ---- the way back

TEST_P(Cameras, ViewIsTheWayBackOfARay) {
    constexpr float kPixels = 5e-3f;  // what rounding of the point costs close to the camera
    test::Uniforms uniforms(9);
    test::MeanEstimate miss;
    for (int i = 0; i < 300; ++i) {
        const Camera camera = random_camera(uniforms);
        const float x = 160.0f * (3.0f * uniforms() - 1.0f), y = 90.0f * (3.0f * uniforms() - 1.0f);
        const Vec2 lens = uniforms.two(), other_lens = uniforms.two();
        const Ray ray = camera.ray(x, y, lens);
        const float t = lerp(1.01f * ray.t_near, 0.99f * ray.t_far, uniforms());
        const Vec3 p = ray.origin + ray.direction * t;
        const std::optional<CameraView> view = camera.view(p, lens);
        ASSERT_TRUE(view);
        EXPECT_NEAR(view->film.x, x, kPixels);
        EXPECT_NEAR(view->film.y, y, kPixels);
        EXPECT_NEAR(length(view->origin - ray.origin), 0.0f, 1e-5f);
        EXPECT_NEAR_REL(view->t_near, ray.t_near, 1e-5);
        EXPECT_NEAR_REL(view->t_far, ray.t_far, 1e-5);
        miss.add(double((camera.view(p, other_lens)->film - Vec2(x, y)).length()));
    }
    // Through another point of the lens it is another point of the film: the test can tell.
    if (GetParam().aperture_radius > 0.0f)
        EXPECT_GT(miss.mean(), 1.0);
    else
        EXPECT_LT(miss.mean(), double(kPixels));
}

TEST_P(Cameras, SeeWhatLiesBetweenTheClips) {
    test::Uniforms uniforms(10);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(uniforms);
        for (const auto& [depth, seen] : {std::pair{-1.0f, false},
                                          {0.0f, false},
                                          {0.49f, false},
                                          {0.51f, true},
                                          {19.9f, true},
                                          {20.1f, false}}) {
            const Vec3 across = camera.to_world.vector(Vec3(uniforms(), uniforms(), 0.0f)),
                       along = camera.to_world.column(2) * -depth,
                       p = camera.to_world.translation + across + along;
            EXPECT_EQ(camera.view(p, uniforms.two()).has_value(), seen) << depth;
        }
    }
    Camera unclipped = random_camera(uniforms);
    unclipped.clip_near = 0.0f;
    EXPECT_FALSE(unclipped.view(unclipped.to_world.translation, {0.5f, 0.5f}));
}

// Rays of neighbouring points of the film, through the same point of the lens, meet a plane that
// faces the middle one: their distances there are the inverse of film_density.
TEST_P(Cameras, FilmPerAreaIsTheDerivativeOfTheFilm) {
    constexpr float kStep = 0.25f;  // pixels
    test::Uniforms uniforms(11);
    for (int i = 0; i < 100; ++i) {
        const Camera camera = random_camera(uniforms);
        const float x = 160.0f * uniforms(), y = 90.0f * uniforms();
        const Vec2 lens = uniforms.two();
        const Ray ray = camera.ray(x, y, lens);
        const Vec3d n(ray.direction);
        const Vec3d p = Vec3d(ray.origin) + n * (1.0 + 10.0 * double(uniforms()));
        const auto hit = [&](float dx, float dy) {
            const Ray beside = camera.ray(x + dx, y + dy, lens);
            const Vec3d d(beside.direction), o(beside.origin);
            return o + d * (dot(n, p - o) / dot(n, d));
        };
        const double step = 2.0 * double(kStep);
        const Vec3d by_x = (hit(kStep, 0) - hit(-kStep, 0)) * (1.0 / step),
                    by_y = (hit(0, kStep) - hit(0, -kStep)) * (1.0 / step);
        const std::optional<CameraView> view = camera.view(Vec3(p), lens);
        ASSERT_TRUE(view);
        const double film_density = 1.0 / length(cross(by_x, by_y));
        EXPECT_NEAR_REL(view->film_density, film_density, 1e-3);
        if (camera.projection == Projection::perspective) {
            EXPECT_NEAR_REL(camera.film_density_omega(ray.direction),
                            film_density * std::pow(length(p - Vec3d(ray.origin)), 2), 1e-3);
        }
    }
}

// ---- the lens

// Cells of equal area: of a disc rings and sectors; of a polygon its triangles, each cut along and
// across. Empty outside of the aperture.
std::optional<size_t> aperture_cell(const Model& model, const Vec3& on_lens) {
    constexpr double kPi2 = 2 * std::numbers::pi, kTolerance = 1e-5;
    constexpr int kCuts = 6;
    const auto cut = [](double share) {
        return std::clamp(static_cast<size_t>(std::max(share, 0.0) * kCuts), size_t{0},
                          size_t{kCuts - 1});
    };
    const double r = double(model.aperture_radius);
    const double x = double(on_lens.x * model.ratio) / r, y = double(on_lens.y) / r;
    const int sides = model.blades == 0 ? 7 : static_cast<int>(model.blades);
    const double turn = std::atan2(y, x) / kPi2 - double(model.rotation) / kPi2 + 0.5 / sides;
    const double side = std::min(std::floor((turn - std::floor(turn)) * sides), sides - 1.0);
    double along = 0, across = 0;
    if (model.blades == 0) {
        along = x * x + y * y;
        across = (turn - std::floor(turn)) * sides - side;
    } else {
        const double angle = double(model.rotation) + kPi2 * side / sides, half = kPi2 / 2 / sides;
        const double height = x * std::cos(angle) + y * std::sin(angle),
                     offset = y * std::cos(angle) - x * std::sin(angle);
        along = std::pow(height / std::cos(half), 2);
        across = 0.5 + 0.5 * offset / (height * std::tan(half));
    }
    if (along > 1 + kTolerance) return std::nullopt;
    return (static_cast<size_t>(side) * kCuts + cut(along)) * kCuts + cut(across);
}

class Lenses : public ::testing::TestWithParam<Model> {
protected:
    static Camera camera() {
        const Model& model = GetParam();
        Camera camera;
        camera.projection = model.projection;
        camera.aperture_radius = model.aperture_radius;
        camera.focus_distance = 3.0f;
        camera.aperture_blades = model.blades;
        camera.aperture_rotation = model.rotation;
        camera.aperture_ratio = model.ratio;
        return built(camera);
    }
    // Where the rays of the middle of the film cross the lens, for points of the unit square
    // that `distort` changes.
    template <class Distort>
    static test::ChiSquare coverage(const Distort& distort) {
        constexpr int kSamples = 200000;
        const Camera camera = Lenses::camera();
        const uint32_t sides = GetParam().blades == 0 ? 7 : GetParam().blades;
        std::vector<int64_t> observed(sides * 36 + 1);
        test::Uniforms uniforms(12);
        for (int i = 0; i < kSamples; ++i) {
            const Ray ray = camera.ray(0.5f, 0.5f, distort(uniforms.two()));
            ++observed[aperture_cell(GetParam(), ray.origin).value_or(sides * 36)];
        }
        std::vector<double> expected(observed.size(), double(kSamples) / (sides * 36));
        expected.back() = 0.0;
        return test::chi_square(observed, expected);
    }
};
const auto kLenses = ::testing::Values(Model{"disc", kPerspective, 0.3f, 0},
                                       Model{"ellipse", kOrthographic, 0.3f, 0, 0.0f, 2.0f},
                                       Model{"triangle", kPerspective, 1.5f, 3, 0.4f},
                                       Model{"anamorphic", kOrthographic, 0.1f, 5, -0.7f, 0.5f},
                                       Model{"sixteen", kPerspective, 0.1f, 16, 3.1f});
INSTANTIATE_TEST_SUITE_P(All, Lenses, kLenses);

TEST_P(Lenses, AreCoveredEvenly) {
    const double significance = test::sidak(0.01, 5);
    const test::ChiSquare even = coverage([](const Vec2& u) { return u; });
    EXPECT_TRUE(even.passes(significance)) << even.text();
    // Denser by up to 5 % at one end, less dense at the other.
    const test::ChiSquare uneven =
        coverage([](const Vec2& u) { return Vec2(u.x, u.y + 0.05f * u.y * (1.0f - u.y)); });
    EXPECT_FALSE(uneven.passes(significance)) << uneven.text();
}

// A point out of focus is a disc on the film, of the radius R |1/d - 1/f| at distance 1 by similar
// triangles, and of R |1 - d/f| where the axes of all lenses are parallel.
TEST(Camera, CircleOfConfusion) {
    constexpr float kRadius = 0.2f, kFocus = 3.0f;
    constexpr int kSamples = 20000;
    const double significance = test::sidak(0.01, 24);
    for (const Projection projection : {kPerspective, kOrthographic}) {
        Camera camera;
        camera.projection = projection;
        camera.width = camera.height = 100;  // 50 pixels per viewplane
        camera.aperture_radius = kRadius;
        camera.focus_distance = kFocus;
        camera = built(camera);
        for (const float depth : {1.0f, 2.0f, 4.0f, 30.0f}) {
            const bool perspective = projection == kPerspective;
            const double d = double(depth), f = double(kFocus), r = double(kRadius);
            const double radius = 50 * r * std::abs(perspective ? 1 / d - 1 / f : 1 - d / f);
            const Vec3 p(0.3f, -0.2f, -depth);
            const double by_distance = perspective ? d : 1.0;
            const double x = 50 + 50 * 0.3 / by_distance, y = 50 - 50 * 0.2 / by_distance;
            test::Uniforms uniforms(13);
            test::MeanEstimate mean_x, mean_y, squared;
            double farthest = 0;
            for (int i = 0; i < kSamples; ++i) {
                const Vec2 film = camera.view(p, uniforms.two())->film;
                const double dx = double(film.x) - x, dy = double(film.y) - y;
                farthest = std::max(farthest, std::hypot(dx, dy));
                mean_x.add(dx);
                mean_y.add(dy);
                squared.add(dx * dx + dy * dy);
            }
            EXPECT_NEAR_REL(farthest, radius, 1e-3);
            EXPECT_TRUE(test::is_mean(mean_x, 0, significance, 1e-4));
            EXPECT_TRUE(test::is_mean(mean_y, 0, significance, 1e-4));
            EXPECT_TRUE(test::is_mean(squared, radius * radius / 2, significance, 1e-4));
        }
    }
}

}  // namespace
}  // namespace spc
