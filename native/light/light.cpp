// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/light.h"

#include "light/mesh_emitter.h"
#include "light/world.h"
#include "math/triangle.h"

namespace spc {
namespace {

// Share of the choice for casters that goes to all lights alike: power says nothing of where a
// light stands.
constexpr double kEvenShare = 0.2;
// Most parts of emissive meshes that are leaves of the tree: of all meshes, and of one. More take
// long to build.
constexpr uint32_t kMostParts = 1u << 16, kMostPartsOfOne = 1u << 10;

DiscreteDistribution select_by_power(const std::vector<double>& power) {
    double sum = 0.0, count = 0.0;
    for (const double p : power) {
        sum += p;
        count += p > 0.0 ? 1.0 : 0.0;
    }
    std::vector<float> weights(power.size(), 0.0f);
    for (size_t i = 0; i < power.size(); ++i)
        if (power[i] > 0.0)
            weights[i] =
                static_cast<float>((1.0 - kEvenShare) * (power[i] / sum) + kEvenShare / count);
    return DiscreteDistribution(weights);
}

float probability_of(const DiscreteDistribution& selection, uint32_t light) {
    return selection.empty() ? 0.0f : selection.probability(light);
}

// `flux`, and the light's power times `factor`, are what its nodes leave on average.
LightBounds bounds_of(const LightDesc& desc, const Lamp& lamp, double flux, float factor) {
    if (is_sun(lamp))
        return {
            .distant = true, .strength = static_cast<float>(flux), .center = desc.axis() * -1.0f};
    LightBounds bounds{.center = desc.position(), .beam = lamp_beam(lamp)};
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) {
        bounds.strength =
            static_cast<float>(flux) * kInvPi * area->spread.towards(area->normal, area->normal);
        bounds.radius = std::sqrt(sqr(area->length_x) + sqr(area->length_y));
        bounds.cosine = true;
    } else {
        bounds.strength = luminance(desc.power) * factor * 0.25f * kInvPi;
        bounds.radius = desc.radius;
    }
    return bounds;
}

// Paths that know nothing of their other end cannot tell what such a light sends along them.
bool depends_on_kind(const Scene& scene, uint32_t material) {
    return material != kNone && (scene.materials[material]->emission_reads & kReadsRay) != 0;
}

// Through a lamp without shadow nothing is a blocker to be told from others.
LightLinks links_of(const LightDesc& desc) {
    const bool casts_shadow = (desc.visibility & kVisibleShadow) != 0;
    return {desc.links.receivers, casts_shadow ? desc.links.blockers : 0};
}

bool shines_on_casters(const Scene& scene, const LightLinks& links) {
    return links.receivers == 0 ||
           std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& one) {
               return one.turns_light() && is_linked(links.receivers, one.sets.receives);
           });
}

RayState with_length(RayState ray, float length) {
    ray.length = std::isinf(length) ? kFromAfar : length;
    return ray;
}

std::optional<DirectSample> sample_part_from(const LightSet& lights, const Scene& scene,
                                             const LightSet::Leaf& leaf, const Vec3& p,
                                             const Vec2& u, RayState ray) {
    const EmissiveInstance& emitter = lights.emissive[leaf.light - lights.lamps.size()];
    const EmitterPoint q = sample_emitter_part(emitter, leaf.part, scene, u);
    const Vec3 to_q = q.p - p;
    const float d2 = length_squared(to_q);
    if (!(d2 > 0.0f)) return std::nullopt;
    const float d = std::sqrt(d2);
    const Vec3 wi = to_q * (1.0f / d);
    const float cos = std::abs(dot(q.n, wi));
    if (!(cos > 0.0f)) return std::nullopt;
    ray.length = d;
    const Spectrum radiance = surface_emission(scene, q.hit, wi * -1.0f, ray);
    if (is_black(radiance)) return std::nullopt;
    return DirectSample{wi, d, radiance, q.pdf_area * d2 / cos, false, leaf.light, q.hit};
}

}  // namespace

