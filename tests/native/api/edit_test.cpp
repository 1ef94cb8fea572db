// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that is edited renders, after every edit, as one into which all has been added anew.
#include "support/api_scene.h"
#include "support/power.h"

#include <map>
#include <numbers>
#include <random>

namespace spc::test {
namespace {

constexpr uint32_t kWidth = 16, kHeight = 12;

// What a test edits: numbers that tell all things of a scene apart.
struct State {
    struct Thing {
        int shape, material;
        std::array<float, 3> at;
        float turn;
        uint32_t visibility = SPC_VISIBLE_ALL;
    };
    std::vector<Thing> things;
    float lamp = 60.0f, sky = 0.3f;
    std::array<float, 3> lamp_at{1.0f, -1.0f, 3.0f};
    float tint = 0.4f;  // of material 0
    int relief = 0;     // of the map of material 3
    float camera_x = 0.0f;
};

// A bent strip of triangles; `shape` tells how it is bent, and all its coordinates are its own.
struct Strip {
    std::vector<float> positions, uv;
    std::vector<uint32_t> triangles;

    explicit Strip(int shape) {
        constexpr uint32_t kSteps = 8;
        std::mt19937 random(static_cast<uint32_t>(shape));
        std::uniform_real_distribution<float> jitter(-0.05f, 0.05f);
        for (uint32_t i = 0; i <= kSteps; ++i)
            for (const float side : {-0.7f, 0.7f}) {
                const float angle = static_cast<float>(i) / kSteps * 3.0f;
                positions.insert(positions.end(),
                                 {side + jitter(random), 0.6f * std::cos(angle) + jitter(random),
                                  0.6f * std::sin(angle) + jitter(random)});
            }
        for (uint32_t i = 0; i < kSteps; ++i) {
            const uint32_t a = 2 * i;
            for (const uint32_t corner : {a, a + 1, a + 3, a, a + 3, a + 2}) {
                triangles.push_back(corner);
                uv.insert(uv.end(), {positions[3 * corner], positions[3 * corner + 1]});
            }
        }
    }
};

std::vector<uint8_t> normal_map(int relief) {
    constexpr int kSide = 32;
    std::vector<uint8_t> texels;
    std::mt19937 random(static_cast<uint32_t>(relief));
    std::uniform_int_distribution<int> slope(118, 138);
    for (int i = 0; i < kSide * kSide; ++i)
        for (const int c : {slope(random), slope(random), 250})
            texels.push_back(static_cast<uint8_t>(c));
    return texels;
}

// Adds a state to a scene. With a memory of the scene before, it keeps what is the same.
class Build {
public:
    using Memory = std::map<std::string, uint32_t>;

    Build(spc_scene* scene, const State& state, const Memory* before)
        : scene_(scene), before_(before) {
        add_image(state.relief);
        add_material("tint", std::to_string(state.tint), [&](auto add) {
            const spc_node nodes[] = {{"Out", "output", SPC_NONE},
                                      {"Diff", "bsdf_diffuse", SPC_NONE}};
            const spc_node_link link = {1, "BSDF", 0, "Surface"};
            const spc_node_input color = {1, "Color", {state.tint, 0.6f, 0.5f, 1.0f}};
            spc_material_desc desc = one_shader("tint", nodes, link);
            desc.inputs = &color;
            desc.input_count = 1;
            add(desc);
        });
        add_material("silver", "", [&](auto add) { add(mirror_material()); });
        add_material("glass", "", [&](auto add) {
            const spc_node nodes[] = {{"Out", "output", SPC_NONE}, {"G", "bsdf_glass", SPC_NONE}};
            const spc_node_link link = {1, "BSDF", 0, "Surface"};
            const spc_node_input smooth = {1, "Roughness", {0, 0, 0, 0}};
            spc_material_desc desc = one_shader("glass", nodes, link);
            desc.inputs = &smooth;
            desc.input_count = 1;
            add(desc);
        });
        add_glints(state.relief);
        add_sky(state.sky);
        for (const State::Thing& thing : state.things) add_thing(thing);
        spc_light_desc lamp = valid_light(SPC_LIGHT_POINT);
        for (size_t i = 0; i < 3; ++i) {
            lamp.transform[4 * i + 3] = state.lamp_at[i];
            lamp.power[i] = state.lamp;
        }
        uint32_t index;
        EXPECT_EQ(spc_scene_add_light(scene_, &lamp, &index), SPC_OK) << spc_last_error();
        spc_camera_desc camera = valid_camera(kWidth, kHeight);
        camera.transform[3] = state.camera_x;
        EXPECT_EQ(spc_scene_set_camera(scene_, &camera), SPC_OK) << spc_last_error();
        EXPECT_EQ(spc_scene_commit(scene_, 2), SPC_OK) << spc_last_error();
    }

