// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/session.h"

#include "core/error.h"

#include <bit>
#include <utility>

#include <pmmintrin.h>
#include <xmmintrin.h>

namespace spc {

namespace {

// Samples per round: one at first, so that a picture is there soon, then twice as many each time,
// so that a tile's data stays in cache, up to 2^kDoublings.
constexpr uint32_t kDoublings = 2, kLargestBatch = 1u << kDoublings;

// Light paths, estimates of camera chains and searches for them between two looks at the clock.
constexpr uint64_t kUntilClock = 64;

uint32_t count_rounds(uint32_t samples) {
    if (samples < kLargestBatch) return static_cast<uint32_t>(std::bit_width(samples));
    return kDoublings +
           samples / kLargestBatch;  // 2^kDoublings - 1 samples precede those of full size
}

IntegratorSettings without_searches(IntegratorSettings settings) {
    settings.manifold.enabled = false;
    settings.glints.method = GlintMethod::search;  // others wait for what they prepare
    return settings;
}

uint32_t worker_count(uint32_t asked) {
    return asked > 0 ? asked : std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace

void RenderStats::add(const RenderStats& other) {
    samples += other.samples;
    nan_samples += other.nan_samples;
    manifold_energy += other.manifold_energy;
    path.rays += other.path.rays;
    path.manifold.add(other.path.manifold);
    path.glints.add(other.path.glints);
    light.add(other.light);
    glint_bytes += other.glint_bytes;
    for (size_t i = 0; i < kRenderStages; ++i) stage_seconds[i] += other.stage_seconds[i];
    for (size_t i = 0; i < kEstimates; ++i) path.evidence[i].add(other.path.evidence[i]);
    path.seed_work += other.path.seed_work;
}

Session::Session(const RenderScene& world, const RenderSettings& settings, SheetStore* store)
    : world_(world),
      settings_(settings),
      path_tracing_(without_searches(settings.integrator)),
      pass_sources_(find_pass_sources(world, settings.custom)),
      filter_(settings.filter, settings.filter_width),
      film_(world.scene->camera.crop[2], world.scene->camera.crop[3], settings.passes,
            settings.for_denoiser ? SplatSpread::one_pixel : SplatSpread::all_pixels,
            settings.crypto, settings.noise_threshold > 0.0f),
      round_count_(count_rounds(settings.samples)),
      tile_rounds_(film_.tile_count()),
      tile_ended_(film_.tile_count()),
      evidence_(film_.tile_count()),
      sheet_store_(store),
      start_(Clock::now()) {
    settings_.integrator.manifold.cancelled = &cut_short_;
    settings_.integrator.tell_lobes = settings.passes.tell_lobes();
    settings_.integrator.pass_sources = &pass_sources_;
    settings_.threads = worker_count(settings.threads);
    const uint32_t count = active_workers_ = settings_.threads;
    try {
        for (uint32_t i = 0; i < count; ++i) workers_.emplace_back([this, i] { work(i); });
    } catch (...) {  // no more threads to be had: those that run must not run to the end
        cancel();
        throw;
    }
}

Session::~Session() { cancel(); }  // the workers join before anything that they use goes

void Session::cancel() {
    cancelled_ = true;
    cut_short_ = true;
}

void Session::pause(bool paused) {
    const std::lock_guard lock(mutex_);
    paused_ = paused;
    resumed_.notify_all();
}

uint32_t Session::round_begin(uint32_t round) const {
    const uint64_t begin = round <= kDoublings
                               ? (1u << round) - 1
                               : uint64_t{round - kDoublings} * kLargestBatch + kLargestBatch - 1;
    return static_cast<uint32_t>(std::min<uint64_t>(begin, settings_.samples));
}

double Session::seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

bool Session::must_stop() const {
    return cancelled_.load(std::memory_order_relaxed) || failed_.load(std::memory_order_relaxed);
}
bool Session::should_stop() const {
    return must_stop() || out_of_time_.load(std::memory_order_relaxed);
}
// However short the time, each pixel gets its first sample, unless that takes much longer: then it
// shows the preview, which is waited for. A sample that takes as long, of thousands of trials, is
// given up.
void Session::look_at_clock() {
    constexpr double kGrace = 0.5, kShare = 0.03;  // s, and of the limit
    const auto limit = static_cast<double>(settings_.time_limit);
    if (!(limit > 0.0)) return;
    const double now = seconds();
    if (now > limit) out_of_time_ = true;
    const bool shows_all = previewed_ || tiles_begun_ == film_.tile_count();
    if (now > limit * (1.0 + kShare) + kGrace && shows_all) cut_short_ = true;
}
bool Session::all_pixels_end() const {
    return splat_jobs_ == 0 && tiles_ended_ == film_.tile_count();
}
bool Session::stops_in(uint32_t round) const {
    if (all_pixels_end()) return true;
    return round > 0 ? should_stop() : must_stop() || cut_short_.load(std::memory_order_relaxed);
}

void TileEvidence::add(const RenderStats& stats) {
    samples += stats.samples;
    rays += stats.path.rays + stats.path.seed_work;
    for (size_t i = 0; i < kEstimates; ++i) manifold[i].add(stats.path.evidence[i]);
}

Activation activation_for(const TileEvidence& evidence, double variance, double least, double most) {
    // Least share of a tile's variance that is ascribed to everything but the manifold.
    constexpr double kLeastRest = 0.05;

    Activation probabilities = kAlways;
    const auto samples = static_cast<double>(evidence.samples);
    double by_manifold = 0.0;
    for (const ActivationEvidence& e : evidence.manifold) by_manifold += e.second_moment / samples;
    const double rest = std::max(variance - by_manifold, kLeastRest * variance);
    const double rest_cost = static_cast<double>(evidence.rays) / samples;
    if (!(rest > 0.0)) return probabilities;
    for (size_t i = 0; i < kEstimates; ++i) {
        const ActivationEvidence& e = evidence.manifold[i];
        if (e.cost == 0.0) continue;
        const double best = std::sqrt(e.second_moment / e.cost * rest_cost / rest);
        probabilities[i] = static_cast<float>(std::clamp(best, least, most));
    }
    return probabilities;
}

Activation activation_for(const TileEvidence& evidence, std::span<const PixelSums> pixels,
                          const Activation& before) {
    if (evidence.samples < kLeastSamples * pixels.size()) return before;
    const std::optional<double> variance = sample_variance(pixels);
    return variance ? activation_for(evidence, *variance, kLeastProbability, 1.0) : before;
}

void Session::work(uint32_t worker) {
    // Denormals cost hundreds of cycles each and carry no light; Embree asks for the same.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    const bool prepares = worker == 0;
    try {
        if (worker == settings_.threads - 1) render_preview();
        if (prepares) prepare();
    } catch (...) {
        fail();
    }
    if (prepares) prepared_.count_down();
    prepared_.wait();
    try {
        run_jobs();
    } catch (...) {
        fail();
    }
    const std::lock_guard lock(mutex_);
    if (--active_workers_ == 0) {
        end_stage();
        seconds_at_end_ = stage_begin_;
    }
    ended_.notify_all();
    job_done_.notify_all();
}

// With the lock.
double Session::stage_fraction() const {
    if (!budget_) return 0.0;
    return stage_part_begin_ + (1.0 - stage_part_begin_) * budget_->fraction();
}

// With the lock.
void Session::end_stage() {
    const double now = seconds();
    stats_.stage_seconds[static_cast<size_t>(stage_)] += now - stage_begin_;
    stage_begin_ = now;
}

// Keeps what is being thrown.
void Session::fail() {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    failed_ = true;
}

void Session::run_jobs() {
    const uint64_t per_round = splat_jobs_ + film_.tile_count(), jobs = per_round * round_count_;
    for (;;) {
        const uint64_t job = next_job_.fetch_add(1);
        if (job >= jobs || !may_begin(static_cast<uint32_t>(job / per_round))) break;
        RenderStats stats;
        const bool done = render_job(job, stats);
        const std::lock_guard lock(mutex_);
        stats_.add(stats);
        if (done) ++jobs_done_;
        job_done_.notify_all();
    }
}

// Waits while an export or a pause holds the round back.
bool Session::may_begin(uint32_t round) {
    std::unique_lock lock(mutex_);
    const auto is_held = [&] {
        return round >= most_rounds_ || (paused_ && round >= rounds_begun_);
    };
    while (is_held() && !stops_in(round)) {
        constexpr std::chrono::milliseconds kUntilLook(50);
        resumed_.wait_for(lock, kUntilLook);
    }
    if (stops_in(round)) return false;
    rounds_begun_ = std::max(rounds_begun_, round + 1);
    return true;
}

Session::Export Session::export_film() {
    const std::lock_guard one_at_a_time(export_mutex_);
    std::unique_lock lock(mutex_);
    const auto per_round = [this] { return uint64_t{splat_jobs_} + film_.tile_count(); };
    // Not before the preparation has said how many jobs there are.
    const auto has_begun = [this] { return rounds_begun_ > 0 || active_workers_ == 0; };
    job_done_.wait(lock, has_begun);
    most_rounds_ = rounds_begun_;
    job_done_.wait(
        lock, [&] { return jobs_done_ == most_rounds_ * per_round() || active_workers_ == 0; });
    const uint32_t rounds = std::exchange(most_rounds_, std::numeric_limits<uint32_t>::max());
    resumed_.notify_all();
    if (rounds == 0 || jobs_done_ != rounds * per_round())
        throw Error(ErrorKind::wrong_state, "the render ended within a sample");
    // Workers that go on wait for the lock before they change the film.
    return {film_.to_bytes(), round_begin(rounds)};
}

// Whether the whole job was done.
bool Session::render_job(uint64_t job, RenderStats& stats) {
    const uint32_t per_round = splat_jobs_ + film_.tile_count();
    const auto round = static_cast<uint32_t>(job / per_round);
    const auto part = static_cast<uint32_t>(job % per_round);
    return part < splat_jobs_ ? render_splats(round, part, stats)
                              : render_tile(round, part - splat_jobs_, stats);
}

bool Session::render_tile(uint32_t round, uint32_t tile, RenderStats& stats) {
    // Samples of a pixel are added in order: wait for whoever still works on this tile's previous
    // round.
    while (tile_rounds_[tile].load() != round) {
        if (stops_in(round)) return false;
        std::this_thread::yield();
    }
    Film::TileSums sums = film_.copy_tile(tile);
    const bool complete = render_pixels(tile, round, sums, stats);
    film_.store_tile(tile, sums);
    if (!complete) return false;
    evidence_[tile].add(stats);
    tile_rounds_[tile].store(round + 1);
    if (round == 0 && tiles_begun_.fetch_add(1) + 1 == film_.tile_count()) {
        const std::lock_guard lock(mutex_);
        stats_.first_sample_seconds = seconds();
    }
    return true;
}

// A part of the light paths, the estimates of camera chains and the searches for them of a round.
bool Session::render_splats(uint32_t round, uint32_t part, RenderStats& stats) {
    const auto& crop = world_.scene->camera.crop;
    const Vec2 corner(static_cast<float>(crop[0]), static_cast<float>(crop[1]));
    struct Part {
        std::vector<Splat> splats;
        uint64_t count = 0;
    };
    // Empty if there was no time for all.
    const auto estimate_part = [&](uint64_t per_sample, auto&& estimate) -> std::optional<Part> {
        const uint64_t begin = per_sample * part / splat_jobs_,
                       end = per_sample * (part + 1) / splat_jobs_;
        Part result;
        for (uint32_t sample = round_begin(round); sample < round_begin(round + 1); ++sample) {
            for (uint64_t i = begin; i < end; ++i) {
                if (i % kUntilClock == 0) look_at_clock();
                if (stops_in(round)) return std::nullopt;
                estimate({settings_.first_sample + sample, i}, result.splats);
            }
            result.count += end - begin;
        }
        stats.nan_samples += static_cast<uint64_t>(std::erase_if(
            result.splats, [](const Splat& splat) { return !can_be_held(splat.value); }));
        for (Splat& splat : result.splats) splat.film -= corner;
        return result;
    };
    const IntegratorSettings& integrator = settings_.integrator;
    const float margin = filter_.radius();
    auto light = estimate_part(light_paths_, [&](const SplatIndex& i, std::vector<Splat>& splats) {
        trace_light_path(world_, integrator, margin, settings_.seed, i, splats, stats.light);
    });
    auto camera_chains = estimate_part(camera_chain_estimates_, [&](const SplatIndex& i,
                                                                    std::vector<Splat>& splats) {
        estimate_camera_chains(world_, integrator, margin, settings_.seed, i, splats, stats.path);
    });
    auto missed =
        estimate_part(camera_chain_searches_, [&](const SplatIndex& i, std::vector<Splat>& splats) {
            search_camera_chains(world_, integrator, margin, settings_.seed, i, splats, stats.path);
        });
    if (!light || !camera_chains || !missed) return false;
    const auto add = [this](SplatSource source, const Part& of, uint64_t per_picture) {
        if (per_picture > 0)
            film_.add_splats(source, of.splats, filter_, of.count, static_cast<double>(per_picture));
    };
    splats_in_order_.call(
        uint64_t{round} * splat_jobs_ + part,
        [=, this, light = *std::move(light), camera_chains = *std::move(camera_chains),
         missed = *std::move(missed)] {
            add(SplatSource::light_paths, light, light_paths_);
            add(SplatSource::camera_chains, camera_chains, camera_chain_estimates_);
            add(SplatSource::missed_camera_chains, missed, camera_chain_searches_);
        });
    return true;
}

RenderProgress Session::wait(std::chrono::milliseconds patience) {
    look_at_clock();
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, patience, [this] { return active_workers_ == 0; });
    RenderProgress progress{};
    progress.state = RenderState::running;
    progress.seconds = active_workers_ == 0 ? seconds_at_end_ : seconds();
    progress.stage = stage_;
    progress.stage_fraction = static_cast<float>(stage_fraction());
    uint64_t tile_samples = 0;
    progress.samples_done = settings_.samples;
    for (const std::atomic<uint32_t>& rounds : tile_rounds_) {
        const uint32_t samples = round_begin(rounds.load());
        tile_samples += samples;
        progress.samples_done = std::min(progress.samples_done, samples);
    }
    const double by_samples =
        static_cast<double>(tile_samples) / film_.tile_count() / settings_.samples;
    const double by_time = settings_.time_limit > 0.0f
                               ? progress.seconds / static_cast<double>(settings_.time_limit)
                               : 0.0;
    progress.fraction = static_cast<float>(std::clamp(std::max(by_samples, by_time), 0.0, 1.0));
    // Samples alone tell how long they take; before them the limit is all that is known.
    const double limit = settings_.time_limit > 0.0f ? static_cast<double>(settings_.time_limit)
                                                     : std::numeric_limits<double>::infinity();
    double left = std::max(limit - progress.seconds, 0.0);
    if (by_samples > 0.0)
        left = std::min(left, (progress.seconds - stage_begin_) * (1.0 / by_samples - 1.0));
    progress.seconds_left = std::isfinite(left) ? left : -1.0;
    if (stage_ == RenderStage::samples) progress.stage_fraction = progress.fraction;
    if (active_workers_ > 0) return progress;
    const bool complete = progress.samples_done == settings_.samples;
    progress.state = failure_                  ? RenderState::failed
                     : cancelled_ && !complete ? RenderState::cancelled
                                               : RenderState::done;
    return progress;
}

RenderStats Session::stats() const {
    const uint64_t lost_rays = world_.scene->accel->lost_rays() - lost_rays_before_;
    const std::lock_guard lock(mutex_);
    RenderStats stats = stats_;
    stats.lost_rays = lost_rays;
    return stats;
}

std::vector<std::string> Session::report() const {
    const std::lock_guard lock(mutex_);
    return report_;
}

std::exception_ptr Session::failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
}

}  // namespace spc
