// SPDX-License-Identifier: GPL-3.0-or-later
// Every kind of chain without light paths: the manifold finds a good part of what reaches the floor.
#include "agreement/parts.h"
#include "integrator/chain_cases.h"

#include <set>

namespace spc::test {
namespace {

constexpr uint32_t kPixels = 4;  // along each side of a quarter of the picture

// Four blocks of the floor from just above: casters stand in nobody's way.
const Part kAboveFloor{"", [](SceneMaker& maker) {
                           constexpr float kBlock = 0.3f;
                           Camera camera;
                           camera.projection = Projection::orthographic;
                           camera.to_world = translation({0, 0, 0.01f});
                           camera.width = camera.height = 2 * kPixels;
                           camera.crop = {0, 0, 2 * kPixels, 2 * kPixels};
                           camera.viewplane = {-kBlock, kBlock, -kBlock, kBlock};
                           maker.builder.set_camera(camera);
                       }};

// What finds chains, and how many samples its comparison takes in each block.
struct Finder {
    Method method;
    uint32_t samples;
};
Finder walks(uint32_t samples = 60000) { return {kManifold, samples}; }
Finder sheets(uint32_t samples = 15000) {
    return {{"light sheets", true, false, ChainFinder::sheets, 256}, samples};
}

struct Lamp {
    LightType type = LightType::point;
    float radius = 0.3f;
};

Row row(const ChainScene& scene, const std::vector<Finder>& finders, Reliefs reliefs = {},
        const Lamp& of = {}) {
    constexpr uint32_t kTruth = 200000;
    constexpr uint32_t kSamplesOfRound = kPixels * kPixels;
    const uint32_t by_day = power(2u, 1u);  // fewer samples
    std::string name = scene.name;
    if (reliefs.one != Relief::none) name += std::string(", ") + to_string(reliefs.one);
    if (reliefs.others != Relief::none)
        name += std::string(", others ") + to_string(reliefs.others);
    LightDesc desc = lamp(of.type, 100.0f);
    desc.to_world = translation(scene.lamp);
    desc.radius = of.radius;
    Row row{.casters = {name,
                        [=](SceneMaker& m) {
                            add_relief_image(m, reliefs);
                            scene.build(m, reliefs);
                        }},
            .light = light("", desc),
            .camera = kAboveFloor,
            .reference = {kTruth / kSamplesOfRound}};
    for (const Finder& finder : finders)
        row.claims.push_back(
            {finder.method, finder.samples / kSamplesOfRound / by_day, power(0.35, 0.25), 0.25});
    return row;
}

// Those of chain_scenes() with these names; all of them if there are none.
std::vector<ChainScene> scenes(const std::set<std::string>& names) {
    std::vector<ChainScene> scenes = chain_scenes();
    std::erase_if(scenes, [&](const ChainScene& scene) { return !names.contains(scene.name); });
    EXPECT_EQ(scenes.size(), names.size());
    return scenes;
}

Table smooth() {
    Table table;
    // Of longer chains walks leave most light to path tracing, where it finds the lamp.
    for (const ChainScene& scene : chain_scenes())
        table.rows.push_back(row(scene, scene.interactions == 1 ? std::vector{walks(), sheets()}
                                                                : std::vector{sheets()}));
    return table;
}

Table in_relief() {
    Table table;
    const auto add = [&](const std::set<std::string>& names, const std::vector<Finder>& finders,
                         Reliefs reliefs) {
        for (const ChainScene& scene : scenes(names))
            table.rows.push_back(row(scene, finders, reliefs));
    };
    const std::vector<Finder> both{walks(), sheets()}, one{sheets()}, patient{sheets(40000)};
    add({"R", "T"}, both, {Relief::normals});
    add({"RT", "TT", "TRT", "TTTT"}, one, {Relief::normals});
    add({"RT", "TRT"}, patient, {Relief::none, Relief::normals});
    add({"RT", "TT", "TTTT"}, patient, {Relief::normals, Relief::normals});
    add({"R", "T"}, both, {Relief::heights});
    add({"RT", "TT"}, one, {Relief::heights});
    add({"TT"}, one, {Relief::heights, Relief::heights});
    return table;
}

// ---- rough vertices

// Roughness 0.2 and 0.15: lobes of 0.04 and 0.0225 rad.
const Graph kMetal = mirror(0.2f), kFrosted = refraction(1.4f, 0.15f), kClear = refraction(1.4f);
Graph beckmann(Graph graph) {
    graph.options.push_back({1, "distribution", "BECKMANN"});
    return graph;
}
const std::vector<Finder> kRoughWalks{walks(30000)}, kRoughSheets{sheets(80000)},
    kPatientSheets{sheets(160000)};

ChainScene scene(const std::string& name, const std::function<void(SceneMaker&, Reliefs)>& build) {
    return {name, 1, build};
}
ChainScene off_mirror(const std::string& name, const Graph& wall) {
    return scene(name, [=](SceneMaker& m, Reliefs r) { add_mirror(m, r.one, wall); });
}
ChainScene by_mirror_and_pane(const std::string& name, const Graph& wall, const Graph& pane) {
    return scene(name, [=](SceneMaker& m, Reliefs) {
        add_mirror(m, Relief::none, wall);
        add_pane_over_mirror(m, pane);
    });
}
ChainScene off_mirror_behind(const std::string& name, const Graph& wall, const Graph& pane) {
    return scene(name, [=](SceneMaker& m, Reliefs r) {
        add_mirror(m, r.others, wall);
        add_pane_before_mirror(m, pane, r.one);
    });
}
void add_pane(SceneMaker& maker, float z, const Graph& graph, Relief relief = Relief::none) {
    add_surface(maker, 2.5f, graph, translation({0, 0, z}), relief);
}
// Whose back is above.
void add_pane_over_glass(SceneMaker& maker, float z, const Graph& graph,
                         Relief relief = Relief::none) {
    add_surface(maker, 2.5f, graph, rotation_x(kPi, {0, 0, z}), relief);
}
ChainScene through_pane(const std::string& name, const Graph& pane) {
    return scene(name, [=](SceneMaker& m, Reliefs r) { add_pane(m, 0.7f, pane, r.one); });
}
ChainScene through_slab(const std::string& name, const Graph& below, const Graph& above) {
    return scene(name, [=](SceneMaker& m, Reliefs r) {
        add_pane_over_glass(m, 0.6f, below, r.others);
        add_pane(m, 0.8f, above, r.one);
    });
}
ChainScene through_slabs(const std::string& name, const std::array<Graph, 4>& from_below) {
    return scene(name, [=](SceneMaker& m, Reliefs) {
        for (size_t i = 0; i < 4; i += 2) {
            const float z = 0.3f + 0.25f * float(i);
            add_pane_over_glass(m, z, from_below[i]);
            add_pane(m, z + 0.2f, from_below[i + 1]);
        }
    });
}

Table rough_reflections() {
    return {
        {row(off_mirror("rough R", kMetal), kRoughWalks),
         row(off_mirror("rough R, Beckmann", beckmann(kMetal)), kRoughWalks),
         // What its diffuse part scatters is path tracing's.
         row(off_mirror("rough R of a mixture", combined(kMetal, diffuse(0.7f), 0.5f)), kRoughWalks),
         // Half of the light passes the pane straight on.
         row(off_mirror_behind("rough R behind a pane", kMetal,
                               combined(kMetal, transparent(1.0f), 0.5f)),
             kRoughSheets),
         // Next event estimation finds lights without size at rough vertices.
         row(off_mirror("rough R of a point", kMetal), kRoughWalks, {}, {LightType::point, 0.0f}),
         row(off_mirror_behind("rough T, rough R, rough T", kMetal, kFrosted), kRoughSheets),
         row(by_mirror_and_pane("rough R, T", kMetal, refraction(1.3f)), kRoughSheets),
         row(by_mirror_and_pane("R, rough T", mirror(), refraction(1.3f, 0.15f)), kRoughSheets),
         row(by_mirror_and_pane("rough R, rough T", kMetal, refraction(1.3f, 0.15f)), kRoughSheets)}};
}

Table rough_refractions() {
    const Lamp small{LightType::point, 0.2f}, sun{LightType::sun, 0.0f};
    const Graph frosted = refraction(1.4f, 0.12f);
    return {{row(through_pane("rough T", kFrosted), kRoughSheets),
             row(through_pane("rough T, Beckmann", beckmann(kFrosted)), kRoughSheets),
             row(through_slab("rough T, T", kFrosted, kClear), kRoughSheets),
             row(through_slab("rough T, T, Beckmann", beckmann(kFrosted), kClear), kRoughSheets),
             row(through_slab("rough T, rough T, Beckmann", beckmann(kFrosted), beckmann(kFrosted)),
                 kRoughSheets),
             row(through_slab("T, rough T", kClear, kFrosted), kRoughSheets, {}, small),
             row(through_pane("rough T of a sun without a disc", refraction(1.4f, 0.28f)),
                 kRoughSheets, {}, sun),
             row(through_slabs("rough T, T, T, T", {frosted, kClear, kClear, kClear}), kRoughSheets,
                 {}, small),
             row(through_slabs("T, T, rough T, T", {kClear, kClear, frosted, kClear}), kRoughSheets,
                 {}, small),
             row(through_slabs("four times rough T", {frosted, frosted, frosted, frosted}),
                 kRoughSheets, {}, small)}};
}

Table rough_reliefs_and_a_ball() {
    ChainScene ball = scene("rough ball", [](SceneMaker& m, Reliefs) {
        add_for_light(m, sphere(32, 0.5), combined(kMetal, refraction(1.5f, 0.2f), 0.5f),
                      translation({0.0f, 0.9f, 0.6f}));
    });
    ball.lamp = {0.1f, -0.4f, 1.3f};
    const ChainScene reflection = off_mirror("rough R", kMetal),
                     refraction = through_pane("rough T, Beckmann", beckmann(kFrosted));
    return {{row(reflection, kRoughWalks, {Relief::normals}),
             row(refraction, kRoughSheets, {Relief::normals}),
             row(off_mirror_behind("rough T, R, rough T", mirror(), kFrosted), kPatientSheets,
                 {Relief::normals}),
             row(through_slab("T, rough T", kClear, kFrosted), kPatientSheets, {Relief::normals}),
             row(reflection, kRoughWalks, {Relief::heights}),
             row(refraction, kRoughSheets, {Relief::heights}), row(ball, kRoughSheets)}};
}

}  // namespace

SPC_AGREEMENT(Chains, smooth);
SPC_AGREEMENT(ChainsInRelief, in_relief);
SPC_AGREEMENT(RoughReflections, rough_reflections);
SPC_AGREEMENT(RoughRefractions, rough_refractions);
SPC_AGREEMENT(RoughChains, rough_reliefs_and_a_ball);

}  // namespace spc::test