    Memory memory;
    int kept = 0;

private:
    // Keeps what `key` names, if the scene before has it; else `add` adds it.
    template <class Add>
    uint32_t keep_or(const std::string& key, Add&& add,
                     spc_status (*keep)(spc_scene*, uint32_t, uint32_t*)) {
        uint32_t index = SPC_NONE;
        if (before_ != nullptr && before_->contains(key)) {
            EXPECT_EQ(keep(scene_, before_->at(key), &index), SPC_OK) << key << spc_last_error();
            ++kept;
        } else {
            add(index);
        }
        memory[key] = index;
        return index;
    }

    void add_image(int relief) {
        const auto add = [&](uint32_t& index) {
            const std::vector<uint8_t> texels = normal_map(relief);
            spc_image_desc desc = valid_image();
            desc.pixels = texels.data();
            desc.width = desc.height = 32;
            desc.color_space = SPC_COLOR_DATA;
            EXPECT_EQ(spc_scene_add_image(scene_, &desc, &index), SPC_OK) << spc_last_error();
        };
        keep_or("image" + std::to_string(relief), add, spc_scene_keep_image);
    }

    template <class Make>
    uint32_t add_material(const std::string& name, const std::string& version, Make&& make) {
        const auto add = [&](uint32_t& index) {
            make([&](const spc_material_desc& desc) {
                EXPECT_EQ(spc_scene_add_material(scene_, &desc, &index), SPC_OK) << spc_last_error();
            });
        };
        return keep_or(name + version, add, spc_scene_keep_material);
    }

    void add_glints(int relief) {
        add_material("glints", std::to_string(relief), [&](auto add) {
            const spc_node nodes[] = {{"Out", "output", SPC_NONE},
                                      {"Gloss", "bsdf_glossy", SPC_NONE},
                                      {"Normal", "normal_map", SPC_NONE},
                                      {"Map", "image_texture", 0}};
            const spc_node_link links[] = {
                {1, "BSDF", 0, "Surface"}, {2, "Normal", 1, "Normal"}, {3, "Color", 2, "Color"}};
            const spc_node_input rough = {1, "Roughness", {0.3f, 0, 0, 0}};
            auto desc = sized<spc_material_desc>();
            desc.name = "glints";
            desc.nodes = nodes;
            desc.node_count = 4;
            desc.links = links;
            desc.link_count = 3;
            desc.inputs = &rough;
            desc.input_count = 1;
            add(desc);
        });
    }

    void add_sky(float strength) {
        const uint32_t index = add_material("sky", std::to_string(strength), [&](auto add) {
            const spc_node nodes[] = {{"Out", "output", SPC_NONE},
                                      {"Sky", "background", SPC_NONE},
                                      {"Grad", "gradient_texture", SPC_NONE}};
            const spc_node_link links[] = {{1, "Background", 0, "Surface"},
                                           {2, "Color", 1, "Color"}};
            const spc_node_input input = {1, "Strength", {strength, 0, 0, 0}};
            auto desc = sized<spc_material_desc>();
            desc.name = "sky";
            desc.nodes = nodes;
            desc.node_count = 3;
            desc.links = links;
            desc.link_count = 2;
            desc.inputs = &input;
            desc.input_count = 1;
            add(desc);
        });
        auto world = sized<spc_environment_desc>();
        world.material = index;
        world.visibility = SPC_VISIBLE_ALL;
        world.feeds_caustics = 1;
        EXPECT_EQ(spc_scene_set_environment(scene_, &world), SPC_OK) << spc_last_error();
    }

