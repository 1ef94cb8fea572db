// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/caster.h"

#include "math/warp.h"

namespace spc {

namespace {

void bound(const Scene& scene, Caster& caster) {
    const Bounds bounds = scene.bounds_of(caster.instance);
    caster.center = (bounds.lower + bounds.upper) * 0.5f;
    caster.half_extent = (bounds.upper - bounds.lower) * 0.5f;
    caster.radius = length(caster.half_extent);
}

template <class Takes>
void tabulate_triangles(const Scene& scene, Caster& caster, const Takes& takes) {
    const Mesh& mesh = scene.meshes[scene.instances[caster.instance].mesh];
    std::vector<float> area(mesh.triangles.size(), 0.0f);
    for (uint32_t t = 0; t < area.size(); ++t) {
        const Material& material = scene.materials[scene.material_index(caster.instance, t)];
        if (!takes(material)) continue;
        caster.mapped_normal = caster.mapped_normal || material.interface().mapped_normal;
        const std::array<Vec3, 3> p = scene.triangle_world(caster.instance, t);
        area[t] = 0.5f * length(cross(p[1] - p[0], p[2] - p[0]));
    }
    caster.triangles = DiscreteDistribution(area);
}

// Moments of the slopes from random points; they only shape seeds, so some thousand points are
// plenty.
void measure_slopes(const Scene& scene, Caster& caster) {
    constexpr int kPoints = 4096;
    Pcg pcg(caster.instance);
    double sum[2] = {0, 0}, squares[2] = {0, 0};
    int used = 0;
    for (int i = 0; i < kPoints; ++i) {
        const SurfaceHit hit = sample_on(caster, pcg);
        const Vec3 local = Frame::around(evaluate_caster(scene, hit, true).n)
                               .to_local(evaluate_caster(scene, hit, false).n);
        if (!(local.z > 0.05f)) continue;
        const double slope[2] = {-local.x / local.z, -local.y / local.z};
        for (int k = 0; k < 2; ++k) {
            sum[k] += slope[k];
            squares[k] += slope[k] * slope[k];
        }
        ++used;
    }
    if (used == 0) return;
    for (int k = 0; k < 2; ++k) {
        const double mean = sum[k] / used;
        caster.slope_mean[k] = static_cast<float>(mean);
        caster.slope_deviation[k] =
            static_cast<float>(std::sqrt(std::max(squares[k] / used - mean * mean, 0.0)));
    }
}

// Bound, up to a factor that is common to all casters, of what a caster throws from `end` at x.
float contribution_bound(const Caster& caster, const Vec3& x, const ReceiverSides& sides,
                         const ChainEnd& end) {
    const Vec3 to_caster = caster.center - x;
    const Vec3 &half = caster.half_extent, &ng = sides.ng;
    const float reach = std::abs(half.x * ng.x) + std::abs(half.y * ng.y) + std::abs(half.z * ng.z);
    const bool wholly_below = dot(to_caster, ng) <= -reach;
    if (wholly_below && !sides.below) return 0.0f;
    const float r2 = sqr(caster.radius), d2 = length_squared(to_caster);
    float cosine = 1.0f, seen = 1.0f;
    if (d2 > r2) {
        const float d = std::sqrt(d2), sin_sphere = caster.radius / d,
                    cos_center = dot(to_caster, ng) / d;
        // Largest cosine inside the sphere's cone.
        const float cos_sphere = safe_sqrt(1.0f - sqr(sin_sphere));
        if (cos_center < cos_sphere && !sides.below)
            cosine = cos_center * cos_sphere + safe_sqrt(1.0f - sqr(cos_center)) * sin_sphere;
        seen = r2 / d2;
    }
    const float lit =
        end.distant ? 1.0f
                    : std::min(1.0f, r2 / std::max(length_squared(caster.center - end.p), 1e-30f));
    return std::max(cosine, 0.0f) * seen * lit;
}

// Share of the probability that is spread evenly over all casters above the horizon: the bound
// takes every caster for evenly bright, a focus is up to some ten times brighter.
constexpr float kEvenShare = 0.1f;

struct BoundSum {
    float total = 0.0f;
    uint32_t possible = 0;
};
BoundSum sum_bounds(const CasterSet& set, const Vec3& x, const ReceiverSides& sides,
                    const ChainEnd& end) {
    BoundSum sum;
    for (const Caster& caster : set.casters) {
        const float b = contribution_bound(caster, x, sides, end);
        sum.total += b;
        sum.possible += b > 0.0f ? 1 : 0;
    }
    return sum;
}
float probability_from(float b, const BoundSum& sum) {
    if (!(b > 0.0f)) return 0.0f;
    return (1.0f - kEvenShare) * b / sum.total + kEvenShare / static_cast<float>(sum.possible);
}

// Of those triangles whose material `takes` says so.
template <class Takes>
Caster caster_of(const Scene& scene, uint32_t instance, const Takes& takes) {
    Caster caster{};
    caster.instance = instance;
    bound(scene, caster);
    tabulate_triangles(scene, caster, takes);
    return caster;
}

void add_caster(CasterSet& set, Caster caster) {
    if (caster.triangles.empty()) return;
    set.of_instance[caster.instance] = static_cast<uint32_t>(set.casters.size());
    set.casters.push_back(std::move(caster));
}

}  // namespace

std::vector<const Caster*> CasterSet::aims() const {
    std::vector<const Caster*> all;
    for (const std::vector<Caster>* some : {&casters, &rough})
        for (const Caster& caster : *some) all.push_back(&caster);
    return all;
}

CasterSet build_casters(const Scene& scene) {
    const auto is_specular = [](const Material& material) { return material.specular.exists(); };
    const auto is_narrow = [](const Material& material) { return !material.narrow_lobe.empty(); };
    CasterSet set;
    set.of_instance.assign(scene.instances.size(), kNone);
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].rough_caster) {
            Caster rough = caster_of(scene, i, is_narrow);
            if (!rough.triangles.empty()) set.rough.push_back(std::move(rough));
        }
        if (scene.instances[i].caster) add_caster(set, caster_of(scene, i, is_specular));
    }
    for (Caster& caster : set.casters)
        if (caster.mapped_normal) measure_slopes(scene, caster);
    return set;
}

