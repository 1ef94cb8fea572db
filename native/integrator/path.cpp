// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path.h"

#include "integrator/history.h"
#include "manifold/fold_directions.h"
#include "manifold/found_chains.h"

#include <utility>

namespace spc {

namespace {

// Directions to lights of which closures with glints take one.
constexpr uint32_t kGlintCandidates = 12;

// The share of an estimate of density `own` in light that another one finds with `other`: by the
// balance heuristic.
float shared(float own, float other) { return own / (own + other); }

// The share of kGlintCandidates directions of density `direct` in light that closures with glints
// find with `closure`.
float shared_by_glints(float direct, const GlintDensity& closure) {
    return closure.share_of_direct(static_cast<float>(kGlintCandidates), direct);
}

// One path under way, and the steps that it consists of.
struct PathTracer {
    const RenderScene& world;
    const IntegratorSettings& settings;
    const PassState& pass;
    PathStats& stats;
    Pcg& pcg;  // of searches for chains that sheets miss
    Vec2 lens;
    Ray ray;
    Media media;             // that the ray is in
    Vec3 from = ray.origin;  // the path's last vertex, beside which the ray starts
    Spectrum throughput{1.0f};
    PathHistory history{};
    BounceCounts bounces{};
    uint32_t ray_kind = kVisibleCamera;
    // Where there may be glints: how the path moves with what it was drawn from, and what its last
    // surface makes of that.
    std::optional<PathDifferential> differential{};
    std::optional<GlintPoint> glints{};
    // At the surface where the path is, and at history.caustic.x.
    FoldDirections folds_here{}, folds_at_x{};
    bool from_folds = false;  // whether one of folds_at_x has been drawn there

    const Scene& scene() const { return *world.scene; }

    std::optional<Hit> intersect() {
        ++stats.rays;
        const std::optional<Hit> hit = scene().accel->intersect(ray, ray_kind);
        throughput *= media.transmittance(hit ? hit->t - ray.t_near : kInfinity);
        return hit;
    }

    // Along the ray to a surface, which the path then evaluates: adds the light that it runs into on
    // the way and there. Empty where it leaves the scene.
    std::optional<Hit> go_to_surface(Surface& surface, Spectrum& radiance) {
        for (;;) {
            const std::optional<Hit> hit = intersect();
            if (!hit) {
                const bool shows_film = settings.transparent_film && ray_kind == kVisibleCamera;
                go_towards(ray.direction);
                if (!shows_film) radiance += throughput * emission_from_afar();
                return hit;
            }
            if (hit->light == kNone) {
                evaluate(*hit, surface);
                come_to(surface.p);
                radiance += throughput * emission_of_surface(*hit, surface);
                return hit;
            }
            // Lamps are looked through, as in Cycles.
            come_to(ray.origin + ray.direction * hit->t);
            radiance += throughput * emission_of_lamp(*hit);
            ray.t_near = past(hit->t);
        }
    }

    // What the path finds at a surface, as far as it is allowed to see it.
    void evaluate(const Hit& hit, Surface& surface) const {
        evaluate_surface(scene(), hit.surface, ray.direction * -1.0f, surface);
        const Vec3 back = from - surface.p;
        if (dot(back, surface.ng) > 0.0f) surface.wo = normalize(back);
        const ManifoldSettings& caustics = settings.manifold;
        if (ray_kind == kVisibleDiffuse && !(caustics.reflections && caustics.refractions))
            drop_caustics(surface.closures, caustics.reflections, caustics.refractions);
    }

    // Whether somebody else may find what path tracing does.
    bool shares() const {
        return (settings.manifold.enabled && has_chain_casters()) ||
               settings.light_tracing.guide != nullptr;
    }
    bool has_chain_casters() const {
        return !(world.casters.empty() && world.rough_chain_casters.empty());
    }
    void go_towards(const Vec3& wi) {
        if (shares()) history.set_direction(scene(), wi);
    }
    void come_to(const Vec3& p) {
        if (shares()) history.set_next(scene(), p);
    }

