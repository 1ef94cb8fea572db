// SPDX-License-Identifier: GPL-3.0-or-later
// What surfaces make of the slopes of a height map, against the normals that they are shaded with.
#include "glints/glint.h"
#include "support/casters.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr float kDistance = 0.3f;  // m
constexpr double kSlope = 0.8;     // of heights by u and v

struct Bump {
    const char* name;
    Image image;
    float strength = 1.0f;
    float distance = kDistance;
    const char* invert = "False";
};

std::vector<Bump> bumps() {
    const Image waves = test::plane_heights(64, 48, 0.2, kSlope, 7);
    std::vector<uint8_t> bytes;
    test::Uniforms uniforms(3);
    for (int i = 0; i < 3 * 20 * 13; ++i) bytes.push_back(static_cast<uint8_t>(255 * uniforms()));
    return {{"waves", waves},
            {"inverted", waves, 1.0f, kDistance, "True"},
            {"weak", waves, 0.35f},
            {"weak and steep", waves, 0.6f, 10.0f * kDistance},
            {"negative distance", waves, 0.8f, -kDistance},
            {"coloured bytes",
             image_from_bytes("bytes", bytes, 20, 13, 3, ColorSpace::data, AlphaMode::none)}};
}

// Tiled, stretched, turned and moved.
Graph glinting(const Bump& bump) {
    Graph graph =
        test::bump_mapped(test::single_shader("bsdf_glossy", {{1, "Roughness", {0.2f, 0, 0, 0}}}),
                          {3.0f, 0.7f}, bump.distance);
    graph.inputs.insert(graph.inputs.end(), {{2, "Strength", {bump.strength, 0, 0, 0}},
                                             {4, "Rotation", {0, 0, 0.4f, 0}},
                                             {4, "Location", {0.2f, 0.7f, 0, 0}}});
    graph.options.push_back({2, "invert", bump.invert});
    return graph;
}

struct Shape {
    const char* name;
    Mesh mesh;
    Transform transform;
};

std::vector<Shape> shapes() {
    const Mesh panel =
        test::with_uvs(test::grid(
                           5, [](double u, double v) { return Vec3d(2.0 * u, 0.6 * v, 0.0); },
                           [](double, double) { return Vec3d(0.0, 0.0, 1.0); }),
                       5);
    const Mesh bent = test::with_uvs(test::sphere(24, 0.5), 24);
    Transform uneven;  // turned and mirrored, too
    uneven.row = {Vec3(0.8f, 0.3f, 0.0f), Vec3(0.4f, -1.4f, 0.0f), Vec3(0.0f, 0.1f, 0.7f)};
    uneven.translation = Vec3(0.3f, -0.2f, 0.5f);
    return {{"square", test::square(1.0f), {}},
            {"panel", panel, {}},
            {"panel, uneven", panel, uneven},
            {"sphere", bent, {}},
            {"sphere, uneven", bent, uneven}};
}

// At a random point of instance 0, from either side. A ray that stands still: footprints are other
// tests' matter.
struct Place {
    Surface surface;
    Footprint footprint;
};
std::optional<Place> random_place(const Scene& scene, test::Uniforms& uniforms) {
    Vec2 at = uniforms.two();
    if (at.x + at.y > 1.0f) at = Vec2(1.0f) - at;
    const size_t triangles = scene.meshes[scene.instances[0].mesh]->triangles.size();
    const auto triangle = static_cast<uint32_t>(uniforms() * float(triangles));
    const SurfaceHit hit{0, triangle, at.x, at.y};
    const Vec3 front = front_normal(scene, 0, triangle), wo = front * (uniforms() < 0.5f ? -1 : 1);
    Place place;
    evaluate_surface(scene, hit, wo, place.surface);
    const Material& material = scene.material_of(hit);
    const Image& image = scene.images[material.slopes.image];
    const std::optional<Footprint> footprint =
        footprint_at(scene, material.slopes, int(image.width), int(image.height), place.surface,
                     {{Vec3d(wo) * -1.0, {}, {}}}, 1.0);
    if (!footprint) return std::nullopt;
    place.footprint = *footprint;
    return place;
}

