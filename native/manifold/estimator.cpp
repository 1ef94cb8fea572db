// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/estimator.h"

namespace spc {

namespace {

ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

// |dw/dA_y| with the cosine at y, or per solid angle of a distant or delta light.
std::optional<double> solid_angle_per_light_measure(const Vec3& x, const ChainRoot& root,
                                                    const LightPoint& y, const Vec3& away) {
    const std::optional<double> g =
        geometry_term(root.interaction, root.eta, x, root.patch, end_of(y));
    if (!g || y.distant || y.delta) return g;
    const float cosine = dot(y.n, away);
    const bool two_sided =
        y.surface.instance != kNone;  // meshes shine from both sides, lamps from one
    return *g * static_cast<double>(two_sided ? std::abs(cosine) : std::max(cosine, 0.0f));
}

bool chain_is_clear(const Scene& scene, const LightSet& lights, const Receiver& receiver,
                    const ChainRoot& root, const LightPoint& y, Spectrum& through,
                    ManifoldStats& stats) {
    const uint32_t kind =
        root.interaction == Interaction::reflection ? kVisibleGlossy : kVisibleTransmission;
    const uint32_t visibility = light_visibility(lights, y.light);
    if ((visibility & kind) == 0) return false;
    const ChainEnd vertex{false, root.patch.p, Vec3(0.0f)};
    uint32_t transparent_left = receiver.transparent_left;
    // Chains that look through a caster first are path tracing's: see ChainClass::through_caster.
    through = transmittance(scene, {receiver.p, receiver.ng, receiver.p_error}, vertex,
                            kVisibleDiffuse, transparent_left, stats.rays, Opaque::casters_too);
    if (is_black(through)) return false;
    if ((visibility & kVisibleShadow) == 0) return true;
    through *= transmittance(scene, {root.patch.p, root.patch.ng, root.patch.p_error}, end_of(y),
                             kind, transparent_left, stats.rays);
    return !is_black(through);
}

// What one solution contributes to an estimate that has drawn y and the caster; zero if blocked.
Spectrum contribution(const Scene& scene, const LightSet& lights, const Receiver& receiver,
                      const LightPoint& y, float caster_probability, const ChainRoot& root,
                      ManifoldStats& stats) {
    const Vec3 to_root = root.patch.p - receiver.p;
    const Vec3 wi = normalize(to_root);
    const ClosureEval at_x = eval(*receiver.closures, receiver.ng, receiver.wo, wi);
    if (is_black(at_x.f_cos)) return Spectrum(0.0f);

    float distance_y;
    const Vec3 to_light = end_of(y).from(root.patch.p, distance_y);
    const Vec3 away = to_light * -1.0f;
    const std::optional<double> jacobian = solid_angle_per_light_measure(receiver.p, root, y, away);
    if (!jacobian || !(*jacobian > 0.0)) return Spectrum(0.0f);

    Surface surface;
    evaluate_surface(scene, root.hit, wi * -1.0f, surface);
    const DeltaLobe lobe = delta_lobe(surface.closures, surface.ng, surface.wo, to_light,
                                      root.interaction == Interaction::refraction);
    if (is_black(lobe.throughput)) return Spectrum(0.0f);
    const Spectrum radiance = radiance_at(lights, scene, y, away);
    if (is_black(radiance)) return Spectrum(0.0f);
    Spectrum through;
    if (!chain_is_clear(scene, lights, receiver, root, y, through, stats)) return Spectrum(0.0f);

    const double manifold_density =
        static_cast<double>(y.pdf) * static_cast<double>(caster_probability);
    const double path_density = y.delta ? 0.0
                                        : static_cast<double>(at_x.pdf_omega) *
                                              static_cast<double>(lobe.probability) * *jacobian;
    // J / p_m times the share p_m / (p_m + p_pt), in a form that stays finite on a fold.
    const auto weight = static_cast<float>(*jacobian / (manifold_density + path_density));
    return at_x.f_cos * lobe.throughput * radiance * through * weight;
}

// E[number of walks until the root comes again] = 1 / p_k: a geometric distribution, counted
// [Zeltner20 Eq. 7].
uint32_t count_trials(const Scene& scene, const ManifoldSettings& settings, const ChainQuery& query,
                      const ChainRoot& root, Pcg& pcg, ManifoldStats& stats) {
    uint32_t trials = 1;
    for (; trials < settings.trial_cap; ++trials) {
        const std::optional<ChainRoot> again = random_walk(scene, settings, query, pcg, stats);
        if (again && same_root(settings, root, *again)) break;
    }
    ++stats.trial_estimates;
    stats.trials += trials;
    stats.max_trials = std::max<uint64_t>(stats.max_trials, trials);
    return trials;
}

}  // namespace

bool manifold_owns(const ManifoldSettings& settings, const CasterSet& casters,
                   const ChainClass& chain) {
    if (!settings.enabled || !chain.receiver || !chain.on_caster_normal || chain.through_caster)
        return false;
    if (casters.of_instance[chain.instance] == kNone) return false;
    return chain.interaction == Interaction::reflection ? settings.reflections
                                                        : settings.refractions;
}

float path_tracing_share(const Scene& scene, const CasterSet& casters, const Vec3& x, const Vec3& ng,
                         float pdf_omega, const SurfaceHit& hit, Interaction interaction,
                         float lobe_probability, const ChainEnd& end, float cos_y, float light_pdf) {
    if (!(light_pdf > 0.0f)) return 1.0f;
    const float caster = caster_probability(casters, casters.of_instance[hit.instance], x, ng, end);
    if (!(caster > 0.0f)) return 1.0f;
    const CasterPatch patch = evaluate_caster(scene, hit, false);
    const float eta = eta_seen_from(patch.ng, x - patch.p, scene.material_of(hit).specular.ior);
    const std::optional<double> g = geometry_term(interaction, eta, x, patch, end);
    if (!g) return 1.0f;
    const ChainDensities densities{static_cast<double>(light_pdf) * static_cast<double>(caster),
                                   static_cast<double>(pdf_omega) *
                                       static_cast<double>(lobe_probability) * *g *
                                       static_cast<double>(cos_y)};
    return 1.0f - manifold_share(densities);
}

Spectrum manifold_radiance(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                           const ManifoldSettings& settings, const Receiver& receiver,
                           const Sampler& sampler, ManifoldStats& stats) {
    const std::optional<LightPoint> y =
        sample_light_point(lights, scene, sampler[Domain::manifold_light].three());
    if (!y) return Spectrum(0.0f);
    const CasterChoice choice = choose_caster(casters, receiver.p, receiver.ng, end_of(*y),
                                              sampler[Domain::manifold_caster].one());
    if (choice.index == kNone) return Spectrum(0.0f);

    ++stats.estimates;
    const ChainQuery query{receiver.p, end_of(*y), &casters.casters[choice.index]};
    Pcg pcg(sampler[Domain::manifold_seeds].stream_seed());
    const auto value_of_root = [&](const ChainRoot& root) {
        return contribution(scene, lights, receiver, *y, choice.probability, root, stats);
    };

    if (!settings.biased) {
        const std::optional<ChainRoot> root = random_walk(scene, settings, query, pcg, stats);
        if (!root) return Spectrum(0.0f);
        const Spectrum value = value_of_root(*root);
        if (is_black(value)) return value;
        const uint32_t trials = count_trials(scene, settings, query, *root, pcg, stats);
        const Spectrum estimate = value * static_cast<float>(trials);
        if (trials >= settings.trial_cap) {
            ++stats.capped;
            stats.capped_energy += static_cast<double>(luminance(estimate));
        }
        return estimate;
    }

    std::vector<ChainRoot> found;
    Spectrum sum(0.0f);
    for (uint32_t walk = 0; walk < settings.set_size; ++walk) {
        const std::optional<ChainRoot> root = random_walk(scene, settings, query, pcg, stats);
        if (!root) continue;
        const auto known = [&](const ChainRoot& other) { return same_root(settings, *root, other); };
        if (std::any_of(found.begin(), found.end(), known)) continue;
        found.push_back(*root);
        sum += value_of_root(*root);
    }
    return sum;
}

}  // namespace spc