    void add_thing(const State::Thing& thing) {
        const std::string key = "mesh" + std::to_string(thing.shape);
        const auto add = [&](uint32_t& index) {
            const Strip strip(thing.shape);
            const spc_attribute layer = unwrap(strip.uv.data(), nullptr);
            spc_mesh_desc desc = valid_mesh();
            desc.positions = strip.positions.data();
            desc.vertex_count = static_cast<uint32_t>(strip.positions.size() / 3);
            desc.triangles = strip.triangles.data();
            desc.triangle_count = static_cast<uint32_t>(strip.triangles.size() / 3);
            desc.attributes = &layer;
            EXPECT_EQ(spc_scene_add_mesh(scene_, &desc, &index), SPC_OK) << spc_last_error();
        };
        const uint32_t mesh =
            memory.contains(key) ? memory.at(key) : keep_or(key, add, spc_scene_keep_mesh);
        const auto material = static_cast<uint32_t>(thing.material);
        spc_instance_desc desc = valid_instance(mesh, material);
        const float c = std::cos(thing.turn), s = std::sin(thing.turn);
        const float rows[12] = {c, -s, 0, thing.at[0], s, c, 0, thing.at[1], 0, 0, 1, thing.at[2]};
        std::copy(rows, rows + 12, desc.transform);
        desc.visibility = thing.visibility;
        uint32_t index;
        EXPECT_EQ(spc_scene_add_instance(scene_, &desc, &index), SPC_OK) << spc_last_error();
    }

    spc_scene* scene_;
    const Memory* before_;
};

class RandomEdits {
public:
    State state;

    RandomEdits() {
        for (int i = 0; i < 5; ++i) add();
    }

    void edit() {
        switch (whole(0, 9)) {
            case 0: return add();
            case 1:
                if (state.things.size() > 3)
                    state.things.erase(state.things.begin() + whole(0, size() - 1));
                return;
            case 2:
            case 3: any().at = place(); return;
            case 4: any().material = whole(0, 3); return;
            case 5: any().shape = next_shape_++; return;
            case 6: state.lamp_at = {number(), number(), 3.0f}; return;
            case 7: state.tint = 0.5f + 0.3f * number(); return;
            case 8: state.sky = 0.5f + 0.3f * number(); return;
            default:
                ++state.relief;
                any().visibility ^= SPC_VISIBLE_CAMERA;
                return;
        }
    }

private:
    std::mt19937 random_{7};
    int next_shape_ = 3;

