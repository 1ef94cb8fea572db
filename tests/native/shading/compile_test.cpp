// SPDX-License-Identifier: GPL-3.0-or-later
// Compilation: what is refused, what is folded away, what the manifold may walk on.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "shading/graphs.h"

namespace spc::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(const Graph& graph, std::span<const Image> images = {}) {
    try {
        compile(graph, images);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::invalid_argument);
        return error.what();
    }
    ADD_FAILURE() << "compiled";
    return "";
}
auto names(const std::string& node, const std::string& socket = "") {
    return AllOf(HasSubstr("material \"Mat\""), HasSubstr("node \"" + node + "\""),
                 HasSubstr(socket.empty() ? "" : "socket \"" + socket + "\""));
}
std::vector<Image> one_image() {
    return {image_from_floats("i", std::vector<float>{1, 1, 1}, 1, 1, 3, ColorSpace::linear,
                              AlphaMode::none)};
}

TEST(CompileErrors, NameMaterialNodeAndSocket) {
    EXPECT_THAT(error_of(single("bsdf_velvet")),
                AllOf(names("bsdf_velvet.0"), HasSubstr("unknown kind")));
    EXPECT_THAT(error_of(single("bsdf_diffuse", {{"Colour", {1, 1, 1}}})),
                AllOf(names("bsdf_diffuse.0", "Colour"), HasSubstr("Color, Roughness, Normal")));
    EXPECT_THAT(error_of(single("bsdf_diffuse", {{"Color", {1, kInfinity, 1}}})),
                AllOf(names("bsdf_diffuse.0", "Color"), HasSubstr("not finite")));
    EXPECT_THAT(error_of(single("bsdf_diffuse", {{"Normal", {0, 0, 1}}})),
                names("bsdf_diffuse.0", "Normal"));
    EXPECT_THAT(error_of(single("bsdf_diffuse", {{"Color", {1, 1, 1}}, {"Color", {1, 1, 1}}})),
                AllOf(names("bsdf_diffuse.0", "Color"), HasSubstr("two")));
    EXPECT_THAT(error_of(single("bsdf_glossy", {}, {{"distribution", "PHONG"}})),
                AllOf(names("bsdf_glossy.0"), HasSubstr("distribution"),
                      HasSubstr("GGX|BECKMANN|MULTI_GGX")));
    EXPECT_THAT(error_of(single("bsdf_glossy", {}, {{"model", "GGX"}})),
                AllOf(names("bsdf_glossy.0"), HasSubstr("\"model\"")));
    EXPECT_THAT(error_of(single("bsdf_diffuse", {}, {}, "Shader")),
                names("bsdf_diffuse.0", "Shader"));
    GraphBuilder b;
    const uint32_t diffuse = b.node("bsdf_diffuse"), glossy = b.node("bsdf_glossy");
    b.link(glossy, "BSDF", diffuse, "Color");
    EXPECT_THAT(error_of(b.surface(diffuse)),
                AllOf(names("bsdf_diffuse.0", "Color"), HasSubstr("shader is linked to a color")));
}

TEST(CompileErrors, Structure) {
    GraphBuilder none;
    none.node("bsdf_diffuse");
    EXPECT_THAT(error_of(none.graph), AllOf(HasSubstr("\"Mat\""), HasSubstr("no output")));
    Graph two = single("bsdf_diffuse");
    two.nodes.push_back({"Second", "output", kNone});
    EXPECT_THAT(error_of(two), names("Second"));

    Graph index = single("bsdf_diffuse");
    index.links.push_back({7, "BSDF", 1, "Surface"});
    EXPECT_THAT(error_of(index), AllOf(HasSubstr("\"Mat\""), HasSubstr("node 7 of 2")));
    Graph twice = single("bsdf_diffuse");
    twice.links.push_back({0, "BSDF", 1, "Surface"});
    EXPECT_THAT(error_of(twice), AllOf(names("output.1", "Surface"), HasSubstr("two links")));

    for (const bool used : {true, false}) {
        GraphBuilder cycle;
        const uint32_t a = cycle.node("mapping"), c = cycle.node("mapping"),
                       diffuse = cycle.node("bsdf_diffuse");
        cycle.link(a, "Vector", c, "Vector").link(c, "Vector", a, "Scale");
        if (used) cycle.link(a, "Vector", diffuse, "Color");
        EXPECT_THAT(error_of(cycle.surface(diffuse)),
                    AllOf(names("mapping.0", "Scale"), HasSubstr("cycle")));
    }
}