    // ---- light that the path runs into. Each is weighed against the estimator that could have
    // connected to it.

    // `end.pdf`: 0 where light points are never drawn there; `end.pdf_direct`: likewise.
    float weight_of(const LightEnd& end) const {
        const float weight = weight_of_own(end);
        if (history.rough_chain.count == 0) return weight;
        return weight *
               (1.0f - rough_chain_share(techniques_of(world, settings), history.rough_chain, end));
    }

    // Of the path since x.
    float weight_of_own(const LightEnd& end) const {
        if (from_folds && history.stage != PathHistory::Stage::chain) return 0.0f;
        switch (history.stage) {
            case PathHistory::Stage::unconnected: return 1.0f;
            case PathHistory::Stage::scattered: {
                const std::optional<CausticDensities> p =
                    shared_with_light_paths(history.caustic, end);
                if (p) return static_cast<float>(p->path_tracing / p->sum());
                return history.glints ? 1.0f - shared_by_glints(end.pdf_direct, *history.glints)
                                      : shared(history.pdf_direct, end.pdf_direct);
            }
            case PathHistory::Stage::chain: return weight_of_chain(end);
        }
        return 1.0f;
    }

    // Of light that a rough caster at path.x throws on; empty where light paths do not find it.
    std::optional<CausticDensities> shared_with_light_paths(const CausticPath& path,
                                                            const LightEnd& end) const {
        if (!path.rough_caster || !(end.pdf > 0.0f) || !(end.cosine > 0.0f)) return std::nullopt;
        const Techniques techniques = techniques_of(world, settings);
        if (!light_tracing_owns(techniques, path)) return std::nullopt;
        const std::optional<CausticDensities> p = caustic_densities(techniques, path, end);
        return p && p->light_tracing > 0.0 ? p : std::nullopt;
    }

    // Whether weight_of() asks for the density of light points.
    bool light_points_count() const {
        return (history.stage == PathHistory::Stage::chain && history.caustic.count > 0) ||
               history.rough_chain.count > 0 ||
               (history.stage == PathHistory::Stage::scattered && history.caustic.rough_caster);
    }

    float weight_of_chain(const LightEnd& end) const {
        const float unshared = from_folds ? 0.0f : 1.0f;
        const Techniques techniques = techniques_of(world, settings);
        const CausticPath& so_far = history.caustic;
        if (!(end.pdf > 0.0f) ||
            !(manifold_owns(techniques, so_far) || light_tracing_owns(techniques, so_far)))
            return unshared;
        if (so_far.from_camera && !settings.highlights->has(end.light)) return unshared;
        CausticPath path = so_far;
        if (is_black(chain_throughput(scene(), path, end.end))) return unshared;
        const std::optional<CausticDensities> p = caustic_densities(techniques, path, end);
        if (!p || p->manifold + p->light_tracing == 0.0) return unshared;
        const double own = from_folds ? p->share_of_folds() : 1.0 - p->share_of_folds();
        if (own == 0.0) return 0.0f;
        const uint32_t trials =
            p->missed_are_apart()
                ? trials_if_missed(techniques, pass.sheets, path, end,
                                   settings.manifold.weight_trials, pcg, stats.manifold)
                : 0;
        return static_cast<float>(
            own * (trials > 0 ? p->share_of_directions(trials) : p->by_directions() / p->sum()));
    }

    // A lamp without shadow shines through everything: rays, which do not, leave it to those who
    // connect to it, if there is one.
    float weight_of_lamp(const LightEnd& end) const {
        const float weight = weight_of(end);
        const bool casts_shadow = (light_visibility(world.lights, end.light) & kVisibleShadow) != 0;
        return casts_shadow || weight == 1.0f ? weight : 0.0f;
    }

    LightEnd end_afar(uint32_t light, float pdf, float pdf_direct) const {
        return {{true, Vec3(0.0f), ray.direction}, light, false, 1.0f, pdf, pdf_direct};
    }

