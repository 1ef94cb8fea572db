// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes: the closures and weights that they come to, against values by hand.
#include "bsdf/albedo.h"
#include "shading/graphs.h"

namespace spc::test {
namespace {

template <class Kind>
Kind kind_of(const ClosureList& list, int i) {
    return std::get<Kind>(list.closures[static_cast<size_t>(i)].kind);
}
Vec3 weight(const ClosureList& list, int i) {
    return Vec3(list.closures[static_cast<size_t>(i)].weight);
}

TEST(Surface, Diffuse) {
    const ClosureList list = closures_of(single("bsdf_diffuse", {{"Color", {0.1f, 0.2f, 0.3f}}}));
    ASSERT_EQ(list.count, 1);
    expect_near(weight(list, 0), {0.1f, 0.2f, 0.3f}, 0.0f);
    expect_near(kind_of<Lambert>(list, 0).n, {0, 0, 1}, 0.0f);
    expect_near(weight(closures_of(single("bsdf_diffuse")), 0), Vec3(0.8f), 0.0f);

    const Constants plaster{{"Color", {0.1f, 0.2f, 0.3f}}, {"Roughness", {0.5f}}};
    const auto rough = kind_of<OrenNayar>(closures_of(single("bsdf_diffuse", plaster)), 0);
    EXPECT_EQ(rough.roughness, 0.5f);
    expect_near(Vec3(rough.exchanged), {0.1f, 0.2f, 0.3f}, 0.0f);
    const Options old{{"multiple_scattering", "False"}};
    const auto alone = kind_of<OrenNayar>(closures_of(single("bsdf_diffuse", plaster, old)), 0);
    expect_near(Vec3(alone.exchanged), Vec3(0.0f), 0.0f);
}

TEST(Surface, NormalsFaceWo) {
    TestPoint at;
    at.turn_to_back();
    const ClosureList list = closures_of(compile(single("bsdf_diffuse"), {}), at.point);
    expect_near(kind_of<Lambert>(list, 0).n, {0, 0, -1}, 0.0f);
}

TEST(Surface, Glossy) {
    const ClosureList list =
        closures_of(single("bsdf_glossy", {{"Color", {0.1f, 0.2f, 0.3f}}, {"Roughness", {0.3f}}},
                           {{"distribution", "BECKMANN"}}));
    ASSERT_EQ(list.count, 1);
    const auto c = kind_of<MicrofacetReflection>(list, 0);
    EXPECT_FLOAT_EQ(c.alpha, 0.09f);
    EXPECT_EQ(c.model, MicrofacetModel::beckmann);
    EXPECT_FALSE(c.energy_compensated);
    expect_near(Vec3(fresnel(c.fresnel, 0.5f)), {0.1f, 0.2f, 0.3f}, 1e-7f);
    const auto multi = kind_of<MicrofacetReflection>(
        closures_of(single("bsdf_glossy", {}, {{"distribution", "MULTI_GGX"}})), 0);
    EXPECT_EQ(multi.model, MicrofacetModel::ggx);
    EXPECT_TRUE(multi.energy_compensated);
    EXPECT_FLOAT_EQ(multi.alpha, 0.25f);
    EXPECT_EQ(
        kind_of<MicrofacetReflection>(closures_of(single("bsdf_glossy", {{"Roughness", {3}}})), 0).alpha,
        1.0f);
}

TEST(Surface, GlassAndRefraction) {
    TestPoint at;
    const Material glass =
        compile(single("bsdf_glass", {{"Color", {0.1f, 0.2f, 0.3f}}, {"IOR", {1.6f}}}), {});
    auto c = kind_of<MicrofacetDielectric>(closures_of(glass, at.point), 0);
    EXPECT_EQ(c.eta, 1.6f);
    EXPECT_EQ(c.alpha, 0.0f);
    EXPECT_TRUE(c.reflects && c.refracts && c.fresnel_weighted);
    expect_near(Vec3(c.reflection_tint), {0.1f, 0.2f, 0.3f}, 0.0f);
    expect_near(Vec3(c.transmission_tint), {0.1f, 0.2f, 0.3f}, 0.0f);
    at.turn_to_back();
    EXPECT_FLOAT_EQ(kind_of<MicrofacetDielectric>(closures_of(glass, at.point), 0).eta, 1 / 1.6f);
    c = kind_of<MicrofacetDielectric>(closures_of(single("bsdf_refraction")), 0);
    EXPECT_EQ(c.eta, 1.45f);
    EXPECT_TRUE(!c.reflects && c.refracts && !c.fresnel_weighted);
}

TEST(Surface, EmissionAndTransparency) {
    TestPoint at;
    const Material emission =
        compile(single("emission", {{"Color", {1, 2, 3}}, {"Strength", {5}}}, {}, "Emission"), {});
    EXPECT_TRUE(emission.emits);
    EXPECT_FALSE(emission.has_smooth || emission.may_be_transparent || emission.is_background);
    expect_near(Vec3(emission.mean_emission), {5, 10, 15}, 0.0f);
    expect_near(Vec3(evaluate_emission(emission, {}, at.point)), {5, 10, 15}, 0.0f);
    expect_near(Vec3(closures_of(emission, at.point).emission), {5, 10, 15}, 0.0f);

    const Material clear = compile(single("bsdf_transparent", {{"Color", {0.1f, 0.2f, 0.3f}}}), {});
    EXPECT_TRUE(clear.may_be_transparent);
    EXPECT_FALSE(clear.emits || clear.has_smooth);
    expect_near(Vec3(evaluate_transparency(clear, {}, at.point)), {0.1f, 0.2f, 0.3f}, 0.0f);
    expect_near(Vec3(closures_of(clear, at.point).transparency), {0.1f, 0.2f, 0.3f}, 0.0f);
    expect_near(Vec3(evaluate_emission(clear, {}, at.point)), Vec3(0.0f), 0.0f);
}

TEST(Surface, BackgroundIsNoSurface) {
    TestPoint at;
    const Material world = compile(
        single("background", {{"Color", {1, 2, 3}}, {"Strength", {2}}}, {}, "Background"), {});
    EXPECT_TRUE(world.is_background);
    expect_near(Vec3(evaluate_background(world, {}, {0, 0, 1})), {2, 4, 6}, 0.0f);
    EXPECT_EQ(closures_of(world, at.point).count, 0);
    const Material surface = compile(single("bsdf_diffuse"), {});
    expect_near(Vec3(evaluate_background(surface, {}, {0, 0, 1})), Vec3(0.0f), 0.0f);
    // Other shaders of a world are dropped, with a word.
    GraphBuilder b;
    const uint32_t add = b.node("add_shader");
    b.link(b.node("background"), "Background", add, "Shader")
        .link(b.node("bsdf_glass"), "BSDF", add, "Shader_001");
    EXPECT_EQ(compile(b.surface(add, "Shader"), {}).warnings.size(), 1u);
}

TEST(Surface, MixAndAddMultiplyDownTheTree) {
    const auto tree = [](float outer, float inner) {
        GraphBuilder b;
        const uint32_t top = b.node("mix_shader", {{"Fac", {outer}}}),
                       low = b.node("mix_shader", {{"Fac", {inner}}});
        const uint32_t diffuse = b.node("bsdf_diffuse", {{"Color", {1, 1, 1}}});
        b.link(diffuse, "BSDF", top, "Shader").link(low, "Shader", top, "Shader_001");
        b.link(b.node("emission"), "Emission", low, "Shader")
            .link(b.node("bsdf_transparent"), "BSDF", low, "Shader_001");
        return compile(b.surface(top, "Shader"), {});
    };
    TestPoint at;
    const Material material = tree(0.25f, 0.6f);
    const ClosureList list = closures_of(material, at.point);
    ASSERT_EQ(list.count, 2);
    expect_near(Vec3(list.emission), Vec3(0.25f * 0.4f), 1e-7f);
    expect_near(Vec3(list.transparency), Vec3(0.25f * 0.6f), 1e-7f);
    expect_near(Vec3(evaluate_transparency(material, {}, at.point)), Vec3(0.25f * 0.6f), 1e-7f);
    // What can never appear is not there.
    EXPECT_FALSE(tree(0.0f, 0.6f).emits || tree(0.0f, 0.6f).may_be_transparent);
    EXPECT_FALSE(tree(1.5f, 0.6f).has_smooth);
    EXPECT_FALSE(tree(1.0f, 1.0f).emits);

    // A shader used twice is one closure under the sum of its weights.
    GraphBuilder b;
    const uint32_t add = b.node("add_shader"), glass = b.node("bsdf_glass");
    b.link(glass, "BSDF", add, "Shader").link(glass, "BSDF", add, "Shader_001");
    const ClosureList twice = closures_of(b.surface(add, "Shader"));
    ASSERT_EQ(twice.count, 1);
    expect_near(weight(twice, 0), Vec3(2.0f), 0.0f);
}

TEST(Surface, FactorsMayVary) {
    TestPoint at;
    GraphBuilder b;
    const uint32_t mix = b.node("mix_shader"),
                   diffuse = b.node("bsdf_diffuse", {{"Color", {1, 1, 1}}});
    b.link(b.node("uv_map"), "UV", mix, "Fac");  // mean of (u, v, 0)
    b.link(diffuse, "BSDF", mix, "Shader")
        .link(b.node("bsdf_transparent"), "BSDF", mix, "Shader_001");
    const Material material = compile(b.surface(mix, "Shader"), {});
    for (const float v : {0.25f, 2.75f, 9.0f}) {  // the last one is beyond 1
        at.attributes[0] = {0.5f, v, 0, 1};
        const float fac = std::min((0.5f + v) / 3, 1.0f);
        const ClosureList list = closures_of(material, at.point);
        expect_near(Vec3(list.transparency), Vec3(fac), 1e-6f);
        EXPECT_EQ(list.count, fac < 1 ? 2 : 1);
        if (fac < 1) expect_near(weight(list, 0), Vec3(1 - fac), 1e-6f);
    }
}

TEST(Surface, TexturesAtTheirMeanForLightSelection) {
    const std::vector<float> texels{1, 0, 0, 3, 2, 0};
    const std::vector<Image> images{
        image_from_floats("i", texels, 2, 1, 3, ColorSpace::linear, AlphaMode::none)};
    GraphBuilder b;
    const uint32_t emission = b.node("emission", {{"Strength", {10}}}), mapping = b.node("mapping");
    const uint32_t image = b.node("image_texture", {}, {}, 0);
    b.link(b.node("texture_coordinate"), "Object", mapping, "Vector")
        .link(mapping, "Vector", image, "Vector");
    b.link(image, "Color", emission, "Color");
    const Material material = compile(b.surface(emission, "Emission"), images);
    expect_near(Vec3(material.mean_emission), {20, 10, 0}, 1e-5f);
    EXPECT_EQ(material.reads, static_cast<uint32_t>(kReadsObjectPosition));
}

TEST(Principled, DefaultIsADielectricOverLambert) {
    TestPoint at;
    const ClosureList list = closures_of(compile(single("bsdf_principled"), {}), at.point);
    ASSERT_EQ(list.count, 2);
    const auto coat = kind_of<MicrofacetReflection>(list, 0);
    EXPECT_FLOAT_EQ(coat.alpha, 0.25f);
    EXPECT_EQ(coat.fresnel.kind, Fresnel::Kind::dielectric_f0);
    EXPECT_FLOAT_EQ(coat.fresnel.eta, 1.5f);
    expect_near(Vec3(coat.fresnel.f0), Vec3(0.04f), 1e-7f);
    expect_near(weight(list, 1), Vec3(0.8f * (1 - kept_from_below(coat, at.point.wo).x)), 1e-6f);
    EXPECT_TRUE(compile(single("bsdf_principled"), {}).has_smooth);
}

TEST(Principled, Metal) {
    const ClosureList list = closures_of(single("bsdf_principled", {{"Metallic", {1}},
                                                                    {"Base Color", {0.9f, 2, 0.1f}},
                                                                    {"Specular Tint", {0.5f, 1, 1}},
                                                                    {"Roughness", {0}}}));
    ASSERT_EQ(list.count, 1);
    const auto c = kind_of<MicrofacetReflection>(list, 0);
    EXPECT_EQ(c.fresnel.kind, Fresnel::Kind::f82);
    expect_near(Vec3(c.fresnel.f0), {0.9f, 1, 0.1f}, 0.0f);
    expect_near(Vec3(c.fresnel.f82), {0.5f, 1, 1}, 0.0f);
    EXPECT_TRUE(list.closures[0].on_caster_normal);
}

TEST(Principled, TransmissionTakesTheRootOfTheColour) {
    TestPoint at;
    at.turn_to_back();
    const Material m = compile(single("bsdf_principled", {{"Transmission Weight", {1}},
                                                          {"Base Color", {0.25f, 0.64f, 2}},
                                                          {"Roughness", {0}},
                                                          {"IOR", {1.33f}}}),
                               {});
    EXPECT_FALSE(m.has_smooth);
    const ClosureList list = closures_of(m, at.point);
    ASSERT_EQ(list.count, 1);
    const auto c = kind_of<MicrofacetDielectric>(list, 0);
    EXPECT_FLOAT_EQ(c.eta, 1 / 1.33f);
    expect_near(Vec3(c.transmission_tint), {0.5f, 0.8f, 1}, 1e-6f);
    expect_near(Vec3(c.reflection_tint), Vec3(1.0f), 0.0f);
}

TEST(Principled, WeightsOfTheLayers) {
    TestPoint at;
    const Material m = compile(single("bsdf_principled", {{"Alpha", {0.5f}},
                                                          {"Metallic", {0.25f}},
                                                          {"Transmission Weight", {0.2f}},
                                                          {"Emission Color", {1, 2, 3}},
                                                          {"Emission Strength", {4}}}),
                               {});
    const ClosureList list = closures_of(m, at.point);
    ASSERT_EQ(list.count, 5);  // gap, metal, glass, coat, Lambert
    expect_near(weight(list, 0), Vec3(0.5f), 1e-7f);
    expect_near(weight(list, 1), Vec3(0.5f * 0.25f), 1e-7f);
    expect_near(weight(list, 2), Vec3(0.5f * 0.75f * 0.2f), 1e-7f);
    expect_near(weight(list, 3), Vec3(0.5f * 0.75f * 0.8f), 1e-7f);
    expect_near(Vec3(list.emission), {2, 4, 6}, 0.0f);  // under alpha
    EXPECT_TRUE(m.may_be_transparent && m.emits);
}

TEST(Principled, SpecularLevelScalesTheReflectance) {
    const auto coat = [](float level, float ior) {
        const ClosureList list = closures_of(
            single("bsdf_principled", {{"Specular IOR Level", {level}}, {"IOR", {ior}}}));
        return list.count == 2 ? kind_of<MicrofacetReflection>(list, 0).fresnel : Fresnel{};
    };
    const float f0 = 0.08f, root = std::sqrt(f0);
    EXPECT_NEAR(coat(1, 1.5f).f0.x, f0, 1e-6f);
    EXPECT_NEAR(coat(1, 1.5f).eta, (1 + root) / (1 - root), 1e-5f);
    EXPECT_NEAR(coat(1, 1 / 1.5f).eta, (1 - root) / (1 + root), 1e-5f);  // stays below 1
    // No reflection at all: Lambert alone.
    EXPECT_EQ(closures_of(single("bsdf_principled", {{"Specular IOR Level", {0}}})).count, 1);
    EXPECT_EQ(closures_of(single("bsdf_principled", {{"IOR", {1}}})).count, 1);
    expect_near(weight(closures_of(single("bsdf_principled", {{"IOR", {1}}})), 0), Vec3(0.8f), 0.0f);
}

TEST(Principled, CoatOverAll) {
    TestPoint at;
    const Constants mixed{{"Metallic", {0.25f}},
                          {"Transmission Weight", {0.2f}},
                          {"Emission Color", {1, 2, 3}},
                          {"Emission Strength", {4}},
                          {"Alpha", {0.5f}}};
    Constants inputs = mixed;
    inputs.insert(inputs.end(), {{"Coat Weight", {0.6f}},
                                 {"Coat Roughness", {0.4f}},
                                 {"Coat IOR", {1.7f}},
                                 {"Coat Tint", {0.9f, 0.5f, 2}}});
    const Material bare = compile(single("bsdf_principled", mixed), {}),
                   coated = compile(single("bsdf_principled", inputs), {});
    const ClosureList below = closures_of(bare, at.point), list = closures_of(coated, at.point);
    const Coat coat{0.6f, 0.16f, 1.7f, Spectrum(0.9f, 0.5f, 1.0f)};
    const Vec3 through(coat_transmittance(coat, at.point.ng, at.point.wo));
    ASSERT_EQ(below.count, 5);  // gap, metal, glass, specular, Lambert
    ASSERT_EQ(list.count, 6);
    expect_near(weight(list, 0), weight(below, 0), 0.0f);
    for (int i = 1; i < 5; ++i) expect_near(weight(list, i), weight(below, i) * through, 1e-6f);
    const auto lobe = kind_of<MicrofacetReflection>(list, 5);
    EXPECT_TRUE(lobe.energy_compensated);
    const Vec3 covered = Vec3(energy_compensation(lobe, at.point.wo)) * (0.5f * 0.6f);
    expect_near(weight(list, 5), covered, 1e-7f);
    EXPECT_FLOAT_EQ(lobe.alpha, 0.16f);
    EXPECT_EQ(lobe.fresnel.kind, Fresnel::Kind::dielectric);
    EXPECT_EQ(lobe.fresnel.eta, 1.7f);
    expect_near(Vec3(list.emission), Vec3(2, 4, 6) * through, 1e-6f);
    expect_near(Vec3(evaluate_emission(coated, {}, at.point)), Vec3(2, 4, 6) * through, 1e-6f);
    expect_near(Vec3(coated.mean_emission), Vec3(2, 4, 6), 0.0f);  // as if clear
    expect_near(Vec3(evaluate_transparency(coated, {}, at.point)), Vec3(0.5f), 0.0f);
    // The same from behind.
    at.turn_to_back();
    expect_near(weight(closures_of(coated, at.point), 5), covered, 1e-7f);
    expect_near(Vec3(evaluate_emission(coated, {}, at.point)), Vec3(2, 4, 6) * through, 1e-6f);
}

TEST(Principled, CoatHasANormalOfItsOwn) {
    GraphBuilder b;
    const uint32_t shader =
        b.node("bsdf_principled", {{"IOR", {1}}, {"Coat Weight", {1}}, {"Coat Roughness", {0.5f}}});
    b.link(b.node("normal_map", {{"Color", {0.8f, 0.5f, 0.9f}}}), "Normal", shader, "Coat Normal");
    TestPoint at;
    const ClosureList list = closures_of(compile(b.surface(shader), {}), at.point);
    ASSERT_EQ(list.count, 2);
    const auto lobe = kind_of<MicrofacetReflection>(list, 1);
    expect_near(kind_of<Lambert>(list, 0).n, {0, 0, 1}, 0.0f);
    expect_near(lobe.n, normalize(Vec3(0.6f, 0, 0.8f)), 1e-6f);
    const Coat coat{1.0f, 0.25f, 1.5f, Spectrum(1.0f)};
    expect_near(weight(list, 0), Vec3(coat_transmittance(coat, lobe.n, at.point.wo)) * 0.8f, 1e-6f);
}

TEST(Principled, CoatOfNoIndexReflectsNothingButTints) {
    const ClosureList list = closures_of(single(
        "bsdf_principled",
        {{"IOR", {1}}, {"Coat Weight", {2}}, {"Coat IOR", {0.5f}}, {"Coat Tint", {0.5f, 1, 1}}}));
    ASSERT_EQ(list.count, 1);
    EXPECT_LT(weight(list, 0).x, 0.4f);
    EXPECT_NEAR(weight(list, 0).y, 0.8f, 1e-6f);
}

TEST(Principled, GivesBackNoMoreThanItGets) {
    Uniforms random(3);
    for (int n = 0; n < 3000; ++n) {
        const auto corner = [&] {  // the ends of the range as often as its inside
            const float x = random();
            return x < 0.25f ? 0.0f : x > 0.75f ? 1.0f : random();
        };
        const Material m =
            compile(single("bsdf_principled",
                           {{"Base Color", {corner(), corner(), corner()}},
                            {"Metallic", {corner()}},
                            {"Roughness", {corner()}},
                            {"IOR", {1.0f + corner()}},
                            {"Alpha", {corner()}},
                            {"Specular IOR Level", {corner()}},
                            {"Specular Tint", {corner() * 2, corner() * 2, corner() * 2}},
                            {"Transmission Weight", {corner()}},
                            {"Coat Weight", {corner()}},
                            {"Coat Roughness", {corner()}},
                            {"Coat IOR", {1.0f + corner()}},
                            {"Coat Tint", {corner(), corner(), corner()}}},
                           {{"distribution", random() < 0.5f ? "GGX" : "MULTI_GGX"}}),
                    {});
        TestPoint at;
        const float z = 0.02f + 0.98f * random();
        at.point.wo = Vec3(std::sqrt(1 - z * z), 0, z);
        ClosureList list = closures_of(m, at.point);
        // Energy compensation is inside the weights; the albedo counts it again unless it is
        // switched off.
        Spectrum sum(0.0f);
        for (int i = 0; i < list.count; ++i) {
            ClosureKind kind = list.closures[static_cast<size_t>(i)].kind;
            if (auto* r = std::get_if<MicrofacetReflection>(&kind)) r->energy_compensated = false;
            if (auto* d = std::get_if<MicrofacetDielectric>(&kind)) d->energy_compensated = false;
            sum += list.closures[static_cast<size_t>(i)].weight * albedo(kind, at.point.wo);
        }
        EXPECT_LE(max_component(sum), 1.0f + 2e-3f) << n;  // of the albedo tables
    }
}

}  // namespace
}  // namespace spc::test
