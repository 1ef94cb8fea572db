// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/walk.h"

#include "math/warp.h"

namespace spc {

namespace {

struct Iterate {
    SurfaceHit hit;
    CasterPatch patch;
    ConstraintValue value;
};

// The normal that a walk aims for: the surface's own, or, in the first of two stages, the smooth
// one leaning by a fixed slope.
struct NormalTarget {
    bool smooth_base = false;
    Vec3 offset{0.0f, 0.0f, 1.0f};  // unit, in Frame::around(smooth normal)
};

CasterPatch aimed_patch(const Scene& scene, const SurfaceHit& hit, const NormalTarget& target) {
    CasterPatch patch = evaluate_caster(scene, hit, target.smooth_base);
    if (!target.smooth_base) return patch;
    // The leaning normal turns as the smooth one does: dm = (n x dn) x m.
    const Vec3 n = patch.n;
    patch.n = Frame::around(n).to_world(target.offset);
    patch.dn_du = cross(cross(n, patch.dn_du), patch.n);
    patch.dn_dv = cross(cross(n, patch.dn_dv), patch.n);
    return patch;
}

// Whether wi and wo leave the geometric and the shading surface as the interaction demands.
bool sides_agree(const CasterPatch& patch, const Vec3& wi, const Vec3& wo, Interaction interaction) {
    const float geometric = dot(patch.ng, wi) * dot(patch.ng, wo),
                shading = dot(patch.n, wi) * dot(patch.n, wo);
    return interaction == Interaction::reflection ? geometric > 0.0f && shading > 0.0f
                                                  : geometric < 0.0f && shading < 0.0f;
}

class Walk {
public:
    Walk(const Scene& scene, const ManifoldSettings& settings, const ChainQuery& query,
         Interaction interaction, float eta, ManifoldStats& stats)
        : scene_(scene),
          settings_(settings),
          query_(query),
          interaction_(interaction),
          eta_(eta),
          stats_(stats) {}

    // Runs from a hit to convergence.
    std::optional<Iterate> run(const SurfaceHit& start, const NormalTarget& target) {
        std::optional<Iterate> current = evaluate(start, target);
        bool polished = false;
        for (int i = 0; current && i < settings_.max_iterations; ++i) {
            const bool converged = has_converged(*current);
            if (converged && polished) return current;
            ++stats_.iterations;
            std::optional<Iterate> next = step(*current, target);
            if (!next)
                return converged ? current
                                 : std::nullopt;  // at the limit of precision nothing improves
            polished = converged;
            current = next;
        }
        return current && has_converged(*current) ? current : std::nullopt;
    }

private:
    bool has_converged(const Iterate& at) const {
        return at.value.size() < std::max(settings_.tolerance, at.value.noise);
    }

    std::optional<Iterate> evaluate(const SurfaceHit& hit, const NormalTarget& target) const {
        const CasterPatch patch = aimed_patch(scene_, hit, target);
        const std::optional<ConstraintValue> value = evaluate_constraint(
            settings_.constraint, interaction_, eta_, query_.x, patch, query_.end);
        if (!value || !std::isfinite(value->size())) return std::nullopt;
        return Iterate{hit, patch, *value};
    }

    // A Newton step in the tangent plane, projected back along the ray from x, and halved until the
    // constraint falls.
    std::optional<Iterate> step(const Iterate& from, const NormalTarget& target) {
        const ConstraintValue& value = from.value;
        const std::optional<Vec2> newton = solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y,
                                                    value.dc_dv.y, value.c.x, value.c.y);
        if (!newton) return std::nullopt;
        Vec3 move = (from.patch.dp_du * newton->x + from.patch.dp_dv * newton->y) * -1.0f;
        // Farther than the caster's own extent the linear model says nothing.
        const float longest = query_.caster->radius, l = length(move);
        if (!(l < kInfinity)) return std::nullopt;
        if (l > longest) move = move * (longest / l);
        for (int halving = 0; halving <= settings_.max_halvings; ++halving, move = move * 0.5f) {
            const std::optional<SurfaceHit> hit = project(from.patch.p + move);
            if (!hit) continue;
            std::optional<Iterate> next = evaluate(*hit, target);
            if (next && next->value.size() < value.size()) return next;
        }
        return std::nullopt;
    }

    std::optional<SurfaceHit> project(const Vec3& p) const {
        const Vec3 to = p - query_.x;
        const float distance = length(to);
        if (!(distance > 0.0f)) return std::nullopt;
        ++stats_.rays;
        const std::optional<Hit> hit = scene_.accel->intersect_caster(
            query_.caster->instance,
            {query_.x, to * (1.0f / distance), 1e-4f * distance, kInfinity});
        if (!hit) return std::nullopt;
        const SpecularInterface& specular = scene_.material_of(hit->surface).specular;
        if (interaction_ == Interaction::reflection ? !specular.reflects : !specular.refracts)
            return std::nullopt;
        return hit->surface;
    }

