// SPDX-License-Identifier: GPL-3.0-or-later
// Normal maps: values by hand, and the derivatives that manifold walks rest on by central
// differences.
#include "shading/graphs.h"

namespace spc::test {
namespace {

Graph mapped_mirror(const Constants& constants, const Options& options = {}, bool textured = false) {
    GraphBuilder b;
    const uint32_t glossy = b.node("bsdf_glossy", {{"Roughness", {0}}});
    const uint32_t map = b.node("normal_map", constants, options);
    b.link(map, "Normal", glossy, "Normal");
    if (textured) {
        const uint32_t image = b.node("image_texture", {}, {{"interpolation", "Cubic"}}, 0);
        b.link(image, "Color", map, "Color");
    }
    return b.surface(glossy);
}

Vec3 normal_of(const Graph& graph, const ShadingPoint<float>& point) {
    const Material material = compile(graph, {});
    EXPECT_TRUE(material.specular.mapped_normal);
    const Vec3 n = value_of(evaluate_caster_normal(material, {}, point));
    const ClosureList list = closures_of(material, point);  // the closure sees the same
    EXPECT_EQ(list.count, 1);
    if (list.count == 1)
        expect_near(std::get<MicrofacetReflection>(list.closures[0].kind).n, n, 0.0f);
    return n;
}

// Colour that encodes the vector (x, y, z).
std::vector<float> encoded(float x, float y, float z) {
    return {0.5f + 0.5f * x, 0.5f + 0.5f * y, 0.5f + 0.5f * z};
}

TEST(NormalMap, TangentSpace) {
    TestPoint at;
    const auto color = encoded(0.6f, 0, 0.8f);
    expect_near(normal_of(mapped_mirror({{"Color", color}}), at.point), {0.6f, 0, 0.8f}, 1e-6f);
    expect_near(normal_of(mapped_mirror({{"Color", encoded(0, 0.6f, 0.8f)}}), at.point),
                {0, 0.6f, 0.8f}, 1e-6f);
    at.sign[0] = -1;  // B = sign N x T
    expect_near(normal_of(mapped_mirror({{"Color", encoded(0, 0.6f, 0.8f)}}), at.point),
                {0, -0.6f, 0.8f}, 1e-6f);
    at.sign[0] = 1;
    // Strength scales the slopes; z goes from 1 to the map's, and no further.
    expect_near(normal_of(mapped_mirror({{"Color", color}, {"Strength", {0.5f}}}), at.point),
                normalize(Vec3(0.3f, 0, 0.9f)), 1e-6f);
    expect_near(normal_of(mapped_mirror({{"Color", color}, {"Strength", {2}}}), at.point),
                normalize(Vec3(1.2f, 0, 0.8f)), 1e-6f);
    expect_near(normal_of(mapped_mirror({{"Color", color}, {"Strength", {0}}}), at.point),
                {0, 0, 1}, 1e-6f);
    // The frame is not normalised.
    at.tangent[0] = {2, 0, 0};
    at.point.normal_object = {0, 0, 0.5f};
    expect_near(normal_of(mapped_mirror({{"Color", color}}), at.point),
                normalize(Vec3(1.2f, 0, 0.4f)), 1e-6f);
    // Without tangents the map is flat.
    at.point.tangent_object = nullptr;
    expect_near(normal_of(mapped_mirror({{"Color", color}}), at.point), {0, 0, 1}, 0.0f);
}

TEST(NormalMap, TransformsAndBackFaces) {
    TestPoint at;
    Transform squash;  // x by 1/2, mirrored in y
    squash.row[0] = Vec3(0.5f, 0, 0);
    squash.row[1] = Vec3(0, -1, 0);
    at.set(squash);
    const Graph graph = mapped_mirror({{"Color", encoded(0.6f, 0.3f, 0.8f)}});
    const Vec3 expected = normalize(Vec3(1.2f, -0.3f, 0.8f));  // by the inverse transpose
    expect_near(normal_of(graph, at.point), expected, 1e-6f);
    at.turn_to_back();
    expect_near(normal_of(graph, at.point), -expected, 1e-6f);
}

TEST(NormalMap, ObjectAndWorldSpace) {
    TestPoint at;
    Transform stretch;
    stretch.row[2] = Vec3(0, 0, 2);
    at.set(stretch);
    const Constants color{{"Color", encoded(0.6f, 0, 0.8f)}};
    expect_near(normal_of(mapped_mirror(color, {{"space", "WORLD"}}), at.point), {0.6f, 0, 0.8f},
                1e-6f);
    expect_near(normal_of(mapped_mirror(color, {{"space", "OBJECT"}}), at.point),
                normalize(Vec3(0.6f, 0, 0.4f)), 1e-6f);
    const Constants half{{"Color", encoded(0.6f, 0, 0.8f)}, {"Strength", {0.5f}}};
    expect_near(normal_of(mapped_mirror(half, {{"space", "WORLD"}}), at.point),
                normalize(Vec3(0.3f, 0, 0.9f)), 1e-6f);
    at.turn_to_back();
    expect_near(normal_of(mapped_mirror(half, {{"space", "WORLD"}}), at.point),
                -normalize(Vec3(0.3f, 0, 0.9f)), 1e-6f);
    // A map that says nothing leaves the interpolated normal.
    expect_near(
        normal_of(mapped_mirror({{"Color", {0.5f, 0.5f, 0.5f}}}, {{"space", "WORLD"}}), at.point),
        {0, 0, -1}, 1e-6f);
}

TEST(NormalMap, AnyVectorWillDoAsANormal) {
    TestPoint at;
    GraphBuilder b;
    const uint32_t diffuse = b.node("bsdf_diffuse");
    b.link(b.node("rgb", {{"Color", {0, 3, 4}}}), "Color", diffuse, "Normal");
    const ClosureList list = closures_of(compile(b.surface(diffuse), {}), at.point);
    expect_near(std::get<Lambert>(list.closures[0].kind).n, {0, 0.6f, 0.8f}, 1e-6f);
    GraphBuilder zero;
    const uint32_t other = zero.node("bsdf_diffuse");
    zero.link(zero.node("rgb", {{"Color", {0, 0, 0}}}), "Color", other, "Normal");
    expect_near(
        std::get<Lambert>(closures_of(compile(zero.surface(other), {}), at.point).closures[0].kind).n,
        {0, 0, 1}, 0.0f);
}

// A patch of surface over (u, v), everything a smooth function of them in double, with derivatives
// by differences in double: what a triangle with interpolated corners offers, and more.
struct Patch {
    Vec3d normal[3], tangent[3], world[3];  // value at 0, slope by u, slope by v
    double uv0[2], uv_u[2], uv_v[2];
    float sign;
    Transform object_to_world, world_to_object;
    bool backfacing;

