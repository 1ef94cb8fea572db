// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path_tracer.h"

namespace spc {

void PathTracer::add_shadow_linked(const Surface& surface, PathLight& light) {
    const LightSet& lights = world.lights;
    for (const uint32_t i : lights.shadow_linked) {
        const bool seen = (light_visibility(lights, i) & ray_kind) != 0;
        if (!seen || !shines_on(lights, i, scattered_by->sets.receives)) continue;
        const uint32_t group = settings.group_of_light(i);
        if (i >= lights.lamps.size()) {
            add_shadow_linked_mesh(surface, i, light);
        } else if (std::holds_alternative<DiscSun>(lights.lamps[i])) {
            go_towards(ray.direction);
            const Spectrum emitted = emission_of_sun(i);
            if (!is_black(emitted))
                add_met(emitted * past_blockers(surface, i, {{true, Vec3(0.0f), ray.direction}}),
                        Pass::emission, group, light);
        } else if (const auto hit = intersect_light(scene().lights[i], ray)) {
            come_to(hit->p);
            const Spectrum emitted = emission_of_lamp({hit->t, i, {kNone, 0, 0, 0}});
            if (!is_black(emitted))
                add_met(emitted * past_blockers(surface, i,
                                                {.at = {false, hit->p, Vec3(0.0f)},
                                                 .ng = hit->n,
                                                 .error = position_error(hit->p),
                                                 .ray_error = kRayError}),
                        Pass::emission, group, light);
        }
    }
}

void PathTracer::add_shadow_linked_mesh(const Surface& surface, uint32_t emitter, PathLight& light) {
    constexpr uint32_t kMostSurfaces = 1024;  // of the mesh along the ray, as in Cycles
    const uint32_t instance = world.lights.emissive[emitter - world.lights.lamps.size()].instance;
    Ray rest = ray;
    Surface met;
    for (uint32_t i = 0; i < kMostSurfaces; ++i) {
        const std::optional<Hit> hit = scene().accel->intersect_alone(instance, rest);
        if (!hit) return;
        evaluate(*hit, met);
        come_to(met.p);
        const Spectrum emitted = emission_of_surface(*hit, met);
        if (!is_black(emitted))
            add_met(emitted * past_blockers(surface, emitter, end_on(scene(), hit->surface, met.p)),
                    Pass::emission, settings.group_of_instance(instance), light);
        rest.t_near = past(hit->t);
    }
}

Spectrum PathTracer::past_blockers(const Surface& surface, uint32_t of_light, const RayEnd& end) {
    uint32_t transparent_left = bounces.transparent_left(settings.limits);
    Media along = media;
    return throughput * transmittance(scene(), {surface.p, surface.ng, surface.p_error}, end,
                                      kVisibleShadow, ray_state(kRayShadow, 0.0f, bounces.total),
                                      transparent_left, along, stats.rays, Opaque::by_material,
                                      blockers_of(world.lights, of_light));
}

}  // namespace spc
