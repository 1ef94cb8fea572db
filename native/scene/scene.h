// SPDX-License-Identifier: GPL-3.0-or-later
// The frozen scene: geometry, materials and lamps as data, with Embree's trees over them. Immutable
// while it is rendered, and shared by all threads; indices refer, vectors own. It is a snapshot:
// the next one shares with it what has not changed.
#pragma once

#include "scene/accel.h"
#include "scene/description.h"

#include <memory>

namespace spc {

struct Scene {
    std::vector<Image> images;  // whose texels are shared
    std::vector<Shared<Material>> materials;
    std::vector<Shared<Mesh>> meshes;
    // The same as the host gave them, before freezing added to some: what the next snapshot keeps.
    // Of a series alone.
    std::vector<Shared<Mesh>> sources;
    std::vector<Instance> instances;
    std::vector<LightDesc> lights;
    Vec3 origin{0.0f};  // of all world coordinates here, in the host's: see center_on_casters()
    Camera camera;
    ViewSpace view;  // of the camera
    Environment environment;
    bool any_transparency = false;  // some material lets shadow rays through
    Bounds absorbing;               // around the instances that absorb, world
    // Diffuse, glossy and transmission rays see the same objects, and the camera's film has an
    // inverse.
    bool light_paths_reach_camera = true;
    float bounds_radius = 0.0f;       // half the diagonal of the box around all geometry and lamps
    std::vector<std::string> report;  // for the log
    // Whether each instance has a tree of its own, which the next snapshot shares if it has not
    // changed; else single users of a mesh are in one tree, which is faster to trace and slower to
    // make.
    bool has_trees_to_share = false;
    std::unique_ptr<Accel> accel;

    // Looks from elsewhere; `checked` is in the host's coordinates. Nothing else depends on the
    // camera.
    void move_camera(const Camera& checked) {
        camera = checked;
        camera.to_world.translation -= origin;
        view = view_space(camera, origin);
    }
    const Material& material_of(const SurfaceHit& hit) const {
        return materials[material_index(hit.instance, hit.triangle)];
    }
    uint32_t material_index(uint32_t instance, uint32_t triangle) const {
        const Instance& inst = instances[instance];
        return inst.materials[meshes[inst.mesh]->slot_of(triangle)];
    }
    // Of an instance's vertices, world.
    Bounds bounds_of(uint32_t instance) const {
        const Instance& inst = instances[instance];
        Bounds bounds;
        for (const Vec3& p : meshes[inst.mesh]->positions)
            bounds.extend(inst.object_to_world.point(p));
        return bounds;
    }
    // World positions of a triangle's corners.
    std::array<Vec3, 3> triangle_world(uint32_t instance, uint32_t triangle) const {
        const Instance& inst = instances[instance];
        const std::array<uint32_t, 3>& index = meshes[inst.mesh]->triangles[triangle];
        if (!inst.world_positions.empty())
            return {inst.world_positions[index[0]], inst.world_positions[index[1]],
                    inst.world_positions[index[2]]};
        const std::vector<Vec3>& p = meshes[inst.mesh]->positions;
        return {inst.object_to_world.point(p[index[0]]), inst.object_to_world.point(p[index[1]]),
                inst.object_to_world.point(p[index[2]])};
    }
};

}  // namespace spc
