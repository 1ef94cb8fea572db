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

// A place in a map, and how it moves with the barycentrics, texels.
struct MapPoint {
    Vec2 at, by_u, by_v;
};
MapPoint map_point(const SlopeMap& map, const Vec2& size, const UvLayer& layer,
                   const SurfaceHit& hit) {
    const auto to_image = [&](const Vec2& v) {
        return Vec2(map.to_image[0].dot(v), map.to_image[1].dot(v)) * size;
    };
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    return {to_image(interpolated(layer.uv, hit)) + map.offset * size - Vec2(0.5f, 0.5f),
            to_image(layer.uv[first + 1] - layer.uv[first]),
            to_image(layer.uv[first + 2] - layer.uv[first])};
}

// As map_normal() has it.
SlopeFrame tangent_frame(const Scene& scene, const UvLayer& layer, const Surface& surface) {
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

// As bump_normal() has it: of the gradient by barycentrics, which the chain rule makes of that by
// texels. Not finite where the normal lies in the plane of the triangle.
SlopeFrame raised_frame(const SlopeMap& map, const MapPoint& point, const Vec3& dp_du,
                        const Vec3& dp_dv, const Surface& surface) {
    const float side = surface.backfacing ? -1.0f : 1.0f;
    const Vec3 front = surface.n * side;
    const Vec3 across_u = cross(dp_dv, front), across_v = cross(front, dp_du);
    const float scale = -side * map.distance / dot(dp_du, across_u);
    return {{(across_u * point.by_u.x + across_v * point.by_v.x) * scale,
             (across_u * point.by_u.y + across_v * point.by_v.y) * scale, surface.n},
            map.strength};
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
    const bool bumped = map.relief == Relief::heights;
    if (uv == kNone || tangent == kNone || (!bumped && mesh.uv_layers[tangent].tangents.empty()))
        return std::nullopt;

    const std::array<Vec3, 3> corner =
        scene.triangle_world(surface.hit.instance, surface.hit.triangle);
    const Vec3 dp_du = corner[1] - corner[0], dp_dv = corner[2] - corner[0];
    const Vec2 size(static_cast<float>(width), static_cast<float>(height));
    const MapPoint point = map_point(map, size, mesh.uv_layers[uv], surface.hit);
    Footprint result;
    result.frame = bumped ? raised_frame(map, point, dp_du, dp_dv, surface)
                          : tangent_frame(scene, mesh.uv_layers[tangent], surface);
    if (!std::isfinite(result.frame.det())) return std::nullopt;
    result.at =
        point.at - Vec2(std::floor(point.at.x / size.x), std::floor(point.at.y / size.y)) * size;

    const Vec3d pu(dp_du), pv(dp_dv), ng(surface.ng);
    const double dng = dot(ray.d, ng);
    const double uu = dot(pu, pu), uv_ = dot(pu, pv), vv = dot(pv, pv), det = uu * vv - uv_ * uv_;
    if (!(std::abs(dng) > 1e-6) || !(det > 0.0)) return std::nullopt;
    for (size_t i = 0; i < 2; ++i) {
        const Vec3d free = ray.dp[i] + ray.dd[i] * distance;
        const Vec3d dp = free - ray.d * (dot(free, ng) / dng);
        const double bu = dot(dp, pu), bv = dot(dp, pv);
        result.by_film[i] = point.by_u * static_cast<float>((bu * vv - bv * uv_) / det) +
                            point.by_v * static_cast<float>((bv * uu - bu * uv_) / det);
    }
    return result;
}

}  // namespace spc