    explicit Patch(Uniforms& random) {
        const auto unit = [&] { return Vec3d(random() - 0.5f, random() - 0.5f, random() - 0.5f); };
        normal[0] = Vec3d(0, 0, 1) + unit() * 0.4;
        tangent[0] = Vec3d(1, 0, 0) + unit() * 0.4;
        for (int i = 1; i < 3; ++i) {
            normal[i] = unit() * 0.6;
            tangent[i] = unit() * 0.6;
        }
        for (int i = 0; i < 2; ++i) {
            uv0[i] = random();
            uv_u[i] = random() - 0.5;
            uv_v[i] = random() - 0.5;
        }
        sign = random() < 0.5f ? -1.0f : 1.0f;
        const float mirror = random() < 0.5f ? -1.0f : 1.0f;
        for (int i = 0; i < 3; ++i) {
            object_to_world.row[static_cast<size_t>(i)] = Vec3(random(), random(), random()) * 0.5f;
            object_to_world.row[static_cast<size_t>(i)][i] += i == 1 ? mirror * 2.0f : 1.0f;
        }
        world_to_object = object_to_world.inverse();
        backfacing = random() < 0.5f;
    }
    static Vec3d at(const Vec3d (&field)[3], double u, double v) {
        return field[0] + field[1] * u + field[2] * v;
    }
    Vec3d world_normal(double u, double v) const {
        const Vec3d n = at(normal, u, v);
        Vec3d w(0.0);
        for (int i = 0; i < 3; ++i) w += Vec3d(world_to_object.row[static_cast<size_t>(i)]) * n[i];
        return normalize(w);
    }

