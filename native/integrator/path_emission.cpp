// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path_tracer.h"
#include "manifold/found_chains.h"

namespace spc {

void PathTracer::add_from_afar(PathLight& light) const {
    const auto group_of = [this](uint32_t of_light) { return settings.group_of_light(of_light); };
    if (world.lights.has_world)
        add_met(throughput * emission_of_world(), Pass::environment,
                group_of(world.lights.of_world()), light);
    for (const uint32_t sun : world.lights.disc_suns) {
        const bool seen = (light_visibility(world.lights, sun) & ray_kind) != 0;
        if (seen && meets(world.lights.links[sun]))
            add_met(throughput * emission_of_sun(sun), Pass::emission, group_of(sun), light);
    }
}

Spectrum PathTracer::emission_of_sun(uint32_t sun) const {
    const Spectrum radiance = radiance_of_lamp(world.lights, scene(), sun, Vec3(0.0f),
                                               ray.direction * -1.0f, seen_by(kFromAfar));
    if (is_black(radiance)) return radiance;
    return radiance * weight_of_lamp(end_afar(
                          sun, pdf_light_point_sun(world.lights, sun, ray.direction),
                          pdf_direct_sun(world.lights, history.lit_point(), sun, ray.direction)));
}

Spectrum PathTracer::world_seen() const {
    if (!world.lights.has_world || (scene().environment.visibility & ray_kind) == 0)
        return Spectrum(0.0f);
    return world_radiance(world.lights, scene(), ray.direction, seen_by(0.0f));
}

Spectrum PathTracer::emission_of_world() const {
    const Spectrum radiance = world_seen();
    if (is_black(radiance)) return radiance;
    const bool scattered = history.stage == PathHistory::Stage::scattered;
    return radiance *
           weight_of(end_afar(
               world.lights.of_world(),
               light_points_count() ? pdf_light_point_world(world.lights, ray.direction) : 0.0f,
               scattered ? pdf_direct_world(world.lights, history.lit_point(), ray.direction)
                         : 0.0f));
}

Spectrum PathTracer::emission_of_lamp(const Hit& hit) const {
    const Lamp& lamp = world.lights.lamps[hit.light];
    const Spectrum radiance =
        radiance_of_lamp(world.lights, scene(), hit.light, ray.origin + ray.direction * hit.t,
                         ray.direction * -1.0f, seen_by(hit.t));
    if (is_black(radiance)) return radiance;
    const Vec3 y = lamp_point_seen(lamp, ray.origin, ray.direction, hit.t);
    float pdf_direct = 0.0f, pdf_point = 0.0f, cos_y = 0.0f;
    if (history.stage == PathHistory::Stage::scattered)
        pdf_direct = pdf_direct_lamp(world.lights, history.lit_point(), ray.direction, hit);
    if (light_points_count()) {
        cos_y = -dot(lamp_normal(lamp, y), ray.direction);
        // The manifold sees lamps from outside alone.
        if (cos_y > 0.0f) pdf_point = pdf_light_point_lamp(world.lights, hit);
    }
    return radiance *
           weight_of_lamp({{false, y, Vec3(0.0f)}, hit.light, false, cos_y, pdf_point, pdf_direct});
}

Spectrum PathTracer::emission_of_surface(const Hit& hit, const Surface& surface) const {
    if (is_black(surface.closures.emission)) return Spectrum(0.0f);
    float pdf_direct = 0.0f, pdf_point = 0.0f;
    if (history.stage == PathHistory::Stage::scattered)
        pdf_direct =
            pdf_direct_surface(world.lights, scene(), history.lit_point(), ray.direction, hit);
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

float PathTracer::weight_of(const LightEnd& end) const {
    const float weight = weight_since_x(end);
    if (history.rough_chain.count == 0) return weight;
    return weight *
           (1.0f - rough_chain_share(techniques_of(world, settings), history.rough_chain, end));
}

float PathTracer::weight_of_lamp(const LightEnd& end) const {
    const bool casts_shadow = (light_visibility(world.lights, end.light) & kVisibleShadow) != 0;
    const bool is_connected_to =
        history.stage == PathHistory::Stage::scattered && end.pdf_direct > 0.0f;
    return casts_shadow || !is_connected_to ? weight_of(end) : 0.0f;
}

float PathTracer::weight_since_x(const LightEnd& end) const {
    if (from_folds && history.stage != PathHistory::Stage::chain) return 0.0f;
    switch (history.stage) {
        case PathHistory::Stage::unconnected: return 1.0f;
        case PathHistory::Stage::scattered: {
            const std::optional<CausticDensities> p = shared_with_light_paths(history.caustic, end);
            if (p) return static_cast<float>(p->path_tracing / p->sum());
            return history.glints ? 1.0f - shared_by_glints(end.pdf_direct, *history.glints)
                                  : power_heuristic(history.pdf_direct, end.pdf_direct);
        }
        case PathHistory::Stage::chain: return weight_of_chain(end);
    }
    return 1.0f;
}

float PathTracer::weight_of_chain(const LightEnd& end) const {
    const float unshared = from_folds ? 0.0f : 1.0f;
    const Techniques techniques = techniques_of(world, settings);
    const CausticPath& so_far = history.caustic;
    if (!(end.pdf > 0.0f) ||
        !(manifold_owns(techniques, so_far) || light_tracing_owns(techniques, so_far)))
        return unshared;
    if (so_far.from_camera && !settings.camera_chains->has(end.light)) return unshared;
    CausticPath path = so_far;
    if (is_black(chain_throughput(scene(), path, end.end))) return unshared;
    const std::optional<CausticDensities> p = caustic_densities(techniques, path, end);
    if (!p || p->manifold + p->light_tracing == 0.0) return unshared;
    const double own = from_folds ? p->share_of_folds() : 1.0 - p->share_of_folds();
    if (own == 0.0) return 0.0f;
    const uint32_t trials =
        p->missed_are_apart()
            ? trials_if_missed(techniques, round.sheets, path, end,
                               p->telling_trials(settings.manifold.trial_cap), pcg, stats.manifold)
            : 0;
    return static_cast<float>(
        own * (trials > 0 ? p->share_of_directions(trials) : p->by_directions() / p->sum()));
}

bool PathTracer::light_points_count() const {
    return (history.stage == PathHistory::Stage::chain && history.caustic.count > 0) ||
           history.rough_chain.count > 0 ||
           (history.stage == PathHistory::Stage::scattered && history.caustic.rough_caster);
}

LightEnd PathTracer::end_afar(uint32_t light, float pdf, float pdf_direct) const {
    return {{true, Vec3(0.0f), ray.direction}, light, false, 1.0f, pdf, pdf_direct};
}

std::optional<CausticDensities> PathTracer::shared_with_light_paths(const CausticPath& path,
                                                                    const LightEnd& end) const {
    if (!path.rough_caster || !(end.pdf > 0.0f) || !(end.cosine > 0.0f)) return std::nullopt;
    const Techniques techniques = techniques_of(world, settings);
    if (!light_tracing_owns(techniques, path)) return std::nullopt;
    const std::optional<CausticDensities> p = caustic_densities(techniques, path, end);
    return p && p->light_tracing > 0.0 ? p : std::nullopt;
}

}  // namespace spc
