// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/triangle.h"
#include "scene/builder.h"
#include "scene/caustics_part.h"
#include "shading/uv_needs.h"

#include <fmt/format.h>

#include <unordered_map>

namespace spc {

// Far from the origin single precision has no digits left for the shape of casters, on which all
// chains depend: then the world moves so that its origin lies among them.
void center_on_casters(Scene& scene) {
    constexpr float kFar = 256.0f;  // times the casters' size
    Bounds bounds;
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        if (scene.instances[i].turns_light()) bounds.extend(scene.bounds_of(i));
    if (bounds.empty()) return;
    const Vec3 center = (bounds.lower + bounds.upper) * 0.5f;
    if (!(length(center) > kFar * length(bounds.upper - bounds.lower))) return;
    scene.origin = center;
    for (Instance& instance : scene.instances) {
        instance.object_to_world.translation -= center;
        instance.world_to_object = instance.object_to_world.inverse();
    }
    for (LightDesc& light : scene.lights) light.to_world.translation -= center;
    scene.camera.to_world.translation -= center;
}

namespace {

bool same_place(const Transform& a, const Transform& b) {
    return a.row == b.row && a.translation == b.translation;
}

SharedArray<Vec3> baked(const Mesh& mesh, const Transform& to_world) {
    std::vector<Vec3> world;
    world.reserve(mesh.positions.size() + 1);  // Embree reads 16 bytes at the last vertex
    for (const Vec3& p : mesh.positions) world.push_back(to_world.point(p));
    return SharedArray(std::move(world));
}

}  // namespace

void bake_single_users(Scene& scene, const Scene* before) {
    std::unordered_map<const Mesh*, const Instance*> baked_before;
    if (before != nullptr)
        for (const Instance& instance : before->instances)
            if (!instance.world_positions.empty())
                baked_before[before->meshes[instance.mesh].get()] = &instance;
    std::vector<uint32_t> users(scene.meshes.size(), 0);
    for (const Instance& instance : scene.instances) ++users[instance.mesh];
    for (Instance& instance : scene.instances) {
        if (users[instance.mesh] != 1) continue;
        const Shared<Mesh>& mesh = scene.meshes[instance.mesh];
        const auto known = baked_before.find(mesh.get());
        const bool stays = known != baked_before.end() &&
                           same_place(known->second->object_to_world, instance.object_to_world);
        instance.world_positions =
            stays ? known->second->world_positions : baked(mesh, instance.object_to_world);
    }
}

namespace {

// Tangents for a layer whose host gave none: the direction of growing u, constant on each triangle.
void derive_tangents(const Mesh& mesh, UvLayer& layer) {
    layer.tangents.resize(layer.uv.size());
    layer.tangent_signs.resize(layer.uv.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 e1 = mesh.positions[b] - mesh.positions[a],
                   e2 = mesh.positions[c] - mesh.positions[a];
        const Vec2 d1 = layer.uv[3 * t + 1] - layer.uv[3 * t],
                   d2 = layer.uv[3 * t + 2] - layer.uv[3 * t];
        const float det = d1.x * d2.y - d1.y * d2.x;
        const Vec3 fallback = Frame::around(unit_normal(e1, e2)).x;
        const Vec3 along_u = (e1 * d2.y - e2 * d1.y) * (det < 0.0f ? -1.0f : 1.0f);
        for (size_t k = 0; k < 3; ++k) {
            layer.tangents[3 * t + k] = safe_normalize(along_u, fallback);
            layer.tangent_signs[3 * t + k] = det < 0.0f ? -1.0f : 1.0f;
        }
    }
}

Mesh with_derived_tangents(const Mesh& mesh, uint32_t layer) {
    Mesh derived = mesh;
    derived.positions.reserve(mesh.positions.size() + 1);  // as in SceneBuilder::add_mesh()
    derive_tangents(derived, derived.uv_layers[layer]);
    return derived;
}

uint32_t find_layer(const Mesh& mesh, const std::string& name) {
    if (mesh.uv_layers.empty()) return kNone;
    if (name.empty()) return mesh.active_uv_layer;
    for (uint32_t i = 0; i < mesh.uv_layers.size(); ++i)
        if (mesh.uv_layers[i].name == name) return i;
    return kNone;
}

}  // namespace

void resolve_uv_layers(Scene& scene) {
    for (Instance& instance : scene.instances) {
        Shared<Mesh>& mesh = scene.meshes[instance.mesh];
        instance.uv_layers.resize(instance.materials.size());
        for (size_t slot = 0; slot < instance.materials.size(); ++slot) {
            const Material& material = scene.materials[instance.materials[slot]];
            for (const auto& [name, tangents] : uv_needs(material)) {
                const uint32_t layer = find_layer(mesh, name);
                instance.uv_layers[slot].push_back(layer);
                if (layer == kNone)
                    scene.report.push_back(
                        fmt::format("{}: no UV layer \"{}\" for material {}: coordinates are 0",
                                    instance.name, name, material.name));
                else if (tangents && mesh->uv_layers[layer].tangents.empty())
                    mesh = with_derived_tangents(mesh, layer);
            }
        }
    }
}

void report_images(Scene& scene) {
    for (const Image& image : scene.images)
        if (image.repaired_texels > 0)
            scene.report.push_back(
                fmt::format("image \"{}\": {} texels were not finite and are read as 0", image.name,
                            image.repaired_texels));
}

void note_materials(Scene& scene) {
    for (Instance& instance : scene.instances)
        for (const uint32_t index : instance.materials) {
            const Material& material = scene.materials[index];
            instance.emits = instance.emits || material.emits;
            instance.has_subsurface = instance.has_subsurface || material.has_subsurface;
            scene.any_transparency = scene.any_transparency || material.may_be_transparent;
        }
}

// A path knows its media by what it has crossed: an instance that some of its rays do not meet would
// leave it in the dark about whether it is inside.
void find_media(Scene& scene) {
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        Instance& instance = scene.instances[i];
        const auto absorbs = [&](uint32_t material) {
            return !is_black(scene.materials[material]->absorption);
        };
        if (std::none_of(instance.materials.begin(), instance.materials.end(), absorbs)) continue;
        instance.absorbs = (instance.visibility & kVisibleAll) == kVisibleAll;
        if (instance.absorbs)
            scene.absorbing.extend(scene.bounds_of(i));
        else
            scene.report.push_back(fmt::format(
                "{}: hidden from some kinds of rays, so its volume has no effect", instance.name));
    }
}

