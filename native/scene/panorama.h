// SPDX-License-Identifier: GPL-3.0-or-later
// Panoramic projections, as Cycles has them.
#pragma once

#include "scene/description.h"

namespace spc {

// Where a camera looks from a point of its viewplane, in shares of the whole panorama from its
// lower left corner: unit, in camera space, ahead along -z. Empty where a round picture has ended.
std::optional<Vec3> panoramic_direction(const Camera& camera, const Vec2& at);

}  // namespace spc
