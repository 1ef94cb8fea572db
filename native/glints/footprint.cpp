// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/footprint.h"

namespace spc {

namespace {

template <class T>
T interpolated(const std::vector<T>& corners, const SurfaceHit& hit) {
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    return corners[first] * (1.0f - hit.u - hit.v) + corners[first + 1] * hit.u +
           corners[first + 2] * hit.v;
}

// As map_normal() builds it, on the side of wo.
SlopeFrame frame_at(const Scene& scene, const UvLayer& layer, const Surface& surface) {
    const Instance& instance = scene.instances[surface.hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Vec3 front = surface.backfacing ? surface.ng * -1.0f : surface.ng;
    const Vec3 normal = mesh.normals.empty() ? normalize(instance.object_to_world.transposed(front))
                                             : interpolated(mesh.normals, surface.hit);
    const Vec3 tangent = interpolated(layer.tangents, surface.hit);
    const float sign = layer.tangent_signs[3 * static_cast<size_t>(surface.hit.triangle)];
    const float side = surface.backfacing ? -1.0f : 1.0f;
    const auto to_world = [&](const Vec3& n) {
        return instance.world_to_object.transposed(n) * side;
    };
    return {{to_world(tangent), to_world(cross(normal, tangent) * sign), to_world(normal)}};
}

// Coordinates (u, v) that barycentrics make of a layer, and their derivatives.
struct LayerPoint {
    Vec2 at, by_u, by_v;
};
LayerPoint layer_point(const UvLayer& layer, const SurfaceHit& hit) {
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    return {interpolated(layer.uv, hit), layer.uv[first + 1] - layer.uv[first],
            layer.uv[first + 2] - layer.uv[first]};
}

}  // namespace

RayDual camera_differential(const Camera& camera, const PixelKernel& pixel, const Vec2& lens,
                            const Vec3& direction) {
    const RayChange change = camera.ray_change(pixel.film.x, pixel.film.y, lens);
    return {Vec3d(direction),
            {Vec3d(change.origin[0]), Vec3d(change.origin[1])},
            {Vec3d(change.direction[0]), Vec3d(change.direction[1])}};
}

bool pass_delta(const Scene& scene, const SurfaceHit& hit, double distance, bool refracted,
                RayDual& ray) {
    const CasterPatch patch = evaluate_caster(scene, hit, false);
    const Interaction interaction = refracted ? Interaction::refraction : Interaction::reflection;
    const float eta =
        eta_seen_from(patch.ng, Vec3(ray.d) * -1.0f, scene.material_of(hit).specular.ior);
    return pass_vertex({interaction, eta, patch}, distance, ray);
}

std::optional<Footprint> footprint_at(const Scene& scene, const SlopeMap& map, int width, int height,
                                      const Surface& surface, const RayDual& ray, double distance) {
    const Instance& instance = scene.instances[surface.hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const std::vector<uint32_t>& layers = instance.uv_layers[mesh.slot_of(surface.hit.triangle)];
    const uint32_t uv = layers[map.uv_layer], tangent = layers[map.tangent_layer];
    if (uv == kNone || tangent == kNone || mesh.uv_layers[tangent].tangents.empty())
        return std::nullopt;

    Footprint result;
    result.frame = frame_at(scene, mesh.uv_layers[tangent], surface);
    const LayerPoint point = layer_point(mesh.uv_layers[uv], surface.hit);
    const Vec2 size(static_cast<float>(width), static_cast<float>(height));
    const auto to_image = [&](const Vec2& v) {
        return Vec2(map.to_image[0].dot(v), map.to_image[1].dot(v)) * size;
    };
    const Vec2 place = to_image(point.at) + map.offset * size - Vec2(0.5f, 0.5f);
    result.at = place - Vec2(std::floor(place.x / size.x), std::floor(place.y / size.y)) * size;

    const std::array<Vec3, 3> corner =
        scene.triangle_world(surface.hit.instance, surface.hit.triangle);
    const Vec3d pu(corner[1] - corner[0]), pv(corner[2] - corner[0]), ng(surface.ng);
    const double dng = dot(ray.d, ng);
    const double uu = dot(pu, pu), uv_ = dot(pu, pv), vv = dot(pv, pv), det = uu * vv - uv_ * uv_;
    if (!(std::abs(dng) > 1e-6) || !(det > 0.0)) return std::nullopt;
    for (size_t i = 0; i < 2; ++i) {
        const Vec3d free = ray.dp[i] + ray.dd[i] * distance;
        const Vec3d dp = free - ray.d * (dot(free, ng) / dng);
        const double bu = dot(dp, pu), bv = dot(dp, pv);
        result.by_film[i] = to_image(point.by_u * static_cast<float>((bu * vv - bv * uv_) / det) +
                                     point.by_v * static_cast<float>((bv * uu - bu * uv_) / det));
    }
    return result;
}

}  // namespace spc