TEST(BumpFrame, GivesTheNormalsOfShading) {
    for (const Shape& shape : shapes())
        for (const Bump& bump : bumps()) {
            const std::string name = std::string(shape.name) + ", " + bump.name;
            SceneMaker maker;
            maker.builder.add_image(bump.image);
            maker.add(shape.mesh, glinting(bump), shape.transform);
            const RenderScene world = maker.finish();
            ASSERT_EQ(world.glints.fields.size(), 1u) << name;
            const SlopeField& field = world.glints.fields[0];
            test::Uniforms uniforms(5);
            int compared = 0;
            double turned = 0.0;
            for (int i = 0; i < 300; ++i) {
                const std::optional<Place> place = random_place(*world.scene, uniforms);
                if (!place) continue;
                ++compared;
                const Vec2 at = place->footprint.at;
                const Vec2 slope = slope_at(field.cell(int(at.x), int(at.y)),
                                            at.x - std::floor(at.x), at.y - std::floor(at.y));
                const SlopeFrame& frame = place->footprint.frame;
                const Vec3 n = normalize(frame.normal(frame.taken(slope))),
                           shaded = place->surface.closures.glints[0].lobe.n;
                EXPECT_LT(test::angle_between(n, shaded), 1e-3) << name;
                turned += test::angle_between(place->surface.n, shaded);
            }
            EXPECT_GT(compared, 250) << name;
            EXPECT_GT(turned / compared, 0.05) << name << ": a flat surface would pass";
        }
}

// Boxes, derivatives and directions of what a weak bump makes of slopes.
TEST(BumpFrame, WeakBumpsBlendSlopes) {
    const SlopeFrame frame{{Vec3(0.7f, 0.2f, 0.0f), Vec3(-0.4f, 1.1f, 0.0f), Vec3(0, 0, 1)}, 0.4f};
    test::Uniforms uniforms(6);
    const auto draw = [&] { return (uniforms.two() - Vec2(0.5f)) * 4.0f; };
    for (int i = 0; i < 500; ++i) {
        const Vec2 slope = draw();
        const Vec3 raised = normalize(frame.normal(slope)),
                   expected = normalize(raised * 0.4f + Vec3(0, 0, 0.6f));
        EXPECT_LT(length(normalize(frame.normal(frame.taken(slope))) - expected), 1e-5f);

        SlopeBounds box{slope, slope};
        box.extend(slope + draw() * uniforms());
        const SlopeBounds taken = frame.taken(box);
        for (int k = 0; k < 10; ++k) {
            const Vec2 inside = frame.taken(box.lower + (box.upper - box.lower) * uniforms.two());
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_GE(inside[axis], taken.lower[axis] - 1e-5f);
                EXPECT_LE(inside[axis], taken.upper[axis] + 1e-5f);
            }
        }
        // Small boxes stay small.
        const SlopeBounds small = frame.taken(SlopeBounds{slope, slope + Vec2(1e-3f)});
        EXPECT_LT((small.upper - small.lower).length(), 4e-3f);
    }
    for (int i = 0; i < 100; ++i) {
        constexpr float kStep = 1e-3f;
        const Vec2 slope = draw(), by_s = draw(), by_t = draw();
        const SlopeJet jet = frame.taken(SlopeJet{slope, by_s, by_t});
        EXPECT_LT((jet.slope - frame.taken(slope)).length(), 1e-6f);
        const auto along = [&](const Vec2& d) {
            return (frame.taken(slope + d * kStep) - frame.taken(slope - d * kStep)) *
                   (0.5f / kStep);
        };
        EXPECT_LT((jet.by_s - along(by_s)).length(), 2e-3f);
        EXPECT_LT((jet.by_t - along(by_t)).length(), 2e-3f);
    }
}

// Of one image: for bumps of any strength and distance, beside that of a normal map.
TEST(BumpFrame, BumpsShareAField) {
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(32, 0.2, 0.2, 5));
    const Graph glossy = test::single_shader("bsdf_glossy", {{1, "Roughness", {0.2f, 0, 0, 0}}});
    Graph weak = test::bump_mapped(glossy, {1, 1}, 0.1f);
    weak.inputs.push_back({2, "Strength", {0.5f, 0, 0, 0}});
    for (const Graph& graph :
         {test::bump_mapped(glossy, {1, 1}, 0.2f), weak, test::normal_mapped(glossy, {1, 1})})
        maker.add(test::square(1.0f), graph);
    const RenderScene world = maker.finish();
    EXPECT_EQ(world.glints.of_material, (std::vector<uint32_t>{0, 0, 1}));
}

}  // namespace
}  // namespace spc
