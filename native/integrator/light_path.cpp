// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/light_path.h"

#include "core/parallel.h"
#include "integrator/path_tracer.h"
#include "manifold/found_chains.h"

namespace spc {

namespace {

// Light of light paths whose chains the manifold looks for, and the same times the trials that a
// search takes to find the chain: for LightTracing::mean_search_trials.
struct SearchTrials {
    double light = 0.0, trials = 0.0;
    ManifoldStats searches{};  // of the render's they are no part

    void add(const SearchTrials& other) {
        light += other.light;
        trials += other.trials;
        searches.add(other.searches);
    }
};

// One light path under way.
class LightTracer {
public:
    LightTracer(const RenderScene& world, const IntegratorSettings& settings, float margin,
                const Sampler& sampler, std::vector<Splat>& splats, LightPathStats& stats)
        : world_(world),
          scene_(*world.scene),
          settings_(settings),
          margin_(margin),
          sampler_(sampler),
          splats_(splats),
          stats_(stats) {}

    // Beside what it adds to the picture the path tells how well sheets lead to its chain.
    void ask(const LightSheets& sheets, SearchTrials& search_trials) {
        sheets_ = &sheets;
        search_trials_ = &search_trials;
    }

    // Where in its light's square the path begins; empty if nothing left the light.
    std::optional<EmissionSample> trace() {
        ++stats_.paths;
        const std::optional<LightPoint> y =
            sample_light_point(world_.lights, scene_, sampler_[Domain::light_point].three());
        // What shines through things is left to those who connect to it.
        if (!y || !sends_light_paths(world_.lights, y->light)) return std::nullopt;
        y_ = *y;
        visibility_ = light_visibility(world_.lights, y_.light);
        const EmittedRay emitted =
            emit(*settings_.light_tracing.guide, y_, sampler_[Domain::light_direction].two());
        away_ = emitted.direction;
        end_ = light_end(y_, away_);
        end_.pdf_emitted = emitted.pdf;
        if (!shines_by_length(world_.lights, scene_, y_)) {
            radiance_ = radiance_at(world_.lights, scene_, y_, away_, 0.0f);
            if (is_black(radiance_)) return std::nullopt;
        }
        ray_ = {offset_from_light(scene_, y_, emitted.origin, away_), away_, 0.0f, kInfinity};
        media_ = media_at(scene_, ray_.origin, stats_.rays);
        if (y_.distant) passed_ = media_.transmittance(kInfinity);
        while (advance()) {}
        if (is_thinned()) stats_.rays_behind += stats_.rays - rays_before_;
        return EmissionSample{y_.light, {emitted.place, 0.0f}};
    }

private:
    // To the next surface, and beyond. Whether the path goes on.
    bool advance() {
        ++stats_.rays;
        const std::optional<Hit> hit =
            scene_.accel->intersect(ray_, kVisibleScattered | kVisibleCamera);
        if (!hit) return false;
        passed_ *= media_.transmittance(hit->t - ray_.t_near);
        ray_.t_near = past(hit->t);
        if (hit->light != kNone) return true;  // lamps are looked through
        const Instance& instance = scene_.instances[hit->surface.instance];
        const bool may_end = history_.has_scattered() || (history_.count > 0 && instance.receiver);
        if (may_end && (instance.visibility & kVisibleCamera) != 0) connect(hit->surface);
        if ((instance.visibility & kVisibleScattered) == 0)
            return true;  // nothing but the camera sees it
        const bool may_throw_on = history_.chain_length() == 0 && instance.rough_caster;
        const bool may_scatter =
            (may_end || may_throw_on) && !ends_at_receiver() &&
            history_.path.camera_subpath.scatterings < most_scatterings(settings_.limits);
        if (!may_scatter && !instance.caster && !scene_.any_transparency) return false;

        Surface surface;
        evaluate_surface(scene_, hit->surface, ray_.direction * -1.0f, surface);
        const Sampler here = sampler_.vertex(segment_++);
        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo, here[Domain::closure].three());
        if (!next || next->below != nullptr) return false;  // left to path tracing
        if (dot(surface.ng, next->wi) < 0.0f) media_.cross(scene_, surface.hit, next->wi);
        if (next->kind == BounceKind::transparent) return look_through(instance, *next);
        if (history_.count == 0 && !history_.has_scattered() &&
            !(shines_on(world_.lights, y_.light, instance.sets.receives) && reaches(surface.p)))
            return false;
        const bool goes_on =
            next->delta ? turn(surface, *next) : may_scatter && scatter(surface, *next, here);
        ray_ = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi, 0.0f,
                kInfinity};
        return goes_on;
    }

