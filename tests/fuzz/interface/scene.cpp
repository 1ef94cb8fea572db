// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene.h"

#include "graphs.h"
#include "memory.h"
#include "render.h"
#include "shapes.h"
#include "support/api_scene.h"

#include <thread>

namespace spc::fuzz {

namespace {

class SceneRun {
public:
    SceneRun(uint64_t seed, Tally& tally)
        : dice_(seed),
          spoiler_(dice_, dice_.one_of({0.0, 0.003, 0.02, 0.1, 0.4}), dice_.chance(0.8)),
          promises_(tally) {}

    void run() {
        if (dice_.chance(0.1)) starve();
        spc_scene* scene = nullptr;
        while (!promises_.took([&] { return spc_scene_create(&scene); }, "")) {}
        scene_ = scene;
        add_resources();
        add_objects();
        set_camera();
        commit();
        render_all();
        stop_failing();
        InsideLibrary inside;
        spc_scene_destroy(scene_);
    }

private:
    // One allocation somewhere fails.
    void starve() {
        promises_.starved = true;
        fail_allocation_after(dice_.below(uint64_t{1} << dice_.from(0, 14)));
    }

    // Adds what is spoiled; if that is refused, or on a lack of memory, what is known to be right.
    template <class Desc>
    uint32_t add(spc_status (*call)(spc_scene*, const Desc*, uint32_t*), const Desc& spoiled,
                 const Desc& right) {
        uint32_t index = 77;
        uint32_t* const out = spoiler_.strikes() && dice_.chance(0.1) ? nullptr : &index;
        stood_in_ = !promises_.took([&] { return call(scene_, &spoiled, out); }, spoiled.name);
        if (!stood_in_) return index;
        if (index != 77) promises_.broken("a refused call wrote its result");
        for (int attempt = 0; attempt < 2; ++attempt)
            if (promises_.took([&] { return call(scene_, &right, &index); }, right.name))
                return index;
        promises_.broken(spc_last_error());
    }

    void add_resources() {
        for (uint32_t i = dice_.below(3); i > 0; --i) add_image();
        for (uint32_t i = dice_.from(1, 4); i > 0; --i) {
            const Graph graph = random_graph(dice_, spoiler_, images_, Purpose::surface);
            add(spc_scene_add_material, graph.desc, test::mirror_material());
            ++materials_;
            if (dice_.chance(0.2)) call_out_of_order();
        }
        for (uint32_t i = dice_.from(1, 3); i > 0; --i) {
            const Shape shape = random_shape(dice_, spoiler_);
            const uint32_t mesh = add(spc_scene_add_mesh, shape.desc, test::valid_mesh());
            slots_.resize(mesh + 1, 0);
            slots_[mesh] = stood_in_ ? test::valid_mesh().slot_count : shape.desc.slot_count;
        }
    }

    void add_image() {
        const uint32_t width = dice_.from(1, 16), height = dice_.from(1, 16),
                       channels = dice_.one_of({1u, 3u, 4u});
        std::vector<float> texels(size_t{width} * height * channels);
        for (float& texel : texels) texel = spoiler_.number(dice_.between(0.0f, 1.0f));
        spc_image_desc desc = test::valid_image();
        desc.struct_size = spoiler_.struct_size(desc.struct_size);
        desc.pixels = spoiler_.pointer(texels.data());
        // A size that is not that of the texels cannot be told from one that is.
        desc.width = width;
        desc.height = height;
        desc.channels = channels;
        desc.pixel_type = dice_.chance(0.7) ? SPC_PIXEL_F32 : SPC_PIXEL_U8;
        desc.color_space = spoiler_.count(dice_.below(3));
        desc.alpha_mode = spoiler_.count(dice_.below(4));
        if (dice_.chance(0.05)) encode(desc, texels);
        add(spc_scene_add_image, desc, test::valid_image());
        ++images_;
    }

    // Bytes that are no image, or a path to none.
    void encode(spc_image_desc& desc, const std::vector<float>& texels) {
        if (!dice_.chance(0.3)) desc.pixels = nullptr;
        if (dice_.chance(0.5)) desc.path = dice_.one_of({"", "/", "/dev/null", "/none.png"});
        if (dice_.chance(0.7)) desc.encoded = texels.data();
        desc.encoded_size = dice_.below(texels.size() * sizeof(float) + 1);
    }

    void add_objects() {
        for (uint32_t i = dice_.from(1, 5); i > 0; --i) add_instance();
        for (uint32_t i = dice_.below(4); i > 0; --i) add_light();
        if (dice_.chance(0.5)) set_environment();
    }

