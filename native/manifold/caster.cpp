// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/caster.h"

#include "math/lanes.h"
#include "math/warp.h"

#include <fmt/format.h>

#include <numbers>

#include <xmmintrin.h>

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

// Statistics of the slopes of the mapped normal in Frame::around(smooth normal).
struct MapSlopes {
    Vec2 mean{0.0f}, deviation{0.0f};
    double bends = 0.0;  // 1/m^2: mean |det d slope / d p|
};
// Random points that they are measured from.
MapSlopes measure_slopes(const Scene& scene, const Caster& caster, int points) {
    Pcg pcg(caster.instance);
    double sum[2] = {0, 0}, squares[2] = {0, 0}, bends = 0.0;
    int used = 0;
    for (int i = 0; i < points; ++i) {
        const SurfaceHit hit = sample_on(caster, pcg);
        const DifferentialGeometry smooth = evaluate_caster(scene, hit, true),
                                   mapped = evaluate_caster(scene, hit, false);
        const Frame frame = Frame::around(smooth.n);
        const Vec3 local = frame.to_local(mapped.n);
        if (!(local.z > 0.05f)) continue;
        const double slope[2] = {-local.x / local.z, -local.y / local.z};
        for (int k = 0; k < 2; ++k) {
            sum[k] += slope[k];
            squares[k] += slope[k] * slope[k];
        }
        // What the map adds to the turn of the smooth normal, which goes with the frame.
        const auto turn = [&](const Vec3& by_map, const Vec3& by_shape) {
            const Vec3 d = frame.to_local(by_map - by_shape) * (1.0f / local.z);
            return Vec2(d.x + static_cast<float>(slope[0]) * d.z,
                        d.y + static_cast<float>(slope[1]) * d.z);
        };
        const Vec2 du = turn(mapped.dn_du, smooth.dn_du), dv = turn(mapped.dn_dv, smooth.dn_dv);
        const float area = length(cross(smooth.dp_du, smooth.dp_dv));
        if (area > 0.0f) bends += static_cast<double>(std::abs(du.x * dv.y - du.y * dv.x) / area);
        ++used;
    }
    MapSlopes slopes;
    if (used == 0) return slopes;
    slopes.bends = bends / used;
    for (int k = 0; k < 2; ++k) {
        const double mean = sum[k] / used;
        slopes.mean[k] = static_cast<float>(mean);
        slopes.deviation[k] =
            static_cast<float>(std::sqrt(std::max(squares[k] / used - mean * mean, 0.0)));
    }
    return slopes;
}

constexpr uint32_t kWidth = CasterPacket::kWidth;

Lanes all_lanes(float v) { return Lanes{} + v; }
Lanes root(Lanes v) { return _mm_sqrt_ps(max(v, Lanes{})); }
Lanes dot(const Lanes* v, const Vec3& w) { return v[0] * w.x + v[1] * w.y + v[2] * w.z; }
Lanes squared_length(const Lanes* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }
struct LaneVectors {
    Lanes v[3];
};
LaneVectors from_to(const Vec3& p, const Lanes* v) { return {v[0] - p.x, v[1] - p.y, v[2] - p.z}; }

// Bound, up to a factor that is common to all casters, of what each throws from `end` at x.
Lanes contribution_bounds(const CasterPacket& casters, const Vec3& x, const ReceiverSides& sides,
                          const ChainEnd& end) {
    const Vec3& ng = sides.ng;
    const Vec3 across(std::abs(ng.x), std::abs(ng.y), std::abs(ng.z));
    const Lanes one = all_lanes(1.0f), none{};
    const LaneVectors to_caster = from_to(x, casters.center);
    const Lanes &r2 = casters.squared_radius, d2 = squared_length(to_caster.v),
                height = dot(to_caster.v, ng);
    const auto outside = d2 > r2;
    const Lanes seen = outside ? r2 / d2 : one;
    Lanes cosine = one;
    if (!sides.below) {
        // The largest inside the sphere's cone.
        const Lanes tangent = root(d2 - r2);
        const Lanes largest = (height * tangent + root((d2 - height * height) * r2)) / d2;
        cosine = outside & (height < tangent) ? largest : one;
        const auto wholly_below = height <= -dot(casters.half_extent, across);
        cosine = wholly_below ? none : cosine;
    }
    Lanes lit = one;
    if (!end.distant) {
        const Lanes to_light = squared_length(from_to(end.p, casters.center).v);
        lit = min(one, r2 / max(to_light, all_lanes(1e-30f)));
    }
    return max(cosine, none) * seen * lit * casters.used;
}

