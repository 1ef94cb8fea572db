// SPDX-License-Identifier: GPL-3.0-or-later
// What Cycles does where a shading normal and the surface disagree: reflections that would go below
// the surface, and the edge between light and shadow.
#pragma once

#include "bsdf/closure_traits.h"
#include "math/vec.h"

namespace spc {

// By material; `none` shades as if the normals were the surface's.
enum class BumpCorrection : uint8_t {
    none,
    smoothed,   // until Blender 4.1: all normals are bent, diffuse light fades by [Chiang19]
    microfacet  // normals of glossy closures are bent, diffuse light fades by [Estevez19]
};

// `n`, turned towards the geometric normal `ng` just enough for the mirrored wo to leave the
// surface. All are unit; ng and n are on the side of wo by the geometry.
Vec3 bent_normal(const Vec3& ng, const Vec3& wo, const Vec3& n);

// How the light of a point fades. Reads the interpolated normal alone, on the side of wo.
struct Terminator {
    BumpCorrection bump = BumpCorrection::none;
    float stretch = 1.0f;  // of the angle to the normal that reflected light comes at, >= 1
    Vec3 smooth_n{0, 0, 1};

    bool fades() const { return bump != BumpCorrection::none || stretch != 1.0f; }
};
// Factor on f |cos| of a closure with the normal n for light from wi.
float fade(const Terminator& terminator, const ClosureTraits& row, const Vec3& n, const Vec3& wi);

}  // namespace spc