    void add_instance() {
        const uint32_t mesh = dice_.below(slots_.size());
        const std::vector<uint32_t> none(16, SPC_NONE);
        std::vector<uint32_t> materials(16);
        for (uint32_t& material : materials)
            material = spoiler_.count(dice_.chance(0.03) ? SPC_NONE : dice_.below(materials_));
        auto desc = test::sized<spc_instance_desc>();
        desc.struct_size = spoiler_.struct_size(desc.struct_size);
        desc.name = "Garden";
        desc.mesh = spoiler_.strikes() ? spoiler_.count(mesh) : mesh;
        random_transform(dice_, spoiler_, desc.transform);
        desc.materials = spoiler_.pointer(materials.data());
        desc.material_count = slots_[mesh];
        desc.visibility = dice_.chance(0.8) ? 31u : dice_.below(40);
        desc.caustics_role = spoiler_.count(dice_.chance(0.7) ? 0 : dice_.below(5));
        desc.terminator_offset =
            spoiler_.number(dice_.chance(0.8) ? 0.0f : dice_.between(0.0f, 1.0f));
        desc.light_group = random_group();
        desc.receives_in = random_sets();
        desc.blocks_in = random_sets();
        desc.receiver_sets = random_sets();
        desc.blocker_sets = random_sets();
        spc_instance_desc right = desc;
        right.struct_size = sizeof(right);
        right.mesh = mesh;
        test::set_identity(right.transform);
        right.materials = none.data();
        right.visibility = SPC_VISIBLE_ALL;
        right.caustics_role = SPC_CAUSTICS_AUTO;
        right.terminator_offset = 0.0f;
        add(spc_scene_add_instance, desc, right);
    }

    const char* random_group() {
        return dice_.one_of<const char*>({nullptr, "", "key", "fill", "none"});
    }

    uint64_t random_sets() { return dice_.chance(0.6) ? 0 : uint64_t{dice_.below(8)} << 30; }

    void add_light() {
        spc_light_desc desc = test::valid_light(dice_.below(4));
        const spc_light_desc right = desc;
        desc.struct_size = spoiler_.struct_size(desc.struct_size);
        desc.type = spoiler_.strikes() ? spoiler_.count(desc.type) : desc.type;
        random_transform(dice_, spoiler_, desc.transform);
        spoiler_.numbers(desc.power, 3);
        if (dice_.chance(0.3)) desc.radius = desc.sun_angle = 0.0f;
        for (float* value : {&desc.radius, &desc.spot_angle, &desc.spot_blend, &desc.sun_angle,
                             &desc.size[0], &desc.size[1], &desc.spread})
            *value = spoiler_.number(*value);
        desc.shape = spoiler_.count(dice_.below(2));
        desc.visibility = dice_.chance(0.8) ? 31u : dice_.below(40);
        desc.feeds_caustics = spoiler_.count(dice_.below(2));
        desc.light_group = random_group();
        desc.receiver_sets = random_sets();
        desc.blocker_sets = random_sets();
        desc.max_bounces = spoiler_.count(dice_.chance(0.7) ? 1024 : dice_.below(3));
        if (materials_ > 0 && dice_.chance(0.5))
            desc.material = spoiler_.count(dice_.below(materials_));
        add(spc_scene_add_light, desc, right);
    }

    void set_environment() {
        const Graph graph =
            random_graph(dice_, spoiler_, dice_.chance(0.15) ? images_ : 0, Purpose::world);
        auto desc = test::sized<spc_environment_desc>();
        desc.struct_size = spoiler_.struct_size(desc.struct_size);
        desc.material = add(spc_scene_add_material, graph.desc, test::sky_material());
        if (spoiler_.strikes()) desc.material = spoiler_.count(desc.material);
        ++materials_;
        desc.visibility = spoiler_.count(SPC_VISIBLE_ALL);
        desc.feeds_caustics = dice_.below(2);
        desc.light_group = random_group();
        promises_.took([&] { return spc_scene_set_environment(scene_, &desc); }, "world");
    }

    void set_camera() {
        spc_camera_desc desc = test::valid_camera(dice_.from(1, 8), dice_.from(1, 8));
        const spc_camera_desc right = desc;
        desc.struct_size = spoiler_.struct_size(desc.struct_size);
        desc.projection = spoiler_.strikes() ? spoiler_.count(0) : dice_.below(9);
        random_transform(dice_, spoiler_, desc.transform);
        desc.transform[11] = spoiler_.number(4.0f);
        if (spoiler_.strikes()) desc.width = spoiler_.count(desc.width);
        if (spoiler_.strikes()) desc.height = spoiler_.count(desc.height);
        spoil_crop(desc);
        spoiler_.numbers(desc.viewplane, 4);
        std::fill(std::begin(desc.panorama), std::end(desc.panorama), 1.0f);
        spoiler_.numbers(desc.panorama, 8);
        desc.aperture_radius = dice_.chance(0.3) ? 0.1f : 0.0f;
        desc.focus_distance = 4.0f;
        desc.aperture_ratio = 1.0f;
        desc.aperture_blades = spoiler_.count(dice_.below(8));
        for (float* value : {&desc.clip_near, &desc.clip_far, &desc.aperture_radius,
                             &desc.focus_distance, &desc.aperture_rotation, &desc.aperture_ratio})
            *value = spoiler_.number(*value);
        if (promises_.took([&] { return spc_scene_set_camera(scene_, &desc); }, "camera")) {
            width_ = desc.crop[2];
            height_ = desc.crop[3];
            return;
        }
        width_ = right.crop[2];
        height_ = right.crop[3];
        while (!promises_.took([&] { return spc_scene_set_camera(scene_, &right); }, "camera")) {}
    }

