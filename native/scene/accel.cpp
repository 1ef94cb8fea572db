// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/accel.h"

#include "core/cancellation.h"
#include "core/error.h"
#include "core/limits.h"
#include "scene/scene.h"

#if __has_include(<embree3/rtcore.h>)
#include <embree3/rtcore.h>
#define SPC_EMBREE 3
#else
#include <embree4/rtcore.h>
#define SPC_EMBREE 4
#endif

#include <atomic>
#include <unordered_map>

#include <fmt/format.h>

namespace spc {

namespace {

// The two calls that differ between Embree's versions.
void intersect1(RTCScene scene, RTCRayHit& ray_hit) {
#if SPC_EMBREE == 3
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray_hit);
#else
    rtcIntersect1(scene, &ray_hit, nullptr);
#endif
}
void occluded1(RTCScene scene, RTCRay& ray) {
#if SPC_EMBREE == 3
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
#else
    rtcOccluded1(scene, &ray, nullptr);
#endif
}

// Embree takes no other ray, and ends the program where it checks them, as Debian's does. What rays
// start on lies within kFarthest; in a mesh's own space they stay within what Embree can square.
bool can_be_cast(const Ray& ray) {
    constexpr float kFarthestStart = 100.0f * kFarthest;
    const Vec3 &o = ray.origin, &d = ray.direction;
    const float extent = std::abs(o.x) + std::abs(o.y) + std::abs(o.z) + std::abs(d.x) +
                         std::abs(d.y) + std::abs(d.z);
    return extent <= kFarthestStart && ray.t_near >= 0.0f && !std::isnan(ray.t_far);
}

RTCRay to_embree(const Ray& ray, uint32_t mask) {
    RTCRay r;
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.tnear = ray.t_near;
    r.tfar = ray.t_far;
    r.time = 0.0f;
    r.mask = mask;
    r.id = 0;
    r.flags = 0;
    return r;
}

RTCRayHit to_embree_hit(const Ray& ray, uint32_t mask) {
    RTCRayHit ray_hit;
    ray_hit.ray = to_embree(ray, mask);
    ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return ray_hit;
}

// Lamps are user geometry of one primitive each; the user data is the lamp.
void light_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& light = *static_cast<const LightDesc*>(args->geometryUserPtr);
    Vec3 half(light.radius);
    if (light.type == LightType::area)
        for (int i = 0; i < 3; ++i)
            half[i] = std::abs(light.half_x()[i]) + std::abs(light.half_y()[i]);
    const Vec3 lower = light.position() - half, upper = light.position() + half;
    *args->bounds_o = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
}

void light_intersect(const RTCIntersectFunctionNArguments* args) {
    SPC_ASSERT(args->N == 1);
    if (args->valid[0] == 0) return;
    auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    RTCRay& r = ray_hit.ray;
    const Ray ray{{r.org_x, r.org_y, r.org_z}, {r.dir_x, r.dir_y, r.dir_z}, r.tnear, r.tfar};
    const std::optional<LightSurfaceHit> hit =
        intersect_light(*static_cast<const LightDesc*>(args->geometryUserPtr), ray);
    if (!hit) return;
    r.tfar = hit->t;
    ray_hit.hit.geomID = args->geomID;
    ray_hit.hit.primID = args->primID;
    ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    ray_hit.hit.u = ray_hit.hit.v = 0.0f;
}

void light_occluded(const RTCOccludedFunctionNArguments*) {}  // lamps cast no shadows

// Embree's device, which outlives all that it has made.
struct Device {
    RTCDevice handle;

    explicit Device(uint32_t threads) {
        const std::string config = threads == 0 ? std::string() : fmt::format("threads={}", threads);
        handle = rtcNewDevice(config.c_str());
        if (handle != nullptr) return;
        const RTCError code = rtcGetDeviceError(nullptr);
        if (code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        throw std::runtime_error(
            fmt::format("Embree could not start (error {})", static_cast<int>(code)));
    }
    ~Device() { rtcReleaseDevice(handle); }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    // Builds the scene's tree. Throws Cancelled.
    static void commit(RTCScene s) {
        const std::atomic<bool>* const wish = Cancellable::wish();
        if (wish != nullptr) {
            const auto goes_on = [](void* cancelled, double) {
                return !static_cast<const std::atomic<bool>*>(cancelled)->load();
            };
            rtcSetSceneProgressMonitorFunction(s, goes_on, const_cast<std::atomic<bool>*>(wish));
        }
        rtcCommitScene(s);
        rtcSetSceneProgressMonitorFunction(s, nullptr, nullptr);
        Cancellable::check();
    }

    RTCScene new_scene() const {
        RTCScene s = rtcNewScene(handle);
        rtcSetSceneFlags(s, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_MEDIUM);
        return s;
    }

    // Of vertices that neither move nor end before the geometry.
    RTCGeometry triangles(const Vec3* positions, const Mesh& mesh, uint32_t mask) const {
        RTCGeometry geometry = rtcNewGeometry(handle, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   positions, 0, sizeof(Vec3), mesh.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(mesh.triangles[0]),
                                   mesh.triangles.size());
        rtcSetGeometryMask(geometry, mask);
        rtcCommitGeometry(geometry);
        return geometry;
    }
};

// A tree over one mesh, in its own space or, if `world_positions` are not empty, in the world's. It
// has its share in what it refers to.
struct MeshTree {
    std::shared_ptr<const Device> device;
    Shared<Mesh> mesh;
    SharedArray<Vec3> world_positions;
    RTCScene scene;

