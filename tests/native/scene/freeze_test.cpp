// SPDX-License-Identifier: GPL-3.0-or-later
// From the builder to the frozen scene: what is dropped, resolved, assigned and reported.
#include "core/error.h"
#include "scene/surface.h"
#include "support/numerics.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

// Five triangles of which the second, third and fifth have no area; all per-triangle data tell who
// they belong to.
Mesh partly_degenerate() {
    Mesh mesh;
    mesh.name = "shards";
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {0, 1, 3}, {0, 1, 5}, {1, 4, 2}};
    mesh.slot_count = 2;
    Attribute layer = test::uv_layer({}), shade;
    shade.called.name = "shade";
    shade.domain = AttributeDomain::triangle;
    shade.components = 1;
    for (uint32_t t = 0; t < 5; ++t) {
        mesh.slots.push_back(t == 3 ? 1 : 0);
        shade.values.push_back(float(t));
        for (uint32_t k = 0; k < 3; ++k) {
            const auto id = float(3 * t + k);
            layer.values.insert(layer.values.end(), {id, -id});
            layer.tangents.push_back(Vec3(id, 1, 0));
            layer.tangent_signs.push_back(t == 3 ? -1.0f : 1.0f);
            mesh.normals.push_back(t == 3 && k == 1 ? Vec3(0.0f) : Vec3(0, 0, id + 1.0f));
        }
    }
    mesh.attributes = {layer, shade};
    return mesh;
}

TEST(Builder, DropsTrianglesWithoutAreaAndAllTheirData) {
    test::SceneMaker maker;
    const uint32_t index = maker.builder.add_mesh(partly_degenerate());
    const Mesh& mesh = maker.builder.mesh(index);
    EXPECT_EQ(mesh.dropped_triangles, 3u);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[1], (std::array<uint32_t, 3>{0, 1, 5}));
    EXPECT_EQ(mesh.slots, (std::vector<uint32_t>{0, 1}));
    const Attribute& layer = mesh.attributes[0];
    ASSERT_EQ(layer.size(), 6u);
    EXPECT_EQ(mesh.attributes[1].values, (std::vector<float>{0, 3}));
    ASSERT_EQ(mesh.normals.size(), 6u);
    for (uint32_t k = 0; k < 6; ++k) {
        const auto id = float(k < 3 ? k : k + 6);
        EXPECT_EQ(layer.uv(k), Vec2(id, -id));
        EXPECT_EQ(layer.tangents[k], Vec3(id, 1, 0));
        EXPECT_EQ(layer.tangent_signs[k], k < 3 ? 1.0f : -1.0f);
        // Normalised; the one without length takes its face's.
        EXPECT_NEAR_ANGLE(mesh.normals[k], k == 4 ? Vec3(0, -1, 0) : Vec3(0, 0, 1), 1e-6);
        EXPECT_NEAR(length(mesh.normals[k]), 1.0f, 1e-6f);
    }
}

// From specks to worlds: what survives has a normal, what has none does not survive.
TEST(Builder, EveryTriangleThatStaysHasANormal) {
    int kept = 0, dropped = 0;
    for (int exponent = -24; exponent <= 8; ++exponent) {
        const float size = std::pow(10.0f, float(exponent));
        for (const float flatness : {1.0f, 1e-3f, 1e-6f}) {
            test::SceneMaker maker;
            Mesh mesh;
            mesh.name = "speck";
            mesh.positions = {
                {0, 0, 0}, {size, 0, 0}, {0.3f * size, flatness * size, 0.1f * flatness * size}};
            mesh.triangles = {{0, 1, 2}};
            mesh.normals = {Vec3(0.0f), Vec3(0.0f), Vec3(1, 0, 0)};  // the last is none of the face's
            const Mesh& added = maker.builder.mesh(maker.builder.add_mesh(mesh));
            EXPECT_EQ(added.normals.size(), 3 * added.triangles.size());
            for (const Vec3& n : added.normals) {
                EXPECT_TRUE(is_finite(n));
                EXPECT_NEAR(length(n), 1.0f, 1e-4f) << "size " << size << ", flatness " << flatness;
            }
            ++(added.dropped_triangles == 0 ? kept : dropped);
            if (added.dropped_triangles > 0) {
                EXPECT_TRUE(exponent < -6 || exponent > 6)
                    << "dropped at size " << size << ", flatness " << flatness;
            }
        }
    }
    EXPECT_GT(kept, 39);
    EXPECT_GT(dropped, 10);
}

