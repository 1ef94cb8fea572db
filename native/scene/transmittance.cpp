// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/transmittance.h"

namespace spc {

Vec3 RayEnd::beside(const Vec3& vertex) const {
    float distance;
    const Vec3 direction = at.from(vertex, distance);
    const float off = error + ray_error * distance;
    if (is_black(ng)) return at.p - direction * std::min(off, distance);
    return at.p - ng * std::copysign(off, dot(ng, direction));
}

RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const Vec3& p) {
    const RayStart start = ray_start(scene, hit, p);
    return {{false, p, Vec3(0.0f)}, start.ng, start.error, ray_error(scene, hit.instance)};
}

RayEnd end_on(const Scene& scene, const SurfaceHit& hit, const DifferentialGeometry& vertex) {
    return {
        {false, vertex.p, Vec3(0.0f)}, vertex.ng, vertex.p_error, ray_error(scene, hit.instance)};
}

Spectrum transmittance(const Scene& scene, const RayStart& from, const RayEnd& end, uint32_t kind,
                       uint32_t& transparent_left, Media& media, uint64_t& rays, Opaque opaque,
                       uint64_t blockers) {
    return transmittance(scene, from, end, kind, ray_seen_as(kind), transparent_left, media, rays,
                         opaque, blockers);
}

Spectrum transmittance(const Scene& scene, const RayStart& from, const RayEnd& end, uint32_t kind,
                       RayState seen_by, uint32_t& transparent_left, Media& media, uint64_t& rays,
                       Opaque opaque, uint64_t blockers) {
    ChainEnd aim = end.at;
    if (!aim.distant) aim.p = end.beside(from.p);
    float distance;
    Vec3 direction = aim.from(from.p, distance);
    // Aimed anew from where the ray starts: a parallel ray would meet the far surface off its mark.
    const Vec3 origin = offset_origin(from, direction);
    direction = aim.from(origin, distance);
    const float t_far = distance - end.clip;
    Ray ray{origin, direction, 0.0f, t_far};
    if (!scene.any_transparency && blockers == 0) {
        ++rays;
        return scene.accel->occluded(ray, kind) ? Spectrum(0.0f) : media.transmittance(t_far);
    }
    Spectrum through(1.0f);
    for (float passed = 0.0f;;) {
        ++rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, kind);
        if (!hit) return through * media.transmittance(t_far - passed);
        if (hit->light == kNone &&
            is_linked(blockers, scene.instances[hit->surface.instance].sets.blocks)) {
            if (transparent_left == 0) return Spectrum(0.0f);
            if (opaque == Opaque::casters_too && scene.instances[hit->surface.instance].turns_light())
                return Spectrum(0.0f);
            --transparent_left;
            seen_by.length = hit->t;
            through *= surface_transparency(scene, hit->surface, direction * -1.0f, seen_by) *
                       media.transmittance(hit->t - passed);
            if (is_black(through)) return through;
            ++seen_by.transparent_depth;
            media.cross(scene, hit->surface, direction);
            passed = hit->t;
        }
        ray.t_near = past(hit->t);
    }
}

}  // namespace spc
