// SPDX-License-Identifier: GPL-3.0-or-later
// As Cycles 5.0 evaluates the nodes of a lamp, confirmed by rendering each output of the nodes that
// tell of points: tests/blender/test_light_nodes_against_cycles.py.
#include "light/lamp_shading.h"

namespace spc {
namespace {

struct LampSurface {
    Vec3 p{0.0f}, n{0.0f};
};

LampSurface surface_of(const PointLamp& lamp, const Vec3&, const Vec3& away) {
    return {lamp.center, away};
}
// All points of a ray through a soft lamp's disk stand for one: the nearest to its centre.
LampSurface surface_of(const SphereLamp& lamp, const Vec3& q, const Vec3& away) {
    if (lamp.soft) return {q + away * dot(lamp.center - q, away), away};
    return {q, safe_normalize(q - lamp.center, away)};
}
LampSurface surface_of(const ParallelSun&, const Vec3&, const Vec3& away) { return {away, away}; }
LampSurface surface_of(const DiscSun&, const Vec3&, const Vec3& away) { return {away, away}; }
LampSurface surface_of(const AreaLamp& lamp, const Vec3& q, const Vec3&) {
    return {q, lamp.normal};
}

// Where an image that a node lays over the lamp has the point: over an area light its extents, over
// a spot what its beam shows, over a point the sphere around it.
Vec2 image_point(const Lamp& lamp, const LampShading& shading, const LampSurface& at,
                 const Vec3& away) {
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) {
        const Vec3 from_center = at.p - area->center;
        return {0.5f + 0.5f * dot(from_center, area->dual_x),
                0.5f + 0.5f * dot(from_center, area->dual_y)};
    }
    if (is_sun(lamp)) return {0.5f, 0.5f};
    if (!shading.spot.uniform) {
        const Vec3 local(dot(away, shading.spot.x), dot(away, shading.spot.y),
                         dot(away, shading.spot.z));
        const float scale = 0.5f / (shading.half_tangent * local.z);
        return {0.5f + local.x * scale, 0.5f + local.y * scale};
    }
    Vec3 local;
    for (int i = 0; i < 3; ++i) local[i] = dot(shading.to_lamp.row[static_cast<size_t>(i)], at.n);
    const float around = local.x == 0.0f && local.y == 0.0f ? kPi : std::atan2(local.x, local.y);
    const float cosine = local.z / std::max(length(local), 1e-30f);
    return {0.5f - 0.5f * kInvPi * around,
            1.0f - kInvPi * std::acos(std::clamp(cosine, -1.0f, 1.0f))};
}

std::array<float, 4> attribute_value(const AttributeName& attribute, const Vec2& on_image,
                                     const Vector3<float>& position_object) {
    switch (attribute.kind) {
        case AttributeKind::uv: return {on_image.x, on_image.y, 0.0f, 1.0f};
        case AttributeKind::generated:
            return {position_object.x, position_object.y, position_object.z, 1.0f};
        default: return {0.0f, 0.0f, 0.0f, 1.0f};
    }
}

}  // namespace

LampShading make_lamp_shading(const LightDesc& desc) {
    LampShading shading;
    shading.material = desc.material;
    shading.to_world = desc.to_world;
    shading.to_lamp = desc.to_world.inverse();
    shading.spot = make_spot_profile(desc);
    shading.half_tangent = std::tan(0.5f * desc.spot_angle);
    return shading;
}

Spectrum lamp_factor(const Scene& scene, const Lamp& lamp, const LampShading& shading,
                     const Vec3& q, const Vec3& away, const RayState& ray) {
    if (!shading.exists()) return Spectrum(1.0f);
    const Material& material = scene.materials[shading.material];
    const LampSurface at = std::visit([&](const auto& l) { return surface_of(l, q, away); }, lamp);
    const Vec2 on_image = image_point(lamp, shading, at, away);
    // A sun's position is a direction, which the host's coordinates and the scene's have in common.
    const Vec3 position = is_sun(lamp) ? at.p : at.p + scene.origin;
    ShadingPoint<float> point{};
    point.position = to_vector(position);
    point.position_object = to_vector(shading.to_lamp.point(position - scene.origin));
    point.backfacing = dot(at.n, away) < 0.0f;
    point.normal = to_vector(at.n);
    point.normal_object = to_vector(normalize(shading.to_world.transposed(at.n)));
    std::array<std::array<float, 4>, kMaxAttributes> attributes;
    for (size_t i = 0; i < material.attributes.size(); ++i)
        attributes[i] = attribute_value(material.attributes[i], on_image, point.position_object);
    const std::array<Vector3<float>, kMaxAttributes> tangents{};
    const std::array<float, kMaxAttributes> signs{};
    point.attributes = attributes.data();
    point.tangent_object = tangents.data();
    point.bitangent_sign = signs.data();
    point.object_to_world = &shading.to_world;
    point.world_to_object = &shading.to_lamp;
    point.ng = point.backfacing ? at.n * -1.0f : at.n;
    point.wo = away;
    point.ray = ray;
    point.u = on_image.y;  // of three corners, of which the first two are Parametric
    point.v = 1.0f - on_image.x - on_image.y;
    point.view = &scene.view;
    return evaluate_emission(material, scene.images, point);
}

float mean_lamp_factor(const Scene& scene, const LampShading& shading) {
    if (!shading.exists()) return 1.0f;
    const Material& material = scene.materials[shading.material];
    const float mean = luminance(material.mean_emission);
    return mean > 0.0f || !material.emits ? mean : 1.0f;
}

}  // namespace spc
