// SPDX-License-Identifier: GPL-3.0-or-later
// Every call on a scene misused on purpose. Each test ends with the scene completed and rendered:
// it must give the image of a scene that nobody has tried to break.
#include "support/api_scene.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace spc::test {
namespace {

// These numbers, and those that are not finite.
std::vector<float> beyond(std::vector<float> values) {
    values.insert(values.end(), std::begin(kNotFinite), std::end(kNotFinite));
    return values;
}

class SceneMisuse : public ::testing::Test {
protected:
    void SetUp() override {
        handle_ = new_scene();
        scene = handle_.get();
        add_resources(scene);
    }
    void TearDown() override {
        if (HasFatalFailure()) return;
        add_objects(scene);
        ASSERT_EQ(spc_scene_commit(scene, 1), SPC_OK) << spc_last_error();
        static const std::vector<float> untouched =
            render_all(committed_scene().get(), quick_settings());
        EXPECT_TRUE(same_bits(render_all(scene, quick_settings()), untouched))
            << "a refused call left its mark";
    }

    void refuses(const spc_image_desc& desc, const std::vector<std::string>& words,
                 spc_status status = SPC_INVALID_ARGUMENT) {
        expect_refused(spc_scene_add_image(scene, &desc, &index), status, words);
    }
    void refuses(const spc_mesh_desc& desc, const std::vector<std::string>& words) {
        expect_refused(spc_scene_add_mesh(scene, &desc, &index), SPC_INVALID_ARGUMENT, words);
    }
    void refuses(const spc_instance_desc& desc, const std::vector<std::string>& words) {
        expect_refused(spc_scene_add_instance(scene, &desc, &index), SPC_INVALID_ARGUMENT, words);
    }
    void refuses(const spc_light_desc& desc, const std::vector<std::string>& words) {
        expect_refused(spc_scene_add_light(scene, &desc, &index), SPC_INVALID_ARGUMENT, words);
    }
    void refuses(const spc_camera_desc& desc, std::vector<std::string> words = {}) {
        words.push_back("camera: ");
        expect_refused(spc_scene_set_camera(scene, &desc), SPC_INVALID_ARGUMENT, words);
    }

    // `call(scene, &desc, &index)` with what is missing or of another version.
    template <class Desc, class Add>
    void refuses_broken_arguments(const Desc& desc, const Add& add) {
        expect_refused(add(nullptr, &desc, &index), SPC_INVALID_ARGUMENT, {"scene"});
        expect_refused(add(scene, nullptr, &index), SPC_INVALID_ARGUMENT, {"desc"});
        expect_refused(add(scene, &desc, nullptr), SPC_INVALID_ARGUMENT, {"index"});
        for (const size_t size : {size_t{0}, sizeof(Desc) - 1, sizeof(Desc) + 8, ~size_t{0}}) {
            Desc other = desc;
            other.struct_size = size;
            expect_refused(add(scene, &other, &index), SPC_INVALID_ARGUMENT, {"struct_size"});
        }
        EXPECT_EQ(index, 77u) << "a refused call wrote its result";
    }

