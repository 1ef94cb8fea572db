// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/shooting.h"

#include "bsdf/fresnel.h"

namespace spc {

namespace {

constexpr float kLongestStep = 0.5f;  // rad, at the receiver
// Largest endpoint error that counts as an arrival, whatever the bound of rounding errors: the
// bound says how far off a ray can be, not that it is, and may be larger than the distance to a
// light that no chain leads to. A fifth of the sun's radius.
constexpr float kLargestEndpointError = 1e-3f;  // rad

// Distance along w after which a ray has left the rounding errors of its surface behind, m.
float start_offset(const RayStart& from, const Vec3& w) {
    constexpr float kLeastCosine = 1e-2f;
    return 2.0f * from.error / std::max(std::abs(dot(from.ng, w)), kLeastCosine);
}

// Where light may turn.
const SpecularInterface& interface_at(const Scene& scene, const SurfaceHit& hit,
                                      const FrozenFacets* facets) {
    const Material& material = scene.material_of(hit);
    return facets != nullptr ? material.interface() : material.specular;
}

// The surface there, or its facet.
DifferentialGeometry geometry_at(const Scene& scene, const SurfaceHit& hit,
                                 const SpecularInterface& interface, const FrozenFacets* facets,
                                 uint32_t vertex) {
    DifferentialGeometry geometry = evaluate_caster(scene, hit, false);
    if (interface.is_rough()) lean(geometry, sample_facet(interface, (*facets)[vertex]));
    return geometry;
}

// The endpoint error of a ray, and its derivative.
struct EndpointError {
    Vec2 c;             // angle in two directions, rad
    Vec2 dc_dx, dc_dy;  // derivatives by the two turns at the receiver
    double distance;    // m, to the end; infinite for a distant one
};

std::optional<EndpointError> endpoint_error(const Vec3& last, const RayDual& ray,
                                            const ChainEnd& end) {
    double distance = std::numeric_limits<double>::infinity();
    Vec3d wanted(end.direction);
    if (!end.distant) {
        wanted = Vec3d(end.p) - Vec3d(last);
        distance = length(wanted);
        if (!(distance > 0.0)) return std::nullopt;
        wanted /= distance;
    }
    const Frame frame = Frame::around(Vec3(wanted));
    const Vec3d e1(frame.x), e2(frame.y), &d = ray.d;
    const double a = dot(e1, d), b = dot(e2, d), sine = std::sqrt(a * a + b * b);
    const double angle = std::atan2(sine, dot(wanted, d));
    const double scale = sine > 1e-9 ? angle / sine : 1.0;
    const auto turned = [&](size_t j) {
        const Vec3d by = ray.dd[j] + ray.dp[j] / distance;
        return Vec2(static_cast<float>(dot(e1, by)), static_cast<float>(dot(e2, by)));
    };
    return EndpointError{{static_cast<float>(a * scale), static_cast<float>(b * scale)},
                         turned(0),
                         turned(1),
                         distance};
}

std::optional<Vec2> newton_step(const EndpointError& error) {
    return solve2x2(error.dc_dx.x, error.dc_dy.x, error.dc_dx.y, error.dc_dy.y, -error.c.x,
                    -error.c.y);
}

// A shot: its chain, the ray behind the last vertex, and the endpoint error.
struct Shot {
    Chain chain;
    RayDual ray;
    EndpointError error;
    float noise;  // what rounding leaves of it at an exact solution, up to kLargestEndpointError
    Vec3 w;       // at the receiver
    float first_distance;  // m, to the first vertex
    float size() const { return error.c.length(); }
};

class Shooter {
public:
    Shooter(const Scene& scene, const RayStart& x, const ChainEnd& end, const ChainKind& kind,
            const FrozenFacets* facets, ManifoldStats& stats)
        : scene_(scene), x_(x), end_(end), kind_(kind), facets_(facets), stats_(stats) {}

