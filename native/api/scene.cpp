// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/gate.h"
#include "api/handles.h"
#include "core/limits.h"

#include <fmt/format.h>

namespace spc::api {

SceneBuilder& builder_of(spc_scene* scene) {
    require(scene != nullptr, "scene is null");
    if (scene->commit.valid()) throw Error(ErrorKind::wrong_state, "the scene is being built");
    if (!scene->builder)
        throw Error(ErrorKind::wrong_state, "the scene is committed already, or its commit failed");
    return *scene->builder;
}

const RenderScene& world_of(const spc_scene* scene) {
    require(scene != nullptr, "scene is null");
    if (!scene->world) throw Error(ErrorKind::wrong_state, "the scene is not committed");
    return *scene->world;
}

namespace {

// Copies `count` elements; a null pointer is only right for none.
template <class T, class Raw>
std::vector<T> copied(const Raw* data, size_t count, const std::string& owner, const char* what) {
    static_assert(sizeof(T) % sizeof(Raw) == 0);
    require(data != nullptr || count == 0, fmt::format("{}: {} is null", owner, what));
    std::vector<T> values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), data, count * sizeof(T));
    return values;
}

std::string owner_of(const char* kind, const char* name) {
    return named(kind, name_or(name, kind));
}

std::string text(const char* value, const std::string& owner, const char* what) {
    require(value != nullptr, fmt::format("{}: {} is null", owner, what));
    return value;
}

Transform transform_of(const float (&rows)[12], const std::string& owner) {
    for (const float value : rows)
        require(std::isfinite(value), owner + ": the transform is not finite");
    return Transform::from_rows(rows);
}

void check_visibility(uint32_t visibility, const std::string& owner) {
    require((visibility & ~static_cast<uint32_t>(SPC_VISIBLE_ALL)) == 0,
            owner + ": unknown visibility bits");
}

Image to_image(const spc_image_desc& desc) {
    const std::string name = name_or(desc.name, "image"), owner = named("image", name);
    const auto space =
        checked_enum<ColorSpace>(desc.color_space, SPC_COLOR_DATA, owner, "colour space");
    const auto alpha =
        checked_enum<AlphaMode>(desc.alpha_mode, SPC_ALPHA_PACKED, owner, "alpha mode");
    const int sources =
        (desc.pixels != nullptr) + (desc.encoded != nullptr) + (desc.path != nullptr);
    require(sources == 1, owner + ": an image has exactly one of pixels, encoded and path");
    if (desc.path != nullptr) return image_from_file(name, desc.path, space, alpha);
    if (desc.encoded != nullptr) {
        require(desc.encoded_size > 0, owner + ": the encoded image is empty");
        return image_from_memory(
            name, {static_cast<const uint8_t*>(desc.encoded), desc.encoded_size}, space, alpha);
    }
    require(desc.width > 0 && desc.height > 0, owner + ": the image has no pixels");
    require(desc.channels == 1 || desc.channels == 3 || desc.channels == 4,
            owner + ": an image has 1, 3 or 4 channels");
    const size_t count = static_cast<size_t>(desc.width) * desc.height * desc.channels;
    require(desc.pixel_type <= SPC_PIXEL_F32, owner + ": unknown pixel type");
    if (desc.pixel_type == SPC_PIXEL_U8)
        return image_from_bytes(name, {static_cast<const uint8_t*>(desc.pixels), count}, desc.width,
                                desc.height, desc.channels, space, alpha);
    return image_from_floats(name, {static_cast<const float*>(desc.pixels), count}, desc.width,
                             desc.height, desc.channels, space, alpha);
}