    spc_scene* scene = nullptr;
    uint32_t index = 77;

private:
    ScenePtr handle_;
};

TEST_F(SceneMisuse, MissingArgumentsAndOtherVersions) {
    const uint32_t material = 0;
    refuses_broken_arguments(valid_image(), spc_scene_add_image);
    refuses_broken_arguments(textured_material(), spc_scene_add_material);
    refuses_broken_arguments(valid_mesh(), spc_scene_add_mesh);
    refuses_broken_arguments(valid_instance(0, material), spc_scene_add_instance);
    refuses_broken_arguments(valid_light(SPC_LIGHT_AREA), spc_scene_add_light);

    const spc_camera_desc camera = valid_camera();
    expect_refused(spc_scene_set_camera(nullptr, &camera), SPC_INVALID_ARGUMENT, {"scene"});
    expect_refused(spc_scene_set_camera(scene, nullptr), SPC_INVALID_ARGUMENT, {"desc"});
    auto world = sized<spc_environment_desc>();
    expect_refused(spc_scene_set_environment(nullptr, &world), SPC_INVALID_ARGUMENT, {"scene"});
    expect_refused(spc_scene_set_environment(scene, nullptr), SPC_INVALID_ARGUMENT, {"desc"});
    world.struct_size = 1;
    expect_refused(spc_scene_set_environment(scene, &world), SPC_INVALID_ARGUMENT, {"struct_size"});

    auto needs = sized<spc_material_needs>();
    expect_refused(spc_scene_material_needs(nullptr, 0, &needs), SPC_INVALID_ARGUMENT, {"scene"});
    expect_refused(spc_scene_material_needs(scene, 0, nullptr), SPC_INVALID_ARGUMENT, {"needs"});
    expect_refused(spc_scene_material_needs(scene, 3, &needs), SPC_INVALID_ARGUMENT, {"3"});
    needs.struct_size = 3;
    expect_refused(spc_scene_material_needs(scene, 0, &needs), SPC_INVALID_ARGUMENT,
                   {"struct_size"});

    const auto refuses_forecast = [&](const std::string& word, spc_scene* of,
                                      const uint32_t* materials, uint32_t count,
                                      uint32_t visibility, uint32_t role, size_t size) {
        auto forecast = sized<spc_forecast>();
        forecast.struct_size = size;
        expect_refused(spc_scene_forecast(of, materials, count, visibility, role, &forecast),
                       SPC_INVALID_ARGUMENT, {word});
    };
    constexpr size_t kSize = sizeof(spc_forecast);
    const uint32_t unknown = 99;
    refuses_forecast("scene", nullptr, &material, 1, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO, kSize);
    refuses_forecast("materials", scene, nullptr, 1, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO, kSize);
    refuses_forecast("materials", scene, &material, 0, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO, kSize);
    refuses_forecast("99", scene, &unknown, 1, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO, kSize);
    refuses_forecast("visibility", scene, &material, 1, 32, SPC_CAUSTICS_AUTO, kSize);
    refuses_forecast("role", scene, &material, 1, SPC_VISIBLE_ALL, 5, kSize);
    refuses_forecast("struct_size", scene, &material, 1, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO,
                     kSize - 1);
    expect_refused(
        spc_scene_forecast(scene, &material, 1, SPC_VISIBLE_ALL, SPC_CAUSTICS_AUTO, nullptr),
        SPC_INVALID_ARGUMENT, {"forecast"});

    expect_refused(spc_scene_create(nullptr), SPC_INVALID_ARGUMENT, {"scene is null"});
    expect_refused(spc_scene_commit(nullptr, 1), SPC_INVALID_ARGUMENT, {"scene"});
    auto stats = sized<spc_scene_stats>();
    expect_refused(spc_scene_get_stats(nullptr, &stats), SPC_INVALID_ARGUMENT, {"scene"});
    EXPECT_EQ(spc_scene_report(nullptr), nullptr);
    spc_scene_destroy(nullptr);
    spc_session_destroy(nullptr);
    spc_render_settings_init(nullptr);
}

TEST_F(SceneMisuse, CallsOutOfOrder) {
    auto stats = sized<spc_scene_stats>();
    expect_refused(spc_scene_get_stats(scene, &stats), SPC_WRONG_STATE, {"not committed"});
    EXPECT_EQ(spc_scene_report(scene), nullptr);
    EXPECT_NE(std::string(spc_last_error()).find("not committed"), std::string::npos);
    const spc_render_settings settings = quick_settings();
    spc_session* session = nullptr;
    expect_refused(spc_render_start(scene, &settings, &session), SPC_WRONG_STATE, {"not committed"});
    EXPECT_EQ(session, nullptr);
    expect_refused(spc_scene_commit(scene, 1), SPC_WRONG_STATE, {"camera"});
}

TEST(SceneAfterCommit, IsImmutable) {
    const ScenePtr handle = committed_scene();
    spc_scene* scene = handle.get();
    const std::vector<float> before = render_all(scene, quick_settings());
    uint32_t index = 77;
    const spc_image_desc image = valid_image();
    const spc_material_desc material = textured_material();
    const spc_mesh_desc mesh = valid_mesh();
    const uint32_t slot = 0;
    const spc_instance_desc instance = valid_instance(0, slot);
    const spc_light_desc light = valid_light(SPC_LIGHT_SUN);
    auto world = sized<spc_environment_desc>();
    world.material = 2;
    expect_refused(spc_scene_add_image(scene, &image, &index), SPC_WRONG_STATE,
                   {"committed already"});
    expect_refused(spc_scene_add_material(scene, &material, &index), SPC_WRONG_STATE,
                   {"committed already"});
    expect_refused(spc_scene_add_mesh(scene, &mesh, &index), SPC_WRONG_STATE, {"committed already"});
    expect_refused(spc_scene_add_instance(scene, &instance, &index), SPC_WRONG_STATE,
                   {"committed already"});
    expect_refused(spc_scene_add_light(scene, &light, &index), SPC_WRONG_STATE,
                   {"committed already"});
    expect_refused(spc_scene_set_environment(scene, &world), SPC_WRONG_STATE, {"committed already"});
    expect_refused(spc_scene_commit(scene, 1), SPC_WRONG_STATE, {"committed already"});
    EXPECT_EQ(index, 77u);
    expect_refused(spc_scene_get_stats(scene, nullptr), SPC_INVALID_ARGUMENT, {"stats"});
    spc_scene_stats stats{};
    expect_refused(spc_scene_get_stats(scene, &stats), SPC_INVALID_ARGUMENT, {"struct_size"});
    EXPECT_TRUE(same_bits(render_all(scene, quick_settings()), before));

    stats.struct_size = sizeof(stats);
    ASSERT_EQ(spc_scene_get_stats(scene, &stats), SPC_OK);
    EXPECT_EQ(stats.triangles, 2u);
    EXPECT_EQ(stats.instances, 2u);
    EXPECT_EQ(stats.lights, 2u);
    EXPECT_EQ(stats.casters, 1u);
    EXPECT_EQ(stats.receivers, 1u);
    EXPECT_NE(std::string(spc_scene_report(scene)).find("Mirror: caster"), std::string::npos)
        << spc_scene_report(scene);
}

TEST_F(SceneMisuse, Images) {
    const auto spoilt = [](auto spoil) {
        spc_image_desc desc = valid_image();
        spoil(desc);
        return desc;
    };
    const char text[] = "this is no image";
    refuses(spoilt([](auto& d) { d.pixels = nullptr; }), {"image \"Bricks\": "});
    refuses(spoilt([&](auto& d) { d.encoded = text, d.encoded_size = sizeof(text); }), {"Bricks"});
    refuses(spoilt([](auto& d) { d.path = "picture.png"; }), {"Bricks"});
    refuses(spoilt([](auto& d) { d.width = 0; }), {"Bricks"});
    refuses(spoilt([](auto& d) { d.height = 0; }), {"Bricks"});
    for (const uint32_t channels : {0u, 2u, 5u, 0xffffffffu})
        refuses(spoilt([&](auto& d) { d.channels = channels; }), {"Bricks"});
    refuses(spoilt([](auto& d) { d.pixel_type = 2; }), {"Bricks", "pixel type"});
    refuses(spoilt([](auto& d) { d.color_space = 3; }), {"Bricks"});
    refuses(spoilt([](auto& d) { d.alpha_mode = 4; }), {"Bricks"});
    // Sizes whose product in bytes wraps around to nothing.
    for (const uint32_t side : {0x80000000u, 0xffffffffu, 0x40000000u})
        for (const uint32_t type : {SPC_PIXEL_U8, SPC_PIXEL_F32})
            refuses(spoilt([&](auto& d) {
                        d.width = d.height = side, d.channels = 4, d.pixel_type = type;
                    }),
                    {"Bricks"});
    for (const float bad : kNotFinite) {
        const float texels[] = {0.5f, 0.5f, 0.5f, bad};
        refuses(spoilt([&](auto& d) {
                    d.pixels = texels, d.channels = 1, d.pixel_type = SPC_PIXEL_F32;
                }),
                {"Bricks"});
    }
    const auto from_file = [&](auto spoil) {
        return spoilt([&](auto& d) { d.pixels = nullptr, spoil(d); });
    };
    refuses(from_file([&](auto& d) { d.encoded = text; }), {"Bricks"});
    refuses(from_file([&](auto& d) { d.encoded = text, d.encoded_size = sizeof(text); }),
            {"Bricks"}, SPC_IO_ERROR);
    refuses(from_file([](auto& d) { d.path = "/no/such/file.png"; }),
            {"Bricks", "/no/such/file.png"}, SPC_IO_ERROR);
    refuses(from_file([](auto& d) { d.path = SPC_TEST_SOURCE_DIR "/LICENSE"; }), {"Bricks"},
            SPC_IO_ERROR);
    refuses(from_file([](auto& d) { d.path = SPC_TEST_SOURCE_DIR; }), {"Bricks"}, SPC_IO_ERROR);
    refuses(from_file([](auto& d) { d.path = ""; }), {"Bricks"}, SPC_IO_ERROR);
}

TEST_F(SceneMisuse, Meshes) {
    const auto spoilt = [](auto spoil) {
        spc_mesh_desc desc = valid_mesh();
        spoil(desc);
        return desc;
    };
    refuses(spoilt([](auto& d) { d.vertex_count = 0; }), {"mesh \"Slate\": ", "empty"});
    refuses(spoilt([](auto& d) { d.triangle_count = 0; }), {"Slate", "empty"});
    refuses(spoilt([](auto& d) { d.positions = nullptr; }), {"Slate", "positions"});
    refuses(spoilt([](auto& d) { d.triangles = nullptr; }), {"Slate", "triangles"});
    refuses(spoilt([](auto& d) { d.slot_count = 0; }), {"Slate", "slot"});
    for (const uint32_t beyond : {4u, 0xffffffffu}) {
        const uint32_t triangles[] = {0, 1, 2, 0, 2, beyond};
        refuses(spoilt([&](auto& d) { d.triangles = triangles; }),
                {"Slate", "triangle 1", "vertex"});
    }
    for (const uint32_t slots : {1u, 2u}) {
        const uint32_t material_slots[] = {0, slots};
        refuses(spoilt([&](auto& d) { d.material_slots = material_slots, d.slot_count = slots; }),
                {"Slate", "slot"});
    }
    for (const float bad : kNotFinite) {
        for (size_t i = 0; i < 12; ++i) {
            std::vector<float> positions(valid_mesh().positions, valid_mesh().positions + 12);
            positions[i] = bad;
            refuses(spoilt([&](auto& d) { d.positions = positions.data(); }),
                    {"Slate", "position", std::to_string(i / 3)});
        }
        for (const size_t i : {0u, 9u, 17u}) {
            std::vector<float> normals(18, 1.0f);
            normals[i] = bad;
            refuses(spoilt([&](auto& d) { d.normals = normals.data(); }), {"Slate", "normal"});
        }
        for (const size_t i : {0u, 11u}) {
            std::vector<float> uv(12, 0.5f);
            uv[i] = bad;
            const spc_attribute layer = unwrap(uv.data(), nullptr);
            refuses(spoilt([&](auto& d) { d.attributes = &layer; }), {"Slate", "Unwrap"});
        }
        for (const size_t i : {0u, 3u, 22u}) {
            std::vector<float> uv(12, 0.5f), tangents(24, 1.0f);
            tangents[i] = bad;
            const spc_attribute layer = unwrap(uv.data(), tangents.data());
            refuses(spoilt([&](auto& d) { d.attributes = &layer; }), {"Slate", "Unwrap"});
        }
    }
    refuses(spoilt([](auto& d) { d.attributes = nullptr; }), {"Slate", "attributes"});
    const std::vector<float> numbers(24, 0.5f);
    const auto refuses_attribute = [&](auto change, const char* word) {
        spc_attribute attribute = unwrap(numbers.data(), nullptr);
        change(attribute);
        refuses(spoilt([&](auto& d) { d.attributes = &attribute; }), {"Slate", "Unwrap", word});
    };
    refuses_attribute([](auto& a) { a.values = nullptr; }, "values");
    refuses_attribute([](auto& a) { a.kind = SPC_ATTRIBUTE_VIEW_LAYER + 1; }, "kind");
    refuses_attribute([](auto& a) { a.kind = SPC_ATTRIBUTE_OBJECT; }, "domain");
    refuses_attribute([](auto& a) { a.domain = SPC_DOMAIN_OBJECT + 1; }, "domain");
    refuses_attribute([](auto& a) { a.components = 5; }, "components");
    refuses_attribute([&](auto& a) { a.components = 3, a.tangents = numbers.data(); }, "tangents");
    refuses(spoilt([](auto& d) { d.name = nullptr, d.vertex_count = 0; }), {"mesh: "});
}

TEST_F(SceneMisuse, Instances) {
    const uint32_t material = 0;
    const auto spoilt = [&](auto spoil) {
        spc_instance_desc desc = valid_instance(0, material);
        spoil(desc);
        return desc;
    };
    for (const uint32_t mesh : {1u, SPC_NONE})
        refuses(spoilt([&](auto& d) { d.mesh = mesh; }), {"object \"Yard\": ", "mesh"});
    refuses(spoilt([](auto& d) { d.materials = nullptr; }), {"Yard", "materials"});
    refuses(spoilt([](auto& d) { d.material_count = 0; }), {"Yard", "material"});
    const uint32_t two[] = {0, 0};
    refuses(spoilt([&](auto& d) { d.materials = two, d.material_count = 2; }),
            {"Yard", "2 materials"});
    for (const uint32_t unknown : {3u, SPC_NONE - 1})
        refuses(spoilt([&](auto& d) { d.materials = &unknown; }), {"Yard", "material"});
    for (const float bad : kNotFinite)
        for (size_t i = 0; i < 12; ++i)
            refuses(spoilt([&](auto& d) { d.transform[i] = bad; }), {"Yard", "transform"});
    for (const size_t axis : {0u, 1u, 2u}) {
        refuses(spoilt([&](auto& d) { d.transform[5 * axis] = 0.0f; }), {"Yard", "inverted"});
        // Two axes the same: singular without a zero in it.
        refuses(spoilt([&](auto& d) {
                    for (size_t c = 0; c < 3; ++c)
                        d.transform[4 * axis + c] = d.transform[4 * ((axis + 1) % 3) + c];
                }),
                {"Yard", "inverted"});
    }
    // Determinants beyond single precision.
    for (const float scale : {1e-20f, 1e13f, 1e20f})
        refuses(spoilt([&](auto& d) { d.transform[0] = d.transform[5] = d.transform[10] = scale; }),
                {"Yard", "the transform"});
    for (const uint32_t bits : {32u, 0x80000000u})
        refuses(spoilt([&](auto& d) { d.visibility = bits; }), {"Yard", "visibility"});
    for (const uint32_t role : {5u, 0xffffffffu})
        refuses(spoilt([&](auto& d) { d.caustics_role = role; }), {"Yard", "role"});
    for (const float offset : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()})
        refuses(spoilt([&](auto& d) { d.terminator_offset = offset; }),
                {"Yard", "terminator_offset"});
    refuses(spoilt([](auto& d) { d.name = nullptr, d.mesh = 9; }), {"object: "});
}