TEST(CompileErrors, Images) {
    GraphBuilder b;
    const uint32_t diffuse = b.node("bsdf_diffuse"), image = b.node("image_texture");
    b.link(image, "Color", diffuse, "Color");
    EXPECT_THAT(error_of(b.surface(diffuse)),
                AllOf(names("image_texture.1"), HasSubstr("no image")));
    b.graph.nodes[image].image = 3;
    EXPECT_THAT(error_of(b.graph, one_image()),
                AllOf(names("image_texture.1"), HasSubstr("image 3 of 1")));
    GraphBuilder unused;  // what is not used may be incomplete
    unused.node("image_texture");
    EXPECT_NO_THROW(compile(unused.surface(unused.node("bsdf_diffuse")), {}));
}

TEST(CompileErrors, TooManyClosures) {
    const auto chain = [](int count) {
        GraphBuilder b;
        uint32_t top = b.node("bsdf_transparent");
        std::string socket = "BSDF";
        for (int i = 1; i < count; ++i) {
            const uint32_t add = b.node("add_shader");
            b.link(top, socket, add, "Shader")
                .link(b.node("bsdf_transparent"), "BSDF", add, "Shader_001");
            top = add;
            socket = "Shader";
        }
        return b.surface(top, socket);
    };
    EXPECT_EQ(closures_of(chain(kMaxClosures)).count, kMaxClosures);
    EXPECT_THAT(error_of(chain(kMaxClosures + 1)),
                AllOf(names("bsdf_transparent.2"), HasSubstr("13 closures; at most 12")));
}

// No depth of graph may exhaust the stack of the thread, no number of values the registers one at a
// time.
TEST(Compile, LongChainsAndManyTextures) {
    TestPoint at;
    GraphBuilder b;
    uint32_t last = b.node("texture_coordinate");
    b.link(last, "Object", b.node("mapping", {{"Location", {1, 0, 0}}}), "Vector");
    for (last = 1; last < 20000; ++last)
        b.link(last, "Vector", b.node("mapping", {{"Location", {1, 0, 0}}}), "Vector");
    expect_near(value_of_graph(b, last, "Vector", at.point), {20001, 2, 3}, 0.0f);

    GraphBuilder many;
    const std::vector<Image> images = one_image();
    uint32_t sum = many.node("emission", {{"Strength", {0}}});
    std::string socket = "Emission";
    for (int i = 0; i < 200; ++i) {
        const uint32_t move = many.node("mapping", {{"Location", {static_cast<float>(i), 0, 0}}});
        const uint32_t image = many.node("image_texture", {}, {}, 0),
                       emission = many.node("emission"), add = many.node("add_shader");
        many.link(many.node("uv_map"), "UV", move, "Vector").link(move, "Vector", image, "Vector");
        many.link(image, "Color", emission, "Color");
        many.link(sum, socket, add, "Shader").link(emission, "Emission", add, "Shader_001");
        sum = add;
        socket = "Shader";
    }
    const Material material = compile(many.surface(sum, socket), images);
    EXPECT_NEAR(evaluate_emission(material, images, at.point).x, 200, 1e-3f);
}

TEST(Compile, WhatComesToNothingIsNotRead) {
    const std::vector<Image> images = one_image();
    // A texture behind a weight, a strength or a factor of zero.
    const auto reads = [&](const std::string& kind, const Constants& constants,
                           const std::string& socket, const std::string& out) {
        GraphBuilder b;
        const uint32_t shader = b.node(kind, constants), image = b.node("image_texture", {}, {}, 0);
        b.link(image, "Color", shader, socket);
        const Material m = compile(b.surface(shader, out), images);
        EXPECT_EQ(m.attributes.empty(), m.reads == 0);
        return m.reads;
    };
    EXPECT_EQ(reads("bsdf_principled", {}, "Emission Color", "BSDF"), 0u);
    EXPECT_EQ(reads("bsdf_principled", {{"Metallic", {1}}}, "IOR", "BSDF"), 0u);
    EXPECT_EQ(reads("bsdf_principled", {{"Metallic", {1}}}, "Base Color", "BSDF"),
              static_cast<uint32_t>(kReadsAttributes));
    EXPECT_EQ(reads("emission", {{"Strength", {0}}}, "Color", "Emission"), 0u);
    EXPECT_EQ(reads("bsdf_glossy", {{"Color", {0, 0, 0}}}, "Roughness", "BSDF"), 0u);
    EXPECT_EQ(reads("bsdf_glossy", {}, "Roughness", "BSDF"),
              static_cast<uint32_t>(kReadsAttributes));
    // A mapping that changes nothing costs nothing, one of constants is a constant.
    GraphBuilder b;
    const uint32_t diffuse = b.node("bsdf_diffuse"),
                   mapping = b.node("mapping", {{"Vector", {1, 2, 3}}});
    b.link(mapping, "Vector", diffuse, "Color");
    EXPECT_EQ(compile(b.surface(diffuse), images).reads, 0u);
    EXPECT_EQ(compile(single("bsdf_principled"), {}).reads, 0u);
    // No shader at all: black.
    GraphBuilder empty;
    empty.node("output");
    const Material nothing = compile(empty.graph, {});
    EXPECT_FALSE(nothing.emits || nothing.has_smooth || nothing.may_be_transparent);
    TestPoint at;
    EXPECT_EQ(closures_of(nothing, at.point).count, 0);
}

