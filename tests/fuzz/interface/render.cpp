// SPDX-License-Identifier: GPL-3.0-or-later
#include "render.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace spc::fuzz {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(1);  // then the render is cancelled

spc_render_settings random_settings(Dice& dice, Spoiler& spoiler) {
    spc_render_settings s;
    spc_render_settings_init(&s);
    s.struct_size = spoiler.struct_size(s.struct_size);
    s.method = spoiler.count(dice.below(SPC_METHOD_AUTO + 1));
    s.light_tracing = spoiler.count(dice.below(3));
    s.constraint = spoiler.count(dice.below(2));
    s.two_stage = dice.below(2);
    s.set_size = spoiler.count(dice.from(1, 8));
    s.glint_method = spoiler.count(dice.below(4));
    s.first_sample = dice.chance(0.2) ? spoiler.count(5) : 0;
    s.samples = dice.from(1, 4);
    s.time_limit = dice.chance(0.3) ? spoiler.number(0.05f) : 0.0f;
    s.seed = spoiler.count(dice.below(100));
    s.threads = dice.from(1, 2);
    for (uint32_t* bounces : {&s.max_bounces, &s.max_diffuse_bounces, &s.max_glossy_bounces,
                              &s.max_transmission_bounces, &s.max_transparent_bounces})
        *bounces = spoiler.count(dice.below(9));
    s.caustics_reflective = dice.below(4);
    s.caustics_refractive = dice.below(4);
    s.pixel_filter = spoiler.count(dice.below(3));
    s.filter_width = spoiler.number(s.filter_width);
    s.passes = dice.chance(0.5) ? (uint64_t{1} << SPC_PASS_COUNT) - 1 : 0;
    s.light_groups = dice.one_of({"", "key", "key\nfill", "key\nkey"});
    s.color_aovs = dice.one_of({"", "mask", "mask\nTEXT"});
    s.value_aovs = dice.one_of({"", "mask"});
    s.pass_alpha_threshold = spoiler.number(s.pass_alpha_threshold);
    s.transparent_film = dice.below(2);
    s.transparent_glass = dice.below(2);
    if (dice.chance(0.1)) s.chain_family = dice.one_of({"", "T", "RR", "TTTTTT", "TTTTTTT", "x"});
    return s;
}

class Render {
public:
    Render(const Film& film, Dice& dice, Promises& promises, spc_session* session)
        : film_(film), dice_(dice), promises_(promises), session_(session) {}

    void run() {
        const Clock::time_point begun = Clock::now();
        bool cancelled = dice_.chance(0.1) && cancel();
        for (;;) {
            const uint32_t state = wait();
            if (state != SPC_RENDER_RUNNING) return finish(state, cancelled);
            if (dice_.chance(0.05)) read(dice_.below(SPC_PASS_COUNT + 1));
            if (dice_.chance(0.05)) pause(dice_.below(2));
            if (dice_.chance(0.02)) return;  // its destruction cancels it
            if (!cancelled && (dice_.chance(0.03) || Clock::now() - begun > kPatience))
                cancelled = cancel();
        }
    }

private:
    bool cancel() {
        return promises_.took([&] { return spc_render_cancel(session_); }, "");
    }

    void pause(uint32_t paused) {
        promises_.took([&] { return spc_render_pause(session_, paused); }, "");
    }

    uint32_t wait() {
        spc_render_progress progress{};
        progress.struct_size = sizeof(progress);
        const bool went = promises_.took(
            [&] { return spc_render_wait(session_, dice_.below(60), &progress); }, "");
        if (!(progress.fraction >= 0.0f && progress.fraction <= 1.0f && progress.seconds >= 0.0))
            promises_.broken("progress out of range");
        if (!went && progress.state != SPC_RENDER_FAILED && !promises_.starved)
            promises_.broken(spc_last_error());
        return progress.state;
    }

    void read(uint32_t pass) {
        const size_t channels = spc_pass_channels(pass);
        const size_t count = channels * film_.width * film_.height;
        std::vector<float> pixels(std::max<size_t>(count, 1));
        const bool right = !dice_.chance(0.02);
        const bool went = promises_.took(
            [&] { return spc_film_read(session_, pass, pixels.data(), right ? count : count + 1); },
            "");
        if (went && (!right || channels == 0)) promises_.broken("an impossible pass was read");
        if (!went) return;
        for (const float value : pixels)
            if (!std::isfinite(value))
                promises_.broken("pass " + std::to_string(pass) + " is not finite");
    }

    void finish(uint32_t state, bool cancelled) {
        if (state == SPC_RENDER_FAILED) return;
        for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) read(pass);
        for (const uint32_t first :
             {SPC_CUSTOM_LIGHT_GROUP, SPC_CUSTOM_COLOR_AOV, SPC_CUSTOM_VALUE_AOV})
            for (const uint32_t index : {0u, 1u}) read(first + index);
        spc_render_stats stats{};
        stats.struct_size = sizeof(stats);
        promises_.took([&] { return spc_render_get_stats(session_, &stats); }, "");
        promises_.count([&](Tally& tally) {
            ++(cancelled ? tally.cancelled : tally.pictures);
            tally.bad_rays += stats.lost_rays > 0 ? 1 : 0;
            tally.bad_samples += stats.nan_samples > 0 ? 1 : 0;
        });
    }

    Film film_;
    Dice& dice_;
    Promises& promises_;
    spc_session* session_;
};

}  // namespace

void Promises::broken(const std::string& what) {
    std::fprintf(stderr, "FUZZ: a promise is broken: %s\n", what.c_str());
    std::abort();
}

bool Promises::judge(spc_status status, const char* name) {
    count([](Tally& tally) { ++tally.calls; });
    if (status == SPC_OK) return true;
    const std::string message = spc_last_error();
    const auto says = [&](const char* word) { return message.find(word) != std::string::npos; };
    if (status == SPC_INTERNAL_ERROR || message.empty()) broken("internal error: " + message);
    if (status == SPC_OUT_OF_MEMORY)
        count([](Tally& tally) { ++tally.out_of_memory; });
    else
        count([](Tally& tally) { ++tally.refusals; });
    if (status == SPC_INVALID_ARGUMENT && name != nullptr && !says(name) && !says("is null") &&
        !says("struct_size") && !(starved && says("no memory left")))
        broken(std::string("\"") + name + "\" is not named by: " + message);
    return false;
}

void render(const spc_scene* scene, const Film& film, Dice dice, Promises& promises) {
    Spoiler spoiler(dice, dice.chance(0.7) ? 0.0 : 0.1, false);
    const spc_render_settings settings = random_settings(dice, spoiler);
    spc_session* session = nullptr;
    if (!promises.took([&] { return spc_render_start(scene, &settings, &session); }, "")) {
        if (session != nullptr) promises.broken("a refused render left a session");
        return;
    }
    Render(film, dice, promises, session).run();
    InsideLibrary inside;
    spc_session_destroy(session);
}

}  // namespace spc::fuzz
