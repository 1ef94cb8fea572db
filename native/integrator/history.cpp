// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/history.h"

namespace spc {

CameraSubpath PathHistory::camera_subpath_to(const Scene& scene, const BounceLimits& limits,
                                             const Surface& next) const {
    if (!has_scattered() || caustic.film_density == 0.0f ||
        caustic.camera_subpath.scatterings >= most_scatterings(limits))
        return {};
    CameraSubpath result{0.0f, caustic.camera_subpath};
    ++result.bounces.scatterings;
    Vec3 first = next.p, last = caustic.x;
    float density = 1.0f;
    if (caustic.count > 0) {
        CausticPath between = caustic;
        const std::optional<SpecularTransfer> transfer = specular_transfer(scene, between, next.p);
        if (!transfer) return {};
        density = transfer->density;
        for (uint32_t i = 0; i < caustic.count; ++i)
            result.bounces.add_turn(caustic.vertices[i].interaction);
        first = surface_position(scene, caustic.vertices[0].hit);
        last = surface_position(scene, caustic.vertices[caustic.count - 1].hit);
    }
    const float cos_next = dot(next.ng, normalize(next.p - last)),
                cos_x = dot(caustic.sides.ng, normalize(first - caustic.x));
    result.film_density =
        caustic.film_density * caustic.pdf_omega * density * std::abs(cos_next / cos_x);
    return result;
}

bool LightHistory::append_delta(const Surface& surface, const ClosureSample& sample,
                                const CasterSet& casters) {
    if (!sample.on_caster_normal || casters.of_instance[surface.hit.instance] == kNone ||
        count == kLongestChain)
        return false;
    through_caster = through_caster || (count > 0 && crossed_caster);
    crossed_caster = false;
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
        arrival.path.film_density *= at.pdf_omega / std::abs(dot(surface.ng, wi));
        if (count == 0) return arrival;
        const std::optional<SpecularTransfer> transfer = specular_transfer(scene, back, last);
        if (!transfer) return std::nullopt;
        arrival.path.film_density *= transfer->density;
        arrival.throughput *= transfer->weight;
        for (uint32_t i = 0; i < count; ++i)
            arrival.path.camera_subpath.add_turn(vertices[i].vertex.interaction);
        return arrival;
    }
    back.sides = {surface.ng, has_smooth_transmission(surface.closures)};
    back.pdf_omega = at.pdf_omega;
    back.receiver = true;
    back.rough_caster = scene.instances[surface.hit.instance].rough_caster;
    back.through_caster = through_caster || crossed_caster;
    back.film_density = 1.0f;
    if (scene.material_of(surface.hit).may_glint()) back.glint_exit_pdf = 1.0f;
    const Spectrum along = chain_throughput(scene, back, end);
    return Arrival{back, at.f_cos * along};
}

void LightHistory::append_smooth(const Surface& surface, const Arrival& arrival, float pdf) {
    path = arrival.path;
    ++path.camera_subpath.scatterings;
    if (path.camera_subpath.scatterings == 1) path.glint_exit_pdf *= pdf;
    path.film_density *= std::abs(dot(surface.ng, surface.wo)) / pdf;
    throughput = arrival.throughput;
    last = surface.p;
    count = 0;
}

void LightHistory::append_back(CausticPath& back) const {
    for (uint32_t k = count; k-- > 0;) back.append(vertices[k].vertex);
}

}  // namespace spc
