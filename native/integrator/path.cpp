// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path.h"

#include "integrator/history.h"

namespace spc {

namespace {

// Everything that the steps of one path share.
struct PathTracer {
    const RenderScene& world;
    const IntegratorSettings& settings;
    PathStats& stats;
    PathHistory history;
    BounceCounts bounces;
    uint32_t ray_kind = kVisibleCamera;

    const Scene& scene() const { return *world.scene; }

    // ---- light that the path runs into. Each is weighed against the estimator that could have
    // connected to it.

    float weight_of(float pdf_direct, float pdf_light_point, const ChainEnd& end, float cos_y) const {
        switch (history.stage) {
            case PathHistory::Stage::unconnected: return 1.0f;
            case PathHistory::Stage::scattered:
                return history.pdf_omega / (history.pdf_omega + pdf_direct);
            case PathHistory::Stage::chain:
                return path_tracing_share(scene(), world.casters, history.x, history.ng,
                                          history.pdf_omega, history.vertex, history.interaction,
                                          history.lobe_probability, end, cos_y, pdf_light_point);
        }
        return 1.0f;
    }

    // The world and every sun with a disc, in the direction of a ray that leaves the scene.
    Spectrum emission_from_afar(const Vec3& direction) const {
        Spectrum sum = emission_of_world(direction);
        for (const uint32_t sun : world.lights.disc_suns) {
            if ((light_visibility(world.lights, sun) & ray_kind) == 0) continue;
            const Spectrum radiance =
                lamp_radiance(world.lights.lamps[sun], Vec3(0.0f), direction * -1.0f);
            if (is_black(radiance)) continue;
            sum += radiance * weight_of(pdf_direct_sun(world.lights, sun, direction),
                                        pdf_light_point_sun(world.lights, sun, direction),
                                        {true, Vec3(0.0f), direction}, 1.0f);
        }
        return sum;
    }

    Spectrum emission_of_world(const Vec3& direction) const {
        if (!world.lights.has_world || (scene().environment.visibility & ray_kind) == 0)
            return Spectrum(0.0f);
        const Spectrum radiance = world_radiance(world.lights, scene(), direction);
        if (is_black(radiance)) return radiance;
        const bool scattered = history.stage == PathHistory::Stage::scattered;
        const bool chain = history.stage == PathHistory::Stage::chain;
        return radiance *
               weight_of(scattered ? pdf_direct_world(world.lights, scene(), direction) : 0.0f,
                         chain ? pdf_light_point_world(world.lights, scene(), direction) : 0.0f,
                         {true, Vec3(0.0f), direction}, 1.0f);
    }

    Spectrum emission_of_lamp(const Ray& ray, const Hit& hit) const {
        const Vec3 p = ray.origin + ray.direction * hit.t;
        const Spectrum radiance =
            lamp_radiance(world.lights.lamps[hit.light], p, ray.direction * -1.0f);
        if (is_black(radiance)) return radiance;
        float pdf_direct = 0.0f, pdf_point = 0.0f, cos_y = 0.0f;
        if (history.stage == PathHistory::Stage::scattered)
            pdf_direct = pdf_direct_lamp(world.lights, scene(), history.x, ray.direction, hit);
        if (history.stage == PathHistory::Stage::chain) {
            const LightDesc& lamp = scene().lights[hit.light];
            const Vec3 n =
                lamp.type == LightType::area ? lamp.axis() : normalize(p - lamp.position());
            cos_y = -dot(n, ray.direction);
            // The manifold sees lamps from outside alone.
            if (cos_y > 0.0f) pdf_point = pdf_light_point_lamp(world.lights, scene(), hit);
        }
        return radiance * weight_of(pdf_direct, pdf_point, {false, p, Vec3(0.0f)}, cos_y);
    }