void assign_caustics_roles(Scene& scene) {
    for (Instance& instance : scene.instances) {
        std::vector<const Material*> materials;
        for (const uint32_t index : instance.materials)
            materials.push_back(scene.materials[index].get());
        const CausticsPart part = caustics_part(materials, instance.role, instance.visibility);
        instance.caster = part.caster;
        instance.rough_caster = part.rough_caster;
        instance.receiver = part.receiver;
        if (part.caster)
            scene.report.push_back(fmt::format("{}: caster, manifold ({})", instance.name, part.why));
        if (part.rough_caster)
            scene.report.push_back(fmt::format("{}: caster, light paths{} ({})", instance.name,
                                               part.chains_turn       ? " and manifold"
                                               : part.chains_may_turn ? ""
                                                                      : " alone",
                                               part.why_rough));
        const bool asked =
            instance.role == CausticsRole::caster || instance.role == CausticsRole::both;
        if (!part.casts() && asked)
            scene.report.push_back(fmt::format("{}: marked as caster, but path traced: {}",
                                               instance.name, part.why_not));
    }
}

// A light path does not know yet by which kind of ray the camera's path would come to a surface.
void check_light_tracing(Scene& scene) {
    const auto casts = [](const Instance& instance) { return instance.turns_light(); };
    if (std::none_of(scene.instances.begin(), scene.instances.end(), casts)) return;
    for (const Instance& instance : scene.instances) {
        const uint32_t seen = instance.visibility & kVisibleScattered;
        if (seen == 0 || seen == kVisibleScattered) continue;
        scene.same_for_scattered_rays = false;
        scene.report.push_back(
            fmt::format("{}: hidden from some kinds of rays, so no light tracing", instance.name));
    }
}

void bound_scene(Scene& scene) {
    Bounds bounds;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) bounds.extend(scene.bounds_of(i));
    for (const LightDesc& light : scene.lights)
        if (light.type != LightType::sun) bounds.extend(light.position());
    if (!bounds.empty()) scene.bounds_radius = 0.5f * length(bounds.upper - bounds.lower);
}

}  // namespace spc