TEST(Builder, CornerNormalsOfFacesSayNothing) {
    const auto kept = [](const Vec3& of_one_corner) {
        test::SceneMaker maker;
        Mesh mesh = test::square(1.0f);
        mesh.normals.assign(3 * mesh.triangles.size(), Vec3(0, 0, 2.0f));
        mesh.normals.back() = of_one_corner;
        return maker.builder.mesh(maker.builder.add_mesh(mesh)).normals.size();
    };
    EXPECT_EQ(kept(Vec3(0, 0, 1)), 0u);
    EXPECT_EQ(kept(Vec3(0.0f)), 0u);  // takes its face's
    for (const Vec3& other : {Vec3(1e-5f, 0, 1), Vec3(0, 0, -1)}) EXPECT_EQ(kept(other), 6u);
}

TEST(Freeze, SlotsWithoutMaterialDrawNothing) {
    test::SceneMaker maker;
    Instance instance;
    instance.name = "shards";
    instance.mesh = maker.builder.add_mesh(partly_degenerate());
    instance.materials = {maker.builder.add_material(test::diffuse(0.5f)), kNone};
    maker.builder.add_instance(instance);
    const RenderScene world = maker.finish();
    EXPECT_TRUE(world.scene->any_transparency);
    EXPECT_EQ(surface_transparency(*world.scene, {0, 0, 0.2f, 0.2f}, Vec3(0, 0, 1)), Spectrum(0.0f));
    EXPECT_EQ(surface_transparency(*world.scene, {0, 1, 0.2f, 0.2f}, Vec3(0, -1, 0)),
              Spectrum(1.0f));
}

// A flattened object is no reason to lose a frame.
TEST(Freeze, MeshOfNothingButNeedlesDrawsNothing) {
    for (const Graph& graph :
         {test::mirror(), test::diffuse(0.5f), test::single_shader("emission", {})}) {
        Mesh needles;
        needles.name = "needles";
        needles.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
        needles.triangles = {{0, 0, 1}, {0, 1, 2}};
        test::SceneMaker maker;
        maker.add(needles, graph);
        maker.add(test::square(1.0f), test::diffuse(0.5f), test::translation(Vec3(0, 0, -1)));
        const RenderScene world = maker.finish();
        EXPECT_EQ(world.scene->meshes[0]->dropped_triangles, 2u);
        const std::optional<Hit> hit =
            world.scene->accel->intersect({{0.1f, 0.1f, 5}, {0, 0, -1}}, kVisibleCamera);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->surface.instance, 1u);
    }
}

TEST(Freeze, RolesAndReport) {
    struct Case {
        CausticsRole role;
        bool mirror, caster, receiver;
    };
    for (const Case& c :
         {Case{CausticsRole::automatic, true, true, false},
          Case{CausticsRole::automatic, false, false, true},
          Case{CausticsRole::off, true, false, false}, Case{CausticsRole::off, false, false, false},
          Case{CausticsRole::caster, true, true, false},
          Case{CausticsRole::caster, false, false, false},
          Case{CausticsRole::receiver, true, false, false},
          Case{CausticsRole::receiver, false, false, true},
          Case{CausticsRole::both, true, true, false},
          Case{CausticsRole::both, false, false, true}}) {
        test::SceneMaker maker;
        maker.add(test::square(1.0f), c.mirror ? test::mirror() : test::diffuse(0.5f), {}, c.role);
        const RenderScene world = maker.finish();
        const Instance& instance = world.scene->instances[0];
        EXPECT_EQ(instance.caster, c.caster)
            << "role " << int(c.role) << (c.mirror ? ", mirror" : ", diffuse");
        EXPECT_EQ(instance.receiver, c.receiver)
            << "role " << int(c.role) << (c.mirror ? ", mirror" : ", diffuse");
        EXPECT_EQ(world.casters.casters.size(), c.caster ? 1u : 0u);
        const bool asked_in_vain =
            !c.mirror && (c.role == CausticsRole::caster || c.role == CausticsRole::both);
        EXPECT_EQ(world.scene->report.size(), c.caster || asked_in_vain ? 1u : 0u);
        if (asked_in_vain) {
            EXPECT_NE(world.scene->report[0].find("path traced"), std::string::npos);
        }
    }
}

