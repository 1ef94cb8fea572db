// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/builder.h"

#include "core/cancellation.h"
#include "core/error.h"
#include "core/limits.h"
#include "scene/clean_mesh.h"
#include "scene/displace.h"

#include <fmt/format.h>

namespace spc {

namespace {

[[noreturn]] void invalid(const std::string& message) {
    throw Error(ErrorKind::invalid_argument, message);
}

bool is_within(const Vec3& value, float most) {
    return std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z)}) <= most &&
           is_finite(value);
}

// `what`: the subject of the message.
void require_within(const Vec3& value, float most, const std::string& owner,
                    const std::string& what) {
    if (!is_finite(value)) invalid(fmt::format("{}: {} is not finite", owner, what));
    if (!is_within(value, most)) invalid(fmt::format("{}: {} exceeds {:g}", owner, what, most));
}

void require_within(float value, float most, const std::string& owner, const std::string& what) {
    require_within(Vec3(value, 0.0f, 0.0f), most, owner, what);
}

// `what`: of each.
void require_all_within(const std::vector<Vec3>& values, float most, const std::string& owner,
                        const char* what) {
    for (size_t i = 0; i < values.size(); ++i)
        if (!is_within(values[i], most))
            require_within(values[i], most, owner, fmt::format("{} {}", what, i));
}

void require_numbers_within(const Attribute& attribute, const std::string& name) {
    const std::string owner = fmt::format("{}: attribute \"{}\"", name, attribute.called.name);
    for (size_t i = 0; i < attribute.values.size(); ++i)
        if (!(std::abs(attribute.values[i]) <= kLargestNumber))
            require_within(Vec3(attribute.values[i]), kLargestNumber, owner,
                           fmt::format("value {}", i / attribute.components));
    require_all_within(attribute.tangents, kLargestNumber, owner, "tangent");
}

Transform checked_inverse(const Transform& transform, const std::string& name) {
    for (const Vec3& row : transform.row) require_within(row, kFarthest, name, "the transform");
    require_within(transform.translation, kFarthest, name, "the transform's translation");
    const Transform inverse = transform.inverse();
    for (const Vec3& row : inverse.row)
        if (!is_within(row, kFarthest))
            invalid(fmt::format("{}: the transform cannot be inverted (a scale of 0?)", name));
    return inverse;
}

// The box around the mesh, as it stands in the world.
void require_bounds_within(const Mesh& mesh, const Transform& to_world, const std::string& name) {
    const std::array<Vec3, 2> ends{mesh.bounds.lower, mesh.bounds.upper};
    for (size_t i = 0; i < 8 && !mesh.bounds.empty(); ++i)
        require_within(to_world.point({ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z}),
                       kFarthest, name, "a coordinate in the world");
}

void check_aperture(const Camera& camera) {
    if (!(std::isfinite(camera.aperture_radius) && camera.aperture_radius >= 0.0f))
        invalid("camera: the aperture's radius must be finite and not negative");
    require_within(camera.aperture_radius, kFarthest, "camera", "the aperture's radius");
    if (camera.aperture_radius == 0.0f) return;
    if (!(std::isfinite(camera.focus_distance) && camera.focus_distance > 0.0f))
        invalid("camera: the focus distance must be finite and positive");
    if (camera.aperture_blades == 1 || camera.aperture_blades == 2)
        invalid("camera: an aperture has no blades, or three or more");
    if (!std::isfinite(camera.aperture_rotation))
        invalid("camera: the aperture's rotation is not finite");
    if (!(std::isfinite(camera.aperture_ratio) && camera.aperture_ratio > 0.0f))
        invalid("camera: the aperture's ratio must be finite and positive");
    require_within(camera.aperture_radius / camera.aperture_ratio, kFarthest, "camera",
                   "the aperture's half width");
}

}  // namespace

SceneBuilder::SceneBuilder() : scene_(std::make_unique<Scene>()) {}

SceneBuilder::SceneBuilder(std::shared_ptr<const Scene> before)
    : before_(std::move(before)), scene_(std::make_unique<Scene>()) {
    scene_->has_trees_to_share = true;
}

const Material& SceneBuilder::material(uint32_t index) const {
    if (index >= scene_->materials.size())
        invalid(fmt::format("material index {} is out of range ({} materials)", index,
                            scene_->materials.size()));
    return scene_->materials[index];
}

const Mesh& SceneBuilder::mesh(uint32_t index) const {
    if (index >= scene_->meshes.size())
        invalid(
            fmt::format("mesh index {} is out of range ({} meshes)", index, scene_->meshes.size()));
    return scene_->meshes[index];
}

uint32_t SceneBuilder::add_image(Image image) {
    scene_->images.push_back(std::move(image));
    return static_cast<uint32_t>(scene_->images.size() - 1);
}

uint32_t SceneBuilder::add_material(const Graph& graph) {
    Material material = compile(graph, scene_->images);
    material.pass_index = graph.pass_index;
    material.crypto = graph.crypto;
    scene_->materials.push_back(std::move(material));
    return static_cast<uint32_t>(scene_->materials.size() - 1);
}