    Spectrum emission_of_surface(const Ray& ray, const Hit& hit, const Surface& surface) const {
        if (is_black(surface.closures.emission)) return Spectrum(0.0f);
        float pdf_direct = 0.0f, pdf_point = 0.0f;
        if (history.stage == PathHistory::Stage::scattered)
            pdf_direct = pdf_direct_surface(world.lights, scene(), history.x, ray.direction, hit);
        if (history.stage == PathHistory::Stage::chain)
            pdf_point = pdf_light_point_surface(world.lights, scene(), hit.surface);
        return surface.closures.emission * weight_of(pdf_direct, pdf_point,
                                                     {false, surface.p, Vec3(0.0f)},
                                                     std::abs(dot(surface.ng, ray.direction)));
    }

    // ---- light that a vertex connects to

    // Next event estimation over all lights.
    Spectrum direct_radiance(const Surface& surface, const Sampler& sampler) {
        const std::optional<DirectSample> light =
            sample_direct(world.lights, scene(), surface.p, sampler[Domain::light].three());
        if (!light || is_black(light->radiance)) return Spectrum(0.0f);
        const uint32_t visibility = light_visibility(world.lights, light->light);
        const ClosureEval f = eval_seen_by(surface, light->wi, visibility);
        if (is_black(f.f_cos)) return Spectrum(0.0f);
        Spectrum through(1.0f);
        if ((visibility & kVisibleShadow) != 0) {
            const bool distant = std::isinf(light->distance);
            const ChainEnd end{
                distant, distant ? Vec3(0.0f) : surface.p + light->wi * light->distance, light->wi};
            uint32_t transparent_left = bounces.transparent_left(settings.limits);
            through = transmittance(scene(), {surface.p, surface.ng, surface.p_error}, end,
                                    kVisibleShadow, transparent_left, stats.rays);
        }
        const float density = light->delta ? light->pdf_omega : light->pdf_omega + f.pdf_omega;
        return f.f_cos * light->radiance * through *
               (1.0f / density);  // f L / p_light times its balance weight
    }

    // The closures by whose rays a light of this visibility would be found.
    ClosureEval eval_seen_by(const Surface& surface, const Vec3& wi, uint32_t visibility) const {
        constexpr uint32_t kScattered = kVisibleDiffuse | kVisibleGlossy | kVisibleTransmission;
        if ((visibility & kScattered) == kScattered)
            return eval(surface.closures, surface.ng, surface.wo, wi);
        uint32_t kinds = 0;
        for (const BounceKind kind :
             {BounceKind::diffuse, BounceKind::glossy, BounceKind::transmission})
            if ((visibility & ray_kind_after(kind)) != 0)
                kinds |= 1u << static_cast<uint32_t>(kind);
        return eval(surface.closures, surface.ng, surface.wo, wi, kinds);
    }

    bool may_receive(const Surface& surface) const {
        return settings.manifold.enabled && !world.casters.empty() &&
               scene().instances[surface.hit.instance].receiver &&
               bounces.leaves_room_for_chain(settings.limits);
    }

    // ---- going on

    static uint32_t ray_kind_after(BounceKind kind) {
        return kind == BounceKind::diffuse  ? kVisibleDiffuse
               : kind == BounceKind::glossy ? kVisibleGlossy
                                            : kVisibleTransmission;
    }

    // The density that the manifold's share is computed with: of the surface's own closures, even
    // where switched-off caustics left fewer to sample.
    float lobe_probability(const Surface& surface, const ClosureSample& next) const {
        if (settings.manifold.reflections && settings.manifold.refractions)
            return delta_lobe(surface.closures, surface.ng, surface.wo, next.wi, next.refracted)
                .probability;
        Surface whole;
        evaluate_surface(scene(), surface.hit, surface.wo, whole);
        return delta_lobe(whole.closures, whole.ng, whole.wo, next.wi, next.refracted).probability;
    }

