// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene built through the public C interface alone, and its descriptors to spoil one by
// one.
#pragma once

#include "specula/specula.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace spc::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNotFinite[] = {kNan, kInf, -kInf};

struct SceneDeleter {
    void operator()(spc_scene* scene) const { spc_scene_destroy(scene); }
};
struct SessionDeleter {
    void operator()(spc_session* session) const { spc_session_destroy(session); }
};
using ScenePtr = std::unique_ptr<spc_scene, SceneDeleter>;
using SessionPtr = std::unique_ptr<spc_session, SessionDeleter>;

template <class T>
T sized() {
    T desc{};
    desc.struct_size = sizeof(T);
    return desc;
}

// Whether a call was refused with this status and a message that has all of the words.
inline void expect_refused(spc_status actual, spc_status expected,
                           const std::vector<std::string>& words) {
    EXPECT_EQ(actual, expected) << spc_last_error();
    if (actual == SPC_OK) return;
    const std::string message = spc_last_error();
    const bool for_the_user = expected != SPC_INTERNAL_ERROR;
    EXPECT_EQ(message.find("spc_") == std::string::npos, for_the_user) << message;
    for (const std::string& word : words)
        EXPECT_NE(message.find(word), std::string::npos) << "no \"" << word << "\" in: " << message;
}

// ---- valid descriptors; what they point to is static

inline spc_image_desc valid_image() {
    static const uint8_t texels[2][2][3] = {{{255, 128, 0}, {20, 200, 90}},
                                            {{0, 50, 255}, {240, 240, 240}}};
    auto desc = sized<spc_image_desc>();
    desc.name = "Bricks";
    desc.pixels = texels;
    desc.width = desc.height = 2;
    desc.channels = 3;
    desc.pixel_type = SPC_PIXEL_U8;
    desc.color_space = SPC_COLOR_SRGB;
    return desc;
}

inline spc_material_desc one_shader(const char* name, const spc_node (&nodes)[2],
                                    const spc_node_link& link) {
    auto desc = sized<spc_material_desc>();
    desc.name = name;
    desc.nodes = nodes;
    desc.node_count = 2;
    desc.links = &link;
    desc.link_count = 1;
    return desc;
}

// An image on a diffuse surface: needs image 0.
inline spc_material_desc textured_material() {
    static const spc_node nodes[] = {{"Out", "output", SPC_NONE},
                                     {"Diff", "bsdf_diffuse", SPC_NONE},
                                     {"Tex", "image_texture", 0}};
    static const spc_node_input inputs[] = {{1, "Roughness", {0, 0, 0, 0}}};
    static const spc_node_option options[] = {{2, "interpolation", "Closest"}};
    static const spc_node_link links[] = {{1, "BSDF", 0, "Surface"}, {2, "Color", 1, "Color"}};
    auto desc = sized<spc_material_desc>();
    desc.name = "Plaster";
    desc.nodes = nodes;
    desc.node_count = 3;
    desc.inputs = inputs;
    desc.input_count = 1;
    desc.options = options;
    desc.option_count = 1;
    desc.links = links;
    desc.link_count = 2;
    return desc;
}
inline spc_material_desc mirror_material() {
    static const spc_node nodes[] = {{"Out", "output", SPC_NONE},
                                     {"Gloss", "bsdf_glossy", SPC_NONE}};
    static const spc_node_link link = {1, "BSDF", 0, "Surface"};
    static const spc_node_input smooth = {1, "Roughness", {0, 0, 0, 0}};
    spc_material_desc desc = one_shader("Silver", nodes, link);
    desc.inputs = &smooth;
    desc.input_count = 1;
    return desc;
}
inline spc_material_desc sky_material() {
    static const spc_node nodes[] = {{"Out", "output", SPC_NONE}, {"Sky", "background", SPC_NONE}};
    static const spc_node_link link = {1, "Background", 0, "Surface"};
    return one_shader("Heaven", nodes, link);
}

// A UV layer for its six corners.
inline spc_attribute unwrap(const float* uv, const float* tangents) {
    return {"Unwrap", SPC_ATTRIBUTE_UV, SPC_DOMAIN_CORNER, 2, uv, tangents};
}

