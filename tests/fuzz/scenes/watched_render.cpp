// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes/watched_render.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>

namespace spc::fuzz {
namespace {

// Longest time for which a stage of the preparation may show no progress, s. The samples are
// exempt: they are counted by whole tiles, of which small pictures have few.
constexpr double kStandstill = 3.0;

constexpr const char* kStages[] = {"maps",          "sheets", "light paths",
                                   "camera chains", "probes", "samples"};

void require_ok(spc_status status) {
    if (status != SPC_OK) throw Broken{Check::numbers, spc_last_error()};
}

}  // namespace

const char* name_of(Check check) {
    switch (check) {
        case Check::weights: return "weights";
        case Check::numbers: return "numbers";
        case Check::progress: return "progress";
        case Check::times: return "times";
        case Check::cancelling: return "cancelling";
        case Check::means: return "means";
    }
    return "";
}

spc_render_settings settings_of(const Plan& plan, const Method& method, uint32_t seed) {
    spc_render_settings s;
    spc_render_settings_init(&s);
    s.method = method.method;
    s.light_tracing = method.light_tracing;
    s.seed = seed;
    s.threads = 2;
    s.max_bounces = s.max_glossy_bounces = s.max_transmission_bounces = plan.bounces;
    s.max_diffuse_bounces = plan.diffuse_bounces;
    s.caustics_reflective = plan.reflective ? 1 : 0;
    s.caustics_refractive = plan.refractive ? 1 : 0;
    s.pixel_filter = SPC_FILTER_BOX;  // errors of pixels are independent
    s.passes = (uint64_t{1} << SPC_PASS_COUNT) - 1;
    return s;
}

Stopwatch::Times Stopwatch::now() {
    timespec work{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &work);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now().time_since_epoch();
    return {passed.count(),
            static_cast<double>(work.tv_sec) + 1e-9 * static_cast<double>(work.tv_nsec)};
}

WatchedRender::WatchedRender(const spc_scene* scene, const spc_render_settings& settings,
                             std::string name)
    : name_(std::move(name)) {
    spc_session* session = nullptr;
    require_ok(spc_render_start(scene, &settings, &session));
    session_.reset(session);
}

spc_render_progress WatchedRender::wait(uint32_t milliseconds) {
    auto now = test::sized<spc_render_progress>();
    if (spc_render_wait(session_.get(), milliseconds, &now) != SPC_OK)
        broken(Check::numbers, spc_last_error());
    const auto within = [&](float value) { return value >= 0.0f && value <= 1.0f; };
    if (!within(now.fraction) || !within(now.stage_fraction) || now.stage >= SPC_STAGE_COUNT)
        broken(Check::progress, "it is out of range");
    if (now.stage < last_.stage || now.samples_done < last_.samples_done ||
        now.fraction < last_.fraction || now.seconds < last_.seconds)
        broken(Check::progress,
               fmt::format("it runs back: stage {} to {}, samples {} to {}, {} to {}", last_.stage,
                           now.stage, last_.samples_done, now.samples_done, last_.fraction,
                           now.fraction));
    const bool same = now.stage == last_.stage;
    if (same && now.stage_fraction < last_.stage_fraction)
        broken(Check::progress, fmt::format("{} run back from {} to {}", kStages[now.stage],
                                            last_.stage_fraction, now.stage_fraction));
    if (!same || now.stage_fraction > last_.stage_fraction ||
        now.samples_done > last_.samples_done || now.state != SPC_RENDER_RUNNING)
        stage_ = Stopwatch();
    else if (now.stage != SPC_STAGE_SAMPLES && stage_.seconds() > kStandstill)
        broken(Check::progress, fmt::format("{} stand still at {} for {} s", kStages[now.stage],
                                            now.stage_fraction, kStandstill));
    last_ = now;
    return now;
}

void WatchedRender::cancel() { require_ok(spc_render_cancel(session_.get())); }

spc_render_stats WatchedRender::stats() const {
    auto stats = test::sized<spc_render_stats>();
    require_ok(spc_render_get_stats(session_.get(), &stats));
    return stats;
}

std::vector<float> WatchedRender::read(uint32_t pass, uint32_t side) const {
    std::vector<float> pixels(size_t{spc_pass_channels(pass)} * side * side);
    require_ok(spc_film_read(session_.get(), pass, pixels.data(), pixels.size()));
    for (const float value : pixels)
        if (!std::isfinite(value))
            broken(Check::numbers, fmt::format("pass {} has {}", pass, value));
    return pixels;
}

void WatchedRender::check_stages() const {
    const spc_render_stats s = stats();
    const double all = std::accumulate(std::begin(s.stage_seconds), std::end(s.stage_seconds), 0.0);
    if (last_.state == SPC_RENDER_DONE &&
        (last_.stage != SPC_STAGE_SAMPLES || last_.fraction != 1.0f))
        broken(Check::progress,
               fmt::format("it ended at {} of {}", last_.fraction, kStages[last_.stage]));
    if (std::abs(all - last_.seconds) > 1e-6 * last_.seconds)
        broken(Check::progress,
               fmt::format("its stages took {} s, all together {} s", all, last_.seconds));
    if (s.nan_samples > 0)
        broken(Check::numbers, fmt::format("{} samples are not finite", s.nan_samples));
    if (s.lost_rays > 0) broken(Check::numbers, fmt::format("{} rays are not finite", s.lost_rays));
}

void WatchedRender::broken(Check check, const std::string& what) const {
    throw Broken{check, name_ + ": " + what};
}

}  // namespace spc::fuzz