Graph to_graph(const spc_material_desc& desc) {
    Graph graph;
    graph.name = name_or(desc.name, "material");
    graph.pass_index = desc.pass_index;
    graph.crypto = desc.crypto;
    const std::string owner = named("material", graph.name);
    graph.displacement = checked_enum<DisplacementMode>(desc.displacement, SPC_DISPLACEMENT_BOTH,
                                                        owner, "choice of displacement");
    graph.glints = checked_enum<GlintsMode>(desc.glints, SPC_GLINTS_OFF, owner, "choice of glints");
    graph.bump_correction = checked_enum<BumpCorrection>(
        desc.bump_correction, SPC_BUMP_CORRECTION_MICROFACET, owner, "bump correction");
    require(desc.nodes != nullptr && desc.node_count > 0, owner + ": the material has no nodes");
    require(desc.inputs != nullptr || desc.input_count == 0, owner + ": inputs is null");
    require(desc.options != nullptr || desc.option_count == 0, owner + ": options is null");
    require(desc.arrays != nullptr || desc.array_count == 0, owner + ": arrays is null");
    require(desc.links != nullptr || desc.link_count == 0, owner + ": links is null");
    const auto check_node = [&](uint32_t node, const char* what) {
        require(node < desc.node_count,
                fmt::format("{}: {} names node {} of {}", owner, what, node, desc.node_count));
    };
    for (uint32_t i = 0; i < desc.node_count; ++i) {
        const spc_node& node = desc.nodes[i];
        std::string kind = text(node.kind, owner, "the kind of a node");
        graph.nodes.push_back({name_or(node.name, kind.c_str()), kind, node.image});
    }
    const auto check_number = [&](float value, uint32_t node, const char* what) {
        require(std::isfinite(value),
                fmt::format("{}: {}: {} is not finite", owner, graph.nodes[node].name, what));
        require(std::abs(value) <= kLargestNumber,
                fmt::format("{}: {}: {} exceeds {:g}", owner, graph.nodes[node].name, what,
                            kLargestNumber));
    };
    for (uint32_t i = 0; i < desc.input_count; ++i) {
        const spc_node_input& input = desc.inputs[i];
        check_node(input.node, "an input");
        for (const float value : input.value) check_number(value, input.node, "a socket's value");
        graph.inputs.push_back({input.node,
                                text(input.socket, owner, "a socket"),
                                {input.value[0], input.value[1], input.value[2], input.value[3]}});
    }
    for (uint32_t i = 0; i < desc.option_count; ++i) {
        const spc_node_option& option = desc.options[i];
        check_node(option.node, "an option");
        graph.options.push_back({option.node, text(option.option, owner, "an option"),
                                 text(option.value, owner, "an option's value")});
    }
    for (uint32_t i = 0; i < desc.array_count; ++i) {
        const spc_node_array& array = desc.arrays[i];
        check_node(array.node, "an array");
        const std::string name = text(array.name, owner, "an array");
        require(
            array.values != nullptr || array.count == 0,
            fmt::format("{}: {}: the array {} is null", owner, graph.nodes[array.node].name, name));
        for (uint32_t k = 0; k < array.count; ++k)
            check_number(array.values[k], array.node, "a number of an array");
        graph.arrays.push_back({array.node, name, {array.values, array.values + array.count}});
    }
    for (uint32_t i = 0; i < desc.link_count; ++i) {
        const spc_node_link& link = desc.links[i];
        check_node(link.from_node, "a link");
        check_node(link.to_node, "a link");
        graph.links.push_back({link.from_node, text(link.from_socket, owner, "a socket"),
                               link.to_node, text(link.to_socket, owner, "a socket")});
    }
    return graph;
}

