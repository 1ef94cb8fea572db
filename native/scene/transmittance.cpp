// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/transmittance.h"

namespace spc {

Spectrum transmittance(const Scene& scene, const RayStart& from, const ChainEnd& end, uint32_t kind,
                       uint32_t& transparent_left, Media& media, uint64_t& rays, Opaque opaque) {
    constexpr float kFarMargin =
        1e-4f;  // relative: the surface at the far end does not block itself
    float distance;
    Vec3 direction = end.from(from.p, distance);
    // Aimed anew from where the ray starts: a parallel ray would meet the far surface off its mark.
    const Vec3 origin = offset_origin(from, direction);
    direction = end.from(origin, distance);
    Ray ray{origin, direction, 0.0f, distance * (1.0f - kFarMargin) - end.margin};
    const float reach = distance - end.margin;
    if (!scene.any_transparency) {
        ++rays;
        return scene.accel->occluded(ray, kind) ? Spectrum(0.0f) : media.transmittance(reach);
    }
    Spectrum through(1.0f);
    for (float passed = 0.0f;;) {
        ++rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, kind);
        if (!hit) return through * media.transmittance(reach - passed);
        if (hit->light == kNone) {
            if (transparent_left == 0) return Spectrum(0.0f);
            if (opaque == Opaque::casters_too && scene.instances[hit->surface.instance].turns_light())
                return Spectrum(0.0f);
            --transparent_left;
            through *= surface_transparency(scene, hit->surface, direction * -1.0f) *
                       media.transmittance(hit->t - passed);
            if (is_black(through)) return through;
            media.cross(scene, hit->surface, direction);
            passed = hit->t;
        }
        ray.t_near = past(hit->t);
    }
}

}  // namespace spc