TEST_F(SceneMisuse, Lights) {
    const auto spoilt = [](uint32_t type, auto spoil) {
        spc_light_desc desc = valid_light(type);
        spoil(desc);
        return desc;
    };
    constexpr uint32_t kTypes[] = {SPC_LIGHT_POINT, SPC_LIGHT_SPOT, SPC_LIGHT_SUN, SPC_LIGHT_AREA};
    for (const uint32_t type : {4u, 0xffffffffu})
        refuses(spoilt(type, [](auto&) {}), {"light \"Lantern\": ", "type"});
    for (const uint32_t type : kTypes) {
        for (const float bad : kNotFinite) {
            for (size_t i = 0; i < 12; ++i)
                refuses(spoilt(type, [&](auto& d) { d.transform[i] = bad; }),
                        {"Lantern", "transform"});
            for (size_t i = 0; i < 3; ++i)
                refuses(spoilt(type, [&](auto& d) { d.power[i] = bad; }), {"Lantern", "power"});
        }
        refuses(spoilt(type, [](auto& d) { d.power[1] = -1e-6f; }), {"Lantern", "power"});
        refuses(spoilt(type, [](auto& d) { d.transform[5] = 0.0f; }), {"Lantern", "transform"});
        refuses(spoilt(type, [](auto& d) { d.visibility = 64; }), {"Lantern", "visibility"});
        refuses(spoilt(type, [](auto& d) { d.shape = 2; }), {"Lantern", "shape"});
        refuses(spoilt(type, [](auto& d) { d.material = 99; }), {"Lantern", "material"});
    }
    for (const uint32_t type : {SPC_LIGHT_POINT, SPC_LIGHT_SPOT})
        for (const float bad : beyond({-1e-6f}))
            refuses(spoilt(type, [&](auto& d) { d.radius = bad; }), {"Lantern", "radius"});
    for (const float bad : beyond({0.0f, -1.0f, 3.2f}))
        refuses(spoilt(SPC_LIGHT_SPOT, [&](auto& d) { d.spot_angle = bad; }),
                {"Lantern", "spot angle"});
    for (const float bad : beyond({-0.1f, 1.1f}))
        refuses(spoilt(SPC_LIGHT_SPOT, [&](auto& d) { d.spot_blend = bad; }), {"Lantern", "blend"});
    for (const float bad : beyond({-0.1f, 3.2f}))
        refuses(spoilt(SPC_LIGHT_SUN, [&](auto& d) { d.sun_angle = bad; }), {"Lantern", "angle"});
    for (const float bad : beyond({0.0f, -1.0f}))
        for (size_t i = 0; i < 2; ++i)
            refuses(spoilt(SPC_LIGHT_AREA, [&](auto& d) { d.size[i] = bad; }), {"Lantern", "size"});
    for (const float bad : beyond({-0.1f, 3.2f}))
        refuses(spoilt(SPC_LIGHT_AREA, [&](auto& d) { d.spread = bad; }), {"Lantern", "spread"});
}