// Share of the probability that is spread evenly over all casters above the horizon: the bound
// takes every caster for evenly bright, a focus is up to some ten times brighter.
constexpr float kEvenShare = 0.1f;

// Sum of the bounds of several casters.
struct BoundSum {
    float total = 0.0f;
    uint32_t possible = 0;

    void add(float bound) {
        total += bound;
        possible += bound > 0.0f ? 1 : 0;
    }
    float probability_among(const BoundSum& all) const {
        if (possible == 0) return 0.0f;
        return (1.0f - kEvenShare) * total / all.total +
               kEvenShare * static_cast<float>(possible) / static_cast<float>(all.possible);
    }
};
BoundSum sum_of(Lanes bounds) {
    BoundSum sum;
    for (uint32_t lane = 0; lane < kWidth; ++lane) sum.add(bounds[lane]);
    return sum;
}
BoundSum sum_bounds(const CasterSet& set, const Vec3& x, const ReceiverSides& sides,
                    const ChainEnd& end) {
    Lanes total{};
    decltype(total > total) possible{};
    for (const CasterPacket& packet : set.packets) {
        const Lanes bounds = contribution_bounds(packet, x, sides, end);
        total += bounds;
        possible -= bounds > Lanes{};
    }
    BoundSum sum;
    for (uint32_t lane = 0; lane < kWidth; ++lane) {
        sum.total += total[lane];
        sum.possible += static_cast<uint32_t>(possible[lane]);
    }
    return sum;
}

// The caster of an instance, with the triangles whose material `takes` accepts.
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
    const size_t index = set.casters.size(), lane = index % kWidth;
    if (lane == 0) set.packets.emplace_back();
    CasterPacket& packet = set.packets.back();
    for (int i = 0; i < 3; ++i) {
        packet.center[i][lane] = caster.center[i];
        packet.half_extent[i][lane] = caster.half_extent[i];
    }
    packet.squared_radius[lane] = sqr(caster.radius);
    packet.used[lane] = 1.0f;
    set.of_instance[caster.instance] = static_cast<uint32_t>(index);
    set.casters.push_back(std::move(caster));
}

// With more chains it takes searches too long to find one again.
constexpr double kMostChainsAtFacets = 3.0;

// Mean number of chains between an x and a y as far away as the caster is large, that turn at
// facets of one slope on a mapped rough surface. Within some area of the surface the half-vector's
// slope takes all values, so this is also the mean number of places in it where the map has a slope
// [Rice44].
double chains_at_facets(const Scene& scene, const Caster& caster,
                        const SpecularInterface& interface) {
    constexpr int kPoints = 1024;  // tell a fine map from a coarse one
    const MapSlopes slopes = measure_slopes(scene, caster, kPoints);
    // Slope by angle: a refraction needs a steeper one than a reflection.
    const double bend = interface.refracts ? (interface.ior - 1.0) / (interface.ior + 1.0) : 1.0;
    const double spread = 2.0 * std::numbers::pi * static_cast<double>(slopes.deviation.x) *
                          static_cast<double>(slopes.deviation.y);
    const double all = std::pow(bend * static_cast<double>(caster.radius), 2);
    return slopes.bends * std::min(all, caster.triangles.total() / spread);
}