    // Whether light of y comes to the first surface, from where it begins.
    bool reaches(const Vec3& p) {
        if (y_.distant) return true;
        if (!shows_itself(world_.lights, y_, p)) return false;
        const Vec3 begin = light_begins(world_.lights, y_, p);
        if (shines_by_length(world_.lights, scene_, y_)) {
            radiance_ = radiance_at(world_.lights, scene_, y_, away_, length(p - begin));
            if (is_black(radiance_)) return false;
        }
        if (begin == y_.p || transparent_ > settings_.limits.transparent) return begin == y_.p;
        uint32_t transparent_left = settings_.limits.transparent - transparent_;
        Media media = media_at(scene_, y_.p, stats_.rays);
        passed_ *= transmittance(scene_, {y_.p, y_.n, 0.0f}, {false, begin, Vec3(0.0f)},
                                 kVisibleScattered, transparent_left, media, stats_.rays);
        return !is_black(passed_);
    }

    bool look_through(const Instance& instance, const ClosureSample& next) {
        passed_ *= next.weight;
        history_.append_transparent(instance);
        return ++transparent_ <= settings_.limits.transparent;
    }

    bool turn(const Surface& surface, const ClosureSample& next) {
        const uint32_t kind = next.refracted ? kVisibleTransmission : kVisibleGlossy;
        if (!history_.has_scattered() && history_.count == 0 && (visibility_ & kind) == 0)
            return false;
        return history_.append_delta(surface, next, world_.casters);
    }

    bool scatter(const Surface& surface, const ClosureSample& next, const Sampler& here) {
        const bool first = !history_.has_scattered();
        if (first) rays_before_ = stats_.rays;
        throughput_ *= next.weight;
        const float q = std::min(1.0f, max_component(throughput_));
        if (here[Domain::roulette].one() >= q) return false;
        throughput_ *= 1.0f / q;
        survival_ *= q;
        Surface from_camera;
        evaluate_surface(scene_, surface.hit, next.wi, from_camera);
        if (first && history_.count == 0)
            end_.pdf_direct = pdf_direct(world_.lights, scene_, lit_point(scene_, from_camera), y_);
        const std::optional<LightHistory::Arrival> arrival =
            history_.arrive(scene_, end_.end, visibility_, from_camera);
        if (!arrival) return false;
        history_.append_smooth(from_camera, *arrival, next.pdf_omega);
        return light_tracing_may_own(techniques_of(world_, settings_), history_.path);
    }

    // Whether the path, having come to its receiver, is none of those that go on there.
    bool ends_at_receiver() const {
        return !history_.has_scattered() && history_.count > 0 &&
               sampler_.vertex(segment_)[Domain::light_goes_on].one() >=
                   settings_.light_tracing.goes_on;
    }

    // Whether but a share of the paths comes so far: LightTracing::goes_on.
    bool is_thinned() const { return history_.has_scattered() && history_.chain_length() > 0; }

