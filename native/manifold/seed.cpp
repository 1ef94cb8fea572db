// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/seed.h"

#include "math/warp.h"

namespace spc {

namespace {

// What x sees of the caster along a direction that is uniform in the cone of its bounding sphere.
// Empty beside it.
std::optional<SurfaceHit> sample_by_direction(const Scene& scene, const ChainQuery& query, Pcg& pcg) {
    const Vec3 direction = towards_caster(*query.caster, query.x, pcg.two());
    // A receiver that is part of the caster must not see itself.
    const float t_near = 1e-4f * query.caster->radius;
    const std::optional<Hit> hit = scene.accel->intersect_alone(
        query.caster->instance, {query.x, direction, t_near, kInfinity});
    if (!hit) return std::nullopt;
    return hit->surface;
}

// A normal that leans as the caster's mapped normals do.
NormalTarget sample_lean(const Caster& caster, Pcg& pcg) {
    // Box-Muller; u in (0, 1].
    const float u = 1.0f - pcg.one(), angle = 2.0f * kPi * pcg.one(),
                r = std::sqrt(-2.0f * std::log(u));
    const float sx = caster.slope_mean.x + caster.slope_deviation.x * r * std::cos(angle);
    const float sy = caster.slope_mean.y + caster.slope_deviation.y * r * std::sin(angle);
    return {true, normalize(Vec3(-sx, -sy, 1.0f))};
}

}  // namespace

DifferentialGeometry aimed_geometry(const Scene& scene, const SurfaceHit& hit,
                                    const NormalTarget& target) {
    DifferentialGeometry geometry = evaluate_caster(scene, hit, target.smooth_base);
    if (!target.smooth_base) return geometry;
    // The leaning normal turns as the smooth one does: dm = (n x dn) x m.
    const Vec3 n = geometry.n;
    geometry.n = Frame::around(n).to_world(target.offset);
    geometry.dn_du = cross(cross(n, geometry.dn_du), geometry.n);
    geometry.dn_dv = cross(cross(n, geometry.dn_dv), geometry.n);
    return geometry;
}

std::optional<Seed> seed_at(const Scene& scene, const ManifoldSettings& settings,
                            const ChainQuery& query, const SurfaceHit& hit,
                            const NormalTarget& first) {
    const Vec3 p = surface_position(scene, hit),
               ng = front_normal(scene, hit.instance, hit.triangle);
    float distance_y = 0.0f;
    const float side_x = dot(ng, query.x - p), side_y = dot(ng, query.end.from(p, distance_y));
    const Interaction interaction =
        side_x * side_y > 0.0f ? Interaction::reflection : Interaction::refraction;
    const SpecularInterface& specular = scene.material_of(hit).specular;
    const bool allowed =
        (interaction == Interaction::reflection ? settings.reflections : settings.refractions) &&
        (settings.family.empty() || settings.family[0] == interaction);
    if (!allowed || !has_interaction(specular, interaction)) return std::nullopt;
    return Seed{hit, interaction, side_x >= 0.0f ? specular.ior : 1.0f / specular.ior, first};
}

std::optional<Seed> sample_seed(const Scene& scene, const ManifoldSettings& settings,
                                const ChainQuery& query, Pcg& pcg, ManifoldStats& stats) {
    const Caster& caster = *query.caster;
    const bool two_stage = settings.two_stage && caster.mapped_normal;
    const NormalTarget first = two_stage ? sample_lean(caster, pcg) : NormalTarget{};
    // By direction the part of a caster next to x gets its share; by area nothing is left out.
    const bool by_area = pcg.one() < settings.seeds_by_area;

    std::optional<Seed> best;
    float best_size = kInfinity;
    for (uint32_t i = 0; i < settings.seed_candidates; ++i) {
        if (!by_area) ++stats.rays;
        const std::optional<SurfaceHit> hit =
            by_area ? sample_on(caster, pcg) : sample_by_direction(scene, query, pcg);
        if (!hit) continue;
        const std::optional<Seed> seed = seed_at(scene, settings, query, *hit, first);
        if (!seed) continue;
        const std::optional<ConstraintValue> value = evaluate_constraint(
            constraint_for(settings.constraint, seed->interaction, seed->eta), seed->interaction,
            seed->eta, query.x, aimed_geometry(scene, *hit, first), query.end);
        if (!value || !(value->size() < best_size)) continue;
        best = seed;
        best_size = value->size();
    }
    return best;
}

}  // namespace spc
