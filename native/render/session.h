// SPDX-License-Identifier: GPL-3.0-or-later
// A render under way. Worker threads take jobs, each a tile or a part of the splats in one round of
// samples, until all samples are done, the time is up, or the render is cancelled.
#pragma once

#include "core/budget.h"
#include "core/parallel.h"
#include "film/film.h"
#include "film/filter.h"
#include "integrator/camera_chains.h"
#include "integrator/light_path.h"
#include "render/sheet_store.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <latch>
#include <thread>

namespace spc {

// How much of the pass of that name a surface has at a distance from the camera.
struct Mist {
    float start = 5.0f, depth = 25.0f;  // m; the mist is full where both end
    float exponent = 2.0f;
    float at(float distance) const {
        const float u = depth > 0.0f ? (distance - start) / depth : distance > start ? 1.0f : 0.0f;
        return std::pow(clamp01(u), exponent);
    }
};

struct RenderSettings {
    // The session itself sets `light_tracing`, `camera_chains` and the flakes of glints.
    IntegratorSettings integrator;
    bool light_tracing = false;  // trace light paths if a light reaches a caster
    // Whether the session leaves to light paths and path tracing what they find at less cost:
    // casters that make too many chains at once, and receivers at which light paths are dense.
    bool chooses = false;
    uint32_t first_sample = 0, samples = 64;
    // Of the render that this one is a part of; 0: it is no part. Samples of a part learn nothing
    // from those before them, so that parts add up to the same picture however its samples are
    // divided.
    uint32_t total_samples = 0;
    float time_limit = 0.0f;  // s, 0 = none
    uint32_t seed = 0;
    uint32_t threads = 0;  // 0 = all
    FilterKind filter = FilterKind::blackman_harris;
    float filter_width = 1.5f;
    PassSet passes;
    CustomNames custom;  // of the custom ones among them
    Mist mist;
    CryptoRequest crypto;
    // Pixels whose error is below the threshold take no more samples; 0: all take all. Not in
    // parts.
    float noise_threshold = 0.0f;
    uint32_t min_samples = 0;   // before that is asked; 0: by the threshold
    bool for_denoiser = false;  // errors of neighbouring pixels are independent
};

// What a render does, in this order. Each stage of the preparation has a share of the render's
// time, and ends early when that is over.
enum class RenderStage : uint8_t { maps, sheets, light_paths, camera_chains, probes, samples };
inline constexpr size_t kRenderStages = 6;

struct RenderStats {
    uint64_t samples = 0;
    uint64_t nan_samples = 0;
    uint64_t lost_rays = 0;  // since the session began, by all users of its scene
    double manifold_energy = 0.0;
    PathStats path;
    LightPathStats light;
    uint64_t glint_bytes = 0;  // memory of slope fields and flakes
    std::array<double, kRenderStages> stage_seconds{};
    double first_sample_seconds = 0.0;  // time until every pixel had a sample; 0: not yet
    void add(const RenderStats& other);
};

enum class RenderState : uint8_t { running, done, cancelled, failed };

struct RenderProgress {
    RenderState state;
    uint32_t samples_done;
    float fraction;
    double seconds;
    RenderStage stage;
    float stage_fraction;
    double seconds_left;  // negative: not known yet
};

// What a tile's samples so far tell about its manifold estimates.
struct TileEvidence {
    uint64_t samples = 0;
    uint64_t rays = 0;  // rays of path tracing, plus the work of chain seeds
    std::array<ActivationEvidence, kEstimates> manifold;
    void add(const RenderStats& stats);
};
// Of a pixel: fewer tell nothing yet of its noise.
inline constexpr uint32_t kLeastSamples = 3;
// Least probability of an estimate. A tile learns late of chains that are found once in a while,
// and with a small probability they come as single bright samples.
inline constexpr double kLeastProbability = 1.0 / 4;
// The probabilities of manifold estimates, between `least` and `most`, for which variance times
// cost of the tile is least; efficiency-optimised Russian roulette [Rath22]. `variance` is that of
// one sample. The second form takes it from the tile's pixels, and returns `before` until they have
// samples enough.
Activation activation_for(const TileEvidence& evidence, double variance, double least, double most);
Activation activation_for(const TileEvidence& evidence, std::span<const PixelSums> pixels,
                          const Activation& before);

class Session {
public:
    // Starts the workers. `world` must outlive the session, and so must `store`, of sheets of that
    // world, if it is not null.
    Session(const RenderScene& world, const RenderSettings& settings, SheetStore* store = nullptr);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    void cancel();
    // Holds back rounds of samples that have not begun, or lets them begin.
    void pause(bool paused);
    // Returns when the render has ended or the time is over.
    RenderProgress wait(std::chrono::milliseconds patience);
    RenderStats stats() const;
    const Film& film() const { return film_; }
    // Waits until every pixel has the same samples, and gives their sums and how many they are. The
    // render stands still meanwhile, for less than a round. Throws Error if it has ended before
    // that.
    struct Export {
        std::vector<std::byte> sums;
        uint32_t samples;
    };
    Export export_film();
    // One line for each caster about which the render has decided. Complete once samples are taken.
    std::vector<std::string> report() const;
    // The exception that made the render fail, or null.
    std::exception_ptr failure() const;

private:
    using Clock = std::chrono::steady_clock;
    void work(uint32_t worker);
    void run_jobs();
    bool may_begin(uint32_t round);
    void fail();
    // Renders a coarse picture by path tracing alone, which is shown until there are samples.
    void render_preview();
    // The preparation before the first round, in this order (session_plan.cpp).
    void prepare();
    // Begins a stage. Its budget is `work` and, if time is limited, `share` of it.
    const Budget& begin(RenderStage stage, double work, double share);
    void end_stage();
    // Of the stage that is under way, [0, 1]: never less than before.
    double stage_fraction() const;
    void prepare_flakes(const Budget& budget);
    void choose_casters(const Budget& budget);
    void prepare_sheets();
    void exclude(const std::vector<double>& chains, const char* what);
    void learn_light_paths();
    void find_camera_chains();
    void weigh_noise();
    void weigh_estimates();
    void count_splats();
    // Variance (mean of the channels) and counted work of one sample of the picture, measured by
    // two samples in each of at most `most` pixels. Of every `rare` pixels the brightest is left
    // out, so that a single bright sample does not decide; `variances`, of the parts of the
    // picture, include it and are 0 where no pixel was measured. The manifold's work is added to
    // the session's statistics.
    struct Probe {
        double variance, work;
        double glint_work;  // work of one estimate of glints; 0 if there was none
        TileEvidence evidence;
        std::array<double, CoarsePicture::kCells> variances;
    };
    Probe probe(uint32_t most, uint32_t rare, const Budget& budget);
    static Probe with_probabilities(const Probe& whole, const Activation& from,
                                    const Activation& to);
    struct LightPathPlan {
        uint64_t paths;  // light paths for each sample of the picture
        double error;    // sum of log(variance * work) over the parts of the picture
    };
    LightPathPlan light_paths_that_pay(const LightPilot& pilot, const Probe& camera) const;
    void weigh_light_paths(const Probe& camera);
    static double walks_that_pay(const Probe& least_walks);
    bool render_job(uint64_t job, RenderStats& stats);
    bool render_tile(uint32_t round, uint32_t tile, RenderStats& stats);
    bool render_splats(uint32_t round, uint32_t part, RenderStats& stats);
    bool render_pixels(uint32_t tile, uint32_t round, Film::TileSums& sums, RenderStats& stats);
    GlintSampling glint_sampling(const PixelSums& pixel, double variance_of_tile) const;
    // `values` may be null.
    FilmSample take_sample(uint32_t x, uint32_t y, uint32_t index,
                           const IntegratorSettings& integrator, const RoundState& state,
                           RenderStats& stats, PassValues* values) const;
    void tell_passes(const PathSample& path, const ManifoldStats& before,
                     const ManifoldStats& after, PassValues& values) const;
    bool is_adaptive() const { return settings_.noise_threshold > 0.0f && !is_part(); }
    std::vector<bool> pixels_that_end(const Film::TileBounds& bounds,
                                      const Film::TileSums& sums) const;
    bool is_part() const { return settings_.total_samples > 0; }
    // What the preparation is for, the same for all parts of a render.
    uint32_t planned_samples() const {
        return is_part() ? settings_.total_samples : settings_.samples;
    }
    uint32_t round_begin(
        uint32_t round) const;  // relative sample index; of round_count_ the number of samples
    bool must_stop() const;     // whatever has been done
    bool should_stop() const;   // that, or time is up
    bool stops_in(uint32_t round) const;
    // Whether no pixel wants more samples, and no light paths are left to trace.
    bool all_pixels_end() const;
    void look_at_clock();
    double seconds() const;