    // Splats what reaches the camera from a surface beyond the chain.
    void connect(const SurfaceHit& hit) {
        if (scene_.instances[hit.instance].holdout) return;
        const Vec3 p = surface_position(scene_, hit);
        const Vec2 lens = sampler_.vertex(segment_)[Domain::lens].two();
        const std::optional<CameraView> view = scene_.camera.view(p, lens);
        if (!view || !scene_.camera.is_near_crop(view->film, margin_)) return;
        Surface surface;
        evaluate_surface(scene_, hit, normalize(view->origin - p), surface);
        std::optional<LightHistory::Arrival> arrival =
            history_.arrive(scene_, end_.end, visibility_, surface);
        if (!arrival) return;
        CausticPath& path = arrival->path;
        path.film_density *= view->film_density * std::abs(dot(surface.ng, surface.wo));
        Spectrum value = arrival->throughput * passed_ * radiance_ * (1.0f / survival_);
        const Techniques techniques = techniques_of(world_, settings_);
        if (is_black(value) || !light_tracing_owns(techniques, path)) return;
        const std::optional<CausticDensities> densities = caustic_densities(techniques, path, end_);
        if (!densities || !(densities->light_tracing > 0.0)) return;
        value *= static_cast<float>(densities->scale()) * seen(surface, *view);
        if (is_black(value)) return;
        if (!can_be_held(value)) {
            ++stats_.nan_splats;
            return;
        }
        const double carried =
            static_cast<double>(luminance(value)) * densities->sum() / densities->light_tracing;
        if (search_trials_ != nullptr && densities->manifold > 0.0)
            count_search_trials(path, carried);
        if (path.glint_exit_pdf > 0.0f) weigh_glints(path, *densities, carried);
        stats_.carried += carried;
        stats_.carried_for_manifold += carried * densities->manifold / densities->sum();
        ++stats_.splats;
        const double square = static_cast<double>(dot(value, value) * (1.0f / 3.0f));
        (is_thinned() ? stats_.squares_behind : stats_.squares) += square;
        Splat splat{view->film, value};
        splat.u = sampler_.vertex(segment_)[Domain::splat].two();
        splat.light_group = settings_.group_of_light(y_.light);
        if (settings_.tell_lobes) splat.shares = lobe_shares(surface, ray_.direction * -1.0f);
        splats_.push_back(splat);
    }

    // Light paths that leave glints with a density of 1/sr, as a footprint may have it on average,
    // are there as dense as next event estimation.
    void weigh_glints(const CausticPath& path, const CausticDensities& densities, double carried) {
        if (!(densities.direct > 0.0)) return;
        stats_.carried_by_glints += carried;
        stats_.beside_glints += carried * densities.light_tracing *
                                static_cast<double>(path.film_density) /
                                (densities.direct * settings_.light_tracing.paths);
    }

    void count_search_trials(const CausticPath& path, double carried) {
        constexpr uint32_t kMostTrials = 1024;
        Pcg pcg(sampler_[Domain::manifold_seeds].stream_seed());
        search_trials_->light += carried;
        const Techniques techniques = techniques_of(world_, settings_);
        const uint32_t trials = trials_if_missed(techniques, *sheets_, path, end_, kMostTrials, pcg,
                                                 search_trials_->searches);
        const uint32_t first = techniques.casters.of_instance[path.vertices[0].hit.instance];
        const auto probability = static_cast<double>(
            caster_probability(techniques.casters, first, path.x, path.sides, end_.end));
        search_trials_->trials +=
            carried * (trials > 0 ? trials / std::max(probability, 1.0 / kMostTrials) : 1.0);
    }

    // Fraction of the light that passes from the surface to the camera.
    Spectrum seen(const Surface& surface, const CameraView& view) {
        uint32_t transparent_left = settings_.limits.transparent - transparent_;
        Media media = media_;
        if (dot(surface.ng, ray_.direction) > 0.0f) media.cross(scene_, surface.hit, surface.wo);
        return transmittance(scene_, {surface.p, surface.ng, surface.p_error},
                             {.at = {false, view.origin, Vec3(0.0f)}, .clip = view.t_near},
                             kVisibleCamera, transparent_left, media, stats_.rays);
    }

    const RenderScene& world_;
    const Scene& scene_;
    const IntegratorSettings& settings_;
    const float margin_;
    const Sampler& sampler_;
    std::vector<Splat>& splats_;
    LightPathStats& stats_;
    const LightSheets* sheets_ = nullptr;
    SearchTrials* search_trials_ = nullptr;

    LightPoint y_{};
    uint32_t visibility_ = 0;  // of its light
    Spectrum radiance_{0.0f};  // at y along the first segment
    Vec3 away_{0.0f};          // direction of that segment
    LightEnd end_{};
    Ray ray_;
    Media media_;            // that the ray is in
    Spectrum passed_{1.0f};  // through transparent surfaces and media
    uint32_t transparent_ = 0;
    uint32_t segment_ = 0;
    LightHistory history_{};
    Spectrum throughput_{1.0f};  // since the receiver, as light paths have it: for the roulette
    float survival_ = 1.0f;      // probability that it did not end the path
    uint64_t rays_before_ = 0;   // counted until the path scattered at its receiver
};

