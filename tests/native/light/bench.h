// SPDX-License-Identifier: GPL-3.0-or-later
// A scene of lights and the ways to look at it that the tests of lights share.
#pragma once

#include "light/light.h"
#include "scene/surface.h"
#include "support/numerics.h"
#include "support/scenes.h"

namespace spc::test {

inline Graph emission(float r, float g, float b, float strength) {
    return single_shader("emission",
                         {{1, "Color", {r, g, b, 1}}, {1, "Strength", {strength, 0, 0, 0}}});
}

inline Transform facing(const Vec3& center, const Vec3& axis, const Vec3& scale = Vec3(1.0f)) {
    const Frame frame = Frame::around(normalize(axis) * -1.0f);
    Transform m;
    for (int i = 0; i < 3; ++i)
        m.row[i] = Vec3(frame.x[i] * scale.x, frame.y[i] * scale.y, frame.z[i] * scale.z);
    m.translation = center;
    return m;
}

// Lamps over the origin that shine down on it, unless `axis` says otherwise.
inline LightDesc point_lamp(float power, float radius, const Vec3& center = {0, 0, 1}) {
    LightDesc light;
    light.name = "point";
    light.type = LightType::point;
    light.to_world = facing(center, {0, 0, -1});
    light.power = Spectrum(power);
    light.radius = radius;
    return light;
}
inline LightDesc soft(LightDesc lamp) {
    lamp.soft_falloff = true;
    return lamp;
}
inline LightDesc spot_lamp(float power, float radius, float angle, float blend,
                           const Vec3& axis = {0, 0, -1}, const Vec3& scale = Vec3(1.0f)) {
    LightDesc light = point_lamp(power, radius);
    light.name = "spot";
    light.type = LightType::spot;
    light.spot_angle = angle;
    light.spot_blend = blend;
    light.to_world = facing({0, 0, 1}, axis, scale);
    return light;
}
inline LightDesc sun_lamp(float irradiance, float angle, const Vec3& axis = {0, 0, -1}) {
    LightDesc light;
    light.name = "sun";
    light.type = LightType::sun;
    light.to_world = facing({0, 0, 5}, axis);
    light.power = Spectrum(irradiance);
    light.sun_angle = angle;
    return light;
}
inline LightDesc area_lamp(float power, AreaShape shape, const Vec2& size,
                           const Vec3& center = {0, 0, 1}, const Vec3& axis = {0, 0, -1},
                           const Vec3& scale = Vec3(1.0f)) {
    LightDesc light;
    light.name = "area";
    light.type = LightType::area;
    light.shape = shape;
    light.size = size;
    light.to_world = facing(center, axis, scale);
    light.power = Spectrum(power);
    return light;
}

// Whose light keeps within half of `spread` about the normal.
inline LightDesc beam(LightDesc area, float spread) {
    area.spread = spread;
    return area;
}

struct Lit {
    std::unique_ptr<Scene> scene;
    LightSet lights;
};
inline Lit freeze(SceneMaker& maker) {
    Lit lit{maker.builder.freeze(1), {}};
    lit.lights = build_lights(*lit.scene, 1);
    return lit;
}
inline Lit lit_by(const std::vector<LightDesc>& lamps) {
    SceneMaker maker;
    for (const LightDesc& lamp : lamps) maker.builder.add_light(lamp);
    return freeze(maker);
}
inline Lit lit_by(const Mesh& mesh, const Graph& graph, const Transform& transform) {
    SceneMaker maker;
    maker.add(mesh, graph, transform);
    return freeze(maker);
}

// Densities of the direction wi from p: as next event estimation and as the manifold sample it,
// summed over all that a ray meets, and the radiance that comes from there. Lamps and suns first,
// then the nearest surface or the world.
struct Seen {
    float pdf_direct = 0.0f;
    float pdf_light_point = 0.0f;  // of the last light that was met
    Spectrum radiance{0.0f};
};
inline Seen look(const Lit& lit, const Vec3& p, const Vec3& wi) {
    Seen seen;
    const Scene& scene = *lit.scene;
    for (uint32_t i = 0; i < scene.lights.size(); ++i) {
        const std::optional<LightSurfaceHit> hit = intersect_light(scene.lights[i], {p, wi});
        if (!hit) continue;
        const Hit as_hit{hit->t, i, {}};
        seen.pdf_direct += pdf_direct_lamp(lit.lights, p, wi, as_hit);
        seen.pdf_light_point = pdf_light_point_lamp(lit.lights, as_hit);
        seen.radiance += lamp_radiance(lit.lights.lamps[i], hit->p, wi * -1.0f);
    }
    for (const uint32_t i : lit.lights.disc_suns) {
        const float pdf = pdf_direct_sun(lit.lights, p, i, wi);
        if (!(pdf > 0.0f)) continue;
        seen.pdf_direct += pdf;
        seen.pdf_light_point = pdf_light_point_sun(lit.lights, i, wi);
        seen.radiance += lamp_radiance(lit.lights.lamps[i], Vec3(0.0f), wi * -1.0f);
    }
    const std::optional<Hit> hit =
        scene.instances.empty() ? std::nullopt : scene.accel->intersect({p, wi}, kVisibleDiffuse);
    if (hit && hit->light == kNone) {
        seen.pdf_direct += pdf_direct_surface(lit.lights, scene, p, wi, *hit);
        seen.pdf_light_point = pdf_light_point_surface(lit.lights, hit->surface);
        seen.radiance += surface_emission(scene, hit->surface, wi * -1.0f);
    } else if (!hit && lit.lights.has_world) {
        seen.pdf_direct += pdf_direct_world(lit.lights, p, wi);
        seen.pdf_light_point = pdf_light_point_world(lit.lights, wi);
        seen.radiance += world_radiance(lit.lights, scene, wi);
    }
    return seen;
}

// Irradiance at p on the side of n, channel `channel`, without any occlusion: by next event
// estimation...
inline MeanEstimate irradiance_direct(const Lit& lit, const Vec3& p, const Vec3& n, int64_t samples,
                                      uint64_t seed, int channel = 1) {
    MeanEstimate estimate;
    Uniforms uniforms(seed);
    for (int64_t i = 0; i < samples; ++i) {
        const std::optional<DirectSample> s =
            sample_direct(lit.lights, *lit.scene, p, uniforms.three());
        estimate.add(s ? s->radiance[channel] * std::max(dot(n, s->wi), 0.0f) / s->density : 0.0f);
    }
    return estimate;
}
// ... and by points of the lights.
inline MeanEstimate irradiance_light_point(const Lit& lit, const Vec3& p, const Vec3& n,
                                           int64_t samples, uint64_t seed, int channel = 1) {
    MeanEstimate estimate;
    Uniforms uniforms(seed);
    for (int64_t i = 0; i < samples; ++i) {
        const std::optional<LightPoint> y =
            sample_light_point(lit.lights, *lit.scene, uniforms.three());
        double value = 0;
        if (y && y->distant) {
            value =
                radiance_at(lit.lights, *lit.scene, *y, y->direction * -1.0f, kFromAfar)[channel] *
                std::max(dot(n, y->direction), 0.0f);
        } else if (y && shows_itself(lit.lights, *y, p)) {
            const Vec3 to_y = y->p - p;
            const Vec3 wi = normalize(to_y);
            const float cos_y = y->delta ? 1.0f : std::abs(dot(y->n, wi));
            value = radiance_at(lit.lights, *lit.scene, *y, wi * -1.0f,
                                length(light_begins(lit.lights, *y, p) - p))[channel] *
                    std::max(dot(n, wi), 0.0f) * cos_y / length_squared(to_y);
        }
        estimate.add(y ? value / y->pdf : 0.0);
    }
    return estimate;
}

}  // namespace spc::test
