// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/cancellation.h"
#include "integrator/path_tracer.h"
#include "integrator/subsurface.h"

namespace spc {

std::optional<Hit> PathTracer::go_to_surface(Surface& surface, PathLight& light) {
    for (;;) {
        const std::optional<Hit> hit = intersect();
        if (!hit) {
            const bool shows_film = settings.transparent_film && sees_film;
            go_towards(ray.direction);
            if (!shows_film) add_from_afar(light);
            return hit;
        }
        if (hit->light == kNone) {
            in_hole = is_held_out(*hit);
            if (in_hole) return std::nullopt;
            evaluate(*hit, surface);
            come_to(surface.p);
            if (meets(scene().instances[hit->surface.instance].links))
                add_met(throughput * emission_of_surface(*hit, surface), Pass::emission,
                        settings.group_of_instance(hit->surface.instance), light);
            return hit;
        }
        // Lamps are looked through, as in Cycles.
        come_to(ray.origin + ray.direction * hit->t);
        if (meets(world.lights.links[hit->light]))
            add_met(throughput * emission_of_lamp(*hit), Pass::emission,
                    settings.group_of_light(hit->light), light);
        ray.t_near = past(hit->t);
    }
}

CameraSubpath PathTracer::camera_subpath_to(const Surface& surface) const {
    if (settings.light_tracing.guide == nullptr) return {};
    if (bounces.total > 0) return history.camera_subpath_to(scene(), settings.limits, surface);
    const std::optional<CameraView> view = scene().camera.view(surface.p, lens);
    if (!view) return {};
    return {view->film_density * std::abs(dot(surface.ng, surface.wo))};
}

PathTracer::Onward PathTracer::shade(const Hit& hit, Surface& surface, const Sampler& here,
                                     const PixelKernel* pixel, PathLight& light, PathSample& out) {
    const CameraSubpath camera_subpath = camera_subpath_to(surface);
    const bool receives = may_receive(surface);
    look_for_glints(hit, surface, camera_subpath, pixel);
    look_for_folds(surface, camera_subpath, receives && settings.manifold.enabled);
    add_direct(surface, camera_subpath, here, light);
    if (glints) add_glints(surface, here, light);
    if (receives && settings.manifold.enabled)
        out.caustics += add_caustics(surface, camera_subpath, here, light);
    return {sample(surface.closures, surface.ng, surface.wo, here[Domain::closure].three()),
            receives, camera_subpath};
}

// Light paths do not walk below surfaces: the path begins anew, as one that path tracing alone
// finds until it scatters.
bool PathTracer::go_below(Surface& surface, const ClosureSample& entry, const Sampler& here) {
    Pcg walk(here[Domain::subsurface].stream_seed());
    const std::optional<SubsurfaceExit> exit =
        walk_below(scene(), surface, *entry.below, walk, stats.rays);
    if (!exit) return false;
    throughput *= entry.weight * exit->weight;
    surface = exit->surface;
    history = {};
    differential.reset();
    return true;
}

bool PathTracer::scatter(const Hit& hit, const Surface& surface, const ClosureSample& next,
                         bool receives, const CameraSubpath& camera_subpath, const Sampler& sampler,
                         PathLight& light) {
    throughput *= next.weight;
    if (!survive_roulette(sampler)) return false;
    if (next.kind == BounceKind::transparent) return look_through(hit);
    if (bounces.total == 0) lobes = only(lobe_of(next.kind));
    writes_aovs = false;
    const BounceCounts before = bounces;
    bounces.add(next.kind);
    sees_film = sees_film && lets_film_through(next);
    if (differential && !propagate_through_bounce(scene(), surface, next,
                                                  static_cast<double>(hit.t), *differential))
        differential.reset();
    if (!next.delta) {
        history.append_rough(rough_vertex_at(surface, next));
        history.append_smooth(scene(), surface, next, receives, camera_subpath, before);
        if (shares()) history.keep(surface, camera_subpath);
        if (next.glints) history.set_glints(glints->density(next.wi));
        std::swap(folds_at_x, folds_here);
        if (!folds_at_x.empty()) history.caustic.folds = &folds_at_x;
    } else {
        history.append_delta(surface.hit, next, world.casters);
    }
    spawn_ray(surface, next);
    add_shadow_linked(surface, light);
    return true;
}

// A path at its limit has one ray more, for the lights: its last vertex had its direct light
// through whatever is transparent, so must this ray.
bool PathTracer::look_for_lights_behind(const Hit& hit, const Surface& surface) {
    throughput *= surface.closures.transparency;
    return !is_black(throughput) && look_through(hit);
}

std::optional<Hit> PathTracer::intersect() {
    ++stats.rays;
    const std::optional<Hit> hit = scene().accel->intersect(ray, ray_kind);
    throughput *= media.transmittance(hit ? hit->t - ray.t_near : kInfinity);
    return hit;
}

void PathTracer::evaluate(const Hit& hit, Surface& surface) const {
    evaluate_surface(scene(), hit.surface, ray.direction * -1.0f, surface, seen_by(hit.t));
    const Vec3 back = from - surface.p;
    if (dot(back, surface.ng) > 0.0f) surface.wo = normalize(back);
    const ManifoldSettings& caustics = settings.manifold;
    if (ray_kind == kVisibleDiffuse && !(caustics.reflections && caustics.refractions))
        drop_caustics(surface.closures, caustics.reflections, caustics.refractions);
}

bool PathTracer::look_through(const Hit& hit) {
    if (bounces.transparent_left(settings.limits) == 0) return false;
    bounces.add(BounceKind::transparent);
    history.append_transparent(scene().instances[hit.surface.instance]);
    media.cross(scene(), hit.surface, ray.direction);
    ray.t_near = past(hit.t);
    return true;
}

void PathTracer::spawn_ray(const Surface& surface, const ClosureSample& next) {
    ray_kind = ray_kind_after(next.kind);
    scattered_by = &scene().instances[surface.hit.instance];
    ray_begins = 0.0f;
    ray_kinds = (next.kind == BounceKind::diffuse ? kRayDiffuse : kRayGlossy) |
                (next.kind == BounceKind::transmission ? kRayTransmission : kRayReflection) |
                (next.delta ? kRaySingular : 0u);
    from = surface.p;
    if (dot(surface.ng, next.wi) < 0.0f) media.cross(scene(), surface.hit, next.wi);
    ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next.wi), next.wi, 0.0f,
           kInfinity};
}