// Light paths cannot know which kind of ray the camera's path would come by.
TEST(Freeze, NoLightTracingWhereSomeRaysSeeOtherObjects) {
    struct Case {
        uint32_t visibility;
        bool caster, same;
    };
    for (const Case& c :
         {Case{kVisibleAll, true, true}, Case{kVisibleCamera, true, true},
          Case{kVisibleAll & ~kVisibleShadow, true, true},
          Case{kVisibleAll & ~kVisibleDiffuse, true, false},
          Case{kVisibleCamera | kVisibleGlossy, true, false}, Case{kVisibleGlossy, false, true}}) {
        test::SceneMaker maker;
        maker.add(test::square(1.0f), c.caster ? test::mirror() : test::diffuse(0.5f));
        Instance other;
        other.name = "screen";
        other.mesh = maker.builder.add_mesh(test::square(2.0f));
        other.materials = {maker.builder.add_material(test::diffuse(0.5f))};
        other.visibility = c.visibility;
        maker.builder.add_instance(other);
        const RenderScene world = maker.finish();
        EXPECT_EQ(world.scene->light_paths_reach_camera, c.same) << c.visibility;
        const std::vector<std::string>& report = world.scene->report;
        const bool told = std::any_of(report.begin(), report.end(), [](const std::string& line) {
            return line.find("screen: hidden from some kinds of rays") != std::string::npos;
        });
        EXPECT_EQ(told, !c.same) << c.visibility;
    }
}

// A caster elsewhere: light paths would come to the pane without knowing their rays.
TEST(Freeze, NoLightTracingWhereALookDependsOnTheRay) {
    test::SceneMaker maker;
    Graph pane = test::single_shader("bsdf_transparent", {}, {});
    pane.name = "pane";
    const auto path = static_cast<uint32_t>(pane.nodes.size());
    pane.nodes.push_back({"Path", "light_path", kNone});
    pane.links.push_back({path, "Is Camera Ray", 1, "Color"});
    maker.add(test::square(1.0f), pane);
    maker.add(test::square(1.0f), test::single_shader("bsdf_glass", {}, {}));
    const RenderScene world = maker.finish();
    EXPECT_FALSE(world.scene->light_paths_reach_camera);
    EXPECT_TRUE(std::any_of(world.scene->report.begin(), world.scene->report.end(),
                            [](const std::string& line) {
                                return line.find(
                                           "its look depends on the kind of ray, so no "
                                           "light tracing") != std::string::npos;
                            }));
}

TEST(Freeze, MissingUvLayerIsReported) {
    test::SceneMaker maker;
    maker.builder.add_image(image_from_floats("grey", std::vector<float>{0.5f}, 1, 1, 1,
                                              ColorSpace::linear, AlphaMode::none));
    Graph graph;
    graph.name = "papered";
    graph.nodes = {{"Out", "output", kNone},
                   {"Diff", "bsdf_diffuse", kNone},
                   {"Tex", "image_texture", 0},
                   {"UV", "uv_map", kNone}};
    graph.options = {{3, "uv_map", "Second"}};
    graph.links = {{1, "BSDF", 0, "Surface"}, {2, "Color", 1, "Color"}, {3, "UV", 2, "Vector"}};
    maker.add(test::square(1.0f), graph);
    const RenderScene world = maker.finish();
    ASSERT_EQ(world.scene->report.size(), 1u);
    for (const char* word : {"square of papered", "Second", "papered"})
        EXPECT_NE(world.scene->report[0].find(word), std::string::npos) << world.scene->report[0];
}

TEST(Freeze, ReportsTexelsThatWereRepaired) {
    test::SceneMaker maker;
    Image broken;
    broken.name = "broken";
    broken.width = broken.height = broken.channels = 1;
    broken.floats.writable() = {0.0f};
    Image whole = broken;
    whole.name = "whole";
    broken.repaired_texels = 3;
    maker.builder.add_image(broken);
    maker.builder.add_image(whole);
    const std::unique_ptr<Scene> scene = maker.builder.freeze(1);
    EXPECT_EQ(
        scene->report,
        (std::vector<std::string>{"image \"broken\": 3 texels were not finite and are read as 0"}));
}

}  // namespace
}  // namespace spc
