// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/ownership.h"

#include "manifold/facet.h"
#include "manifold/fold_directions.h"

namespace spc {

namespace {

bool allowed(const ManifoldSettings& settings, Interaction interaction) {
    return interaction == Interaction::reflection ? settings.reflections : settings.refractions;
}

// Whether the manifold looks for chains of this kind.
bool looks_for(const ManifoldSettings& settings, const CausticPath& path) {
    const std::span vertices(path.vertices.data(), path.count);
    const uint32_t longest = path.from_camera ? kLongestChain : settings.longest_chain;
    if (vertices.empty() || vertices.size() > longest) return false;
    const auto same = [](const CausticVertex& vertex, Interaction interaction) {
        return vertex.interaction == interaction;
    };
    if (!settings.family.empty() && !std::equal(vertices.begin(), vertices.end(),
                                                settings.family.begin(), settings.family.end(), same))
        return false;
    // MNEE seeds find refractions along straight lines and single reflections. Camera chains have
    // seeds and searches of their own, whatever the finder.
    return path.from_camera || settings.finder != ChainFinder::mnee || vertices.size() == 1 ||
           std::all_of(vertices.begin(), vertices.end(), [](const CausticVertex& vertex) {
               return vertex.interaction == Interaction::refraction;
           });
}

// Whether path tracing may follow the path to its light within the limits, whichever closure
// scatters at x. `before`: bounces before x.
bool within_limits(const BounceLimits& limits, const BounceCounts& before, const CausticPath& path) {
    const uint32_t at_x = path.from_camera ? 0 : 1;
    uint32_t glossy = before.glossy + at_x, transmission = before.transmission + at_x;
    for (uint32_t i = 0; i + 1 < path.count; ++i)
        ++(path.vertices[i].interaction == Interaction::reflection ? glossy : transmission);
    return before.total + at_x + path.count <= limits.total + 1 &&
           before.diffuse + at_x <= limits.diffuse && glossy <= limits.glossy &&
           transmission <= limits.transmission;
}

// Whether light paths may find rough chains of the path: they scatter at the rough vertices and at
// x.
bool light_paths_may_find(const Techniques& techniques, const CausticPath& path) {
    return techniques.light_tracing.guide != nullptr && path.film_density > 0.0f;
}

// Whether the manifold looks for chains on all casters of the path.
bool searches_all(const Techniques& techniques, const CausticPath& path) {
    const std::span vertices(path.vertices.data(), path.count);
    return std::all_of(vertices.begin(), vertices.end(), [&](const CausticVertex& vertex) {
        const CasterSet& set = vertex.rough ? techniques.rough_chain_casters : techniques.casters;
        return set.of_instance[vertex.hit.instance] != kNone;
    });
}

// Whether light paths are dense enough at x for the manifold to search for nothing there.
bool left_to_light_paths(const Techniques& techniques, const CausticPath& path) {
    return techniques.light_tracing.alone && path.film_density > 0.0f;
}

// Whether an estimate comes to the path's first caster by choose_caster().
bool chooses_caster(const ManifoldSettings& settings, const CausticPath& path) {
    if (path.count != 1) return false;
    return settings.finder == ChainFinder::walks ||
           (settings.finder == ChainFinder::mnee &&
            path.vertices[0].interaction == Interaction::reflection);
}

bool camera_sees(const Scene& scene, const SurfaceHit& hit) {
    return (scene.instances[hit.instance].visibility & kVisibleCamera) != 0;
}

bool is_seen_through(const LightSet& lights, uint32_t light) {
    return (light_visibility(lights, light) & kVisibleShadow) == 0;
}

// Whether next event estimation looks for lights at the path's last vertex, or at x.
bool ends_scattered(const CausticPath& path) {
    return path.count == 0 || path.vertices[path.count - 1].rough;
}

// Whether camera chains lead to this light. Not to lights without extent.
bool has_camera_chains(const Techniques& techniques, const LightEnd& end) {
    return techniques.camera_chains->has(end.light) && !end.delta;
}

// Product over the vertices of the probability that a path from the light takes the same lobe.
double probability_from_light(const Scene& scene, const CausticPath& path,
                              std::span<const ChainVertex> chain, const ChainEnd& end) {
    double product = 1.0;
    Surface surface;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (path.vertices[i].probability_from_light > 0.0f) {
            product *= static_cast<double>(path.vertices[i].probability_from_light);
            continue;
        }
        const Vec3 p = chain[i].geometry.p;
        float unused;
        const Vec3 to_light =
            i + 1 < chain.size() ? normalize(chain[i + 1].geometry.p - p) : end.from(p, unused);
        const Vec3 to_receiver = normalize((i > 0 ? chain[i - 1].geometry.p : path.x) - p);
        evaluate_surface(scene, path.vertices[i].hit, to_light, surface);
        product *=
            static_cast<double>(delta_lobe(surface.closures, surface.ng, to_light, to_receiver,
                                           chain[i].interaction == Interaction::refraction)
                                    .probability);
    }
    return product;
}

// Vertex i of a path, as seen from `from`.
ChainVertex chain_vertex(const Scene& scene, const CausticPath& path, uint32_t i, const Vec3& from) {
    const CausticVertex& vertex = path.vertices[i];
    const DifferentialGeometry geometry = evaluate_caster(scene, vertex.hit, false);
    const float eta = eta_seen_from(geometry.ng, from - geometry.p,
                                    scene.material_of(vertex.hit).interface().ior);
    return {vertex.interaction, eta, geometry};
}

// The bit of the bounce by which a closure makes this interaction.
uint32_t kinds_of(Interaction interaction) {
    return kind_bit(interaction == Interaction::reflection ? BounceKind::glossy
                                                           : BounceKind::transmission);
}

float facet_pdf_at(const Scene& scene, const SurfaceHit& hit, Interaction interaction,
                   const Vec3& wi, const Vec3& wo) {
    const SpecularInterface& interface = scene.material_of(hit).interface();
    const DifferentialGeometry geometry = evaluate_caster(scene, hit, false);
    return facet_pdf(interface, geometry, interaction,
                     eta_seen_from(geometry.ng, wi, interface.ior), wi, wo);
}

// Density of next event estimation at x, or at the last vertex, which is at `last`. `before`:
// product of the probabilities of the lobes before that.
double direct_density(const CausticPath& path, double before, const Vec3& last, const LightEnd& end,
                      double geometry) {
    const auto pdf = static_cast<double>(end.pdf_direct);
    if (path.count == 0) return pdf * (end.delta ? 1.0 : geometry);
    const double squared =
        end.delta && !end.end.distant ? static_cast<double>(length_squared(end.end.p - last)) : 1.0;
    return static_cast<double>(path.pdf_omega) * before * pdf * geometry * squared;
}

// Whether path tracing, which has the mean over a footprint, comes from the camera to glints at x
// so densely that light paths, which meet one point of their map at a time, would only add noise.
bool left_to_glints(const LightTracing& light_tracing, const CausticPath& path) {
    return path.count == 0 && static_cast<double>(path.film_density * path.glint_exit_pdf) >
                                  light_tracing.beside_glints * light_tracing.paths;
}

}  // namespace