// Ends paths of little throughput without bias; the root keeps them alive longer than the
// throughput itself would, for the light that waits behind dark surfaces. Most of a picture comes
// by the first bounces, whose directions are stratified: chance would undo that.
bool PathTracer::survive_roulette(const Sampler& sampler) {
    constexpr uint32_t kSureBounces = 2;
    if (bounces.total < kSureBounces) return true;
    const float q = std::min(1.0f, std::sqrt(max_component(throughput)));
    if (q >= 1.0f) return true;
    if (sampler[Domain::roulette].one() >= q) return false;
    throughput *= 1.0f / q;
    return true;
}

std::optional<CausticVertex> PathTracer::rough_vertex_at(const Surface& surface,
                                                         const ClosureSample& next) const {
    if (!next.facets || next.glints || rough_visit(surface).before == nullptr) return std::nullopt;
    return rough_vertex(techniques_of(world, settings), surface.hit, surface.ng, next.wi);
}

RoughVisit PathTracer::rough_visit(const Surface& surface) const {
    const bool possible = settings.manifold.enabled && !world.rough_chain_casters.empty() &&
                          scene().instances[surface.hit.instance].rough_caster;
    return {possible ? history.chain_so_far() : nullptr, surface.hit, surface.closures, surface.ng,
            surface.wo};
}

RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads, const RenderScene* before) {
    RenderScene world;
    Cancellable::check();
    world.lights = build_lights(*scene, threads, before != nullptr ? &before->lights : nullptr);
    Cancellable::check();
    world.casters = build_casters(*scene);
    world.rough_chain_casters = build_rough_chain_casters(*scene, scene->report);
    Cancellable::check();
    world.glints =
        build_glints(*scene, threads, before != nullptr ? &before->glints : nullptr, scene->report);
    world.scene = std::move(scene);
    return world;
}

// L(x0, w0) = sum over path vertices of throughput x (emission + direct + manifold). Each path is
// owned by one estimator or shared by several with weights that sum to one: manifold/ownership.h
// says which.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const RoundState& round, const Ray& camera_ray, const Vec2& lens,
                         const Sampler& sampler, PathStats& stats, const PixelKernel* pixel,
                         PassValues* values) {
    const Vec3 start = camera_ray.origin + camera_ray.direction * camera_ray.t_near;
    Pcg pcg(sampler[Domain::missed_chains].stream_seed());
    PathTracer path{world, settings, round,      stats,
                    pcg,   lens,     camera_ray, media_at(*world.scene, start, stats.rays)};
    if (pixel != nullptr && !world.glints.fields.empty())
        path.differential =
            camera_differential(world.scene->camera, *pixel, lens, camera_ray.direction);
    if (settings.camera_chains != nullptr)
        path.history.begin_at_camera(world.scene->camera, camera_ray);
    PathSample out;
    PathLight light;
    if (values != nullptr && values->asked().tell_light()) light.values = values;
    path.writes_aovs = values != nullptr && values->asked().tell_aovs();
    std::optional<Features> features;
    if (values != nullptr && values->asked().tell_features()) features.emplace();
    Surface surface;
    for (uint32_t vertex = 0;; ++vertex) {
        const std::optional<Hit> hit = path.go_to_surface(surface, light);
        if (!hit) {
            const Spectrum& t = path.throughput;
            if (path.in_hole || (settings.transparent_film && path.sees_film)) out.alpha -= mean(t);
            if (features && !path.in_hole) features->look_at_world(path.world_seen(), *values);
            if (path.writes_aovs && !path.in_hole) path.tell_aovs_of_world(*values);
            break;
        }
        if (path.sees_film) out.alpha -= mean(path.throughput * surface.closures.holdout);
        if (values != nullptr && path.bounces.total == 0) path.tell_surface(surface, *values);
        if (path.writes_aovs) path.tell_aovs(surface, hit->t, *values);
        const float length = hit->t - path.ray_begins;
        if (features && features->look(*world.scene, surface, length, *values)) features.reset();
        if (path.bounces.exhausted(settings.limits)) {
            if (path.look_for_lights_behind(*hit, surface)) continue;
            break;
        }

        const Sampler here = sampler.vertex(vertex);
        PathTracer::Onward on = path.shade(*hit, surface, here, pixel, light, out);
        if (!out.hit && !(on.next && on.next->kind == BounceKind::transparent)) {
            out.hit = true;
            out.surface = surface.hit;
            out.position = surface.p;
            out.normal = surface.n;
        }
        if (on.next && on.next->below != nullptr) {
            if (!path.go_below(surface, *on.next, here)) break;
            on = path.shade(*hit, surface, here, pixel, light, out);
        }
        if (!on.next ||
            !path.scatter(*hit, surface, *on.next, on.receives, on.camera_subpath, here, light))
            break;
        if (features) features->scatter(*on.next);
    }
    out.radiance = light.total;
    out.alpha = std::max(out.alpha, 0.0f);  // a mean of ones may be rounded to more than one
    return out;
}

}  // namespace spc
