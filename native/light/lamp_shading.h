// SPDX-License-Identifier: GPL-3.0-or-later
// What the nodes of a lamp make of its light: a factor by point, direction and length of the ray.
#pragma once

#include "light/lamp.h"
#include "scene/scene.h"

namespace spc {

// A lamp with what its nodes need to know of it; without nodes they are not read.
struct LampShading {
    uint32_t material = kNone;  // of the scene; kNone: the factor is 1
    Transform to_world, to_lamp;
    SpotProfile spot;        // of a spot, which its image fills
    float half_tangent = 1;  // of half the spot's angle

    bool exists() const { return material != kNone; }
};
LampShading make_lamp_shading(const LightDesc& desc);

// The factor at the point q of the lamp, unset for a sun, along the unit direction `away`. `ray`
// tells of the ray that sees it.
Spectrum lamp_factor(const Scene& scene, const Lamp& lamp, const LampShading& shading,
                     const Vec3& q, const Vec3& away, const RayState& ray);

// Roughly its mean, for choosing among lights; not 0 where the lamp may shine.
float mean_lamp_factor(const Scene& scene, const LampShading& shading);

}  // namespace spc