inline spc_mesh_desc valid_mesh() {
    static const float positions[] = {-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0};
    static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    static const float uv[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
    static const spc_attribute layer = unwrap(uv, nullptr);
    auto desc = sized<spc_mesh_desc>();
    desc.name = "Slate";
    desc.positions = positions;
    desc.vertex_count = 4;
    desc.triangles = triangles;
    desc.triangle_count = 2;
    desc.slot_count = 1;
    desc.attributes = &layer;
    desc.attribute_count = 1;
    return desc;
}

inline void set_identity(float (&m)[12]) {
    const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    std::copy(identity, identity + 12, m);
}

inline spc_instance_desc valid_instance(uint32_t mesh, const uint32_t& material) {
    auto desc = sized<spc_instance_desc>();
    desc.name = "Yard";
    desc.mesh = mesh;
    set_identity(desc.transform);
    desc.materials = &material;
    desc.material_count = 1;
    desc.visibility = SPC_VISIBLE_ALL;
    return desc;
}

// Index of a mesh of a million triangles, whose tree takes a while.
inline uint32_t add_large_mesh(spc_scene* scene) {
    constexpr uint32_t kSide = 700;
    std::vector<float> positions;
    std::vector<uint32_t> triangles;
    for (uint32_t i = 0; i < kSide * kSide; ++i)
        for (const float x : {float(i % kSide), float(i / kSide), 0.0f}) positions.push_back(x);
    for (uint32_t i = 0; i + kSide + 1 < kSide * kSide; ++i)
        for (const uint32_t corner : {i, i + 1, i + kSide, i + 1, i + kSide, i + kSide + 1})
            triangles.push_back(corner);
    spc_mesh_desc mesh = valid_mesh();
    mesh.positions = positions.data();
    mesh.vertex_count = kSide * kSide;
    mesh.triangles = triangles.data();
    mesh.triangle_count = static_cast<uint32_t>(triangles.size() / 3);
    mesh.attribute_count = 0;
    uint32_t index = SPC_NONE;
    EXPECT_EQ(spc_scene_add_mesh(scene, &mesh, &index), SPC_OK) << spc_last_error();
    return index;
}

inline spc_light_desc valid_light(uint32_t type) {
    auto desc = sized<spc_light_desc>();
    desc.name = "Lantern";
    desc.type = type;
    set_identity(desc.transform);
    desc.transform[3] = 0.5f;
    desc.transform[11] = 1.5f;
    desc.power[0] = desc.power[1] = desc.power[2] = 20.0f;
    desc.radius = 0.1f;
    desc.spot_angle = 1.0f;
    desc.spot_blend = 0.5f;
    desc.sun_angle = 0.01f;
    desc.size[0] = desc.size[1] = 0.5f;
    desc.spread = 2.0f;
    desc.visibility = SPC_VISIBLE_ALL;
    desc.feeds_caustics = 1;
    desc.material = SPC_NONE;
    desc.max_bounces = 1024;
    return desc;
}

inline spc_camera_desc valid_camera(uint32_t width = 12, uint32_t height = 8) {
    auto desc = sized<spc_camera_desc>();
    set_identity(desc.transform);
    desc.transform[11] = 4.0f;
    desc.width = desc.crop[2] = width;
    desc.height = desc.crop[3] = height;
    const float viewplane[] = {-0.6f, 0.6f, -0.4f, 0.4f};
    std::copy(viewplane, viewplane + 4, desc.viewplane);
    desc.clip_near = 0.01f;
    desc.clip_far = 100.0f;
    return desc;
}

// ---- the scene: a textured floor, a mirror as wall, a lamp and a grey sky

inline ScenePtr new_scene() {
    spc_scene* scene = nullptr;
    EXPECT_EQ(spc_scene_create(&scene), SPC_OK);
    return ScenePtr(scene);
}

inline ScenePtr edited(const spc_scene* before) {
    spc_scene* scene = nullptr;
    EXPECT_EQ(spc_scene_edit(before, &scene), SPC_OK) << spc_last_error();
    return ScenePtr(scene);
}

// Image 0; materials 0 plaster, 1 silver, 2 sky; mesh 0.
inline void add_resources(spc_scene* scene) {
    uint32_t index;
    const spc_image_desc image = valid_image();
    ASSERT_EQ(spc_scene_add_image(scene, &image, &index), SPC_OK) << spc_last_error();
    ASSERT_EQ(index, 0u);
    const spc_material_desc materials[] = {textured_material(), mirror_material(), sky_material()};
    for (uint32_t i = 0; i < 3; ++i) {
        ASSERT_EQ(spc_scene_add_material(scene, &materials[i], &index), SPC_OK) << spc_last_error();
        ASSERT_EQ(index, i);
    }
    const spc_mesh_desc mesh = valid_mesh();
    ASSERT_EQ(spc_scene_add_mesh(scene, &mesh, &index), SPC_OK) << spc_last_error();
    ASSERT_EQ(index, 0u);
}

// Those of the scene before, in an edited one.
inline void keep_resources(spc_scene* scene) {
    uint32_t index;
    ASSERT_EQ(spc_scene_keep_image(scene, 0, &index), SPC_OK) << spc_last_error();
    for (uint32_t i = 0; i < 3; ++i)
        ASSERT_EQ(spc_scene_keep_material(scene, i, &index), SPC_OK) << spc_last_error();
    ASSERT_EQ(spc_scene_keep_mesh(scene, 0, &index), SPC_OK) << spc_last_error();
}

inline void add_objects(spc_scene* scene, const spc_camera_desc& camera = valid_camera()) {
    uint32_t index;
    const uint32_t plaster = 0, silver = 1;
    const spc_instance_desc floor = valid_instance(0, plaster);
    ASSERT_EQ(spc_scene_add_instance(scene, &floor, &index), SPC_OK) << spc_last_error();
    ASSERT_EQ(index, 0u);
    spc_instance_desc wall = valid_instance(0, silver);
    wall.name = "Mirror";
    const float upright[12] = {0, 0, 1, -1, 0, 0.4f, 0, 0, -0.4f, 0, 0, 0.8f};  // faces +x
    std::copy(upright, upright + 12, wall.transform);
    ASSERT_EQ(spc_scene_add_instance(scene, &wall, &index), SPC_OK) << spc_last_error();
    const spc_light_desc light = valid_light(SPC_LIGHT_POINT);
    ASSERT_EQ(spc_scene_add_light(scene, &light, &index), SPC_OK) << spc_last_error();
    ASSERT_EQ(index, 0u);
    auto world = sized<spc_environment_desc>();
    world.material = 2;
    world.visibility = SPC_VISIBLE_ALL;
    ASSERT_EQ(spc_scene_set_environment(scene, &world), SPC_OK) << spc_last_error();
    ASSERT_EQ(spc_scene_set_camera(scene, &camera), SPC_OK) << spc_last_error();
}

inline ScenePtr committed_scene(const spc_camera_desc& camera = valid_camera()) {
    ScenePtr scene = new_scene();
    add_resources(scene.get());
    add_objects(scene.get(), camera);
    EXPECT_EQ(spc_scene_commit(scene.get(), 1), SPC_OK) << spc_last_error();
    return scene;
}

// What has ended a commit that was started.
inline spc_status end_of_commit(spc_scene* scene) {
    uint32_t ended = 0;
    spc_status status = SPC_OK;
    while (status == SPC_OK && ended == 0) status = spc_scene_commit_wait(scene, 1000, &ended);
    return status;
}

// By walks, which need next to no preparation.
inline spc_render_settings quick_settings(uint32_t samples = 2) {
    spc_render_settings settings;
    spc_render_settings_init(&settings);
    settings.method = SPC_METHOD_SMS_UNBIASED;
    settings.samples = samples;
    settings.threads = 1;
    settings.passes = (uint64_t{1} << SPC_PASS_COUNT) - 1;
    return settings;
}

inline SessionPtr start(const spc_scene* scene, const spc_render_settings& settings) {
    spc_session* session = nullptr;
    EXPECT_EQ(spc_render_start(scene, &settings, &session), SPC_OK) << spc_last_error();
    return SessionPtr(session);
}

inline spc_render_progress wait_for(spc_session* session, uint32_t milliseconds = 60000) {
    auto progress = sized<spc_render_progress>();
    EXPECT_EQ(spc_render_wait(session, milliseconds, &progress), SPC_OK) << spc_last_error();
    return progress;
}

inline std::vector<float> read_pass(spc_session* session, uint32_t pass, uint32_t width,
                                    uint32_t height) {
    std::vector<float> buffer(static_cast<size_t>(width) * height * spc_pass_channels(pass), -1.0f);
    EXPECT_EQ(spc_film_read(session, pass, buffer.data(), buffer.size()), SPC_OK)
        << spc_last_error();
    return buffer;
}

// All passes of a finished render of the 12 x 8 scene, one after the other.
inline std::vector<float> render_all(const spc_scene* scene, const spc_render_settings& settings,
                                     uint32_t width = 12, uint32_t height = 8) {
    const SessionPtr session = start(scene, settings);
    std::vector<float> all;
    if (!session) return all;
    EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE));
    for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) {
        const std::vector<float> one = read_pass(session.get(), pass, width, height);
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && !a.empty() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace spc::test
