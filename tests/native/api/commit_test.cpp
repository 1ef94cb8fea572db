// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that a thread of the library commits: as if at once, or not at all.
#include "support/api_scene.h"

namespace spc::test {
namespace {

// Of a series, and with a mesh of a million triangles.
ScenePtr large_scene(const spc_scene* before) {
    ScenePtr scene = edited(before);
    before != nullptr ? keep_resources(scene.get()) : add_resources(scene.get());
    const uint32_t mesh = add_large_mesh(scene.get()), plaster = 0;
    add_objects(scene.get());
    spc_instance_desc instance = valid_instance(mesh, plaster);
    instance.transform[11] = -1.0f;
    uint32_t index;
    EXPECT_EQ(spc_scene_add_instance(scene.get(), &instance, &index), SPC_OK) << spc_last_error();
    return scene;
}

TEST(CommitOnAnotherThread, RendersAsOneAtOnce) {
    const std::vector<float> wanted = render_all(committed_scene().get(), quick_settings());
    const ScenePtr scene = new_scene();
    add_resources(scene.get());
    add_objects(scene.get());
    ASSERT_EQ(spc_scene_commit_start(scene.get(), 1), SPC_OK) << spc_last_error();
    EXPECT_EQ(end_of_commit(scene.get()), SPC_OK) << spc_last_error();
    EXPECT_TRUE(same_bits(render_all(scene.get(), quick_settings()), wanted));
    expect_refused(spc_scene_commit_start(scene.get(), 1), SPC_WRONG_STATE, {"committed already"});
    auto stats = sized<spc_scene_stats>();
    ASSERT_EQ(spc_scene_get_stats(scene.get(), &stats), SPC_OK);
    EXPECT_GT(stats.commit_seconds, 0.0);
}

TEST(CommitOnAnotherThread, CanOnlyBeWaitedForAndCancelled) {
    const ScenePtr scene = large_scene(nullptr);
    uint32_t index = 77, ended = 77;
    expect_refused(spc_scene_commit_wait(scene.get(), 0, &ended), SPC_WRONG_STATE,
                   {"not being built"});
    expect_refused(spc_scene_commit_cancel(scene.get()), SPC_WRONG_STATE, {"not being built"});
    expect_refused(spc_scene_commit_start(scene.get(), 1u << 20), SPC_INVALID_ARGUMENT, {"threads"});
    ASSERT_EQ(spc_scene_commit_start(scene.get(), 1), SPC_OK) << spc_last_error();
    const spc_mesh_desc mesh = valid_mesh();
    const spc_camera_desc camera = valid_camera();
    const spc_render_settings settings = quick_settings();
    spc_session* session = nullptr;
    spc_scene* next = nullptr;
    expect_refused(spc_scene_add_mesh(scene.get(), &mesh, &index), SPC_WRONG_STATE, {"being built"});
    expect_refused(spc_scene_keep_mesh(scene.get(), 0, &index), SPC_WRONG_STATE, {"being built"});
    expect_refused(spc_scene_set_camera(scene.get(), &camera), SPC_WRONG_STATE, {"being built"});
    expect_refused(spc_scene_commit(scene.get(), 1), SPC_WRONG_STATE, {"being built"});
    expect_refused(spc_scene_commit_start(scene.get(), 1), SPC_WRONG_STATE, {"being built"});
    expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_WRONG_STATE,
                   {"not committed"});
    expect_refused(spc_scene_edit(scene.get(), &next), SPC_WRONG_STATE, {"not committed"});
    expect_refused(spc_scene_commit_wait(scene.get(), 0, nullptr), SPC_INVALID_ARGUMENT,
                   {"ended is null"});
    EXPECT_EQ(index, 77u);
    EXPECT_EQ(ended, 77u);
    EXPECT_EQ(end_of_commit(scene.get()), SPC_OK) << spc_last_error();
    expect_refused(spc_scene_commit_wait(scene.get(), 0, &ended), SPC_WRONG_STATE,
                   {"not being built"});
}

TEST(CommitOnAnotherThread, WhatIsCancelledIsLostAlone) {
    const ScenePtr before = edited(nullptr);
    add_resources(before.get());
    add_objects(before.get());
    ASSERT_EQ(spc_scene_commit(before.get(), 1), SPC_OK) << spc_last_error();
    const std::vector<float> wanted = render_all(before.get(), quick_settings());
    for (const uint32_t milliseconds : {0, 10, 40}) {
        const ScenePtr scene = large_scene(before.get());
        ASSERT_EQ(spc_scene_commit_start(scene.get(), 1), SPC_OK) << spc_last_error();
        uint32_t ended = 0;
        ASSERT_EQ(spc_scene_commit_wait(scene.get(), milliseconds, &ended), SPC_OK);
        if (ended == 1) continue;  // on a fast machine
        EXPECT_EQ(spc_scene_commit_cancel(scene.get()), SPC_OK) << spc_last_error();
        expect_refused(end_of_commit(scene.get()), SPC_CANCELLED, {"cancelled"});
        expect_refused(spc_scene_commit(scene.get(), 1), SPC_WRONG_STATE, {"commit failed"});
        EXPECT_EQ(spc_scene_report(scene.get()), nullptr);
    }
    const ScenePtr next = edited(before.get());
    keep_resources(next.get());
    add_objects(next.get());
    ASSERT_EQ(spc_scene_commit_start(next.get(), 1), SPC_OK) << spc_last_error();
    EXPECT_EQ(end_of_commit(next.get()), SPC_OK) << spc_last_error();
    EXPECT_TRUE(same_bits(render_all(next.get(), quick_settings()), wanted));
    EXPECT_TRUE(same_bits(render_all(before.get(), quick_settings()), wanted));
}

TEST(CommitOnAnotherThread, EndsWithTheScene) {
    ScenePtr before = large_scene(nullptr);
    ASSERT_EQ(spc_scene_commit_start(before.get(), 2), SPC_OK) << spc_last_error();
    before.reset();
    before = edited(nullptr);
    add_resources(before.get());
    add_objects(before.get());
    ASSERT_EQ(spc_scene_commit(before.get(), 1), SPC_OK) << spc_last_error();
    ScenePtr next = large_scene(before.get());
    ASSERT_EQ(spc_scene_commit_start(next.get(), 2), SPC_OK) << spc_last_error();
    before.reset();  // of which the next one has its share
    EXPECT_EQ(end_of_commit(next.get()), SPC_OK) << spc_last_error();
    EXPECT_FALSE(render_all(next.get(), quick_settings()).empty());
}

}  // namespace
}  // namespace spc::test