CasterSet build_rough_chain_casters(const Scene& scene) {
    const auto turns_light = [](const Material& material) { return material.interface().exists(); };
    const auto is_rough = [&](const Instance& instance) {
        return instance.rough_caster &&
               std::any_of(instance.materials.begin(), instance.materials.end(),
                           [&](uint32_t i) { return scene.materials[i].rough.exists(); });
    };
    CasterSet set;
    set.of_instance.assign(scene.instances.size(), kNone);
    if (std::none_of(scene.instances.begin(), scene.instances.end(), is_rough)) return set;
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        if (scene.instances[i].caster || is_rough(scene.instances[i]))
            add_caster(set, caster_of(scene, i, turns_light));
    return set;
}

SurfaceHit sample_on(const Caster& caster, Pcg& pcg) {
    const uint32_t triangle = caster.triangles.sample(pcg.one()).index;
    const Vec2 b = uniform_triangle(pcg.two());
    return {caster.instance, triangle, b.x, b.y};
}

Vec3 towards_caster(const Caster& caster, const Vec3& x, const Vec2& u) {
    const Vec3 to_center = caster.center - x;
    const float d2 = length_squared(to_center), sin2 = sqr(caster.radius) / d2;
    const float one_minus_cos = sin2 < 1.0f ? sin2 / (1.0f + std::sqrt(1.0f - sin2)) : 2.0f;
    const Vec3 local = uniform_cone(u, one_minus_cos);
    return d2 > 0.0f ? Frame::around(to_center * (1.0f / std::sqrt(d2))).to_world(local) : local;
}

CasterChoice choose_caster(const CasterSet& set, const Vec3& x, const ReceiverSides& sides,
                           const ChainEnd& end, float u) {
    const BoundSum sum = sum_bounds(set, x, sides, end);
    CasterChoice choice;
    float cumulative = 0.0f;
    for (uint32_t i = 0; i < set.casters.size(); ++i) {
        const float probability =
            probability_from(contribution_bound(set.casters[i], x, sides, end), sum);
        if (probability == 0.0f) continue;
        choice = {i, probability};  // the last possible one also takes what rounding leaves over
        cumulative += probability;
        if (u < cumulative) break;
    }
    return choice;
}

float caster_probability(const CasterSet& set, uint32_t caster, const Vec3& x,
                         const ReceiverSides& sides, const ChainEnd& end) {
    return probability_from(contribution_bound(set.casters[caster], x, sides, end),
                            sum_bounds(set, x, sides, end));
}

}  // namespace spc
