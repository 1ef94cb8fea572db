// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that runs out, in a process of its own: each call says so and for what, and what was there
// before still renders.
#include "support/api_scene.h"

#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace spc::test {
namespace {

constexpr size_t kMegabyte = size_t{1} << 20;

// From now on this process gets no more than so much beyond what it has.
void limit_memory(size_t bytes) {
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<size_t>(sysconf(_SC_PAGESIZE)) + bytes;
    const rlimit limit{most, most};
    ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
}

// Runs the checks where no other test feels the limit; its exit code says whether all held.
template <class Checks>
void in_own_process(const Checks& checks) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer ends the program where memory is refused";
#endif
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            checks();
            std::fputs(spc_last_error(), stderr);  // shown if it fails
            std::_Exit(::testing::Test::HasFailure() ? 1 : 0);
        },
        ::testing::ExitedWithCode(0), "");
}

TEST(OutOfMemory, OfImagesMeshesAndFilms) {
    in_own_process([] {
        const ScenePtr kept = committed_scene(),
                       large_film = committed_scene(valid_camera(4096, 4096)), growing = new_scene();
        add_resources(growing.get());
        const std::vector<float> numbers(40 * kMegabyte, 0.5f);
        const std::vector<uint32_t> indices(6 * kMegabyte, 0);
        limit_memory(64 * kMegabyte);
        uint32_t index = 77;

        spc_image_desc image = valid_image();
        image.pixels = numbers.data();
        image.pixel_type = SPC_PIXEL_F32;
        image.width = image.height = 3600;
        expect_refused(spc_scene_add_image(growing.get(), &image, &index), SPC_OUT_OF_MEMORY,
                       {"image \"Bricks\"", "out of memory"});

        spc_mesh_desc mesh = valid_mesh();
        mesh.positions = numbers.data();
        mesh.vertex_count = 12 * kMegabyte;
        mesh.triangles = indices.data();
        mesh.attribute_count = 0;
        expect_refused(spc_scene_add_mesh(growing.get(), &mesh, &index), SPC_OUT_OF_MEMORY,
                       {"mesh \"Slate\"", "out of memory"});
        EXPECT_EQ(index, 77u);

        const spc_render_settings settings = quick_settings();
        spc_session* session = nullptr;
        expect_refused(spc_render_start(large_film.get(), &settings, &session), SPC_OUT_OF_MEMORY,
                       {"film", "4096 x 4096", "out of memory"});
        EXPECT_EQ(session, nullptr);

        add_objects(growing.get());
        EXPECT_EQ(spc_scene_commit(growing.get(), 1), SPC_OK) << spc_last_error();
        const std::vector<float> picture = render_all(kept.get(), settings);
        EXPECT_TRUE(same_bits(picture, render_all(growing.get(), settings)));
    });
}

void check_commit(spc_status (*commit)(spc_scene*)) {
    in_own_process([&] {
        const ScenePtr kept = committed_scene(), lost = new_scene();
        add_resources(lost.get());
        const uint32_t mesh = add_large_mesh(lost.get());
        add_objects(lost.get());
        const uint32_t plaster = 0;
        const spc_instance_desc instance = valid_instance(mesh, plaster);
        uint32_t index;
        ASSERT_EQ(spc_scene_add_instance(lost.get(), &instance, &index), SPC_OK);
        limit_memory(32 * kMegabyte);

        expect_refused(commit(lost.get()), SPC_OUT_OF_MEMORY, {"trees", "out of memory"});
        expect_refused(spc_scene_commit(lost.get(), 1), SPC_WRONG_STATE, {"commit failed"});
        EXPECT_FALSE(render_all(kept.get(), quick_settings()).empty());
    });
}

TEST(OutOfMemory, OfACommit) {
    check_commit([](spc_scene* scene) { return spc_scene_commit(scene, 1); });
}

TEST(OutOfMemory, OfACommitOnAnotherThread) {
    check_commit([](spc_scene* scene) {
        const spc_status started = spc_scene_commit_start(scene, 1);
        return started == SPC_OK ? end_of_commit(scene) : started;
    });
}

}  // namespace
}  // namespace spc::test
