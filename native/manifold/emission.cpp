// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/emission.h"

#include "math/warp.h"

namespace spc {

namespace {

// Shares of the samples: uniform over a light's whole cone, and over what it sees of the casters.
// The first keeps every density positive, the second bounds what was never learned.
constexpr float kFloor = 0.1f;
constexpr float kAimedShare = 0.25f;
// Points on the casters from which the aim is taken, for all lights together and at least for each.
constexpr uint32_t kAimingPoints = 1u << 18, kMostAimingPoints = 1u << 14, kLeastAimingPoints = 256;

// Sphere around everything from which a local light shines.
struct LightSphere {
    Vec3 center;
    float radius;
};

LightSphere sphere_of(const Bounds& bounds) {
    return {(bounds.lower + bounds.upper) * 0.5f, 0.5f * length(bounds.upper - bounds.lower)};
}

LightSphere sphere_of(const Scene& scene, const LightSet& lights, uint32_t light) {
    if (light >= lights.lamps.size())
        return sphere_of(scene.bounds_of(lights.emissive[light - lights.lamps.size()].instance));
    const Lamp& lamp = lights.lamps[light];
    if (const auto* area = std::get_if<AreaLamp>(&lamp))
        return {area->center, area->length_x + area->length_y};
    if (const auto* sphere = std::get_if<SphereLamp>(&lamp))
        return {sphere->center, sphere->radius};
    return {std::get<PointLamp>(lamp).center, 0.0f};
}

// Area-preserving map between the unit square and a cone around +z.
Vec3 to_cone(const Vec2& place, float one_minus_cos) {
    const Vec2 disk = concentric_disk(place);
    const float h = disk.length2() * one_minus_cos;  // 1 - cos theta
    const float scale = safe_sqrt(one_minus_cos * (2.0f - h));
    return {disk.x * scale, disk.y * scale, 1.0f - h};
}
// Its inverse; empty outside the cone.
std::optional<Vec2> from_cone(const Vec3& w, float one_minus_cos) {
    const float sin2 = w.x * w.x + w.y * w.y;
    // 1 - w.z, without cancellation: cones may be narrower than the spacing of floats below one.
    const float h = w.z > 0.0f ? sin2 / (1.0f + w.z) : 1.0f - w.z;
    if (h > one_minus_cos) return std::nullopt;
    const float radius = std::sqrt(h / one_minus_cos);
    const float scale = sin2 > 0.0f ? radius / std::sqrt(sin2) : 0.0f;
    return concentric_square({w.x * scale, w.y * scale});
}

// Directions from a point of a local light: the unit square's map.
struct Cone {
    Frame frame;
    float one_minus_cos;
};

float cone_around(float radius, float distance) {
    if (distance <= radius) return 2.0f;
    const float sine = radius / distance;
    // 1 - sqrt(1 - s^2), without cancellation
    return sqr(sine) / (1.0f + std::sqrt(1.0f - sqr(sine)));
}

// All casters as the point `y` sees them; every direction if it lies among them. Turned from the
// light's frame by the shortest way, so that a place in the square means much the same part of the
// casters for all points of the light.
Cone cone_from(const EmissionGuide& guide, const LightEmission& emission, const Vec3& y) {
    if (emission.by_beam) return {emission.frame, emission.narrowest};
    const Cone all{emission.frame, 2.0f};
    const Vec3 axis = guide.center - y;
    const float distance = length(axis);
    if (distance <= guide.radius) return all;
    const Vec3 z = axis * (1.0f / distance);
    const float c = dot(emission.frame.z, z);
    if (!(c > 0.0f)) return all;
    const Vec3 turn = cross(emission.frame.z, z);
    const auto turned = [&](const Vec3& v) {
        const Vec3 once = cross(turn, v);
        return v + once + cross(turn, once) * (1.0f / (1.0f + c));
    };
    return {{turned(emission.frame.x), turned(emission.frame.y), z},
            cone_around(guide.radius, distance)};
}

struct Place {
    Vec2 p;
    float density_of_uniform;  // 1/sr or 1/m^2
};
// Empty where the light's square does not reach.
std::optional<Place> place_of(const EmissionGuide& guide, uint32_t light, const ChainEnd& end,
                              const Vec3& p) {
    const auto inside = [](const Vec2& place) {
        return place.x >= 0.0f && place.x < 1.0f && place.y >= 0.0f && place.y < 1.0f;
    };
    const LightEmission& emission = guide.lights[light];
    if (end.distant) {
        const Frame frame = Frame::around(end.direction);
        const Vec3 q = (p - guide.center) * (0.5f / guide.radius);
        const Vec2 place(dot(q, frame.x) + 0.5f, dot(q, frame.y) + 0.5f);
        if (!inside(place)) return std::nullopt;
        return Place{place, 0.25f / sqr(guide.radius)};
    }
    const Cone cone = cone_from(guide, emission, end.p);
    const Vec3 w = cone.frame.to_local(normalize(p - end.p));
    const std::optional<Vec2> place = from_cone(w, cone.one_minus_cos);
    if (!place || !inside(*place)) return std::nullopt;
    return Place{*place, uniform_cone_pdf(cone.one_minus_cos)};
}

// Side of the smallest cell of a light's square in which rays can be told from each other. Finer
// ones would follow the spacing of floats.
float finest_cell(const EmissionGuide& guide, uint32_t light, bool distant) {
    constexpr float kSpacing = 64.0f * 0x1p-24f;  // of directions and, relatively, of positions
    if (distant) return kSpacing * guide.start / guide.radius;
    return kSpacing / std::sqrt(guide.lights[light].narrowest);
}

void enclose_casters(const Scene& scene, std::span<const Caster* const> casters,
                     EmissionGuide& guide) {
    Bounds bounds;
    for (const Caster* caster : casters) {
        bounds.extend(caster->center - caster->half_extent);
        bounds.extend(caster->center + caster->half_extent);
    }
    constexpr float kMargin = 1.001f;  // for points on the sphere itself, and flat casters
    const LightSphere sphere = sphere_of(bounds);
    guide.center = sphere.center;
    guide.radius = sphere.radius * kMargin;
    guide.start = 2.0f * scene.bounds_radius + guide.radius;
}

void face_casters(const LightSphere& light, const EmissionGuide& guide, LightEmission& emission) {
    const Vec3 axis = guide.center - light.center;
    const float distance = length(axis);
    emission.frame = Frame::around(distance > 0.0f ? axis * (1.0f / distance) : Vec3(0, 0, 1));
    emission.narrowest = cone_around(guide.radius, distance + light.radius);
}

void follow_beam(const Lamp& lamp, LightEmission& emission) {
    const LampBeam beam = lamp_beam(lamp);
    if (!(beam.one_minus_cos < emission.narrowest)) return;
    emission.frame = Frame::around(beam.axis);
    emission.narrowest = beam.one_minus_cos;
    emission.by_beam = true;
}

}  // namespace

EmissionGuide aim_at_casters(const Scene& scene, const LightSet& lights, const CasterSet& set,
                             Squares squares, std::span<const EmissionSample> learned) {
    EmissionGuide guide;
    const std::vector<const Caster*> casters = set.aims();
    if (casters.empty() || lights.caustic_selection.empty()) return guide;
    enclose_casters(scene, casters, guide);
    const auto count = lights.count();
    guide.lights.resize(count);
    for (uint32_t light = 0; light < count; ++light) {
        if (lights.is_distant(light)) continue;
        face_casters(sphere_of(scene, lights, light), guide, guide.lights[light]);
        if (squares == Squares::of_beams && light < lights.lamps.size())
            follow_beam(lights.lamps[light], guide.lights[light]);
    }

    std::vector<std::vector<WeightedPoint>> points(count);
    std::vector<double> learned_weight(count, 0.0);
    for (const EmissionSample& sample : learned) {
        points[sample.light].push_back(sample.place);
        learned_weight[sample.light] += static_cast<double>(sample.place.weight);
    }
    const uint32_t aims = std::clamp(kAimingPoints / count, kLeastAimingPoints, kMostAimingPoints);
    for (uint32_t light = 0; light < count; ++light) {
        if (lights.caustic_selection.probability(light) == 0.0f) continue;
        const float weight =
            learned_weight[light] > 0.0
                ? static_cast<float>(learned_weight[light] *
                                     static_cast<double>(kAimedShare / (1.0f - kAimedShare)) / aims)
                : 1.0f;
        Pcg pcg(light);
        for (uint32_t i = 0; i < aims; ++i) {
            const std::optional<LightPoint> y =
                sample_point_of_light(lights, scene, light, {pcg.one(), pcg.one()});
            const Caster& caster = *casters[pcg.bits() % casters.size()];
            const Vec3 p = surface_position(scene, sample_on(caster, pcg));
            if (!y) continue;
            if (const std::optional<Place> place =
                    place_of(guide, light, {y->distant, y->p, y->direction}, p))
                points[light].push_back({place->p, weight});
        }
        guide.lights[light].density = QuadtreeDensity(
            points[light], kFloor, finest_cell(guide, light, lights.is_distant(light)));
    }
    return guide;
}

Ray ray_at(const EmissionGuide& guide, const LightPoint& y, const Vec2& place) {
    if (y.distant) {
        const Frame frame = Frame::around(y.direction);
        const Vec3 across = frame.x * (2.0f * place.x - 1.0f) + frame.y * (2.0f * place.y - 1.0f);
        return {guide.center + across * guide.radius + y.direction * guide.start,
                y.direction * -1.0f};
    }
    const Cone cone = cone_from(guide, guide.lights[y.light], y.p);
    return {y.p, normalize(cone.frame.to_world(to_cone(place, cone.one_minus_cos)))};
}

Vec3 offset_from_light(const Scene& scene, const LightPoint& y, const Vec3& origin,
                       const Vec3& direction) {
    if (y.surface.instance == kNone) return origin;
    return offset_origin({y.p, y.n, position_error(scene, y.surface.instance, y.surface.triangle)},
                         direction);
}

std::optional<Vec2> place_towards(const EmissionGuide& guide, uint32_t light, const ChainEnd& end,
                                  const Vec3& p) {
    const std::optional<Place> place = place_of(guide, light, end, p);
    if (!place) return std::nullopt;
    return place->p;
}

float density_of_uniform(const EmissionGuide& guide, const LightPoint& y) {
    if (y.distant) return 0.25f / sqr(guide.radius);
    return uniform_cone_pdf(cone_from(guide, guide.lights[y.light], y.p).one_minus_cos);
}

EmittedRay emit(const EmissionGuide& guide, const LightPoint& y, const Vec2& u) {
    const QuadtreeDensity::Sample at = guide.lights[y.light].density.sample(u);
    const Ray ray = ray_at(guide, y, at.p);
    return {ray.origin, ray.direction, at.p, at.pdf * density_of_uniform(guide, y)};
}

float emission_pdf(const EmissionGuide& guide, uint32_t light, const ChainEnd& end, const Vec3& p) {
    const std::optional<Place> place = place_of(guide, light, end, p);
    return place ? guide.lights[light].density.pdf(place->p) * place->density_of_uniform : 0.0f;
}

}  // namespace spc