    int whole(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
    float number() { return std::uniform_real_distribution(-1.0f, 1.0f)(random_); }
    int size() const { return static_cast<int>(state.things.size()); }
    State::Thing& any() { return state.things[static_cast<size_t>(whole(0, size() - 1))]; }
    std::array<float, 3> place() { return {1.5f * number(), number(), 0.7f * number()}; }
    // Some share a mesh, others are its single user.
    void add() { state.things.push_back({whole(0, 2), whole(0, 3), place(), 3.0f * number()}); }
};

TEST(Edit, RendersAsASceneBuiltFromNothing) {
    constexpr int kEdits = 40, kEditsOfARender = repeats(1, 4);
    RandomEdits edits;
    Build::Memory memory;
    ScenePtr scene;
    std::vector<float> before;
    int kept = 0, renders = 0, changed = 0;
    for (int i = 0; i < kEdits; ++i) {
        ScenePtr next = edited(scene.get());
        Build build(next.get(), edits.state, scene ? &memory : nullptr);
        scene = std::move(next);  // the one before ends
        memory = build.memory;
        kept += build.kept;
        // One that is not edited later copies small meshes, which rounds otherwise.
        const ScenePtr anew = edited(nullptr);
        const Build from_nothing(anew.get(), edits.state, nullptr);
        edits.edit();
        if (i % kEditsOfARender != 0) continue;
        const spc_render_settings settings = quick_settings();
        const std::vector<float> picture = render_all(scene.get(), settings, kWidth, kHeight);
        ASSERT_TRUE(same_bits(picture, render_all(anew.get(), settings, kWidth, kHeight)))
            << "after edit " << i;
        changed += same_bits(picture, before) ? 0 : 1;
        before = picture;
        ++renders;
    }
    EXPECT_GT(kept, 5 * kEdits);
    EXPECT_GT(changed, renders / 2) << "edits do not show";
}

// What both share outlives the first, and what is under way there.
TEST(Edit, DoesNotDisturbTheSceneBefore) {
    RandomEdits edits;
    ScenePtr first = edited(nullptr);
    const Build build(first.get(), edits.state, nullptr);
    const spc_render_settings settings = quick_settings(4);
    const std::vector<float> alone = render_all(first.get(), settings, kWidth, kHeight);
    SessionPtr running = start(first.get(), settings);
    ScenePtr second = edited(first.get());
    const Build same(second.get(), edits.state, &build.memory);
    EXPECT_TRUE(same_bits(render_all(second.get(), settings, kWidth, kHeight), alone));
    EXPECT_EQ(wait_for(running.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE));
    running.reset();
    first.reset();
    EXPECT_TRUE(same_bits(render_all(second.get(), settings, kWidth, kHeight), alone));
}

// Rays of a render by light sheets, and its picture.
uint64_t rays_by_sheets(const spc_scene* scene, std::vector<float>& picture) {
    spc_render_settings settings = quick_settings();
    settings.method = SPC_METHOD_SHEETS;
    const SessionPtr session = start(scene, settings);
    EXPECT_EQ(wait_for(session.get()).state, static_cast<uint32_t>(SPC_RENDER_DONE));
    picture = read_pass(session.get(), SPC_PASS_COMBINED, kWidth, kHeight);
    auto stats = sized<spc_render_stats>();
    EXPECT_EQ(spc_render_get_stats(session.get(), &stats), SPC_OK);
    return stats.rays;
}

TEST(Edit, LightSheetsAreTracedOnceForAllCameras) {
    State state;
    state.things = {{0, 0, {0.0f, 0.0f, -0.5f}, 0.3f}, {1, 2, {0.2f, 0.1f, 0.8f}, 0.7f}};
    const ScenePtr scene = edited(nullptr);
    const Build build(scene.get(), state, nullptr);
    std::vector<float> first, second, anew;
    rays_by_sheets(scene.get(), first);
    state.camera_x = 0.2f;
    spc_camera_desc camera = valid_camera(kWidth, kHeight);
    camera.transform[3] = state.camera_x;
    ASSERT_EQ(spc_scene_set_camera(scene.get(), &camera), SPC_OK) << spc_last_error();
    const uint64_t rays = rays_by_sheets(scene.get(), second);
    const ScenePtr other = new_scene();
    const Build from_nothing(other.get(), state, nullptr);
    const uint64_t all_rays = rays_by_sheets(other.get(), anew);
    EXPECT_LT(rays, all_rays);
    EXPECT_TRUE(same_bits(second, anew));
    EXPECT_FALSE(same_bits(first, second)) << "the move does not show";
}

TEST(Edit, RefusesWhatItCannotKeep) {
    uint32_t index = 0;
    const ScenePtr plain = new_scene();
    expect_refused(spc_scene_keep_mesh(plain.get(), 0, &index), SPC_WRONG_STATE, {"before"});
    spc_scene* out = nullptr;
    expect_refused(spc_scene_edit(plain.get(), &out), SPC_WRONG_STATE, {"not committed"});
    EXPECT_EQ(out, nullptr);
    expect_refused(spc_scene_edit(plain.get(), nullptr), SPC_INVALID_ARGUMENT, {"scene is null"});

    const ScenePtr fixed = committed_scene();
    expect_refused(spc_scene_edit(fixed.get(), &out), SPC_INVALID_ARGUMENT, {"made to be edited"});

    const ScenePtr before = edited(nullptr);
    add_resources(before.get());
    add_objects(before.get());
    ASSERT_EQ(spc_scene_commit(before.get(), 1), SPC_OK) << spc_last_error();
    const ScenePtr scene = edited(before.get());
    expect_refused(spc_scene_keep_image(scene.get(), 1, &index), SPC_INVALID_ARGUMENT,
                   {"image index 1", "1 in the scene before"});
    expect_refused(spc_scene_keep_mesh(scene.get(), 0, nullptr), SPC_INVALID_ARGUMENT,
                   {"index is null"});
    // Plaster reads image 0, which is not there yet, and then another one.
    expect_refused(spc_scene_keep_material(scene.get(), 0, &index), SPC_INVALID_ARGUMENT,
                   {"Plaster", "image 0"});
    const spc_image_desc other = valid_image();
    ASSERT_EQ(spc_scene_add_image(scene.get(), &other, &index), SPC_OK);
    expect_refused(spc_scene_keep_material(scene.get(), 0, &index), SPC_INVALID_ARGUMENT,
                   {"Plaster", "image 0"});
    EXPECT_EQ(spc_scene_keep_material(scene.get(), 1, &index), SPC_OK) << spc_last_error();
    EXPECT_EQ(index, 0u);  // what was refused took no place
}

}  // namespace
}  // namespace spc::test
