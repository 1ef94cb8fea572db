// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path_tracer.h"

#include <utility>

namespace spc {

bool PathTracer::may_receive(const Surface& surface) const {
    return shares() && has_chain_casters() && has_smooth_closure(surface.closures) &&
           scene().instances[surface.hit.instance].receiver &&
           bounces.leaves_room_for_chain(settings.limits);
}

void PathTracer::look_for_folds(const Surface& surface, const CameraSubpath& camera_subpath,
                                bool receives) {
    const bool draws =
        receives && !(camera_subpath.film_density > 0.0f) && !rough_visit(surface).before;
    folds_here = draws ? FoldDirections(round.sheets, surface.p) : FoldDirections();
}

template <class Estimate>
Spectrum PathTracer::estimate(const Surface& surface, const CameraSubpath& camera_subpath, size_t i,
                              float u, const Estimate& radiance, PathLight& light) {
    if (settings.light_tracing.alone && camera_subpath.film_density > 0.0f) return Spectrum(0.0f);
    const float activation = round.activation[i];
    const float probability =
        activation * static_cast<float>(walk_probability(techniques_of(world, settings),
                                                         camera_subpath.film_density));
    const bool draws = u < probability;
    const bool is_seeded = probability > 0.0f && i < kReceiverDepths && !round.sheets.all.empty();
    if (!draws && !is_seeded) return Spectrum(0.0f);
    ManifoldStats& counts = stats.manifold;
    const ManifoldStats before = counts;
    Receiver receiver = receiver_at(surface, camera_subpath);
    receiver.importance = max_component(throughput) * smooth_albedo(surface.closures) *
                          share_beside_light_paths(camera_subpath) / kPi;
    std::vector<ReceivedLight> received;
    if (light.values != nullptr) receiver.received = &received;
    const ManifoldRadiance found = radiance(receiver, draws);
    const Spectrum drawn = throughput * found.drawn * (1.0f / probability);
    const double squares = static_cast<double>(dot(drawn, drawn) * (1.0f / 3.0f));
    const auto work = static_cast<double>(counts.work() - before.work() - found.seed_work);
    stats.evidence[i].add(
        {squares * static_cast<double>(activation), work / static_cast<double>(activation)});
    stats.seed_work += found.seed_work;
    if (counts.capped > before.capped)
        counts.capped_energy += static_cast<double>(luminance(drawn));
    for (const ReceivedLight& one : received)
        tell_scattered(throughput * one.radiance * (one.drawn ? 1.0f / probability : 1.0f), surface,
                       one.wi, one.light, *light.values, false);
    const Spectrum sum = throughput * found.seeded + drawn;
    light.total += sum;
    return sum;
}

Spectrum PathTracer::add_caustics(const Surface& surface, const CameraSubpath& camera_subpath,
                                  const Sampler& sampler, PathLight& light) {
    Spectrum sum(0.0f);
    const size_t depth = receiver_depth(bounces.total);
    const Techniques techniques = techniques_of(world, settings);
    if (!techniques.casters.empty())
        sum += estimate(
            surface, camera_subpath, depth, sampler[Domain::manifold_activation].one(),
            [&](const Receiver& receiver, bool draws) {
                ManifoldRadiance result = manifold_radiance(techniques, receiver, round.sheets,
                                                            draws, sampler, stats.manifold);
                add_folds(surface, sampler[Domain::folds], result, light);
                return result;
            },
            light);
    if (may_begin_rough_chain(surface, camera_subpath))
        sum += estimate(
            surface, camera_subpath, kReceiverDepths + depth,
            sampler[Domain::rough_chain_activation].one(),
            [&](const Receiver& receiver, bool) {
                return ManifoldRadiance{
                    Spectrum(0.0f),
                    rough_chain_radiance(techniques, receiver, sampler, stats.manifold)};
            },
            light);
    return sum;
}

Receiver PathTracer::receiver_at(const Surface& surface, const CameraSubpath& camera_subpath) const {
    return {surface.p,
            surface.p_error,
            surface.ng,
            surface.wo,
            &surface.closures,
            bounces.transparent_left(settings.limits),
            &media,
            surface.hit,
            camera_subpath,
            bounces,
            0.0f,
            rough_visit(surface).before,
            folds_here.empty() ? nullptr : &folds_here};
}

bool PathTracer::may_begin_rough_chain(const Surface& surface,
                                       const CameraSubpath& camera_subpath) const {
    return !world.rough_chain_casters.empty() && !(camera_subpath.film_density > 0.0f) &&
           settings.manifold.finder != ChainFinder::mnee &&
           !(history.has_scattered() && scene().instances[surface.hit.instance].rough_caster);
}

float PathTracer::share_beside_light_paths(const CameraSubpath& camera_subpath) const {
    constexpr double kLeast = 1.0 / 16;
    return camera_subpath.film_density > 0.0f
               ? static_cast<float>(std::max(settings.light_tracing.manifold_share, kLeast))
               : 1.0f;
}

void PathTracer::add_folds(const Surface& surface, const Sampler& sampler, ManifoldRadiance& to,
                           const PathLight& light) const {
    if (folds_here.empty()) return;
    const std::optional<Vec3> w = folds_here.sample(sampler.three());
    const float pdf = w ? folds_here.pdf(*w) : 0.0f;
    if (!(pdf > 0.0f)) return;
    const ClosureEval f = eval(surface.closures, surface.ng, surface.wo, *w);
    if (is_black(f.f_cos)) return;
    PathTracer path{world, settings, round, stats, pcg, lens, ray, media};
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
    path.spawn_ray(surface, next);
    path.lobes = lobes;
    PathLight found{.values = light.values, .scale = throughput};
    if (found.values != nullptr && bounces.total == 0) path.lobes = lobe_shares(surface, *w);
    const uint64_t rays_before = stats.rays;
    path.add_light_behind_deltas(sampler, found);
    to.seeded += found.total;
    const uint64_t rays = std::exchange(stats.rays, rays_before) - rays_before;
    stats.manifold.rays += rays;
    to.seed_work += rays;
}

void PathTracer::add_light_behind_deltas(const Sampler& sampler, PathLight& light) {
    Surface surface;
    for (uint32_t vertex = 0;; ++vertex) {
        const std::optional<Hit> hit = go_to_surface(surface, light);
        if (!hit) return;
        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo,
                   sampler.vertex(vertex)[Domain::closure].three());
        if (!next || next->below != nullptr) return;
        throughput *= next->weight;
        if (next->kind == BounceKind::transparent) {
            if (!look_through(*hit)) return;
            continue;
        }
        if (!next->delta || history.caustic.count == settings.manifold.longest_chain) return;
        bounces.add(next->kind);
        history.append_delta(surface.hit, *next, world.casters);
        if (history.stage != PathHistory::Stage::chain) return;
        spawn_ray(surface, *next);
        add_shadow_linked(surface, light);
    }
}

}  // namespace spc
