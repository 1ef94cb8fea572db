// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/triangle.h"
#include "scene/builder.h"
#include "scene/caustics_part.h"
#include "shading/attribute_needs.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
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

// Copies of triangles that are made at most, some 0.1 kB each.
constexpr size_t kMostCopies = 512 * 1024;

// One tree over all triangles is faster than a tree of instances, whose boxes overlap: where leaves
// are instances, by more than twice. The smallest meshes come first, an instance of which takes
// about as much memory as its triangles. Trees that are shared are those of meshes.
std::vector<char> meshes_to_bake(const Scene& scene) {
    const size_t count = scene.meshes.size();
    std::vector<size_t> users(count, 0), by_size(count);
    for (const Instance& instance : scene.instances) ++users[instance.mesh];
    std::iota(by_size.begin(), by_size.end(), size_t{0});
    const auto triangles = [&](size_t mesh) { return scene.meshes[mesh]->triangles.size(); };
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](size_t a, size_t b) { return triangles(a) < triangles(b); });
    std::vector<char> baked(count, 0);
    size_t left = scene.has_trees_to_share ? 0 : kMostCopies;
    for (const size_t mesh : by_size) {
        const size_t copies = users[mesh] > 1 ? users[mesh] * triangles(mesh) : 0;
        if (copies > left) continue;
        baked[mesh] = 1;
        left -= copies;
    }
    return baked;
}

}  // namespace

void bake_positions(Scene& scene, const Scene* before) {
    std::unordered_map<const Mesh*, const Instance*> baked_before;
    if (before != nullptr)
        for (const Instance& instance : before->instances)
            if (!instance.world_positions.empty())
                baked_before[before->meshes[instance.mesh].get()] = &instance;
    const std::vector<char> to_bake = meshes_to_bake(scene);
    for (Instance& instance : scene.instances) {
        if (to_bake[instance.mesh] == 0) continue;
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
void derive_tangents(const Mesh& mesh, Attribute& layer) {
    layer.tangents.resize(layer.size());
    layer.tangent_signs.resize(layer.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 e1 = mesh.positions[b] - mesh.positions[a],
                   e2 = mesh.positions[c] - mesh.positions[a];
        const Vec2 d1 = layer.uv(3 * t + 1) - layer.uv(3 * t),
                   d2 = layer.uv(3 * t + 2) - layer.uv(3 * t);
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
    derive_tangents(derived, derived.attributes[layer]);
    return derived;
}

// The attribute that answers, of the mesh or, counted on from there, of the object; kNone without
// one.
uint32_t find_attribute(const Mesh& mesh, const Instance& instance, const AttributeName& wanted) {
    uint32_t index = 0;
    for (const std::vector<Attribute>* all : {&mesh.attributes, &instance.attributes})
        for (const Attribute& attribute : *all) {
            if (attribute.called.answers(wanted)) return index;
            ++index;
        }
    return kNone;
}

std::string text_of(const AttributeName& attribute) {
    const std::string name = "\"" + attribute.name + "\"";
    switch (attribute.kind) {
        case AttributeKind::uv: return "UV layer " + name;
        case AttributeKind::color: return "colour attribute " + name;
        case AttributeKind::generated: return "Generated coordinates";
        case AttributeKind::pointiness: return "Pointiness";
        case AttributeKind::island: return "Random Per Island";
        case AttributeKind::named:
        case AttributeKind::object:
        case AttributeKind::instancer:
        case AttributeKind::object_info:
        case AttributeKind::particle_info:
        case AttributeKind::view_layer: break;
    }
    return "attribute " + name;
}

}  // namespace

void resolve_attributes(Scene& scene) {
    for (Instance& instance : scene.instances) {
        Shared<Mesh>& mesh = scene.meshes[instance.mesh];
        instance.attribute_indices.resize(instance.materials.size());
        for (size_t slot = 0; slot < instance.materials.size(); ++slot) {
            const Material& material = scene.materials[instance.materials[slot]];
            for (const auto& [wanted, tangents] : attribute_needs(material)) {
                const uint32_t index = find_attribute(mesh, instance, wanted);
                instance.attribute_indices[slot].push_back(index);
                if (index == kNone)
                    scene.report.push_back(fmt::format("{}: no {} for material {}: it is 0",
                                                       instance.name, text_of(wanted),
                                                       material.name));
                else if (tangents && index < mesh->attributes.size() &&
                         mesh->attributes[index].is_uv_layer() &&
                         mesh->attributes[index].tangents.empty())
                    mesh = with_derived_tangents(mesh, index);
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

// A path knows its media by what it has crossed: an instance that some of its rays do not meet
// would leave it in the dark about whether it is inside.
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
    if (scene.camera.is_panoramic()) {
        scene.light_paths_reach_camera = false;
        scene.report.push_back("camera: it is panoramic, so no light tracing");
    }
    for (const Instance& instance : scene.instances) {
        const uint32_t seen = instance.visibility & kVisibleScattered;
        const bool hidden = seen != 0 && seen != kVisibleScattered;
        const bool varies = std::any_of(
            instance.materials.begin(), instance.materials.end(),
            [&](uint32_t material) { return scene.materials[material]->depends_on_ray; });
        if (!hidden && !varies) continue;
        scene.light_paths_reach_camera = false;
        scene.report.push_back(fmt::format(
            "{}: {}, so no light tracing", instance.name,
            hidden ? "hidden from some kinds of rays" : "its look depends on the kind of ray"));
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
