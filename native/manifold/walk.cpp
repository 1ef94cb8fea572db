// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/walk.h"

namespace spc {

namespace {

struct Iterate {
    SurfaceHit hit;
    DifferentialGeometry geometry;
    ConstraintValue value;
};

class Walk {
public:
    Walk(const Scene& scene, const ManifoldSettings& settings, const ChainQuery& query,
         const Seed& seed, ManifoldStats& stats)
        : scene_(scene),
          settings_(settings),
          query_(query),
          constraint_(constraint_for(settings.constraint, seed.interaction, seed.eta)),
          interaction_(seed.interaction),
          eta_(seed.eta),
          stats_(stats) {}

    // Runs from a hit to convergence: until rounding alone could be what is left of the constraint.
    // A looser end would let points pass that lie just beyond a fold, where there is no solution
    // but a very bright geometry term.
    std::optional<Iterate> run(const SurfaceHit& start, const NormalTarget& target) {
        std::optional<Iterate> current = evaluate(start, target);
        for (int i = 0; current && i < settings_.max_iterations; ++i) {
            if (has_converged(*current)) return current;
            ++stats_.iterations;
            current = step(*current, target);
        }
        return current && has_converged(*current) ? current : std::nullopt;
    }

private:
    static bool has_converged(const Iterate& at) { return at.value.size() < at.value.noise; }

    std::optional<Iterate> evaluate(const SurfaceHit& hit, const NormalTarget& target) const {
        const DifferentialGeometry geometry = aimed_geometry(scene_, hit, target);
        const std::optional<ConstraintValue> value =
            evaluate_constraint(constraint_, interaction_, eta_, query_.x, geometry, query_.end);
        if (!value || !std::isfinite(value->size())) return std::nullopt;
        return Iterate{hit, geometry, *value};
    }

    // A Newton step in the tangent plane, projected back along the ray from x, and halved until the
    // constraint falls.
    std::optional<Iterate> step(const Iterate& from, const NormalTarget& target) {
        const ConstraintValue& value = from.value;
        const std::optional<Vec2> newton = solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y,
                                                    value.dc_dv.y, value.c.x, value.c.y);
        if (!newton) return std::nullopt;
        Vec3 move = (from.geometry.dp_du * newton->x + from.geometry.dp_dv * newton->y) * -1.0f;
        // Farther than the caster's own extent the linear model says nothing.
        const float longest = query_.caster->radius, l = length(move);
        if (!(l < kInfinity)) return std::nullopt;
        if (l > longest) move = move * (longest / l);
        for (int halving = 0; halving <= settings_.max_halvings; ++halving, move = move * 0.5f) {
            const std::optional<SurfaceHit> hit = project(from.geometry.p + move);
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
        const std::optional<Hit> hit = scene_.accel->intersect_alone(
            query_.caster->instance,
            {query_.x, to * (1.0f / distance), 1e-4f * distance, kInfinity});
        if (!hit) return std::nullopt;
        const SpecularInterface& specular = scene_.material_of(hit->surface).specular;
        if (!has_interaction(specular, interaction_)) return std::nullopt;
        return hit->surface;
    }

    const Scene& scene_;
    const ManifoldSettings& settings_;
    const ChainQuery& query_;
    Constraint constraint_;
    Interaction interaction_;
    float eta_;
    ManifoldStats& stats_;
};

// How far a converged iterate may lie from the solution that it stands for, m: the noise of the
// constraint, through dp = p_uv (dC)^-1, and the spacing of positions. Empty on a fold.
std::optional<float> resolution_of(const Iterate& at) {
    const ConstraintValue& value = at.value;
    const std::optional<Vec2> a =
        solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y, value.dc_dv.y, 1.0f, 0.0f);
    const std::optional<Vec2> b =
        solve2x2(value.dc_du.x, value.dc_dv.x, value.dc_du.y, value.dc_dv.y, 0.0f, 1.0f);
    if (!a || !b) return std::nullopt;
    const Vec3 &p = at.geometry.p, &pu = at.geometry.dp_du, &pv = at.geometry.dp_dv;
    const float extent = std::max(length(pu * a->x + pv * a->y), length(pu * b->x + pv * b->y));
    const float spacing = 0x1p-23f * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return extent * value.noise + spacing;
}

}  // namespace

std::optional<ChainRoot> random_walk(const Scene& scene, const ManifoldSettings& settings,
                                     const ChainQuery& query, Pcg& pcg, ManifoldStats& stats) {
    const std::optional<Seed> seed = sample_seed(scene, settings, query, pcg, stats);
    if (seed) return walk_from(scene, settings, query, *seed, stats);
    ++stats.walks;
    return std::nullopt;
}

std::optional<ChainRoot> walk_from(const Scene& scene, const ManifoldSettings& settings,
                                   const ChainQuery& query, const Seed& seed, ManifoldStats& stats) {
    ++stats.walks;
    Walk walk(scene, settings, query, seed, stats);
    SurfaceHit start = seed.hit;
    if (seed.first.smooth_base) {
        const std::optional<Iterate> leaning = walk.run(start, seed.first);
        if (!leaning) return std::nullopt;
        start = leaning->hit;
    }
    const std::optional<Iterate> end = walk.run(start, NormalTarget{});
    if (!end) return std::nullopt;

    float distance_y = 0.0f;
    const Vec3 wi = normalize(query.x - end->geometry.p),
               wo = query.end.from(end->geometry.p, distance_y);
    if (!sides_agree(end->geometry, wi, wo, seed.interaction)) return std::nullopt;
    // Another material, or the back of the surface, where the walk took another index ratio for
    // granted.
    if (eta_seen_from(end->geometry.ng, wi, scene.material_of(end->hit).specular.ior) != seed.eta)
        return std::nullopt;
    const std::optional<float> resolution = resolution_of(*end);
    if (!resolution) return std::nullopt;
    ++stats.converged;
    return ChainRoot{end->hit, end->geometry, seed.interaction, seed.eta, *resolution};
}

bool same_root(const ManifoldSettings& settings, const ChainRoot& a, const ChainRoot& b) {
    if (a.interaction != b.interaction) return false;
    return length(a.geometry.p - b.geometry.p) <=
           settings.identity_factor * (a.resolution + b.resolution);
}

}  // namespace spc
