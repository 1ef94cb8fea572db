// SPDX-License-Identifier: GPL-3.0-or-later
// In which normal maps glints are looked for, and why in others not.
#include "support/casters.h"

#include <gmock/gmock.h>

namespace spc {
namespace {

using ::testing::HasSubstr;

std::vector<Image> images() {
    const std::vector<uint8_t> bytes(12, 200);
    return {test::normal_image(4, 4, [](double, double) { return Vec2(0.1f, 0.0f); }),
            image_from_bytes("colour", bytes, 2, 2, 3, ColorSpace::srgb, AlphaMode::none)};
}

Graph glossy(float roughness, GlintsMode mode = GlintsMode::on) {
    Graph graph = test::normal_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {roughness, 0, 0, 0}}}), {2, 3});
    graph.glints = mode;
    return graph;
}

Material compiled(const Graph& graph) {
    static const std::vector<Image> kImages = images();
    return compile(graph, kImages);
}

TEST(SlopeMap, IsANormalMapOnAnAffineUvMap) {
    Graph graph = glossy(0.2f, GlintsMode::automatic);
    graph.inputs.push_back({4, "Location", {0.25f, -1, 0, 0}});
    graph.inputs.push_back({2, "Strength", {0.5f, 0, 0, 0}});
    graph.options.push_back({2, "uv_map", "Other"});
    const Material material = compiled(graph);
    const SlopeMap& map = material.slopes;
    EXPECT_EQ(map.image, 0u);
    EXPECT_EQ(material.attributes[map.uv_layer].name, "");
    EXPECT_EQ(material.attributes[map.tangent_layer].name, "Other");
    EXPECT_FLOAT_EQ(map.strength, 0.5f);
    EXPECT_EQ(map.to_image[0], Vec2(2, 0));
    EXPECT_EQ(map.to_image[1], Vec2(0, 3));
    EXPECT_EQ(map.offset, Vec2(0.25f, -1));
    EXPECT_EQ(map.why, "Glossy BSDF, roughness 0.2");
    EXPECT_EQ(map.why_not, "");
}

Graph bumped(GlintsMode mode = GlintsMode::on) {
    Graph graph = test::bump_mapped(
        test::single_shader("bsdf_glossy", {{1, "Roughness", {0.2f, 0, 0, 0}}}), {2, 3}, 0.3f);
    graph.glints = mode;
    return graph;
}

// However its image would be filtered elsewhere.
TEST(SlopeMap, IsAHeightMapOnAnAffineUvMap) {
    Graph graph = bumped(GlintsMode::automatic);
    graph.inputs.push_back({2, "Strength", {0.5f, 0, 0, 0}});
    graph.options.push_back({2, "invert", "True"});
    graph.options.push_back({3, "interpolation", "Closest"});
    const Material material = compiled(graph);
    const SlopeMap& map = material.slopes;
    EXPECT_EQ(map.relief, Relief::heights);
    EXPECT_EQ(map.image, 0u);
    EXPECT_EQ(material.attributes, (std::vector<AttributeName>{{AttributeKind::uv, ""}}));
    EXPECT_EQ(material.reads & kReadsTangent, 0u);
    EXPECT_FLOAT_EQ(map.strength, 0.5f);
    EXPECT_FLOAT_EQ(map.distance, -0.3f);
    EXPECT_EQ(map.to_image[0], Vec2(2, 0));
    EXPECT_EQ(map.to_image[1], Vec2(0, 3));
    EXPECT_EQ(map.why, "Glossy BSDF, roughness 0.2");
    EXPECT_EQ(compiled(bumped(GlintsMode::off)).slopes.image, kNone);
}

TEST(SlopeMap, SaysWhyNotOfABump) {
    const auto link = [](const char* node_kind, const char* out, const char* socket) {
        Graph graph = bumped();
        const auto node = static_cast<uint32_t>(graph.nodes.size());
        graph.nodes.push_back(
            {"New", node_kind, std::string(node_kind) == "image_texture" ? 0 : kNone});
        std::erase_if(graph.links,
                      [&](const GraphLink& l) { return l.to_node == 2 && l.to_socket == socket; });
        graph.links.push_back({node, out, 2, socket});
        return graph;
    };
    const auto constant = [](const char* socket, float value) {
        Graph graph = bumped();
        std::erase_if(graph.inputs, [&](const GraphInput& input) {
            return input.node == 2 && input.socket == socket;
        });
        graph.inputs.push_back({2, socket, {value, 0, 0, 0}});
        return graph;
    };
    Graph extended = bumped(), colour = bumped(), elsewhere = bumped();
    extended.options.push_back({3, "extension", "EXTEND"});
    colour.nodes[3].image = 1;
    for (GraphLink& l : elsewhere.links)
        if (l.to_node == 4) l.from_socket = "Object";
    const std::pair<Graph, const char*> cases[] = {
        {link("normal_map", "Normal", "Normal"), "its bump rises from another normal"},
        {link("image_texture", "Alpha", "Strength"), "the strength of its bump varies"},
        {link("image_texture", "Alpha", "Distance"), "the distance of its bump varies"},
        {link("image_texture", "Alpha", "Height"),
         "its height is not the colour of an image alone"},
        {constant("Strength", 1.5f), "the strength of its bump is above 1"},
        {constant("Distance", 0.0f), "the distance of its bump is 0"},
        {extended, "its height map is not repeated"},
        {colour, "its height map is not Non-Color data"},
        {elsewhere, "its height map is not placed by a UV map"}};
    for (const auto& [graph, why_not] : cases) {
        const SlopeMap map = compiled(graph).slopes;
        EXPECT_EQ(map.image, kNone) << why_not;
        EXPECT_THAT(map.why_not, HasSubstr(why_not));
    }
}