    const Scene& scene_;
    const ManifoldSettings& settings_;
    const ChainQuery& query_;
    Interaction interaction_;
    float eta_;
    ManifoldStats& stats_;
};

// A point of the caster, uniform by area.
SurfaceHit sample_by_area(const Caster& caster, Pcg& pcg) {
    const uint32_t triangle = caster.triangles.sample(pcg.one()).index;
    const Vec2 b = uniform_triangle(pcg.two());
    return {caster.instance, triangle, b.x, b.y};
}

// What x sees of the caster along a direction that is uniform in the cone of its bounding sphere.
// Empty beside it.
std::optional<SurfaceHit> sample_by_direction(const Scene& scene, const ChainQuery& query, Pcg& pcg) {
    const Vec3 to_center = query.caster->center - query.x;
    const float d2 = length_squared(to_center), sin2 = sqr(query.caster->radius) / d2;
    const float one_minus_cos = sin2 < 1.0f ? sin2 / (1.0f + std::sqrt(1.0f - sin2)) : 2.0f;
    const Vec3 local = uniform_cone(pcg.two(), one_minus_cos);
    const Vec3 direction =
        d2 > 0.0f ? Frame::around(to_center * (1.0f / std::sqrt(d2))).to_world(local) : local;
    const std::optional<Hit> hit = scene.accel->intersect_caster(
        query.caster->instance, {query.x, direction, 1e-4f * query.caster->radius, kInfinity});
    if (!hit) return std::nullopt;
    const SpecularInterface& specular = scene.material_of(hit->surface).specular;
    if (!specular.reflects && !specular.refracts) return std::nullopt;
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

std::optional<ChainRoot> random_walk(const Scene& scene, const ManifoldSettings& settings,
                                     const ChainQuery& query, Pcg& pcg, ManifoldStats& stats) {
    // By direction the part of a caster next to x gets its share; by area nothing is left out.
    if (pcg.one() < settings.seeds_by_area)
        return walk_from(scene, settings, query, sample_by_area(*query.caster, pcg), pcg, stats);
    ++stats.rays;
    const std::optional<SurfaceHit> seed = sample_by_direction(scene, query, pcg);
    if (seed) return walk_from(scene, settings, query, *seed, pcg, stats);
    ++stats.walks;
    return std::nullopt;
}

std::optional<ChainRoot> walk_from(const Scene& scene, const ManifoldSettings& settings,
                                   const ChainQuery& query, const SurfaceHit& seed, Pcg& pcg,
                                   ManifoldStats& stats) {
    ++stats.walks;
    const Caster& caster = *query.caster;
    const bool two_stage = settings.two_stage && caster.mapped_normal;
    const NormalTarget lean = two_stage ? sample_lean(caster, pcg) : NormalTarget{};

    const Vec3 p = surface_position(scene, seed),
               ng = front_normal(scene, seed.instance, seed.triangle);
    float distance_y;
    const float side_x = dot(ng, query.x - p), side_y = dot(ng, query.end.from(p, distance_y));
    const Interaction interaction =
        side_x * side_y > 0.0f ? Interaction::reflection : Interaction::refraction;
    const SpecularInterface& specular = scene.material_of(seed).specular;
    if (interaction == Interaction::reflection ? !(specular.reflects && settings.reflections)
                                               : !(specular.refracts && settings.refractions))
        return std::nullopt;

    const float eta = side_x >= 0.0f ? specular.ior : 1.0f / specular.ior;
    Walk walk(scene, settings, query, interaction, eta, stats);
    SurfaceHit start = seed;
    if (two_stage) {
        const std::optional<Iterate> leaning = walk.run(seed, lean);
        if (!leaning) return std::nullopt;
        start = leaning->hit;
    }
    const std::optional<Iterate> end = walk.run(start, NormalTarget{});
    if (!end) return std::nullopt;

    const Vec3 wi = normalize(query.x - end->patch.p), wo = query.end.from(end->patch.p, distance_y);
    if (!sides_agree(end->patch, wi, wo, interaction)) return std::nullopt;
    // Another material, or the back of the surface, where the walk took another index ratio for
    // granted.
    if (eta_seen_from(end->patch.ng, wi, scene.material_of(end->hit).specular.ior) != eta)
        return std::nullopt;
    ++stats.converged;

    // dp = p_uv (dC)^-1 tolerance, as a length.
    const ConstraintValue& value = end->value;
    const std::optional<Vec2> a =
        solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y, value.dc_dv.y, 1.0f, 0.0f);
    const std::optional<Vec2> b =
        solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y, value.dc_dv.y, 0.0f, 1.0f);
    float reach = 0.0f;
    if (a && b)
        reach = std::max(length(end->patch.dp_du * a->x + end->patch.dp_dv * a->y),
                         length(end->patch.dp_du * b->x + end->patch.dp_dv * b->y));
    return ChainRoot{end->hit, end->patch, interaction, eta,
                     reach * std::max(settings.tolerance, value.noise)};
}

bool same_root(const ManifoldSettings& settings, const ChainRoot& a, const ChainRoot& b) {
    if (a.interaction != b.interaction) return false;
    const float distance = length(a.patch.p - b.patch.p);
    // Single precision cannot hold positions apart that are closer than some units in the last
    // place.
    const float precision =
        1e-6f * (std::abs(a.patch.p.x) + std::abs(a.patch.p.y) + std::abs(a.patch.p.z));
    return distance <=
           std::max(settings.identity_factor * std::max(a.resolution, b.resolution), precision);
}

}  // namespace spc
