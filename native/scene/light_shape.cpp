// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces that lamps present to rays. Point and spot lamps are spheres, seen from outside or,
// as in Cycles, from within by rays that start there, or, with soft falloff, disks; area lamps are
// parallelograms or ellipses that only their shining side shows.
#include "scene/description.h"

namespace spc {
namespace {

std::optional<LightSurfaceHit> intersect_sphere(const Vec3& center, float radius, const Ray& ray) {
    const Vec3 to_center = center - ray.origin;
    const float along = dot(to_center, ray.direction);
    // Distance to the axis by the foot of the perpendicular: the textbook's b^2 - 4 a c loses small
    // spheres far away.
    const Vec3 foot = to_center - ray.direction * along;
    const float half_chord_squared = radius * radius - length_squared(foot);
    if (!(half_chord_squared >= 0.0f)) return std::nullopt;
    // A ray that starts outside meets the outside alone, even when its t_near is already within:
    // who looks through a lamp must not meet it twice.
    const float side = length_squared(to_center) > radius * radius ? -1.0f : 1.0f;
    const float half_chord = std::sqrt(half_chord_squared), t = along + side * half_chord;
    if (!(t > ray.t_near && t < ray.t_far)) return std::nullopt;
    const Vec3 outward = normalize(ray.direction * (side * half_chord) - foot);
    return LightSurfaceHit{t, center + outward * radius, outward * -side};
}

// The disk's normal is the way from its centre to the ray's origin.
std::optional<LightSurfaceHit> intersect_facing_disk(const Vec3& center, float radius,
                                                     const Ray& ray) {
    const Vec3 to_center = center - ray.origin;
    const float along = dot(to_center, ray.direction), d2 = length_squared(to_center);
    if (!(along > 0.0f)) return std::nullopt;
    const float t = d2 / along;
    const Vec3 from_center = ray.direction * t - to_center;
    if (!(length_squared(from_center) <= radius * radius)) return std::nullopt;
    if (!(t > ray.t_near && t < ray.t_far)) return std::nullopt;
    return LightSurfaceHit{t, center + from_center, to_center * (-1.0f / std::sqrt(d2))};
}

std::optional<LightSurfaceHit> intersect_area(const LightDesc& light, const Ray& ray) {
    const Vec3 x = light.half_x(), y = light.half_y();
    const Vec3 across = cross(x, y);
    const Vec3 n =
        safe_normalize(dot(across, light.axis()) < 0.0f ? across * -1.0f : across, Vec3(0.0f));
    const float approach = dot(ray.direction, n);
    if (!(approach < 0.0f)) return std::nullopt;
    const Vec3 from_center = ray.origin - light.position();
    const float t = -dot(from_center, n) / approach;
    if (!(t > ray.t_near && t < ray.t_far)) return std::nullopt;
    const Vec3 offset = from_center + ray.direction * t;
    // Coordinates in the basis of the half extents, which need not be orthogonal.
    const float inv = 1.0f / length_squared(across);
    const float a = dot(cross(offset, y), across) * inv, b = dot(cross(x, offset), across) * inv;
    const bool inside = light.shape == AreaShape::rectangle
                            ? std::abs(a) <= 1.0f && std::abs(b) <= 1.0f
                            : a * a + b * b <= 1.0f;
    if (!inside) return std::nullopt;
    return LightSurfaceHit{t, light.position() + x * a + y * b, n};
}

}  // namespace

std::optional<LightSurfaceHit> intersect_light(const LightDesc& light, const Ray& ray) {
    if (!light.has_surface()) return std::nullopt;
    if (light.type == LightType::area) return intersect_area(light, ray);
    return light.soft_falloff ? intersect_facing_disk(light.position(), light.radius, ray)
                              : intersect_sphere(light.position(), light.radius, ray);
}

}  // namespace spc
