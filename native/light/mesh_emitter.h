// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that shine, on both sides of their triangles: one emitter per instance.
#pragma once

#include "light/light.h"
#include "math/bounds.h"

namespace spc {

struct BuiltEmitter {
    EmissiveInstance emitter;
    double flux = 0.0;                      // W, of luminance
    std::vector<LightBounds> light_bounds;  // of its parts
};
// In so many parts at most. Empty if no triangle of the instance shines.
std::optional<BuiltEmitter> build_emitter(const Scene& scene, uint32_t instance,
                                          uint32_t most_parts);

// A point of the emitter, uniform on a triangle that is drawn in proportion to its flux. u.x also
// draws the triangle: the choice of the light leaves too few digits of its own number.
struct EmitterPoint {
    SurfaceHit hit;
    Vec3 p;
    Vec3 n;          // unit, front side
    float pdf_area;  // 1/m^2
};
EmitterPoint sample_emitter(const EmissiveInstance& emitter, const Scene& scene, const Vec2& u);
float emitter_pdf_area(const EmissiveInstance& emitter, uint32_t triangle);
// The same for one part of the emitter, and for the part that the triangle belongs to.
EmitterPoint sample_emitter_part(const EmissiveInstance& emitter, uint32_t part, const Scene& scene,
                                 const Vec2& u);
float emitter_part_pdf_area(const EmissiveInstance& emitter, uint32_t triangle);

}  // namespace spc
