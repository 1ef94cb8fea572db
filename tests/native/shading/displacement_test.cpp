// SPDX-License-Identifier: GPL-3.0-or-later
// Displacement: bumps against a Bump node's of the same height, vertices against where they should
// be.
#include "scene/surface.h"
#include "shading/graphs.h"
#include "support/scenes.h"

namespace spc::test {
namespace {

// A height of 0.3 x, in object space.
uint32_t slope_along_x(GraphBuilder& b) {
    const uint32_t coordinate = b.node("texture_coordinate"), split = b.node("separate_xyz"),
                   steep = b.node("math", {{"Value_001", {0.3f}}}, {{"operation", "MULTIPLY"}});
    b.link(coordinate, "Object", split, "Vector").link(split, "X", steep, "Value");
    return steep;
}

// A mirror whose points move along their normals by Scale (height - Midlevel).
Graph displaced_mirror(DisplacementMode mode, const Options& options = {},
                       const Constants& constants = {{"Scale", {1}}}) {
    GraphBuilder b;
    const uint32_t mirror = b.node("bsdf_glossy", {{"Roughness", {0}}}),
                   up = b.node("displacement", constants, options);
    b.link(slope_along_x(b), "Value", up, "Height");
    Graph& graph = b.surface(mirror);
    graph.displacement = mode;
    return b.link(up, "Displacement", static_cast<uint32_t>(graph.nodes.size()) - 1, "Displacement")
        .graph;
}

Transform scaled(float s) {
    Transform transform;
    for (Vec3& row : transform.row) row = row * s;
    return transform;
}

Mesh smooth_square() {
    Mesh mesh = square(1.0f);
    mesh.normals.assign(3 * mesh.triangles.size(), Vec3(0, 0, 1));
    mesh.shaded_smooth = true;
    return mesh;
}

RenderScene world_of(const Graph& graph, const Transform& transform = {}, Mesh mesh = square(1.0f)) {
    SceneMaker maker;
    maker.add(std::move(mesh), graph, transform, CausticsRole::caster);
    return maker.finish();
}

// Of the mirror, seen from above and as a chain sees it.
Vec3 normal_in(const RenderScene& world) {
    const SurfaceHit hit{0, 0, 0.05f, 0.45f};
    const DifferentialGeometry patch = evaluate_caster(*world.scene, hit, false);
    Surface surface;
    evaluate_surface(*world.scene, hit, Vec3(0, 0, 1), surface);
    const Vec3 n = std::get<MicrofacetReflection>(surface.closures.closures[0].kind).n;
    expect_near(patch.n, n, 1e-6f);
    return n;
}

TEST(Displacement, BumpsWhatHasNoNormalOfItsOwn) {
    const RenderScene world = world_of(displaced_mirror(DisplacementMode::bump));
    expect_near(normal_in(world), normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
    expect_near(world.scene->meshes[0]->positions[0], Vec3(-1, -1, 0), 0.0f);
}

TEST(Displacement, OfAnObjectGrowsWithIt) {
    const Transform twice = scaled(2.0f);
    // The slope of a shape stays as it grows; that of a height in metres of the world does not.
    expect_near(normal_in(world_of(displaced_mirror(DisplacementMode::bump), twice)),
                normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
    expect_near(
        normal_in(world_of(displaced_mirror(DisplacementMode::bump, {{"space", "WORLD"}}), twice)),
        normalize(Vec3(-0.15f, 0, 1)), 1e-5f);
}

TEST(Displacement, ABumpIsReadByWhatReadsTheNormal) {
    GraphBuilder b;
    const uint32_t glow = b.node("emission"), geometry = b.node("geometry"),
                   up = b.node("displacement", {{"Scale", {1}}});
    b.link(geometry, "Normal", glow, "Color").link(slope_along_x(b), "Value", up, "Height");
    Graph& graph = b.surface(glow, "Emission");
    b.link(up, "Displacement", static_cast<uint32_t>(graph.nodes.size()) - 1, "Displacement");
    const RenderScene world = world_of(graph);
    const Spectrum seen = surface_emission(*world.scene, {0, 0, 0.05f, 0.45f}, Vec3(0, 0, 1));
    expect_near(seen, normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
}

TEST(Displacement, MovesVerticesAlongTheirNormals) {
    const RenderScene world = world_of(
        displaced_mirror(DisplacementMode::vertices, {}, {{"Scale", {2}}, {"Midlevel", {0.1f}}}));
    const Mesh& mesh = world.scene->meshes[world.scene->instances[0].mesh];
    ASSERT_EQ(mesh.positions.size(), 4u);
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.z, 2.0f * (0.3f * p.x - 0.1f), 1e-6f);
    expect_near(normal_in(world), normalize(Vec3(-0.6f, 0, 1)), 1e-5f);
}

TEST(Displacement, OfVerticesInMetresOfTheWorldDoesNotGrow) {
    const RenderScene world =
        world_of(displaced_mirror(DisplacementMode::vertices, {{"space", "WORLD"}}), scaled(2.0f));
    const std::array<Vec3, 3> corner = world.scene->triangle_world(0, 0);
    for (const Vec3& p : corner) EXPECT_NEAR(p.z, 0.3f * 0.5f * p.x - 0.5f, 1e-6f);
}

TEST(Displacement, SmoothNormalsTurnWithTheFacesAndFlatOnesAreTheFaces) {
    const RenderScene smooth =
        world_of(displaced_mirror(DisplacementMode::vertices), {}, smooth_square());
    expect_near(normal_in(smooth), normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
    Mesh mixed = smooth_square();
    mixed.flat_faces = {1, 0};
    expect_near(normal_in(world_of(displaced_mirror(DisplacementMode::vertices), {}, mixed)),
                normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
}

// On top of the displaced normals its bump would look twice as steep.
TEST(Displacement, BothBumpsTheSurfaceAsItWas) {
    const RenderScene flat = world_of(displaced_mirror(DisplacementMode::both));
    expect_near(normal_in(flat), normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
    const RenderScene world =
        world_of(displaced_mirror(DisplacementMode::both), {}, smooth_square());
    expect_near(normal_in(world), normalize(Vec3(-0.3f, 0, 1)), 1e-5f);
    const Mesh& mesh = world.scene->meshes[world.scene->instances[0].mesh];
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.z, 0.3f * p.x - 0.5f, 1e-6f);
}

TEST(Displacement, InstancesOfOneMeshAndMaterialShareTheDisplacedOne) {
    SceneMaker maker;
    const uint32_t moved = maker.builder.add_material(displaced_mirror(DisplacementMode::vertices)),
                   plain = maker.builder.add_material(single("bsdf_diffuse"));
    const uint32_t mesh = maker.builder.add_mesh(square(1.0f));
    for (const uint32_t material : {moved, plain, moved}) {
        Instance instance;
        instance.mesh = mesh;
        instance.materials = {material};
        maker.builder.add_instance(instance);
    }
    const RenderScene world = maker.finish();
    const std::vector<Instance>& instances = world.scene->instances;
    EXPECT_EQ(instances[0].mesh, instances[2].mesh);
    EXPECT_EQ(instances[1].mesh, mesh);
    EXPECT_NE(instances[0].mesh, mesh);
}

// Along the tangent, the normal and the bitangent, in this order.
TEST(Displacement, OfAVectorInTangentSpace) {
    GraphBuilder b;
    const uint32_t mirror = b.node("bsdf_glossy", {{"Roughness", {0}}}),
                   shift = b.node("vector_displacement",
                                  {{"Vector", {0.1f, 0.2f, 0.3f}}, {"Scale", {1}}});
    Graph& graph = b.surface(mirror);
    graph.displacement = DisplacementMode::vertices;
    b.link(shift, "Displacement", static_cast<uint32_t>(graph.nodes.size()) - 1, "Displacement");
    const RenderScene world = world_of(graph);
    const Mesh& mesh = world.scene->meshes[world.scene->instances[0].mesh];
    expect_near(mesh.positions[0], Vec3(-1 + 0.1f, -1 + 0.3f, 0.2f), 1e-6f);
}

TEST(Displacement, ThatDependsOnABumpIsToldAndFlat) {
    GraphBuilder b;
    const uint32_t mirror = b.node("bsdf_glossy", {{"Roughness", {0}}}), bump = b.node("bump"),
                   up = b.node("displacement", {{"Height", {1}}});
    b.link(slope_along_x(b), "Value", bump, "Height").link(bump, "Normal", up, "Normal");
    Graph& graph = b.surface(mirror);
    b.link(up, "Displacement", static_cast<uint32_t>(graph.nodes.size()) - 1, "Displacement");
    const RenderScene world = world_of(graph, {}, smooth_square());
    expect_near(normal_in(world), Vec3(0, 0, 1), 1e-6f);
    ASSERT_EQ(world.scene->materials[0]->warnings.size(), 1u);
}

}  // namespace
}  // namespace spc::test