TEST_F(SceneMisuse, CameraAndWorld) {
    const auto spoilt = [](auto spoil) {
        spc_camera_desc desc = valid_camera();
        spoil(desc);
        return desc;
    };
    refuses(spoilt([](auto& d) { d.width = 0; }));
    refuses(spoilt([](auto& d) { d.height = 0; }));
    using Crop = std::array<uint32_t, 4>;
    for (const Crop& crop : {Crop{0, 0, 0, 8}, Crop{0, 0, 12, 0}, Crop{12, 0, 1, 1},
                             Crop{0, 8, 1, 1}, Crop{1, 0, 12, 8}, Crop{0, 1, 12, 8},
                             Crop{0xffffffff, 0, 2, 8}, Crop{1, 1, 0xffffffff, 0xffffffff}})
        refuses(spoilt([&](auto& d) { std::copy(crop.begin(), crop.end(), d.crop); }));
    for (const float bad : kNotFinite) {
        for (size_t i = 0; i < 12; ++i) refuses(spoilt([&](auto& d) { d.transform[i] = bad; }));
        for (size_t i = 0; i < 4; ++i) refuses(spoilt([&](auto& d) { d.viewplane[i] = bad; }));
        refuses(spoilt([&](auto& d) { d.clip_near = bad; }));
    }
    refuses(spoilt([](auto& d) { d.clip_far = kNan; }));
    refuses(spoilt([](auto& d) { d.clip_far = -kInf; }));
    refuses(spoilt([](auto& d) { d.clip_near = -1.0f; }));
    refuses(spoilt([](auto& d) { d.clip_near = d.clip_far; }));
    refuses(spoilt([](auto& d) { d.viewplane[1] = d.viewplane[0]; }));
    refuses(spoilt([](auto& d) { d.viewplane[3] = d.viewplane[2]; }));
    refuses(spoilt([](auto& d) { d.transform[10] = 0.0f; }));
    refuses(spoilt([](auto& d) { d.projection = 9; }), {"projection", "9"});
    for (const float bad : beyond({-1.0f}))
        refuses(spoilt([&](auto& d) { d.aperture_radius = bad; }), {"aperture", "radius"});
    const auto lens = [](auto spoil) {
        spc_camera_desc desc = valid_camera();
        desc.aperture_radius = 0.1f;
        desc.focus_distance = desc.aperture_ratio = 1.0f;
        spoil(desc);
        return desc;
    };
    for (const float bad : beyond({0.0f, -1.0f})) {
        refuses(lens([&](auto& d) { d.focus_distance = bad; }), {"focus distance"});
        refuses(lens([&](auto& d) { d.aperture_ratio = bad; }), {"aperture", "ratio"});
    }
    for (const float bad : kNotFinite)
        refuses(lens([&](auto& d) { d.aperture_rotation = bad; }), {"aperture", "rotation"});
    for (const uint32_t bad : {1u, 2u})
        refuses(lens([&](auto& d) { d.aperture_blades = bad; }), {"blades"});

    auto world = sized<spc_environment_desc>();
    world.visibility = SPC_VISIBLE_ALL;
    world.material = 3;
    expect_refused(spc_scene_set_environment(scene, &world), SPC_INVALID_ARGUMENT, {"world: ", "3"});
    world.material = 0;
    expect_refused(spc_scene_set_environment(scene, &world), SPC_INVALID_ARGUMENT,
                   {"world", "Plaster", "background"});
    world.material = 2;
    world.visibility = 32;
    expect_refused(spc_scene_set_environment(scene, &world), SPC_INVALID_ARGUMENT,
                   {"world", "visibility"});
}