LightSet build_lights(const Scene& scene, uint32_t threads, const LightSet* before) {
    LightSet lights;
    std::vector<LightBounds> light_bounds;
    std::vector<double> caustic_power;
    // Suns and world pour through the disc that the scene's bounding sphere shows them.
    const double radius = scene.bounds_radius > 0.0f ? scene.bounds_radius : 1.0;
    const double disc = std::numbers::pi * radius * radius;
    for (const LightDesc& desc : scene.lights) {
        lights.lamps.push_back(make_lamp(desc));
        const Lamp& lamp = lights.lamps.back();
        if (std::holds_alternative<DiscSun>(lamp))
            lights.disc_suns.push_back(static_cast<uint32_t>(lights.lamps.size() - 1));
        lights.visibility.push_back(desc.visibility);
        lights.links.push_back(links_of(desc));
        const bool seen = (desc.visibility & kVisibleScattered) != 0;
        lights.shadings.push_back(make_lamp_shading(desc));
        const float factor = mean_lamp_factor(scene, lights.shadings.back());
        const double flux = lamp_flux(desc, lamp) * static_cast<double>(factor);
        lights.leaves.push_back({static_cast<uint32_t>(lights.lamps.size() - 1), 0});
        light_bounds.push_back(seen && flux > 0.0 ? bounds_of(desc, lamp, flux, factor)
                                                  : LightBounds{});
        light_bounds.back().receivers = desc.links.receivers;
        const bool feeds = seen && desc.feeds_caustics && !depends_on_kind(scene, desc.material) &&
                           shines_on_casters(scene, desc.links);
        caustic_power.push_back(feeds ? flux * (is_sun(lamp) ? disc : 1.0) : 0.0);
    }
    lights.emissive_of_instance.assign(scene.instances.size(), kNone);
    const auto shines = [](const Instance& instance) {
        return instance.emits && (instance.visibility & kVisibleScattered) != 0;
    };
    const auto shining =
        static_cast<uint32_t>(std::count_if(scene.instances.begin(), scene.instances.end(), shines));
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!shines(instance)) continue;
        std::optional<BuiltEmitter> built =
            build_emitter(scene, i, std::clamp(kMostParts / shining, 1u, kMostPartsOfOne));
        if (!built) continue;
        lights.emissive_of_instance[i] = static_cast<uint32_t>(lights.emissive.size());
        built->emitter.first_leaf = static_cast<uint32_t>(light_bounds.size());
        for (LightBounds& bounds : built->light_bounds) {
            bounds.even = 1.0f / static_cast<float>(built->light_bounds.size());
            bounds.receivers = instance.links.receivers;
            lights.leaves.push_back(
                {lights.of_emitter(lights.emissive_of_instance[i]),
                 static_cast<uint32_t>(light_bounds.size()) - built->emitter.first_leaf});
            light_bounds.push_back(bounds);
        }
        lights.emissive.push_back(std::move(built->emitter));
        lights.visibility.push_back(instance.visibility | kVisibleShadow);
        lights.links.push_back(instance.links);
        caustic_power.push_back(shines_on_casters(scene, instance.links) ? built->flux : 0.0);
    }
    build_world(scene, lights, threads, before);
    if (lights.has_world) {
        lights.visibility.push_back(scene.environment.visibility | kVisibleShadow);
        lights.links.push_back({});
        const bool seen = (scene.environment.visibility & kVisibleScattered) != 0;
        LightBounds bounds{.distant = true};
        // Irradiance, on average over all orientations of what it falls on.
        if (seen) bounds.strength = static_cast<float>(0.25 * world_excess(lights));
        lights.leaves.push_back({lights.of_world(), 0});
        light_bounds.push_back(bounds);
        const bool feeds = seen && scene.environment.feeds_caustics;
        caustic_power.push_back(feeds ? world_excess_of_peaks(lights) * disc : 0.0);
    }
    for (uint32_t i = 0; i < lights.links.size(); ++i)
        if (lights.links[i].blockers != 0) lights.shadow_linked.push_back(i);
    lights.tree = LightTree(light_bounds);
    lights.caustic_selection = select_by_power(caustic_power);
    return lights;
}

uint32_t light_visibility(const LightSet& lights, uint32_t light) {
    return lights.visibility[light];
}

bool shines_on(const LightSet& lights, uint32_t light, uint64_t receives) {
    return is_linked(lights.links[light].receivers, receives);
}

uint64_t blockers_of(const LightSet& lights, uint32_t light) {
    return lights.links[light].blockers;
}

bool sends_light_paths(const LightSet& lights, uint32_t light) {
    return (lights.visibility[light] & kVisibleShadow) != 0 && lights.links[light].blockers == 0;
}

Spectrum radiance_of_lamp(const LightSet& lights, const Scene& scene, uint32_t light, const Vec3& q,
                          const Vec3& away, const RayState& ray) {
    const Lamp& lamp = lights.lamps[light];
    const Spectrum radiance = lamp_radiance(lamp, q, away);
    if (is_black(radiance)) return radiance;
    return radiance * lamp_factor(scene, lamp, lights.shadings[light], q, away, ray);
}

