// SPDX-License-Identifier: GPL-3.0-or-later
// The ray that a surface or the world is seen by, as far as graphs may ask for it.
#pragma once

#include <cstdint>
#include <limits>

namespace spc {

// Bits of ray visibility. A ray has the bit of its kind, an object those of the rays that see it.
enum Visibility : uint32_t {
    kVisibleCamera = 1,
    kVisibleDiffuse = 2,
    kVisibleGlossy = 4,
    kVisibleTransmission = 8,
    kVisibleShadow = 16,
    kVisibleAll = 31,
    // Rays after a bounce.
    kVisibleScattered = kVisibleDiffuse | kVisibleGlossy | kVisibleTransmission
};

// What Light Path tells of a ray besides its lengths and depths.
enum RayKind : uint32_t {
    kRayCamera = 1,
    kRayShadow = 2,
    kRayDiffuse = 4,
    kRayGlossy = 8,  // any but a diffuse scattering, refraction included
    kRaySingular = 16,
    kRayReflection = 32,
    kRayTransmission = 64
};

// Length of a ray that leaves the scene, m: as good as infinite, but can be reckoned with.
inline constexpr float kFromAfar = std::numeric_limits<float>::max();

// By default the ray is of no kind, as that to a light in next event estimation is in Cycles: the
// light is evaluated once for all that the receiver scatters.
struct RayState {
    uint32_t kinds = 0;   // of RayKind
    float length = 0.0f;  // m
    uint32_t depth = 0;   // bounces before it, of each kind and in all
    uint32_t diffuse_depth = 0;
    uint32_t glossy_depth = 0;
    uint32_t transparent_depth = 0;
    uint32_t transmission_depth = 0;
};

// A ray of that visibility of which nothing else is known.
constexpr RayState ray_seen_as(uint32_t visibility) {
    RayState ray;
    switch (visibility) {
        case kVisibleCamera: ray.kinds = kRayCamera; break;
        case kVisibleShadow: ray.kinds = kRayShadow; break;
        case kVisibleDiffuse: ray.kinds = kRayDiffuse | kRayReflection; break;
        case kVisibleGlossy: ray.kinds = kRayGlossy | kRayReflection; break;
        case kVisibleTransmission: ray.kinds = kRayGlossy | kRayTransmission; break;
        default: break;
    }
    return ray;
}

}  // namespace spc
