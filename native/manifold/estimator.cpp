// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/estimator.h"

#include "manifold/found_chains.h"

#include <bit>

namespace spc {

namespace {

// Chains of throughput below kWeak have their trials counted only with a proportional probability,
// at least kLeastProbability.
constexpr float kWeak = 1.0f / 4, kLeastProbability = 1.0f / 16;

ReceiverSides sides_of(const Receiver& receiver) {
    return {receiver.ng, receiver.camera == nullptr && has_smooth_transmission(*receiver.closures)};
}

RayStart start_of(const Receiver& receiver) { return {receiver.p, receiver.ng, receiver.p_error}; }

// One estimate: a receiver and a light point, and chains between them.
class Estimate {
public:
    Estimate(const Techniques& techniques, const Receiver& receiver, const LightPoint& y,
             ManifoldStats& stats)
        : techniques_(techniques),
          scene_(techniques.scene),
          lights_(techniques.lights),
          settings_(techniques.manifold),
          receiver_(receiver),
          y_(y),
          stats_(stats) {}

    // One walk on a caster's surface, weighted by how many more it takes to find the same solution
    // again.
    Spectrum unbiased(const Caster& caster, Pcg& pcg) {
        const ChainQuery query{receiver_.p, end_of(y_), &caster};
        const auto walk = [&] { return random_walk(scene_, settings_, query, pcg, stats_); };
        const std::optional<ChainRoot> root = walk();
        if (!root) return Spectrum(0.0f);
        const Chain chain = chain_of(*root);
        const Spectrum value = contribution(chain);
        if (is_black(value)) return value;
        return told(chain, value * static_cast<float>(trials_until([&] {
                               const std::optional<ChainRoot> again = walk();
                               return again && same_root(settings_, *root, *again);
                           })));
    }

    // The same for chains with several vertices, which shots find.
    Spectrum unbiased_long(Pcg& pcg) { return by_random_search({techniques_.casters, 2}, pcg); }

    // The sum over the different solutions of a fixed number of walks.
    Spectrum biased(const Caster& caster, Pcg& pcg) {
        const ChainQuery query{receiver_.p, end_of(y_), &caster};
        return set_of<ChainRoot>([&] { return random_walk(scene_, settings_, query, pcg, stats_); },
                                 same_root, chain_of);
    }

    Spectrum biased_long(Pcg& pcg) {
        const Search search{techniques_.casters, 2};
        return set_of<ChainSolution>([&] { return random_chain(search, choose(search, pcg), pcg); },
                                     same_solution,
                                     [](const ChainSolution& one) { return one.chain; });
    }

    // The sum over the chains that sheet seeds find, weak ones with a probability. What the sheet
    // misses at its folds and ends is left to a random search with trials, which rarely finds
    // anything.
    ManifoldRadiance by_sheet(const LightSheet* sheet, float sure, bool draws, Pcg& pcg) {
        const float search_probability = sheet != nullptr ? settings_.search_probability : 1.0f;
        // Turns a beam's density, the irradiance at the receiver, into the probability of its seed.
        const float probability_per_density = sure > 0.0f ? receiver_.importance / (y_.pdf * sure)
                                                          : std::numeric_limits<float>::max();
        FoundChains found;
        const float u = pcg.one();
        const uint64_t work_before = stats_.work();
        if (sheet != nullptr)
            shoot_seeds(scene_, settings_, *sheet, start(), y_, probability_per_density, u, found,
                        stats_);
        ManifoldRadiance result;
        for (const FoundChain& one : found)
            result.seeded +=
                told(one.solution.chain,
                     contribution(one.solution.chain) * (1.0f / one.probability), false);
        stats_.roots += found.size();
        result.seed_work = stats_.work() - work_before;
        if (!draws || pcg.one() >= search_probability) return result;
        const Search search{techniques_.casters};
        const CasterChoice caster = choose(search, pcg);
        const std::optional<ChainSolution> missed = random_chain(search, caster, pcg);
        if (!missed || find_chain(settings_, found, *missed) != nullptr) return result;
        if (sheet != nullptr)
            shoot_seeds(scene_, settings_, *sheet, start(), y_, probability_per_density, 0.0f,
                        found, stats_);
        if (find_chain(settings_, found, *missed) != nullptr) return result;
        result.drawn = of_missed(missed->chain, pcg,
                                 [&] { return comes_again(search, caster, *missed, pcg); }) *
                       (1.0f / (caster.probability * search_probability));
        if (is_black(told(missed->chain, result.drawn))) return result;
        ++stats_.missed;
        stats_.missed_energy += static_cast<double>(luminance(result.drawn));
        return result;
    }

