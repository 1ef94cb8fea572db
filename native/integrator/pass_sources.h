// SPDX-License-Identifier: GPL-3.0-or-later
// Where passes whose number the artist chooses get their values from.
#pragma once

#include "film/passes.h"

#include <string>
#include <vector>

namespace spc {

struct RenderScene;

// Names of light groups and AOVs, in the order of their passes.
struct CustomNames {
    std::array<std::vector<std::string>, kCustomKinds> of;

    const std::vector<std::string>& operator[](CustomKind kind) const {
        return of[static_cast<size_t>(kind)];
    }
    CustomCounts counts() const;
};

struct PassSources {
    // Light groups, or kNoGroup: of each light of the LightSet, of each instance, and of the world.
    std::vector<uint32_t> of_light, of_instance;
    uint32_t of_world;
    // What fills an AOV: a node of the material.
    struct Aov {
        uint32_t node;  // of Material::aovs
        Pass pass;
    };
    std::vector<std::vector<Aov>> aovs;  // of each material
};
PassSources find_pass_sources(const RenderScene& world, const CustomNames& names);

}  // namespace spc