    // The world and every sun with a disc, in the direction of a ray that leaves the scene.
    Spectrum emission_from_afar() const {
        Spectrum sum = emission_of_world();
        for (const uint32_t sun : world.lights.disc_suns) {
            if ((light_visibility(world.lights, sun) & ray_kind) == 0) continue;
            const Spectrum radiance =
                lamp_radiance(world.lights.lamps[sun], Vec3(0.0f), ray.direction * -1.0f);
            if (is_black(radiance)) continue;
            sum += radiance * weight_of_lamp(end_afar(
                                  sun, pdf_light_point_sun(world.lights, sun, ray.direction),
                                  pdf_direct_sun(world.lights, sun, ray.direction)));
        }
        return sum;
    }

    Spectrum emission_of_world() const {
        if (!world.lights.has_world || (scene().environment.visibility & ray_kind) == 0)
            return Spectrum(0.0f);
        const Spectrum radiance = world_radiance(world.lights, scene(), ray.direction);
        if (is_black(radiance)) return radiance;
        const bool scattered = history.stage == PathHistory::Stage::scattered;
        return radiance *
               weight_of(end_afar(
                   world.lights.of_world(),
                   light_points_count() ? pdf_light_point_world(world.lights, ray.direction) : 0.0f,
                   scattered ? pdf_direct_world(world.lights, ray.direction) : 0.0f));
    }

    Spectrum emission_of_lamp(const Hit& hit) const {
        const Vec3 p = ray.origin + ray.direction * hit.t;
        const Spectrum radiance =
            lamp_radiance(world.lights.lamps[hit.light], p, ray.direction * -1.0f);
        if (is_black(radiance)) return radiance;
        float pdf_direct = 0.0f, pdf_point = 0.0f, cos_y = 0.0f;
        if (history.stage == PathHistory::Stage::scattered)
            pdf_direct = pdf_direct_lamp(world.lights, history.caustic.x, ray.direction, hit);
        if (light_points_count()) {
            cos_y = -dot(lamp_normal(world.lights.lamps[hit.light], p), ray.direction);
            // The manifold sees lamps from outside alone.
            if (cos_y > 0.0f) pdf_point = pdf_light_point_lamp(world.lights, hit);
        }
        return radiance *
               weight_of_lamp(
                   {{false, p, Vec3(0.0f)}, hit.light, false, cos_y, pdf_point, pdf_direct});
    }

    Spectrum emission_of_surface(const Hit& hit, const Surface& surface) const {
        if (is_black(surface.closures.emission)) return Spectrum(0.0f);
        float pdf_direct = 0.0f, pdf_point = 0.0f;
        if (history.stage == PathHistory::Stage::scattered)
            pdf_direct =
                pdf_direct_surface(world.lights, scene(), history.caustic.x, ray.direction, hit);
        if (light_points_count()) pdf_point = pdf_light_point_surface(world.lights, hit.surface);
        const uint32_t emitter = world.lights.emissive_of_instance[hit.surface.instance];
        const LightEnd end{{false, surface.p, Vec3(0.0f)},
                           emitter == kNone ? kNone : world.lights.of_emitter(emitter),
                           false,
                           std::abs(dot(surface.ng, ray.direction)),
                           pdf_point,
                           pdf_direct};
        return surface.closures.emission * weight_of(end);
    }

    // ---- light that a vertex connects to

    // Next event estimation over all lights.
    Spectrum direct_radiance(const Surface& surface, const CameraApproach& approach,
                             const Sampler& sampler) {
        if (!has_smooth_closure(surface.closures)) return Spectrum(0.0f);
        const std::optional<DirectSample> light =
            sample_direct(world.lights, scene(), surface.p, sampler[Domain::light].three());
        if (!light || is_black(light->radiance)) return Spectrum(0.0f);
        const uint32_t visibility = light_visibility(world.lights, light->light);
        const ClosureEval f =
            eval(surface.closures, surface.ng, surface.wo, light->wi, kinds_seeing(visibility));
        if (is_black(f.f_cos)) return Spectrum(0.0f);
        // f L / p_light, times its balance weight where other rays find the light, too
        const Spectrum alone = left_of_direct(surface, *light, f, kinds_seeing(visibility)) *
                               light->radiance * (1.0f / light->density);
        if ((visibility & kVisibleShadow) == 0) return alone;
        return alone * weight_of_direct(surface, approach, *light, f) * unblocked(surface, *light);
    }