// `elements`: of the domains of spc_attribute_domain; 0: the owner has none of that domain.
Attribute to_attribute(const spc_attribute& desc, const std::array<size_t, 4>& elements,
                       const std::string& owner) {
    Attribute attribute;
    attribute.called.name = name_or(desc.name, "");
    const std::string who = fmt::format("{}: attribute \"{}\"", owner, attribute.called.name);
    attribute.called.kind =
        checked_enum<AttributeKind>(desc.kind, SPC_ATTRIBUTE_VIEW_LAYER, who, "kind of attribute");
    attribute.domain = checked_enum<AttributeDomain>(desc.domain, SPC_DOMAIN_OBJECT, who, "domain");
    require(is_of_object(attribute.called.kind) == (attribute.domain == AttributeDomain::object),
            who + ": kind and domain do not belong together");
    const size_t count = elements[desc.domain];
    require(count > 0, who + ": the domain is not one of its owner");
    require(desc.components >= 1 && desc.components <= 4, who + ": has 1 to 4 components");
    attribute.components = desc.components;
    attribute.values = copied<float>(desc.values, count * desc.components, who, "values");
    if (desc.tangents == nullptr) return attribute;
    require(attribute.is_uv_layer(), who + ": only UV layers have tangents");
    attribute.tangents.resize(count);
    attribute.tangent_signs.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const float* t = desc.tangents + 4 * i;
        require(std::isfinite(t[3]), fmt::format("{}: tangent sign {} is not finite", who, i));
        attribute.tangents[i] = {t[0], t[1], t[2]};
        attribute.tangent_signs[i] = t[3] < 0.0f ? -1.0f : 1.0f;
    }
    return attribute;
}

std::vector<Attribute> to_attributes(const spc_attribute* descs, uint32_t count,
                                     const std::array<size_t, 4>& elements,
                                     const std::string& owner) {
    require(descs != nullptr || count == 0, owner + ": attributes is null");
    std::vector<Attribute> attributes;
    for (uint32_t i = 0; i < count; ++i)
        attributes.push_back(to_attribute(descs[i], elements, owner));
    return attributes;
}

Mesh to_mesh(const spc_mesh_desc& desc) {
    Mesh mesh;
    mesh.name = name_or(desc.name, "mesh");
    const std::string owner = named("mesh", mesh.name);
    require(desc.vertex_count > 0 && desc.triangle_count > 0, owner + ": the mesh is empty");
    require(desc.slot_count > 0, owner + ": a mesh has at least one material slot");
    const size_t triangles = desc.triangle_count;
    mesh.positions = copied<Vec3>(desc.positions, desc.vertex_count, owner, "positions");
    mesh.triangles = copied<std::array<uint32_t, 3>>(desc.triangles, triangles, owner, "triangles");
    if (desc.normals != nullptr)
        mesh.normals = copied<Vec3>(desc.normals, 3 * triangles, owner, "normals");
    mesh.shaded_smooth = desc.normals != nullptr;
    if (desc.flat_faces != nullptr)
        mesh.flat_faces = copied<uint32_t>(desc.flat_faces, triangles, owner, "flat_faces");
    if (desc.material_slots != nullptr)
        mesh.slots = copied<uint32_t>(desc.material_slots, triangles, owner, "material_slots");
    mesh.slot_count = desc.slot_count;
    mesh.attributes = to_attributes(desc.attributes, desc.attribute_count,
                                    {3 * triangles, desc.vertex_count, triangles, 0}, owner);
    return mesh;
}

Instance to_instance(const spc_instance_desc& desc) {
    Instance instance;
    instance.name = name_or(desc.name, "object");
    const std::string owner = named("object", instance.name);
    instance.mesh = desc.mesh;
    instance.object_to_world = transform_of(desc.transform, owner);
    instance.materials = copied<uint32_t>(desc.materials, desc.material_count, owner, "materials");
    check_visibility(desc.visibility, owner);
    instance.visibility = desc.visibility;
    instance.pass_index = desc.pass_index;
    instance.crypto_object = desc.crypto_object;
    instance.crypto_asset = desc.crypto_asset;
    instance.light_group = name_or(desc.light_group, "");
    instance.role =
        checked_enum<CausticsRole>(desc.caustics_role, SPC_CAUSTICS_BOTH, owner, "caustics role");
    instance.holdout = desc.holdout != 0;
    instance.attributes = to_attributes(desc.attributes, desc.attribute_count, {0, 0, 0, 1}, owner);
    require(desc.terminator_offset >= 0.0f && desc.terminator_offset <= 1.0f,
            owner + ": terminator_offset is not within 0 and 1");
    instance.terminator_stretch = 1.0f / (1.0f - 0.5f * desc.terminator_offset);
    instance.links = {desc.receiver_sets, desc.blocker_sets};
    instance.sets = {desc.receives_in, desc.blocks_in};
    return instance;
}

