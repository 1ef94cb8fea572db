// SPDX-License-Identifier: GPL-3.0-or-later
// How large the numbers of a scene may be; specula.h states it for callers. Within these single
// precision holds what renders make of them: squares of areas, light over squares of distances.
#pragma once

namespace spc {

// Of coordinates in object and in world space, and of extents; also of the entries of a transform's
// linear part and of its inverse's, so that a ray in a mesh's own space stays one.
inline constexpr float kFarthest = 1e8f;  // m
// Of everything else that has no unit of length: colours, strengths, powers, texels, normals.
inline constexpr float kLargestNumber = 1e15f;

}  // namespace spc