CausticPath camera_path(const Camera& camera, const Vec3& x, const Vec3& w) {
    CausticPath path;
    path.x = x;
    path.sides = {camera.forward(), false};
    path.pdf_omega = camera.film_density_omega(w);
    path.receiver = path.from_camera = true;
    path.begins_rough = false;
    return path;
}

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

void set_film_density(const Scene& scene, const CameraSubpath& camera_subpath,
                      const SurfaceHit& hit, const Vec3& wo, const Vec3& wi, CausticPath& path) {
    path.film_density = camera_subpath.film_density;
    path.glint_exit_pdf = 0.0f;
    if (camera_subpath.bounces.scatterings == 0 || camera_subpath.film_density == 0.0f) return;
    Surface from_light;
    evaluate_surface(scene, hit, wi, from_light);
    const float pdf = eval(from_light.closures, from_light.ng, wi, wo).pdf_omega;
    path.film_density = pdf > 0.0f ? camera_subpath.film_density / pdf : 0.0f;
    if (scene.material_of(hit).may_glint()) path.glint_exit_pdf = pdf;
}

uint32_t most_scatterings(const BounceLimits& limits) {
    const uint32_t scatterings =
        std::min({limits.total, limits.diffuse, limits.glossy, limits.transmission});
    return std::max(scatterings, 1u) - 1;  // the receiver scatters once more
}

