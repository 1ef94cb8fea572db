// SPDX-License-Identifier: GPL-3.0-or-later
// The world's directions, sampled in proportion to a table of its radiance above the mean,
// interpolated bilinearly. The table is latitude-longitude in the orientation of Blender's
// environment images, so that an unrotated image's texels are its own:
//   u = 1/2 - atan2(y, x) / (2 pi),   v = 1 - acos(z) / pi.
#pragma once

#include "light/light.h"

namespace spc {

// Sets the world_* members of `lights` and has_world; `before` as for build_lights().
void build_world(const Scene& scene, LightSet& lights, uint32_t threads, const LightSet* before);
// Integral of the luminance above its mean over all directions, and over the peaks, W/m^2; none of
// a constant world.
double world_excess(const LightSet& lights);
double world_excess_of_peaks(const LightSet& lights);

struct WorldSample {
    Vec3 wi;
    float pdf_omega;  // 1/sr
};
// Empty at a pole itself. Only with has_world.
std::optional<WorldSample> sample_world(const LightSet& lights, const Vec2& u);
float world_pdf(const LightSet& lights, const Vec3& wi);
// Among the peaks alone.
std::optional<WorldSample> sample_world_peaks(const LightSet& lights, const Vec2& u);
float world_peaks_pdf(const LightSet& lights, const Vec3& wi);

}  // namespace spc