    // One chain among facets that are drawn once.
    Spectrum by_facets(Pcg& pcg) {
        const FrozenFacets facets = freeze_facets(pcg);
        return by_random_search({techniques_.rough_chain_casters, 1, &facets}, pcg);
    }

    // Appends the camera chains that chain seeds find.
    void camera_chains(std::vector<CameraChain>& out) {
        FoundChains found;
        shoot_seeds(techniques_, start(), y_, found, stats_);
        stats_.roots += found.size();
        for (const FoundChain& one : found) {
            const Spectrum value = contribution(one.solution.chain);
            if (!is_black(value)) out.push_back(camera_chain(one.solution.chain, value));
        }
    }

    // A camera chain that no chain seed finds, by a search in one pixel.
    std::optional<CameraChain> missed_camera_chain(const Vec2& pixel, Pcg& pcg) {
        const auto search = [&] {
            return search_pixel(techniques_, start(), pixel, end_of(y_), pcg, stats_);
        };
        const std::optional<ChainSolution> missed = search();
        if (!missed || any_seed_finds(techniques_, start(), end_of(y_), y_.light, *missed, stats_))
            return std::nullopt;
        const Spectrum value = of_missed(missed->chain, pcg, [&] {
            const std::optional<ChainSolution> again = search();
            return again && same_solution(settings_, *missed, *again);
        });
        if (is_black(value)) return std::nullopt;
        return camera_chain(missed->chain, value);
    }

    // From a ray of the camera's and its first `count` turns.
    std::optional<ChainSolution> camera_chain_near(const FollowedRay& ray, uint32_t count) {
        std::optional<ChainSolution> found =
            shoot(scene_, settings_, start(), end_of(y_), ray.kind.first(count), ray.w,
                  settings_.max_halvings, stats_);
        if (found && is_black(contribution(found->chain))) found.reset();
        return found;
    }

    // The chains of both MNEE seeds: the straight line, and the middle of a caster.
    Spectrum from_mnee_seeds(uint32_t caster) {
        Spectrum sum(0.0f);
        for (const Interaction first : {Interaction::refraction, Interaction::reflection})
            if (const std::optional<ChainSolution> found =
                    shoot_from_mnee_seed(techniques_, start(), end_of(y_), first, caster, stats_))
                sum += told(found->chain, contribution(found->chain));
        return sum;
    }

private:
    CameraChain camera_chain(const Chain& chain, const Spectrum& value) const {
        return {chain.vertices[0].geometry.p, value, chain.vertices[0].interaction, chain.count,
                y_.light};
    }

    // `radiance`, which is told to the receiver if it asks.
    Spectrum told(const Chain& chain, const Spectrum& radiance, bool drawn = true) const {
        if (receiver_.received != nullptr && !is_black(radiance))
            receiver_.received->push_back(
                {normalize(chain.vertices[0].geometry.p - receiver_.p), radiance, y_.light, drawn});
        return radiance;
    }

    static Chain chain_of(const ChainRoot& root) {
        Chain chain;
        chain.count = 1;
        chain.hits[0] = root.hit;
        chain.vertices[0] = {root.interaction, root.eta, root.geometry};
        return chain;
    }

    RayStart start() const { return start_of(receiver_); }

    // What random searches look for: chains of so many vertices or more.
    struct Search {
        const CasterSet& casters;
        uint32_t fewest = 1;
        const FrozenFacets* facets = nullptr;
    };

    CasterChoice choose(const Search& search, Pcg& pcg) const {
        return choose_caster(search.casters, receiver_.p, sides_of(receiver_), end_of(y_),
                             pcg.one());
    }

