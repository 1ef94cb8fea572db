// SPDX-License-Identifier: GPL-3.0-or-later
// How large the numbers of a scene may be; specula.h states it for callers. Within these single
// precision holds what renders make of them: squares of areas, light over squares of distances.
#pragma once

namespace spc {

// Largest coordinate in object and in world space, and largest extent. Also the largest entry of a
// transform's linear part and of its inverse, so that rays stay valid in a mesh's own space.
inline constexpr float kFarthest = 1e8f;  // m
// Largest value of everything without a unit of length: colours, strengths, powers, texels,
// normals.
inline constexpr float kLargestNumber = 1e15f;

}  // namespace spc