bool manifold_owns(const Techniques& techniques, const CausticPath& path) {
    return techniques.manifold.enabled && path.receiver && !path.through_caster &&
           !left_to_light_paths(techniques, path) && looks_for(techniques.manifold, path) &&
           searches_all(techniques, path) &&
           (!path.is_rough() ||
            (path.begins_rough && techniques.manifold.finder != ChainFinder::mnee &&
             !light_paths_may_find(techniques, path))) &&
           (path.from_camera ? techniques.camera_chains != nullptr &&
                                   camera_sees(techniques.scene, path.vertices[0].hit)
                             : allowed(techniques.manifold, path.vertices[0].interaction)) &&
           within_limits(techniques.limits, path.before, path);
}

bool light_tracing_owns(const Techniques& techniques, const CausticPath& path) {
    return light_tracing_may_own(techniques, path) &&
           !left_to_glints(techniques.light_tracing, path);
}

bool light_tracing_may_own(const Techniques& techniques, const CausticPath& path) {
    // If caustics by reflection or refraction are switched off, paths behind a scattering do not
    // meet all that light paths meet. The limits of manifold chains hold for light tracing, too.
    const auto [n, reflections, refractions] = path.camera_subpath;
    const BounceCounts whichever{.total = n + reflections + refractions,
                                 .diffuse = n,
                                 .glossy = n + reflections,
                                 .transmission = n + refractions,
                                 .transparent = 0};
    const bool all_seen = techniques.manifold.reflections && techniques.manifold.refractions;
    const bool by_casters = path.count > 0
                                ? path.receiver && !path.is_rough() &&
                                      allowed(techniques.manifold, path.vertices[0].interaction)
                                : path.rough_caster && n > 0;
    return techniques.light_tracing.guide != nullptr && by_casters && path.film_density > 0.0f &&
           std::isfinite(path.film_density) && (n == 0 || all_seen) &&
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
        if (vertex.rough) {
            const ClosureEval at = eval(surface.closures, surface.ng, surface.wo, to_light,
                                        kinds_of(vertex.interaction));
            vertex.probability = at.pdf_omega;
            vertex.facet_pdf =
                facet_pdf_at(scene, vertex.hit, vertex.interaction, surface.wo, to_light);
            throughput *= at.f_cos;
        } else {
            const DeltaLobe lobe = delta_lobe(surface.closures, surface.ng, surface.wo, to_light,
                                              vertex.interaction == Interaction::refraction);
            vertex.probability = lobe.probability;
            throughput *= lobe.throughput;
        }
        if (is_black(throughput)) break;
    }
    return throughput;
}

std::optional<SpecularTransfer> specular_transfer(const Scene& scene, CausticPath& path,
                                                  const Vec3& z) {
    const ChainEnd end{false, z, Vec3(0.0f)};
    const Spectrum throughput = chain_throughput(scene, path, end);
    if (is_black(throughput)) return std::nullopt;
    std::array<ChainVertex, kLongestChain> storage;
    const std::span<ChainVertex> chain(storage.data(), path.count);
    double probability = 1.0;
    Vec3 from = path.x;
    for (uint32_t i = 0; i < path.count; ++i) {
        chain[i] = chain_vertex(scene, path, i, from);
        from = chain[i].geometry.p;
        probability *= static_cast<double>(path.vertices[i].probability);
    }
    const std::optional<ChainDerivative> derivative = chain_derivative(path.x, chain, end);
    const double back = probability_from_light(scene, path, chain, end);
    if (!derivative || !(probability > 0.0) || !(back > 0.0)) return std::nullopt;
    return SpecularTransfer{throughput * static_cast<float>(1.0 / probability),
                            static_cast<float>(probability / (back * derivative->etendue))};
}