// A material with a volume alone.
Material with_volume(GraphBuilder& b, uint32_t node, const char* socket,
                     std::span<const Image> images = {}) {
    b.link(node, socket, b.node("output"), "Volume");
    return compile(b.graph, images);
}
void expect_absorption(const Material& material, const Spectrum& sigma) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(material.absorption[c], sigma[c], 1e-6f);
    EXPECT_TRUE(material.warnings.empty());
}

TEST(CompileVolume, AbsorbsWhatItsColorsLeaveOut) {
    GraphBuilder plain;
    expect_absorption(
        with_volume(plain,
                    plain.node("volume_absorption", {{"Color", {1, 0.75f, 2}}, {"Density", {4}}}),
                    "Volume"),
        Spectrum(0.0f, 1.0f, 0.0f));
    GraphBuilder thin;
    expect_absorption(
        with_volume(thin, thin.node("volume_absorption", {{"Density", {-1}}}), "Volume"),
        Spectrum(0.0f));
    GraphBuilder principled;
    expect_absorption(
        with_volume(principled,
                    principled.node("volume_principled", {{"Color", {0, 0, 0}},
                                                          {"Density", {2}},
                                                          {"Absorption Color", {0, 0.25f, 1}}}),
                    "Volume"),
        Spectrum(2.0f, 1.0f, 0.0f));
}

TEST(CompileVolume, MixesAndAddsAsSurfacesDo) {
    GraphBuilder b;
    const uint32_t red = b.node("volume_absorption", {{"Color", {1, 0, 0}}, {"Density", {2}}}),
                   blue = b.node("volume_absorption", {{"Color", {0, 0, 1}}, {"Density", {4}}}),
                   mix = b.node("mix_shader", {{"Fac", {0.25f}}}), add = b.node("add_shader");
    b.link(red, "Volume", mix, "Shader").link(blue, "Volume", mix, "Shader_001");
    b.link(mix, "Shader", add, "Shader").link(blue, "Volume", add, "Shader_001");
    expect_absorption(with_volume(b, add, "Shader"), Spectrum(5.0f, 6.5f, 1.5f));
}

// Blender lets all shaders be linked to both; what has no effect there has none here, but says so.
TEST(CompileVolume, AndSurfaceAreApart) {
    GraphBuilder b;
    const uint32_t both = b.node("add_shader"), glass = b.node("bsdf_glass"),
                   medium = b.node("volume_absorption", {{"Color", {0, 0, 0}}});
    b.link(glass, "BSDF", both, "Shader").link(medium, "Volume", both, "Shader_001");
    const uint32_t out = b.node("output");
    b.link(both, "Shader", out, "Surface").link(both, "Shader", out, "Volume");
    const Material m = compile(b.graph, {});
    EXPECT_EQ(m.absorption, Spectrum(1.0f));
    EXPECT_TRUE(m.specular.refracts);
    EXPECT_THAT(m.warnings, testing::UnorderedElementsAre(
                                AllOf(names("volume_absorption.2"), HasSubstr("on a surface")),
                                AllOf(names("bsdf_glass.1"), HasSubstr("in a volume"))));
    GraphBuilder value;
    EXPECT_THAT(with_volume(value, value.node("rgb"), "Color").warnings,
                testing::ElementsAre(HasSubstr("in place of a volume")));
}