LightDesc to_light(const spc_light_desc& desc) {
    LightDesc light;
    light.name = name_or(desc.name, "light");
    const std::string owner = named("light", light.name);
    light.type = checked_enum<LightType>(desc.type, SPC_LIGHT_AREA, owner, "light type");
    light.to_world = transform_of(desc.transform, owner);
    light.power = Spectrum(desc.power[0], desc.power[1], desc.power[2]);
    const bool has_radius = light.type == LightType::point || light.type == LightType::spot;
    light.radius = has_radius ? desc.radius : 0.0f;
    light.soft_falloff = desc.soft_falloff != 0;
    light.spot_angle = desc.spot_angle;
    light.spot_blend = desc.spot_blend;
    light.sun_angle = desc.sun_angle;
    light.shape = checked_enum<AreaShape>(desc.shape, SPC_AREA_ELLIPSE, owner, "shape");
    light.size = Vec2(desc.size[0], desc.size[1]);
    light.spread = desc.spread;
    check_visibility(desc.visibility, owner);
    light.visibility = desc.visibility;
    light.feeds_caustics = desc.feeds_caustics != 0;
    light.light_group = name_or(desc.light_group, "");
    light.material = desc.material;
    light.links = {desc.receiver_sets, desc.blocker_sets};
    light.max_bounces = desc.max_bounces;
    return light;
}

Camera to_camera(const spc_camera_desc& desc) {
    Camera camera;
    camera.projection = checked_enum<Projection>(
        desc.projection, SPC_PROJECTION_CENTRAL_CYLINDRICAL, "camera", "projection");
    camera.to_world = transform_of(desc.transform, "camera");
    camera.width = desc.width;
    camera.height = desc.height;
    std::copy(std::begin(desc.crop), std::end(desc.crop), camera.crop.begin());
    std::copy(std::begin(desc.viewplane), std::end(desc.viewplane), camera.viewplane.begin());
    std::copy(std::begin(desc.panorama), std::end(desc.panorama), camera.panorama.begin());
    camera.clip_near = desc.clip_near;
    camera.clip_far = desc.clip_far;
    camera.aperture_radius = desc.aperture_radius;
    camera.focus_distance = desc.focus_distance;
    camera.aperture_blades = desc.aperture_blades;
    camera.aperture_rotation = desc.aperture_rotation;
    camera.aperture_ratio = desc.aperture_ratio;
    return camera;
}

spc_caustics_search search_for(const CausticsPart& part) {
    if (!part.casts()) return SPC_SEARCH_NONE;
    if (part.caster || part.chains_turn) return SPC_SEARCH_MANIFOLD;
    return part.chains_may_turn ? SPC_SEARCH_MANIFOLD_IF_COARSE : SPC_SEARCH_LIGHT_PATHS;
}

// The texts stay with the scene. Of several materials with glints the first stands for all.
void fill_forecast(spc_scene& scene, std::span<const Material* const> materials,
                   spc_forecast& forecast) {
    scene.glints.clear();
    scene.no_glints.clear();
    for (const Material* material : materials) {
        if (scene.glints.empty() && material->may_glint()) scene.glints = material->slopes.why;
        if (scene.no_glints.empty()) scene.no_glints = material->slopes.why_not;
    }
    const CausticsPart& part = scene.part;
    const std::string& reason = part.caster         ? part.why
                                : part.rough_caster ? part.why_rough
                                                    : part.why_not;
    forecast = {sizeof(forecast), part.receiver ? 1u : 0u, search_for(part),
                reason.c_str(),   scene.glints.c_str(),    scene.no_glints.c_str()};
}

}  // namespace
}  // namespace spc::api

