// SPDX-License-Identifier: GPL-3.0-or-later
// Absorbing media along a path.
#pragma once

#include "scene/surface.h"

namespace spc {

// The homogeneous media that a segment of a path lies in. A medium fills the space behind an
// instance's front faces of one material. Where media overlap their coefficients add up, as in
// Cycles, so the result does not depend on the direction of light.
class Media {
public:
    // Updates the media when the path crosses a surface along `direction`: it enters the medium
    // behind a front face and leaves it through a back face. Leaving a medium that was not entered
    // has no effect.
    void cross(const Scene& scene, const SurfaceHit& hit, const Vec3& direction);

    // exp(-sigma t) along a segment of `distance` m. For kInfinity black if anything absorbs.
    Spectrum transmittance(float distance) const;

private:
    static constexpr uint32_t kMost = 8;  // further media are treated as if they did not absorb
    struct Entry {
        uint32_t instance, material;
        uint32_t depth;  // entries minus exits
        Spectrum sigma;  // 1/m
    };
    uint32_t count_ = 0;
    std::array<Entry, kMost> entries_;
};

// The media at a point, by what a ray from there to the outside leaves and enters. The ray goes
// upwards as in Cycles, which matters if a mesh is not closed. Adds the number of rays cast to
// `rays`.
Media media_at(const Scene& scene, const Vec3& p, uint64_t& rays);

}  // namespace spc
