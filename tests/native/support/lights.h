// SPDX-License-Identifier: GPL-3.0-or-later
// Points of lights that rays run into.
#pragma once

#include "integrator/path.h"

namespace spc::test {

// As sample_light_point() describes it. Without a hit that of the scene's first sun or, without
// one, of the world; empty where none is there, or where none would be drawn.
inline std::optional<LightPoint> light_point_met(const RenderScene& world, const Ray& ray,
                                                 const std::optional<Hit>& hit) {
    const LightSet& lights = world.lights;
    LightPoint y{};
    y.p = y.n = Vec3(0.0f);
    y.distant = !hit;
    y.direction = ray.direction;
    if (!hit) {
        if (lights.disc_suns.empty() && !lights.has_world) return std::nullopt;
        const bool sun = !lights.disc_suns.empty();
        y.light = sun ? lights.disc_suns[0] : lights.of_world();
        y.pdf = sun ? pdf_light_point_sun(lights, y.light, ray.direction)
                    : pdf_light_point_world(lights, ray.direction);
    } else if (hit->light != kNone) {
        y.light = hit->light;
        y.p = ray.origin + ray.direction * hit->t;
        const auto* area = std::get_if<AreaLamp>(&lights.lamps[y.light]);
        y.n = area != nullptr ? area->normal
                              : normalize(y.p - world.scene->lights[y.light].position());
        y.pdf = pdf_light_point_lamp(lights, *hit);
    } else {
        y.surface = hit->surface;
        y.light = lights.of_emitter(lights.emissive_of_instance[hit->surface.instance]);
        y.p = surface_position(*world.scene, hit->surface);
        y.n = front_normal(*world.scene, hit->surface.instance, hit->surface.triangle);
        y.pdf = pdf_light_point_surface(lights, hit->surface);
    }
    if (!(y.pdf > 0.0f)) return std::nullopt;
    return y;
}

}  // namespace spc::test
