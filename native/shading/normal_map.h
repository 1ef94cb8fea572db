// SPDX-License-Identifier: GPL-3.0-or-later
// Blender's Normal Map node, over T = float or Dual2.
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
        if (value_of(strength) != 1.0f || std::is_same_v<T, Dual2>) {
            const Vector3<T> base = facing_normal(point);
            n = safe_normalize(base + (n - base) * non_negative(strength));
        }
    }
    return is_zero(n) || !is_finite(value_of(n)) ? facing_normal(point) : n;
}

}  // namespace spc