using namespace spc::api;

spc_status spc_scene_create(spc_scene** scene) {
    return gate("spc_scene_create", [&] {
        spc_scene*& out =
            checked_output(scene, "scene");  // first: an assignment evaluates its right side before
        out = new spc_scene;
    });
}

spc_status spc_scene_edit(const spc_scene* before, spc_scene** scene) {
    return gate("spc_scene_edit", [&] {
        spc_scene*& out = checked_output(scene, "scene");
        std::shared_ptr<const spc::RenderScene> world;
        if (before != nullptr) {
            require(world_of(before).scene->has_trees_to_share,
                    "the scene before was not made to be edited");
            world = before->world;
        }
        auto made = std::make_unique<spc_scene>();
        made->builder = std::make_unique<spc::SceneBuilder>(
            world ? std::shared_ptr<const spc::Scene>(world, world->scene.get()) : nullptr);
        made->before = std::move(world);
        out = made.release();
    });
}

namespace {

// One of the builder's ways to keep something of the scene before.
spc_status keep(const char* function, spc_scene* scene, uint32_t before, uint32_t* index,
                uint32_t (spc::SceneBuilder::*how)(uint32_t)) {
    return gate(function, [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& out = checked_output(index, "index");
        out = (builder.*how)(before);
    });
}

}  // namespace

spc_status spc_scene_keep_image(spc_scene* scene, uint32_t before, uint32_t* image_index) {
    return keep("spc_scene_keep_image", scene, before, image_index, &spc::SceneBuilder::keep_image);
}

spc_status spc_scene_keep_material(spc_scene* scene, uint32_t before, uint32_t* material_index) {
    return keep("spc_scene_keep_material", scene, before, material_index,
                &spc::SceneBuilder::keep_material);
}

spc_status spc_scene_keep_mesh(spc_scene* scene, uint32_t before, uint32_t* mesh_index) {
    return keep("spc_scene_keep_mesh", scene, before, mesh_index, &spc::SceneBuilder::keep_mesh);
}

void spc_scene_destroy(spc_scene* scene) { delete scene; }

spc_status spc_scene_add_image(spc_scene* scene, const spc_image_desc* desc, uint32_t* image_index) {
    return gate("spc_scene_add_image", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& index = checked_output(image_index, "image_index");
        const spc_image_desc& d = checked(desc, "desc");
        index = spc::with_memory_for(owner_of("image", d.name),
                                     [&] { return builder.add_image(to_image(d)); });
    });
}

spc_status spc_scene_add_material(spc_scene* scene, const spc_material_desc* desc,
                                  uint32_t* material_index) {
    return gate("spc_scene_add_material", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& index = checked_output(material_index, "material_index");
        const spc_material_desc& d = checked(desc, "desc");
        index = spc::with_memory_for(owner_of("material", d.name),
                                     [&] { return builder.add_material(to_graph(d)); });
    });
}

spc_status spc_scene_material_needs(spc_scene* scene, uint32_t material_index,
                                    spc_material_needs* needs) {
    return gate("spc_scene_material_needs", [&] {
        const spc::SceneBuilder& builder = builder_of(scene);
        checked(needs, "needs");
        scene->needs = spc::attribute_needs(builder.material(material_index));
        scene->needed_attributes.clear();
        for (const auto& [attribute, tangents] : scene->needs)
            scene->needed_attributes.push_back(
                {attribute.name.c_str(), static_cast<uint32_t>(attribute.kind), tangents ? 1u : 0u});
        needs->attributes = scene->needed_attributes.data();
        needs->attribute_count = static_cast<uint32_t>(scene->needed_attributes.size());
    });
}