    // A shot from a random direction towards the caster, with a random interaction at every vertex.
    // It finds every chain that begins at the caster with some probability.
    std::optional<ChainSolution> random_chain(const Search& search, const CasterChoice& first,
                                              Pcg& pcg) {
        if (first.index == kNone) return std::nullopt;
        const std::optional<ChainSeed> chain = sample_chain(
            scene_, settings_, start(), search.casters, first.index, pcg, stats_, search.facets);
        if (!chain || chain->kind.count < search.fewest) return std::nullopt;
        return shoot(scene_, settings_, start(), end_of(y_), chain->kind, chain->w,
                     settings_.max_halvings, stats_, search.facets);
    }

    // One solution, weighted by how many more times it takes to find it again.
    Spectrum by_random_search(const Search& search, Pcg& pcg) {
        const CasterChoice first = choose(search, pcg);
        const std::optional<ChainSolution> solution = random_chain(search, first, pcg);
        if (!solution) return Spectrum(0.0f);
        const std::optional<Connection> connection =
            connect(solution->chain, search.facets != nullptr);
        if (!connection) return Spectrum(0.0f);
        const Spectrum value =
            light_of(*connection, solution->chain) * static_cast<float>(connection->scale);
        return told(solution->chain, counted(value, connection->strength(), pcg, [&] {
                                         return comes_again(search, first, *solution, pcg);
                                     }) * (1.0f / first.probability));
    }

    // `value` times the number of trials until its solution is found again, which estimates 1 /
    // p_k. Chains of little throughput take as many trials as others, so only some of them are
    // counted.
    template <class Trial>
    Spectrum counted(const Spectrum& value, float strength, Pcg& pcg, const Trial& comes_again) {
        if (is_black(value)) return value;
        const float probability = std::clamp(strength / kWeak, kLeastProbability, 1.0f);
        if (pcg.one() >= probability) return Spectrum(0.0f);
        return value * (static_cast<float>(trials_until(comes_again)) / probability);
    }

    bool comes_again(const Search& search, const CasterChoice& first, const ChainSolution& solution,
                     Pcg& pcg) {
        const std::optional<ChainSolution> again = random_chain(search, first, pcg);
        return again && same_solution(settings_, solution, *again);
    }

    // The sum over the different solutions of `set_size` searches.
    template <class Solution, class Find, class Same, class ToChain>
    Spectrum set_of(const Find& find_one, const Same& same, const ToChain& to_chain) {
        std::vector<Solution> found;
        Spectrum sum(0.0f);
        for (uint32_t i = 0; i < settings_.set_size && !is_cancelled(settings_); ++i) {
            const std::optional<Solution> one = find_one();
            if (!one) continue;
            const auto known = [&](const Solution& other) { return same(settings_, *one, other); };
            if (std::any_of(found.begin(), found.end(), known)) continue;
            found.push_back(*one);
            const Chain chain = to_chain(*one);
            sum += told(chain, contribution(chain));
        }
        return sum;
    }

    // A solution as a path of light that the manifold may find, whatever stands in its way.
    struct Connection {
        Spectrum f_cos;  // at x
        Spectrum throughput, radiance;
        CausticDensities densities;
        double scale;  // of its light, where the manifold is sure to find it
        float strength() const { return max_component(throughput); }
    };
    // With `among_facets` only chains that have a rough vertex count; the others are found without
    // facets.
    std::optional<Connection> connect(const Chain& chain, bool among_facets = false) const {
        const Vec3 wi = normalize(chain.vertices[0].geometry.p - receiver_.p);
        const ClosureEval at_x = scattering_at_x(wi);
        if (is_black(at_x.f_cos)) return std::nullopt;
        const Vec3& last = chain.vertices[chain.count - 1].geometry.p;
        float distance_y = 0.0f;
        const Vec3 away = end_of(y_).from(last, distance_y) * -1.0f;
        Connection result;
        const float length_y = length(light_begins(lights_, y_, last) - last);
        result.radiance = radiance_at(lights_, scene_, y_, away, length_y);
        if (is_black(result.radiance) || !shows_itself(lights_, y_, last)) return std::nullopt;

        CausticPath path = receiver_.camera != nullptr
                               ? camera_path(*receiver_.camera, receiver_.p, wi)
                               : caustic_path(scene_, receiver_, at_x, wi);
        for (uint32_t i = 0; i < chain.count; ++i)
            path.append({.hit = chain.hits[i],
                         .interaction = chain.vertices[i].interaction,
                         .rough = scene_.material_of(chain.hits[i]).interface().is_rough()});
        if (path.is_rough() != among_facets) return std::nullopt;
        result.throughput = chain_throughput(scene_, path, end_of(y_));
        if (is_black(result.throughput) || !manifold_owns(techniques_, path)) return std::nullopt;
        LightEnd end = light_end(y_, away);
        if (path.vertices[path.count - 1].rough) {
            const Vec3& before =
                chain.count > 1 ? chain.vertices[chain.count - 2].geometry.p : receiver_.p;
            Surface at_last;
            evaluate_surface(scene_, chain.hits[chain.count - 1], normalize(before - last), at_last);
            end.pdf_direct = pdf_direct(lights_, scene_, lit_point(scene_, at_last), y_);
        }
        const std::optional<CausticDensities> densities = caustic_densities(techniques_, path, end);
        if (!densities || !(densities->geometry > 0.0) || !(densities->manifold > 0.0))
            return std::nullopt;
        result.densities = *densities;
        result.scale = manifold_confidence(techniques_, path) * densities->scale();
        const bool shared = !among_facets && receiver_.rough_before != nullptr;
        result.f_cos = shared ? left_by_rough_chains(
                                    techniques_,
                                    {receiver_.rough_before, receiver_.hit, *receiver_.closures,
                                     receiver_.ng, receiver_.wo},
                                    wi, kAllKinds, std::span(path.vertices.data(), path.count), end)
                              : at_x.f_cos;
        return result;
    }

