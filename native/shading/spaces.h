// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of a ShadingPoint from space to space, over T = float or a dual.
#pragma once

#include "shading/arithmetic.h"
#include "shading/program.h"

namespace spc {

template <class T>
Vector3<T> apply(const Transform& transform, const Vector3<T>& a) {
    return apply_rows(transform.row, a);
}
template <class T>
Vector3<T> moved(const Vector3<T>& a, const Vec3& by) {
    return {a.x + T(by.x), a.y + T(by.y), a.z + T(by.z)};
}
template <class T>
Vector3<T> apply_to_point(const Transform& transform, const Vector3<T>& a) {
    return moved(apply(transform, a), transform.translation);
}

// A world has no object: its space is the world's.
template <class T>
Vector3<T> transformed(uint8_t mode, Vector3<T> a, const ShadingPoint<T>& point) {
    const auto from = static_cast<VectorSpace>(mode & 3),
               to = static_cast<VectorSpace>(mode >> 2 & 3);
    const auto meaning = static_cast<VectorMeaning>(mode >> 4);
    const bool is_point = meaning == VectorMeaning::point,
               has_object = point.object_to_world != nullptr;
    const auto through = [&](const Transform& transform) {
        return is_point ? apply_to_point(transform, a) : apply(transform, a);
    };
    if (from == to) return a;
    if (from == VectorSpace::camera) a = through(point.view->to_world);
    if (from == VectorSpace::object && has_object) {
        a = meaning == VectorMeaning::normal ? apply_transposed(point.world_to_object->row, a)
                                             : through(*point.object_to_world);
        if (is_point) a = moved(a, point.view->origin);
    }
    if (to == VectorSpace::camera) a = through(point.view->from_world);
    if (to == VectorSpace::object && has_object) {
        if (is_point) a = moved(a, point.view->origin * -1.0f);
        a = meaning == VectorMeaning::normal ? apply_transposed(point.object_to_world->row, a)
                                             : through(*point.world_to_object);
    }
    return meaning == VectorMeaning::normal ? safe_normalize(a) : a;
}

template <class T>
Vector3<T> in_view(const ShadingPoint<T>& point) {
    return apply_to_point(point.view->from_world, point.position);
}

template <class T>
Vector3<T> in_window(const ShadingPoint<T>& point) {
    const ViewSpace& view = *point.view;
    const Vector3<T> at = in_view(point);
    const T depth = view.perspective ? at.z : T(1.0f);
    if (value_of(depth) == 0.0f) return {};
    const auto& [left, right, bottom, top] = view.viewplane;
    return {times(at.x / depth - T(left), 1.0f / (right - left)),
            times(at.y / depth - T(bottom), 1.0f / (top - bottom)), T(0.0f)};
}

// 1 if the point is within half of `width` of the triangle's sides, else 0. `in_pixels`: as the
// camera sees them where the point is.
template <class T>
float is_near_side(float width, bool in_pixels, const ShadingPoint<T>& point) {
    if (in_pixels) {
        const float depth = point.view->perspective ? std::abs(value_of(in_view(point)).z) : 1.0f;
        width *= point.view->pixel * depth;
    }
    const Vec3 third = point.dp_dv - point.dp_du;
    const float twice_area = length(cross(point.dp_du, point.dp_dv));
    const float u = value_of(point.u), v = value_of(point.v);
    const auto is_near = [&](float weight, const Vec3& side) {
        return weight * twice_area < 0.5f * width * length(side);
    };
    const bool near =
        is_near(1.0f - u - v, third) || is_near(u, point.dp_dv) || is_near(v, point.dp_du);
    return near ? 1.0f : 0.0f;
}

}  // namespace spc
