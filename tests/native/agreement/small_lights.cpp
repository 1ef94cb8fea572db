// SPDX-License-Identifier: GPL-3.0-or-later
// Lights so small that path tracing is blind: the manifold alone against light paths alone, for each
// kind of chain.
#include "agreement/parts.h"
#include "integrator/chain_cases.h"

#include <set>

namespace spc::test {
namespace {

constexpr Method kSheetsAlone{"light sheets", true, false, ChainFinder::sheets};

struct SmallLight {
    const char* name;
    LightType type;
    float radius;
};
constexpr SmallLight kPoint{"a point", LightType::point, 0.0f},
    kTiny{"a tiny sphere", LightType::point, 1e-3f}, kSun{"a sun", LightType::sun, 0.0f};
constexpr Vec3 kSlanting(0.1f, -1.0f, 0.9f);  // towards the sun: what leads to the floor by a mirror

// Of the floor, m: the mirror lights a narrow part. Where casters are much larger than what the camera
// sees of their light, light paths have rare bright splats that their sample variance does not know of.
constexpr float kNarrow = 0.3f, kWide = 0.9f;

Row row(const ChainScene& scene, Reliefs reliefs, const SmallLight& small, float half_view) {
    constexpr float kHeight = 3.0f;
    constexpr uint32_t kRounds = 1000, kRoundsOfWalks = 12000, kLightRounds = 16000;
    constexpr double kNotices = 0.12;
    const bool sun = small.type == LightType::sun;
    LightDesc desc = lamp(small.type, sun ? 3.0f : 100.0f);
    desc.to_world =
        sun ? rotation_x(std::atan2(-kSlanting.y, kSlanting.z)) : translation(scene.lamp);
    desc.radius = small.radius;
    Row row{.casters = {scene.name + ", " + to_string(reliefs.one),
                        [=](SceneMaker& m) {
                            add_relief_image(m, reliefs);
                            scene.build(m, reliefs);
                        }},
            .light = light(std::string("under ") + small.name, desc),
            .camera = camera_from("", {0.0f, 0.0f, kHeight}, half_view / kHeight),
            .reference = {kLightRounds, kLightPaths},
            .claims = {{kSheetsAlone, kRounds, kNotices}},
            .blind_path_tracing = true};
    // Of the ball walks hardly meet some chains.
    if (reliefs.one == Relief::none && scene.has_relief)
        row.claims.push_back({kManifold, kRoundsOfWalks, kNotices});
    return row;
}

Table table() {
    Table table;
    const auto add = [&](const std::set<std::string>& kinds, Reliefs reliefs,
                         const SmallLight& light, float half_view) {
        for (const ChainScene& scene : chain_scenes())
            if (kinds.contains(scene.name))
                table.rows.push_back(row(scene, reliefs, light, half_view));
    };
    const std::string ball = "R, TT and TRT of a ball";
    const std::set<std::string> every{"R", "T", "RT", "TT", "TRT", "TTTT", ball};
    add(every, {}, kPoint, kWide);
    add(every, {}, kTiny, kWide);
    // What is over the mirror keeps such a sun away in RT.
    add({"R", "T", "TT", "TRT", "TTTT", ball}, {}, kSun, kWide);
    add({"R", "TRT"}, {Relief::normals}, kPoint, kNarrow);
    add({"T", "RT", "TT", "TTTT"}, {Relief::normals}, kPoint, kWide);
    add({"R", "T", "RT", "TT"}, {Relief::heights}, kPoint, kWide);
    return table;
}

}  // namespace

SPC_AGREEMENT(SmallLights, table);

}  // namespace spc::test