uint32_t SceneBuilder::add_mesh(Mesh mesh) {
    const std::string name = named("mesh", mesh.name);
    require_all_within(mesh.positions, kFarthest, name, "position");
    require_all_within(mesh.normals, kLargestNumber, name, "corner normal");
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const uint32_t index : mesh.triangles[t])
            if (index >= mesh.positions.size())
                invalid(fmt::format("{}: triangle {} names vertex {} of {}", name, t, index,
                                    mesh.positions.size()));
    for (size_t t = 0; t < mesh.slots.size(); ++t)
        if (mesh.slots[t] >= mesh.slot_count)
            invalid(fmt::format("{}: triangle {} names material slot {} of {}", name, t,
                                mesh.slots[t], mesh.slot_count));
    for (const Attribute& attribute : mesh.attributes) require_numbers_within(attribute, name);
    if (mesh.slot_count == 1) mesh.slots.clear();
    drop_degenerate_triangles(mesh);
    normalize_corner_normals(mesh);
    for (const Vec3& p : mesh.positions) mesh.bounds.extend(p);
    mesh.positions.reserve(mesh.positions.size() + 1);  // Embree reads 16 bytes at the last vertex
    scene_->meshes.push_back(std::move(mesh));
    return static_cast<uint32_t>(scene_->meshes.size() - 1);
}

const Scene& SceneBuilder::before() const {
    if (!before_)
        throw Error(ErrorKind::wrong_state, "there is no scene before of which to keep anything");
    return *before_;
}

namespace {

template <class T>
uint32_t keep(const std::vector<T>& before, uint32_t index, std::vector<T>& now, const char* what) {
    if (index >= before.size())
        invalid(fmt::format("{} index {} is out of range ({} in the scene before)", what, index,
                            before.size()));
    now.push_back(before[index]);
    return static_cast<uint32_t>(now.size() - 1);
}

}  // namespace

uint32_t SceneBuilder::keep_image(uint32_t index) {
    return keep(before().images, index, scene_->images, "image");
}

uint32_t SceneBuilder::keep_mesh(uint32_t index) {
    return keep(before().sources, index, scene_->meshes, "mesh");
}

uint32_t SceneBuilder::keep_material(uint32_t index) {
    const uint32_t kept = keep(before().materials, index, scene_->materials, "material");
    const Material& material = scene_->materials[kept];
    for (const uint32_t image : material.images) {
        if (image < scene_->images.size() &&
            scene_->images[image].texels() == before().images[image].texels())
            continue;
        const std::string name = named("material", material.name);
        scene_->materials.pop_back();
        invalid(fmt::format("{}: image {} is another one than before", name, image));
    }
    return kept;
}

uint32_t SceneBuilder::invisible_material() {
    if (invisible_material_ == kNone) {
        Graph graph;
        graph.name = "(nothing)";
        graph.nodes = {{"output", "output", kNone}, {"transparent", "bsdf_transparent", kNone}};
        graph.inputs = {{1, "Color", {1, 1, 1, 1}}};
        graph.links = {{1, "BSDF", 0, "Surface"}};
        invisible_material_ = add_material(graph);
    }
    return invisible_material_;
}

uint32_t SceneBuilder::add_instance(Instance instance) {
    const std::string name = named("object", instance.name);
    if (instance.mesh >= scene_->meshes.size())
        invalid(fmt::format("{}: mesh index {} of {}", name, instance.mesh, scene_->meshes.size()));
    const uint32_t slots = scene_->meshes[instance.mesh]->slot_count;
    if (instance.materials.size() != slots)
        invalid(fmt::format("{}: {} materials for {} slots of its mesh", name,
                            instance.materials.size(), slots));
    for (const uint32_t material : instance.materials)
        if (material != kNone && material >= scene_->materials.size())
            invalid(fmt::format("{}: material index {} of {}", name, material,
                                scene_->materials.size()));
    for (const Attribute& attribute : instance.attributes) require_numbers_within(attribute, name);
    instance.world_to_object = checked_inverse(instance.object_to_world, name);
    require_bounds_within(scene_->meshes[instance.mesh], instance.object_to_world, name);
    instance.mirrored = instance.object_to_world.determinant() < 0.0f;
    for (uint32_t& material : instance.materials)
        if (material == kNone) material = invisible_material();
    scene_->instances.push_back(std::move(instance));
    return static_cast<uint32_t>(scene_->instances.size() - 1);
}

