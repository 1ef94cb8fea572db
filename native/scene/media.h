// SPDX-License-Identifier: GPL-3.0-or-later
// Absorbing media, and in which of them a path is.
#pragma once

#include "scene/surface.h"

namespace spc {

// The homogeneous media that a segment of a path lies in: each fills what lies behind the front
// faces of one instance that have one material. Where they overlap their coefficients add up, as in
// Cycles, so that light meets the same media whichever way it goes.
class Media {
public:
    // The path goes through the surface along `direction`: from its front it enters what lies
    // behind, from its back it leaves it. A surface behind which nothing absorbs makes no
    // difference, nor does leaving what the path has not entered.
    void cross(const Scene& scene, const SurfaceHit& hit, const Vec3& direction);

    // exp(-sigma t) along a segment of `distance` m; kInfinity: black where anything absorbs.
    Spectrum transmittance(float distance) const;

private:
    static constexpr uint32_t kMost = 8;  // no room for more: they are as if they did not absorb
    struct Entry {
        uint32_t instance, material;
        uint32_t depth;  // how often the path has entered it and not left it
        Spectrum sigma;  // 1/m
    };
    uint32_t count_ = 0;
    std::array<Entry, kMost> entries_;
};

// Those at a point, by what a ray from there to the outside leaves and enters: upwards, as Cycles
// looks, which decides where a mesh is not closed. Counts the rays that it casts in `rays`.
Media media_at(const Scene& scene, const Vec3& p, uint64_t& rays);

}  // namespace spc
