// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/gate.h"
#include "api/handles.h"

#include <fmt/format.h>

#ifndef SPC_ISA_LEVEL
#define SPC_ISA_LEVEL "unknown"
#endif

namespace spc::api {
namespace {

std::string& last_error() {
    thread_local std::string message;
    return message;
}

// Beyond these a render could neither be cancelled in time nor show anything.
constexpr uint32_t kMostWalks = 4096;
constexpr float kWidestFilter = 1000.0f;
// Below this a filter is a point, and its density beyond single precision.
constexpr float kNarrowestFilter = 0.01f;

void check_settings(const spc_render_settings& s) {
    require(s.method <= SPC_METHOD_AUTO, fmt::format("unknown method {}", s.method));
    require(s.light_tracing <= SPC_LIGHT_TRACING_OFF,
            fmt::format("unknown light tracing {}", s.light_tracing));
    require(s.constraint <= SPC_CONSTRAINT_ANGLE_DIFFERENCE,
            fmt::format("unknown constraint {}", s.constraint));
    require(s.glint_method <= SPC_GLINT_METHOD_YAN,
            fmt::format("unknown glint method {}", s.glint_method));
    require(s.pixel_filter <= SPC_FILTER_BLACKMAN_HARRIS,
            fmt::format("unknown pixel filter {}", s.pixel_filter));
    require(s.samples >= 1, "samples must be at least 1");
    require(s.samples <= 0xffffffffu - s.first_sample, "first_sample + samples is out of range");
    require(s.set_size >= 1 && s.set_size <= kMostWalks,
            fmt::format("set_size must lie in [1, {}]", kMostWalks));
    require(std::isfinite(s.time_limit) && s.time_limit >= 0.0f,
            "time_limit must be finite and not negative");
    require_thread_count(s.threads);
    require(
        s.pixel_filter == SPC_FILTER_BOX ||
            (s.filter_width >= kNarrowestFilter && s.filter_width <= kWidestFilter),
        fmt::format("filter_width must lie in [{}, {}] pixels", kNarrowestFilter, kWidestFilter));
}

ChainFinder finder_of(uint32_t method) {
    switch (method) {
        case SPC_METHOD_AUTO:
        case SPC_METHOD_SHEETS: return ChainFinder::sheets;
        case SPC_METHOD_MNEE:
        case SPC_METHOD_MNEE_BIASED: return ChainFinder::mnee;
        default: return ChainFinder::walks;
    }
}

std::vector<spc::Interaction> to_family(const char* letters) {
    std::vector<spc::Interaction> family;
    for (const char* letter = letters == nullptr ? "" : letters; *letter != 0; ++letter) {
        require((*letter == 'R' || *letter == 'T') && family.size() < spc::kLongestManifoldChain,
                fmt::format("chain_family must be at most {} letters R and T",
                            spc::kLongestManifoldChain));
        family.push_back(*letter == 'R' ? spc::Interaction::reflection
                                        : spc::Interaction::refraction);
    }
    return family;
}

RenderSettings to_settings(const spc_render_settings& s) {
    check_settings(s);
    RenderSettings settings;
    IntegratorSettings& integrator = settings.integrator;
    integrator.limits = {s.max_bounces, s.max_diffuse_bounces, s.max_glossy_bounces,
                         s.max_transmission_bounces, s.max_transparent_bounces};
    integrator.transparent_film = s.transparent_film != 0;
    ManifoldSettings& manifold = integrator.manifold;
    manifold.enabled = s.method != SPC_METHOD_PT && s.method != SPC_METHOD_LT;
    manifold.finder = finder_of(s.method);
    manifold.biased = s.method == SPC_METHOD_SMS_BIASED || s.method == SPC_METHOD_MNEE_BIASED;
    manifold.set_size = s.set_size;
    const std::vector<spc::Interaction> family = to_family(s.chain_family);
    if (manifold.finder == ChainFinder::walks) manifold.family = family;
    manifold.constraint = static_cast<Constraint>(s.constraint);
    manifold.two_stage = s.two_stage != 0;
    manifold.reflections = s.caustics_reflective != 0;
    manifold.refractions = s.caustics_refractive != 0;
    integrator.glints.method = static_cast<GlintMethod>(s.glint_method);
    integrator.glints.set_size = s.set_size;
    settings.light_tracing =
        s.method == SPC_METHOD_LT || (manifold.enabled && s.light_tracing != SPC_LIGHT_TRACING_OFF);
    settings.chooses = s.method == SPC_METHOD_AUTO;
    settings.first_sample = s.first_sample;
    settings.samples = s.samples;
    settings.time_limit = s.time_limit;
    settings.seed = s.seed;
    settings.threads = s.threads;
    settings.filter = static_cast<FilterKind>(s.pixel_filter);
    settings.filter_width = s.filter_width;
    return settings;
}

Session& session_of(spc_session* session) {
    require(session != nullptr, "session is null");
    return session->session;
}

}  // namespace

void set_last_error(const std::string& message) { last_error() = message; }
// So short that every string has the room.
void set_last_error_without_memory() noexcept { last_error() = "no memory left"; }

}  // namespace spc::api

using namespace spc::api;

uint32_t spc_api_version(void) { return SPC_API_VERSION; }

const char* spc_version_string(void) {
    static const std::string text =
        fmt::format("0.1.0 {} {}", SPC_ISA_LEVEL, spc::Accel::library_version());
    return text.c_str();
}

