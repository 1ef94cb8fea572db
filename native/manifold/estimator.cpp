// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/estimator.h"

namespace spc {

namespace {

// Of a segment that touches a surface: nearer to grazing the margin would swallow the segment.
constexpr float kLeastCosine = 1e-3f;

ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

ReceiverSides sides_of(const Receiver& receiver) {
    return {receiver.ng, has_smooth_transmission(*receiver.closures)};
}

// One estimate: a receiver, a light point and a caster, and walks between them.
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

    // One walk, weighted by how many more it takes to find the same solution again.
    Spectrum unbiased(const Caster& caster, Pcg& pcg) {
        const ChainQuery query{receiver_.p, end_of(y_), &caster};
        const std::optional<ChainRoot> root = random_walk(scene_, settings_, query, pcg, stats_);
        if (!root) return Spectrum(0.0f);
        const Spectrum value = contribution(*root);
        if (is_black(value)) return value;
        const uint32_t trials = count_trials(query, *root, pcg);
        if (trials >= settings_.trial_cap) ++stats_.capped;
        return value * static_cast<float>(trials);
    }

    // The sum over the different solutions of a fixed number of walks.
    Spectrum biased(const Caster& caster, Pcg& pcg) {
        const ChainQuery query{receiver_.p, end_of(y_), &caster};
        std::vector<ChainRoot> found;
        Spectrum sum(0.0f);
        for (uint32_t walk = 0; walk < settings_.set_size && !is_cancelled(); ++walk) {
            const std::optional<ChainRoot> root = random_walk(scene_, settings_, query, pcg, stats_);
            if (!root) continue;
            const auto known = [&](const ChainRoot& other) {
                return same_root(settings_, *root, other);
            };
            if (std::any_of(found.begin(), found.end(), known)) continue;
            found.push_back(*root);
            sum += contribution(*root);
        }
        return sum;
    }

private:
    // What one solution contributes; zero if something stands in its way.
    Spectrum contribution(const ChainRoot& root) {
        const Vec3 wi = normalize(root.patch.p - receiver_.p);
        const ClosureEval at_x = eval(*receiver_.closures, receiver_.ng, receiver_.wo, wi);
        if (is_black(at_x.f_cos)) return Spectrum(0.0f);
        float distance_y = 0.0f;
        const Vec3 to_light = end_of(y_).from(root.patch.p, distance_y);
        const Vec3 away = to_light * -1.0f;
        Surface surface;
        evaluate_surface(scene_, root.hit, wi * -1.0f, surface);
        const DeltaLobe lobe = delta_lobe(surface.closures, surface.ng, surface.wo, to_light,
                                          root.interaction == Interaction::refraction);
        if (is_black(lobe.throughput)) return Spectrum(0.0f);
        const Spectrum radiance = radiance_at(lights_, scene_, y_, away);
        if (is_black(radiance)) return Spectrum(0.0f);

        const CausticPath path = caustic_path(scene_, receiver_, at_x, root, lobe.probability);
        const std::optional<CausticDensities> densities =
            caustic_densities(techniques_, path, light_end(y_, away));
        if (!densities || !(densities->geometry > 0.0)) return Spectrum(0.0f);
        const Spectrum through = passes(root);
        return at_x.f_cos * lobe.throughput * radiance * through *
               static_cast<float>(kManifoldWorth * densities->scale());
    }

    // Fraction of light that passes along both segments of a chain.
    Spectrum passes(const ChainRoot& root) {
        const uint32_t kind =
            root.interaction == Interaction::reflection ? kVisibleGlossy : kVisibleTransmission;
        if ((light_visibility(lights_, y_.light) & kind) == 0) return Spectrum(0.0f);
        uint32_t transparent_left = receiver_.transparent_left;
        // Chains that look through a caster first are path tracing's: see
        // ChainClass::through_caster.
        const Spectrum to_vertex =
            transmittance(scene_, {receiver_.p, receiver_.ng, receiver_.p_error}, vertex_of(root),
                          kVisibleDiffuse, transparent_left, stats_.rays, Opaque::casters_too);
        if (is_black(to_vertex) || !casts_shadow()) return to_vertex;
        return to_vertex * transmittance(scene_, {root.patch.p, root.patch.ng, root.patch.p_error},
                                         end_of_light(root), kind, transparent_left, stats_.rays);
    }

    // An emissive mesh does not block its own light.
    ChainEnd end_of_light(const ChainRoot& root) const {
        ChainEnd end = end_of(y_);
        if (y_.surface.instance == kNone) return end;
        const float cosine = std::abs(dot(y_.n, normalize(y_.p - root.patch.p)));
        end.margin = position_error(scene_, y_.surface.instance, y_.surface.triangle) /
                     std::max(cosine, kLeastCosine);
        return end;
    }

    ChainEnd vertex_of(const ChainRoot& root) const {
        const float cosine = std::abs(dot(root.patch.ng, normalize(root.patch.p - receiver_.p)));
        return {false, root.patch.p, Vec3(0.0f),
                root.patch.p_error / std::max(cosine, kLeastCosine)};
    }

    // Whether occluders stop the light. Where they do not, path tracing leaves the chains to the
    // manifold: its rays cannot look through.
    bool casts_shadow() const {
        return (light_visibility(lights_, y_.light) & kVisibleShadow) != 0;
    }

    bool is_cancelled() const {
        return settings_.cancelled != nullptr &&
               settings_.cancelled->load(std::memory_order_relaxed);
    }

    // E[number of walks until the root comes again] = 1 / p_k: a geometric distribution, counted.
    uint32_t count_trials(const ChainQuery& query, const ChainRoot& root, Pcg& pcg) {
        uint32_t trials = 1;
        for (; trials < settings_.trial_cap && !is_cancelled(); ++trials) {
            const std::optional<ChainRoot> again =
                random_walk(scene_, settings_, query, pcg, stats_);
            if (again && same_root(settings_, root, *again)) break;
        }
        ++stats_.trial_estimates;
        stats_.trials += trials;
        stats_.max_trials = std::max<uint64_t>(stats_.max_trials, trials);
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
                         const ChainRoot& root, float probability) {
    CausticPath path;
    path.x = receiver.p;
    path.sides = sides_of(receiver);
    path.pdf_omega = at_x.pdf_omega;
    path.receiver = true;
    path.scatterings = receiver.approach.scatterings;
    path.film_per_area = film_per_area(scene, receiver.approach, receiver.hit, receiver.wo,
                                       normalize(root.patch.p - receiver.p));
    path.count = 1;
    path.vertices[0] = {root.hit, root.interaction, probability};
    return path;
}

Spectrum manifold_radiance(const Techniques& techniques, const Receiver& receiver,
                           const Sampler& sampler, ManifoldStats& stats) {
    const CasterSet& casters = techniques.casters;
    const std::optional<LightPoint> y = sample_light_point(techniques.lights, techniques.scene,
                                                           sampler[Domain::manifold_light].three());
    if (!y) return Spectrum(0.0f);
    const CasterChoice choice = choose_caster(casters, receiver.p, sides_of(receiver), end_of(*y),
                                              sampler[Domain::manifold_caster].one());
    if (choice.index == kNone) return Spectrum(0.0f);

    ++stats.estimates;
    Pcg pcg(sampler[Domain::manifold_seeds].stream_seed());
    Estimate estimate(techniques, receiver, *y, stats);
    const Caster& caster = casters.casters[choice.index];
    return techniques.manifold.biased ? estimate.biased(caster, pcg)
                                      : estimate.unbiased(caster, pcg);
}

}  // namespace spc
