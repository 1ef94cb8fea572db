// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/description.h"

namespace spc {

Ray Camera::ray(float x, float y) const {
    const auto& [left, right, bottom, top] = viewplane;
    const Vec3 local(lerp(left, right, x / static_cast<float>(width)),
                     lerp(bottom, top, y / static_cast<float>(height)), -1.0f);
    const float stretch = length(local);  // distance along the ray per distance along the axis
    return {to_world.translation, to_world.vector(local * (1.0f / stretch)), clip_near * stretch,
            clip_far * stretch};
}

std::optional<CameraView> Camera::view(const Vec3& p, const Vec2& /*lens*/) const {
    const auto& [left, right, bottom, top] = viewplane;
    const Vec3 to_p = p - to_world.translation;
    const float z = -dot(to_p, to_world.column(2)), distance = length(to_p);
    if (!(z > 0.0f) || z < clip_near || z > clip_far) return std::nullopt;
    const float inv = 1.0f / z;
    const Vec2 plane(dot(to_p, to_world.column(0)) * inv, dot(to_p, to_world.column(1)) * inv);
    const Vec2 scale(static_cast<float>(width) / (right - left),
                     static_cast<float>(height) / (top - bottom));
    const float stretch = distance * inv;
    return CameraView{to_world.translation, clip_near * stretch, clip_far * stretch,
                      {(plane.x - left) * scale.x, (plane.y - bottom) * scale.y},
                      std::abs(scale.x * scale.y) * distance * inv * inv * inv};
}

float Camera::depth(const Vec3& p) const {
    return -dot(p - to_world.translation, to_world.column(2));
}

}  // namespace spc