template <class Index>
Sampler light_sampler(uint32_t seed, const Index& index) {
    return sampler_beside_pixels(seed, 0x6c69676874ull, index);
}

// Shares of the pilot's paths on each of several guides, each of which learns from the one before.
constexpr std::array<double, 4> kGenerations{0.125, 0.125, 0.25, 0.5};
constexpr uint32_t kPilotChunk = 1u << 11;
// So many of the pilot's paths are asked how hard sheets find their chains: each searches for its
// own, which is slow. A chunk stops asking when that has taken kWorkOfAsked.
constexpr uint32_t kAsked = 1u << 11;
constexpr uint64_t kWorkOfAsked = 16 * kPilotChunk;
// Chunks between two looks at what is left of the budget.
constexpr uint32_t kPilotRound = 16;
// One lucky path must not draw all others to it.
constexpr float kLargestWeight = 32.0f;  // times the mean

// Some of the pilot's paths: from number `first` on, so many chunks.
struct Generation {
    uint64_t first;
    uint32_t chunks, ask_every;
    uint64_t count() const { return uint64_t{chunks} * kPilotChunk; }
};

// What paths of the pilot have found.
struct PilotRecord {
    explicit PilotRecord(const std::array<uint32_t, 4>& crop) : moments(crop) {}
    std::vector<EmissionSample> found;
    LightPathStats counted;
    CoarsePicture moments;
    SearchTrials search_trials;

    void add(const PilotRecord& other) {
        found.insert(found.end(), other.found.begin(), other.found.end());
        counted.add(other.counted);
        moments.add(other.moments);
        search_trials.add(other.search_trials);
    }
    uint64_t work() const { return counted.rays + search_trials.searches.work(); }
};

// Paths numbered from `first` on, up to a chunk of them.
void trace_chunk(const RenderScene& world, const IntegratorSettings& settings,
                 const LightSheets& sheets, float margin, uint64_t first, uint32_t ask_every,
                 uint32_t seed, const Budget& budget, PilotRecord& record) {
    constexpr uint32_t kUntilLook = 16;
    std::vector<Splat> splats;
    for (uint32_t i = 0; i < kPilotChunk; ++i) {
        if (i % kUntilLook == 0 && budget.must_end()) return;
        splats.clear();
        const Sampler sampler = light_sampler(~seed, first + i);
        LightTracer path(world, settings, margin, sampler, splats, record.counted);
        if (i % ask_every == 0 && !sheets.all.empty() &&
            record.search_trials.searches.work() < kWorkOfAsked)
            path.ask(sheets, record.search_trials);
        std::optional<EmissionSample> sample = path.trace();
        if (!sample) continue;
        for (const Splat& splat : splats) {
            sample->place.weight += luminance(splat.value);
            record.moments.add(splat.film,
                               static_cast<double>(dot(splat.value, splat.value) * (1.0f / 3.0f)));
        }
        if (sample->place.weight > 0.0f) record.found.push_back(*sample);
    }
}

// `work_before`: of earlier generations.
PilotRecord pilot(const RenderScene& world, const IntegratorSettings& settings,
                  const LightSheets& sheets, float margin, const Generation& generation,
                  uint32_t seed, uint32_t threads, const Budget& budget, uint64_t work_before) {
    const PilotRecord none(world.scene->camera.crop);
    PilotRecord all = none;
    for (uint32_t begin = 0; begin < generation.chunks; begin += kPilotRound) {
        if (budget.is_spent(work_before + all.work())) break;
        std::vector<PilotRecord> parts(std::min(kPilotRound, generation.chunks - begin), none);
        parallel_for(threads, static_cast<uint32_t>(parts.size()), [&](uint32_t c) {
            trace_chunk(world, settings, sheets, margin,
                        generation.first + uint64_t{begin + c} * kPilotChunk, generation.ask_every,
                        seed, budget, parts[c]);
        });
        for (const PilotRecord& part : parts) all.add(part);
    }
    return all;
}

