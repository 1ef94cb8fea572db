// SPDX-License-Identifier: GPL-3.0-or-later
// The shared library as a host meets it: its symbols, and a render through dlopen().
#include "support/api_scene.h"

#include <dlfcn.h>
#include <elf.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace spc::test {
namespace {

std::vector<std::filesystem::path> libraries() {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(SPC_TEST_LIBRARY_DIR))
        if (entry.path().extension() == ".so") found.push_back(entry.path());
    return found;
}

// Names that a 64-bit ELF file defines for others.
std::set<std::string> exported(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
    Elf64_Ehdr header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    std::vector<Elf64_Shdr> sections(header.e_shnum);
    std::memcpy(sections.data(), bytes.data() + header.e_shoff,
                sections.size() * sizeof(Elf64_Shdr));
    std::set<std::string> names;
    for (const Elf64_Shdr& section : sections) {
        if (section.sh_type != SHT_DYNSYM) continue;
        const char* strings = bytes.data() + sections[section.sh_link].sh_offset;
        for (size_t at = 0; at < section.sh_size; at += sizeof(Elf64_Sym)) {
            Elf64_Sym symbol;
            std::memcpy(&symbol, bytes.data() + section.sh_offset + at, sizeof(symbol));
            const unsigned binding = ELF64_ST_BIND(symbol.st_info);
            if (symbol.st_shndx != SHN_UNDEF && binding != STB_LOCAL)
                names.insert(strings + symbol.st_name);
        }
    }
    return names;
}

// The functions that the header declares.
std::set<std::string> declared() {
    std::ifstream file(SPC_TEST_SOURCE_DIR "/native/include/specula/specula.h");
    std::set<std::string> names;
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("SPC_API ", 0) != 0) continue;
        const size_t end = line.find('(');
        size_t begin = end;
        while (begin > 0 && (std::isalnum(static_cast<unsigned char>(line[begin - 1])) ||
                             line[begin - 1] == '_'))
            --begin;
        names.insert(line.substr(begin, end - begin));
    }
    return names;
}

TEST(Library, ExportsExactlyWhatTheHeaderDeclares) {
    const std::set<std::string> header = declared();
    EXPECT_GE(header.size(), 25u);
    ASSERT_FALSE(libraries().empty()) << "no library in " << SPC_TEST_LIBRARY_DIR;
    for (const std::filesystem::path& path : libraries()) EXPECT_EQ(exported(path), header) << path;
}

struct Closer {
    void operator()(void* handle) const { dlclose(handle); }
};

TEST(Library, RendersThroughDlopen) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the program holds the same globals already";
#endif
    for (const std::filesystem::path& path : libraries()) {
        const std::unique_ptr<void, Closer> handle(dlopen(path.c_str(), RTLD_LOCAL | RTLD_NOW));
        ASSERT_TRUE(handle) << dlerror();
        const auto find = [&]<class F>(F*, const char* name) {
            void* symbol = dlsym(handle.get(), name);
            EXPECT_NE(symbol, nullptr) << name;
            return reinterpret_cast<F*>(symbol);
        };
#define SPC_FIND(name) const auto lib_##name = find(static_cast<decltype(&name)>(nullptr), #name)
        SPC_FIND(spc_api_version);
        SPC_FIND(spc_version_string);
        SPC_FIND(spc_last_error);
        SPC_FIND(spc_scene_create);
        SPC_FIND(spc_scene_destroy);
        SPC_FIND(spc_scene_commit);
        SPC_FIND(spc_scene_set_camera);
        SPC_FIND(spc_render_start);
        SPC_FIND(spc_render_wait);
        SPC_FIND(spc_film_read);
        SPC_FIND(spc_session_destroy);
#undef SPC_FIND
        EXPECT_EQ(lib_spc_api_version(), SPC_API_VERSION);
        const std::string level = path.stem().string().substr(std::string("libspecula-").size());
        EXPECT_NE(std::string(lib_spc_version_string()).find(level), std::string::npos)
            << lib_spc_version_string();
        // Not the program's own copy of the function.
        EXPECT_NE(reinterpret_cast<void*>(lib_spc_scene_create),
                  reinterpret_cast<void*>(&spc_scene_create));

        spc_scene* scene = nullptr;
        ASSERT_EQ(lib_spc_scene_create(&scene), SPC_OK);
        EXPECT_EQ(lib_spc_scene_commit(scene, 1), SPC_WRONG_STATE);
        EXPECT_NE(std::string(lib_spc_last_error()).find("camera"), std::string::npos);
        const spc_camera_desc camera = valid_camera(3, 2);
        ASSERT_EQ(lib_spc_scene_set_camera(scene, &camera), SPC_OK);
        ASSERT_EQ(lib_spc_scene_commit(scene, 1), SPC_OK);
        const spc_render_settings settings = quick_settings();
        spc_session* session = nullptr;
        ASSERT_EQ(lib_spc_render_start(scene, &settings, &session), SPC_OK);
        ASSERT_EQ(lib_spc_render_wait(session, 60000, nullptr), SPC_OK);
        float depth[6];
        ASSERT_EQ(lib_spc_film_read(session, SPC_PASS_DEPTH, depth, 6), SPC_OK);
        for (const float value : depth) EXPECT_EQ(value, 1e10f) << "an empty scene has no surface";
        lib_spc_session_destroy(session);
        lib_spc_scene_destroy(scene);
    }
}

}  // namespace
}  // namespace spc::test