    // False where the ray does not make it.
    bool fire(const Vec3& w, Shot& shot) const {
        shot.w = w;
        shot.chain.count = kind_.count;
        shot.ray = ray_dual_from(w);
        RayStart from = x_;
        Vec3 d = w;
        for (uint32_t i = 0; i < kind_.count; ++i) {
            const ChainLink& link = kind_.links[i];
            ++stats_.rays;
            const std::optional<Hit> hit = scene_.accel->intersect_alone(
                link.instance, {from.p, d, start_offset(from, d), kInfinity});
            if (!hit) return false;
            const SpecularInterface& specular = interface_at(scene_, hit->surface, facets_);
            if (!has_interaction(specular, link.interaction)) return false;
            shot.chain.hits[i] = hit->surface;
            ChainVertex& vertex = shot.chain.vertices[i];
            vertex.interaction = link.interaction;
            vertex.geometry = geometry_at(scene_, hit->surface, specular, facets_, i);
            vertex.eta = eta_seen_from(vertex.geometry.ng, d * -1.0f, specular.ior);
            // The ray keeps its direction: between sides a millimetre apart that from point to
            // point would be off by what both were rounded.
            const double distance = length(Vec3d(vertex.geometry.p) - Vec3d(from.p));
            if (!(distance > 0.0)) return false;
            if (!propagate_through_vertex(vertex, distance, shot.ray)) return false;
            const Vec3 wi = d * -1.0f;
            d = Vec3(shot.ray.d);
            if (!sides_agree(vertex.geometry, wi, d, link.interaction)) return false;
            if (i == 0) shot.first_distance = static_cast<float>(distance);
            from = {vertex.geometry.p, vertex.geometry.ng, vertex.geometry.p_error};
        }
        return measure_miss(shot);
    }

private:
    bool measure_miss(Shot& shot) const {
        const std::optional<EndpointError> error =
            endpoint_error(shot.chain.vertices[kind_.count - 1].geometry.p, shot.ray, end_);
        if (!error) return false;
        shot.error = *error;
        shot.noise = noise_of(shot, static_cast<float>(error->distance));
        return std::isfinite(shot.noise) && std::isfinite(shot.size());
    }

    // Rounding turns the ray at its start, by positions over distance and by the spacing of
    // barycentrics on large triangles, about as much at each further vertex, and once more at its
    // end.
    float noise_of(const Shot& shot, float last_distance) const {
        const DifferentialGeometry& first = shot.chain.vertices[0].geometry;
        const ChainVertex& last = shot.chain.vertices[kind_.count - 1];
        const float largest = std::max(largest_coordinate(x_.p), largest_coordinate(first.p));
        const float spacing =
            0x1p-24f * std::max(length(first.dp_du), length(first.dp_dv)) / shot.first_distance;
        const float at_start = kUnitRoundoff * (1.0f + largest / shot.first_distance) + spacing;
        const float turn = std::sqrt(shot.error.dc_dx.length2() + shot.error.dc_dy.length2());
        // Near the critical angle the refracted direction magnifies every error by 1 / cos_t.
        const float magnified =
            last.interaction == Interaction::refraction
                ? 1.0f / std::max(
                             std::abs(static_cast<float>(dot(shot.ray.d, Vec3d(last.geometry.n)))),
                             1e-3f)
                : 1.0f;
        const float at_end =
            kUnitRoundoff * (2.0f + largest_coordinate(last.geometry.p) / last_distance) * magnified;
        return std::min(turn * at_start * static_cast<float>(kind_.count) + at_end,
                        kLargestEndpointError);
    }