uint32_t SceneBuilder::add_light(LightDesc light) {
    const std::string name = named("light", light.name);
    const auto require = [&](bool holds, const char* what) {
        if (!holds) invalid(fmt::format("{}: {}", name, what));
    };
    checked_inverse(light.to_world, name);
    require(light.material == kNone || light.material < scene_->materials.size(),
            "the material does not exist");
    require(
        is_finite(light.power) && std::min({light.power.x, light.power.y, light.power.z}) >= 0.0f,
        "the power must be finite and not negative");
    require_within(light.power, kLargestNumber, name, "the power");
    require(std::isfinite(light.radius) && light.radius >= 0.0f,
            "the radius must be finite and not negative");
    require_within(light.radius, kFarthest, name, "the radius");
    if (light.type == LightType::spot) {
        require(light.spot_angle > 0.0f && light.spot_angle <= kPi * 1.0001f,
                "the spot angle must lie in (0, pi]");
        require(light.spot_blend >= 0.0f && light.spot_blend <= 1.0f,
                "the spot blend must lie in [0, 1]");
    }
    if (light.type == LightType::sun)
        require(light.sun_angle >= 0.0f && light.sun_angle <= kPi * 1.0001f,
                "the sun's angle must lie in [0, pi]");
    if (light.type == LightType::area) {
        require(std::isfinite(light.size.x) && std::isfinite(light.size.y) && light.size.x > 0.0f &&
                    light.size.y > 0.0f,
                "the size of an area light must be finite and positive");
        require_within(light.half_x(), kFarthest, name, "half the size in x");
        require_within(light.half_y(), kFarthest, name, "half the size in y");
        require(light.spread >= 0.0f && light.spread <= kPi * 1.0001f,
                "the spread must lie in [0, pi]");
    }
    scene_->lights.push_back(std::move(light));
    return static_cast<uint32_t>(scene_->lights.size() - 1);
}

Camera checked_camera(const Camera& camera) {
    Camera checked = camera;
    checked_inverse(camera.to_world, "camera");
    if (camera.width < 1 || camera.height < 1) invalid("camera: the image has no pixels");
    const auto& [x0, y0, width, height] = camera.crop;
    if (width < 1 || height < 1 || x0 >= camera.width || y0 >= camera.height ||
        width > camera.width - x0 || height > camera.height - y0)
        invalid("camera: the crop is empty or leaves the frame");
    const auto& [left, right, bottom, top] = camera.viewplane;
    if (!std::isfinite(left) || !std::isfinite(right) || !std::isfinite(bottom) ||
        !std::isfinite(top) || left == right || bottom == top)
        invalid("camera: the viewplane is empty or not finite");
    for (const float edge : camera.viewplane)
        require_within(edge, kFarthest, "camera", "the viewplane");
    if (!(camera.clip_near >= 0.0f && camera.clip_near < camera.clip_far))
        invalid("camera: clipping needs 0 <= near < far");
    for (const float number : camera.panorama)
        require_within(number, kLargestNumber, "camera", "a number of the panorama");
    if (camera.projection == Projection::fisheye_equisolid && !(camera.panorama[1] > 0.0f))
        invalid("camera: the fisheye's focal length must be positive");
    require_within(camera.clip_near, kFarthest, "camera", "the near clip");
    check_aperture(camera);
    // Scale would otherwise change depths.
    const Vec3 z = normalize(camera.to_world.column(2));
    const Vec3 x = normalize(camera.to_world.column(0) - z * dot(z, camera.to_world.column(0)));
    Vec3 y = cross(z, x);
    if (dot(y, camera.to_world.column(1)) < 0.0f) y = y * -1.0f;
    for (int i = 0; i < 3; ++i)
        checked.to_world.row[static_cast<size_t>(i)] = Vec3(x[i], y[i], z[i]);
    return checked;
}

void SceneBuilder::set_camera(const Camera& camera) {
    scene_->camera = checked_camera(camera);
    has_camera_ = true;
}

void SceneBuilder::set_environment(const Environment& environment) {
    if (environment.material >= scene_->materials.size())
        invalid(fmt::format("world: material index {} of {}", environment.material,
                            scene_->materials.size()));
    if (!material(environment.material).is_background)
        invalid(fmt::format("world: {} has no background as its surface",
                            named("material", material(environment.material).name)));
    scene_->environment = environment;
}

void SceneBuilder::require_complete() const {
    if (!has_camera_) throw Error(ErrorKind::wrong_state, "the scene has no camera");
}

std::unique_ptr<Scene> SceneBuilder::freeze(uint32_t threads) {
    require_complete();
    if (scene_->has_trees_to_share) scene_->sources = scene_->meshes;
    for (const Material& material : scene_->materials)
        for (const std::string& warning : material.warnings) scene_->report.push_back(warning);
    report_images(*scene_);
    resolve_attributes(*scene_);
    displace(*scene_, threads);
    note_materials(*scene_);
    find_media(*scene_);
    assign_caustics_roles(*scene_);
    check_light_tracing(*scene_);
    center_on_casters(*scene_);
    scene_->view = view_space(scene_->camera, scene_->origin);
    bake_positions(*scene_, before_.get());
    Cancellable::check();
    bound_scene(*scene_);
    scene_->accel =
        std::make_unique<Accel>(*scene_, threads, before_ ? before_->accel.get() : nullptr);
    for (uint32_t i = 0; i < scene_->instances.size(); ++i) {
        const Instance& instance = scene_->instances[i];
        if (instance.turns_light() || instance.has_subsurface || instance.is_shadow_linked())
            scene_->accel->prepare_alone(*scene_, i);
    }
    return std::move(scene_);
}

}  // namespace spc