    // Anywhere in the frame; so small that it is rendered at once, or so large that it cannot be.
    void spoil_crop(spc_camera_desc& desc) {
        for (uint32_t& value : desc.crop) value = spoiler_.count(value);
        constexpr uint64_t kSmall = 1024, kHuge = uint64_t{1} << 25;
        const uint64_t pixels = uint64_t{desc.crop[2]} * desc.crop[3];
        if (pixels > kSmall && pixels < kHuge) desc.crop[2] = desc.crop[3] = 4;
    }

    // What is refused whatever it says, and leaves no mark.
    void call_out_of_order() {
        spc_session* session = nullptr;
        spc_render_settings settings;
        spc_render_settings_init(&settings);
        auto stats = test::sized<spc_scene_stats>();
        auto needs = test::sized<spc_material_needs>();
        const auto refused = [&](auto&& call) {
            if (promises_.took(call, "")) promises_.broken("a call out of order was taken");
        };
        refused([&] { return spc_render_start(scene_, &settings, &session); });
        refused([&] { return spc_scene_get_stats(scene_, &stats); });
        refused([&] { return spc_scene_commit(nullptr, 1); });
        refused([&] { return spc_scene_commit(scene_, 1); });  // no camera yet
        refused([&] { return spc_scene_commit_start(scene_, 1); });
        refused([&] { return spc_scene_commit_cancel(scene_); });
        uint32_t ended = 0;
        refused([&] { return spc_scene_commit_wait(scene_, 0, &ended); });
        refused([&] { return spc_render_cancel(nullptr); });
        promises_.took([&] { return spc_scene_material_needs(scene_, dice_.below(6), &needs); }, "");
        auto forecast = test::sized<spc_forecast>();
        const uint32_t materials[2] = {dice_.below(6), dice_.below(6)};
        promises_.took(
            [&] {
                return spc_scene_forecast(scene_, materials, dice_.below(3), dice_.below(33),
                                          dice_.below(6), &forecast);
            },
            "");
    }

    void commit() {
        const uint32_t threads = spoiler_.strikes() ? spoiler_.count(1) % 1100 : dice_.from(1, 2);
        const bool at_once = dice_.chance(0.6);
        const auto call = at_once ? spc_scene_commit : spc_scene_commit_start;
        committed_ = promises_.took([&] { return call(scene_, threads); }, "");
        if (!committed_ && !promises_.starved)
            committed_ = promises_.took([&] { return call(scene_, 1); }, "");
        if (!committed_ && !promises_.starved) promises_.broken(spc_last_error());
        if (committed_ && !at_once) committed_ = wait_for_commit();
        if (committed_ && promises_.took([&] { return spc_scene_commit(scene_, threads); }, ""))
            promises_.broken("a scene was committed twice");
        InsideLibrary inside;
        if ((spc_scene_report(scene_) != nullptr) != committed_)
            promises_.broken("a report without a commit, or the other way round");
    }

    // Whether the scene is committed. Some are cancelled, some left to be destroyed as they are.
    bool wait_for_commit() {
        if (dice_.chance(0.1)) return false;
        if (promises_.took([&] { return spc_scene_commit(scene_, 1); }, ""))
            promises_.broken("a scene was committed twice at once");
        const bool cancelled = dice_.chance(0.2);
        if (cancelled && !promises_.took([&] { return spc_scene_commit_cancel(scene_); }, ""))
            promises_.broken(spc_last_error());
        uint32_t ended = 0;
        spc_status status = SPC_OK;
        while (status == SPC_OK && ended == 0)
            promises_.took([&] { return status = spc_scene_commit_wait(scene_, 100, &ended); }, "");
        const bool may_fail = promises_.starved || (cancelled && status == SPC_CANCELLED);
        if (status != SPC_OK && !may_fail) promises_.broken(spc_last_error());
        return status == SPC_OK;
    }

    void render_all() {
        if (!committed_) return;
        const Film film{width_, height_};
        if (!dice_.chance(0.15)) return render(scene_, film, Dice(dice_.bits()), promises_);
        std::vector<std::jthread> threads;
        for (int i = 0; i < 2; ++i)
            threads.emplace_back([this, film, dice = Dice(dice_.bits())] {
                begin_outside_library();
                render(scene_, film, dice, promises_);
            });
    }

    Dice dice_;
    Spoiler spoiler_;
    Promises promises_;
    spc_scene* scene_ = nullptr;
    uint32_t images_ = 0, materials_ = 0;
    std::vector<uint32_t> slots_;  // of each mesh
    uint32_t width_ = 0, height_ = 0;
    bool stood_in_ = false;  // for what add() was given last
    bool committed_ = false;
};

}  // namespace

void run_scene(uint64_t seed, Tally& tally) {
    begin_outside_library();
    SceneRun(seed, tally).run();
    ++tally.scenes;
}

}  // namespace spc::fuzz
