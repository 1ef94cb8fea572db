// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/pass_sources.h"

#include "integrator/path.h"

#include <algorithm>

namespace spc {

CustomCounts CustomNames::counts() const {
    CustomCounts counts;
    for (size_t kind = 0; kind < kCustomKinds; ++kind)
        counts.of[kind] = static_cast<uint32_t>(of[kind].size());
    return counts;
}

PassSources find_pass_sources(const RenderScene& world, const CustomNames& names) {
    const Scene& scene = *world.scene;
    const auto index_in = [&](CustomKind kind, const std::string& name) {
        const std::vector<std::string>& all = names[kind];
        const auto found = std::find(all.begin(), all.end(), name);
        return found == all.end() ? kNoGroup : static_cast<uint32_t>(found - all.begin());
    };
    const auto group = [&](const std::string& name) {
        return index_in(CustomKind::light_group, name);
    };
    PassSources sources;
    for (const Instance& instance : scene.instances)
        sources.of_instance.push_back(group(instance.light_group));
    sources.of_world = group(scene.environment.light_group);
    for (const LightDesc& light : scene.lights)
        sources.of_light.push_back(group(light.light_group));
    for (const EmissiveInstance& emitter : world.lights.emissive)
        sources.of_light.push_back(sources.of_instance[emitter.instance]);
    if (world.lights.has_world) sources.of_light.push_back(sources.of_world);
    for (const Material& material : scene.materials) {
        std::vector<PassSources::Aov>& aovs = sources.aovs.emplace_back();
        for (uint32_t node = 0; node < material.aovs.size(); ++node)
            for (const CustomKind kind : {CustomKind::color_aov, CustomKind::value_aov})
                if (const uint32_t i = index_in(kind, material.aovs[node]); i != kNoGroup)
                    aovs.push_back({node, pass_of(kind, i)});
    }
    return sources;
}

}  // namespace spc