    const RenderScene& world_;
    const uint64_t lost_rays_before_ = world_.scene->accel->lost_rays();
    RenderSettings settings_;                // constant once prepared_
    const IntegratorSettings path_tracing_;  // for the preview
    const PassSources pass_sources_;
    const PixelFilter filter_;
    Film film_;
    const uint32_t round_count_;
    std::vector<std::atomic<uint32_t>> tile_rounds_;  // rounds completed, by tile
    std::atomic<uint32_t> tiles_begun_{0};            // tiles that have completed a round
    // Tiles of which adaptive sampling wants no more; each is set by whoever has the tile.
    std::vector<uint8_t> tile_ended_;
    std::atomic<uint32_t> tiles_ended_{0};
    std::vector<TileEvidence> evidence_;        // by tile, from its completed rounds
    Activation first_probabilities_ = kAlways;  // for tiles whose samples tell nothing yet
    // Jobs of a round beside its tiles. Their splats are added to the film in the order of the
    // jobs.
    uint32_t splat_jobs_ = 0;
    uint64_t light_paths_ = 0, camera_chain_estimates_ = 0,
             camera_chain_searches_ = 0;  // for each sample of the picture
    InOrder splats_in_order_;
    CasterSet searched_;  // used if some casters are left to other techniques
    std::unique_ptr<const LightPilot> light_pilot_;
    std::unique_ptr<const CameraChains> camera_chains_;
    SheetStore* const sheet_store_;
    std::shared_ptr<const SheetPool> sheet_pool_;
    LightSheets sheets_;  // refers to the pool
    // Mean variance of a sample over the picture, and the ratio of its work to that of an estimate
    // of glints. Measured only if a decision needs them.
    double variance_ = 0.0, work_by_glint_ = 0.0;
    FlakeSet flakes_;
    std::latch prepared_{1};
    std::atomic<uint64_t> next_job_{0};
    // `cut_short_`: what is under way need not be finished.
    std::atomic<bool> cancelled_{false}, out_of_time_{false}, cut_short_{false}, failed_{false};
    std::atomic<bool> previewed_{false};
    const Clock::time_point start_;

    std::mutex export_mutex_;   // of whoever has the render stand still; taken before the next
    mutable std::mutex mutex_;  // guards the rest
    std::condition_variable ended_;
    // Rounds that have begun, and those that may; jobs that are done.
    uint32_t rounds_begun_ = 0, most_rounds_ = std::numeric_limits<uint32_t>::max();
    uint64_t jobs_done_ = 0;
    bool paused_ = false;
    std::condition_variable resumed_, job_done_;
    uint32_t active_workers_ = 0;
    double seconds_at_end_ = 0.0;
    RenderStats stats_;
    std::exception_ptr failure_;
    RenderStage stage_ = RenderStage::maps;
    std::shared_ptr<const Budget> budget_;  // of the stage, or of a part of it
    double stage_part_begin_ = 0.0;         // stage_fraction() when that part began
    double stage_begin_ = 0.0;              // s
    std::vector<std::string> report_;

    std::vector<std::jthread> workers_;  // last: they use all of the above
};

}  // namespace spc
