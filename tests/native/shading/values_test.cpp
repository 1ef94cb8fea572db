// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that give values, against values by hand.
#include "shading/graphs.h"

namespace spc::test {
namespace {

Image ramp() {  // red by u, green by v, blue 0.25, alpha 0.5; 4 x 4
    std::vector<float> texels;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const float fx = (static_cast<float>(x) + 0.5f) / 4,
                        fy = (static_cast<float>(y) + 0.5f) / 4;
            texels.insert(texels.end(), {fx, fy, 0.25f, 0.5f});
        }
    return image_from_floats("ramp", texels, 4, 4, 4, ColorSpace::linear, AlphaMode::premultiplied);
}

Vec3 mapped(const std::string& type, const Vec3& location, const Vec3& rotation, const Vec3& scale,
            bool fold) {
    const auto list = [](const Vec3& v) { return std::vector<float>{v.x, v.y, v.z}; };
    TestPoint at;
    GraphBuilder b;
    const uint32_t mapping = b.node(
        "mapping", {{"Location", list(location)}, {"Scale", list(scale)}}, {{"vector_type", type}});
    b.link(b.node("texture_coordinate"), "Object", mapping, "Vector");  // (1, 2, 3)
    if (fold) {
        b.graph.inputs.push_back({mapping, "Rotation", {rotation.x, rotation.y, rotation.z, 0}});
    } else {
        // The same rotation as something that varies: position minus a constant.
        const uint32_t move = b.node("mapping", {{"Location", list(rotation - Vec3(1, 2, 3))}});
        b.link(b.node("texture_coordinate"), "Object", move, "Vector");
        b.link(move, "Vector", mapping, "Rotation");
    }
    return value_of_graph(b, mapping, "Vector", at.point);
}

TEST(Values, MappingTypes) {
    const float quarter = 0.5f * kPi;
    for (bool fold : {true, false}) {
        // About Z by 90 degrees: (x, y, z) -> (-y, x, z).
        expect_near(mapped("POINT", {10, 0, 0}, {0, 0, quarter}, {2, 1, 1}, fold), {8, 2, 3}, 1e-5f);
        expect_near(mapped("VECTOR", {10, 0, 0}, {0, 0, quarter}, {2, 1, 1}, fold), {-2, 2, 3},
                    1e-5f);
        expect_near(mapped("TEXTURE", {0, 1, 0}, {0, 0, quarter}, {2, 4, 0}, fold),
                    {0.5f, -0.25f, 0}, 1e-5f);
        expect_near(mapped("NORMAL", {10, 0, 0}, {0, 0, quarter}, {0.5f, 1, 3}, fold),
                    Vec3(-2, 2, 1) / 3.0f, 1e-5f);
        // X first: (1, 2, 3) -> (1, -3, 2), then about Y by 90: (x, y, z) -> (z, y, -x).
        expect_near(mapped("POINT", {0, 0, 0}, {quarter, quarter, 0}, {1, 1, 1}, fold), {2, -3, -1},
                    1e-5f);
        expect_near(mapped("TEXTURE", {0, 0, 0}, {quarter, quarter, 0}, {1, 1, 1}, fold),
                    {-3, 1, -2}, 2e-5f);
    }
}

TEST(Values, Conversions) {
    TestPoint at;
    const auto strength = [&](const std::string& kind, const Constants& constants,
                              const std::string& socket) {
        GraphBuilder b;
        const uint32_t emission = b.node("emission");
        b.link(b.node(kind, constants), socket, emission, "Strength");
        return evaluate_emission(compile(b.surface(emission, "Emission"), {}), {}, at.point).x;
    };
    EXPECT_NEAR(strength("rgb", {{"Color", {0.2f, 0.4f, 0.8f}}}, "Color"),
                0.2126729f * 0.2f + 0.7151522f * 0.4f + 0.072175f * 0.8f, 1e-6f);
    EXPECT_NEAR(strength("mapping", {{"Vector", {1, 2, 6}}}, "Vector"), 3.0f, 1e-6f);
    EXPECT_NEAR(strength("texture_coordinate", {}, "Object"), 2.0f, 1e-6f);
    EXPECT_NEAR(strength("value", {{"Value", {7}}}, "Value"), 7.0f, 1e-6f);
    GraphBuilder b;
    expect_near(value_of_graph(b, b.node("value", {{"Value", {0.3f}}}), "Value", at.point),
                Vec3(0.3f), 0.0f);
    GraphBuilder vector;  // a vector is a colour as it is
    expect_near(value_of_graph(vector, vector.node("uv_map"), "UV", at.point), {0.25f, 0.75f, 0},
                0.0f);
    GraphBuilder direct;  // a colour in place of a shader is an emission
    const Material material =
        compile(direct.surface(direct.node("rgb", {{"Color", {1, 2, 3}}}), "Color"), {});
    expect_near(Vec3(evaluate_emission(material, {}, at.point)), {1, 2, 3}, 0.0f);
}

TEST(Values, TextureCoordinates) {
    TestPoint at;
    Transform transform;  // scales x by 2, moves
    transform.row[0] = Vec3(2, 0, 0);
    transform.translation = Vec3(0, 0, 5);
    at.set(transform);
    const Vec3 n = normalize(Vec3(0.5f, 0, 1));
    at.point.normal = to_vector(n);
    const auto get = [&](const std::string& socket) {
        GraphBuilder b;
        return value_of_graph(b, b.node("texture_coordinate"), socket, at.point);
    };
    expect_near(get("Object"), {1, 2, 3}, 0.0f);
    expect_near(get("Generated"), {0.25f, 0.75f, 0}, 0.0f);  // the first attribute
    expect_near(get("UV"), {0.25f, 0.75f, 0}, 0.0f);
    expect_near(get("Normal"), normalize(Vec3(1, 0, 1)), 1e-6f);
    at.point.backfacing = true;
    expect_near(get("Normal"), -normalize(Vec3(1, 0, 1)), 1e-6f);
}

TEST(Values, ImageTexture) {
    const std::vector<Image> images{ramp()};
    TestPoint at;
    GraphBuilder b;
    expect_near(value_of_graph(b, b.node("image_texture", {}, {{"extension", "EXTEND"}}, 0),
                               "Color", at.point, images),
                {0.25f, 0.75f, 0.25f}, 1e-6f);
    GraphBuilder alpha;
    expect_near(
        value_of_graph(alpha, alpha.node("image_texture", {}, {}, 0), "Alpha", at.point, images),
        Vec3(0.5f), 1e-6f);

    // The alpha used as well: the colour comes without it.
    GraphBuilder both;
    const uint32_t image = both.node("image_texture", {}, {{"interpolation", "Closest"}}, 0),
                   emission = both.node("emission");
    both.link(image, "Color", emission, "Color").link(image, "Alpha", emission, "Strength");
    const Material material = compile(both.surface(emission, "Emission"), images);
    expect_near(Vec3(evaluate_emission(material, images, at.point)), Vec3(0.375f, 0.875f, 0.25f),
                1e-6f);
    EXPECT_EQ(material.reads, static_cast<uint32_t>(kReadsAttributes));

    GraphBuilder clip;
    const uint32_t move = clip.node("mapping", {{"Location", {2, 0, 0}}});
    const uint32_t texture = clip.node("image_texture", {}, {{"extension", "CLIP"}}, 0);
    clip.link(clip.node("texture_coordinate"), "UV", move, "Vector")
        .link(move, "Vector", texture, "Vector");
    expect_near(value_of_graph(clip, texture, "Color", at.point, images), Vec3(0.0f), 0.0f);
}

TEST(Values, UvLayersByName) {
    TestPoint at;
    GraphBuilder b;
    const uint32_t add = b.node("add_shader");
    for (const char* layer : {"", "Second"}) {
        const uint32_t emission = b.node("emission");
        b.link(b.node("uv_map", {}, {{"uv_map", layer}}), "UV", emission, "Color");
        b.link(emission, "Emission", add, *layer ? "Shader_001" : "Shader");
    }
    const Material material = compile(b.surface(add, "Shader"), {});
    ASSERT_EQ(material.attributes.size(), 2u);
    std::array<float, 4> uv[2];
    for (size_t i = 0; i < 2; ++i)
        uv[i] = material.attributes[i].name.empty() ? std::array{0.1f, 0.2f, 0.0f, 1.0f}
                                                    : std::array{10.0f, 20.0f, 0.0f, 1.0f};
    at.point.attributes = uv;
    expect_near(Vec3(evaluate_emission(material, {}, at.point)), {10.1f, 20.2f, 0}, 1e-5f);
}

TEST(Values, AttributesByKindAndName) {
    TestPoint at;
    const Options tint{{"attribute_type", "OBJECT"}, {"attribute_name", "tint"}};
    at.attributes[0] = {0.1f, 0.2f, 0.6f, 0.4f};
    const auto get = [&](const std::string& socket) {
        GraphBuilder b;
        return value_of_graph(b, b.node("attribute", {}, tint), socket, at.point);
    };
    expect_near(get("Color"), {0.1f, 0.2f, 0.6f}, 0.0f);
    expect_near(get("Fac"), Vec3(0.3f), 1e-6f);
    expect_near(get("Alpha"), Vec3(0.4f), 0.0f);
    GraphBuilder b;
    const uint32_t emission = b.node("emission");
    b.link(b.node("attribute", {}, tint), "Color", emission, "Color");
    const Material material = compile(b.surface(emission, "Emission"), {});
    ASSERT_EQ(material.attributes.size(), 1u);
    EXPECT_EQ(material.attributes[0], (AttributeName{AttributeKind::object, "tint"}));
}

TEST(Values, AttributesAnswerByNameOrKind) {
    using enum AttributeKind;
    const AttributeName active{uv, "first"}, other{named, "second"}, tint{object, "second"};
    EXPECT_TRUE(active.answers({uv, ""}));
    EXPECT_TRUE(active.answers({named, "first"}));
    EXPECT_FALSE(active.answers({uv, "second"}));
    EXPECT_TRUE(other.answers({uv, "second"}));
    EXPECT_TRUE(other.answers({color, "second"}));
    EXPECT_FALSE(other.answers({uv, ""}));
    EXPECT_FALSE(other.answers({named, ""}));
    EXPECT_FALSE(tint.answers({named, "second"}));
    EXPECT_FALSE(tint.answers({instancer, "second"}));
    EXPECT_TRUE(tint.answers({object, "second"}));
}

TEST(Values, LightPathTellsOfTheRay) {
    TestPoint at;
    at.point.ray = {.kinds = kRayGlossy | kRayTransmission,
                    .length = 2.5f,
                    .depth = 7,
                    .diffuse_depth = 1,
                    .glossy_depth = 2,
                    .transparent_depth = 3,
                    .transmission_depth = 4};
    const std::pair<const char*, float> outputs[] = {
        {"Is Camera Ray", 0},       {"Is Shadow Ray", 0},         {"Is Diffuse Ray", 0},
        {"Is Glossy Ray", 1},       {"Is Singular Ray", 0},       {"Is Reflection Ray", 0},
        {"Is Transmission Ray", 1}, {"Is Volume Scatter Ray", 0}, {"Ray Length", 2.5f},
        {"Ray Depth", 7},           {"Diffuse Depth", 1},         {"Glossy Depth", 2},
        {"Transparent Depth", 3},   {"Transmission Depth", 4},    {"Portal Depth", 0}};
    for (const auto& [socket, value] : outputs) {
        SCOPED_TRACE(socket);
        GraphBuilder b;
        expect_near(value_of_graph(b, b.node("light_path"), socket, at.point), Vec3(value), 0.0f);
    }
    GraphBuilder b;
    const uint32_t falloff = b.node("light_falloff", {{"Strength", {3}}, {"Smooth", {0.5f}}});
    const float smooth = 3.0f * 6.25f / 6.75f;
    expect_near(value_of_graph(b, falloff, "Constant", at.point), Vec3(smooth * 6.25f), 1e-4f);
}

// An emission may depend on the ray: nothing but path tracing asks for it.
TEST(Values, WhatDependsOnTheRayCastsNothing) {
    GraphBuilder b;
    const uint32_t mix = b.node("mix_shader"), path = b.node("light_path");
    b.link(path, "Is Shadow Ray", mix, "Fac")
        .link(b.node("bsdf_glass"), "BSDF", mix, "Shader")
        .link(b.node("bsdf_transparent"), "BSDF", mix, "Shader_001");
    const Material mixed = compile(b.surface(mix, "Shader"), {});
    EXPECT_TRUE(mixed.depends_on_ray);
    EXPECT_FALSE(mixed.specular.exists());
    EXPECT_EQ(mixed.specular.why_not, "its look depends on the kind of ray");

    GraphBuilder glow;
    const uint32_t add = glow.node("add_shader"), emission = glow.node("emission");
    glow.link(glow.node("light_path"), "Is Camera Ray", emission, "Strength")
        .link(emission, "Emission", add, "Shader")
        .link(glow.node("bsdf_glass"), "BSDF", add, "Shader_001");
    const Material glowing = compile(glow.surface(add, "Shader"), {});
    EXPECT_FALSE(glowing.depends_on_ray);
    EXPECT_TRUE(glowing.specular.exists());
}

TEST(Values, SpacesOfTheCameraAndTheObject) {
    TestPoint at;
    Transform to_world;
    to_world.row = {Vec3(0, 0, 2), Vec3(1, 0, 0), Vec3(0, 3, 0)};
    to_world.translation = Vec3(1, 2, 3);
    at.set(to_world);
    ViewSpace view;  // at (0, 0, 10), looking down
    view.to_world.row = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, -1)};
    view.to_world.translation = Vec3(0, 0, 10);
    view.from_world = view.to_world.inverse();
    view.viewplane = {-1, 1, -0.5f, 0.5f};
    view.origin = Vec3(5, 0, 0);  // the scene's own coordinates are shifted against the host's
    at.point.view = &view;
    at.point.position = {2, 1, 6};
    const auto coordinate = [&](const char* socket) {
        GraphBuilder b;
        return value_of_graph(b, b.node("texture_coordinate"), socket, at.point);
    };
    expect_near(coordinate("Camera"), {2, 1, 4}, 1e-6f);
    expect_near(coordinate("Window"), {0.75f, 0.75f, 0}, 1e-6f);
    const auto transformed = [&](const char* meaning, const char* from, const char* to) {
        GraphBuilder b;
        const uint32_t node =
            b.node("vector_transform", {{"Vector", {1, 2, 3}}},
                   {{"vector_type", meaning}, {"convert_from", from}, {"convert_to", to}});
        return value_of_graph(b, node, "Vector", at.point);
    };
    expect_near(transformed("VECTOR", "OBJECT", "WORLD"), {6, 1, 6}, 1e-6f);
    expect_near(transformed("POINT", "OBJECT", "WORLD"), {12, 3, 9}, 1e-6f);
    expect_near(transformed("NORMAL", "OBJECT", "WORLD"), normalize(Vec3(1.5f, 1, 2.0f / 3.0f)),
                1e-6f);
    expect_near(transformed("POINT", "WORLD", "CAMERA"), {1, 2, 7}, 1e-6f);
    expect_near(transformed("POINT", "OBJECT", "CAMERA"), {12, 3, 1}, 1e-5f);
    expect_near(transformed("VECTOR", "CAMERA", "CAMERA"), {1, 2, 3}, 0.0f);
    for (const char* meaning : {"VECTOR", "POINT"}) {  // there and back
        GraphBuilder b;
        const uint32_t out =
            b.node("vector_transform", {{"Vector", {1, 2, 3}}},
                   {{"vector_type", meaning}, {"convert_from", "WORLD"}, {"convert_to", "OBJECT"}});
        const uint32_t back =
            b.node("vector_transform", {},
                   {{"vector_type", meaning}, {"convert_from", "OBJECT"}, {"convert_to", "WORLD"}});
        b.link(out, "Vector", back, "Vector");
        expect_near(value_of_graph(b, back, "Vector", at.point), {1, 2, 3}, 1e-5f);
    }
}

