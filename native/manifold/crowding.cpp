// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/crowding.h"

#include <numbers>

namespace spc {

namespace {

// The area (m^2) of a caster on which the slope that turns light to one point changes by one in
// both of its directions. With 1 / D = 1 / (distance to the receiver) + 1 / (distance to the
// light), a mirror's slope changes by 1 / 2 D per metre. Returns the mean of the interaction with
// the largest one; 0 if none leads to a surface.
double area_of_a_slope(const Scene& scene, const LightSet& lights, const Caster& caster, Pcg& pcg) {
    constexpr int kRays = 64;
    constexpr std::array kinds{Interaction::reflection, Interaction::refraction};
    std::array<double, kinds.size()> sum{}, count{};
    for (int i = 0; i < kRays; ++i) {
        const SurfaceHit hit = sample_on(caster, pcg);
        const DifferentialGeometry geometry = evaluate_caster(scene, hit, true);
        const SpecularInterface& specular = scene.material_of(hit).specular;
        const Vec2 u = pcg.two();
        const std::optional<LightPoint> y =
            sample_light_point(lights, scene, Vec3(u.x, u.y, pcg.one()));
        if (!y) continue;
        float to_light = kInfinity;
        const Vec3 w = ChainEnd{y->distant, y->p, y->direction}.from(geometry.p, to_light);
        for (size_t k = 0; k < kinds.size(); ++k) {
            if (!has_interaction(specular, kinds[k])) continue;
            RayDual ray = ray_dual_from(w * -1.0f);
            const float eta = eta_seen_from(geometry.ng, w, specular.ior);
            if (!propagate_through_vertex({kinds[k], eta, geometry}, 0.0, ray)) continue;
            const Vec3 out(ray.d);
            const Vec3 origin = offset_origin({geometry.p, geometry.ng, geometry.p_error}, out);
            const std::optional<Hit> next =
                scene.accel->intersect({origin, out, 0.0f, kInfinity}, kVisibleScattered);
            if (!next || next->light != kNone) continue;
            const double distance =
                1.0 / (1.0 / static_cast<double>(next->t) + 1.0 / static_cast<double>(to_light));
            // A refraction needs steeper slopes than a reflection.
            const double bend =
                kinds[k] == Interaction::reflection
                    ? 1.0
                    : std::abs(static_cast<double>(eta) - 1.0) / (static_cast<double>(eta) + 1.0);
            sum[k] += std::pow(2.0 * bend * distance, 2);
            count[k] += 1.0;
        }
    }
    double largest = 0.0;
    for (size_t k = 0; k < kinds.size(); ++k)
        if (count[k] > 0.0) largest = std::max(largest, sum[k] / count[k]);
    return largest;
}

// Adds one to each caster that a chain of this kind meets, however often.
void count_casters(const CasterSet& casters, const ChainKind& kind, std::vector<double>& counts) {
    std::array<uint32_t, kLongestChain> met;
    const auto end =
        std::transform(kind.links.begin(), kind.links.begin() + kind.count, met.begin(),
                       [&](const ChainLink& link) { return casters.of_instance[link.instance]; });
    std::sort(met.begin(), end);
    std::for_each(met.begin(), std::unique(met.begin(), end),
                  [&](uint32_t caster) { counts[caster] += 1.0; });
}

}  // namespace

bool rays_find_all(const Scene& scene, const LightSet& lights) {
    for (uint32_t i = 0; i < lights.count(); ++i) {
        if (lights.caustic_selection.empty() || !(lights.caustic_selection.probability(i) > 0.0f))
            continue;
        const std::optional<LightPoint> y =
            sample_point_of_light(lights, scene, i, Vec2(0.5f, 0.5f));
        if (!y || y->delta || !sends_light_paths(lights, i)) return false;
    }
    return true;
}

std::vector<double> chains_by_maps(const Scene& scene, const LightSet& lights,
                                   const CasterSet& casters, uint32_t seed, const Budget& budget) {
    std::vector<double> chains(casters.casters.size(), 0.0);
    for (size_t i = 0; i < chains.size(); ++i) {
        const Caster& caster = casters.casters[i];
        if (budget.is_cancelled()) break;
        if (!(caster.slope_bends > 0.0)) continue;
        Pcg pcg(mix_bits(seed + (uint64_t{caster.instance} << 32)));
        const double spread = 2.0 * std::numbers::pi *
                              static_cast<double>(caster.slope_deviation.x) *
                              static_cast<double>(caster.slope_deviation.y);
        const double area = area_of_a_slope(scene, lights, caster, pcg);
        chains[i] = caster.slope_bends *
                    (spread > 0.0 ? std::min(area, caster.triangles.total() / spread) : area);
    }
    return chains;
}

std::vector<double> chains_by_sheets(const CasterSet& casters, const SheetPool& sheets,
                                     uint32_t seed, const Budget& budget) {
    constexpr uint32_t kPoints = 256;  // of each sheet
    std::vector<double> sum(casters.casters.size(), 0.0), lit = sum, of_point = sum;
    std::vector<SheetSeed> chain_seeds;
    for (size_t s = 0; s < sheets.size() && !budget.is_cancelled(); ++s) {
        Pcg pcg(mix_bits(seed + (uint64_t{s} << 32)));
        for (const Vec3& p : sheets[s]->lit_points(kPoints, pcg)) {
            chain_seeds.clear();
            sheets[s]->find_seeds(p, Vec3(0.0f), std::numeric_limits<float>::max(), 0.0f,
                                  chain_seeds);
            std::fill(of_point.begin(), of_point.end(), 0.0);
            for (const SheetSeed& chain_seed : chain_seeds)
                if (chain_seed.inside) count_casters(casters, *chain_seed.kind, of_point);
            for (size_t i = 0; i < sum.size(); ++i) {
                sum[i] += of_point[i];
                lit[i] += of_point[i] > 0.0 ? 1.0 : 0.0;
            }
        }
    }
    for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(lit[i], 1.0);
    return sum;
}

}  // namespace spc