    // f |cos|, less what rough chains find.
    Spectrum left_of_direct(const Surface& surface, const DirectSample& light, const ClosureEval& f,
                            uint32_t kinds) const {
        const RoughVisit visit = rough_visit(surface);
        if (visit.before == nullptr) return f.f_cos;
        return left_by_rough_chains(techniques_of(world, settings), visit, light.wi, kinds, {},
                                    end_of_direct(surface, light));
    }

    RoughVisit rough_visit(const Surface& surface) const {
        const bool possible = settings.manifold.enabled && !world.rough_chain_casters.empty() &&
                              scene().instances[surface.hit.instance].rough_caster;
        return {possible ? history.chain_so_far() : nullptr, surface.hit, surface.closures,
                surface.ng, surface.wo};
    }

    LightEnd end_of_direct(const Surface& surface, const DirectSample& light) const {
        LightEnd end =
            light_end(light_point_of(world.lights, scene(), surface.p, light), light.wi * -1.0f);
        end.pdf_direct = light.density;
        return end;
    }

    // Whether light paths may find light that comes to the surface, as a rough caster throws it on.
    bool throws_on(const Surface& surface, const CameraApproach& approach) const {
        if (!scene().instances[surface.hit.instance].rough_caster) return false;
        CausticPath path;
        path.rough_caster = true;
        path.approach = approach.bounces;
        path.film_per_area = approach.film_per_area;
        return light_tracing_owns(techniques_of(world, settings), path);
    }

    float weight_of_direct(const Surface& surface, const CameraApproach& approach,
                           const DirectSample& light, const ClosureEval& f) const {
        if (throws_on(surface, approach)) {
            const LightEnd end = end_of_direct(surface, light);
            CausticPath path = caustic_path(scene(), receiver_at(surface, approach), f, light.wi);
            path.rough_caster = true;
            if (const std::optional<CausticDensities> p = shared_with_light_paths(path, end))
                return static_cast<float>(p->direct / p->sum());
        }
        return light.delta ? 1.0f : shared(light.density, f.pdf_omega);
    }

    // The same for closures with glints, averaged over the pixel. Throughput included.
    Spectrum glint_radiance(const Surface& surface, const Sampler& sampler) {
        // After a rough bounce the noise is the path's, which no further estimates take away.
        const uint32_t estimates = differential->lobe ? 1 : pass.glints.estimates;
        Spectrum sum(0.0f);
        for (uint32_t i = 0; i < estimates; ++i) sum += glint_estimate(surface, sampler, i);
        return sum * (1.0f / static_cast<float>(estimates));
    }

