// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes whose closures have a grain, lie over others, or follow where they are seen from.
#include "shading/graphs.h"

namespace spc::test {
namespace {

template <class Kind>
Kind kind_of(const ClosureList& list, int i) {
    return std::get<Kind>(list.closures[static_cast<size_t>(i)].kind);
}

// Around the middle of the mesh, at a quarter and three quarters of it, seen along Z; turned by a quarter of a turn; the alphas
// of a Glossy BSDF and of a Principled BSDF.
TEST(Grain, FollowsTheTangent) {
    const Vec3 around = normalize(Vec3(-1, -1, 0)), out = normalize(Vec3(1, -1, 0));
    const auto brushed = [](const Constants& constants) {
        return kind_of<MicrofacetReflection>(closures_of(single("bsdf_glossy", constants)), 0);
    };
    const Constants along{{"Roughness", {0.5f}}, {"Anisotropy", {0.6f}}};
    const auto lobe = brushed(along);
    EXPECT_NEAR(lobe.alpha, 0.25f * 0.4f, 1e-6f);
    EXPECT_NEAR(lobe.alpha_y, 0.25f / 0.4f, 1e-6f);
    expect_near(lobe.tangent, around, 1e-6f);
    const auto across = brushed({{"Roughness", {0.5f}}, {"Anisotropy", {-0.6f}}});
    EXPECT_NEAR(across.alpha, 0.25f / 0.4f, 1e-6f);
    EXPECT_NEAR(across.alpha_y, 0.25f * 0.4f, 1e-6f);
    const auto turned =
        brushed({{"Roughness", {0.5f}}, {"Anisotropy", {0.6f}}, {"Rotation", {0.25f}}});
    expect_near(turned.tangent, out, 1e-6f);
    EXPECT_TRUE(brushed({{"Roughness", {0.5f}}}).is_isotropic());
    EXPECT_TRUE(brushed({{"Roughness", {0.0f}}, {"Anisotropy", {0.6f}}}).is_isotropic());

    const auto metal = kind_of<MicrofacetReflection>(
        closures_of(single("bsdf_principled",
                           {{"Metallic", {1}}, {"Roughness", {0.5f}}, {"Anisotropic", {0.8f}}})),
        0);
    const float aspect = std::sqrt(1.0f - 0.9f * 0.8f);
    EXPECT_NEAR(metal.alpha, 0.25f / aspect, 1e-6f);
    EXPECT_NEAR(metal.alpha_y, 0.25f * aspect, 1e-6f);
    const auto phong = kind_of<AshikhminShirley>(
        closures_of(single("bsdf_glossy", along, {{"distribution", "ASHIKHMIN_SHIRLEY"}})), 0);
    EXPECT_NEAR(phong.alpha, 0.25f * 0.4f, 1e-6f);
    expect_near(phong.tangent, around, 1e-6f);
}

// Tangents turn like normals, as in Cycles: by the inverse of a stretch.
TEST(Grain, OfAStretchedObject) {
    Transform stretched;
    stretched.row[0].x = 4.0f;
    TestPoint at;
    at.set(stretched);
    const Material material =
        compile(single("bsdf_glossy", {{"Roughness", {0.5f}}, {"Anisotropy", {0.6f}}}), {});
    const auto lobe = kind_of<MicrofacetReflection>(closures_of(material, at.point), 0);
    expect_near(lobe.tangent, normalize(Vec3(-0.25f, -1, 0)), 1e-6f);
}

TEST(Grain, CastsNoChains) {
    const Material plain = compile(single("bsdf_glossy", {{"Roughness", {0.2f}}}), {});
    EXPECT_TRUE(plain.rough.exists());
    const Material brushed =
        compile(single("bsdf_glossy", {{"Roughness", {0.2f}}, {"Anisotropy", {0.6f}}}), {});
    EXPECT_FALSE(brushed.rough.exists());
    EXPECT_FALSE(brushed.narrow_lobe.empty());  // light paths find what it throws
    const Options phong{{"distribution", "ASHIKHMIN_SHIRLEY"}};
    EXPECT_FALSE(compile(single("bsdf_glossy", {{"Roughness", {0.2f}}}, phong), {}).rough.exists());
    EXPECT_TRUE(compile(single("bsdf_glossy", {{"Roughness", {0.0f}}}, phong), {}).specular.exists());
}

TEST(Metallic, BothFresnelTerms) {
    const auto f82 = kind_of<MicrofacetReflection>(
        closures_of(single("bsdf_metallic",
                           {{"Base Color", {0.9f, 0.6f, 0.3f}}, {"Edge Tint", {0.5f, 0.6f, 0.7f}}})),
        0);
    expect_near(Vec3(fresnel(f82.fresnel, 1.0f)), {0.9f, 0.6f, 0.3f}, 1e-6f);
    const auto gold = kind_of<MicrofacetReflection>(
        closures_of(single("bsdf_metallic",
                           {{"IOR", {0.14f, 0.37f, 1.44f}}, {"Extinction", {3.98f, 2.38f, 1.6f}}},
                           {{"fresnel_type", "PHYSICAL_CONDUCTOR"}})),
        0);
    for (int i = 0; i < 3; ++i) {
        const double n = gold.fresnel.f0[i], k = gold.fresnel.f82[i];
        const double expected = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
        EXPECT_NEAR(fresnel(gold.fresnel, 1.0f)[i], expected, 1e-5);
    }
}

// Of an index of 1 only the base is left, which has no grain.
TEST(Anisotropy, OfNoReflectionIsNone) {
    const ClosureList list = closures_of(
        single("bsdf_principled",
               {{"IOR", {1.0f}}, {"Specular IOR Level", {0.5f}}, {"Anisotropic", {0.7f}}}));
    ASSERT_EQ(list.count, 1);
    EXPECT_TRUE(std::holds_alternative<Lambert>(list.closures[0].kind));
}

// What the sheen reflects does not reach the layers below, nor leave them.
TEST(Sheen, LiesOverTheRest) {
    const Constants plain{{"Base Color", {0.5f, 0.5f, 0.5f}}, {"Emission Strength", {1}}};
    Constants fuzzy = plain;
    fuzzy.insert(
        fuzzy.end(),
        {{"Sheen Weight", {0.8f}}, {"Sheen Roughness", {0.4f}}, {"Sheen Tint", {1.0f, 0.5f, 0.2f}}});
    const TestPoint at;
    const ClosureList below = closures_of(single("bsdf_principled", plain)),
                      all = closures_of(single("bsdf_principled", fuzzy));
    ASSERT_EQ(all.count, below.count + 1);
    const auto sheen = kind_of<Sheen>(all, 0);
    EXPECT_EQ(sheen.roughness, 0.4f);
    expect_near(Vec3(all.closures[0].weight), Vec3(0.8f, 0.4f, 0.16f), 1e-6f);
    const float left = 1.0f - 0.8f * albedo(sheen, at.point.wo).x;
    for (int i = 0; i < below.count; ++i)
        expect_near(Vec3(all.closures[static_cast<size_t>(i) + 1].weight),
                    Vec3(below.closures[static_cast<size_t>(i)].weight) * left, 1e-5f);
    expect_near(Vec3(all.emission), Vec3(below.emission) * left, 1e-5f);
}

// Blender 3.4's: of the diffuse part alone, from white to the base's hue by a factor, and not in
// its way.
TEST(Sheen, OfAnOlderPrincipled) {
    const ClosureList list = closures_of(single("bsdf_principled",
                                                {{"Base Color", {0.2f, 0.4f, 0.1f}},
                                                 {"Metallic", {0.25f}},
                                                 {"Sheen Weight", {0.8f}},
                                                 {"Sheen Tint", {0.5f, 0.5f, 0.5f}}},
                                                {{"model", "BURLEY"}}));
    int found = -1;
    for (int i = 0; i < list.count; ++i)
        if (std::holds_alternative<SchlickSheen>(list.closures[static_cast<size_t>(i)].kind))
            found = i;
    ASSERT_GE(found, 0);
    const Vec3 base(0.2f, 0.4f, 0.1f);
    const Vec3 hue = base * (1.0f / luminance(Spectrum(base)));
    expect_near(Vec3(list.closures[static_cast<size_t>(found)].weight),
                (Vec3(0.5f) + hue * 0.5f) * (0.8f * 0.75f), 1e-5f);
}

// A share goes on below; the rest, and all without a radius, is diffuse.
TEST(Subsurface, TakesItsShareOfTheBase) {
    const auto base = [](float share, float radius) {
        return closures_of(single("bsdf_principled", {{"Base Color", {0.5f, 0.5f, 0.5f}},
                                                      {"Specular IOR Level", {0}},
                                                      {"Subsurface Weight", {share}},
                                                      {"Subsurface Radius", {radius, 0, 0}},
                                                      {"Subsurface Scale", {2}}}));
    };
    const ClosureList both = base(0.25f, 0.1f);
    ASSERT_EQ(both.count, 2);
    EXPECT_EQ(kind_of<Subsurface>(both, 0).radius, Spectrum(0.2f, 0.0f, 0.0f));
    expect_near(Vec3(both.closures[0].weight), Vec3(0.125f), 1e-6f);
    expect_near(Vec3(both.closures[1].weight), Vec3(0.375f), 1e-6f);
    EXPECT_EQ(base(1.0f, 0.1f).count, 1);
    const ClosureList flat = base(0.0f, 0.1f);
    ASSERT_EQ(flat.count, 1);
    EXPECT_TRUE(std::holds_alternative<Lambert>(flat.closures[0].kind));
}

TEST(StandIns, SayWhatTheyAre) {
    EXPECT_TRUE(compile(single("bsdf_ray_portal"), {}).may_be_transparent);
}

TEST(HairNodes, AreAFibreOrALobe) {
    for (const bool through : {false, true}) {
        const ClosureList list =
            closures_of(single("bsdf_hair", {{"RoughnessU", {0.3f}}, {"RoughnessV", {0.6f}}},
                               {{"component", through ? "Transmission" : "Reflection"}}));
        ASSERT_EQ(list.count, 1);
        const auto& lobe = kind_of<HairLobe>(list, 0);
        EXPECT_EQ(lobe.transmits, through);
        EXPECT_EQ(lobe.along, 0.3f);
        EXPECT_EQ(lobe.around, 0.6f);
    }
    EXPECT_TRUE(compile(single("bsdf_hair_principled"), {}).warnings.empty());
    EXPECT_EQ(compile(single("bsdf_hair_principled", {}, {{"model", "HUANG"}}), {}).warnings.size(),
              1u);
}

// What is given as a colour is what absorption brings forth [Chiang16 Eq. 9]; melanin adds to a
// tint's.
TEST(HairNodes, AbsorbWhatTheirColourSays) {
    const auto absorption = [](const Constants& constants, const std::string& given) {
        return Vec3(kind_of<HairFibre>(closures_of(single("bsdf_hair_principled", constants,
                                                          {{"parametrization", given}})),
                                       0)
                        .absorption);
    };
    expect_near(absorption({{"Absorption Coefficient", {0.1f, 0.2f, 0.3f}}}, "ABSORPTION"),
                Vec3(0.1f, 0.2f, 0.3f), 1e-6f);
    expect_near(absorption({{"Melanin", {0}}}, "MELANIN"), Vec3(0.0f), 1e-6f);
    const float b = 0.3f;
    const float factor = 5.969f - 0.215f * b + 2.532f * b * b - 10.73f * std::pow(b, 3.0f) +
                         5.574f * std::pow(b, 4.0f) + 0.245f * std::pow(b, 5.0f);
    const float expected = std::pow(std::log(0.4f) / factor, 2.0f);
    expect_near(absorption({{"Color", {0.4f, 0.4f, 0.4f}}}, "COLOR"), Vec3(expected), 1e-5f);
    const Vec3 dark = absorption(
        {{"Melanin", {0.6f}}, {"Melanin Redness", {0}}, {"Tint", {0.4f, 0.4f, 0.4f}}}, "MELANIN");
    expect_near(dark, Vec3(0.506f, 0.841f, 1.653f) * -std::log(0.4f) + Vec3(expected), 1e-4f);
}

TEST(Holdout, IsAHoleWithoutAClosure) {
    const ClosureList list = closures_of(single("holdout", {}, {}, "Holdout"));
    EXPECT_EQ(list.count, 0);
    expect_near(Vec3(list.holdout), Vec3(1.0f), 0.0f);
}

// A caster's normal that is bent for a view is none on which chains turn.
TEST(BumpCorrection, BendsGlossyNormals) {
    Graph graph = single("bsdf_glass", {{"Roughness", {0}}});
    TestPoint at;
    at.point.normal = to_vector(normalize(Vec3(-0.6f, 0, 0.8f)));
    at.point.wo = normalize(Vec3(1, 0, 0.8f));
    const Vec3 smooth = value_of(at.point.normal);
    const auto glass = [&](BumpCorrection correction) {
        graph.bump_correction = correction;
        return closures_of(compile(graph, {}), at.point);
    };
    const ClosureList as_it_is = glass(BumpCorrection::none),
                      bent = glass(BumpCorrection::microfacet);
    EXPECT_EQ(kind_of<MicrofacetDielectric>(as_it_is, 0).n, smooth);
    EXPECT_TRUE(as_it_is.closures[0].on_caster_normal);
    EXPECT_EQ(kind_of<MicrofacetDielectric>(bent, 0).n,
              bent_normal(at.point.ng, at.point.wo, smooth));
    EXPECT_NE(kind_of<MicrofacetDielectric>(bent, 0).n, smooth);
    EXPECT_FALSE(bent.closures[0].on_caster_normal);

    Graph wall = single("bsdf_diffuse");
    wall.bump_correction = BumpCorrection::microfacet;
    EXPECT_EQ(kind_of<Lambert>(closures_of(compile(wall, {}), at.point), 0).n, smooth);
    wall.bump_correction = BumpCorrection::smoothed;
    EXPECT_NE(kind_of<Lambert>(closures_of(compile(wall, {}), at.point), 0).n, smooth);
}

}  // namespace
}  // namespace spc::test
