// SPDX-License-Identifier: GPL-3.0-or-later
// The frozen scene: geometry, materials and lamps as data, with Embree's trees over them. Immutable
// and shared by all threads; indices refer, vectors own.
#pragma once

#include "scene/accel.h"
#include "scene/description.h"

#include <memory>

namespace spc {

struct Scene {
    std::vector<Image> images;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<LightDesc> lights;
    Camera camera;
    Environment environment;
    bool any_transparency = false;  // some material lets shadow rays through
    Vec3 bounds_center{0.0f};       // bounding sphere of all geometry and lamps
    float bounds_radius = 0.0f;
    std::vector<std::string> report;  // for the log
    std::unique_ptr<Accel> accel;

    const Material& material_of(const SurfaceHit& hit) const {
        const Instance& instance = instances[hit.instance];
        const Mesh& mesh = meshes[instance.mesh];
        return materials[instance.materials[mesh.slots.empty() ? 0 : mesh.slots[hit.triangle]]];
    }
    uint32_t material_index(uint32_t instance, uint32_t triangle) const {
        const Mesh& mesh = meshes[instances[instance].mesh];
        return instances[instance].materials[mesh.slots.empty() ? 0 : mesh.slots[triangle]];
    }
    // World positions of a triangle's corners.
    std::array<Vec3, 3> triangle_world(uint32_t instance, uint32_t triangle) const {
        const Instance& inst = instances[instance];
        const std::array<uint32_t, 3>& index = meshes[inst.mesh].triangles[triangle];
        if (!inst.world_positions.empty())
            return {inst.world_positions[index[0]], inst.world_positions[index[1]],
                    inst.world_positions[index[2]]};
        const std::vector<Vec3>& p = meshes[inst.mesh].positions;
        return {inst.object_to_world.point(p[index[0]]), inst.object_to_world.point(p[index[1]]),
                inst.object_to_world.point(p[index[2]])};
    }
};

}  // namespace spc
