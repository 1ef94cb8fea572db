// SPDX-License-Identifier: GPL-3.0-or-later
// Ray casts, by Embree (3 or 4).
#pragma once

#include "scene/description.h"

namespace spc {

struct Scene;

// A point on a triangle: barycentrics weigh the corners (1 - u - v, u, v).
struct SurfaceHit {
    uint32_t instance;
    uint32_t triangle;
    float u, v;
};

struct Hit {
    float t;
    uint32_t light;  // index of a lamp, or kNone: then `surface` is valid
    SurfaceHit surface;
};

class Accel {
public:
    // Builds over the meshes, instances and lamps of a scene whose world positions are set.
    // `threads` 0 = all. The accel refers to the scene's vertex buffers: they must stay where they
    // are.
    Accel(const Scene& scene, uint32_t threads);
    ~Accel();
    Accel(const Accel&) = delete;
    Accel& operator=(const Accel&) = delete;

    // A ray that is not finite, or starts beyond everything, is not cast but counted: it meets
    // nothing, and no light passes along it.

    // Nearest hit of anything that shows itself to `kind`, a bit of Visibility. Lamps are hit by
    // their surface.
    std::optional<Hit> intersect(const Ray& ray, uint32_t kind) const;
    // Whether anything that shows itself to `kind` is in the way. Lamps never are.
    bool occluded(const Ray& ray, uint32_t kind) const;
    // Nearest hit on one caster's triangles alone, whatever stands in the way.
    std::optional<Hit> intersect_caster(uint32_t instance, const Ray& ray) const;
    // Makes intersect_caster available for an instance; called while freezing.
    void prepare_caster(const Scene& scene, uint32_t instance);

    // Rays that could not be cast so far, by all who share the scene.
    uint64_t lost_rays() const;

    static const char* library_version();  // "Embree 3.13.5"

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace spc