// Finite, but so large that sums and squares on the way would not be.
TEST_F(SceneMisuse, NumbersBeyondTheirBounds) {
    constexpr float kFar = 1.01e8f, kLarge = 1.01e15f;
    const float texels[] = {0.5f, 0.5f, -kLarge, 0.5f};
    spc_image_desc image = valid_image();
    image.pixels = texels;
    image.channels = 1;
    image.pixel_type = SPC_PIXEL_F32;
    refuses(image, {"image \"Bricks\"", "texel 2", "1e+15"});

    spc_material_desc material = textured_material();
    const spc_node_input strong[] = {{1, "Color", {kLarge, 0, 0, 0}}};
    material.inputs = strong;
    expect_refused(spc_scene_add_material(scene, &material, &index), SPC_INVALID_ARGUMENT,
                   {"material \"Plaster\"", "Diff", "1e+15"});

    spc_mesh_desc mesh = valid_mesh();
    std::vector<float> positions(mesh.positions, mesh.positions + 12), normals(18, 1.0f),
        uv(12, 0.5f), tangents(24, 1.0f);
    const spc_attribute layer = unwrap(uv.data(), tangents.data());
    mesh.normals = normals.data();
    mesh.attributes = &layer;
    const auto refuses_beyond = [&](float& value, float beyond,
                                    const std::vector<std::string>& words) {
        const float good = std::exchange(value, beyond);
        refuses(mesh, words);
        value = good;
    };
    refuses_beyond(normals[7], -kLarge, {"mesh \"Slate\"", "corner normal 2", "1e+15"});
    refuses_beyond(uv[7], kLarge, {"Slate", "Unwrap", "value 3", "1e+15"});
    refuses_beyond(tangents[5], kLarge, {"Slate", "Unwrap", "tangent 1", "1e+15"});
    mesh.positions = positions.data();
    refuses_beyond(positions[7], -kFar, {"Slate", "position 2", "1e+08"});

    const uint32_t plaster = 0;
    const auto moved = [&](float scale, float x) {
        spc_instance_desc desc = valid_instance(0, plaster);
        desc.transform[0] = scale;
        desc.transform[3] = x;
        return desc;
    };
    refuses(moved(kFar, 0), {"object \"Yard\"", "transform", "1e+08"});
    refuses(moved(1, -kFar), {"Yard", "translation", "1e+08"});
    refuses(moved(6e7f, 0), {"Yard", "world", "1e+08"});
    refuses(moved(0.9e-8f, 0), {"Yard", "inverted"});

    spc_light_desc light = valid_light(SPC_LIGHT_AREA);
    light.power[1] = kLarge;
    refuses(light, {"light \"Lantern\"", "power", "1e+15"});
    light = valid_light(SPC_LIGHT_POINT);
    light.radius = kFar;
    refuses(light, {"Lantern", "radius", "1e+08"});
    light = valid_light(SPC_LIGHT_AREA);
    light.size[1] = 2.0f * kFar;
    refuses(light, {"Lantern", "size in y", "1e+08"});

    spc_camera_desc camera = valid_camera();
    camera.viewplane[1] = kFar;
    refuses(camera, {"viewplane", "1e+08"});
    camera = valid_camera();
    camera.clip_near = kFar;
    camera.clip_far = 1e12f;
    refuses(camera, {"near", "1e+08"});
}