    // To look for glints costs more than to draw lights: of several the one is taken that promises
    // most, by the moments of the slopes (resampled importance sampling [Talbot05]). All of a
    // sample's estimates together are points of a lattice, so that none of a few small lamps is left
    // out by chance.
    Spectrum glint_estimate(const Surface& surface, const Sampler& sampler, uint32_t estimate) {
        constexpr float kPoints = 6.0f;
        struct Candidate {
            DirectSample light;
            float share, promise;
        };
        std::optional<Candidate> chosen;
        float sum = 0.0f, earliest = kInfinity;
        const Vec3 first = sampler.vertex(0)[Domain::glints].three();
        const uint32_t begin = estimate * kGlintCandidates;
        for (uint32_t i = begin; i < begin + kGlintCandidates; ++i) {
            const std::optional<DirectSample> light =
                sample_direct(world.lights, scene(), surface.p, lattice_point(first, i));
            if (!light || !(dot(surface.ng, light->wi) > 0.0f)) continue;
            const uint32_t visibility = light_visibility(world.lights, light->light);
            if ((visibility & kVisibleGlossy) == 0) continue;
            const GlintDensity density = glints->density(light->wi);
            const bool alone = light->delta || (visibility & kVisibleShadow) == 0;
            const float share = alone ? 1.0f : shared_by_glints(light->density, density);
            const float promise = max_component(light->radiance) * share * density.mean;
            const float weight = promise / light->density;
            if (!(weight > 0.0f)) continue;
            sum += weight;
            // The first to come at rates in proportion to weights. In an animation, whose weights
            // change little by little, that is rarely another one in the next frame.
            const float u = sampler.vertex(i + 1)[Domain::glints].one();
            const float arrival = -std::log1p(-u) / weight;
            if (arrival < earliest) {
                earliest = arrival;
                chosen = Candidate{*light, share, promise};
            }
        }
        if (!chosen) return Spectrum(0.0f);
        const DirectSample& light = chosen->light;
        Spectrum arriving = throughput * light.radiance *
                            (chosen->share * sum / (kGlintCandidates * chosen->promise));
        if ((light_visibility(world.lights, light.light) & kVisibleShadow) != 0)
            arriving *= unblocked(surface, light);
        if (is_black(arriving)) return arriving;
        // The mean of several may be as noisy as one.
        const float faint =
            static_cast<float>(pass.glints.estimates) * pass.glints.faint / max_component(arriving);
        return arriving * glints->f_cos(light.wi, {kPoints * chosen->share, faint},
                                        sampler[Domain::glints].stream_seed() + estimate,
                                        stats.glints);
    }

    // Whether rough chains may find light that comes to the surface and is reflected.
    bool turns_rough_chain(const Surface& surface) const {
        return rough_visit(surface).before != nullptr &&
               rough_vertex(techniques_of(world, settings), surface.hit, surface.ng, surface.ng);
    }

    // Whether the surface is looked at through the path's footprint. Not where its direct light is
    // shared with light paths or rough chains, by densities for the normal of one point: those find
    // narrow lobes better.
    void look_for_glints(const Hit& hit, Surface& surface, const CameraApproach& approach,
                         const PixelKernel* pixel) {
        glints.reset();
        if (!differential || surface.closures.glint_count == 0) return;
        if (throws_on(surface, approach) || turns_rough_chain(surface)) return;
        glints = GlintPoint::at(world.glints, settings.glints, scene(), surface, *differential,
                                static_cast<double>(hit.t), *pixel);
        surface.closures.glints_apart = glints.has_value();
    }

    Spectrum unblocked(const Surface& surface, const DirectSample& light) {
        const bool distant = std::isinf(light.distance);
        const ChainEnd end{distant, distant ? Vec3(0.0f) : surface.p + light.wi * light.distance,
                           light.wi, light.margin};
        uint32_t transparent_left = bounces.transparent_left(settings.limits);
        Media along = media;
        if (dot(surface.ng, light.wi) < 0.0f) along.cross(scene(), surface.hit, light.wi);
        return transmittance(scene(), {surface.p, surface.ng, surface.p_error}, end, kVisibleShadow,
                             transparent_left, along, stats.rays);
    }

    bool may_receive(const Surface& surface) const {
        return shares() && has_chain_casters() && has_smooth_closure(surface.closures) &&
               scene().instances[surface.hit.instance].receiver &&
               bounces.leaves_room_for_chain(settings.limits);
    }

    CameraApproach approach_to(const Surface& surface) const {
        if (settings.light_tracing.guide == nullptr) return {};
        if (bounces.total > 0) return history.approach_to(scene(), settings.limits, surface);
        const std::optional<CameraView> view = scene().camera.view(surface.p, lens);
        if (!view) return {};
        return {view->film_per_area * std::abs(dot(surface.ng, surface.wo))};
    }

