// SPDX-License-Identifier: GPL-3.0-or-later
// Collects and validates a scene, then freezes it.
#pragma once

#include "scene/scene.h"

namespace spc {

class SceneBuilder {
public:
    SceneBuilder();
    // For a snapshot that shares what it keeps of the one before, which may be null.
    explicit SceneBuilder(std::shared_ptr<const Scene> before);
    // Each returns the index by which others refer to the object. They throw Error, which names the
    // object, and then have changed nothing.
    uint32_t add_image(Image image);
    uint32_t add_material(const Graph& graph);
    uint32_t add_mesh(Mesh mesh);  // drops triangles of zero area
    uint32_t add_instance(Instance instance);
    uint32_t add_light(LightDesc light);
    // What the snapshot before has at an index there. A material's images must have been kept, with
    // their indices.
    uint32_t keep_image(uint32_t index);
    uint32_t keep_material(uint32_t index);
    uint32_t keep_mesh(uint32_t index);
    void set_camera(const Camera& camera);
    void set_environment(const Environment& environment);

    const Material& material(uint32_t index) const;
    const Mesh& mesh(uint32_t index) const;

    // Throws Error (wrong_state) if something is missing that every render needs.
    void require_complete() const;
    // Builds the trees and decides who casts and who receives caustics. Empties the builder.
    std::unique_ptr<Scene> freeze(uint32_t threads);

private:
    std::shared_ptr<const Scene> before_;
    std::unique_ptr<Scene> scene_;
    bool has_camera_ = false;
    uint32_t invisible_material_ = kNone;  // made when a slot draws nothing

    uint32_t invisible_material();
    const Scene& before() const;
};

// The camera with its frame made orthonormal, since a scaled frame would change depths. Throws
// Error (invalid), which names what is wrong.
Camera checked_camera(const Camera& camera);

// Steps of freeze(). Each may append to scene.report.
void report_images(Scene& scene);
void resolve_attributes(Scene& scene);  // names -> indices, fallback tangents
void note_materials(Scene& scene);      // sets flags of instances and scene by their materials
void find_media(Scene& scene);          // which instances absorb
void assign_caustics_roles(Scene& scene);
void check_light_tracing(Scene& scene);  // after the roles
void center_on_casters(Scene& scene);    // after the roles
// World-space vertices for meshes with one instance, and for copies of small ones; those of
// `before`, if it is not null, where neither mesh nor place has changed.
void bake_positions(Scene& scene, const Scene* before);
void bound_scene(Scene& scene);

}  // namespace spc
