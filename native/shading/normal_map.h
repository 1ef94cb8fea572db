// SPDX-License-Identifier: GPL-3.0-or-later
// Blender's Normal Map and Bump nodes, over T = float or Dual2.
#pragma once

#include "shading/arithmetic.h"
#include "shading/program.h"

namespace spc {

template <class T>
Vector3<T> flipped(const Vector3<T>& a, bool flip) {
    return flip ? times(a, -1.0f) : a;
}
// The interpolated normal on the side of wo.
template <class T>
Vector3<T> facing_normal(const ShadingPoint<T>& point) {
    return flipped(point.normal, point.backfacing);
}
template <class T>
Vector3<T> normal_to_world(const ShadingPoint<T>& point, const Vector3<T>& n_object) {
    return safe_normalize(apply_transposed(point.world_to_object->row, n_object));
}
template <class T>
bool is_zero(const Vector3<T>& a) {
    const Vec3 v = value_of(a);
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

// In tangent space strength scales the slopes, on the interpolated frame N, T, B = sign N x T in
// object space as it is, not normalised. In the other spaces it blends with the interpolated
// normal. All is done on the front side and turned to wo's side at the end. Where the map leaves no
// direction the interpolated normal stands.
template <class T>
Vector3<T> map_normal(NormalSpace space, const T& strength, const Vector3<T>& color, uint32_t layer,
                      const ShadingPoint<T>& point) {
    const T one(1.0f);
    const Vector3<T> c{times(color.x, 2.0f) - one, times(color.y, 2.0f) - one,
                       times(color.z, 2.0f) - one};
    Vector3<T> n;
    if (space == NormalSpace::tangent) {
        if (point.tangent_object == nullptr) return facing_normal(point);
        const T z = one + (c.z - one) * clamp_unit(strength);
        const Vector3<T>& normal = point.normal_object;
        const Vector3<T>& tangent = point.tangent_object[layer];
        const Vector3<T> bitangent = times(cross(normal, tangent), point.bitangent_sign[layer]);
        n = normal_to_world(point,
                            tangent * (c.x * strength) + bitangent * (c.y * strength) + normal * z);
        n = flipped(n, point.backfacing);
    } else {
        n = space == NormalSpace::object ? normal_to_world(point, c) : safe_normalize(c);
        n = flipped(n, point.backfacing);
        if (value_of(strength) != 1.0f || !std::is_same_v<T, float>) {
            const Vector3<T> base = facing_normal(point);
            n = safe_normalize(base + (n - base) * non_negative(strength));
        }
    }
    return is_zero(n) || !is_finite(value_of(n)) ? facing_normal(point) : n;
}

// The normal of a surface that is raised by distance x height (m) along `n`, a unit normal on wo's
// side, without being moved [Mikkelsen10]; strength blends between both. As with a normal map, it
// is the relief of the front side that is seen from behind.
template <class T>
Vector3<T> bump_normal(const Vector3<T>& n, const Dual<T>& height, const T& strength,
                       const T& distance, const ShadingPoint<T>& point) {
    const auto constant = [](const Vec3& a) { return Vector3<T>{T(a.x), T(a.y), T(a.z)}; };
    const Vector3<T> front = flipped(n, point.backfacing);
    const Vector3<T> dp_du = constant(point.dp_du), dp_dv = constant(point.dp_dv);
    const Vector3<T> across_u = cross(dp_dv, front), across_v = cross(front, dp_du);
    const T area = dot(dp_du, across_u);  // negative where the instance is mirrored
    const Vector3<T> gradient = across_u * height.du + across_v * height.dv;
    const float sign = value_of(area) < 0.0f ? -1.0f : 1.0f;
    const Vector3<T> raised =
        safe_normalize(front * times(area, sign) - gradient * times(distance, sign));
    const T s = non_negative(strength);
    const Vector3<T> mixed =
        is_zero(raised) ? front : safe_normalize(raised * s + front * (T(1.0f) - s));
    return is_zero(mixed) || !is_finite(value_of(mixed)) ? n : flipped(mixed, point.backfacing);
}

}  // namespace spc