TEST_F(SceneMisuse, AbsurdNumbersOfThreadsForACommit) {
    // Whichever way it goes, it must not start four thousand million threads.
    const ScenePtr other = new_scene();
    add_resources(other.get());
    add_objects(other.get());
    expect_refused(spc_scene_commit(other.get(), 0xffffffffu), SPC_INVALID_ARGUMENT, {"threads"});
    EXPECT_EQ(spc_scene_commit(other.get(), 3), SPC_OK) << spc_last_error();
}

// Odd, but nothing in the contract forbids it: it must render, without a sample that is not a
// number.
TEST(OddScenes, Render) {
    const auto renders = [](const char* what, auto add) {
        const ScenePtr scene = new_scene();
        add_resources(scene.get());
        add(scene.get());
        const spc_camera_desc camera = valid_camera(8, 6);
        ASSERT_EQ(spc_scene_set_camera(scene.get(), &camera), SPC_OK) << what << spc_last_error();
        ASSERT_EQ(spc_scene_commit(scene.get(), 1), SPC_OK) << what << spc_last_error();
        const SessionPtr session = start(scene.get(), quick_settings(4));
        ASSERT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE)) << what;
        auto stats = sized<spc_render_stats>();
        ASSERT_EQ(spc_render_get_stats(session.get(), &stats), SPC_OK);
        EXPECT_EQ(stats.nan_samples, 0u) << what;
        for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass)
            for (const float value : read_pass(session.get(), pass, 8, 6))
                ASSERT_TRUE(std::isfinite(value)) << what << ", pass " << pass;
    };
    const auto add_instance = [](spc_scene* scene, uint32_t material, float scale = 1.0f,
                                 uint32_t visibility = SPC_VISIBLE_ALL) {
        uint32_t index;
        spc_instance_desc desc = valid_instance(0, material);
        for (const size_t i : {0u, 5u, 10u}) desc.transform[i] = scale;
        desc.visibility = visibility;
        ASSERT_EQ(spc_scene_add_instance(scene, &desc, &index), SPC_OK) << spc_last_error();
    };
    const auto add_light = [](spc_scene* scene, const spc_light_desc& desc) {
        uint32_t index;
        ASSERT_EQ(spc_scene_add_light(scene, &desc, &index), SPC_OK) << spc_last_error();
    };
    renders("nothing at all", [](spc_scene*) {});
    renders("a background as surface", [&](spc_scene* scene) { add_instance(scene, 2); });
    renders("a slot without material", [&](spc_scene* scene) { add_instance(scene, SPC_NONE); });
    renders("a mirror that nothing sees", [&](spc_scene* scene) {
        add_instance(scene, 0), add_instance(scene, 1, 1.0f, 0),
            add_light(scene, valid_light(SPC_LIGHT_POINT));
    });
    renders("floor and mirror in one place", [&](spc_scene* scene) {
        add_instance(scene, 0), add_instance(scene, 1),
            add_light(scene, valid_light(SPC_LIGHT_POINT));
    });
    renders("an output without surface", [&](spc_scene* scene) {
        static const spc_node out = {"Out", "output", SPC_NONE};
        auto desc = sized<spc_material_desc>();
        desc.name = "Void";
        desc.nodes = &out;
        desc.node_count = 1;
        uint32_t index;
        ASSERT_EQ(spc_scene_add_material(scene, &desc, &index), SPC_OK) << spc_last_error();
        add_instance(scene, index);
    });
    for (const uint32_t type : {SPC_LIGHT_POINT, SPC_LIGHT_SPOT, SPC_LIGHT_SUN, SPC_LIGHT_AREA})
        for (const float power : {0.0f, 1e-30f, 1e-6f, 1e6f})
            for (const float size : {1e-6f, 1.0f, 1e4f})
                renders("a lamp of extreme power or size", [&](spc_scene* scene) {
                    add_instance(scene, 0);
                    add_instance(scene, 1, 0.1f);
                    spc_light_desc desc = valid_light(type);
                    for (float& p : desc.power) p = power;
                    desc.radius = desc.size[0] = desc.size[1] = size;
                    desc.sun_angle = std::min(size, 3.14159f);
                    desc.spot_angle = std::min(size, 3.14159f);
                    desc.spread = std::min(size, 3.14159f);
                    add_light(scene, desc);
                });
    for (const float scale : {1e-6f, 1e-4f, 1e4f, 1e6f})
        renders("objects of extreme scale", [&](spc_scene* scene) {
            add_instance(scene, 0, scale), add_instance(scene, 1, scale),
                add_light(scene, valid_light(SPC_LIGHT_POINT));
        });
}

TEST(LastError, BelongsToItsThread) {
    expect_refused(spc_scene_create(nullptr), SPC_INVALID_ARGUMENT, {"scene is null"});
    const std::string mine = spc_last_error();
    std::thread([] {
        EXPECT_STREQ(spc_last_error(), "");
        expect_refused(spc_render_cancel(nullptr), SPC_INVALID_ARGUMENT, {"session is null"});
    }).join();
    EXPECT_EQ(mine, spc_last_error());
    spc_scene* scene = nullptr;
    ASSERT_EQ(spc_scene_create(&scene), SPC_OK);
    spc_scene_destroy(scene);
    EXPECT_EQ(mine, spc_last_error()) << "a success does not forget the last failure";
}

}  // namespace
}  // namespace spc::test
