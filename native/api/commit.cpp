// SPDX-License-Identifier: GPL-3.0-or-later
// What freezes a scene, at once or on a thread of its own, and what a frozen one tells.
#include "api/gate.h"
#include "api/handles.h"

#include <chrono>

#include <fmt/format.h>

namespace spc::api {
namespace {

SceneBuilder& builder_to_commit(spc_scene* scene, uint32_t threads) {
    SceneBuilder& builder = builder_of(scene);
    require(threads <= kMostThreads, fmt::format("threads must be at most {}", kMostThreads));
    builder.require_complete();
    return builder;
}

Commit build(SceneBuilder& builder, const RenderScene* before, uint32_t threads) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_ptr<Scene> frozen = with_memory_for("the trees over the scene's geometry",
                                                    [&] { return builder.freeze(threads); });
    Commit made;
    made.world = with_memory_for("the tables of the scene's lights and casters", [&] {
        return std::make_shared<RenderScene>(prepare(std::move(frozen), threads, before));
    });
    for (const std::string& line : made.world->scene->report) made.report += line + "\n";
    made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return made;
}

// The scene becomes what `make` gives. If that throws, the scene is lost, and says so to every
// later call.
template <class Make>
void take_over(spc_scene& scene, const Make& make) {
    const std::unique_ptr<SceneBuilder> builder = std::move(scene.builder);
    const std::shared_ptr<const RenderScene> before = std::move(scene.before);
    Commit made = make();
    scene.world = std::move(made.world);
    scene.report = std::move(made.report);
    scene.commit_seconds = made.seconds;
}

spc_scene& with_commit(spc_scene* scene) {
    require(scene != nullptr, "scene is null");
    if (!scene->commit.valid()) throw Error(ErrorKind::wrong_state, "the scene is not being built");
    return *scene;
}

void fill_stats(const spc_scene& handle, spc_scene_stats& stats) {
    const RenderScene& world = *handle.world;
    const Scene& scene = *world.scene;
    stats = {};
    stats.struct_size = sizeof(stats);
    for (const Mesh& mesh : scene.meshes) {
        stats.triangles += mesh.triangles.size();
        stats.dropped_triangles += mesh.dropped_triangles;
        stats.memory_bytes += mesh.positions.size() * sizeof(Vec3) +
                              mesh.triangles.size() * sizeof(mesh.triangles[0]) +
                              mesh.normals.size() * sizeof(Vec3) +
                              mesh.slots.size() * sizeof(uint32_t);
        for (const Attribute& attribute : mesh.attributes)
            stats.memory_bytes += attribute.values.size() * sizeof(float) +
                                  attribute.tangents.size() * (sizeof(Vec3) + sizeof(float));
    }
    for (const Image& image : scene.images) stats.memory_bytes += image.memory_bytes();
    stats.memory_bytes += world.glints.memory_bytes();
    stats.instances = scene.instances.size();
    for (const Instance& instance : scene.instances) {
        stats.casters += instance.turns_light() ? 1 : 0;
        stats.receivers += instance.receiver ? 1 : 0;
        stats.memory_bytes += instance.world_positions.size() * sizeof(Vec3);
    }
    stats.lights = world.lights.count();
    stats.commit_seconds = handle.commit_seconds;
}

}  // namespace
}  // namespace spc::api

using namespace spc::api;

spc_status spc_scene_commit(spc_scene* scene, uint32_t threads) {
    return gate("spc_scene_commit", [&] {
        spc::SceneBuilder& builder = builder_to_commit(scene, threads);
        const spc::RenderScene* before = scene->before.get();
        take_over(*scene, [&] { return build(builder, before, threads); });
    });
}

spc_status spc_scene_commit_start(spc_scene* scene, uint32_t threads) {
    return gate("spc_scene_commit_start", [&] {
        spc::SceneBuilder& builder = builder_to_commit(scene, threads);
        scene->commit = std::async(std::launch::async, [&builder, scene, threads] {
            const spc::Cancellable cancellable(scene->cancelled);
            return build(builder, scene->before.get(), threads);
        });
    });
}

spc_status spc_scene_commit_wait(spc_scene* scene, uint32_t milliseconds, uint32_t* ended) {
    return gate("spc_scene_commit_wait", [&] {
        spc_scene& building = with_commit(scene);
        uint32_t& out = checked_output(ended, "ended");
        const auto status = building.commit.wait_for(std::chrono::milliseconds(milliseconds));
        out = status == std::future_status::ready ? 1 : 0;
        if (out == 1) take_over(building, [&] { return building.commit.get(); });
    });
}

spc_status spc_scene_commit_cancel(spc_scene* scene) {
    return gate("spc_scene_commit_cancel", [&] { with_commit(scene).cancelled = true; });
}

spc_status spc_scene_get_stats(const spc_scene* scene, spc_scene_stats* stats) {
    return gate("spc_scene_get_stats", [&] {
        world_of(scene);
        checked(stats, "stats");
        fill_stats(*scene, *stats);
    });
}

const char* spc_scene_report(const spc_scene* scene) {
    const spc_status status = gate("spc_scene_report", [&] { world_of(scene); });
    return status == SPC_OK ? scene->report.c_str() : nullptr;
}