    // That reaches the receiver; zero if something stands in its way.
    Spectrum light_of(const Connection& connection, const Chain& chain) {
        return connection.f_cos * connection.throughput * connection.radiance * passes(chain);
    }

    // What one solution contributes that the manifold is sure to find.
    Spectrum contribution(const Chain& chain) {
        const std::optional<Connection> connection = connect(chain);
        if (!connection) return Spectrum(0.0f);
        return light_of(*connection, chain) * static_cast<float>(connection->scale);
    }

    // The contribution of a chain that seeds miss, with the weight of searches for such chains.
    template <class Trial>
    Spectrum of_missed(const Chain& chain, Pcg& pcg, const Trial& comes_again) {
        const std::optional<Connection> connection = connect(chain);
        if (!connection) return Spectrum(0.0f);
        const Spectrum light = light_of(*connection, chain);
        if (is_black(light)) return light;
        return counted(light * scale_of_missed(*connection, comes_again), connection->strength(),
                       pcg, comes_again);
    }

    template <class Trial>
    float scale_of_missed(const Connection& connection, const Trial& comes_again) {
        const CausticDensities& p = connection.densities;
        if (!p.missed_are_apart()) return static_cast<float>(connection.scale);
        const uint32_t trials =
            count_trials(settings_, p.telling_trials(settings_.trial_cap), comes_again);
        return static_cast<float>(p.geometry * p.share_of_searches(trials) /
                                  static_cast<double>(y_.pdf));
    }

    // The camera takes the film for what scatters.
    ClosureEval scattering_at_x(const Vec3& wi) const {
        if (receiver_.camera == nullptr)
            return eval(*receiver_.closures, receiver_.ng, receiver_.wo, wi);
        const float density = receiver_.camera->film_density_omega(wi);
        return {Spectrum(density), density};
    }