    const Scene& scene_;
    const RayStart& x_;
    const ChainEnd& end_;
    const ChainKind& kind_;
    const FrozenFacets* facets_;
    ManifoldStats& stats_;
};

float determinant(const Shot& shot) {
    return shot.error.dc_dx.x * shot.error.dc_dy.y - shot.error.dc_dx.y * shot.error.dc_dy.x;
}

// The right singular vector of the smaller singular value.
Vec3 softest_direction(const Shot& shot) {
    const float xx = shot.error.dc_dx.length2(), yy = shot.error.dc_dy.length2(),
                xy = shot.error.dc_dx.x * shot.error.dc_dy.x +
                     shot.error.dc_dx.y * shot.error.dc_dy.y;
    const float angle = 0.5f * (std::atan2(2.0f * xy, xx - yy) + kPi);
    const Frame frame = Frame::around(shot.w);
    return frame.x * std::cos(angle) + frame.y * std::sin(angle);
}

// How far rounding may put the first and the last vertex from those of the solution. False on a
// fold.
bool measure_resolution(const Shot& shot, ChainSolution& solution) {
    const float det = std::abs(solution.determinant);
    const float norm = std::sqrt(shot.error.dc_dx.length2() + shot.error.dc_dy.length2());
    if (!(det > 1e-7f * sqr(norm))) return false;
    const float turn = norm / det * shot.noise;  // of the first direction
    const DifferentialGeometry& first = shot.chain.vertices[0].geometry;
    const DifferentialGeometry& last = shot.chain.vertices[shot.chain.count - 1].geometry;
    const auto spacing = [](const Vec3& p) { return 0x1p-23f * largest_coordinate(p); };
    const float cosine = std::max(std::abs(dot(first.ng, shot.w)), 1e-3f);
    solution.first_resolution = turn * shot.first_distance / cosine + spacing(first.p);
    solution.last_resolution =
        turn * static_cast<float>(length(shot.ray.dp[0]) + length(shot.ray.dp[1])) + spacing(last.p);
    return true;
}

// Probability of following the reflection: Fresnel's term with a floor, so that neither side
// starves. Any positive probability is right, since trials make up for it.
float reflection_probability(const SpecularInterface& interface, float cosine, float eta) {
    constexpr float kFloor = 1.0f / 8;
    if (!interface.reflects || !interface.refracts) return interface.reflects ? 1.0f : 0.0f;
    return std::clamp(facet::dielectric(cosine, eta), kFloor, 1.0f - kFloor);
}

// Follows a ray from its first hit `hit`, which must lie on a caster, through casters.
std::optional<FollowedRay> follow_at_random(const Scene& scene, const ManifoldSettings& settings,
                                            const CasterSet& casters, Ray ray,
                                            std::optional<Hit> hit, uint32_t longest, Pcg& pcg,
                                            ManifoldStats& stats, const FrozenFacets* facets) {
    const std::vector<Interaction>& family = settings.family;
    if (!family.empty()) longest = static_cast<uint32_t>(family.size());
    FollowedRay followed;
    followed.w = ray.direction;
    RayDual dual = ray_dual_from(ray.direction);
    while (hit && hit->light == kNone && casters.of_instance[hit->surface.instance] != kNone) {
        const uint32_t n = followed.kind.count;
        const SpecularInterface& specular = interface_at(scene, hit->surface, facets);
        const DifferentialGeometry geometry = geometry_at(scene, hit->surface, specular, facets, n);
        const float eta = eta_seen_from(geometry.ng, ray.direction * -1.0f, specular.ior);
        const Interaction interaction =
            !family.empty() ? family[n]
            : pcg.one() < reflection_probability(specular, dot(geometry.n, ray.direction), eta)
                ? Interaction::reflection
                : Interaction::refraction;
        if (!has_interaction(specular, interaction)) break;
        if (!propagate_through_vertex({interaction, eta, geometry},
                                      length(Vec3d(geometry.p) - Vec3d(ray.origin)), dual))
            break;
        followed.kind.append({hit->surface.instance, interaction});
        followed.behind[n] = {geometry.p, dual};
        if (followed.kind.count == longest) break;
        const Vec3 out(dual.d);
        const RayStart from{geometry.p, geometry.ng, geometry.p_error};
        ray = {geometry.p, out, start_offset(from, out), kInfinity};
        ++stats.rays;
        hit = scene.accel->intersect(ray, kVisibleScattered);
    }
    if (!family.empty()) followed.fewest = longest;
    if (followed.kind.count < followed.fewest) return std::nullopt;
    return followed;
}

}  // namespace

FrozenFacets freeze_facets(Pcg& pcg) {
    FrozenFacets facets;
    for (Vec2& facet : facets) facet = pcg.two();
    return facets;
}

ChainKind ChainKind::first(uint32_t n) const {
    ChainKind kind;
    for (uint32_t i = 0; i < n; ++i) kind.append(links[i]);
    return kind;
}

ChainKind ChainKind::reversed() const {
    ChainKind kind;
    for (uint32_t i = count; i-- > 0;) kind.append(links[i]);
    return kind;
}

std::optional<ChainSolution> shoot(const Scene& scene, const ManifoldSettings& settings,
                                   const RayStart& x, const ChainEnd& end, const ChainKind& kind,
                                   const Vec3& w, int max_halvings, ManifoldStats& stats,
                                   const FrozenFacets* facets) {
    ++stats.walks;
    const Shooter shooter(scene, x, end, kind, facets, stats);
    std::array<Shot, 2> shots;
    Shot *shot = &shots[0], *next = &shots[1];
    if (!shooter.fire(w, *shot)) return std::nullopt;
    for (int i = 0; !(shot->size() < shot->noise); ++i) {
        if (i == settings.max_iterations) return std::nullopt;
        ++stats.iterations;
        std::optional<Vec2> step = newton_step(shot->error);
        if (!step) return std::nullopt;
        const float l = step->length();
        if (!(l < kInfinity)) return std::nullopt;
        if (l > kLongestStep) *step *= kLongestStep / l;
        const Frame frame = Frame::around(shot->w);
        int halvings = 0;
        while (!shooter.fire(normalize(shot->w + frame.x * step->x + frame.y * step->y), *next) ||
               !(next->size() < shot->size())) {
            if (++halvings > max_halvings) return std::nullopt;
            *step *= 0.5f;
        }
        std::swap(shot, next);
    }
    ChainSolution solution{
        kind, shot->chain, 0.0f, 0.0f, shot->w, determinant(*shot), softest_direction(*shot)};
    if (!measure_resolution(*shot, solution)) return std::nullopt;
    ++stats.converged;
    return solution;
}

std::optional<ChainSolution> shoot_across_fold(const Scene& scene, const ManifoldSettings& settings,
                                               const RayStart& x, const ChainEnd& end,
                                               const ChainSolution& solution, float step,
                                               int max_halvings, ManifoldStats& stats) {
    const auto beside = [&](float by) { return normalize(solution.w + solution.softest * by); };
    const Shooter shooter(scene, x, end, solution.kind, nullptr, stats);
    Shot shot;
    if (!shooter.fire(beside(step), shot)) {
        step = -step;
        if (!shooter.fire(beside(step), shot)) return std::nullopt;
    }
    // The fold is where the determinant is zero, and the other solution as far beyond it.
    const float there =
        2.0f * step * solution.determinant / (solution.determinant - determinant(shot));
    if (!(std::abs(there) < kLongestStep)) return std::nullopt;
    const std::optional<ChainSolution> other =
        shoot(scene, settings, x, end, solution.kind, beside(there), max_halvings, stats);
    if (!other || (other->determinant > 0.0f) == (solution.determinant > 0.0f)) return std::nullopt;
    return other;
}

std::optional<ChainSeed> sample_chain(const Scene& scene, const ManifoldSettings& settings,
                                      const RayStart& x, const CasterSet& casters, uint32_t caster,
                                      Pcg& pcg, ManifoldStats& stats, const FrozenFacets* facets) {
    const Caster& first = casters.casters[caster];
    Vec3 w;
    const bool by_area = pcg.one() < settings.seeds_by_area;
    if (by_area) {
        const Vec3 to = surface_position(scene, sample_on(first, pcg)) - x.p;
        const float distance = length(to);
        if (!(distance > 0.0f)) return std::nullopt;
        w = to * (1.0f / distance);
    } else {
        w = towards_caster(first, x.p, pcg.two());
    }
    const Ray ray{x.p, w, start_offset(x, w), kInfinity};
    ++stats.rays;
    const std::optional<FollowedRay> followed = follow_at_random(
        scene, settings, casters, ray, scene.accel->intersect_alone(first.instance, ray),
        settings.longest_chain, pcg, stats, facets);
    if (!followed) return std::nullopt;
    ChainSeed start{followed->kind, w};
    // Light may wait behind any of the vertices; most often behind the last.
    if (settings.family.empty() && pcg.one() < 0.5f)
        start.kind = start.kind.first(
            1 + std::min(static_cast<uint32_t>(pcg.one() * static_cast<float>(start.kind.count)),
                         start.kind.count - 1));
    return start;
}

std::optional<FollowedRay> follow_camera_ray(const Scene& scene, const ManifoldSettings& settings,
                                             Ray ray, const CasterSet& casters, Pcg& pcg,
                                             ManifoldStats& stats) {
    for (;;) {
        ++stats.rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleCamera);
        if (!hit) return std::nullopt;
        if (hit->light == kNone) {
            if (casters.of_instance[hit->surface.instance] != kNone)
                return follow_at_random(scene, settings, casters, ray, hit, kLongestChain, pcg,
                                        stats, nullptr);
            if (!scene.any_transparency) return std::nullopt;
        }
        ray.t_near = past(hit->t);
    }
}