TEST(SlopeMap, PrincipledGlintsInItsReflections) {
    Graph graph = test::normal_mapped(test::principled(0.5f, 0.3f), {1, 1});
    const SlopeMap map = compiled(graph).slopes;
    EXPECT_EQ(map.image, 0u);
    EXPECT_THAT(map.why, HasSubstr("(metal), roughness 0.3; "));
    EXPECT_THAT(map.why, HasSubstr("(specular), roughness 0.3"));
}

// A coat glints by its own normal, or with what lies below by the same one.
TEST(SlopeMap, Coats) {
    const Graph metal = test::normal_mapped(test::principled(1.0f, 0.3f), {1, 1});
    EXPECT_EQ(compiled(test::coated(metal, 0.1f, true)).slopes.why,
              "Principled BSDF (metal), roughness 0.3; Principled BSDF (coat), roughness 0.1");
    EXPECT_EQ(compiled(test::coated(metal, 0.1f, false)).slopes.why,
              "Principled BSDF (metal), roughness 0.3");
    Graph varnish = test::coated(metal, 0.1f, true);
    std::erase_if(varnish.links, [](const GraphLink& link) { return link.to_socket == "Normal"; });
    EXPECT_EQ(compiled(varnish).slopes.why, "Principled BSDF (coat), roughness 0.1");
    EXPECT_EQ(compiled(test::coated(metal, 0.0f, true)).slopes.why,
              "Principled BSDF (metal), roughness 0.3");
}

TEST(SlopeMap, AutomaticTakesNarrowLobesAlone) {
    EXPECT_EQ(compiled(glossy(0.3f, GlintsMode::automatic)).slopes.image, 0u);
    for (const float roughness : {0.0f, 0.5f})
        EXPECT_EQ(compiled(glossy(roughness, GlintsMode::automatic)).slopes.image, kNone);
    EXPECT_EQ(compiled(glossy(0.5f, GlintsMode::on)).slopes.image, 0u);
    EXPECT_EQ(compiled(glossy(0.3f, GlintsMode::off)).slopes.image, kNone);
}

// Asked for, a material without glints says why; else it is silent.
TEST(SlopeMap, SaysWhyNot) {
    const auto with = [](const char* node_kind, const char* out, int to, const char* socket) {
        Graph graph = glossy(0.2f);
        const auto node = static_cast<uint32_t>(graph.nodes.size());
        graph.nodes.push_back(
            {"New", node_kind, std::string(node_kind) == "image_texture" ? 0 : kNone});
        std::erase_if(graph.links, [&](const GraphLink& link) {
            return link.to_node == uint32_t(to) && link.to_socket == socket;
        });
        graph.links.push_back({node, out, uint32_t(to), socket});
        return graph;
    };
    const auto option = [](uint32_t node, const char* name, const char* value) {
        Graph graph = glossy(0.2f);
        graph.options.push_back({node, name, value});
        return graph;
    };
    Graph flat = glossy(0.2f), colour = glossy(0.2f), none = glossy(0.2f);
    flat.inputs.push_back({2, "Strength", {0, 0, 0, 0}});
    colour.nodes[3].image = 1;
    std::erase_if(none.links, [](const GraphLink& link) { return link.to_socket == "Normal"; });
    Graph diffuse = test::normal_mapped(test::diffuse(0.5f), {1, 1});
    diffuse.glints = GlintsMode::on;
    const std::pair<Graph, const char*> cases[] = {
        {glossy(0.0f), "Glossy BSDF: roughness 0"},
        {none, "Glossy BSDF: no normal map or bump"},
        {with("texture_coordinate", "Normal", 1, "Normal"),
         "its normal is not a Normal Map or Bump node"},
        {option(2, "space", "OBJECT"), "its normal map is not in tangent space"},
        {with("image_texture", "Alpha", 2, "Strength"), "the strength of its normal map varies"},
        {flat, "the strength of its normal map is 0"},
        {with("texture_coordinate", "UV", 2, "Color"), "its normal map is not an image alone"},
        {option(3, "interpolation", "Cubic"), "its normal map is not interpolated linearly"},
        {option(3, "extension", "EXTEND"), "its normal map is not repeated"},
        {colour, "its normal map is not Non-Color data"},
        {with("texture_coordinate", "Object", 3, "Vector"), "not placed by a UV map"},
        {diffuse, "no glossy closure"}};
    for (Graph graph : {cases[0].first, cases[3].first}) {
        graph.glints = GlintsMode::automatic;
        EXPECT_EQ(compiled(graph).slopes.why_not, "");
    }
    for (const auto& [graph, why_not] : cases) {
        const SlopeMap map = compiled(graph).slopes;
        EXPECT_EQ(map.image, kNone) << why_not;
        EXPECT_THAT(map.why_not, HasSubstr(why_not));
    }
}

// The first lobe's normal decides.
TEST(SlopeMap, LobesWithOtherNormalsStayAsTheyAre) {
    Graph graph = glossy(0.2f, GlintsMode::automatic);
    graph.nodes.push_back({"Coat", "bsdf_glossy", kNone});
    graph.nodes.push_back({"Both", "add_shader", kNone});
    graph.inputs.push_back({6, "Roughness", {0.1f, 0, 0, 0}});
    std::erase_if(graph.links, [](const GraphLink& link) { return link.to_node == 0; });
    graph.links.insert(
        graph.links.end(),
        {{7, "Shader", 0, "Surface"}, {1, "BSDF", 7, "Shader"}, {6, "BSDF", 7, "Shader_001"}});
    const SlopeMap map = compiled(graph).slopes;
    EXPECT_EQ(map.image, 0u);
    EXPECT_EQ(map.why, "Glossy BSDF, roughness 0.2");
}

}  // namespace
}  // namespace spc