// Whether chains turn at facets of the instance.
bool turns_at_facets(const Scene& scene, uint32_t index, std::vector<std::string>& report) {
    const Instance& instance = scene.instances[index];
    bool turns = false;
    for (const uint32_t m : instance.materials) {
        const Material& material = scene.materials[m];
        if (!instance.rough_caster || !material.rough.exists()) continue;
        const bool mapped = material.rough.mapped_normal;
        turns = true;
        if (!mapped) continue;
        const Caster part =
            caster_of(scene, index, [&](const Material& one) { return &one == &material; });
        if (part.triangles.empty()) continue;
        const double chains = chains_at_facets(scene, part, material.rough);
        // What has deltas as well takes part as a whole.
        const bool few = instance.caster || chains <= kMostChainsAtFacets;
        report.push_back(
            fmt::format("{}: chains turn at {} of '{}', whose map makes some {:.2g} at once",
                        instance.name, few ? "facets" : "no facets", material.name, chains));
        if (!few) return false;
    }
    return turns;
}

}  // namespace

std::vector<const Caster*> CasterSet::aims() const {
    std::vector<const Caster*> all;
    for (const std::vector<Caster>* some : {&casters, &rough})
        for (const Caster& caster : *some) all.push_back(&caster);
    return all;
}

CasterSet build_casters(const Scene& scene) {
    constexpr int kPoints = 4096;  // only shape seeds
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
    for (Caster& caster : set.casters) {
        if (!caster.mapped_normal) continue;
        const MapSlopes slopes = measure_slopes(scene, caster, kPoints);
        caster.slope_mean = slopes.mean;
        caster.slope_deviation = slopes.deviation;
        caster.slope_bends = slopes.bends;
    }
    return set;
}

CasterSet without(const CasterSet& casters, const std::vector<bool>& left_out) {
    CasterSet set;
    set.rough = casters.rough;
    set.of_instance.assign(casters.of_instance.size(), kNone);
    for (size_t i = 0; i < casters.casters.size(); ++i)
        if (!left_out[i]) add_caster(set, casters.casters[i]);
    return set;
}

CasterSet build_rough_chain_casters(const Scene& scene, std::vector<std::string>& report) {
    const auto turns_light = [](const Material& material) { return material.interface().exists(); };
    CasterSet set;
    set.of_instance.assign(scene.instances.size(), kNone);
    std::vector<bool> rough(scene.instances.size());
    for (uint32_t i = 0; i < rough.size(); ++i) rough[i] = turns_at_facets(scene, i, report);
    if (std::find(rough.begin(), rough.end(), true) == rough.end()) return set;
    for (uint32_t i = 0; i < rough.size(); ++i)
        if (scene.instances[i].caster || rough[i])
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
    const BoundSum all = sum_bounds(set, x, sides, end);
    // First the packet, then the caster. The last possible one also takes what rounding leaves
    // over.
    Lanes bounds{};
    uint32_t first = 0;
    float before = 0.0f, cumulative = 0.0f;
    for (uint32_t i = 0; i < set.packets.size() && !(u < cumulative); ++i) {
        const Lanes here = contribution_bounds(set.packets[i], x, sides, end);
        const float probability = sum_of(here).probability_among(all);
        if (probability == 0.0f) continue;
        bounds = here;
        first = kWidth * i;
        before = cumulative;
        cumulative += probability;
    }
    CasterChoice choice;
    for (uint32_t lane = 0; lane < kWidth; ++lane) {
        BoundSum one;
        one.add(bounds[lane]);
        const float probability = one.probability_among(all);
        if (probability == 0.0f) continue;
        choice = {first + lane, probability};
        before += probability;
        if (u < before) break;
    }
    return choice;
}

float caster_probability(const CasterSet& set, uint32_t caster, const Vec3& x,
                         const ReceiverSides& sides, const ChainEnd& end) {
    BoundSum one;
    one.add(contribution_bounds(set.packets[caster / kWidth], x, sides, end)[caster % kWidth]);
    return one.probability_among(sum_bounds(set, x, sides, end));
}

}  // namespace spc
