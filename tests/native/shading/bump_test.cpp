// SPDX-License-Identifier: GPL-3.0-or-later
// Bump maps: the normals of flat surfaces under heights whose slopes are known.
#include "scene/surface.h"
#include "shading/graphs.h"
#include "support/scenes.h"

namespace spc::test {
namespace {

// A mirror whose normal is a bump's.
struct BumpGraph : GraphBuilder {
    explicit BumpGraph(const Constants& constants = {}, const Options& options = {})
        : glossy(node("bsdf_glossy", {{"Roughness", {0}}})), bump(node("bump", constants, options)) {
        link(bump, "Normal", glossy, "Normal");
    }
    uint32_t glossy, bump;
};

// Rises by 1 from the left to the right of the image, by 1/2 from the bottom to the top.
Image ramp() {
    constexpr uint32_t kSide = 8;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x)
            texels.push_back((static_cast<float>(x) + 0.5f * static_cast<float>(y)) / kSide);
    return image_from_floats("ramp", texels, kSide, kSide, 1, ColorSpace::data, AlphaMode::none);
}
Graph ramp_mirror(const Constants& constants, const Options& options = {},
                  const char* interpolation = "Linear") {
    BumpGraph b(constants, options);
    const uint32_t image = b.node("image_texture", {}, {{"interpolation", interpolation}}, 0);
    b.link(image, "Color", b.bump, "Height");
    return b.surface(b.glossy);
}
// Heights are the mean of the object's coordinates.
Graph slanted_mirror() {
    BumpGraph b;
    const uint32_t coordinate = b.node("texture_coordinate");
    b.link(coordinate, "Object", b.bump, "Height");
    return b.surface(b.glossy);
}

// Near the middle of a square of two metres that the image covers, seen from above or from below.
Vec3 normal_on_square(const Graph& graph, const Transform& transform = {}, float side = 1.0f) {
    SceneMaker maker;
    maker.builder.add_image(ramp());
    maker.add(square(1.0f), graph, transform, CausticsRole::caster);
    const RenderScene world = maker.finish();
    const SurfaceHit hit{0, 0, 0.05f, 0.45f};
    const DifferentialGeometry patch = evaluate_caster(*world.scene, hit, false);
    Surface surface;
    evaluate_surface(*world.scene, hit, patch.ng * side, surface);
    const Vec3 n = std::get<MicrofacetReflection>(surface.closures.closures[0].kind).n;
    expect_near(patch.n * side, n, 1e-6f);
    expect_near(patch.dn_du, Vec3(0.0f), 1e-5f);  // the slope is the same everywhere
    return n;
}

TEST(Bump, IsTheSlopeOfItsHeight) {
    expect_near(normal_on_square(ramp_mirror({})), normalize(Vec3(-0.5f, -0.25f, 1)), 1e-5f);
    expect_near(normal_on_square(ramp_mirror({{"Distance", {3}}})),
                normalize(Vec3(-1.5f, -0.75f, 1)), 1e-5f);
    expect_near(normal_on_square(ramp_mirror({}, {{"invert", "True"}})),
                normalize(Vec3(0.5f, 0.25f, 1)), 1e-5f);
    const Vec3 whole = normalize(Vec3(-0.5f, -0.25f, 1));
    expect_near(normal_on_square(ramp_mirror({{"Strength", {0.5f}}})),
                normalize(whole + Vec3(0, 0, 1)), 1e-5f);
    expect_near(normal_on_square(ramp_mirror({{"Strength", {2}}})),
                normalize(whole * 2.0f - Vec3(0, 0, 1)), 1e-5f);
    expect_near(normal_on_square(ramp_mirror({{"Strength", {-1}}})), {0, 0, 1}, 1e-6f);
    // However the image would be filtered elsewhere.
    expect_near(normal_on_square(ramp_mirror({}, {}, "Closest")), whole, 1e-5f);
}

// Half as long along x, mirrored along y.
Transform squeezed() {
    Transform transform;
    transform.row[0] = Vec3(0.5f, 0, 0);
    transform.row[1] = Vec3(0, -1, 0);
    return transform;
}

TEST(Bump, HeightsAreMetresOfTheWorld) {
    expect_near(normal_on_square(ramp_mirror({}), squeezed()), normalize(Vec3(-1, 0.25f, 1)), 1e-5f);
    expect_near(normal_on_square(slanted_mirror()), normalize(Vec3(-1, -1, 3)), 1e-5f);
    expect_near(normal_on_square(slanted_mirror(), squeezed()), normalize(Vec3(-2, 1, 3)), 1e-5f);
}

TEST(Bump, IsTheSameReliefFromBehind) {
    const Vec3 front = normal_on_square(ramp_mirror({}));
    expect_near(normal_on_square(ramp_mirror({}), {}, -1.0f), -front, 1e-6f);
    expect_near(normal_on_square(ramp_mirror({}), squeezed(), -1.0f),
                -normalize(Vec3(-1, 0.25f, 1)), 1e-5f);
}

TEST(Bump, RisesFromTheNormalThatItIsGiven) {
    BumpGraph b;
    const uint32_t normal = b.node("rgb", {{"Color", {0.6f, 0, 0.8f}}}),
                   image = b.node("image_texture", {}, {}, 0);
    b.link(normal, "Color", b.bump, "Normal").link(image, "Color", b.bump, "Height");
    // |dp_du x dp_dv . n| n - (dp_dv x n) h_u - (n x dp_du) h_v, by hand for h = x / 2 + y / 4
    const Vec3 n(0.6f, 0, 0.8f);
    const Vec3 gradient = cross(Vec3(0, 1, 0), n) * 0.5f + cross(n, Vec3(1, 0, 0)) * 0.25f;
    expect_near(normal_on_square(b.surface(b.glossy)), normalize(n * 0.8f - gradient), 1e-5f);
}

TEST(Bump, FlatHeightsAreNoBumps) {
    for (const Constants& constants : {Constants{}, Constants{{"Height", {3}}}}) {
        BumpGraph b(constants);
        const Material material = compile(b.surface(b.glossy), {});
        EXPECT_FALSE(material.specular.mapped_normal);
        EXPECT_EQ(material.reads, 0u);
    }
    const std::vector<Image> images{ramp()};
    EXPECT_FALSE(compile(ramp_mirror({{"Strength", {0}}}), images).specular.mapped_normal);
    const Material bumped = compile(ramp_mirror({}), images);
    EXPECT_TRUE(bumped.specular.mapped_normal);
    EXPECT_EQ(bumped.height_reads, static_cast<uint32_t>(kReadsAttributes));
    EXPECT_NE(bumped.normal_reads & kReadsHeights, 0u);
    EXPECT_EQ(bumped.images, std::vector<uint32_t>{0});
}

TEST(Bump, HeightsHaveNoBumps) {
    BumpGraph b;
    const uint32_t inner = b.node("bump"), image = b.node("image_texture", {}, {}, 0);
    b.link(image, "Color", inner, "Height").link(inner, "Normal", b.bump, "Height");
    const std::vector<Image> images{ramp()};
    const Material material = compile(b.surface(b.glossy), images);
    EXPECT_FALSE(material.specular.mapped_normal);
    ASSERT_EQ(material.warnings.size(), 1u);
    EXPECT_NE(material.warnings[0].find("depends on another bump"), std::string::npos);
}

}  // namespace
}  // namespace spc::test