std::optional<CausticDensities> caustic_densities(const Techniques& techniques,
                                                  const CausticPath& path, const LightEnd& end) {
    const Scene& scene = techniques.scene;
    std::array<ChainVertex, kLongestChain> storage;
    const std::span<ChainVertex> chain(storage.data(), path.count);
    double probability = 1.0, before_last = 1.0, facets = 1.0;
    Vec3 from = path.x;
    for (uint32_t i = 0; i < path.count; ++i) {
        const CausticVertex& vertex = path.vertices[i];
        chain[i] = chain_vertex(scene, path, i, from);
        DifferentialGeometry& geometry = chain[i].geometry;
        if (vertex.rough) {
            float unused;
            const Vec3 to_light =
                i + 1 < path.count
                    ? normalize(surface_position(scene, path.vertices[i + 1].hit) - geometry.p)
                    : end.end.from(geometry.p, unused);
            const std::optional<Vec2> slope = facet_between(
                geometry, vertex.interaction, chain[i].eta, normalize(from - geometry.p), to_light);
            if (!slope) return std::nullopt;
            lean(geometry, *slope);
            facets *= static_cast<double>(vertex.facet_pdf);
        }
        before_last = probability;
        probability *= static_cast<double>(vertex.probability);
        from = geometry.p;
    }
    const std::optional<ChainDerivative> derivative = chain_derivative(path.x, chain, end.end);
    if (!derivative) return std::nullopt;

    constexpr double kSearchConfidence = 0.5;  // by the noise of its count
    // Parallelograms are larger than what chains at folds take of them.
    constexpr double kFoldConfidence = 0.25;
    CausticDensities p;
    p.geometry = derivative->geometry * static_cast<double>(end.cosine);
    const bool by_manifold = manifold_owns(techniques, path) &&
                             !(path.from_camera && !has_camera_chains(techniques, end));
    if (by_manifold && path.from_camera) {
        p.manifold = techniques.camera_chains->estimates * static_cast<double>(end.pdf);
        p.missed =
            kSearchConfidence * techniques.camera_chains->searches * static_cast<double>(end.pdf);
    } else if (by_manifold) {
        const ManifoldSettings& manifold = techniques.manifold;
        p.manifold = manifold_confidence(techniques, path) * static_cast<double>(end.pdf) * facets;
        // Only random searches look for rough chains.
        if (!path.is_rough()) {
            const auto probability_of_caster = [&] {
                return static_cast<double>(caster_probability(
                    techniques.casters, techniques.casters.of_instance[path.vertices[0].hit.instance],
                    path.x, path.sides, end.end));
            };
            if (chooses_caster(manifold, path)) p.manifold *= probability_of_caster();
            if (manifold.finder == ChainFinder::sheets)
                p.missed = kSearchConfidence * static_cast<double>(manifold.search_probability) *
                           probability_of_caster() * static_cast<double>(end.pdf);
            if (manifold.finder == ChainFinder::mnee && !manifold.biased) p.missed = 0.0;
        }
    }
    if (ends_scattered(path)) p.direct = direct_density(path, before_last, from, end, p.geometry);
    // Next event estimation connects to a lamp without shadow through everything, so rays leave it
    // to that.
    const bool seen_through = is_seen_through(techniques.lights, end.light),
               by_rays = !seen_through || !ends_scattered(path);
    if (!end.delta && by_rays)
        p.path_tracing = static_cast<double>(path.pdf_omega) * probability * p.geometry;
    if (!end.delta && by_rays && by_manifold && !path.is_rough() && path.folds != nullptr)
        p.folds = kFoldConfidence *
                  static_cast<double>(path.folds->pdf(normalize(chain[0].geometry.p - path.x))) *
                  probability * p.geometry;
    // If the camera's rays hit the light as often as seeds find it, path tracing needs no help.
    if (path.from_camera && p.manifold <= p.path_tracing) {
        p.manifold = 0.0;
        p.missed.reset();
    }
    if (sends_light_paths(techniques.lights, end.light) && light_tracing_owns(techniques, path)) {
        float unused;
        const Vec3 wi = chain.empty() ? end.end.from(path.x, unused)
                                      : normalize(chain.front().geometry.p - path.x);
        const Vec3 last = chain.empty() ? path.x : chain.back().geometry.p;
        const float emitted = end.pdf_emitted ? *end.pdf_emitted
                                              : emission_pdf(*techniques.light_tracing.guide,
                                                             end.light, end.end, last);
        const double cos_x = std::abs(static_cast<double>(dot(path.sides.ng, wi)));
        const LightTracing& paths = techniques.light_tracing;
        // Light paths behind a receiver go on with this probability; those that a rough caster
        // scatters always.
        const bool thinned = path.camera_subpath.scatterings > 0 && path.count > 0;
        if (emitted > 0.0f)
            p.light_tracing = paths.paths * (thinned ? paths.goes_on : 1.0) /
                              static_cast<double>(path.film_density) *
                              static_cast<double>(end.pdf) * static_cast<double>(emitted) *
                              probability_from_light(scene, path, chain, end.end) *
                              derivative->geometry * derivative->etendue * cos_x;
    }
    return p;
}

