// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/footprint.h"

namespace spc {

namespace {

// Standard deviation of the directions that stand for the one that a rough bounce took. Of a
// microfacet's tilt, in parts of alpha: Beckmann's own is 0.71 along each axis, and the core of GGX
// is as wide as a normal distribution of 0.5, so that a lobe's picture of the texels is blurred by
// 6 and 12 % more than the lobe does. Of a diffuse direction, rad: nothing else varies with it as
// slowly, and Footprint::axes() has a bound of its own.
constexpr float kFacetSpread = 0.25f;
constexpr float kDiffuseSpread = 0.1f;

Vec3 interpolated(const std::vector<Vec3>& corners, const SurfaceHit& hit) {
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    return corners[first] * (1.0f - hit.u - hit.v) + corners[first + 1] * hit.u +
           corners[first + 2] * hit.v;
}

// A place in a map, and how it moves with the barycentrics, texels.
struct MapPoint {
    Vec2 at, by_u, by_v;
};
MapPoint map_point(const SlopeMap& map, const Vec2& size, const Attribute& layer,
                   const SurfaceHit& hit) {
    const auto to_image = [&](const Vec2& v) {
        return Vec2(map.to_image[0].dot(v), map.to_image[1].dot(v)) * size;
    };
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    const Vec2 a = layer.uv(first), b = layer.uv(first + 1), c = layer.uv(first + 2);
    const Vec2 at = a * (1.0f - hit.u - hit.v) + b * hit.u + c * hit.v;
    return {to_image(at) + map.offset * size - Vec2(0.5f, 0.5f), to_image(b - a), to_image(c - a)};
}

// The frame of a normal map's slopes, as map_normal() uses it.
SlopeFrame tangent_frame(const Scene& scene, const Attribute& layer, const Surface& surface) {
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

// The frame of a height map's slopes, as bump_normal() uses it. The chain rule turns the gradient
// by texels into one by barycentrics. Not finite if the normal lies in the plane of the triangle.
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

ChainVertex delta_vertex(const Scene& scene, const Surface& surface, const ClosureSample& next) {
    const DifferentialGeometry geometry = evaluate_caster(scene, surface.hit, false);
    return {next.refracted ? Interaction::refraction : Interaction::reflection,
            eta_seen_from(geometry.ng, surface.wo, scene.material_of(surface.hit).specular.ior),
            geometry};
}

// A delta at the facet that has turned the path, which leans on the interpolated normal and turns
// with it. Of what a map does to the closure's normal besides nobody asks: that leaves the mean
// over many texels alone, as any smooth map from paths to neighbouring ones does, and moves places.
ChainVertex facet_vertex(const Scene& scene, const Surface& surface, const ClosureSample& next) {
    const float eta = next.refracted ? next.eta : 1.0f;
    const Vec3 half = normalize(surface.wo + next.wi * eta);
    const bool front = (dot(half, surface.wo) > 0.0f) != surface.backfacing;
    DifferentialGeometry geometry = evaluate_caster(scene, surface.hit, true);
    geometry.n = front ? half : half * -1.0f;
    for (Vec3* change : {&geometry.dn_du, &geometry.dn_dv})
        *change -= geometry.n * dot(geometry.n, *change);
    return {next.refracted ? Interaction::refraction : Interaction::reflection, eta, geometry};
}

// The direction stays as the place moves.
bool propagate_through_diffuse(const Surface& surface, const Vec3& wi, double distance,
                               RayDual& ray) {
    const Vec3d ng(surface.ng);
    const double dng = dot(ray.d, ng);
    if (!(std::abs(dng) > 1e-9)) return false;
    for (size_t i = 0; i < 2; ++i) {
        const Vec3d free = ray.dp[i] + ray.dd[i] * distance;
        ray.dp[i] = free - ray.d * (dot(free, ng) / dng);
        ray.dd[i] = Vec3d(0.0);
    }
    ray.d = Vec3d(wi);
    return true;
}

RayDual diffuse_lobe(const Vec3& wi) {
    const Frame frame = Frame::around(wi);
    const auto spread = static_cast<double>(kDiffuseSpread);
    return {Vec3d(wi), {Vec3d(0.0), Vec3d(0.0)}, {Vec3d(frame.x) * spread, Vec3d(frame.y) * spread}};
}

// Differential of a microfacet's reflection: the facet leans with the position in its plane, and
// nothing else changes.
std::optional<RayDual> facet_lobe(ChainVertex vertex, const Vec3& wo, float alpha) {
    DifferentialGeometry& geometry = vertex.geometry;
    const Frame frame = Frame::around(geometry.n);
    geometry.ng = geometry.n;
    geometry.dp_du = frame.x;
    geometry.dp_dv = frame.y;
    geometry.dn_du = frame.x * (alpha * kFacetSpread);
    geometry.dn_dv = frame.y * (alpha * kFacetSpread);
    RayDual ray{Vec3d(wo) * -1.0, {Vec3d(frame.x), Vec3d(frame.y)}, {Vec3d(0.0), Vec3d(0.0)}};
    if (!propagate_through_vertex(vertex, 0.0, ray)) return std::nullopt;
    ray.dp = {Vec3d(0.0), Vec3d(0.0)};
    return ray;
}

double spread_of(const RayDual& lobe) {
    return dot(lobe.dd[0], lobe.dd[0]) + dot(lobe.dd[1], lobe.dd[1]);
}

// How the plane of a triangle is met by rays nearby, as barycentrics.
class PlaneChange {
public:
    // Empty where it is seen edge-on.
    static std::optional<PlaneChange> of(const Vec3& dp_du, const Vec3& dp_dv,
                                         const Surface& surface, const RayDual& ray,
                                         double distance) {
        PlaneChange plane{Vec3d(dp_du), Vec3d(dp_dv), Vec3d(surface.ng), distance};
        plane.det_ = plane.uu_ * plane.vv_ - plane.uv_ * plane.uv_;
        if (!(std::abs(dot(ray.d, plane.ng_)) > 1e-6) || !(plane.det_ > 0.0)) return std::nullopt;
        return plane;
    }
    Vec2 operator()(const RayDual& ray, size_t i) const {
        const Vec3d free = ray.dp[i] + ray.dd[i] * distance_;
        const Vec3d dp = free - ray.d * (dot(free, ng_) / dot(ray.d, ng_));
        const double bu = dot(dp, pu_), bv = dot(dp, pv_);
        return {static_cast<float>((bu * vv_ - bv * uv_) / det_),
                static_cast<float>((bv * uu_ - bu * uv_) / det_)};
    }

private:
    PlaneChange(const Vec3d& pu, const Vec3d& pv, const Vec3d& ng, double distance)
        : pu_(pu),
          pv_(pv),
          ng_(ng),
          distance_(distance),
          uu_(dot(pu, pu)),
          uv_(dot(pu, pv)),
          vv_(dot(pv, pv)) {}

    Vec3d pu_, pv_, ng_;
    double distance_, uu_, uv_, vv_, det_ = 0.0;
};

// With d = wo + wi, h = d / |d| turns by dwo / |d| as far as that is across h; for the mirrored wi
// h is the normal, and |d| is 2 cos.
float lobe_turn(const Scene& scene, const Surface& surface, const RayDual& lobe,
                const std::array<Vec2, 2>& barycentric) {
    constexpr float kLeastCosine = 0.05f;
    const DifferentialGeometry geometry = evaluate_caster(scene, surface.hit, true);
    const Vec3 n = surface.n;
    const float side = surface.backfacing ? -1.0f : 1.0f;
    const float cos_o = std::max(std::abs(dot(n, surface.wo)), kLeastCosine);
    float squares = 0.0f;
    for (size_t i = 0; i < 2; ++i) {
        const Vec3 dwo = Vec3(lobe.dd[i]) * -1.0f;
        const Vec3 dh = (dwo - n * dot(n, dwo)) * (0.5f / cos_o);
        const Vec3 dn =
            (geometry.dn_du * barycentric[i].x + geometry.dn_dv * barycentric[i].y) * side;
        squares += length_squared(dh - dn);
    }
    return std::sqrt(squares);
}

}  // namespace

PathDifferential camera_differential(const Camera& camera, const PixelKernel& pixel,
                                     const Vec2& lens, const Vec3& direction) {
    const RayChange change = camera.ray_change(pixel.film.x, pixel.film.y, lens);
    return {{Vec3d(direction),
             {Vec3d(change.origin[0]), Vec3d(change.origin[1])},
             {Vec3d(change.direction[0]), Vec3d(change.direction[1])}}};
}

bool propagate_through_bounce(const Scene& scene, const Surface& surface, const ClosureSample& next,
                              double distance, PathDifferential& path) {
    if (next.delta && !next.on_caster_normal) return false;
    const bool diffuse = !next.facets;
    ChainVertex vertex{};
    if (!diffuse)
        vertex =
            next.delta ? delta_vertex(scene, surface, next) : facet_vertex(scene, surface, next);
    const auto pass = [&](RayDual& ray) {
        return diffuse ? propagate_through_diffuse(surface, next.wi, distance, ray)
                       : propagate_through_vertex(vertex, distance, ray);
    };
    if (!pass(path.film) || (path.lobe && !pass(*path.lobe))) return false;
    if (next.delta) return true;
    const std::optional<RayDual> lobe =
        diffuse ? diffuse_lobe(next.wi) : facet_lobe(vertex, surface.wo, next.alpha);
    if (!lobe) return false;
    if (!path.lobe || spread_of(*lobe) > spread_of(*path.lobe)) path.lobe = lobe;
    return true;
}

std::optional<Footprint> footprint_at(const Scene& scene, const SlopeMap& map, int width,
                                      int height, const Surface& surface,
                                      const PathDifferential& path, double distance) {
    const Instance& instance = scene.instances[surface.hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto layer = [&](uint32_t of_material) {
        return instance.attribute(
            mesh, instance.attribute_indices[mesh.slot_of(surface.hit.triangle)][of_material]);
    };
    const Attribute *uv = layer(map.uv_layer), *tangent = layer(map.tangent_layer);
    const bool bumped = map.relief == Relief::heights;
    if (uv == nullptr || !uv->is_uv_layer()) return std::nullopt;
    if (!bumped && (tangent == nullptr || tangent->tangents.empty())) return std::nullopt;

    const std::array<Vec3, 3> corner =
        scene.triangle_world(surface.hit.instance, surface.hit.triangle);
    const Vec3 dp_du = corner[1] - corner[0], dp_dv = corner[2] - corner[0];
    const Vec2 size(static_cast<float>(width), static_cast<float>(height));
    const MapPoint point = map_point(map, size, *uv, surface.hit);
    Footprint result;
    result.frame = bumped ? raised_frame(map, point, dp_du, dp_dv, surface)
                          : tangent_frame(scene, *tangent, surface);
    if (!std::isfinite(result.frame.det())) return std::nullopt;
    result.at =
        point.at - Vec2(std::floor(point.at.x / size.x), std::floor(point.at.y / size.y)) * size;

    const std::optional<PlaneChange> plane =
        PlaneChange::of(dp_du, dp_dv, surface, path.film, distance);
    if (!plane) return std::nullopt;
    const auto texels = [&](const Vec2& change) {
        return point.by_u * change.x + point.by_v * change.y;
    };
    for (size_t i = 0; i < 2; ++i) result.by_film[i] = texels((*plane)(path.film, i));
    if (path.lobe) {
        const std::array<Vec2, 2> change{(*plane)(*path.lobe, 0), (*plane)(*path.lobe, 1)};
        for (size_t i = 0; i < 2; ++i) result.by_lobe[i] = texels(change[i]);
        result.lobe_turn = lobe_turn(scene, surface, *path.lobe, change);
    }
    return result;
}

// Covariances of independent displacements add up; the axes are a Cholesky factor of their sum.
std::array<Vec2, 2> Footprint::axes(float variance, float most_turn) const {
    const float share =
        lobe_turn > most_turn ? sqr(most_turn / lobe_turn) / variance : 1.0f / variance;
    float xx = 0.0f, xy = 0.0f, yy = 0.0f;
    for (const Vec2& lobe : by_lobe) {
        xx += share * lobe.x * lobe.x;
        xy += share * lobe.x * lobe.y;
        yy += share * lobe.y * lobe.y;
    }
    if (xx == 0.0f && yy == 0.0f) return by_film;
    for (const Vec2& film : by_film) {
        xx += film.x * film.x;
        xy += film.x * film.y;
        yy += film.y * film.y;
    }
    const float x = std::sqrt(xx), along = xy / x;
    return {Vec2(x, along), Vec2(0.0f, safe_sqrt(yy - sqr(along)))};
}

}  // namespace spc
