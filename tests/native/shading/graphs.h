// SPDX-License-Identifier: GPL-3.0-or-later
// Graphs and points for the tests of shading.
#pragma once

#include <gtest/gtest.h>

#include "core/error.h"
#include "shading/program.h"
#include "support/numerics.h"

namespace spc::test {

using Constants = std::vector<std::pair<std::string, std::vector<float>>>;
using Options = std::vector<std::pair<std::string, std::string>>;

// The node's number is its handle; names are "kind.number".
class GraphBuilder {
public:
    GraphBuilder() { graph.name = "Mat"; }

    uint32_t node(const std::string& kind, const Constants& constants = {},
                  const Options& options = {}, uint32_t image = kNone) {
        const uint32_t index = static_cast<uint32_t>(graph.nodes.size());
        graph.nodes.push_back({kind + "." + std::to_string(index), kind, image});
        for (const auto& [socket, value] : constants) {
            GraphInput input{index, socket, {}};
            std::copy(value.begin(), value.end(), input.value.begin());
            graph.inputs.push_back(input);
        }
        for (const auto& [name, value] : options) graph.options.push_back({index, name, value});
        return index;
    }
    GraphBuilder& link(uint32_t from, const std::string& from_socket, uint32_t to,
                       const std::string& to_socket) {
        graph.links.push_back({from, from_socket, to, to_socket});
        return *this;
    }
    // An output under the shader `from`.
    Graph& surface(uint32_t from, const std::string& socket = "BSDF") {
        link(from, socket, node("output"), "Surface");
        return graph;
    }

    Graph graph;
};

// A material of one shader.
inline Graph single(const std::string& kind, const Constants& constants = {},
                    const Options& options = {}, const std::string& socket = "BSDF") {
    GraphBuilder b;
    return b.surface(b.node(kind, constants, options), socket);
}

// A point of a surface that stands as it is: everything set, frame (T, B, N) = (X, Y, Z).
struct TestPoint {
    Transform object_to_world, world_to_object;
    Vector3<float> tangent[2]{{1, 0, 0}, {1, 0, 0}};
    float sign[2]{1, 1};
    std::array<float, 4> attributes[2]{{0.25f, 0.75f, 0, 1}, {0.5f, 0.5f, 0, 1}};
    ShadingPoint<float> point{};

    TestPoint() { set(Transform{}); }
    void set(const Transform& transform) {
        object_to_world = transform;
        world_to_object = transform.inverse();
        point.normal_object = {0, 0, 1};
        point.position_object = {1, 2, 3};
        point.position = to_vector(transform.point(Vec3(1, 2, 3)));
        point.normal = to_vector(normalize(world_to_object.transposed(Vec3(0, 0, 1))));
        point.tangent_object = tangent;
        point.bitangent_sign = sign;
        point.attributes = attributes;
        point.object_to_world = &object_to_world;
        point.world_to_object = &world_to_object;
        point.ng = value_of(point.normal);
        point.wo = normalize(point.ng + Frame::around(point.ng).x * 0.3f);
        point.backfacing = false;
    }
    void turn_to_back() {
        point.backfacing = true;
        point.ng = -point.ng;
        point.wo = -point.wo;
    }
};

inline ClosureList closures_of(const Material& material, const ShadingPoint<float>& point,
                               std::span<const Image> images = {}) {
    ClosureList list;
    evaluate_closures(material, images, point, list);
    return list;
}
inline ClosureList closures_of(const Graph& graph) {
    const TestPoint at;
    return closures_of(compile(graph, {}), at.point);
}

// A value seen as an emission: the last node's `socket`.
inline Vec3 value_of_graph(GraphBuilder& b, uint32_t node, const std::string& socket,
                           const ShadingPoint<float>& point, std::span<const Image> images = {}) {
    const uint32_t emission = b.node("emission");
    b.link(node, socket, emission, "Color");
    const Material material = compile(b.surface(emission, "Emission"), images);
    return Vec3(evaluate_emission(material, images, point));
}

inline void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

}  // namespace spc::test