    // Fraction of light that passes along all segments of a chain.
    Spectrum passes(const Chain& chain) {
        const auto kind_at = [&](uint32_t i) -> uint32_t {
            return chain.vertices[i].interaction == Interaction::reflection ? kVisibleGlossy
                                                                            : kVisibleTransmission;
        };
        const uint32_t last = chain.count - 1;
        const Instance& next_to_light = scene_.instances[chain.hits[last].instance];
        if ((light_visibility(lights_, y_.light) & kind_at(last)) == 0 ||
            !shines_on(lights_, y_.light, next_to_light.sets.receives))
            return Spectrum(0.0f);
        uint32_t transparent_left = receiver_.transparent_left;
        Media media = *receiver_.media;
        const Vec3 first = chain.vertices[0].geometry.p - receiver_.p;
        if (dot(receiver_.ng, first) < 0.0f) media.cross(scene_, receiver_.hit, first);
        Spectrum through(1.0f);
        RayStart from = start();
        if (receiver_.camera != nullptr)  // nothing nearer is in its way
            from.p += first * (receiver_.camera->clip_near / dot(receiver_.ng, first));
        uint32_t kind = receiver_.camera != nullptr ? kVisibleCamera : kVisibleDiffuse;
        for (uint32_t i = 0; i < chain.count; ++i) {
            const DifferentialGeometry& geometry = chain.vertices[i].geometry;
            // Chains that look through a caster are path tracing's: CausticPath::through_caster.
            through *= transmittance(scene_, from, end_on(scene_, chain.hits[i], geometry), kind,
                                     transparent_left, media, stats_.rays, Opaque::casters_too);
            if (is_black(through)) return through;
            if (chain.vertices[i].interaction == Interaction::refraction)
                media.cross(scene_, chain.hits[i], geometry.p - from.p);
            from = {geometry.p, geometry.ng, geometry.p_error};
            kind = kind_at(i);
        }
        if (scene_.material_of(chain.hits[last]).interface().is_rough() && !casts_shadow())
            return through;
        // As the rays that look for such a light.
        const uint64_t blockers = blockers_of(lights_, y_.light);
        return through * transmittance(scene_, from, end_of_light(from.p),
                                       blockers == 0 ? kind : uint32_t{kVisibleShadow},
                                       transparent_left, media, stats_.rays, Opaque::by_material,
                                       blockers);
    }

    // Where the lamp's light begins on its way to `last`.
    RayEnd end_of_light(const Vec3& last) const {
        RayEnd end = ray_end(scene_, y_);
        if (!end.at.distant) end.at.p = light_begins(lights_, y_, last);
        return end;
    }

    // Whether occluders stop the light, where next event estimation looks for it, too: rays, which
    // look for it behind mirrors and glass, they always stop.
    bool casts_shadow() const {
        return (light_visibility(lights_, y_.light) & kVisibleShadow) != 0;
    }

    // E[number of trials until a solution comes again] = 1 / p_k.
    template <class Trial>
    uint32_t trials_until(const Trial& comes_again) {
        const uint32_t trials = count_trials(settings_, settings_.trial_cap, comes_again);
        ++stats_.trial_estimates;
        stats_.trials += trials;
        ++stats_.trial_histogram[std::min<size_t>(std::bit_width(trials) - 1,
                                                  stats_.trial_histogram.size() - 1)];
        stats_.max_trials = std::max<uint64_t>(stats_.max_trials, trials);
        if (trials >= settings_.trial_cap) ++stats_.capped;
        return trials;
    }

    const Techniques& techniques_;
    const Scene& scene_;
    const LightSet& lights_;
    const ManifoldSettings& settings_;
    const Receiver& receiver_;
    const LightPoint& y_;
    ManifoldStats& stats_;
};

}  // namespace

CausticPath caustic_path(const Scene& scene, const Receiver& receiver, const ClosureEval& at_x,
                         const Vec3& wi) {
    CausticPath path;
    path.x = receiver.p;
    path.p_error = receiver.p_error;
    path.sides = sides_of(receiver);
    path.pdf_omega = at_x.pdf_omega;
    path.receiver = true;
    path.camera_subpath = receiver.camera_subpath.bounces;
    set_film_density(scene, receiver.camera_subpath, receiver.hit, receiver.wo, wi, path);
    path.folds = receiver.folds;
    path.before = receiver.before;
    return path;
}

ManifoldRadiance manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                                   const LightSheets& sheets, bool draws, const Sampler& sampler,
                                   ManifoldStats& stats) {
    ManifoldRadiance result;
    const ManifoldSettings& settings = techniques.manifold;
    const CasterSet& casters = techniques.casters;
    const Vec3 u = sampler[Domain::manifold_light].three();
    Pcg pcg(sampler[Domain::manifold_seeds].stream_seed());
    const std::optional<LightPoint> y = sample_light_point(techniques.lights, techniques.scene, u);
    if (!y) return result;
    ++stats.estimates;
    Estimate estimate(techniques, receiver, *y, stats);
    if (settings.finder == ChainFinder::sheets)
        return estimate.by_sheet(nearest_sheet(sheets, *y), sheets.sure, draws, pcg);
    if (settings.finder == ChainFinder::walks && settings.looks_for_longer())
        result.drawn = settings.biased ? estimate.biased_long(pcg) : estimate.unbiased_long(pcg);
    if (!settings.looks_for_singles()) return result;
    const CasterChoice choice = choose_caster(casters, receiver.p, sides_of(receiver), end_of(*y),
                                              sampler[Domain::manifold_caster].one());
    if (choice.index == kNone) return result;
    const Caster& caster = casters.casters[choice.index];
    result.drawn += settings.finder == ChainFinder::mnee ? estimate.from_mnee_seeds(choice.index)
                    : settings.biased                    ? estimate.biased(caster, pcg)
                                                         : estimate.unbiased(caster, pcg);
    return result;
}