    MeshTree(std::shared_ptr<const Device> device_, const Shared<Mesh>& mesh_,
             const SharedArray<Vec3>& world_positions_)
        : device(std::move(device_)),
          mesh(mesh_),
          world_positions(world_positions_),
          scene(device->new_scene()) {
        RTCGeometry geometry = device->triangles(vertices(), mesh, kVisibleAll);
        rtcAttachGeometryByID(scene, geometry, 0);
        rtcReleaseGeometry(geometry);
    }
    ~MeshTree() { rtcReleaseScene(scene); }
    MeshTree(const MeshTree&) = delete;
    MeshTree& operator=(const MeshTree&) = delete;

    const Vec3* vertices() const {
        return world_positions.empty() ? mesh->positions.data() : world_positions.data();
    }
};

}  // namespace

struct Accel::Impl {
    std::shared_ptr<const Device> device;
    RTCScene scene = nullptr;
    std::unordered_map<const Vec3*, std::shared_ptr<const MeshTree>> trees;  // by their vertices
    std::vector<const MeshTree*> tree_of;  // per instance, null for those in the scene's own tree
    std::vector<RTCGeometry> baked;        // per instance, in the scene's own tree, else null
    std::vector<RTCScene> caster_scenes;   // per instance, null unless prepared
    std::vector<const Instance*> instances;
    uint32_t instance_count = 0;
    std::atomic<uint64_t> lost_rays{0};

    ~Impl() {
        for (RTCGeometry geometry : baked)
            if (geometry != nullptr) rtcReleaseGeometry(geometry);
        for (RTCScene s : caster_scenes)
            if (s != nullptr) rtcReleaseScene(s);
        if (scene != nullptr) rtcReleaseScene(scene);
    }

    bool casts(const Ray& ray) {
        if (can_be_cast(ray)) return true;
        lost_rays.fetch_add(1, std::memory_order_relaxed);
        return false;
    }

    // Embree reports errors through the device: out of memory is the one that input can cause.
    void check(const char* step) const {
        const RTCError code = rtcGetDeviceError(device->handle);
        if (code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        if (code != RTC_ERROR_NONE)
            throw std::runtime_error(
                fmt::format("Embree error {} in {}", static_cast<int>(code), step));
    }

    // The tree over the mesh of an instance, in the space that it is baked into.
    const MeshTree& tree_for(const Scene& source, const Instance& instance, const Impl* before) {
        const Shared<Mesh>& mesh = source.meshes[instance.mesh];
        const Vec3* vertices = instance.world_positions.empty() ? mesh->positions.data()
                                                                : instance.world_positions.data();
        std::shared_ptr<const MeshTree>& tree = trees[vertices];
        if (!tree && before != nullptr) {
            const auto known = before->trees.find(vertices);
            if (known != before->trees.end()) tree = known->second;
        }
        if (!tree) {
            tree = std::make_shared<const MeshTree>(device, mesh, instance.world_positions);
            Device::commit(tree->scene);
        }
        return *tree;
    }

    void add_instance(const Scene& source, uint32_t index, const Impl* before) {
        const Instance& instance = source.instances[index];
        const bool is_baked = !instance.world_positions.empty();
        if (is_baked && !source.has_trees_to_share) {
            baked[index] = device->triangles(instance.world_positions.data(),
                                             source.meshes[instance.mesh], instance.visibility);
            rtcAttachGeometryByID(scene, baked[index], index);
            return;
        }
        tree_of[index] = &tree_for(source, instance, before);
        RTCGeometry geometry = rtcNewGeometry(device->handle, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, tree_of[index]->scene);
        const Transform m = is_baked ? Transform() : instance.object_to_world;
        const float rows[12] = {m.row[0].x, m.row[0].y, m.row[0].z, m.translation.x,
                                m.row[1].x, m.row[1].y, m.row[1].z, m.translation.y,
                                m.row[2].x, m.row[2].y, m.row[2].z, m.translation.z};
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
        rtcSetGeometryMask(geometry, instance.visibility);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, index);
        rtcReleaseGeometry(geometry);
    }

