// SPDX-License-Identifier: GPL-3.0-or-later
// Material graphs that no host should send, through the public interface.
#include "support/api_scene.h"

namespace spc::test {
namespace {

// A graph as vectors, from one that is right: a textured, half emissive surface.
struct Parts {
    std::vector<spc_node> nodes{{"Out", "output", SPC_NONE},    {"Diff", "bsdf_diffuse", SPC_NONE},
                                {"Glow", "emission", SPC_NONE}, {"Sum", "add_shader", SPC_NONE},
                                {"Tex", "image_texture", 0},    {"Ramp", "color_ramp", SPC_NONE}};
    std::vector<float> table = std::vector<float>(8, 0.5f);
    std::vector<spc_node_array> arrays{{5, "Table", table.data(), 8}};
    std::vector<spc_node_input> inputs{{2, "Strength", {2, 0, 0, 0}}};
    std::vector<spc_node_option> options{{4, "interpolation", "Closest"}};
    std::vector<spc_node_link> links{{1, "BSDF", 3, "Shader"},
                                     {2, "Emission", 3, "Shader_001"},
                                     {3, "Shader", 0, "Surface"},
                                     {4, "Color", 1, "Color"}};

    spc_material_desc desc() const {
        auto d = sized<spc_material_desc>();
        d.name = "Plaster";
        d.nodes = nodes.data();
        d.node_count = static_cast<uint32_t>(nodes.size());
        d.inputs = inputs.data();
        d.input_count = static_cast<uint32_t>(inputs.size());
        d.options = options.data();
        d.option_count = static_cast<uint32_t>(options.size());
        d.arrays = arrays.data();
        d.array_count = static_cast<uint32_t>(arrays.size());
        d.links = links.data();
        d.link_count = static_cast<uint32_t>(links.size());
        return d;
    }
};

class MaterialMisuse : public ::testing::Test {
protected:
    void SetUp() override { add_resources(scene.get()); }

    void refuses(const spc_material_desc& desc, const std::vector<std::string>& words) {
        expect_refused(spc_scene_add_material(scene.get(), &desc, &index), SPC_INVALID_ARGUMENT,
                       words);
        EXPECT_EQ(index, 77u);
    }
    template <class Spoil>
    void refuses_parts(const std::vector<std::string>& words, const Spoil& spoil) {
        Parts parts;
        spoil(parts);
        refuses(parts.desc(), words);
    }
    template <class Spoil>
    void refuses_desc(const std::vector<std::string>& words, const Spoil& spoil) {
        const Parts parts;
        spc_material_desc desc = parts.desc();
        spoil(desc);
        refuses(desc, words);
    }