    Receiver receiver_at(const Surface& surface, const CameraApproach& approach) const {
        return {surface.p,
                surface.p_error,
                surface.ng,
                surface.wo,
                &surface.closures,
                bounces.transparent_left(settings.limits),
                &media,
                surface.hit,
                approach,
                bounces,
                0.0f,
                rough_visit(surface).before,
                folds_here.empty() ? nullptr : &folds_here};
    }

    // Before receiver_at(). Where the camera comes as light paths do, those find what is next to folds.
    void look_for_folds(const Surface& surface, const CameraApproach& approach, bool receives) {
        const bool draws =
            receives && !(approach.film_per_area > 0.0f) && !rough_visit(surface).before;
        folds_here = draws ? FoldDirections(pass.sheets, surface.p) : FoldDirections();
    }

    // Of chains of deltas, and of those with rough vertices. Throughput included.
    Spectrum caustic_radiance(const Surface& surface, const CameraApproach& approach,
                              const Sampler& sampler) {
        Spectrum sum(0.0f);
        const size_t depth = receiver_depth(bounces.total);
        const Techniques techniques = techniques_of(world, settings);
        if (!world.casters.empty())
            sum += estimate(surface, approach, depth, sampler[Domain::manifold_activation].one(),
                            [&](const Receiver& receiver, bool draws) {
                                ManifoldRadiance result =
                                    manifold_radiance(techniques, receiver, pass.sheets, draws,
                                                      sampler, stats.manifold);
                                add_folds(surface, sampler[Domain::folds], result);
                                return result;
                            });
        if (may_begin_rough_chain(surface, approach))
            sum += estimate(
                surface, approach, kReceiverDepths + depth,
                sampler[Domain::rough_chain_activation].one(), [&](const Receiver& receiver, bool) {
                    return ManifoldRadiance{
                        Spectrum(0.0f),
                        rough_chain_radiance(techniques, receiver, sampler, stats.manifold)};
                });
        return sum;
    }

    // Of chains of deltas, by a direction next to folds.
    void add_folds(const Surface& surface, const Sampler& sampler, ManifoldRadiance& to) const {
        if (folds_here.empty()) return;
        const std::optional<Vec3> w = folds_here.sample(sampler.three());
        const float pdf = w ? folds_here.pdf(*w) : 0.0f;
        if (!(pdf > 0.0f)) return;
        const ClosureEval f = eval(surface.closures, surface.ng, surface.wo, *w);
        if (is_black(f.f_cos)) return;
        PathTracer path{world, settings, pass, stats, pcg, lens, ray, media};
        path.throughput = f.f_cos * (1.0f / pdf);
        path.bounces = bounces;
        path.from_folds = true;
        ClosureSample next{};
        next.wi = *w;
        next.pdf_omega = f.pdf_omega;
        next.kind = BounceKind::diffuse;
        path.history.append_smooth(scene(), surface, next, true, {}, bounces);
        path.history.keep(surface, {});
        path.history.caustic.folds = &folds_here;
        path.leave(surface, next);
        const uint64_t rays_before = stats.rays;
        to.led += path.light_behind_deltas(sampler);
        const uint64_t rays = std::exchange(stats.rays, rays_before) - rays_before;
        stats.manifold.rays += rays;
        to.work_of_leads += rays;
    }

    // Throughput included.
    Spectrum light_behind_deltas(const Sampler& sampler) {
        Spectrum sum(0.0f);
        Surface surface;
        for (uint32_t vertex = 0;; ++vertex) {
            const std::optional<Hit> hit = go_to_surface(surface, sum);
            if (!hit) return sum;
            const std::optional<ClosureSample> next =
                sample(surface.closures, surface.ng, surface.wo,
                       sampler.vertex(vertex)[Domain::closure].three());
            if (!next) return sum;
            throughput *= next->weight;
            if (next->kind == BounceKind::transparent) {
                if (!look_through(*hit)) return sum;
                continue;
            }
            if (!next->delta || history.caustic.count == settings.manifold.longest_chain)
                return sum;
            bounces.add(next->kind);
            history.append_delta(surface.hit, *next, world.casters);
            if (history.stage != PathHistory::Stage::chain) return sum;
            leave(surface, *next);
        }
    }

