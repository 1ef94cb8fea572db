// SPDX-License-Identifier: GPL-3.0-or-later
// Converters and colour nodes, against values by hand. tests/blender compares them with Cycles.
#include "shading/graphs.h"

namespace spc::test {
namespace {

// A node of these inputs, all constant, or with the first one as a part of what a point offers.
float scalar_of(const std::string& kind, const Constants& constants, const Options& options,
                const std::string& output) {
    TestPoint at;
    GraphBuilder b;
    return value_of_graph(b, b.node(kind, constants, options), output, at.point).x;
}
Vec3 vector_of(const std::string& kind, const Constants& constants, const Options& options,
               const std::string& output) {
    TestPoint at;
    GraphBuilder b;
    return value_of_graph(b, b.node(kind, constants, options), output, at.point);
}

struct MathCase {
    const char* operation;
    float a, b, c, expected;
};

TEST(Math, EachOperation) {
    const float pi = std::numbers::pi_v<float>;
    for (const MathCase& m :
         std::initializer_list<MathCase>{{"ADD", 2, 3, 0, 5},
                                         {"SUBTRACT", 2, 3, 0, -1},
                                         {"MULTIPLY", 2, 3, 0, 6},
                                         {"DIVIDE", 3, 2, 0, 1.5f},
                                         {"DIVIDE", 3, 0, 0, 0},
                                         {"MULTIPLY_ADD", 2, 3, 4, 10},
                                         {"POWER", 2, 0.5f, 0, std::sqrt(2.0f)},
                                         {"POWER", -2, 3, 0, -8},
                                         {"POWER", -2, 2, 0, 4},
                                         {"POWER", -2, 0.5f, 0, 0},
                                         {"POWER", 0, 0, 0, 1},
                                         {"POWER", 0, -1, 0, 0},
                                         {"LOGARITHM", 8, 2, 0, 3},
                                         {"LOGARITHM", -8, 2, 0, 0},
                                         {"LOGARITHM", 8, 1, 0, 0},
                                         {"SQRT", 9, 0, 0, 3},
                                         {"SQRT", -9, 0, 0, 0},
                                         {"INVERSE_SQRT", 4, 0, 0, 0.5f},
                                         {"INVERSE_SQRT", 0, 0, 0, 0},
                                         {"ABSOLUTE", -2, 0, 0, 2},
                                         {"EXPONENT", 1, 0, 0, std::numbers::e_v<float>},
                                         {"MINIMUM", 2, 3, 0, 2},
                                         {"MAXIMUM", 2, 3, 0, 3},
                                         {"LESS_THAN", 2, 3, 0, 1},
                                         {"LESS_THAN", 3, 3, 0, 0},
                                         {"GREATER_THAN", 3, 2, 0, 1},
                                         {"SIGN", -0.1f, 0, 0, -1},
                                         {"SIGN", 0, 0, 0, 0},
                                         {"COMPARE", 2, 2.4f, 0.5f, 1},
                                         {"COMPARE", 2, 2.6f, 0.5f, 0},
                                         {"SMOOTH_MIN", 1, 1, 0.6f, 0.9f},  // 1 - k / 6
                                         {"SMOOTH_MAX", 1, 1, 0.6f, 1.1f},
                                         {"SMOOTH_MIN", 1, 2, 0.6f, 1},
                                         {"ROUND", 2.5f, 0, 0, 3},
                                         {"ROUND", -2.5f, 0, 0, -2},
                                         {"FLOOR", -2.5f, 0, 0, -3},
                                         {"CEIL", -2.5f, 0, 0, -2},
                                         {"TRUNC", -2.5f, 0, 0, -2},
                                         {"FRACT", -2.25f, 0, 0, 0.75f},
                                         {"MODULO", -5, 3, 0, -2},
                                         {"FLOORED_MODULO", -5, 3, 0, 1},
                                         {"MODULO", 5, 0, 0, 0},
                                         {"WRAP", 5.5f, 3, 1, 1.5f},
                                         {"WRAP", 5.5f, 1, 1, 1},
                                         {"SNAP", 5.5f, 2, 0, 4},
                                         {"PINGPONG", 3.5f, 2, 0, 0.5f},
                                         {"PINGPONG", 3.5f, 0, 0, 0},
                                         {"SINE", pi / 6, 0, 0, 0.5f},
                                         {"COSINE", pi / 3, 0, 0, 0.5f},
                                         {"TANGENT", pi / 4, 0, 0, 1},
                                         {"ARCSINE", 0.5f, 0, 0, pi / 6},
                                         {"ARCSINE", 2, 0, 0, pi / 2},
                                         {"ARCCOSINE", 0.5f, 0, 0, pi / 3},
                                         {"ARCTANGENT", 1, 0, 0, pi / 4},
                                         {"ARCTAN2", 1, -1, 0, 3 * pi / 4},
                                         {"ARCTAN2", 0, 0, 0, 0},
                                         {"SINH", 1, 0, 0, 1.1752012f},
                                         {"COSH", 1, 0, 0, 1.5430806f},
                                         {"TANH", 1, 0, 0, 0.7615942f},
                                         {"RADIANS", 180, 0, 0, pi},
                                         {"DEGREES", pi, 0, 0, 180}}) {
        const Constants in{{"Value", {m.a}}, {"Value_001", {m.b}}, {"Value_002", {m.c}}};
        EXPECT_NEAR(scalar_of("math", in, {{"operation", m.operation}}, "Value"), m.expected,
                    2e-6f * std::max(1.0f, std::abs(m.expected)))
            << m.operation << " " << m.a << " " << m.b << " " << m.c;
    }
    EXPECT_EQ(
        scalar_of("math", {{"Value", {2}}}, {{"operation", "ADD"}, {"use_clamp", "True"}}, "Value"),
        1.0f);
}

TEST(VectorMath, EachOperationThatIsNotMaths) {
    const Constants in{{"Vector", {1, 2, 3}},
                       {"Vector_001", {0, 2, 0}},
                       {"Vector_002", {1, 0, 1}},
                       {"Scale", {0.5f}}};
    const auto vector = [&](const char* operation) {
        return vector_of("vector_math", in, {{"operation", operation}}, "Vector");
    };
    const auto value = [&](const char* operation) {
        return scalar_of("vector_math", in, {{"operation", operation}}, "Value");
    };
    expect_near(vector("CROSS_PRODUCT"), {-6, 0, 2}, 1e-6f);
    expect_near(vector("PROJECT"), {0, 2, 0}, 1e-6f);
    expect_near(vector("REFLECT"), {1, -2, 3}, 1e-6f);
    // k = 1 - (1/4) (1 - 4) = 7/4; (1, 2, 3) / 2 - (1 + sqrt(7/4)) (0, 1, 0)
    expect_near(vector("REFRACT"), {0.5f, -std::sqrt(1.75f), 1.5f}, 1e-6f);
    expect_near(vector("FACEFORWARD"), {-1, -2, -3}, 1e-6f);
    expect_near(vector("SCALE"), {0.5f, 1, 1.5f}, 1e-6f);
    expect_near(vector("NORMALIZE"), Vec3(1, 2, 3) / std::sqrt(14.0f), 1e-6f);
    expect_near(vector("MULTIPLY_ADD"), {1, 4, 1}, 1e-6f);
    expect_near(vector("DIVIDE"), {0, 1, 0}, 1e-6f);
    EXPECT_NEAR(value("DOT_PRODUCT"), 4, 1e-6f);
    EXPECT_NEAR(value("LENGTH"), std::sqrt(14.0f), 1e-6f);
    EXPECT_NEAR(value("DISTANCE"), std::sqrt(10.0f), 1e-6f);
}

TEST(Mix, BlendTypes) {
    const Vec3 a(0.2f, 0.6f, 0.8f), b(0.5f, 0.25f, 0.75f);
    const auto blended = [&](const std::string& type, float t) {
        return vector_of(
            "mix",
            {{"Factor_Float", {t}}, {"A_Color", {a.x, a.y, a.z}}, {"B_Color", {b.x, b.y, b.z}}},
            {{"blend_type", type}}, "Result_Color");
    };
    expect_near(blended("MIX", 0.25f), a * 0.75f + b * 0.25f, 1e-6f);
    expect_near(blended("MULTIPLY", 1), {0.1f, 0.15f, 0.6f}, 1e-6f);
    expect_near(blended("SCREEN", 1), {0.6f, 0.7f, 0.95f}, 1e-6f);
    expect_near(blended("OVERLAY", 1), {0.2f, 0.4f, 0.9f}, 1e-6f);
    expect_near(blended("DARKEN", 1), {0.2f, 0.25f, 0.75f}, 1e-6f);
    expect_near(blended("LIGHTEN", 1), {0.5f, 0.6f, 0.8f}, 1e-6f);
    expect_near(blended("DIFFERENCE", 1), {0.3f, 0.35f, 0.05f}, 1e-6f);
    expect_near(blended("EXCLUSION", 1), {0.5f, 0.55f, 0.35f}, 1e-6f);
    expect_near(blended("SUBTRACT", 1), {-0.3f, 0.35f, 0.05f}, 1e-6f);
    expect_near(blended("DIVIDE", 1), {0.4f, 2.4f, 0.8f / 0.75f}, 1e-6f);
    expect_near(blended("DODGE", 1), {0.4f, 0.8f, 1}, 1e-6f);
    expect_near(blended("BURN", 1), {0, 0, 1 - 0.2f / 0.75f}, 1e-6f);
    expect_near(blended("SOFT_LIGHT", 1), {0.2f, 0.48f, 0.88f}, 1e-6f);
    expect_near(blended("LINEAR_LIGHT", 1), {0.2f, 0.1f, 1.3f}, 1e-6f);
    // a has hue 5/9, saturation 3/4, value 0.8; b has 3/4, 2/3 and 3/4.
    expect_near(blended("VALUE", 1), Vec3(0.2f, 0.6f, 0.8f) * (0.75f / 0.8f), 1e-5f);
    expect_near(blended("SATURATION", 1), {0.8f / 3, 0.8f - 0.8f * 2 / 3 / 3, 0.8f}, 1e-5f);
    expect_near(blended("HUE", 1), {0.5f, 0.2f, 0.8f}, 1e-5f);
    expect_near(blended("COLOR", 1), {0.8f * 2 / 3, 0.8f / 3, 0.8f}, 1e-5f);
    for (const char* type : {"ADD", "BURN", "HUE", "COLOR", "DODGE"})
        expect_near(blended(type, 0), a, 0.0f);
}

TEST(Mix, FactorsAndClamps) {
    const Constants in{{"Factor_Float", {2}},     {"Factor_Vector", {0, 0.5f, 1}},
                       {"A_Float", {1}},          {"B_Float", {3}},
                       {"A_Vector", {1, 1, 1}},   {"B_Vector", {3, 3, 3}},
                       {"A_Color", {0, 0, 0.5f}}, {"B_Color", {1, 2, 3}}};
    EXPECT_EQ(scalar_of("mix", in, {}, "Result_Float"), 3.0f);
    EXPECT_EQ(scalar_of("mix", in, {{"clamp_factor", "False"}}, "Result_Float"), 5.0f);
    expect_near(vector_of("mix", in, {{"factor_mode", "NON_UNIFORM"}}, "Result_Vector"), {1, 2, 3},
                1e-6f);
    expect_near(vector_of("mix", in, {}, "Result_Vector"), {3, 3, 3}, 1e-6f);
    expect_near(vector_of("mix", in, {{"clamp_result", "True"}}, "Result_Color"), {1, 1, 1}, 0.0f);
    expect_near(
        vector_of("mix_rgb", {{"Fac", {2}}, {"Color1", {1, 1, 1}}, {"Color2", {3, 0.5f, -1}}},
                  {{"use_clamp", "True"}}, "Color"),
        {1, 0.5f, 0}, 0.0f);
}

TEST(MapRange, Interpolations) {
    const auto mapped = [&](float value, const std::string& type,
                            const std::string& clamp = "True") {
        return scalar_of("map_range",
                         {{"Value", {value}},
                          {"From Min", {1}},
                          {"From Max", {3}},
                          {"To Min", {10}},
                          {"To Max", {0}},
                          {"Steps", {4}}},
                         {{"interpolation_type", type}, {"clamp", clamp}}, "Result");
    };
    EXPECT_NEAR(mapped(1.5f, "LINEAR"), 7.5f, 1e-5f);
    EXPECT_NEAR(mapped(0, "LINEAR"), 10, 1e-5f);
    EXPECT_NEAR(mapped(0, "LINEAR", "False"), 15, 1e-5f);
    EXPECT_NEAR(mapped(1.5f, "STEPPED"), 7.5f, 1e-5f);  // floor(0.25 * 5) / 4
    EXPECT_NEAR(mapped(1.9f, "STEPPED"), 5, 1e-5f);     // floor(0.45 * 5) / 4
    EXPECT_NEAR(mapped(1.5f, "SMOOTHSTEP"), 10 - 10 * 0.15625f, 1e-5f);
    EXPECT_NEAR(mapped(1.5f, "SMOOTHERSTEP"), 10 - 10 * 0.103515625f, 1e-5f);
    EXPECT_NEAR(mapped(4, "SMOOTHSTEP"), 0, 1e-5f);
    expect_near(
        vector_of(
            "map_range",
            {{"Vector", {0.5f, 2, 1}}, {"From_Max_FLOAT3", {1, 1, 2}}, {"To_Max_FLOAT3", {4, 4, 4}}},
            {}, "Vector"),
        {2, 4, 2}, 1e-6f);
    EXPECT_EQ(scalar_of("clamp", {{"Value", {5}}, {"Min", {3}}, {"Max", {1}}},
                        {{"clamp_type", "RANGE"}}, "Result"),
              3.0f);
    EXPECT_EQ(scalar_of("clamp", {{"Value", {5}}, {"Min", {1}}, {"Max", {3}}}, {}, "Result"), 3.0f);
}

TEST(Colors, SpacesThereAndBack) {
    const std::vector<float> color{0.2f, 0.6f, 0.8f};
    const auto channel = [&](const std::string& mode, const char* name) {
        return scalar_of("separate_color", {{"Color", color}}, {{"mode", mode}}, name);
    };
    EXPECT_NEAR(channel("HSV", "Red"), 5.0f / 9, 1e-6f);
    EXPECT_NEAR(channel("HSV", "Green"), 0.75f, 1e-6f);
    EXPECT_NEAR(channel("HSV", "Blue"), 0.8f, 1e-6f);
    EXPECT_NEAR(channel("HSL", "Green"), 0.6f, 1e-6f);
    EXPECT_NEAR(channel("HSL", "Blue"), 0.5f, 1e-6f);
    EXPECT_NEAR(channel("RGB", "Green"), 0.6f, 0.0f);
    for (const std::string mode : {"HSV", "HSL", "RGB"})
        expect_near(vector_of("combine_color",
                              {{"Red", {channel(mode, "Red")}},
                               {"Green", {channel(mode, "Green")}},
                               {"Blue", {channel(mode, "Blue")}}},
                              {{"mode", mode}}, "Color"),
                    {0.2f, 0.6f, 0.8f}, 1e-6f);
    expect_near(
        vector_of(
            "hue_saturation",
            {{"Hue", {0.5f + 1.0f / 3}}, {"Saturation", {2}}, {"Value", {0.5f}}, {"Color", color}},
            {}, "Color"),
        {0.4f, 0, 0.4f * 2 / 3}, 1e-5f);  // hue 8/9, saturation 1, value 0.4
    expect_near(vector_of("bright_contrast",
                          {{"Color", color}, {"Bright", {0.1f}}, {"Contrast", {1}}}, {}, "Color"),
                {0, 0.8f, 1.2f}, 1e-6f);
    expect_near(vector_of("gamma", {{"Color", {0.25f, -1, 4}}, {"Gamma", {0.5f}}}, {}, "Color"),
                {0.5f, -1, 2}, 1e-6f);
    expect_near(vector_of("invert", {{"Fac", {0.5f}}, {"Color", {0, 0.25f, 1}}}, {}, "Color"),
                {0.5f, 0.5f, 0.5f}, 1e-6f);
}

TEST(ColorRamp, LooksUpItsTable) {
    const auto at = [&](float factor, const std::string& interpolation, const std::string& output) {
        TestPoint point;
        GraphBuilder b;
        const uint32_t ramp =
            b.node("color_ramp", {{"Fac", {factor}}}, {{"interpolation", interpolation}});
        b.graph.arrays.push_back({ramp, "Table", {0, 1, 2, 0.5f, 1, 3, 0, 1, 5, 5, 5, 0}});
        return value_of_graph(b, ramp, output, point.point);
    };
    expect_near(at(0.25f, "LINEAR", "Color"), {0.5f, 2, 1}, 1e-6f);
    expect_near(at(0.25f, "CONSTANT", "Color"), {0, 1, 2}, 0.0f);
    expect_near(at(2, "EASE", "Color"), {5, 5, 5}, 0.0f);
    expect_near(at(-1, "LINEAR", "Color"), {0, 1, 2}, 0.0f);
    expect_near(at(0.75f, "LINEAR", "Alpha"), Vec3(0.5f), 1e-6f);
}

TEST(Curves, BetweenTheirRowsAndBeyond) {
    const auto at = [&](float value, const std::string& extend) {
        TestPoint point;
        GraphBuilder b;
        const uint32_t curve =
            b.node("float_curve", {{"Value", {value}}, {"Factor", {0.5f}}}, {{"extend", extend}});
        b.graph.arrays.push_back({curve, "Table", {1, 0, 2, 4, 3, 6}});  // places 1, 2, 3
        return value_of_graph(b, curve, "Value", point.point).x;
    };
    EXPECT_NEAR(at(1.5f, "HORIZONTAL"), 0.5f * (1.5f + 2), 1e-6f);
    EXPECT_NEAR(at(2.5f, "EXTRAPOLATED"), 0.5f * (2.5f + 5), 1e-6f);
    EXPECT_NEAR(at(4, "HORIZONTAL"), 0.5f * (4 + 6), 1e-6f);
    EXPECT_NEAR(at(4, "EXTRAPOLATED"), 0.5f * (4 + 8), 1e-6f);
    EXPECT_NEAR(at(0.5f, "EXTRAPOLATED"), 0.5f * (0.5f - 2), 1e-6f);
}

TEST(NormalNode, GivesItsDirectionAndTheCosineToIt) {
    const Constants in{{"Direction", {0, 3, 4}}, {"Normal", {0, 2, 0}}};
    expect_near(vector_of("normal", in, {}, "Normal"), {0, 0.6f, 0.8f}, 1e-6f);
    EXPECT_NEAR(scalar_of("normal", in, {}, "Dot"), 0.6f, 1e-6f);
}

TEST(VectorRotate, AboutAnAxis) {
    const float quarter = 0.5f * kPi;
    const auto rotated = [&](const Options& options) {
        return vector_of("vector_rotate",
                         {{"Vector", {2, 2, 3}},
                          {"Center", {1, 0, 0}},
                          {"Angle", {quarter}},
                          {"Axis", {0, 0, 2}},
                          {"Rotation", {0, 0, quarter}}},
                         options, "Vector");
    };
    expect_near(rotated({}), {-1, 1, 3}, 1e-6f);
    expect_near(rotated({{"rotation_type", "EULER_XYZ"}}), {-1, 1, 3}, 1e-6f);
    expect_near(rotated({{"invert", "True"}}), {3, -1, 3}, 1e-6f);
    expect_near(rotated({{"rotation_type", "X_AXIS"}}), {2, -3, 2}, 1e-6f);
}

// A factor that varies is the factor of a point, on constants and on what varies alike.
TEST(Converters, WhatVariesGivesWhatIsFolded) {
    TestPoint at;  // Object is (1, 2, 3)
    GraphBuilder b;
    const uint32_t split = b.node("separate_xyz"),
                   math = b.node("math", {{"Value_001", {0.5f}}}, {{"operation", "POWER"}});
    b.link(b.node("texture_coordinate"), "Object", split, "Vector");
    b.link(split, "Y", math, "Value");
    const Vec3 varied = value_of_graph(b, math, "Value", at.point);
    expect_near(varied, Vec3(std::sqrt(2.0f)), 1e-6f);
}

TEST(LookDependent, FresnelAndLayerWeight) {
    TestPoint at;
    const float cosine = dot(at.point.ng, at.point.wo);
    const auto value = [&](const std::string& kind, const Constants& in, const std::string& output) {
        GraphBuilder b;
        return value_of_graph(b, b.node(kind, in), output, at.point).x;
    };
    EXPECT_NEAR(value("fresnel", {{"IOR", {1.5f}}}, "Fac"), fresnel_dielectric(cosine, 1.5f), 1e-6f);
    EXPECT_NEAR(value("layer_weight", {{"Blend", {0.5f}}}, "Facing"), 1 - cosine, 1e-6f);
    EXPECT_NEAR(value("layer_weight", {{"Blend", {0.75f}}}, "Facing"), 1 - cosine * cosine, 1e-5f);
    EXPECT_NEAR(value("layer_weight", {{"Blend", {0.25f}}}, "Facing"), 1 - std::sqrt(cosine), 1e-5f);
    EXPECT_NEAR(value("layer_weight", {{"Blend", {0.5f}}}, "Fresnel"),
                fresnel_dielectric(cosine, 2.0f), 1e-6f);
    at.turn_to_back();
    EXPECT_NEAR(value("fresnel", {{"IOR", {1.5f}}}, "Fac"), fresnel_dielectric(cosine, 1 / 1.5f),
                1e-6f);
    EXPECT_NEAR(value("layer_weight", {{"Blend", {0.5f}}}, "Fresnel"),
                fresnel_dielectric(cosine, 0.5f), 1e-6f);
    EXPECT_EQ(value("geometry", {}, "Backfacing"), 1.0f);
}

// What depends on where it is seen from has no derivatives: chains do not turn on such a normal.
TEST(LookDependent, GivesNoCasterItsNormal) {
    GraphBuilder b;
    const uint32_t glossy = b.node("bsdf_glossy", {{"Roughness", {0}}});
    b.link(b.node("geometry"), "Incoming", glossy, "Normal");
    const Material material = compile(b.surface(glossy), {});
    EXPECT_FALSE(material.specular.exists());
    EXPECT_NE(material.specular.why_not.find("no derivatives"), std::string::npos);
}

}  // namespace
}  // namespace spc::test
