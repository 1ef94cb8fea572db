// SPDX-License-Identifier: GPL-3.0-or-later
// Random walks below a surface that scatters light there.
#pragma once

#include "core/random.h"
#include "scene/surface.h"

namespace spc {

// Where a walk that went below `surface`, by the closure `medium` of its list, leaves the object: a
// diffuse surface seen from outside. `weight` is the light that is left of a closure that
// reflects all, divided by the density of the walk. Empty where the light is lost.
struct SubsurfaceExit {
    Surface surface;
    Spectrum weight;
};
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const Surface& surface,
                                         const Subsurface& medium, Pcg& pcg, uint64_t& rays);

}  // namespace spc