void limit_weights(std::vector<EmissionSample>& samples) {
    double sum = 0.0;
    for (const EmissionSample& sample : samples) sum += static_cast<double>(sample.place.weight);
    const auto largest =
        kLargestWeight * static_cast<float>(sum / static_cast<double>(samples.size()));
    for (EmissionSample& sample : samples)
        sample.place.weight = std::min(sample.place.weight, largest);
}

// Evaluates paths that went on with probability c. With probability b they would have the variance
// V + V' / b and the cost C + b C'; what is counted is V' / c and c C'.
void measure(const LightPathStats& counted, const CoarsePicture& moments, LightPilot& result) {
    constexpr double kLeastGoingOn = 1.0 / 16;  // what was not met must not come too rarely
    const auto behind = static_cast<double>(counted.rays_behind),
               before = static_cast<double>(counted.rays) - behind;
    const double best =
        result.goes_on * std::sqrt(counted.squares_behind * before / (counted.squares * behind));
    result.goes_on = best < 1.0 ? std::max(best, kLeastGoingOn) : 1.0;
    if (counted.carried > 0.0)
        result.manifold_share = counted.carried_for_manifold / counted.carried;
    if (counted.carried_by_glints > 0.0)
        result.beside_glints = counted.beside_glints / counted.carried_by_glints;
    const auto paths = static_cast<double>(counted.paths);
    result.squares = moments;
    result.squares.scale(paths);
    result.rays = static_cast<double>(counted.rays) / paths;
}

}  // namespace

void trace_light_path(const RenderScene& world, const IntegratorSettings& settings, float margin,
                      uint32_t seed, const SplatIndex& index, std::vector<Splat>& splats,
                      LightPathStats& stats) {
    const Sampler sampler = light_sampler(seed, index);
    LightTracer(world, settings, margin, sampler, splats, stats).trace();
}

std::unique_ptr<const LightPilot> learn_emission(const RenderScene& world,
                                                 IntegratorSettings settings,
                                                 const LightSheets& sheets, float margin,
                                                 uint32_t paths, uint32_t seed, uint32_t threads,
                                                 const Budget& budget, LightPathStats& stats) {
    if (world.casters.aims().empty() || world.lights.caustic_selection.empty() ||
        !world.scene->light_paths_reach_camera)
        return nullptr;
    auto result = std::make_unique<LightPilot>(
        aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_beams), 1.0,
        CoarsePicture(world.scene->camera.crop), 0.0, 0.0, 1.0, 1.0,
        std::numeric_limits<double>::infinity());
    Generation generation{0, 0, std::max(1u, paths / kAsked)};
    SearchTrials search_trials;
    uint64_t work = 0;
    for (size_t i = 0; i < kGenerations.size(); ++i) {
        if (i > 1 && result->come_through < kFewComeThrough) break;
        if (i > 0 && budget.is_spent(work)) break;
        generation.chunks = static_cast<uint32_t>(std::ceil(kGenerations[i] * paths / kPilotChunk));
        settings.light_tracing = {.guide = &result->guide,
                                  .paths = static_cast<double>(generation.count()),
                                  .goes_on = result->goes_on,
                                  .mean_search_trials = result->mean_search_trials,
                                  .beside_glints = result->beside_glints};
        PilotRecord record =
            pilot(world, settings, sheets, margin, generation, seed, threads, budget, work);
        generation.first += generation.count();
        work += record.work();
        std::vector<EmissionSample>& learned = record.found;
        const LightPathStats& counted = record.counted;
        stats.add(counted);
        search_trials.add(record.search_trials);
        if (budget.is_cancelled()) return nullptr;
        if (learned.empty()) {
            if (i == 0) return nullptr;
            break;
        }
        result->come_through =
            static_cast<double>(learned.size()) / static_cast<double>(counted.paths);
        measure(counted, record.moments, *result);
        if (search_trials.light > 0.0)
            result->mean_search_trials = search_trials.trials / search_trials.light;
        limit_weights(learned);
        result->guide =
            aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_beams, learned);
    }
    return result;
}

}  // namespace spc