TEST(Values, TilesAreImagesOfTheirOwn) {
    std::vector<Image> images;
    for (const float grey : {0.2f, 0.4f})
        images.push_back(image_from_floats("tile", std::vector<float>{grey}, 1, 1, 1,
                                           ColorSpace::linear, AlphaMode::none));
    TestPoint at;
    const auto texel = [&](float last_image) {
        GraphBuilder b;
        const uint32_t texture = b.node("image_texture", {}, {}, 0);
        b.graph.arrays.push_back({texture, "Tiles", {0, 0, 11, last_image}});
        return value_of_graph(b, texture, "Color", at.point, images);
    };
    const std::pair<std::array<float, 2>, Vec3> seen[] = {{{0.5f, 0.5f}, Vec3(0.2f)},
                                                          {{1.5f, 1.5f}, Vec3(0.4f)},
                                                          {{1.5f, 0.5f}, Vec3(1, 0, 1)},
                                                          {{-0.5f, 1.5f}, Vec3(1, 0, 1)}};
    for (const auto& [uv, color] : seen) {
        at.attributes[0] = {uv[0], uv[1], 0, 1};
        expect_near(texel(1), color, 1e-6f);
    }
    EXPECT_THROW(texel(2), Error);
}

// One texel coloured by where it lies: what a direction sees.
Vec3 environment(const Vec3& direction, const std::string& projection, uint32_t width,
                 uint32_t height) {
    std::vector<float> texels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            texels.insert(texels.end(), {static_cast<float>(x), static_cast<float>(y), 0.0f});
    const std::vector<Image> images{
        image_from_floats("e", texels, width, height, 3, ColorSpace::linear, AlphaMode::none)};
    GraphBuilder b;
    const uint32_t background = b.node("background");
    b.link(b.node("environment_texture", {},
                  {{"projection", projection}, {"interpolation", "Closest"}}, 0),
           "Color", background, "Color");
    const Material material = compile(b.surface(background, "Background"), images);
    EXPECT_TRUE(material.is_background);
    return Vec3(evaluate_background(material, images, direction));
}

