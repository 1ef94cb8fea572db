// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/gate.h"
#include "api/handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <sstream>

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

// Takes the host's settings into the core's, if they are within bounds.
struct Take {
    template <class T>
    void number(const char* name, T host, T& core, std::type_identity_t<T> least,
                std::type_identity_t<T> most) const {
        require(host >= least && host <= most,  // no NaN is
                fmt::format("{} must lie in [{}, {}]", name, least, most));
        core = host;
    }
    void flag(uint32_t host, bool& core) const { core = host != 0; }
    template <class E>
    void choice(const char* name, uint32_t host, E& core, uint32_t last) const {
        core = checked_enum<E>(host, last, "settings", name);
    }
};

// Gives the host the core's settings, which are the defaults.
struct Give {
    template <class T>
    void number(const char*, T& host, T core, std::type_identity_t<T>,
                std::type_identity_t<T>) const {
        host = core;
    }
    void flag(uint32_t& host, bool core) const { host = core ? 1 : 0; }
    template <class E>
    void choice(const char*, uint32_t& host, E core, uint32_t) const {
        host = static_cast<uint32_t>(core);
    }
};

// A row for each setting that is one of the core's as it stands.
template <class Way, class Host, class Core>
void exchange(const Way& way, Host& host, Core& core) {
    constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
    constexpr float kLongest = std::numeric_limits<float>::max();
    auto& integrator = core.integrator;
    auto& manifold = integrator.manifold;
    auto& limits = integrator.limits;
    way.choice("constraint", host.constraint, manifold.constraint, SPC_CONSTRAINT_ANGLE_DIFFERENCE);
    way.flag(host.two_stage, manifold.two_stage);
    way.number("set_size", host.set_size, manifold.set_size, 1, kMostWalks);
    way.choice("glint method", host.glint_method, integrator.glints.method, SPC_GLINT_METHOD_YAN);
    way.number("first_sample", host.first_sample, core.first_sample, 0, kMost);
    way.number("samples", host.samples, core.samples, 1, kMost);
    way.number("time_limit", host.time_limit, core.time_limit, 0.0f, kLongest);
    way.number("seed", host.seed, core.seed, 0, kMost);
    way.number("threads", host.threads, core.threads, 0, kMostThreads);
    way.number("max_bounces", host.max_bounces, limits.total, 0, kMost);
    way.number("max_diffuse_bounces", host.max_diffuse_bounces, limits.diffuse, 0, kMost);
    way.number("max_glossy_bounces", host.max_glossy_bounces, limits.glossy, 0, kMost);
    way.number("max_transmission_bounces", host.max_transmission_bounces, limits.transmission, 0,
               kMost);
    way.number("max_transparent_bounces", host.max_transparent_bounces, limits.transparent, 0,
               kMost);
    way.flag(host.caustics_reflective, manifold.reflections);
    way.flag(host.caustics_refractive, manifold.refractions);
    way.choice("pixel filter", host.pixel_filter, core.filter, SPC_FILTER_BLACKMAN_HARRIS);
    if (host.pixel_filter != SPC_FILTER_BOX)
        way.number("filter_width", host.filter_width, core.filter_width, kNarrowestFilter,
                   kWidestFilter);
    way.flag(host.transparent_film, integrator.transparent_film);
    way.flag(host.transparent_glass, integrator.transparent_glass);
    way.number("transparent_glass_roughness", host.transparent_glass_roughness,
               integrator.transparent_glass_alpha, 0.0f, 1.0f);
    way.number("total_samples", host.total_samples, core.total_samples, 0, kMost);
    way.number("pass_alpha_threshold", host.pass_alpha_threshold, integrator.pass_alpha_threshold,
               0.0f, 1.0f);
    way.number("mist_start", host.mist_start, core.mist.start, 0.0f, kLongest);
    way.number("mist_depth", host.mist_depth, core.mist.depth, 0.0f, kLongest);
    way.number("mist_exponent", host.mist_exponent, core.mist.exponent, 0.0f, kLongest);
    way.flag(host.for_denoiser, core.for_denoiser);
    way.number("noise_threshold", host.noise_threshold, core.noise_threshold, 0.0f, 1.0f);
    way.number("min_samples", host.min_samples, core.min_samples, 0, kMost);
    way.number("crypto_kinds", host.crypto_kinds, core.crypto.kinds, 0, (1u << kCryptoKinds) - 1);
    way.number("crypto_ranks", host.crypto_ranks, core.crypto.ranks, 0, kMostCryptoRanks);
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

// What several of the core's settings follow from.
void choose_method(const spc_render_settings& s, RenderSettings& settings) {
    checked_enum<spc_method>(s.method, SPC_METHOD_AUTO, "settings", "method");
    checked_enum<spc_light_tracing>(s.light_tracing, SPC_LIGHT_TRACING_OFF, "settings",
                                    "light tracing");
    ManifoldSettings& manifold = settings.integrator.manifold;
    manifold.enabled = s.method != SPC_METHOD_PT && s.method != SPC_METHOD_LT;
    manifold.finder = finder_of(s.method);
    manifold.biased = s.method == SPC_METHOD_SMS_BIASED || s.method == SPC_METHOD_MNEE_BIASED;
    const std::vector<spc::Interaction> family = to_family(s.chain_family);
    if (manifold.finder == ChainFinder::walks) manifold.family = family;
    settings.integrator.glints.set_size = manifold.set_size;
    settings.light_tracing =
        s.method == SPC_METHOD_LT || (manifold.enabled && s.light_tracing != SPC_LIGHT_TRACING_OFF);
    settings.chooses = s.method == SPC_METHOD_AUTO;
}

// Names that stand in a line each.
std::vector<std::string> to_names(const char* lines, const char* what) {
    std::vector<std::string> names;
    std::istringstream text(lines == nullptr ? "" : lines);
    for (std::string name; std::getline(text, name);) {
        require(std::ranges::find(names, name) == names.end(),
                fmt::format("{} names \"{}\" twice", what, name));
        names.push_back(name);
    }
    require(names.size() <= spc::kMostCustom,
            fmt::format("{} holds more than {} names", what, spc::kMostCustom));
    return names;
}

RenderSettings to_settings(const spc_render_settings& s) {
    RenderSettings settings;
    exchange(Take{}, s, settings);
    require(s.samples <= 0xffffffffu - s.first_sample, "first_sample + samples is out of range");
    choose_method(s, settings);
    settings.custom.of = {to_names(s.light_groups, "light_groups"),
                          to_names(s.color_aovs, "color_aovs"),
                          to_names(s.value_aovs, "value_aovs")};
    settings.passes = spc::PassSet(s.passes, settings.custom.counts());
    require(s.passes >> SPC_PASS_COUNT == 0, "passes holds a bit of no pass");
    if (s.total_samples > 0) {
        require(s.first_sample + s.samples <= s.total_samples,
                "total_samples is less than first_sample + samples");
        require(s.time_limit == 0.0f, "a part of a render has no time limit");
    }
    return settings;
}

Session& session_of(spc_session* session) {
    require(session != nullptr, "session is null");
    return session->session;
}

std::unique_ptr<Film> film_of(const void* sums, size_t size) {
    require(sums != nullptr, "sums is null");
    return with_memory_for("the sums of a film", [&] {
        return Film::from_bytes({static_cast<const std::byte*>(sums), size});
    });
}

void read_crypto(const Film& film, uint32_t kind, uint32_t level, float* buffer, size_t count) {
    const auto wanted = checked_enum<CryptoKind>(kind, SPC_CRYPTO_ASSET, "Cryptomatte", "kind");
    require(buffer != nullptr, "buffer is null");
    require(film.crypto().has(wanted) && level < film.crypto().ranks,
            fmt::format("level {} of kind {} was not asked for", level, kind));
    const size_t expected = size_t{4} * film.width() * film.height();
    require(count == expected,
            fmt::format("the buffer holds {} floats, the pass has {}", count, expected));
    film.read_crypto(wanted, level, {buffer, count});
}

void read_pass(const Film& film, uint32_t pass, float* buffer, size_t count) {
    require(spc::is_pass(pass), fmt::format("unknown pass {}", pass));
    require(buffer != nullptr, "buffer is null");
    require(film.can_read(static_cast<Pass>(pass)), fmt::format("pass {} was not asked for", pass));
    const size_t expected =
        static_cast<size_t>(spc_pass_channels(pass)) * film.width() * film.height();
    require(count == expected,
            fmt::format("the buffer holds {} floats, the pass has {}", count, expected));
    film.read(static_cast<Pass>(pass), {buffer, count});
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
    *settings = {};
    settings->struct_size = sizeof(*settings);
    settings->method = SPC_METHOD_AUTO;
    exchange(Give{}, *settings, defaults);
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

spc_status spc_render_pause(spc_session* session, uint32_t paused) {
    return gate("spc_render_pause", [&] { session_of(session).pause(paused != 0); });
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
    thread_local std::string report;
    const spc_status status = gate("spc_render_report", [&] {
        report.clear();
        for (const std::string& line : session_of(session).report()) report += line + "\n";
    });
    return status == SPC_OK ? report.c_str() : nullptr;
}

uint32_t spc_pass_channels(uint32_t pass) {
    return spc::is_pass(pass) ? spc::pass_channels(static_cast<spc::Pass>(pass)) : 0;
}

const char* spc_passes(void) {
    static const std::string text = [] {
        std::string lines;
        for (uint32_t i = 0; i < SPC_PASS_COUNT; ++i) {
            const spc::PassDesc& pass = spc::describe(static_cast<spc::Pass>(i));
            lines += fmt::format("{} {}\n", pass.channels, pass.name);
        }
        return lines;
    }();
    return text.c_str();
}

spc_status spc_film_read(spc_session* session, uint32_t pass, float* buffer, size_t count) {
    return gate("spc_film_read",
                [&] { read_pass(session_of(session).film(), pass, buffer, count); });
}

spc_status spc_film_read_crypto(spc_session* session, uint32_t kind, uint32_t level, float* buffer,
                                size_t count) {
    return gate("spc_film_read_crypto",
                [&] { read_crypto(session_of(session).film(), kind, level, buffer, count); });
}

spc_status spc_sums_read_crypto(const void* sums, size_t size, uint32_t kind, uint32_t level,
                                float* buffer, size_t count) {
    return gate("spc_sums_read_crypto",
                [&] { read_crypto(*film_of(sums, size), kind, level, buffer, count); });
}

spc_status spc_film_export(spc_session* session, spc_sums* sums) {
    return gate("spc_film_export", [&] {
        spc::Session& s = session_of(session);
        checked(sums, "sums");
        spc::Session::Export all =
            spc::with_memory_for("the sums of the film", [&] { return s.export_film(); });
        const std::lock_guard lock(session->sums_mutex);
        std::vector<std::byte>& kept = session->sums[std::this_thread::get_id()];
        kept = std::move(all.sums);
        *sums = {sizeof(*sums), kept.data(), kept.size(), all.samples};
    });
}

spc_status spc_sums_add(void* sums, const void* other, size_t size, uint32_t earlier) {
    return gate("spc_sums_add", [&] {
        const auto film = film_of(sums, size);
        film->add(*film_of(other, size), earlier != 0);
        const std::vector<std::byte> bytes = film->to_bytes();
        require(bytes.size() == size, "the sums are those of another picture");
        std::ranges::copy(bytes, static_cast<std::byte*>(sums));
    });
}

spc_status spc_sums_extent(const void* sums, size_t size, uint32_t extent[2]) {
    return gate("spc_sums_extent", [&] {
        require(extent != nullptr, "extent is null");
        const auto film = film_of(sums, size);
        extent[0] = film->width();
        extent[1] = film->height();
    });
}

spc_status spc_sums_read(const void* sums, size_t size, uint32_t pass, float* buffer, size_t count) {
    return gate("spc_sums_read", [&] { read_pass(*film_of(sums, size), pass, buffer, count); });
}

void spc_session_destroy(spc_session* session) { delete session; }