    // See CausticPath::begins_rough. Where the camera comes as light paths do, they find them.
    bool may_begin_rough_chain(const Surface& surface, const CameraApproach& approach) const {
        return !world.rough_chain_casters.empty() && !(approach.film_per_area > 0.0f) &&
               settings.manifold.finder != ChainFinder::mnee &&
               !(history.has_scattered() && scene().instances[surface.hit.instance].rough_caster);
    }

    // Of what chains bring, that the manifold counts; those that light paths rarely meet bring all.
    float share_beside_light_paths(const CameraApproach& approach) const {
        constexpr double kLeast = 1.0 / 16;
        return approach.film_per_area > 0.0f
                   ? static_cast<float>(std::max(settings.light_tracing.manifold_share, kLeast))
                   : 1.0f;
    }

    // Of kind `i` of Activation; `u` decides whether it has what is left to chance. Throughput
    // included.
    template <class Estimate>
    Spectrum estimate(const Surface& surface, const CameraApproach& approach, size_t i, float u,
                      const Estimate& radiance) {
        const float chance = pass.activation[i];
        const bool draws = u < chance;
        const bool is_led = chance > 0.0f && i < kReceiverDepths && !pass.sheets.all.empty();
        if (!draws && !is_led) return Spectrum(0.0f);
        ManifoldStats& counts = stats.manifold;
        const ManifoldStats before = counts;
        Receiver receiver = receiver_at(surface, approach);
        receiver.importance = max_component(throughput) * smooth_albedo(surface.closures) *
                              share_beside_light_paths(approach) / kPi;
        const ManifoldRadiance found = radiance(receiver, draws);
        const Spectrum drawn = throughput * found.drawn * (1.0f / chance);
        const double squares = static_cast<double>(dot(drawn, drawn) * (1.0f / 3.0f));
        const auto work = static_cast<double>(counts.work() - before.work() - found.work_of_leads);
        stats.evidence[i].add(
            {squares * static_cast<double>(chance), work / static_cast<double>(chance)});
        stats.work_of_leads += found.work_of_leads;
        if (counts.capped > before.capped)
            counts.capped_energy += static_cast<double>(luminance(drawn));
        return throughput * found.led + drawn;
    }

    // ---- going on; each tells whether the path does

    bool look_through(const Hit& hit) {
        if (bounces.transparent_left(settings.limits) == 0) return false;
        bounces.add(BounceKind::transparent);
        history.append_transparent(scene().instances[hit.surface.instance]);
        media.cross(scene(), hit.surface, ray.direction);
        ray.t_near = past(hit.t);
        return true;
    }

    // A path at its limit has one ray more, for the lights: its last vertex had its direct light
    // through whatever is transparent, so must this ray.
    bool look_for_lights_behind(const Hit& hit, const Surface& surface) {
        throughput *= surface.closures.transparency;
        return !is_black(throughput) && look_through(hit);
    }

    bool scatter(const Hit& hit, const Surface& surface, const ClosureSample& next, bool receives,
                 const CameraApproach& approach, const Sampler& sampler) {
        throughput *= next.weight;
        if (!survive_roulette(sampler)) return false;
        if (next.kind == BounceKind::transparent) return look_through(hit);
        const BounceCounts before = bounces;
        bounces.add(next.kind);
        if (differential &&
            !pass_bounce(scene(), surface, next, static_cast<double>(hit.t), *differential))
            differential.reset();
        if (!next.delta) {
            history.append_rough(rough_vertex_at(surface, next));
            history.append_smooth(scene(), surface, next, receives, approach, before);
            if (shares()) history.keep(surface, approach);
            if (next.glints) history.set_glints(glints->density(next.wi));
            std::swap(folds_at_x, folds_here);
            if (!folds_at_x.empty()) history.caustic.folds = &folds_at_x;
        } else {
            history.append_delta(surface.hit, next, world.casters);
        }
        leave(surface, next);
        return true;
    }

