// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/ownership.h"

namespace spc {

namespace {

bool allowed(const ManifoldSettings& settings, Interaction interaction) {
    return interaction == Interaction::reflection ? settings.reflections : settings.refractions;
}

// Whether the manifold looks for chains of this kind.
bool looks_for(const ManifoldSettings& settings, const CausticPath& path) {
    const std::span vertices(path.vertices.data(), path.count);
    if (vertices.empty() || vertices.size() > settings.longest_chain) return false;
    // Along straight lines through glass; of reflections for single ones.
    return settings.finder != ChainFinder::mnee || vertices.size() == 1 ||
           std::all_of(vertices.begin(), vertices.end(), [](const CausticVertex& vertex) {
               return vertex.interaction == Interaction::refraction;
           });
}

// Whether path tracing may follow the path to its light, by whichever closure x scatters, after such
// bounces.
bool within_limits(const BounceLimits& limits, const BounceCounts& before, const CausticPath& path) {
    uint32_t glossy = before.glossy + 1, transmission = before.transmission + 1;
    for (uint32_t i = 0; i + 1 < path.count; ++i)
        ++(path.vertices[i].interaction == Interaction::reflection ? glossy : transmission);
    return before.total + path.count <= limits.total && before.diffuse < limits.diffuse &&
           glossy <= limits.glossy && transmission <= limits.transmission;
}

// Whether an estimate comes to the path's first caster by choose_caster().
bool chooses_caster(const ManifoldSettings& settings, const CausticPath& path) {
    return settings.finder == ChainFinder::walks ||
           (settings.finder == ChainFinder::mnee &&
            path.vertices[0].interaction == Interaction::reflection);
}

bool is_seen_through(const LightSet& lights, uint32_t light) {
    return (light_visibility(lights, light) & kVisibleShadow) == 0;
}

// Product over the vertices of the chance that a path from the light takes the same lobe.
double probability_from_light(const Scene& scene, const CausticPath& path,
                              std::span<const ChainVertex> chain, const ChainEnd& end) {
    double product = 1.0;
    Surface surface;
    for (size_t i = 0; i < chain.size(); ++i) {
        const Vec3 p = chain[i].patch.p;
        float unused;
        const Vec3 to_light =
            i + 1 < chain.size() ? normalize(chain[i + 1].patch.p - p) : end.from(p, unused);
        const Vec3 to_receiver = normalize((i > 0 ? chain[i - 1].patch.p : path.x) - p);
        evaluate_surface(scene, path.vertices[i].hit, to_light, surface);
        product *=
            static_cast<double>(delta_lobe(surface.closures, surface.ng, to_light, to_receiver,
                                           chain[i].interaction == Interaction::refraction)
                                    .probability);
    }
    return product;
}

}  // namespace

LightEnd light_end(const LightPoint& y, const Vec3& away) {
    const bool point = y.distant || y.delta;
    const bool two_sided = y.surface.instance != kNone;  // meshes; lamps shine from one side
    const float cosine = dot(y.n, away);
    return {{y.distant, y.p, y.direction},
            y.light,
            y.delta,
            point       ? 1.0f
            : two_sided ? std::abs(cosine)
                        : std::max(cosine, 0.0f),
            y.pdf};
}

float film_per_area(const Scene& scene, const CameraApproach& approach, const SurfaceHit& hit,
                    const Vec3& wo, const Vec3& wi) {
    if (approach.scatterings == 0 || approach.film_per_area == 0.0f) return approach.film_per_area;
    Surface from_light;
    evaluate_surface(scene, hit, wi, from_light);
    const float pdf = eval(from_light.closures, from_light.ng, wi, wo).pdf_omega;
    return pdf > 0.0f ? approach.film_per_area / pdf : 0.0f;
}

uint32_t most_scatterings(const BounceLimits& limits) {
    const uint32_t scatterings =
        std::min({limits.total, limits.diffuse, limits.glossy, limits.transmission});
    return std::max(scatterings, 1u) - 1;  // the receiver scatters once more
}

bool manifold_owns(const Techniques& techniques, const CausticPath& path) {
    return techniques.manifold.enabled && path.receiver && !path.through_caster &&
           looks_for(techniques.manifold, path) &&
           allowed(techniques.manifold, path.vertices[0].interaction) &&
           within_limits(techniques.limits, path.before, path);
}

bool light_tracing_owns(const Techniques& techniques, const CausticPath& path) {
    // Switched-off caustics leave diffuse rays not all that light paths meet.
    // The manifold's limits hold for all that light tracing owns.
    const uint32_t n = path.scatterings;
    const BounceCounts whichever{
        .total = n, .diffuse = n, .glossy = n, .transmission = n, .transparent = 0};
    const bool all_seen = techniques.manifold.reflections && techniques.manifold.refractions;
    const bool by_casters =
        path.count > 0 ? path.receiver && allowed(techniques.manifold, path.vertices[0].interaction)
                       : path.rough_caster && path.scatterings > 0;
    return techniques.light_tracing.guide != nullptr && by_casters && path.film_per_area > 0.0f &&
           std::isfinite(path.film_per_area) && (path.scatterings == 0 || all_seen) &&
           within_limits(techniques.limits, whichever, path);
}

Spectrum chain_throughput(const Scene& scene, CausticPath& path, const ChainEnd& end) {
    Spectrum throughput(1.0f);
    if (path.count == 0) return throughput;
    Surface surface;
    Vec3 from = path.x, p = surface_position(scene, path.vertices[0].hit);
    for (uint32_t i = 0; i < path.count; ++i) {
        CausticVertex& vertex = path.vertices[i];
        evaluate_surface(scene, vertex.hit, normalize(from - p), surface);
        from = p;
        float unused;
        Vec3 to_light;
        if (i + 1 < path.count) {
            p = surface_position(scene, path.vertices[i + 1].hit);
            to_light = normalize(p - from);
        } else {
            to_light = end.from(from, unused);
        }
        const DeltaLobe lobe = delta_lobe(surface.closures, surface.ng, surface.wo, to_light,
                                          vertex.interaction == Interaction::refraction);
        vertex.probability = lobe.probability;
        throughput *= lobe.throughput;
        if (is_black(throughput)) break;
    }
    return throughput;
}

std::optional<CausticDensities> caustic_densities(const Techniques& techniques,
                                                  const CausticPath& path, const LightEnd& end) {
    const Scene& scene = techniques.scene;
    std::array<ChainVertex, kLongestChain> storage;
    const std::span<ChainVertex> chain(storage.data(), path.count);
    double probability = 1.0;
    Vec3 from = path.x;
    for (uint32_t i = 0; i < path.count; ++i) {
        const CausticVertex& vertex = path.vertices[i];
        const CasterPatch patch = evaluate_caster(scene, vertex.hit, false);
        const float ior = scene.material_of(vertex.hit).specular.ior;
        chain[i] = {vertex.interaction, eta_seen_from(patch.ng, from - patch.p, ior), patch};
        probability *= static_cast<double>(vertex.probability);
        from = patch.p;
    }
    const std::optional<ChainDerivative> derivative = chain_derivative(path.x, chain, end.end);
    if (!derivative) return std::nullopt;

    CausticDensities p;
    p.geometry = derivative->geometry * static_cast<double>(end.cosine);
    const bool by_manifold = manifold_owns(techniques, path);
    if (by_manifold) {
        const ManifoldSettings& manifold = techniques.manifold;
        p.manifold = manifold_worth(techniques) * static_cast<double>(end.pdf);
        if (manifold.finder == ChainFinder::sheets)
            p.missed = CausticDensities::kMissedWorth * static_cast<double>(end.pdf);
        if (manifold.finder == ChainFinder::mnee && !manifold.biased) p.missed = 0.0;
        if (chooses_caster(manifold, path)) {
            const uint32_t caster = techniques.casters.of_instance[path.vertices[0].hit.instance];
            p.manifold *= static_cast<double>(
                caster_probability(techniques.casters, caster, path.x, path.sides, end.end));
        }
    }
    if (path.count == 0)
        p.direct = static_cast<double>(end.pdf_direct) * (end.delta ? 1.0 : p.geometry);
    // Rays do not look through what a lamp without shadow shines through: they leave such a light
    // to those who connect to it.
    const bool by_rays = !is_seen_through(techniques.lights, end.light);
    if (!end.delta && (by_rays || !by_manifold))
        p.path_tracing = static_cast<double>(path.pdf_omega) * probability * p.geometry;
    if (by_rays && light_tracing_owns(techniques, path)) {
        float unused;
        const Vec3 wi = chain.empty() ? end.end.from(path.x, unused)
                                      : normalize(chain.front().patch.p - path.x);
        const Vec3 last = chain.empty() ? path.x : chain.back().patch.p;
        const float emitted =
            emission_pdf(*techniques.light_tracing.guide, end.light, end.end, last);
        const double cos_x = std::abs(static_cast<double>(dot(path.sides.ng, wi)));
        const LightTracing& paths = techniques.light_tracing;
        // All of those that a rough caster scatters go on.
        const bool thinned = path.scatterings > 0 && path.count > 0;
        if (emitted > 0.0f)
            p.light_tracing = paths.paths * (thinned ? paths.goes_on : 1.0) /
                              static_cast<double>(path.film_per_area) *
                              static_cast<double>(end.pdf) * static_cast<double>(emitted) *
                              probability_from_light(scene, path, chain, end.end) *
                              derivative->geometry * derivative->etendue * cos_x;
    }
    return p;
}

}  // namespace spc
