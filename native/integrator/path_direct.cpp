// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path_tracer.h"

namespace spc {

void PathTracer::add_direct(const Surface& surface, const CameraSubpath& camera_subpath,
                            const Sampler& sampler, PathLight& light) {
    if (!has_smooth_closure(surface.closures)) return;
    const LitPoint at = lit_point(scene(), surface);
    const auto add = [&](const std::optional<DirectSample>& one) {
        if (one)
            add_scattered(throughput * direct_radiance(surface, camera_subpath, *one), surface,
                          one->wi, one->light, light, bounces.total == 0);
    };
    add(sample_direct_first(world.lights, scene(), at, sampler[Domain::light].three(), to_light(0)));
    if (world.lights.tree.has_second())
        add(sample_direct_second(world.lights, scene(), at, sampler[Domain::even_light].three(),
                                 to_light(0)));
}

Spectrum PathTracer::direct_radiance(const Surface& surface, const CameraSubpath& camera_subpath,
                                     const DirectSample& light) {
    if (is_black(light.radiance) || !connects_to(light.light)) return Spectrum(0.0f);
    const uint32_t visibility = light_visibility(world.lights, light.light);
    const ClosureEval f =
        eval(surface.closures, surface.ng, surface.wo, light.wi, kinds_seeing(visibility));
    if (is_black(f.f_cos)) return Spectrum(0.0f);
    // f L / p_light, times its weight where other rays find the light, too
    const Spectrum alone = left_of_direct(surface, light, f, kinds_seeing(visibility)) *
                           light.radiance * (light.weight / light.density);
    if ((visibility & kVisibleShadow) == 0) return alone;
    return alone * weight_of_direct(surface, camera_subpath, light, f) * unblocked(surface, light);
}

Spectrum PathTracer::left_of_direct(const Surface& surface, const DirectSample& light,
                                    const ClosureEval& f, uint32_t kinds) const {
    const RoughVisit visit = rough_visit(surface);
    if (visit.before == nullptr) return f.f_cos;
    return left_by_rough_chains(techniques_of(world, settings), visit, light.wi, kinds, {},
                                end_of_direct(surface, light));
}

float PathTracer::weight_of_direct(const Surface& surface, const CameraSubpath& camera_subpath,
                                   const DirectSample& light, const ClosureEval& f) const {
    if (throws_on(surface, camera_subpath)) {
        const LightEnd end = end_of_direct(surface, light);
        CausticPath path = caustic_path(scene(), receiver_at(surface, camera_subpath), f, light.wi);
        path.rough_caster = true;
        if (const std::optional<CausticDensities> p = shared_with_light_paths(path, end))
            return static_cast<float>(p->direct / p->sum());
    }
    return light.delta ? 1.0f : power_heuristic(light.density, f.pdf_omega);
}

LightEnd PathTracer::end_of_direct(const Surface& surface, const DirectSample& light) const {
    LightEnd end =
        light_end(light_point_of(world.lights, scene(), surface.p, light), light.wi * -1.0f);
    end.pdf_direct = light.density;
    return end;
}

bool PathTracer::throws_on(const Surface& surface, const CameraSubpath& camera_subpath) const {
    if (!scene().instances[surface.hit.instance].rough_caster) return false;
    CausticPath path;
    path.rough_caster = true;
    path.camera_subpath = camera_subpath.bounces;
    path.film_density = camera_subpath.film_density;
    if (scene().material_of(surface.hit).may_glint()) path.glint_exit_pdf = 1.0f;
    return light_tracing_owns(techniques_of(world, settings), path);
}

Spectrum PathTracer::unblocked(const Surface& surface, const DirectSample& light) {
    const RayEnd end = ray_end(world.lights, scene(), surface.p, light);
    uint32_t transparent_left = bounces.transparent_left(settings.limits);
    Media along = media;
    if (dot(surface.ng, light.wi) < 0.0f) along.cross(scene(), surface.hit, light.wi);
    return transmittance(scene(), {surface.p, surface.ng, surface.p_error}, end, kVisibleShadow,
                         to_light(kRayShadow), transparent_left, along, stats.rays,
                         Opaque::by_material, blockers_of(world.lights, light.light));
}

}  // namespace spc