    void leave(const Surface& surface, const ClosureSample& next) {
        ray_kind = ray_kind_after(next.kind);
        from = surface.p;
        if (dot(surface.ng, next.wi) < 0.0f) media.cross(scene(), surface.hit, next.wi);
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next.wi), next.wi, 0.0f,
               kInfinity};
    }

    // Ends paths of little throughput without bias; the root keeps them alive longer than the
    // throughput itself would, for the light that waits behind dark surfaces.
    bool survive_roulette(const Sampler& sampler) {
        const float q = std::min(1.0f, std::sqrt(max_component(throughput)));
        if (q >= 1.0f) return true;
        if (sampler[Domain::roulette].one() >= q) return false;
        throughput *= 1.0f / q;
        return true;
    }

    // A scattering that a chain may go on with.
    std::optional<CausticVertex> rough_vertex_at(const Surface& surface,
                                                 const ClosureSample& next) const {
        if (next.kind == BounceKind::diffuse || next.glints ||
            rough_visit(surface).before == nullptr)
            return std::nullopt;
        return rough_vertex(techniques_of(world, settings), surface.hit, surface.ng, next.wi);
    }
};

}  // namespace

RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads) {
    RenderScene world;
    world.lights = build_lights(*scene, threads);
    world.casters = build_casters(*scene);
    world.rough_chain_casters = build_rough_chain_casters(*scene, scene->report);
    world.glints = build_glints(*scene, threads, scene->report);
    world.scene = std::move(scene);
    return world;
}

// L(x0, w0) = sum over path vertices of throughput x (emission + direct + manifold). Each path is
// owned by one estimator or shared by several with weights that sum to one: manifold/ownership.h
// says which.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const PassState& pass, const Ray& camera_ray, const Vec2& lens,
                         const Sampler& sampler, PathStats& stats, const PixelKernel* pixel) {
    const Vec3 start = camera_ray.origin + camera_ray.direction * camera_ray.t_near;
    Pcg pcg(sampler[Domain::missed_chains].stream_seed());
    PathTracer path{world, settings, pass,       stats,
                    pcg,   lens,     camera_ray, media_at(*world.scene, start, stats.rays)};
    if (pixel != nullptr && !world.glints.fields.empty())
        path.differential =
            camera_differential(world.scene->camera, *pixel, lens, camera_ray.direction);
    if (settings.highlights != nullptr)
        path.history.begin_at_camera(world.scene->camera, camera_ray);
    PathSample out;
    Surface surface;
    for (uint32_t vertex = 0;; ++vertex) {
        const std::optional<Hit> hit = path.go_to_surface(surface, out.radiance);
        if (!hit) {
            const Spectrum& t = path.throughput;
            if (settings.transparent_film && path.ray_kind == kVisibleCamera)
                out.alpha = 1.0f - (t.x + t.y + t.z) / 3.0f;
            break;
        }
        if (path.bounces.exhausted(settings.limits)) {
            if (path.look_for_lights_behind(*hit, surface)) continue;
            break;
        }

        const Sampler here = sampler.vertex(vertex);
        const CameraApproach approach = path.approach_to(surface);
        const bool receives = path.may_receive(surface);
        path.look_for_glints(*hit, surface, approach, pixel);
        path.look_for_folds(surface, approach, receives && settings.manifold.enabled);
        out.radiance += path.throughput * path.direct_radiance(surface, approach, here);
        if (path.glints) out.radiance += path.glint_radiance(surface, here);
        if (receives && settings.manifold.enabled) {
            const Spectrum caustic = path.caustic_radiance(surface, approach, here);
            out.radiance += caustic;
            out.caustics += caustic;
        }

        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo, here[Domain::closure].three());
        if (!out.hit && !(next && next->kind == BounceKind::transparent)) {
            out.hit = true;
            out.position = surface.p;
            out.normal = surface.n;
        }
        if (!next || !path.scatter(*hit, surface, *next, receives, approach, here)) break;
    }
    return out;
}

}  // namespace spc
