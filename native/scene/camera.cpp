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

float Camera::depth(const Vec3& p) const {
    return -dot(p - to_world.translation, to_world.column(2));
}

}  // namespace spc