spc_status spc_scene_material_emission(spc_scene* scene, uint32_t material_index, float* mean,
                                       uint32_t* varies) {
    return gate("spc_scene_material_emission", [&] {
        const spc::Material& material = builder_of(scene).material(material_index);
        require(mean != nullptr && varies != nullptr, "mean or varies is null");
        for (int i = 0; i < 3; ++i) mean[i] = material.mean_emission[i];
        *varies = material.constant_emission ? 0 : 1;
    });
}

spc_status spc_scene_forecast(spc_scene* scene, const uint32_t* materials, uint32_t material_count,
                              uint32_t visibility, uint32_t caustics_role, spc_forecast* forecast) {
    return gate("spc_scene_forecast", [&] {
        const spc::SceneBuilder& builder = builder_of(scene);
        checked(forecast, "forecast");
        require(materials != nullptr && material_count > 0, "forecast: there are no materials");
        check_visibility(visibility, "forecast");
        const auto role = checked_enum<spc::CausticsRole>(caustics_role, SPC_CAUSTICS_BOTH,
                                                          "forecast", "caustics role");
        std::vector<const spc::Material*> slots;
        for (uint32_t i = 0; i < material_count; ++i)
            slots.push_back(&builder.material(materials[i]));
        scene->part = spc::caustics_part(slots, role, visibility);
        fill_forecast(*scene, slots, *forecast);
    });
}

const char* spc_node_kinds(void) { return spc::node_kinds_text(); }

spc_status spc_scene_add_mesh(spc_scene* scene, const spc_mesh_desc* desc, uint32_t* mesh_index) {
    return gate("spc_scene_add_mesh", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& index = checked_output(mesh_index, "mesh_index");
        const spc_mesh_desc& d = checked(desc, "desc");
        index = spc::with_memory_for(owner_of("mesh", d.name),
                                     [&] { return builder.add_mesh(to_mesh(d)); });
    });
}

spc_status spc_scene_add_instance(spc_scene* scene, const spc_instance_desc* desc,
                                  uint32_t* instance_index) {
    return gate("spc_scene_add_instance", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& index = checked_output(instance_index, "instance_index");
        const spc_instance_desc& d = checked(desc, "desc");
        index = spc::with_memory_for(owner_of("object", d.name),
                                     [&] { return builder.add_instance(to_instance(d)); });
    });
}

spc_status spc_scene_add_light(spc_scene* scene, const spc_light_desc* desc, uint32_t* light_index) {
    return gate("spc_scene_add_light", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        uint32_t& index = checked_output(light_index, "light_index");
        const spc_light_desc& d = checked(desc, "desc");
        index = spc::with_memory_for(owner_of("light", d.name),
                                     [&] { return builder.add_light(to_light(d)); });
    });
}

spc_status spc_scene_set_camera(spc_scene* scene, const spc_camera_desc* desc) {
    return gate("spc_scene_set_camera", [&] {
        require(scene != nullptr, "scene is null");
        const spc::Camera camera = to_camera(checked(desc, "desc"));
        if (!scene->world) {
            builder_of(scene).set_camera(camera);
            return;
        }
        const spc::Camera moved = spc::checked_camera(camera);
        const std::lock_guard lock(scene->renders_mutex);
        if (scene->renders > 0)
            throw spc::Error(spc::ErrorKind::wrong_state,
                             "the scene is being rendered: its camera is fixed");
        scene->world->scene->move_camera(moved);
    });
}

spc_status spc_scene_set_environment(spc_scene* scene, const spc_environment_desc* desc) {
    return gate("spc_scene_set_environment", [&] {
        spc::SceneBuilder& builder = builder_of(scene);
        const spc_environment_desc& d = checked(desc, "desc");
        check_visibility(d.visibility, "world");
        builder.set_environment(
            {d.material, d.visibility, d.feeds_caustics != 0, name_or(d.light_group, "")});
    });
}