TEST(CompileVolume, WarnsOfWhatItCannotModel) {
    const std::vector<Image> images = {image_from_floats(
        "i", std::vector<float>{0.5f, 0.25f, 1}, 1, 1, 3, ColorSpace::linear, AlphaMode::none)};
    GraphBuilder textured;
    const uint32_t medium = textured.node("volume_absorption", {{"Density", {2}}});
    textured.link(textured.node("image_texture", {}, {}, 0), "Color", medium, "Color");
    const Material varies = with_volume(textured, medium, "Volume", images);
    EXPECT_EQ(varies.absorption, Spectrum(1.0f, 1.5f, 0.0f));
    EXPECT_THAT(varies.warnings, testing::ElementsAre(HasSubstr("its mean is used")));
    EXPECT_EQ(varies.reads, 0u);
    GraphBuilder foggy;
    const Material fog = with_volume(foggy, foggy.node("volume_principled"), "Volume");
    EXPECT_EQ(fog.absorption, Spectrum(0.5f));
    EXPECT_THAT(fog.warnings,
                testing::ElementsAre(AllOf(names("volume_principled.0"), HasSubstr("scattering"))));
}

TEST(Compile, NormalIsReadOnItsOwn) {
    const std::vector<Image> images = one_image();
    GraphBuilder b;
    const uint32_t glass = b.node("bsdf_glass"),
                   map = b.node("normal_map", {}, {{"space", "WORLD"}});
    const uint32_t color = b.node("image_texture", {}, {}, 0);
    b.link(b.node("texture_coordinate"), "Object", color, "Vector")
        .link(color, "Color", glass, "Color");
    b.link(map, "Normal", glass, "Normal").link(b.node("uv_map"), "UV", map, "Color");
    const Material m = compile(b.surface(glass), images);
    EXPECT_EQ(m.reads, static_cast<uint32_t>(kReadsAttributes | kReadsObjectPosition));
    EXPECT_EQ(m.normal_reads, static_cast<uint32_t>(kReadsAttributes));
}

SpecularInterface specular(const std::string& kind, const Constants& constants = {}) {
    return compile(single(kind, constants), {}).specular;
}

TEST(Specular, WhichClosuresAreInterfaces) {
    const SpecularInterface glass = specular("bsdf_glass", {{"IOR", {1.33f}}});
    EXPECT_TRUE(glass.reflects && glass.refracts);
    EXPECT_EQ(glass.ior, 1.33f);
    EXPECT_FALSE(glass.mapped_normal);
    EXPECT_EQ(glass.why, "Glass BSDF, roughness 0, IOR 1.33");
    EXPECT_EQ(glass.why_not, "");

    const SpecularInterface mirror = specular("bsdf_glossy", {{"Roughness", {0}}});
    EXPECT_TRUE(mirror.reflects && !mirror.refracts);
    const SpecularInterface refraction = specular("bsdf_refraction");
    EXPECT_TRUE(!refraction.reflects && refraction.refracts);
    EXPECT_EQ(refraction.ior, 1.45f);
    EXPECT_TRUE(specular("bsdf_principled", {{"Metallic", {1}}, {"Roughness", {0}}}).reflects);
    const SpecularInterface transmission =
        specular("bsdf_principled", {{"Transmission Weight", {1}}, {"Roughness", {0}}});
    EXPECT_TRUE(transmission.reflects && transmission.refracts);
    const SpecularInterface coat = specular("bsdf_principled", {{"Roughness", {0}}});
    EXPECT_TRUE(coat.reflects && !coat.refracts);
    EXPECT_EQ(coat.why, "Principled BSDF (specular), roughness 0, IOR 1.5");
    // What is stronger than a coat of another normal leads.
    const SpecularInterface varnish =
        specular("bsdf_principled", {{"Coat Weight", {1}}, {"Coat Roughness", {0}}});
    EXPECT_TRUE(varnish.reflects && !varnish.refracts);
    EXPECT_EQ(varnish.why, "Principled BSDF (coat), roughness 0, IOR 1.5");
    GraphBuilder b;
    const uint32_t chrome = b.node(
        "bsdf_principled",
        {{"Metallic", {1}}, {"Roughness", {0}}, {"Coat Weight", {1}}, {"Coat Roughness", {0}}});
    b.link(b.node("normal_map", {{"Color", {0.6f, 0.5f, 0.9f}}}), "Normal", chrome, "Normal");
    const Material mapped = compile(b.surface(chrome), {});
    EXPECT_EQ(mapped.specular.why, "Principled BSDF (metal), roughness 0, mapped normal");
    EXPECT_EQ(mapped.warnings.size(), 1u);
    // A black half is not there.
    const SpecularInterface black =
        specular("bsdf_principled",
                 {{"Transmission Weight", {1}}, {"Roughness", {0}}, {"Base Color", {0, 0, 0}}});
    EXPECT_TRUE(black.reflects && !black.refracts);
}

