// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/mesh_emitter.h"

#include "core/limits.h"
#include "math/triangle.h"
#include "math/warp.h"
#include "scene/surface.h"

namespace spc {

namespace {

constexpr double kBrightestPart = 1e37;  // W

struct ShiningTriangle {
    uint32_t index;
    float flux;  // W, of luminance
    Bounds bounds;

    Vec3 center() const { return (bounds.lower + bounds.upper) * 0.5f; }
};

class PartsBuilder {
public:
    explicit PartsBuilder(BuiltEmitter& built) : built_(built) {}

    // Halves them along the longest side of their bounds, into so many parts at most.
    void split(std::span<ShiningTriangle> triangles, uint32_t most_parts) {
        Bounds bounds;
        for (const ShiningTriangle& one : triangles) bounds.extend(one.bounds);
        if (most_parts <= 1 || triangles.size() == 1) return append(triangles, bounds);
        const Vec3 size = bounds.upper - bounds.lower;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const size_t half = triangles.size() / 2;
        std::nth_element(triangles.begin(), triangles.begin() + static_cast<ptrdiff_t>(half),
                         triangles.end(), [&](const ShiningTriangle& a, const ShiningTriangle& b) {
                             const float x = a.center()[axis], y = b.center()[axis];
                             return x != y ? x < y : a.index < b.index;
                         });
        split(triangles.first(half), most_parts / 2);
        split(triangles.subspan(half), most_parts - most_parts / 2);
    }

private:
    void append(std::span<const ShiningTriangle> triangles, const Bounds& bounds) {
        const auto index = static_cast<uint32_t>(built_.emitter.parts.size());
        EmissiveInstance::Part part;
        std::vector<float> flux;
        double sum = 0.0;
        for (const ShiningTriangle& one : triangles) {
            built_.emitter.places[one.index] = {index, static_cast<uint32_t>(flux.size())};
            part.triangles.push_back(one.index);
            flux.push_back(one.flux);
            sum += one.flux;
        }
        part.choice = DiscreteDistribution(flux);
        built_.emitter.parts.push_back(std::move(part));
        const Vec3 center = (bounds.lower + bounds.upper) * 0.5f;
        built_.light_bounds.push_back(
            {.strength = static_cast<float>(std::min(sum, kBrightestPart)) * 0.25f * kInvPi,
             .center = center,
             .radius = length(bounds.upper - center)});
    }

    BuiltEmitter& built_;
};

EmitterPoint point_on(const EmissiveInstance& emitter, const Scene& scene, uint32_t triangle,
                      float probability, const Vec2& u) {
    const Vec2 b = uniform_triangle(u);
    const std::array<Vec3, 3> corner = scene.triangle_world(emitter.instance, triangle);
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const float side = scene.instances[emitter.instance].mirrored ? -1.0f : 1.0f;
    return {{emitter.instance, triangle, b.x, b.y},
            corner[0] + e1 * b.x + e2 * b.y,
            unit_normal(e1, e2) * side,
            probability * emitter.inv_area[triangle]};
}

}  // namespace

std::optional<BuiltEmitter> build_emitter(const Scene& scene, uint32_t instance,
                                          uint32_t most_parts) {
    const size_t count = scene.meshes[scene.instances[instance].mesh]->triangles.size();
    std::vector<float> flux(count, 0.0f);
    std::vector<ShiningTriangle> shining;
    BuiltEmitter built;
    built.emitter.instance = instance;
    built.emitter.inv_area.assign(count, 0.0f);
    built.emitter.places.resize(count);
    for (uint32_t t = 0; t < count; ++t) {
        const Material& material = scene.materials[scene.material_index(instance, t)];
        const float brightness =
            material.emits ? std::min(luminance(material.mean_emission), kLargestNumber) : 0.0f;
        if (!(brightness > 0.0f)) continue;
        const std::array<Vec3, 3> corner = scene.triangle_world(instance, t);
        const float area = 0.5f * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
        if (!(area >= std::numeric_limits<float>::min())) continue;
        flux[t] = 2.0f * kPi * area * brightness;
        built.emitter.inv_area[t] = 1.0f / area;
        built.flux += flux[t];
        Bounds bounds;
        for (const Vec3& p : corner) bounds.extend(p);
        shining.push_back({t, flux[t], bounds});
    }
    if (!(built.flux > 0.0)) return std::nullopt;
    built.emitter.triangles = DiscreteDistribution(flux);
    PartsBuilder(built).split(shining, most_parts);
    return built;
}

EmitterPoint sample_emitter(const EmissiveInstance& emitter, const Scene& scene, const Vec2& u) {
    const DiscreteDistribution::Sample one = emitter.triangles.sample(u.x);
    return point_on(emitter, scene, one.index, one.probability, {one.remapped, u.y});
}

float emitter_pdf_area(const EmissiveInstance& emitter, uint32_t triangle) {
    return emitter.triangles.probability(triangle) * emitter.inv_area[triangle];
}

EmitterPoint sample_emitter_part(const EmissiveInstance& emitter, uint32_t part, const Scene& scene,
                                 const Vec2& u) {
    const DiscreteDistribution::Sample one = emitter.parts[part].choice.sample(u.x);
    return point_on(emitter, scene, emitter.parts[part].triangles[one.index], one.probability,
                    {one.remapped, u.y});
}

float emitter_part_pdf_area(const EmissiveInstance& emitter, uint32_t triangle) {
    const auto [part, index] = emitter.places[triangle];
    if (part == kNone) return 0.0f;
    return emitter.parts[part].choice.probability(index) * emitter.inv_area[triangle];
}

}  // namespace spc
