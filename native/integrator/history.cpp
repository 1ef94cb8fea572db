// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/history.h"

namespace spc {

bool LightHistory::append_delta(const Surface& surface, const ClosureSample& sample,
                                const CasterSet& casters) {
    if (scatterings > 0 || !sample.on_caster_normal ||
        casters.of_instance[surface.hit.instance] == kNone || count == kLongestChain)
        return false;
    through_caster = through_caster || (count > 0 && passed_caster);
    passed_caster = false;
    vertices[count++] = {
        surface.p,
        {surface.hit, sample.refracted ? Interaction::refraction : Interaction::reflection, 0.0f}};
    return true;
}

Vec3 LightHistory::direction_back(const ChainEnd& end, const Vec3& p) const {
    float unused;
    if (scatterings == 0 && count == 0) return end.from(p, unused);
    return normalize((scatterings > 0 ? last : vertices[count - 1].p) - p);
}

std::optional<LightHistory::Arrival> LightHistory::arrive(const Scene& scene, const ChainEnd& end,
                                                          uint32_t light_visibility,
                                                          const Surface& surface) const {
    const Vec3 wi = direction_back(end, surface.p);
    const bool straight = scatterings == 0 && count == 0;
    const ClosureEval at = eval(surface.closures, surface.ng, surface.wo, wi,
                                straight ? kinds_seeing(light_visibility) : kAllKinds);
    if (is_black(at.f_cos)) return std::nullopt;
    if (scatterings > 0) {
        if (!(at.pdf_omega > 0.0f)) return std::nullopt;
        Arrival arrival{path, throughput * at.f_cos * (1.0f / at.pdf_omega)};
        arrival.path.film_per_area *= at.pdf_omega / std::abs(dot(surface.ng, wi));
        return arrival;
    }
    Arrival arrival;
    arrival.path.x = surface.p;
    arrival.path.sides = {surface.ng, has_smooth_transmission(surface.closures)};
    arrival.path.pdf_omega = at.pdf_omega;
    arrival.path.receiver = true;
    arrival.path.rough_caster = scene.instances[surface.hit.instance].rough_caster;
    arrival.path.through_caster = through_caster || passed_caster;
    arrival.path.film_per_area = 1.0f;
    arrival.throughput = at.f_cos * trace_back(scene, end, arrival.path);
    return arrival;
}

void LightHistory::append_smooth(const Surface& surface, const Arrival& arrival, float pdf) {
    path = arrival.path;
    path.scatterings = ++scatterings;
    path.film_per_area *= std::abs(dot(surface.ng, surface.wo)) / pdf;
    throughput = arrival.throughput;
    last = surface.p;
}

Spectrum LightHistory::trace_back(const Scene& scene, const ChainEnd& end, CausticPath& path) const {
    for (uint32_t k = count; k-- > 0;) path.vertices[path.count++] = vertices[k].vertex;
    return chain_throughput(scene, path, end);
}

}  // namespace spc