    void append(const Surface& surface, const ClosureSample& next, bool receives) {
        if (next.delta) {
            if (history.append_delta(surface.hit, next, settings.manifold, world.casters))
                history.lobe_probability = lobe_probability(surface, next);
        } else {
            history.append_smooth(surface, next.pdf_omega, receives);
        }
        ray_kind = ray_kind_after(next.kind);
    }
};

// Ends paths of little throughput without bias; the root keeps them alive longer than the
// throughput itself would, for the light that waits behind dark surfaces.
bool survive_roulette(Spectrum& throughput, const Sampler& sampler) {
    const float q = std::min(1.0f, std::sqrt(max_component(throughput)));
    if (q >= 1.0f) return true;
    if (sampler[Domain::roulette].one() >= q) return false;
    throughput *= 1.0f / q;
    return true;
}

}  // namespace

RenderScene prepare(std::unique_ptr<Scene> scene, uint32_t threads) {
    RenderScene world;
    world.lights = build_lights(*scene, threads);
    world.casters = build_casters(*scene);
    world.scene = std::move(scene);
    return world;
}

// L(x0, w0) = sum over path vertices of throughput x (emission + direct + manifold). Each path is
// owned by one estimator or shared by two with weights that sum to one: manifold/estimator.h says
// which.
PathSample path_radiance(const RenderScene& world, const IntegratorSettings& settings,
                         const Ray& camera_ray, const Sampler& sampler, PathStats& stats) {
    PathTracer path{world, settings, stats, {}, {}};
    const Scene& scene = path.scene();
    PathSample out;
    Spectrum throughput(1.0f);
    Ray ray = camera_ray;
    Surface surface;
    bool seen_surface = false;
    for (uint32_t vertex = 0;; ++vertex) {
        ++stats.rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, path.ray_kind);
        if (!hit) {
            if (path.ray_kind == kVisibleCamera && settings.transparent_film)
                out.alpha = 1.0f - (throughput.x + throughput.y + throughput.z) / 3.0f;
            else
                out.radiance += throughput * path.emission_from_afar(ray.direction);
            break;
        }
        if (hit->light != kNone) {  // lamps are looked through, as in Cycles
            out.radiance += throughput * path.emission_of_lamp(ray, *hit);
            ray.t_near = past(hit->t);
            continue;
        }

        evaluate_surface(scene, hit->surface, ray.direction * -1.0f, surface);
        out.radiance += throughput * path.emission_of_surface(ray, *hit, surface);
        if (path.ray_kind == kVisibleDiffuse &&
            !(settings.manifold.reflections && settings.manifold.refractions))
            drop_caustics(surface.closures, settings.manifold.reflections,
                          settings.manifold.refractions);
        if (path.bounces.exhausted(settings.limits)) {
            // Its last vertex had its direct light, through whatever is transparent: so must this
            // ray.
            throughput *= surface.closures.transparency;
            path.bounces.add(BounceKind::transparent);
            if (is_black(throughput) || path.bounces.transparent > settings.limits.transparent)
                break;
            path.history.append_transparent(scene.instances[hit->surface.instance]);
            ray.t_near = past(hit->t);
            continue;
        }

        const Sampler here = sampler.vertex(vertex);
        const bool receives = has_smooth_closure(surface.closures) && path.may_receive(surface);
        if (has_smooth_closure(surface.closures)) {
            out.radiance += throughput * path.direct_radiance(surface, here);
            if (receives) {
                const Spectrum caustic =
                    throughput * manifold_radiance(scene, world.lights, world.casters,
                                                   settings.manifold,
                                                   {surface.p, surface.p_error, surface.ng,
                                                    surface.wo, &surface.closures,
                                                    path.bounces.transparent_left(settings.limits)},
                                                   here, stats.manifold);
                out.radiance += caustic;
                out.caustics += caustic;
            }
        }

        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo, here[Domain::closure].three());
        const bool transparent = next && next->kind == BounceKind::transparent;
        if (!seen_surface && !transparent) {
            seen_surface = out.hit = true;
            out.position = surface.p;
            out.normal = surface.n;
        }
        if (!next) break;
        throughput *= next->weight;
        path.bounces.add(next->kind);
        if (!survive_roulette(throughput, here)) break;
        if (transparent) {
            path.history.append_transparent(scene.instances[hit->surface.instance]);
            ray.t_near = past(hit->t);
            continue;
        }
        path.append(surface, *next, receives);
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi, 0.0f,
               kInfinity};
    }
    return out;
}

}  // namespace spc