const char* spc_last_error(void) { return last_error().c_str(); }

void spc_render_settings_init(spc_render_settings* settings) {
    if (settings == nullptr) return;
    const spc::RenderSettings defaults;
    const spc::BounceLimits& limits = defaults.integrator.limits;
    *settings = {};
    settings->struct_size = sizeof(*settings);
    settings->method = SPC_METHOD_SMS_UNBIASED;
    settings->constraint = SPC_CONSTRAINT_ANGLE_DIFFERENCE;
    settings->two_stage = 1;
    settings->set_size = defaults.integrator.manifold.set_size;
    settings->samples = defaults.samples;
    settings->max_bounces = limits.total;
    settings->max_diffuse_bounces = limits.diffuse;
    settings->max_glossy_bounces = limits.glossy;
    settings->max_transmission_bounces = limits.transmission;
    settings->max_transparent_bounces = limits.transparent;
    settings->caustics_reflective = settings->caustics_refractive = 1;
    settings->pixel_filter = SPC_FILTER_BLACKMAN_HARRIS;
    settings->filter_width = defaults.filter_width;
}

spc_status spc_render_start(const spc_scene* scene, const spc_render_settings* settings,
                            spc_session** session) {
    return gate("spc_render_start", [&] {
        require(scene != nullptr, "scene is null");
        if (!scene->world)
            throw spc::Error(spc::ErrorKind::wrong_state, "the scene is not committed");
        spc_session*& out = checked_output(session, "session");
        const spc::RenderSettings checked_settings = to_settings(checked(settings, "settings"));
        const auto& crop = scene->world->scene->camera.crop;
        out = spc::with_memory_for(
            fmt::format("the film of {} x {} pixels, or the threads", crop[2], crop[3]),
            [&] { return new spc_session(*scene, checked_settings); });
    });
}

spc_status spc_render_wait(spc_session* session, uint32_t milliseconds,
                           spc_render_progress* progress) {
    return gate("spc_render_wait", [&] {
        spc::Session& s = session_of(session);
        if (progress != nullptr) checked(progress, "progress");
        const spc::RenderProgress now = s.wait(std::chrono::milliseconds(milliseconds));
        if (progress != nullptr)
            *progress = {sizeof(*progress),  static_cast<uint32_t>(now.state),
                         now.samples_done,   now.fraction,
                         now.seconds,        static_cast<uint32_t>(now.stage),
                         now.stage_fraction, now.seconds_left};
        if (now.state == spc::RenderState::failed)
            spc::with_memory_for("rendering", [&] { std::rethrow_exception(s.failure()); });
    });
}

spc_status spc_render_cancel(spc_session* session) {
    return gate("spc_render_cancel", [&] { session_of(session).cancel(); });
}

spc_status spc_render_get_stats(spc_session* session, spc_render_stats* stats) {
    return gate("spc_render_get_stats", [&] {
        const spc::RenderStats s = session_of(session).stats();
        checked(stats, "stats");
        const spc::ManifoldStats& m = s.path.manifold;
        *stats = {sizeof(*stats),
                  s.samples,
                  s.path.rays + m.rays + s.light.rays,
                  m.estimates,
                  m.walks,
                  m.converged,
                  m.iterations,
                  m.trial_estimates,
                  m.trials,
                  m.max_trials,
                  {},
                  m.capped,
                  m.capped_energy,
                  s.manifold_energy,
                  s.nan_samples + s.light.nan_splats,
                  s.light.paths,
                  s.light.splats,
                  m.chain_seeds,
                  m.roots,
                  m.missed,
                  m.missed_energy,
                  s.path.glints.estimates,
                  s.path.glints.nodes,
                  s.path.glints.points,
                  s.path.glints.capped,
                  s.glint_bytes,
                  {},
                  s.first_sample_seconds,
                  s.lost_rays};
        std::ranges::copy(m.trial_histogram, stats->trial_histogram);
        static_assert(std::size(decltype(stats->stage_seconds){}) == spc::kRenderStages &&
                      spc::kRenderStages == SPC_STAGE_COUNT);
        std::ranges::copy(s.stage_seconds, stats->stage_seconds);
    });
}

const char* spc_render_report(spc_session* session) {
    const spc_status status = gate("spc_render_report", [&] {
        const std::vector<std::string> lines = session_of(session).report();
        session->report.clear();
        for (const std::string& line : lines) session->report += line + "\n";
    });
    return status == SPC_OK ? session->report.c_str() : nullptr;
}

uint32_t spc_pass_channels(uint32_t pass) {
    return pass < SPC_PASS_COUNT ? spc::pass_channels(static_cast<spc::Pass>(pass)) : 0;
}

spc_status spc_film_read(spc_session* session, uint32_t pass, float* buffer, size_t count) {
    return gate("spc_film_read", [&] {
        const spc::Film& film = session_of(session).film();
        require(pass < SPC_PASS_COUNT, fmt::format("unknown pass {}", pass));
        require(buffer != nullptr, "buffer is null");
        const size_t expected =
            static_cast<size_t>(spc_pass_channels(pass)) * film.width() * film.height();
        require(count == expected,
                fmt::format("the buffer holds {} floats, the pass has {}", count, expected));
        film.read(static_cast<spc::Pass>(pass), {buffer, count});
    });
}

void spc_session_destroy(spc_session* session) { delete session; }