    struct Storage {
        Vector3<Dual2> tangent;
        std::array<Dual2, 4> uv;
    };
    ShadingPoint<Dual2> dual_point(Storage& storage) const {
        ShadingPoint<Dual2> p{};
        constexpr double kStep = 1e-6;
        const Vec3d du = (world_normal(kStep, 0) - world_normal(-kStep, 0)) / (2 * kStep);
        const Vec3d dv = (world_normal(0, kStep) - world_normal(0, -kStep)) / (2 * kStep);
        p.normal = dual(Vec3(world_normal(0, 0)), Vec3(du), Vec3(dv));
        p.normal_object = dual(Vec3(normal[0]), Vec3(normal[1]), Vec3(normal[2]));
        storage.tangent = dual(Vec3(tangent[0]), Vec3(tangent[1]), Vec3(tangent[2]));
        for (size_t i = 0; i < 2; ++i)
            storage.uv[i] = Dual2(static_cast<float>(uv0[i]), static_cast<float>(uv_u[i]),
                                  static_cast<float>(uv_v[i]));
        p.tangent_object = &storage.tangent;
        p.attributes = &storage.uv;
        finish(p);
        return p;
    }
    struct FloatStorage {
        Vector3<float> tangent;
        std::array<float, 4> uv;
    };
    ShadingPoint<float> float_point(double u, double v, FloatStorage& storage) const {
        ShadingPoint<float> p{};
        p.normal = to_vector(Vec3(world_normal(u, v)));
        p.normal_object = to_vector(Vec3(at(normal, u, v)));
        storage.tangent = to_vector(Vec3(at(tangent, u, v)));
        for (size_t i = 0; i < 2; ++i)
            storage.uv[i] = static_cast<float>(uv0[i] + uv_u[i] * u + uv_v[i] * v);
        p.tangent_object = &storage.tangent;
        p.attributes = &storage.uv;
        finish(p);
        return p;
    }
    template <class T>
    void finish(ShadingPoint<T>& p) const {
        p.bitangent_sign = &sign;
        p.object_to_world = &object_to_world;
        p.world_to_object = &world_to_object;
        p.backfacing = backfacing;
    }
};

TEST(NormalMap, DerivativesMatchCentralDifferences) {
    Uniforms random(11);
    std::vector<float> floats(size_t{6} * 5 * 3);
    for (float& f : floats) f = 0.3f + 0.4f * random();
    std::vector<uint8_t> bytes(floats.size());
    for (size_t i = 0; i < floats.size(); ++i) bytes[i] = static_cast<uint8_t>(255 * floats[i]);
    const std::vector<Image> images[] = {
        {image_from_floats("f", floats, 6, 5, 3, ColorSpace::data, AlphaMode::none)},
        {image_from_bytes("b", bytes, 6, 5, 3, ColorSpace::data, AlphaMode::none)},
        {image_from_bytes("s", bytes, 6, 5, 3, ColorSpace::srgb, AlphaMode::none)}};
    for (const char* space : {"TANGENT", "OBJECT", "WORLD"}) {
        for (const float strength : {1.0f, 0.4f, 1.7f}) {
            for (const std::vector<Image>& image : images) {
                const Material material = compile(
                    mapped_mirror({{"Strength", {strength}}}, {{"space", space}}, true), image);
                for (int n = 0; n < 60; ++n) {
                    const Patch patch(random);
                    Patch::Storage dual_storage;
                    const Vector3<Dual2> got =
                        evaluate_caster_normal(material, image, patch.dual_point(dual_storage));
                    Patch::FloatStorage storage;
                    const auto at = [&](double u, double v) {
                        return value_of(evaluate_caster_normal(material, image,
                                                               patch.float_point(u, v, storage)));
                    };
                    // Richardson's combination of two steps: fourth order, rounding about 1e-7 /
                    // step.
                    const auto difference = [&](double u, double v) {
                        constexpr double kStep = 2e-3;
                        const auto over = [&](double h) {
                            return (Vec3d(at(h * u, h * v)) - Vec3d(at(-h * u, -h * v))) / (2 * h);
                        };
                        return Vec3((over(kStep) * 4.0 - over(2 * kStep)) / 3.0);
                    };
                    const Vec3 du = difference(1, 0), dv = difference(0, 1);
                    expect_near(value_of(got), at(0, 0), 2e-6f);
                    EXPECT_NEAR(length(value_of(got)), 1.0f, 1e-6f);
                    const float scale = 1.0f + length(du) + length(dv);
                    expect_near(derivative_u(got), du, 1e-3f * scale);
                    expect_near(derivative_v(got), dv, 1e-3f * scale);
                }
            }
        }
    }
}

TEST(NormalMap, UnmappedNormalKeepsItsDerivative) {
    Uniforms random(5);
    const Material material = compile(single("bsdf_glass"), {});
    EXPECT_FALSE(material.specular.mapped_normal);
    for (int n = 0; n < 8; ++n) {
        const Patch patch(random);
        Patch::Storage storage;
        const ShadingPoint<Dual2> point = patch.dual_point(storage);
        const Vector3<Dual2> got = evaluate_caster_normal(material, {}, point);
        const float sign = patch.backfacing ? -1.0f : 1.0f;
        expect_near(value_of(got), value_of(point.normal) * sign, 0.0f);
        expect_near(derivative_u(got), derivative_u(point.normal) * sign, 0.0f);
    }
}

TEST(NormalMap, ReadsAndLayers) {
    const Material material = compile(mapped_mirror({}, {{"uv_map", "Detail"}}), {});
    EXPECT_EQ(material.normal_reads, static_cast<uint32_t>(kReadsTangent | kReadsObjectNormal));
    EXPECT_EQ(material.attributes, (std::vector<AttributeName>{{AttributeKind::uv, "Detail"}}));
    const Material world =
        compile(mapped_mirror({}, {{"space", "WORLD"}, {"uv_map", "Detail"}}), {});
    EXPECT_EQ(world.reads, 0u);
    EXPECT_TRUE(world.attributes.empty());
}

}  // namespace
}  // namespace spc::test