    void add_light(const LightDesc& light, uint32_t id) {
        RTCGeometry geometry = rtcNewGeometry(device->handle, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, 1);
        rtcSetGeometryUserData(geometry, const_cast<LightDesc*>(&light));
        rtcSetGeometryBoundsFunction(geometry, light_bounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, light_intersect);
        rtcSetGeometryOccludedFunction(geometry, light_occluded);
        rtcSetGeometryMask(geometry, light.visibility & ~static_cast<uint32_t>(kVisibleShadow));
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, id);
        rtcReleaseGeometry(geometry);
    }
};

Accel::Accel(const Scene& scene, uint32_t threads, const Accel* before)
    : impl_(std::make_unique<Impl>()) {
    const Impl* impl_before = before != nullptr ? before->impl_.get() : nullptr;
    impl_->device =
        impl_before != nullptr ? impl_before->device : std::make_shared<const Device>(threads);
    impl_->instance_count = static_cast<uint32_t>(scene.instances.size());
    impl_->tree_of.resize(scene.instances.size(), nullptr);
    impl_->baked.resize(scene.instances.size(), nullptr);
    impl_->caster_scenes.resize(scene.instances.size(), nullptr);
    for (const Instance& instance : scene.instances) impl_->instances.push_back(&instance);
    impl_->scene = impl_->device->new_scene();
    for (uint32_t i = 0; i < impl_->instance_count; ++i) impl_->add_instance(scene, i, impl_before);
    for (uint32_t i = 0; i < scene.lights.size(); ++i)
        if (scene.lights[i].has_surface())
            impl_->add_light(scene.lights[i], impl_->instance_count + i);
    Device::commit(impl_->scene);
    impl_->check("building the scene's tree");
}

Accel::~Accel() = default;

std::optional<Hit> Accel::intersect(const Ray& ray, uint32_t kind) const {
    if (!impl_->casts(ray)) return std::nullopt;
    RTCRayHit ray_hit = to_embree_hit(ray, kind);
    intersect1(impl_->scene, ray_hit);
    if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const RTCHit& h = ray_hit.hit;
    if (h.instID[0] != RTC_INVALID_GEOMETRY_ID)
        return Hit{ray_hit.ray.tfar, kNone, {h.instID[0], h.primID, h.u, h.v}};
    if (h.geomID >= impl_->instance_count)
        return Hit{ray_hit.ray.tfar, h.geomID - impl_->instance_count, {kNone, 0, 0, 0}};
    return Hit{ray_hit.ray.tfar, kNone, {h.geomID, h.primID, h.u, h.v}};
}

bool Accel::occluded(const Ray& ray, uint32_t kind) const {
    if (!impl_->casts(ray)) return true;
    RTCRay r = to_embree(ray, kind);
    occluded1(impl_->scene, r);
    return r.tfar < 0.0f;
}

void Accel::prepare_alone(const Scene& scene, uint32_t index) {
    if (impl_->baked[index] == nullptr) return;  // its own tree serves
    RTCScene alone = impl_->device->new_scene();
    impl_->caster_scenes[index] = alone;
    rtcAttachGeometryByID(alone, impl_->baked[index], 0);
    Device::commit(alone);
    impl_->check(scene.instances[index].name.c_str());
}

std::optional<Hit> Accel::intersect_alone(uint32_t index, const Ray& ray) const {
    if (!impl_->casts(ray)) return std::nullopt;
    RTCScene alone = impl_->caster_scenes[index];
    Ray local = ray;
    if (alone == nullptr) {
        const Instance& instance = *impl_->instances[index];
        alone = impl_->tree_of[index]->scene;
        if (instance.world_positions.empty()) {
            // The direction keeps its length, so t is the world's.
            local.origin = instance.world_to_object.point(ray.origin);
            local.direction = instance.world_to_object.vector(ray.direction);
        }
    }
    RTCRayHit ray_hit = to_embree_hit(local, ~0u);
    intersect1(alone, ray_hit);
    if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{ray_hit.ray.tfar, kNone, {index, ray_hit.hit.primID, ray_hit.hit.u, ray_hit.hit.v}};
}

uint64_t Accel::lost_rays() const { return impl_->lost_rays.load(std::memory_order_relaxed); }

const char* Accel::library_version() {
    static const std::string text = fmt::format("Embree {}", RTC_VERSION_STRING);
    return text.c_str();
}

}  // namespace spc