TEST(Values, EnvironmentOrientation) {
    // Blender: +X in the middle, +Y a quarter to the left, -Y to the right, +Z on top.
    const auto at = [](const Vec3& d) { return environment(normalize(d), "EQUIRECTANGULAR", 8, 4); };
    expect_near(at({1, -0.1f, 0.1f}), {4, 2, 0}, 0.0f);
    expect_near(at({1, 0.1f, -0.1f}), {3, 1, 0}, 0.0f);
    expect_near(at({0.1f, 1, 0.1f}), {2, 2, 0}, 0.0f);
    expect_near(at({0.1f, -1, 0.1f}), {5, 2, 0}, 0.0f);
    expect_near(at({-1, 0.1f, 0.1f}), {0, 2, 0}, 0.0f);
    expect_near(at({-1, -0.1f, 0.1f}), {7, 2, 0}, 0.0f);
    EXPECT_EQ(at({0.01f, 0, 1}).y, 3.0f);
    EXPECT_EQ(at({0.01f, 0, -1}).y, 0.0f);
    // A mirror ball seen along +Y: its middle reflects -Y, its rim +Y.
    const auto ball = [](const Vec3& d) { return environment(normalize(d), "MIRROR_BALL", 9, 9); };
    expect_near(ball({0, -1, 0}), {4, 4, 0}, 0.0f);
    EXPECT_EQ(ball({0.2f, 1, 0}).x, 8.0f);
    EXPECT_EQ(ball({0, 1, 0.2f}).y, 8.0f);
    EXPECT_EQ(ball({1, -1, 0}).x, 6.0f);  // half-vector of (1, -1) and (0, -1): x = sin 22.5 = 0.38
}

TEST(Values, BackgroundCoordinatesAreTheDirection) {
    const Vec3 d = normalize(Vec3(1, 2, 3));
    for (const auto& [socket, expected] :
         {std::pair("Generated", d), {"Object", d}, {"Normal", -d}}) {
        GraphBuilder b;
        const uint32_t background = b.node("background", {{"Strength", {2}}});
        b.link(b.node("texture_coordinate"), socket, background, "Color");
        expect_near(
            Vec3(evaluate_background(compile(b.surface(background, "Background"), {}), {}, d)),
            expected * 2.0f, 1e-6f);
    }
}

}  // namespace
}  // namespace spc::test