LitPoint lit_point(const Scene& scene, const Surface& surface) {
    return {surface.p, has_smooth_transmission(surface.closures) ? Vec3(0.0f) : surface.ng,
            scene.instances[surface.hit.instance].sets.receives};
}

namespace {

std::optional<DirectSample> sample_leaf(const LightSet& lights, const Scene& scene,
                                        const LitPoint& at, const LightTree::Sample& chosen,
                                        const Vec2& u, const RayState& ray) {
    const LightSet::Leaf& leaf = lights.leaves[chosen.light];
    if (!shines_on(lights, leaf.light, at.receives)) return std::nullopt;
    std::optional<DirectSample> sample;
    if (leaf.light < lights.lamps.size()) {
        const Lamp& lamp = lights.lamps[leaf.light];
        if (const std::optional<LampSample> s = sample_lamp(lamp, at.p, u)) {
            const Spectrum factor =
                lamp_factor(scene, lamp, lights.shadings[leaf.light], at.p + s->wi * s->distance,
                            s->wi * -1.0f, with_length(ray, s->distance));
            sample = {s->wi, s->distance, s->radiance * factor, s->density, s->delta, leaf.light};
        }
    } else if (leaf.light == lights.of_world()) {
        if (const std::optional<WorldSample> s = sample_world(lights, u))
            sample = {s->wi,        kInfinity, world_radiance(lights, scene, s->wi, ray),
                      s->pdf_omega, false,     leaf.light};
    } else {
        sample = sample_part_from(lights, scene, leaf, at.p, u, ray);
    }
    if (!sample) return std::nullopt;
    sample->density *= chosen.probability;
    sample->weight = chosen.weight;
    return sample;
}

}  // namespace

std::optional<DirectSample> sample_direct(const LightSet& lights, const Scene& scene,
                                          const LitPoint& at, const Vec3& u, const RayState& ray) {
    if (lights.tree.empty()) return std::nullopt;
    return sample_leaf(lights, scene, at, lights.tree.sample(at, u.x), {u.y, u.z}, ray);
}

std::optional<DirectSample> sample_direct_first(const LightSet& lights, const Scene& scene,
                                                const LitPoint& at, const Vec3& u,
                                                const RayState& ray) {
    if (lights.tree.empty()) return std::nullopt;
    return sample_leaf(lights, scene, at, lights.tree.first_of_two(at, u.x), {u.y, u.z}, ray);
}

std::optional<DirectSample> sample_direct_second(const LightSet& lights, const Scene& scene,
                                                 const LitPoint& at, const Vec3& u,
                                                 const RayState& ray) {
    const float chosen = u.x / LightTree::kSecond;
    if (!(chosen < 1.0f)) return std::nullopt;
    return sample_leaf(lights, scene, at, lights.tree.second_of_two(at, chosen), {u.y, u.z}, ray);
}

float pdf_direct_lamp(const LightSet& lights, const LitPoint& at, const Vec3& wi, const Hit& hit) {
    return lights.tree.probability(hit.light, at) *
           lamp_pdf(lights.lamps[hit.light], at.p, wi, hit.t);
}

float pdf_direct_surface(const LightSet& lights, const Scene& scene, const LitPoint& at,
                         const Vec3& wi, const Hit& hit) {
    const uint32_t index = lights.emissive_of_instance[hit.surface.instance];
    if (index == kNone) return 0.0f;
    const EmissiveInstance& emitter = lights.emissive[index];
    const float pdf_area = emitter_part_pdf_area(emitter, hit.surface.triangle);
    if (!(pdf_area > 0.0f)) return 0.0f;
    const std::array<Vec3, 3> corner =
        scene.triangle_world(hit.surface.instance, hit.surface.triangle);
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const float d2 = length_squared(corner[0] + e1 * hit.surface.u + e2 * hit.surface.v - at.p);
    const float cos = std::abs(dot(unit_normal(e1, e2), wi));
    if (!(cos > 0.0f)) return 0.0f;
    const uint32_t leaf = emitter.first_leaf + emitter.places[hit.surface.triangle].part;
    return lights.tree.probability(leaf, at) * pdf_area * d2 / cos;
}

float pdf_direct_world(const LightSet& lights, const LitPoint& at, const Vec3& wi) {
    if (!lights.has_world) return 0.0f;
    const float probability = lights.tree.probability(lights.world_leaf(), at);
    return probability > 0.0f ? probability * world_pdf(lights, wi) : 0.0f;
}