std::optional<CausticVertex> rough_vertex(const Techniques& techniques, const SurfaceHit& hit,
                                          const Vec3& ng, const Vec3& wi) {
    if (techniques.rough_chain_casters.empty() ||
        techniques.rough_chain_casters.of_instance[hit.instance] == kNone)
        return std::nullopt;
    const SpecularInterface& interface = techniques.scene.material_of(hit).interface();
    const Interaction interaction =
        dot(ng, wi) > 0.0f ? Interaction::reflection : Interaction::refraction;
    if (!interface.is_rough() || !has_interaction(interface, interaction)) return std::nullopt;
    return CausticVertex{.hit = hit, .interaction = interaction, .rough = true};
}

float rough_chain_share(const Techniques& techniques, CausticPath path, const LightEnd& end) {
    if (!(end.pdf > 0.0f) || !(end.cosine > 0.0f) || !manifold_owns(techniques, path)) return 0.0f;
    if (is_black(chain_throughput(techniques.scene, path, end.end))) return 0.0f;
    const std::optional<CausticDensities> p = caustic_densities(techniques, path, end);
    return p && p->manifold > 0.0 ? static_cast<float>(p->manifold / p->sum()) : 0.0f;
}

Spectrum left_by_rough_chains(const Techniques& techniques, const RoughVisit& visit, const Vec3& wi,
                              uint32_t kinds, std::span<const CausticVertex> behind,
                              const LightEnd& end) {
    const auto f_cos = [&](uint32_t some) {
        return eval(visit.closures, visit.ng, visit.wo, wi, some).f_cos;
    };
    const Spectrum all = f_cos(kinds);
    if (visit.before->count + 1 + behind.size() > kLongestChain) return all;
    const std::optional<CausticVertex> here = rough_vertex(techniques, visit.hit, visit.ng, wi);
    if (!here) return all;
    CausticPath path = *visit.before;
    path.append(*here);
    for (const CausticVertex& vertex : behind) path.append(vertex);
    const float share = rough_chain_share(techniques, path, end);
    return share > 0.0f ? all - f_cos(kinds & kinds_of(here->interaction)) * share : all;
}

}  // namespace spc
