// SPDX-License-Identifier: GPL-3.0-or-later
// Lights so small that path tracing is blind: the manifold alone against light paths alone, for
// each kind of chain.
#include "agreement/chain_scenes.h"
#include "agreement/parts.h"

#include <set>

namespace spc::test {
namespace {

// Half of the floor's side that the camera sees, m: the mirror lights a narrow part. Where casters
// are much larger than what the camera sees of their light, light paths have rare bright splats
// that their sample variance does not know of.
constexpr float kNarrow = 0.3f, kWide = 0.9f;

enum class SmallLight : uint8_t { point, tiny_sphere, sun };
Part under(SmallLight small, const Vec3& p) {
    constexpr Vec3 kSlanting(0.1f, -1.0f, 0.9f);  // to the sun: what leads to the floor by a mirror
    if (small == SmallLight::sun) {
        LightDesc sun = lamp(LightType::sun, 3.0f);
        sun.to_world = rotation_x(std::atan2(-kSlanting.y, kSlanting.z));
        return light("sun", sun);
    }
    const bool tiny = small == SmallLight::tiny_sphere;
    return bulb(tiny ? "tiny sphere" : "point", p, tiny ? 1e-3f : 0.0f);
}

// Of each kind among `kinds`.
std::vector<Row> rows(const std::set<std::string>& kinds, Reliefs reliefs, SmallLight small,
                      float half_view = kWide) {
    constexpr uint32_t kRounds = 1000, kRoundsOfWalks = 12000, kLightRounds = 16000;
    constexpr double kNotices = 0.12;
    std::vector<Row> rows;
    for (const ChainScene& scene : chain_scenes()) {
        if (!kinds.contains(scene.name)) continue;
        Row row{.casters = casters_of(scene, reliefs),
                .light = under(small, scene.lamp),
                .camera = camera_above(half_view),
                .reference = {kLightRounds, kLightPaths},
                .claims = {{kSheetsAlone, kRounds, kNotices}},
                .blind_path_tracing = true};
        // Of the ball walks hardly meet some chains.
        if (reliefs.one == Relief::none && scene.has_relief)
            row.claims.push_back({kManifold, kRoundsOfWalks, kNotices});
        rows.push_back(row);
    }
    return rows;
}

Table table() {
    const char* const kBall = "R, TT and TRT of a ball";
    const std::set<std::string> every{"R", "T", "RT", "TT", "TRT", "TTTT", kBall};
    Table table;
    for (const std::vector<Row>& some : {
             rows(every, {}, SmallLight::point),
             rows(every, {}, SmallLight::tiny_sphere),
             // What is over the mirror keeps such a sun away in RT.
             rows({"R", "T", "TT", "TRT", "TTTT", kBall}, {}, SmallLight::sun),
             rows({"R", "TRT"}, {Relief::normals}, SmallLight::point, kNarrow),
             rows({"T", "RT", "TT", "TTTT"}, {Relief::normals}, SmallLight::point),
             rows({"R", "T", "RT", "TT"}, {Relief::heights}, SmallLight::point),
         })
        table.rows.insert(table.rows.end(), some.begin(), some.end());
    return table;
}

}  // namespace

SPC_AGREEMENT(SmallLights, table);

}  // namespace spc::test
