// SPDX-License-Identifier: GPL-3.0-or-later
// What a session learns and decides before its first round.
#include "render/session.h"

#include "core/parallel.h"
#include "manifold/crowding.h"

#include <fmt/format.h>

#include <numeric>

namespace spc {

namespace {

// Light paths, estimates of camera chains and searches for them in a job.
constexpr uint64_t kSplatJob = 1024;

// Least share of receivers with walks beside light paths, which bring what the walks do not find.
constexpr double kLeastWalks = 1.0 / 16;
// If fewer than 1 / kUnlessRare of the receivers have walks, their confidence falls faster than
// their number, since light paths are dense there. Otherwise walks keep a rare light path from
// making a bright pixel.
constexpr double kUnlessRare = 4.0;

// Sum of the squares of the shares that pixels have of one splat, on average.
double spread(const PixelFilter& filter, SplatSpread how) {
    constexpr int kSteps = 64;
    if (how == SplatSpread::one_pixel) return 1.0;
    const float step = filter.radius() / kSteps;
    double sum = 0.0;
    for (int i = -kSteps; i < kSteps; ++i) {
        const auto weight =
            static_cast<double>(filter.weight((static_cast<float>(i) + 0.5f) * step));
        sum += weight * weight * static_cast<double>(step);
    }
    return sum * sum;
}

// Work is counted in rays and iterations of Newton's method, and in parts of slope fields, of which
// so many are looked at in the time of a ray. To choose a light takes a few rays' time.
constexpr double kNodesOfRay = 8.0, kRaysOfGlint = 3.0;
// With what is done for each, a light path's ray takes the time of so many of other work.
constexpr double kWorkOfLightRay = 2.0;

// Most chains to one point by way of one caster. With more, sheets find each of them so rarely, and
// search so long for what they miss, that light paths and path tracing have less error in the same
// time.
constexpr double kMostChains = 64.0;

// Work of a probed pixel, if it is a lot of work; share of a limited time that probes may take.
constexpr double kWorkOfProbe = 0x1p14, kShareOfProbes = 0.08;

// Index of the preview's samples: no pixel takes as many.
constexpr uint32_t kPreviewSample = 0x7fffffff;

double glint_work(const GlintStats& stats) {
    return static_cast<double>(stats.nodes + stats.points) / kNodesOfRay +
           kRaysOfGlint * static_cast<double>(stats.estimates);
}

}  // namespace

const Budget& Session::begin(RenderStage stage, double work, double share) {
    // A stage's time without a time limit: longer than its work takes, so that the picture does not
    // depend on the machine.
    constexpr double kGuardOfPart = 1e9, kGuardOfOthers = 20.0;  // s
    const double kGuard = is_part() ? kGuardOfPart : kGuardOfOthers;
    const auto limit = static_cast<double>(settings_.time_limit);
    auto budget =
        std::make_shared<const Budget>(work, limit > 0.0 ? share * limit : kGuard, cut_short_);
    const std::lock_guard lock(mutex_);
    end_stage();
    stage_part_begin_ = stage == stage_ ? stage_fraction() : 0.0;
    budget_ = budget;
    stage_ = stage;
    return *budget;
}

// Shares of a limited time: what stages usually take is a third of that.
void Session::prepare() {
    constexpr double kMost = std::numeric_limits<double>::infinity();
    const Budget& maps = begin(RenderStage::maps, kMost, 1.0);
    prepare_flakes(maps);
    choose_casters(maps);
    prepare_sheets();
    learn_light_paths();
    find_camera_chains();
    weigh_noise();
    weigh_estimates();
    count_splats();
    begin(RenderStage::samples, kMost, 1.0);
}

void Session::render_preview() {
    constexpr double kMostSamples = 0x1p16;
    const auto& [x0, y0, width, height] = world_.scene->camera.crop;
    const double pixels = static_cast<double>(width) * static_cast<double>(height);
    const auto block =
        static_cast<uint32_t>(std::max(1.0, std::ceil(std::sqrt(pixels / kMostSamples))));
    const uint32_t across = (width + block - 1) / block, down = (height + block - 1) / block;
    std::vector<std::array<float, 4>> colors(static_cast<size_t>(across) * down);
    RenderStats stats;
    for (uint32_t i = 0; i < colors.size(); ++i) {
        // Where time is limited, some pixels may have nothing else in the end.
        if (must_stop() || (!(settings_.time_limit > 0.0f) && prepared_.try_wait())) return;
        const uint32_t x = std::min(i % across * block + block / 2, width - 1),
                       y = std::min(i / across * block + block / 2, height - 1);
        const FilmSample sample =
            take_sample(x0 + x, y0 + y, kPreviewSample, path_tracing_, {}, stats, nullptr);
        colors[i] = {sample.radiance.x, sample.radiance.y, sample.radiance.z, sample.alpha};
    }
    film_.set_preview(block, std::move(colors));
    previewed_ = true;
}

void Session::prepare_flakes(const Budget& budget) {
    GlintSettings& glints = settings_.integrator.glints;
    RenderStats stats;
    stats.glint_bytes = world_.glints.memory_bytes();
    if (glints.method == GlintMethod::yan) {
        for (const SlopeField& field : world_.glints.fields) {
            if (budget.is_cancelled()) return;
            const FlakeField& flakes = flakes_.emplace_back(field, settings_.threads, budget);
            stats.glint_bytes += flakes.memory_bytes();
        }
        glints.flakes = &flakes_;
    }
    const std::lock_guard lock(mutex_);
    stats_.add(stats);
}

// Chooses the casters that the manifold searches: not those that make too many chains at once.
void Session::choose_casters(const Budget& budget) {
    settings_.chooses =
        settings_.chooses && settings_.light_tracing && rays_find_all(*world_.scene, world_.lights);
    if (!settings_.chooses) return;
    exclude(chains_by_maps(*world_.scene, world_.lights, world_.casters, settings_.seed, budget),
            "by its map");
}

void Session::exclude(const std::vector<double>& chains, const char* what) {
    const CasterSet& all = settings_.integrator.casters_of(world_);
    std::vector<bool> crowded(chains.size());
    std::vector<std::string> lines;
    double most = 0.0;  // of those that are searched
    for (size_t i = 0; i < chains.size(); ++i) {
        crowded[i] = chains[i] > kMostChains;
        if (!crowded[i]) {
            most = std::max(most, chains[i]);
            continue;
        }
        lines.push_back(fmt::format(
            "{}: some {:.2g} chains at once {}, more than {:.0f}: left to light paths and path "
            "tracing",
            world_.scene->instances[all.casters[i].instance].name, chains[i], what, kMostChains));
    }
    if (most > 0.0)
        lines.push_back(
            fmt::format("Casters that are searched: up to {:.2g} chains at once {}", most, what));
    if (std::find(crowded.begin(), crowded.end(), true) != crowded.end()) {
        searched_ = without(all, crowded);
        settings_.integrator.searched = &searched_;
    }
    const std::lock_guard lock(mutex_);
    report_.insert(report_.end(), lines.begin(), lines.end());
}

void Session::prepare_sheets() {
    constexpr double kPixelsPerCell = 64.0, kSamplesPerCell = 4096.0, kSecondsPerCell = 0.04;
    constexpr double kLeastCells = 64.0, kMostCells = 2048.0;
    constexpr double kRaysPerCell = 0x1p14, kShare = 0.15;
    const ManifoldSettings& manifold = settings_.integrator.manifold;
    // So many emission cells that building the sheets is a small part of the work.
    const auto& crop = world_.scene->camera.crop;
    const auto pixels = static_cast<double>(uint64_t{crop[2]} * crop[3]);
    double emission_cells =
        std::min(pixels / kPixelsPerCell, pixels * planned_samples() / kSamplesPerCell);
    if (settings_.time_limit > 0.0f) {
        const double seconds = static_cast<double>(settings_.time_limit) * settings_.threads;
        emission_cells = std::min(emission_cells, seconds / kSecondsPerCell);
    }
    emission_cells = std::clamp(emission_cells, kLeastCells, kMostCells);
    const Budget& budget = begin(RenderStage::sheets, emission_cells * kRaysPerCell, kShare);
    if (manifold.finder != ChainFinder::sheets) return;
    RenderStats stats;
    const auto build = [&] {
        const CasterSet& casters = settings_.integrator.casters_of(world_);
        SheetStore::Key key{
            settings_.seed, static_cast<uint32_t>(emission_cells), manifold.longest_chain, {}};
        for (const Caster& caster : casters.casters) key.casters.push_back(caster.instance);
        if (sheet_store_ != nullptr) sheet_pool_ = sheet_store_->find(key);
        if (sheet_pool_) return;
        sheet_pool_ = std::make_shared<const SheetPool>(
            build_sheets(*world_.scene, world_.lights, casters, manifold, settings_.seed,
                         key.emission_cells, settings_.threads, budget));
        for (const auto& sheet : *sheet_pool_) stats.path.manifold.rays += sheet->rays();
        if (sheet_store_ != nullptr && !budget.must_end())
            sheet_store_->put(std::move(key), sheet_pool_);
    };
    build();
    if (settings_.chooses) {
        const CasterSet* before = settings_.integrator.searched;
        exclude(chains_by_sheets(settings_.integrator.casters_of(world_), *sheet_pool_,
                                 settings_.seed, budget),
                "by light sheets");
        if (settings_.integrator.searched != before) {
            sheet_pool_.reset();
            build();
        }
    }
    sheets_.all = *sheet_pool_;
    const std::lock_guard lock(mutex_);
    stats_.add(stats);
}

void Session::learn_light_paths() {
    constexpr double kSamplesOfPath = 16.0, kSecondsOfPath = 1.25e-4, kMostPaths = 0x1p19;
    constexpr double kRaysOfPath = 64.0, kShare = 0.15;
    // As many as are a small part of the work.
    const auto& crop = world_.scene->camera.crop;
    const auto pixels = static_cast<double>(uint64_t{crop[2]} * crop[3]);
    double paths = pixels * planned_samples() / kSamplesOfPath;
    if (settings_.time_limit > 0.0f)
        paths = std::min(
            paths, static_cast<double>(settings_.time_limit) * settings_.threads / kSecondsOfPath);
    paths = std::clamp(paths, double{kLeastPilotPaths}, kMostPaths);
    const Budget& budget = begin(RenderStage::light_paths, paths * kRaysOfPath, kShare);
    if (!settings_.light_tracing) return;
    RenderStats stats;
    light_pilot_ = learn_emission(world_, settings_.integrator, sheets_, filter_.radius(),
                                  static_cast<uint32_t>(paths), settings_.seed, settings_.threads,
                                  budget, stats.light);
    if (light_pilot_)
        settings_.integrator.light_tracing = {.guide = &light_pilot_->guide,
                                              .paths = pixels,
                                              .goes_on = light_pilot_->goes_on,
                                              .mean_search_trials = light_pilot_->mean_search_trials,
                                              .manifold_share = light_pilot_->manifold_share,
                                              .beside_glints = light_pilot_->beside_glints};
    const std::lock_guard lock(mutex_);
    stats_.add(stats);
}

// Beside sheets or light paths: walks alone are as others have them.
void Session::find_camera_chains() {
    constexpr double kSamplesOfWalk = 8.0, kSecondsOfWalk = 5e-5, kLeastWalks = 1024.0,
                     kMostWalks = 0x1p21;
    constexpr double kWorkOfWalk = 256.0, kShare = 0.05;
    // As many as are a small part of the work.
    const auto& crop = world_.scene->camera.crop;
    const auto pixels = static_cast<double>(uint64_t{crop[2]} * crop[3]);
    double walks = std::min(kMostWalks, pixels * planned_samples() / kSamplesOfWalk);
    if (settings_.time_limit > 0.0f)
        walks = std::min(
            walks, static_cast<double>(settings_.time_limit) * settings_.threads / kSecondsOfWalk);
    walks = std::max(walks, kLeastWalks);
    const Budget& budget = begin(RenderStage::camera_chains, walks * kWorkOfWalk, kShare);
    const bool walks_alone = sheets_.all.empty() && !settings_.light_tracing;
    if (!settings_.integrator.manifold.enabled || walks_alone) return;
    RenderStats stats;
    camera_chains_ = learn_camera_chains(world_, settings_.integrator, static_cast<uint32_t>(walks),
                                         settings_.seed, settings_.threads, budget, stats.path);
    settings_.integrator.camera_chains = camera_chains_.get();
    const std::lock_guard lock(mutex_);
    stats_.add(stats);
}

// A chain that adds v, looked for with the probability v / s, adds s v to the variance and v / s
// shots to the cost. With a, the sum of all v of a sample, variance V + s a and cost C + c a / s
// have the least product where s = sqrt(V c / C).
void Session::weigh_noise() {
    // Few: until the chains are weighed, all of them are looked for.
    constexpr uint32_t kPixels = 512, kRare = 128;
    constexpr double kShotOverSample = 0.5;
    const Budget& budget = begin(RenderStage::probes, kPixels * kWorkOfProbe, kShareOfProbes);
    if (sheets_.all.empty() && world_.glints.fields.empty()) return;
    const Probe one = probe(kPixels, kRare, budget);
    variance_ = one.variance;
    if (one.glint_work > 0.0) work_by_glint_ = one.work / one.glint_work;
    sheets_.sure = static_cast<float>(std::sqrt(kShotOverSample * variance_));
}

void Session::weigh_estimates() {
    constexpr uint32_t kPixels = 2048, kRare = 128;
    const ManifoldSettings& manifold = settings_.integrator.manifold;
    const bool may_draw =
        manifold.enabled && !(world_.casters.empty() && world_.rough_chain_casters.empty());
    if (!light_pilot_ && !may_draw) return;
    LightTracing& paths = settings_.integrator.light_tracing;
    const bool walks_share = light_pilot_ && manifold.finder == ChainFinder::walks;
    if (walks_share) paths.walks = paths.walk_confidence = kLeastWalks;
    const Budget& budget = begin(RenderStage::probes, kPixels * kWorkOfProbe, kShareOfProbes);
    const Probe camera = probe(kPixels, kRare, budget);
    first_probabilities_ = activation_for(camera.evidence, camera.variance, kLeastProbability, 1.0);
    if (light_pilot_) weigh_light_paths(camera);
    if (walks_share) {
        paths.walks = walks_that_pay(camera);
        paths.walk_confidence = paths.walks * std::min(1.0, kUnlessRare * paths.walks);
    }
}

// How many there are, and whether the manifold searches where they come. Samples without those
// searches are taken in the same pixels, so that the comparison has little noise.
void Session::weigh_light_paths(const Probe& camera) {
    constexpr uint32_t kPixels = 2048, kRare = 128;
    constexpr double kGain = 0.9;  // of variance times work: less of a gain may be noise
    const LightPilot& pilot = *light_pilot_;
    const LightPathPlan with =
        light_paths_that_pay(pilot, with_probabilities(camera, kAlways, first_probabilities_));
    light_paths_ = with.paths;
    // Where light paths come rarely they are bright pixels, which a few samples do not tell.
    const bool dense = pilot.come_through >= kFewComeThrough;
    if (!settings_.chooses || !dense || settings_.integrator.casters_of(world_).empty()) return;
    bool& alone = settings_.integrator.light_tracing.alone;
    alone = true;
    const Budget& budget = begin(RenderStage::probes, kPixels * kWorkOfProbe, kShareOfProbes);
    const Probe without_searches = probe(kPixels, kRare, budget);
    const Activation probabilities = activation_for(
        without_searches.evidence, without_searches.variance, kLeastProbability, 1.0);
    const LightPathPlan without =
        light_paths_that_pay(pilot, with_probabilities(without_searches, kAlways, probabilities));
    const double ratio = std::exp(without.error - with.error);
    alone = ratio < kGain;
    if (alone) {
        light_paths_ = without.paths;
        first_probabilities_ = probabilities;
    }
    const std::lock_guard lock(mutex_);
    report_.push_back(
        fmt::format("Receivers that the camera sees as light paths do: without searches {:.2g} of "
                    "their variance "
                    "times work, {:.2g} of the pilot's paths come to them: {}",
                    ratio, pilot.come_through, alone ? "left to light paths" : "searched"));
}

// Where light paths come that is all receivers which the camera sees directly, and few others. The
// fewer have walks, the more the weights leave to light paths: too many cost time, too few make
// bright pixels where light paths come rarely, which is worse.
double Session::walks_that_pay(const Probe& least_walks) {
    constexpr double kMore = 4.0;  // than variance and cost ask for
    const double best =
        static_cast<double>(activation_for(least_walks.evidence, least_walks.variance, 0.0,
                                           static_cast<double>(kInfinity))[receiver_depth(0)]);
    return std::clamp(kMore * best * kLeastWalks, kLeastWalks, 1.0);
}

void Session::count_splats() {
    if (camera_chains_) {
        camera_chain_estimates_ = static_cast<uint64_t>(camera_chains_->estimates);
        camera_chain_searches_ =
            camera_chain_searches(world_.scene->camera, *camera_chains_, filter_.radius());
    }
    const uint64_t splats = light_paths_ + camera_chain_estimates_ + camera_chain_searches_;
    if (splats == 0) return;
    splat_jobs_ =
        static_cast<uint32_t>(std::clamp<uint64_t>(splats / kSplatJob, 1, film_.tile_count()));
    settings_.integrator.light_tracing.paths = static_cast<double>(light_paths_);
}

Session::Probe Session::probe(uint32_t most, uint32_t rare, const Budget& budget) {
    constexpr uint32_t kFewest = 256, kRound = 64;

    const auto& [x0, y0, width, height] = world_.scene->camera.crop;
    const uint64_t pixels = uint64_t{width} * height;
    // Every receiver has walks, whose confidence is known the better, but they count as rarely as
    // they come.
    RoundState always;
    always.sheets = sheets_;
    always.activation[receiver_depth(0)] /=
        static_cast<float>(settings_.integrator.light_tracing.walks);
    const auto wanted = static_cast<uint32_t>(std::clamp<uint64_t>(pixels / 16, kFewest, most));
    // Spread over the picture however early the probe ends: a step prime to their number.
    uint32_t step = static_cast<uint32_t>(0.618 * wanted) | 1u;
    while (std::gcd(step, wanted) > 1) step += 2;
    const auto pixel_of = [&](uint32_t i) {
        return static_cast<uint32_t>(pixels * (uint64_t{i} * step % wanted) / wanted);
    };
    std::vector<double> squares;  // of differences, mean of the channels
    std::vector<uint32_t> probed;
    RenderStats all;
    for (uint32_t begin = 0; begin < wanted; begin += kRound) {
        const uint32_t size = std::min(kRound, wanted - begin);
        std::vector<RenderStats> stats(size);
        std::vector<double> found(size, -1.0);
        parallel_for(settings_.threads, size, [&](uint32_t k) {
            if (budget.must_end()) return;
            const uint32_t i = begin + k, pixel = pixel_of(i);
            const auto take = [&](uint32_t index) {
                return take_sample(x0 + pixel % width, y0 + pixel / width, index,
                                   settings_.integrator, always, stats[k], nullptr)
                    .radiance;
            };
            const Spectrum difference = take(~i) - take(~i ^ (1u << 30));
            found[k] = static_cast<double>(dot(difference, difference) * (1.0f / 3.0f));
        });
        for (uint32_t k = 0; k < size; ++k) {
            if (found[k] < 0.0) continue;
            squares.push_back(found[k]);
            probed.push_back(pixel_of(begin + k));
            all.add(stats[k]);
        }
        if (budget.is_spent(all.path.rays + all.path.manifold.work())) break;
    }
    const auto count = static_cast<uint32_t>(squares.size());
    if (count == 0) return Probe{};
    CoarsePicture sums(world_.scene->camera.crop), counts = sums;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t pixel = probed[i];
        const Vec2 film(static_cast<float>(x0 + pixel % width) + 0.5f,
                        static_cast<float>(y0 + pixel / width) + 0.5f);
        sums.add(film, 0.5 * squares[i]);
        counts.add(film, 1.0);
    }
    std::sort(squares.begin(), squares.end());
    squares.resize(squares.size() - (squares.size() + rare - 1) / rare);
    {
        const std::lock_guard lock(mutex_);
        stats_.path.manifold.add(all.path.manifold);
    }
    const double samples = 2.0 * static_cast<double>(count);
    Probe probe{
        std::accumulate(squares.begin(), squares.end(), 0.0) / samples,
        (static_cast<double>(all.path.rays + all.path.manifold.rays + all.path.manifold.iterations) +
         glint_work(all.path.glints)) /
            samples,
        all.path.glints.estimates > 0
            ? glint_work(all.path.glints) / static_cast<double>(all.path.glints.estimates)
            : 0.0,
        {},
        {}};
    probe.evidence.add(all);
    for (size_t i = 0; i < CoarsePicture::kCells; ++i)
        if (counts[i] > 0.0) probe.variances[i] = sums[i] / counts[i];
    return with_probabilities(probe, always.activation, kAlways);
}

