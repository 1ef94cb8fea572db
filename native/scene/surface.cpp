// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/surface.h"

#include "core/error.h"
#include "core/uninitialized_array.h"
#include "math/triangle.h"

namespace spc {

namespace {

// Weighted sum of three corner values at barycentrics that may carry derivatives.
template <class T>
Vector3<T> interpolate(const Vec3& a, const Vec3& b, const Vec3& c, const T& u, const T& v) {
    const auto component = [&](float ca, float cb, float cc) {
        return T(ca) + T(cb - ca) * u + T(cc - ca) * v;
    };
    return {component(a.x, b.x, c.x), component(a.y, b.y, c.y), component(a.z, b.z, c.z)};
}

// Rows of the inverse transpose, for normals.
std::array<Vec3, 3> normal_rows(const Transform& world_to_object) {
    return {world_to_object.column(0), world_to_object.column(1), world_to_object.column(2)};
}

Vec3 front_normal_of(const std::array<Vec3, 3>& corner, bool mirrored) {
    const Vec3 n = unit_normal(corner[1] - corner[0], corner[2] - corner[0]);
    return mirrored ? n * -1.0f : n;
}

Vec3 object_face_normal(const Mesh& mesh, uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return unit_normal(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
}

// The sums that rounding errors of a triangle's points grow with, for coordinates of at most M and
// the unit roundoff u = 2^-24:
//   - interpolate(): 6 u M in each coordinate, 10.4 u M along any normal;
//   - the shifted origin itself: 1.7 u M;
//   - a ray cast's distance to the plane of a triangle that is not a sliver: 12 u M.
// M is the largest coordinate of the corners: near the world's origin that is the triangle's own
// extent. A tree in object space adds the transforms there and back, 4 u for each product of a row,
// and errors of the inverse of the same size; there M counts every term of those products.
// Together less than 50 u; the next power of two keeps some reserve.
constexpr float kPositionError = 0x1p-18f;

// kRayError, at the far end of a ray of length d, is the sum of
//   - its direction and length: 5 u d and 3 u d;
//   - the corners as seen from its origin, and their products with the normal: 6 u d;
//   - the product of direction and normal, and its reciprocal: 5 u d.
// The transforms of a tree in object space multiply it as they do coordinates.

Vec3 absolute(const Vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

float largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

// Sums of the absolute values of all products in the transforms to object space and back.
Vec3 terms_there_and_back(const Instance& instance, const Vec3& size) {
    const auto terms = [](const Transform& m, const Vec3& v) {
        return Vec3(dot(absolute(m.row[0]), v), dot(absolute(m.row[1]), v),
                    dot(absolute(m.row[2]), v));
    };
    return terms(instance.object_to_world, terms(instance.world_to_object, size));
}

float position_error(const Instance& instance, const std::array<Vec3, 3>& corner) {
    Vec3 size(0.0f);
    for (const Vec3& p : corner)
        for (int i = 0; i < 3; ++i) size[i] = std::max(size[i], std::abs(p[i]));
    if (instance.world_positions.empty())
        size = terms_there_and_back(instance, size + absolute(instance.object_to_world.translation));
    return kPositionError * largest(size);
}

// A ShadingPoint with the storage for what it points to.
template <class T>
struct PointAt {
    ShadingPoint<T> point;
    UninitializedArray<Vector3<T>, kMaxAttributes> tangents;
    UninitializedArray<float, kMaxAttributes> signs;
    UninitializedArray<std::array<T, 4>, kMaxAttributes> attributes;
};

// The attribute's value at a point of the triangle; black where there is none.
template <class T>
std::array<T, 4> attribute_at(const Attribute* attribute, const Mesh& mesh, uint32_t triangle,
                              const T& u, const T& v) {
    const auto constant = [](const std::array<float, 4>& a) {
        return std::array<T, 4>{T(a[0]), T(a[1]), T(a[2]), T(a[3])};
    };
    if (attribute == nullptr) return constant({0.0f, 0.0f, 0.0f, 1.0f});
    if (attribute->domain == AttributeDomain::object) return constant(attribute->value(0));
    if (attribute->domain == AttributeDomain::triangle) return constant(attribute->value(triangle));
    std::array<std::array<float, 4>, 3> corner;
    for (size_t k = 0; k < 3; ++k)
        corner[k] = attribute->value(attribute->domain == AttributeDomain::corner
                                         ? 3 * static_cast<size_t>(triangle) + k
                                         : mesh.triangles[triangle][k]);
    const auto component = [&](size_t i) {
        const float a = corner[0][i];
        return T(a) + T(corner[1][i] - a) * u + T(corner[2][i] - a) * v;
    };
    return {component(0), component(1), component(2), component(3)};
}

template <class T>
void fill_attributes(const Instance& instance, const Mesh& mesh, uint32_t triangle, const T& u,
                     const T& v, bool with_tangents, PointAt<T>& at) {
    const std::vector<uint32_t>& indices = instance.attribute_indices[mesh.slot_of(triangle)];
    const size_t first = 3 * static_cast<size_t>(triangle);
    for (size_t i = 0; i < indices.size(); ++i) {
        const Attribute* attribute = instance.attribute(mesh, indices[i]);
        at.attributes[i] = attribute_at(attribute, mesh, triangle, u, v);
        if (!with_tangents) continue;
        if (attribute == nullptr || attribute->tangents.empty()) {
            // Constant on the triangle: a tangent that turned with the normal would need its
            // derivative.
            const Vec3 x = Frame::around(object_face_normal(mesh, triangle)).x;
            at.tangents[i] = {T(x.x), T(x.y), T(x.z)};
            at.signs[i] = 1.0f;
            continue;
        }
        at.tangents[i] = interpolate(attribute->tangents[first], attribute->tangents[first + 1],
                                     attribute->tangents[first + 2], u, v);
        at.signs[i] = attribute->tangent_signs[first];
    }
    at.point.attributes = at.attributes.data();
    at.point.tangent_object = at.tangents.data();
    at.point.bitangent_sign = at.signs.data();
}

// Fills in what `reads` asks for; ng, wo and backfacing are the caller's. `corner` and `positions`,
// of the mesh's vertices, say where the surface is: in the world and in object space.
template <class T>
void fill_point(const Scene& scene, const SurfaceHit& hit, const T& u, const T& v,
                const std::array<Vec3, 3>& corner, const std::vector<Vec3>& positions,
                const Vec3& front_ng, uint32_t reads, PointAt<T>& at) {
    const Instance& instance = scene.instances[hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    ShadingPoint<T>& point = at.point;
    point.u = u;
    point.v = v;
    point.view = &scene.view;
    point.object_to_world = &instance.object_to_world;
    point.world_to_object = &instance.world_to_object;
    if ((reads & kReadsPosition) != 0)
        point.position = interpolate(corner[0] + scene.origin, corner[1] + scene.origin,
                                     corner[2] + scene.origin, u, v);
    if ((reads & kReadsObjectPosition) != 0) {
        const auto& index = mesh.triangles[hit.triangle];
        point.position_object =
            interpolate(positions[index[0]], positions[index[1]], positions[index[2]], u, v);
    }
    if (mesh.normals.empty()) {
        const Vector3<float> n = to_vector(front_ng);
        point.normal = {T(n.x), T(n.y), T(n.z)};
        if ((reads & (kReadsObjectNormal | kReadsTangent)) != 0) {
            // normal matrix's inverse is the transform's transpose
            const Vec3 o = normalize(instance.object_to_world.transposed(front_ng));
            point.normal_object = {T(o.x), T(o.y), T(o.z)};
        }
    } else {
        point.normal_object = interpolate(mesh.normals[first], mesh.normals[first + 1],
                                          mesh.normals[first + 2], u, v);
        point.normal =
            normalize(apply_rows(normal_rows(instance.world_to_object), point.normal_object));
    }
    if ((reads & (kReadsAttributes | kReadsTangent)) != 0)
        fill_attributes(instance, mesh, hit.triangle, u, v, (reads & kReadsTangent) != 0, at);
}

// World positions of a triangle's corners before it was displaced.
std::array<Vec3, 3> rest_corners(const Scene& scene, const SurfaceHit& hit) {
    const Instance& instance = scene.instances[hit.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto& [a, b, c] = mesh.triangles[hit.triangle];
    const std::vector<Vec3>& rest = mesh.rest_positions;
    return {instance.object_to_world.point(rest[a]), instance.object_to_world.point(rest[b]),
            instance.object_to_world.point(rest[c])};
}

// The same, with the storage for what a material's heights read.
template <class T>
struct PointWithHeights : PointAt<T> {
    std::optional<PointAt<Dual<T>>> around;
};

// Fills in what `reads` asks for, seen from `wo`. `front`: the geometric normal on the front side.
template <class T>
void fill_point_seen_from(const Scene& scene, const SurfaceHit& hit, const T& u, const T& v,
                          const Vec3& wo, uint32_t reads, const Material& material,
                          const std::array<Vec3, 3>& corner, const Vec3& front,
                          PointWithHeights<T>& at) {
    const Mesh& mesh = scene.meshes[scene.instances[hit.instance].mesh];
    fill_point(scene, hit, u, v, corner, mesh.positions, front, reads, at);
    ShadingPoint<T>& point = at.point;
    point.backfacing = dot(front, wo) < 0.0f;
    point.ng = point.backfacing ? front * -1.0f : front;
    point.wo = wo;
    point.dp_du = corner[1] - corner[0];
    point.dp_dv = corner[2] - corner[0];
    if ((reads & kReadsHeights) == 0) return;
    // A bump that goes with a displacement is of the surface before it.
    const bool displaced = !mesh.rest_positions.empty();
    const std::array<Vec3, 3> base = displaced ? rest_corners(scene, hit) : corner;
    point.dp_du = base[1] - base[0];
    point.dp_dv = base[2] - base[0];
    fill_point(scene, hit, Dual<T>(u, T(1.0f), T(0.0f)), Dual<T>(v, T(0.0f), T(1.0f)), base,
               displaced ? mesh.rest_positions : mesh.positions, front, material.height_reads,
               at.around.emplace());
    at.around->point.backfacing = point.backfacing;
    point.around = &at.around->point;
}

// The plain point that closures are evaluated at.
void point_seen_from(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                     const Material& material, const std::array<Vec3, 3>& corner,
                     PointWithHeights<float>& at) {
    const Vec3 front = front_normal_of(corner, scene.instances[hit.instance].mirrored);
    fill_point_seen_from(scene, hit, hit.u, hit.v, wo, material.reads, material, corner, front, at);
}

// Evaluates one output of a material's program at a hit, without closures.
template <class Evaluate>
auto evaluate_alone(const Evaluate& evaluate, const Scene& scene, const SurfaceHit& hit,
                    const Vec3& wo, const RayState& ray) {
    const Material& material = scene.material_of(hit);
    PointWithHeights<float> at;
    point_seen_from(scene, hit, wo, material, scene.triangle_world(hit.instance, hit.triangle), at);
    at.point.ray = ray;
    return evaluate(material, scene.images, at.point);
}

}  // namespace

Vec3 front_normal(const Scene& scene, uint32_t instance, uint32_t triangle) {
    return front_normal_of(scene.triangle_world(instance, triangle),
                           scene.instances[instance].mirrored);
}

float position_error(const Scene& scene, uint32_t instance, uint32_t triangle) {
    return position_error(scene.instances[instance], scene.triangle_world(instance, triangle));
}

RayStart ray_start(const Scene& scene, const SurfaceHit& hit, const Vec3& p) {
    const Instance& instance = scene.instances[hit.instance];
    const std::array<Vec3, 3> corner = scene.triangle_world(hit.instance, hit.triangle);
    return {p, front_normal_of(corner, instance.mirrored), position_error(instance, corner)};
}

float position_error(const Vec3& p) { return kPositionError * largest(absolute(p)); }

float ray_error(const Scene& scene, uint32_t instance) {
    const Instance& one = scene.instances[instance];
    if (!one.world_positions.empty()) return kRayError;
    return kRayError * largest(terms_there_and_back(one, Vec3(1.0f)));
}

Vec3 surface_position(const Scene& scene, const SurfaceHit& hit) {
    const std::array<Vec3, 3> corner = scene.triangle_world(hit.instance, hit.triangle);
    return value_of(interpolate(corner[0], corner[1], corner[2], hit.u, hit.v));
}

void evaluate_surface(const Scene& scene, const SurfaceHit& hit, const Vec3& wo, Surface& surface,
                      const RayState& ray) {
    surface.hit = hit;
    const Material& material = scene.material_of(hit);
    const std::array<Vec3, 3> corner = scene.triangle_world(hit.instance, hit.triangle);
    PointWithHeights<float> at;
    point_seen_from(scene, hit, wo, material, corner, at);
    at.point.ray = ray;
    surface.p = value_of(interpolate(corner[0], corner[1], corner[2], hit.u, hit.v));
    surface.p_error = position_error(scene.instances[hit.instance], corner);
    surface.ng = at.point.ng;
    surface.backfacing = at.point.backfacing;
    surface.n = value_of(at.point.normal) * (at.point.backfacing ? -1.0f : 1.0f);
    surface.wo = wo;
    surface.closures.clear();
    evaluate_closures(material, scene.images, at.point, surface.closures);
    surface.closures.terminator.stretch = scene.instances[hit.instance].terminator_stretch;
}

Spectrum surface_emission(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                          const RayState& ray) {
    const Material& material = scene.material_of(hit);
    return material.emits ? evaluate_alone(evaluate_emission, scene, hit, wo, ray) : Spectrum(0.0f);
}

Spectrum surface_transparency(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                              const RayState& ray) {
    const Material& material = scene.material_of(hit);
    return material.may_be_transparent ? evaluate_alone(evaluate_transparency, scene, hit, wo, ray)
                                       : Spectrum(0.0f);
}

Vec3 surface_color_aov(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                       const RayState& ray, uint32_t node) {
    const auto evaluate = [node](const auto&... at) { return evaluate_color_aov(at..., node); };
    return evaluate_alone(evaluate, scene, hit, wo, ray);
}

float surface_value_aov(const Scene& scene, const SurfaceHit& hit, const Vec3& wo,
                        const RayState& ray, uint32_t node) {
    const auto evaluate = [node](const auto&... at) { return evaluate_value_aov(at..., node); };
    return evaluate_alone(evaluate, scene, hit, wo, ray);
}

Vec3 surface_displacement(const Scene& scene, const SurfaceHit& hit) {
    const Material& material = scene.material_of(hit);
    const std::array<Vec3, 3> corner = scene.triangle_world(hit.instance, hit.triangle);
    const Vec3 front = front_normal_of(corner, scene.instances[hit.instance].mirrored);
    PointWithHeights<float> at;
    fill_point_seen_from(scene, hit, hit.u, hit.v, front, material.displacement_reads, material,
                         corner, front, at);
    return evaluate_displacement(material, scene.images, at.point);
}

DifferentialGeometry evaluate_caster(const Scene& scene, const SurfaceHit& hit, bool smooth_base) {
    const Material& material = scene.material_of(hit);
    const std::array<Vec3, 3> corner = scene.triangle_world(hit.instance, hit.triangle);
    DifferentialGeometry geometry;
    geometry.ng = front_normal_of(corner, scene.instances[hit.instance].mirrored);
    geometry.dp_du = corner[1] - corner[0];
    geometry.dp_dv = corner[2] - corner[0];
    geometry.p = corner[0] + geometry.dp_du * hit.u + geometry.dp_dv * hit.v;
    geometry.p_error = position_error(scene.instances[hit.instance], corner);
    const bool mapped = material.interface().mapped_normal && !smooth_base;
    PointWithHeights<Dual2> at;
    fill_point_seen_from(scene, hit, Dual2(hit.u, 1, 0), Dual2(hit.v, 0, 1), geometry.ng,
                         mapped ? material.normal_reads : 0, material, corner, geometry.ng, at);
    const Vector3<Dual2> n =
        mapped ? evaluate_caster_normal(material, scene.images, at.point) : at.point.normal;
    geometry.n = value_of(n);
    geometry.dn_du = derivative_u(n);
    geometry.dn_dv = derivative_v(n);
    return geometry;
}

Vec3 offset_origin(const RayStart& from, const Vec3& direction) {
    return from.p + from.ng * std::copysign(from.error, dot(from.ng, direction));
}

}  // namespace spc
