// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/media.h"

namespace spc {

namespace {

// Whether a ray upwards from p may meet anything that absorbs.
bool may_be_inside(const Bounds& absorbing, const Vec3& p) {
    return p.x >= absorbing.lower.x && p.x <= absorbing.upper.x && p.y >= absorbing.lower.y &&
           p.y <= absorbing.upper.y && p.z <= absorbing.upper.z;
}

}  // namespace

void Media::cross(const Scene& scene, const SurfaceHit& hit, const Vec3& direction) {
    if (!scene.instances[hit.instance].absorbs) return;
    const uint32_t material = scene.material_index(hit.instance, hit.triangle);
    const Spectrum& sigma = scene.materials[material]->absorption;
    if (is_black(sigma)) return;
    const bool enters = dot(front_normal(scene, hit.instance, hit.triangle), direction) < 0.0f;
    uint32_t i = 0;
    while (i < count_ && !(entries_[i].instance == hit.instance && entries_[i].material == material))
        ++i;
    if (i < count_) {
        if (enters)
            ++entries_[i].depth;
        else if (--entries_[i].depth == 0)
            entries_[i] = entries_[--count_];
    } else if (enters && count_ < kMost) {
        entries_[count_++] = {hit.instance, material, 1, sigma};
    }
}

Spectrum Media::transmittance(float distance) const {
    Spectrum through(1.0f);
    if (count_ == 0) return through;
    Spectrum sigma(0.0f);
    for (uint32_t i = 0; i < count_; ++i) sigma += entries_[i].sigma;
    // An infinite coefficient or distance must not meet a zero of the other.
    constexpr float kLargest = std::numeric_limits<float>::max();
    for (int c = 0; c < 3; ++c)
        if (sigma[c] > 0.0f) through[c] = std::exp(-std::min(sigma[c], kLargest) * distance);
    return through;
}

Media media_at(const Scene& scene, const Vec3& p, uint64_t& rays) {
    Media media;
    if (!may_be_inside(scene.absorbing, p)) return media;
    Ray ray{p, Vec3(0.0f, 0.0f, 1.0f)};
    std::vector<SurfaceHit> passed;
    for (;;) {
        ++rays;
        const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleCamera);
        if (!hit) break;
        if (hit->light == kNone && scene.instances[hit->surface.instance].absorbs)
            passed.push_back(hit->surface);
        ray.t_near = past(hit->t);
    }
    // The way back: from outside, where nothing absorbs.
    for (auto hit = passed.rbegin(); hit != passed.rend(); ++hit)
        media.cross(scene, *hit, ray.direction * -1.0f);
    return media;
}

}  // namespace spc
