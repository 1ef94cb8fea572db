// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/mesh_emitter.h"

#include "math/warp.h"
#include "scene/surface.h"

namespace spc {

std::optional<BuiltEmitter> build_emitter(const Scene& scene, uint32_t instance) {
    const size_t count = scene.meshes[scene.instances[instance].mesh].triangles.size();
    std::vector<float> flux(count, 0.0f), inv_area(count, 0.0f);
    double total = 0.0;
    Bounds bounds;
    for (uint32_t t = 0; t < count; ++t) {
        const Material& material = scene.materials[scene.material_index(instance, t)];
        const float brightness = material.emits ? luminance(material.mean_emission) : 0.0f;
        if (!(brightness > 0.0f)) continue;
        const std::array<Vec3, 3> corner = scene.triangle_world(instance, t);
        const float area = 0.5f * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
        if (!(area > 0.0f)) continue;
        flux[t] = 2.0f * kPi * area * brightness;
        inv_area[t] = 1.0f / area;
        total += flux[t];
        for (const Vec3& p : corner) bounds.extend(p);
    }
    if (!(total > 0.0)) return std::nullopt;
    return BuiltEmitter{{instance, DiscreteDistribution(flux), std::move(inv_area)}, total, bounds};
}

EmitterPoint sample_emitter(const EmissiveInstance& emitter, const Scene& scene, const Vec2& u) {
    const DiscreteDistribution::Sample triangle = emitter.triangles.sample(u.x);
    const Vec2 b = uniform_triangle({triangle.remapped, u.y});
    const std::array<Vec3, 3> corner = scene.triangle_world(emitter.instance, triangle.index);
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const float side = scene.instances[emitter.instance].mirrored ? -1.0f : 1.0f;
    return {{emitter.instance, triangle.index, b.x, b.y},
            corner[0] + e1 * b.x + e2 * b.y,
            normalize(cross(e1, e2)) * side,
            triangle.probability * emitter.inv_area[triangle.index]};
}

float emitter_pdf_area(const EmissiveInstance& emitter, uint32_t triangle) {
    return emitter.triangles.probability(triangle) * emitter.inv_area[triangle];
}

}  // namespace spc