float turn_towards(const FollowedRay::Behind& behind, const ChainEnd& end) {
    const std::optional<EndpointError> error = endpoint_error(behind.p, behind.ray, end);
    const std::optional<Vec2> step = error ? newton_step(*error) : std::nullopt;
    return step ? step->length() : kInfinity;
}

std::optional<ChainSeed> straight_chain(const Scene& scene, const ManifoldSettings& settings,
                                        const RayStart& x, const CasterSet& casters,
                                        const ChainEnd& end, ManifoldStats& stats) {
    constexpr float kEndMargin = 1e-4f;  // of the segment: a light's own surface is not crossed
    float distance = kInfinity;
    ChainSeed start{{}, end.from(x.p, distance)};
    if (!(distance > 0.0f)) return std::nullopt;
    Ray ray{x.p, start.w, start_offset(x, start.w), distance * (1.0f - kEndMargin)};
    for (;;) {
        ++stats.rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleScattered);
        if (!hit) break;
        ray.t_near = past(hit->t);
        if (hit->light != kNone || casters.of_instance[hit->surface.instance] == kNone ||
            !has_interaction(scene.material_of(hit->surface).specular, Interaction::refraction))
            continue;
        if (start.kind.count == settings.longest_chain) return std::nullopt;
        start.kind.append({hit->surface.instance, Interaction::refraction});
    }
    if (start.kind.count == 0) return std::nullopt;
    return start;
}

std::optional<ChainSeed> central_reflection(const RayStart& x, const Caster& caster) {
    const Vec3 to = caster.center - x.p;
    const float distance = length(to);
    if (!(distance > 0.0f)) return std::nullopt;
    ChainSeed start{{}, to * (1.0f / distance)};
    start.kind.append({caster.instance, Interaction::reflection});
    return start;
}

bool same_solution(const ManifoldSettings& settings, const ChainSolution& a, const ChainSolution& b) {
    if (a.kind != b.kind) return false;
    const auto near = [&](const Vec3& p, const Vec3& q, float resolution) {
        return length(p - q) <= settings.identity_factor * resolution;
    };
    const uint32_t last = a.kind.count - 1;
    return near(a.chain.vertices[0].geometry.p, b.chain.vertices[0].geometry.p,
                a.first_resolution + b.first_resolution) &&
           near(a.chain.vertices[last].geometry.p, b.chain.vertices[last].geometry.p,
                a.last_resolution + b.last_resolution);
}

}  // namespace spc
