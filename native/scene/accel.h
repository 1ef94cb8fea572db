// SPDX-License-Identifier: GPL-3.0-or-later
// Ray casts, by Embree (3 or 4).
#pragma once

#include "scene/description.h"

namespace spc {

struct Scene;

// A point on a triangle. The barycentric weights of the corners are (1 - u - v, u, v).
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
    // Builds trees over the meshes, instances and lamps of a scene whose world positions are set;
    // the scene's lists must not move. Trees over vertices of which `before`, if it is not null,
    // has one are shared with it. `threads` 0 = all; with trees to share, those of the first scene.
    Accel(const Scene& scene, uint32_t threads, const Accel* before = nullptr);
    ~Accel();
    Accel(const Accel&) = delete;
    Accel& operator=(const Accel&) = delete;

    // A ray that is not finite, or starts beyond everything, is counted as lost instead of cast: it
    // hits nothing, and occluded() is true.

    // Nearest hit of anything that is visible to `kind`, a bit of Visibility. Lamps are hit on
    // their surface.
    std::optional<Hit> intersect(const Ray& ray, uint32_t kind) const;
    // Whether anything that is visible to `kind` blocks the ray. Lamps block nothing.
    bool occluded(const Ray& ray, uint32_t kind) const;
    // Nearest hit on one instance's triangles; everything else is ignored.
    std::optional<Hit> intersect_alone(uint32_t instance, const Ray& ray) const;
    // Makes intersect_alone() available for an instance. Called while freezing.
    void prepare_alone(const Scene& scene, uint32_t instance);

    // Number of lost rays so far, by all users of the scene.
    uint64_t lost_rays() const;

    static const char* library_version();  // "Embree 3.13.5"

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace spc