    ScenePtr scene = new_scene();
    uint32_t index = 77;
};

TEST_F(MaterialMisuse, ArraysAndNames) {
    refuses_desc({"material \"Plaster\": ", "nodes"}, [](auto& d) { d.nodes = nullptr; });
    refuses_desc({"Plaster", "nodes"}, [](auto& d) { d.node_count = 0; });
    refuses_desc({"Plaster", "inputs"}, [](auto& d) { d.inputs = nullptr; });
    refuses_desc({"Plaster", "options"}, [](auto& d) { d.options = nullptr; });
    refuses_desc({"Plaster", "arrays"}, [](auto& d) { d.arrays = nullptr; });
    refuses_desc({"Plaster", "links"}, [](auto& d) { d.links = nullptr; });
    refuses_parts({"Plaster", "kind"}, [](auto& p) { p.nodes[1].kind = nullptr; });
    refuses_parts({"Plaster", "Diff", "bsdf_fluffy"},
                  [](auto& p) { p.nodes[1].kind = "bsdf_fluffy"; });
    refuses_parts({"Plaster"}, [](auto& p) { p.nodes[1].kind = ""; });
    refuses_parts({"Plaster", "Tex", "image"}, [](auto& p) { p.nodes[4].image = 1; });
    refuses_parts({"Plaster", "Tex", "image"}, [](auto& p) { p.nodes[4].image = SPC_NONE; });
    refuses_parts({"Plaster", "socket"}, [](auto& p) { p.inputs[0].socket = nullptr; });
    refuses_parts({"Plaster", "option"}, [](auto& p) { p.options[0].option = nullptr; });
    refuses_parts({"Plaster", "option"}, [](auto& p) { p.options[0].value = nullptr; });
    refuses_parts({"Plaster", "socket"}, [](auto& p) { p.links[0].from_socket = nullptr; });
    refuses_parts({"Plaster", "socket"}, [](auto& p) { p.links[0].to_socket = nullptr; });
    for (const uint32_t beyond : {6u, SPC_NONE}) {
        refuses_parts({"Plaster", "input", "of 6"}, [&](auto& p) { p.inputs[0].node = beyond; });
        refuses_parts({"Plaster", "option", "of 6"}, [&](auto& p) { p.options[0].node = beyond; });
        refuses_parts({"Plaster", "array", "of 6"}, [&](auto& p) { p.arrays[0].node = beyond; });
        refuses_parts({"Plaster", "link", "of 6"}, [&](auto& p) { p.links[0].from_node = beyond; });
        refuses_parts({"Plaster", "link", "of 6"}, [&](auto& p) { p.links[0].to_node = beyond; });
    }
}

TEST_F(MaterialMisuse, SocketsOptionsAndLinks) {
    refuses_parts({"Plaster", "Glow", "Warmth"}, [](auto& p) { p.inputs[0].socket = "Warmth"; });
    refuses_parts({"Plaster", "Sum"}, [](auto& p) {
        p.inputs.push_back({3, "Shader", {1, 1, 1, 1}});
    });
    refuses_parts({"Plaster", "Glow", "Strength"}, [](auto& p) { p.inputs.push_back(p.inputs[0]); });
    for (const float bad : kNotFinite)
        for (size_t lane = 0; lane < 4; ++lane)
            refuses_parts({"Plaster", "Glow", "finite"},
                          [&](auto& p) { p.inputs[0].value[lane] = bad; });
    refuses_parts({"Plaster", "Tex", "softness"}, [](auto& p) { p.options[0].option = "softness"; });
    refuses_parts({"Plaster", "Tex", "Fuzzy"}, [](auto& p) { p.options[0].value = "Fuzzy"; });
    refuses_parts({"Plaster", "Tex"}, [](auto& p) { p.options[0].value = ""; });
    refuses_parts({"Plaster", "Tex"}, [](auto& p) { p.options[0].value = "Linear|Closest"; });
    refuses_parts({"Plaster", "Diff", "Glitter"},
                  [](auto& p) { p.links[0].from_socket = "Glitter"; });
    refuses_parts({"Plaster", "Sum", "Glitter"}, [](auto& p) { p.links[0].to_socket = "Glitter"; });
    refuses_parts({"Plaster", "Diff", "Color"}, [](auto& p) {
        p.links[3] = {2, "Emission", 1, "Color"};
    });
    refuses_parts({"Plaster", "Diff", "Color"}, [](auto& p) { p.links.push_back(p.links[3]); });
    refuses_parts({"Plaster", "cycle"}, [](auto& p) {
        p.links[1] = {3, "Shader", 3, "Shader_001"};
    });
    refuses_parts({"Plaster", "output"},
                  [](auto& p) { p.nodes[0].kind = "value", p.links.erase(p.links.begin() + 2); });
    refuses_parts({"Plaster", "output"}, [](auto& p) {
        p.nodes.push_back({"Out 2", "output", SPC_NONE});
    });
}

TEST_F(MaterialMisuse, ArraysOfNumbers) {
    refuses_parts({"Plaster", "an array", "null"}, [](auto& p) { p.arrays[0].name = nullptr; });
    refuses_parts({"Plaster", "Ramp", "null"}, [](auto& p) { p.arrays[0].values = nullptr; });
    refuses_parts({"Plaster", "Ramp", "Chair"}, [](auto& p) { p.arrays[0].name = "Chair"; });
    refuses_parts({"Plaster", "Tex", "no such array"}, [](auto& p) { p.arrays[0].node = 4; });
    refuses_parts({"Plaster", "Ramp", "twice"}, [](auto& p) { p.arrays.push_back(p.arrays[0]); });
    for (const uint32_t count : {0u, 4u, 7u})
        refuses_parts({"Plaster", "Ramp", "4 in each of at least two rows"},
                      [&](auto& p) { p.arrays[0].count = count; });
    for (const float bad : kNotFinite)
        refuses_parts({"Plaster", "Ramp", "finite"}, [&](auto& p) { p.table[3] = bad; });
    refuses_parts({"Plaster", "Ramp", "missing"}, [](auto& p) {
        p.arrays.clear();
        p.links[3] = {5, "Color", 1, "Color"};
    });
}

TEST_F(MaterialMisuse, TooManyClosures) {
    Parts parts;
    parts.nodes = {{"Out", "output", SPC_NONE}};
    parts.inputs.clear();
    parts.options.clear();
    parts.arrays.clear();
    parts.links.clear();
    uint32_t sum = SPC_NONE;
    for (uint32_t i = 0; i < 40; ++i) {
        const auto shader = static_cast<uint32_t>(parts.nodes.size());
        parts.nodes.push_back({"Gloss", "bsdf_glossy", SPC_NONE});
        if (sum == SPC_NONE) {
            sum = shader;
            continue;
        }
        parts.nodes.push_back({"Sum", "add_shader", SPC_NONE});
        parts.links.push_back({sum, i == 1 ? "BSDF" : "Shader", shader + 1, "Shader"});
        parts.links.push_back({shader, "BSDF", shader + 1, "Shader_001"});
        sum = shader + 1;
    }
    parts.links.push_back({sum, "Shader", 0, "Surface"});
    refuses(parts.desc(), {"Plaster", "closures"});
}

// A graph is data, so its depth must not be the depth of a stack.
TEST_F(MaterialMisuse, AVeryLongChainOfNodes) {
    constexpr uint32_t kLength = 50000;
    for (const bool varying : {false, true}) {
        Parts parts;
        parts.nodes = {{"Out", "output", SPC_NONE},
                       {"Diff", "bsdf_diffuse", SPC_NONE},
                       {"Coordinates", "texture_coordinate", SPC_NONE}};
        parts.inputs.clear();
        parts.options.clear();
        parts.arrays.clear();
        parts.links = {{1, "BSDF", 0, "Surface"}};
        for (uint32_t i = 0; i < kLength; ++i) parts.nodes.push_back({"Move", "mapping", SPC_NONE});
        for (uint32_t i = 0; i + 1 < kLength; ++i)
            parts.links.push_back({i + 3, "Vector", i + 4, "Vector"});
        if (varying) parts.links.push_back({2, "Object", 3, "Vector"});
        parts.links.push_back({kLength + 2, "Vector", 1, "Color"});
        const spc_material_desc desc = parts.desc();
        const spc_status status = spc_scene_add_material(scene.get(), &desc, &index);
        if (status != SPC_OK) expect_refused(status, SPC_INVALID_ARGUMENT, {"Plaster"});
    }
}

TEST_F(MaterialMisuse, UnknownChoices) {
    refuses_desc({"Plaster", "choice of glints", "3"},
                 [](spc_material_desc& desc) { desc.glints = 3; });
    refuses_desc({"Plaster", "bump correction", "3"},
                 [](spc_material_desc& desc) { desc.bump_correction = 3; });
}

TEST_F(MaterialMisuse, NamesMayBeMissing) {
    Parts parts;
    for (spc_node& node : parts.nodes) node.name = nullptr;
    spc_material_desc desc = parts.desc();
    desc.name = nullptr;
    ASSERT_EQ(spc_scene_add_material(scene.get(), &desc, &index), SPC_OK) << spc_last_error();
    parts.inputs[0].socket = "Warmth";
    desc = parts.desc();
    desc.name = nullptr;
    expect_refused(spc_scene_add_material(scene.get(), &desc, &index), SPC_INVALID_ARGUMENT,
                   {"material", "emission", "Warmth"});
}

TEST_F(MaterialMisuse, NeedsAreTold) {
    auto needs = sized<spc_material_needs>();
    ASSERT_EQ(spc_scene_material_needs(scene.get(), 0, &needs), SPC_OK);
    ASSERT_EQ(needs.attribute_count, 1u);
    EXPECT_EQ(needs.attributes[0].name, std::string());
    EXPECT_EQ(needs.attributes[0].kind, static_cast<uint32_t>(SPC_ATTRIBUTE_UV));
    EXPECT_EQ(needs.attributes[0].tangents, 0u);
    ASSERT_EQ(spc_scene_material_needs(scene.get(), 1, &needs), SPC_OK);
    EXPECT_EQ(needs.attribute_count, 0u);
    EXPECT_NE(std::string(spc_node_kinds()).find("bsdf_diffuse: in Color:color"), std::string::npos);
}

TEST_F(MaterialMisuse, TheForecastIsWhatTheSceneThenIs) {
    constexpr uint32_t kPlaster = 0, kSilver = 1;
    for (const uint32_t material : {kPlaster, kSilver})
        for (uint32_t role = SPC_CAUSTICS_AUTO; role <= SPC_CAUSTICS_BOTH; ++role)
            for (const uint32_t visibility : {SPC_VISIBLE_ALL, SPC_VISIBLE_CAMERA}) {
                const ScenePtr other = new_scene();
                add_resources(other.get());
                auto forecast = sized<spc_forecast>();
                ASSERT_EQ(spc_scene_forecast(other.get(), &material, 1, visibility, role, &forecast),
                          SPC_OK);
                const bool casts = forecast.search != SPC_SEARCH_NONE;
                const bool may_cast = role != SPC_CAUSTICS_OFF && role != SPC_CAUSTICS_RECEIVER;
                EXPECT_EQ(forecast.reason[0] != 0, may_cast);
                spc_instance_desc object = valid_instance(0, material);
                object.visibility = visibility;
                object.caustics_role = role;
                ASSERT_EQ(spc_scene_add_instance(other.get(), &object, &index), SPC_OK);
                const spc_camera_desc camera = valid_camera();
                ASSERT_EQ(spc_scene_set_camera(other.get(), &camera), SPC_OK);
                ASSERT_EQ(spc_scene_commit(other.get(), 1), SPC_OK);
                auto stats = sized<spc_scene_stats>();
                ASSERT_EQ(spc_scene_get_stats(other.get(), &stats), SPC_OK);
                EXPECT_EQ(stats.casters, casts ? 1u : 0u);
                EXPECT_EQ(stats.receivers, forecast.receives);
                expect_refused(
                    spc_scene_forecast(other.get(), &material, 1, visibility, role, &forecast),
                    SPC_WRONG_STATE, {"committed"});
            }
}

}  // namespace
}  // namespace spc::test
