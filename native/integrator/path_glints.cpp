// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/path_tracer.h"

namespace spc {

// Not where its direct light is shared with light paths or rough chains, by densities for the
// normal of one point: those find narrow lobes better.
void PathTracer::look_for_glints(const Hit& hit, Surface& surface,
                                 const CameraSubpath& camera_subpath, const PixelKernel* pixel) {
    glints.reset();
    if (!differential || surface.closures.glint_count == 0) return;
    if (throws_on(surface, camera_subpath) || turns_rough_chain(surface)) return;
    glints = GlintPoint::at(world.glints, settings.glints, scene(), surface, *differential,
                            static_cast<double>(hit.t), *pixel);
    surface.closures.glints_apart = glints.has_value();
}

void PathTracer::add_glints(const Surface& surface, const Sampler& sampler, PathLight& light) {
    // After a rough bounce the noise is the path's, which no further estimates take away.
    const uint32_t estimates = differential->lobe ? 1 : round.glints.estimates;
    const bool seen = bounces.total == 0;
    for (uint32_t i = 0; i < estimates; ++i) {
        const GlintLight found = glint_estimate(surface, sampler, i);
        const Spectrum part = found.radiance * (1.0f / static_cast<float>(estimates));
        light.total += part;
        if (light.values == nullptr || is_black(part)) continue;
        light.values->add_scattered(part, seen ? only(Lobe::glossy) : lobes, seen);
        light.values->add_to_group(settings.group_of_light(found.light), part);
    }
}

bool PathTracer::turns_rough_chain(const Surface& surface) const {
    return rough_visit(surface).before != nullptr &&
           rough_vertex(techniques_of(world, settings), surface.hit, surface.ng, surface.ng);
}

// To look for glints costs more than to draw lights: of several the one is taken that promises
// most, by the moments of the slopes (resampled importance sampling [Talbot05]). All of a
// sample's estimates together are points of a lattice, so that none of a few small lamps is left
// out by chance.
PathTracer::GlintLight PathTracer::glint_estimate(const Surface& surface, const Sampler& sampler,
                                                  uint32_t estimate) {
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
            sample_direct(world.lights, scene(), lit_point(scene(), surface),
                          lattice_point(first, i), to_light(0));
        if (!light || !(dot(surface.ng, light->wi) > 0.0f) || !connects_to(light->light)) continue;
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
    if (!chosen) return {};
    const DirectSample& light = chosen->light;
    Spectrum arriving =
        throughput * light.radiance * (chosen->share * sum / (kGlintCandidates * chosen->promise));
    if ((light_visibility(world.lights, light.light) & kVisibleShadow) != 0)
        arriving *= unblocked(surface, light);
    if (is_black(arriving)) return {};
    // The mean of several may be as noisy as one.
    const float faint =
        static_cast<float>(round.glints.estimates) * round.glints.faint / max_component(arriving);
    return {arriving * glints->f_cos(light.wi, {kPoints * chosen->share, faint},
                                     sampler[Domain::glints].stream_seed() + estimate, stats.glints),
            light.light};
}

}  // namespace spc