float pdf_direct_sun(const LightSet& lights, const LitPoint& at, uint32_t light, const Vec3& wi) {
    return lights.tree.probability(light, at) *
           lamp_pdf(lights.lamps[light], Vec3(0.0f), wi, kInfinity);
}

Spectrum world_radiance(const LightSet& lights, const Scene& scene, const Vec3& direction,
                        RayState ray) {
    if (lights.world_is_constant) return lights.world_constant;
    if (scene.environment.material == kNone) return Spectrum(0.0f);
    ray.length = kFromAfar;
    return evaluate_background(scene.materials[scene.environment.material], scene.images, direction,
                               ray, scene.view);
}

std::optional<LightPoint> sample_point_of_light(const LightSet& lights, const Scene& scene,
                                                uint32_t light, const Vec2& u) {
    const Vec3 none(0.0f);
    LightPoint y{light, false, false, none, none, none, {kNone, 0, 0, 0}, 0.0f};
    if (light < lights.lamps.size()) {
        const Lamp& lamp = lights.lamps[light];
        const LampPoint point = sample_lamp_point(lamp, u);
        y.distant = is_sun(lamp);
        y.delta = is_delta(lamp);
        y.p = point.p;
        y.n = point.n;
        y.direction = point.direction;
        y.pdf = point.pdf;
    } else if (light == lights.of_world()) {
        const std::optional<WorldSample> s = sample_world_peaks(lights, u);
        if (!s) return std::nullopt;
        y.distant = true;
        y.direction = s->wi;
        y.pdf = s->pdf_omega;
    } else {
        const EmitterPoint q =
            sample_emitter(lights.emissive[light - lights.lamps.size()], scene, u);
        y.p = q.p;
        y.n = q.n;
        y.surface = q.hit;
        y.pdf = q.pdf_area;
    }
    return y;
}

std::optional<LightPoint> sample_light_point(const LightSet& lights, const Scene& scene,
                                             const Vec3& u) {
    if (lights.caustic_selection.empty()) return std::nullopt;
    const DiscreteDistribution::Sample chosen = lights.caustic_selection.sample(u.x);
    std::optional<LightPoint> y = sample_point_of_light(lights, scene, chosen.index, Vec2(u.y, u.z));
    if (y) y->pdf *= chosen.probability;
    return y;
}

namespace {

Spectrum even_radiance_at(const Lamp& lamp, const LightPoint& y, const Vec3& away) {
    if (const auto* sun = std::get_if<DiscSun>(&lamp)) return sun->radiance;
    if (y.delta) return delta_strength(lamp, away);
    // A sphere's inner side is lit for those inside, but hidden by the outer one from here.
    if (dot(y.n, away) <= 0.0f) return Spectrum(0.0f);
    return lamp_radiance(lamp, y.p, away);
}

}  // namespace

Spectrum radiance_at(const LightSet& lights, const Scene& scene, const LightPoint& y,
                     const Vec3& away, float length) {
    const RayState ray = with_length({}, y.distant ? kInfinity : length);
    if (y.light >= lights.lamps.size())
        return y.distant ? world_radiance(lights, scene, y.direction)
                         : surface_emission(scene, y.surface, away, ray);
    const Lamp& lamp = lights.lamps[y.light];
    const Spectrum even = even_radiance_at(lamp, y, away);
    if (is_black(even)) return even;
    return even * lamp_factor(scene, lamp, lights.shadings[y.light], y.p, away, ray);
}

bool shines_by_length(const LightSet& lights, const Scene& scene, const LightPoint& y) {
    if (y.distant) return false;
    const uint32_t material = y.light < lights.lamps.size()
                                  ? lights.shadings[y.light].material
                                  : scene.material_index(y.surface.instance, y.surface.triangle);
    return material != kNone && (scene.materials[material]->emission_reads & kReadsRayLength) != 0;
}

Spectrum brightest_at(const LightSet& lights, const Scene& scene, const LightPoint& y,
                      const Vec3& p, const Vec3& away) {
    if (y.light >= lights.lamps.size() || y.distant || y.delta)
        return radiance_at(lights, scene, y, away, length(p - y.p));
    return brightest_radiance(lights.lamps[y.light], p) *
           mean_lamp_factor(scene, lights.shadings[y.light]);
}

bool shows_itself(const LightSet& lights, const LightPoint& y, const Vec3& p) {
    return y.light >= lights.lamps.size() || lamp_shows(lights.lamps[y.light], y.p, p);
}