TEST(Specular, WhyNot) {
    const auto why_not = [](const SpecularInterface& s) {
        EXPECT_FALSE(s.reflects || s.refracts);
        return s.why_not;
    };
    EXPECT_EQ(why_not(specular("bsdf_diffuse")), "no specular closure");
    EXPECT_EQ(why_not(specular("bsdf_glass", {{"Roughness", {0.25f}}})),
              "Glass BSDF: roughness 0.25");
    EXPECT_EQ(
        why_not(specular("bsdf_principled", {{"Roughness", {0}}, {"Specular IOR Level", {0}}})),
        "no specular closure");
    for (const auto& [socket, reason] :
         {std::pair("Roughness", "roughness varies"), {"IOR", "IOR varies"}}) {
        GraphBuilder b;
        const uint32_t glass = b.node("bsdf_glass");
        b.link(b.node("uv_map"), "UV", glass, socket);
        const Material m = compile(b.surface(glass), {});
        EXPECT_EQ(why_not(m.specular), std::string("Glass BSDF: ") + reason);
        TestPoint at;
        EXPECT_FALSE(closures_of(m, at.point).closures[0].on_caster_normal);
    }
    EXPECT_TRUE(compile(single("bsdf_glass", {{"Roughness", {0.25f}}}), {}).has_smooth);
    EXPECT_FALSE(compile(single("bsdf_glass"), {}).has_smooth);
}

// Two mirrors under normals of their own, or of one node: what walks along.
TEST(Specular, OneNormal) {
    TestPoint at;
    for (const bool shared : {true, false}) {
        GraphBuilder b;
        const uint32_t mix = b.node("mix_shader"),
                       map = b.node("normal_map", {{"Strength", {0.5f}}});
        const uint32_t glossy = b.node("bsdf_glossy", {{"Roughness", {0}}}),
                       glass = b.node("bsdf_glass");
        b.link(glossy, "BSDF", mix, "Shader").link(glass, "BSDF", mix, "Shader_001");
        b.link(map, "Normal", glass, "Normal");
        if (shared) b.link(map, "Normal", glossy, "Normal");
        const Material m = compile(b.surface(mix, "Shader"), {});
        EXPECT_TRUE(m.specular.reflects && m.specular.refracts && m.specular.mapped_normal);
        const ClosureList list = closures_of(m, at.point);
        ASSERT_EQ(list.count, 2);
        for (int i = 0; i < 2; ++i) {
            const Closure& c = list.closures[static_cast<size_t>(i)];
            EXPECT_EQ(c.on_caster_normal,
                      shared || std::holds_alternative<MicrofacetDielectric>(c.kind));
        }
        EXPECT_EQ(m.warnings.size(), shared ? 0u : 1u);
        if (shared) continue;
        EXPECT_THAT(m.warnings[0], AllOf(names("bsdf_glossy.2"), HasSubstr("another normal")));
    }
    // Equal nodes count as one.
    GraphBuilder b;
    const uint32_t add = b.node("add_shader");
    for (const char* socket : {"Shader", "Shader_001"}) {
        const uint32_t glossy = b.node("bsdf_glossy", {{"Roughness", {0}}});
        b.link(b.node("normal_map"), "Normal", glossy, "Normal").link(glossy, "BSDF", add, socket);
    }
    EXPECT_TRUE(compile(b.surface(add, "Shader"), {}).warnings.empty());
}

TEST(Specular, OneIndex) {
    GraphBuilder b;
    const uint32_t add = b.node("add_shader");
    b.link(b.node("bsdf_glass", {{"IOR", {1.5f}}}), "BSDF", add, "Shader")
        .link(b.node("bsdf_refraction", {{"IOR", {1.2f}}}), "BSDF", add, "Shader_001");
    const Material m = compile(b.surface(add, "Shader"), {});
    ASSERT_EQ(m.warnings.size(), 1u);
    EXPECT_THAT(m.warnings[0], HasSubstr("another IOR"));
}

TEST(Compile, DocumentationListsTheTable) {
    std::ifstream file(std::string(SPC_TEST_SOURCE_DIR) + "/docs/nodes.md");
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_THAT(text.str(), HasSubstr(std::string("```text\n") + node_kinds_text() + "```\n"));
}

}  // namespace
}  // namespace spc::test
