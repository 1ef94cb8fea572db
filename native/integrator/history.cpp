// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/history.h"

namespace spc {

CameraApproach PathHistory::approach_to(const Scene& scene, const BounceLimits& limits,
                                        const Surface& next) const {
    if (!has_scattered() || caustic.film_per_area == 0.0f ||
        caustic.approach.scatterings >= most_scatterings(limits))
        return {};
    CameraApproach result{0.0f, caustic.approach};
    ++result.bounces.scatterings;
    Vec3 first = next.p, last = caustic.x;
    float density = 1.0f;
    if (caustic.count > 0) {
        CausticPath between = caustic;
        const std::optional<Turns> turns = turns_between(scene, between, next.p);
        if (!turns) return {};
        density = turns->density;
        for (uint32_t i = 0; i < caustic.count; ++i)
            result.bounces.add_turn(caustic.vertices[i].interaction);
        first = surface_position(scene, caustic.vertices[0].hit);
        last = surface_position(scene, caustic.vertices[caustic.count - 1].hit);
    }
    const float cos_next = dot(next.ng, normalize(next.p - last)),
                cos_x = dot(caustic.sides.ng, normalize(first - caustic.x));
    result.film_per_area =
        caustic.film_per_area * caustic.pdf_omega * density * std::abs(cos_next / cos_x);
    return result;
}

bool LightHistory::append_delta(const Surface& surface, const ClosureSample& sample,
                                const CasterSet& casters) {
    if (!sample.on_caster_normal || casters.of_instance[surface.hit.instance] == kNone ||
        count == kLongestChain)
        return false;
    through_caster = through_caster || (count > 0 && passed_caster);
    passed_caster = false;
    const float probability =
        delta_lobe(surface.closures, surface.ng, surface.wo, sample.wi, sample.refracted).probability;
    vertices[count++] = {
        surface.p,
        {.hit = surface.hit,
         .interaction = sample.refracted ? Interaction::refraction : Interaction::reflection,
         .probability_from_light = probability}};
    return true;
}

Vec3 LightHistory::direction_back(const ChainEnd& end, const Vec3& p) const {
    float unused;
    if (!has_scattered() && count == 0) return end.from(p, unused);
    return normalize((count > 0 ? vertices[count - 1].p : last) - p);
}

std::optional<LightHistory::Arrival> LightHistory::arrive(const Scene& scene, const ChainEnd& end,
                                                          uint32_t light_visibility,
                                                          const Surface& surface) const {
    const Vec3 wi = direction_back(end, surface.p);
    const bool straight = !has_scattered() && count == 0;
    const ClosureEval at = eval(surface.closures, surface.ng, surface.wo, wi,
                                straight ? kinds_seeing(light_visibility) : kAllKinds);
    if (is_black(at.f_cos)) return std::nullopt;
    CausticPath back;
    back.x = surface.p;
    append_back(back);
    if (has_scattered()) {
        if (!(at.pdf_omega > 0.0f)) return std::nullopt;
        Arrival arrival{path, throughput * at.f_cos * (1.0f / at.pdf_omega)};
        arrival.path.film_per_area *= at.pdf_omega / std::abs(dot(surface.ng, wi));
        if (count == 0) return arrival;
        const std::optional<Turns> turns = turns_between(scene, back, last);
        if (!turns) return std::nullopt;
        arrival.path.film_per_area *= turns->density;
        arrival.throughput *= turns->weight;
        for (uint32_t i = 0; i < count; ++i)
            arrival.path.approach.add_turn(vertices[i].vertex.interaction);
        return arrival;
    }
    back.sides = {surface.ng, has_smooth_transmission(surface.closures)};
    back.pdf_omega = at.pdf_omega;
    back.receiver = true;
    back.rough_caster = scene.instances[surface.hit.instance].rough_caster;
    back.through_caster = through_caster || passed_caster;
    back.film_per_area = 1.0f;
    if (scene.material_of(surface.hit).may_glint()) back.leave_of_glints = 1.0f;
    const Spectrum along = chain_throughput(scene, back, end);
    return Arrival{back, at.f_cos * along};
}

void LightHistory::append_smooth(const Surface& surface, const Arrival& arrival, float pdf) {
    path = arrival.path;
    ++path.approach.scatterings;
    if (path.approach.scatterings == 1) path.leave_of_glints *= pdf;
    path.film_per_area *= std::abs(dot(surface.ng, surface.wo)) / pdf;
    throughput = arrival.throughput;
    last = surface.p;
    count = 0;
}

void LightHistory::append_back(CausticPath& back) const {
    for (uint32_t k = count; k-- > 0;) back.append(vertices[k].vertex);
}

}  // namespace spc