Vec3 light_begins(const LightSet& lights, const LightPoint& y, const Vec3& p) {
    return y.light < lights.lamps.size() ? lamp_light_begins(lights.lamps[y.light], y.p, p) : y.p;
}

float pdf_light_point_lamp(const LightSet& lights, const Hit& hit) {
    return probability_of(lights.caustic_selection, hit.light) *
           lamp_point_pdf(lights.lamps[hit.light]);
}

float pdf_light_point_surface(const LightSet& lights, const SurfaceHit& hit) {
    const uint32_t emitter = lights.emissive_of_instance[hit.instance];
    if (emitter == kNone) return 0.0f;
    return probability_of(lights.caustic_selection, lights.of_emitter(emitter)) *
           emitter_pdf_area(lights.emissive[emitter], hit.triangle);
}

float pdf_light_point_world(const LightSet& lights, const Vec3& wi) {
    if (!lights.has_world) return 0.0f;
    const float probability = probability_of(lights.caustic_selection, lights.of_world());
    return probability > 0.0f ? probability * world_peaks_pdf(lights, wi) : 0.0f;
}

float pdf_light_point_sun(const LightSet& lights, uint32_t light, const Vec3& wi) {
    return probability_of(lights.caustic_selection, light) * lamp_point_pdf(lights.lamps[light]) *
           (in_disc(std::get<DiscSun>(lights.lamps[light]), wi) ? 1.0f : 0.0f);
}

float pdf_direct(const LightSet& lights, const Scene& scene, const LitPoint& at,
                 const LightPoint& y) {
    const bool lamp = y.light < lights.lamps.size();
    if (y.delta) return lights.tree.probability(y.light, at);
    if (y.distant)
        return lamp ? pdf_direct_sun(lights, at, y.light, y.direction)
                    : pdf_direct_world(lights, at, y.direction);
    const Vec3 to = y.p - at.p;
    const float distance = length(to);
    const Vec3 wi = to * (1.0f / distance);
    return lamp ? pdf_direct_lamp(lights, at, wi, {distance, y.light, y.surface})
                : pdf_direct_surface(lights, scene, at, wi, {distance, kNone, y.surface});
}

LightPoint light_point_of(const LightSet& lights, const Scene& scene, const Vec3& p,
                          const DirectSample& sample) {
    const bool distant = std::isinf(sample.distance), lamp = sample.light < lights.lamps.size();
    LightPoint y{sample.light, distant,   sample.delta,   Vec3(0.0f),
                 Vec3(0.0f),   sample.wi, sample.surface, 0.0f};
    if (!distant) y.p = p + sample.wi * sample.distance;
    if (!lamp && distant) {
        y.pdf = pdf_light_point_world(lights, sample.wi);
    } else if (!lamp) {
        y.n = front_normal(scene, y.surface.instance, y.surface.triangle);
        y.pdf = pdf_light_point_surface(lights, y.surface);
    } else if (sample.delta) {
        y.pdf = probability_of(lights.caustic_selection, y.light);
    } else if (distant) {
        y.pdf = pdf_light_point_sun(lights, y.light, sample.wi);
    } else {
        y.p = lamp_point_seen(lights.lamps[y.light], p, sample.wi, sample.distance);
        y.n = lamp_normal(lights.lamps[y.light], y.p);
        y.pdf = pdf_light_point_lamp(lights, {sample.distance, y.light, y.surface});
    }
    return y;
}

namespace {

RayEnd end_on_lamp(const Vec3& p, const Vec3& n) {
    return {{false, p, Vec3(0.0f)}, n, position_error(p), kRayError};
}

}  // namespace

RayEnd ray_end(const LightSet& lights, const Scene& scene, const Vec3& p,
               const DirectSample& sample) {
    if (std::isinf(sample.distance)) return {{true, Vec3(0.0f), sample.wi}};
    const Vec3 y = p + sample.wi * sample.distance;
    if (sample.light >= lights.lamps.size()) return end_on(scene, sample.surface, y);
    return end_on_lamp(y, sample.delta ? Vec3(0.0f) : lamp_normal(lights.lamps[sample.light], y));
}

RayEnd ray_end(const Scene& scene, const LightPoint& y) {
    if (y.distant) return {{true, y.p, y.direction}};
    return y.surface.instance == kNone ? end_on_lamp(y.p, y.n) : end_on(scene, y.surface, y.p);
}

}  // namespace spc