// The probe as it would be if manifold estimates had the probabilities `to` instead of `from`.
Session::Probe Session::with_probabilities(const Probe& whole, const Activation& from,
                                           const Activation& to) {
    Probe result = whole;
    const auto samples = static_cast<double>(whole.evidence.samples);
    for (size_t i = 0; i < kEstimates; ++i) {
        const auto before = static_cast<double>(from[i]), after = static_cast<double>(to[i]);
        const ActivationEvidence& e = whole.evidence.manifold[i];
        result.variance += e.second_moment / samples * (1.0 / after - 1.0 / before);
        result.work -= e.cost / samples * (before - after);
    }
    if (whole.variance > 0.0)
        for (double& variance : result.variances) variance *= result.variance / whole.variance;
    return result;
}

// For each sample of the picture: so many that in the same time the variances of the picture's
// parts have the least geometric mean. N light paths and P camera paths cost N C + P C', and have
// the variance V / N + V' / P in a part. (The least sum would be decided by the noisiest part
// alone, and leave to others what a few more light paths take away.) Work is counted, not timed, so
// that the same render comes out everywhere.
Session::LightPathPlan Session::light_paths_that_pay(const LightPilot& pilot,
                                                     const Probe& camera) const {
    constexpr double kLeast = 1.0 / 64, kMost = 8.0, kStep = 1.125;  // for each pixel
    const auto& crop = world_.scene->camera.crop;
    const auto pixels = static_cast<double>(uint64_t{crop[2]} * crop[3]);
    // Variance of a pixel if there is one light path for each pixel, per unit of pilot.squares.
    const double of_light =
        spread(filter_, film_.spread()) * CoarsePicture::kCells / (pixels * pixels);
    const double work = kWorkOfLightRay * pilot.rays;
    const auto error = [&](double paths) {  // logarithm of that mean
        double sum = 0.0;
        for (size_t i = 0; i < CoarsePicture::kCells; ++i) {
            const double variance = camera.variances[i] + pilot.squares[i] * of_light / paths;
            if (variance > 0.0) sum += std::log(variance * (camera.work + paths * work));
        }
        return sum;
    };
    double best = kLeast;
    for (double paths = kLeast; paths <= kMost; paths *= kStep)
        if (error(paths) < error(best)) best = paths;
    return {static_cast<uint64_t>(std::ceil(pixels * best)), error(best) / CoarsePicture::kCells};
}

}  // namespace spc