Spectrum rough_chain_radiance(const Techniques& techniques, const Receiver& receiver,
                              const Sampler& sampler, ManifoldStats& stats) {
    const Vec3 u = sampler[Domain::rough_chain_light].three();
    Pcg pcg(sampler[Domain::rough_chain_seeds].stream_seed());
    const std::optional<LightPoint> y = sample_light_point(techniques.lights, techniques.scene, u);
    if (!y) return Spectrum(0.0f);
    ++stats.estimates;
    return Estimate(techniques, receiver, *y, stats).by_facets(pcg);
}

void find_camera_chains(const Techniques& techniques, const Receiver& camera, const Sampler& sampler,
                        std::vector<CameraChain>& found, ManifoldStats& stats) {
    const std::optional<LightPoint> y = sample_light_point(
        techniques.lights, techniques.scene, sampler[Domain::camera_chain_light].three());
    if (!y || !techniques.camera_chains->has(y->light)) return;
    ++stats.estimates;
    Estimate(techniques, camera, *y, stats).camera_chains(found);
}

std::optional<CameraChain> search_camera_chain(const Techniques& techniques, const Receiver& camera,
                                               const Vec2& pixel, const Sampler& sampler,
                                               ManifoldStats& stats) {
    const std::optional<LightPoint> y = sample_light_point(
        techniques.lights, techniques.scene, sampler[Domain::camera_chain_light].three());
    if (!y || !techniques.camera_chains->has(y->light)) return std::nullopt;
    Pcg pcg(sampler[Domain::camera_chain_seeds].stream_seed());
    return Estimate(techniques, camera, *y, stats).missed_camera_chain(pixel, pcg);
}

void add_random_camera_chains(const Techniques& techniques, const Receiver& camera,
                              const Vec2& film, float radius, const Sampler& sampler,
                              std::vector<RandomCameraChain>& found, ManifoldStats& stats) {
    constexpr uint32_t kLights = 16;  // at most, behind each turn
    const ManifoldSettings& settings = techniques.manifold;
    Pcg pcg(sampler[Domain::camera_chain_seeds].stream_seed());
    const std::optional<FollowedRay> ray =
        follow_camera_ray(techniques.scene, settings, camera.camera->ray_from(camera.p, film),
                          techniques.casters, pcg, stats);
    if (!ray) return;
    const float most_turn = radius / std::sqrt(camera.camera->film_density_omega(ray->w));
    const Vec3 u = sampler[Domain::camera_chain_light].three();
    uint32_t light = kNone;
    for (uint32_t i = 0; i < kLights; ++i) {
        const float chosen = (static_cast<float>(i) + u.x) / static_cast<float>(kLights);
        const std::optional<LightPoint> y = sample_light_point(
            techniques.lights, techniques.scene, Vec3(std::min(chosen, kBelowOne), u.y, u.z));
        if (!y || y->light == light) continue;
        light = y->light;
        for (uint32_t n = ray->fewest; n <= ray->kind.count; ++n) {
            if (!(turn_towards(ray->behind[n - 1], end_of(*y)) < most_turn)) continue;
            const std::optional<ChainSolution> solution =
                Estimate(techniques, camera, *y, stats).camera_chain_near(*ray, n);
            if (solution) found.push_back({*y, *solution});
        }
    }
}

bool seed_finds(const Techniques& techniques, const Receiver& camera, const ChainSeed& chain_seed,
                const RandomCameraChain& camera_chain, ManifoldStats& stats) {
    return seed_finds(techniques, start_of(camera), end_of(camera_chain.y), chain_seed,
                      camera_chain.solution, stats);
}

}  // namespace spc
