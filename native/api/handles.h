// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/session.h"
#include "scene/builder.h"
#include "scene/caustics_part.h"
#include "shading/attribute_needs.h"
#include "specula/specula.h"

#include <atomic>
#include <future>
#include <map>
#include <mutex>
#include <thread>

// What a commit makes of a scene.
struct Commit {
    std::shared_ptr<spc::RenderScene> world;
    std::string report;
    double seconds;
};

// A scene under construction, or frozen: `builder` until commit, `world` after it.
struct spc_scene {
    spc_scene() = default;
    ~spc_scene() { cancelled = true; }  // `commit` ends before anything that it uses goes
    spc_scene(const spc_scene&) = delete;
    spc_scene& operator=(const spc_scene&) = delete;

    std::unique_ptr<spc::SceneBuilder> builder = std::make_unique<spc::SceneBuilder>();
    std::shared_ptr<const spc::RenderScene> before{};  // the snapshot before, until commit
    std::shared_ptr<spc::RenderScene> world{};
    std::string report;
    double commit_seconds = 0.0;
    // What the last answers refer to.
    std::vector<spc::AttributeNeed> needs{};
    std::vector<spc_attribute_need> needed_attributes{};
    spc::CausticsPart part{};
    std::string glints{}, no_glints{};
    // Of the sessions so far, if the scene is one of a series.
    mutable spc::SheetStore sheets{};
    // Sessions that render it; a render may start and end in any thread.
    mutable std::mutex renders_mutex;
    mutable uint32_t renders = 0;
    // One on a thread of its own, which has `builder` and `before` to itself; valid until its end
    // is told.
    std::atomic<bool> cancelled{false};
    std::future<Commit> commit;
};

namespace spc::api {
// Throw Error unless the scene is in that state.
SceneBuilder& builder_of(spc_scene* scene);
const RenderScene& world_of(const spc_scene* scene);
}  // namespace spc::api

// Counts as one of the scene's renders for as long as it lives.
class RendersScene {
public:
    explicit RendersScene(const spc_scene& scene) : scene_(scene) { add(1); }
    ~RendersScene() { add(-1); }
    RendersScene(const RendersScene&) = delete;
    RendersScene& operator=(const RendersScene&) = delete;

private:
    void add(int change) {
        const std::lock_guard lock(scene_.renders_mutex);
        scene_.renders += static_cast<uint32_t>(change);
    }
    const spc_scene& scene_;
};

struct spc_session {
    spc_session(const spc_scene& scene, const spc::RenderSettings& settings)
        : renders(scene),
          session(*scene.world, settings,
                  scene.world->scene->has_trees_to_share ? &scene.sheets : nullptr) {}
    RendersScene renders;
    spc::Session session;
    std::mutex sums_mutex{};
    // That each thread of the host has asked for last.
    std::map<std::thread::id, std::vector<std::byte>> sums{};
};
