// SPDX-License-Identifier: GPL-3.0-or-later
// Chains with rough vertices by the manifold alone.
#include "agreement/chain_scenes.h"

namespace spc::test {
namespace {

const Claim kByWalks = alone(kManifold, 1875), kBySheets = alone(kSheetsAlone, 5000),
            kByManySheets = alone(kSheetsAlone, 10000);

// Roughness 0.2 and 0.15: lobes of 0.04 and 0.0225 rad.
const Graph kMetal = mirror(0.2f), kFrosted = refraction(1.4f, 0.15f);
Graph beckmann(Graph graph) {
    graph.options.push_back({1, "distribution", "BECKMANN"});
    return graph;
}

using Build = std::function<void(SceneMaker&, Reliefs)>;
Row row_of(const char* name, const Claim& claim, const std::function<void(SceneMaker&)>& build,
           float lamp_radius = 0.3f) {
    ChainScene scene{name, 1, [build](SceneMaker& m, Reliefs) { build(m); }};
    scene.lamp_radius = lamp_radius;
    return chain_row(scene, {}, {claim});
}
void add_pane(SceneMaker& maker, float z, const Graph& graph) {
    add_surface(maker, 2.5f, graph, translation({0, 0, z}));
}
// Whose back is above.
void add_pane_over_glass(SceneMaker& maker, float z, const Graph& graph) {
    add_surface(maker, 2.5f, graph, rotation_x(kPi, {0, 0, z}));
}

Table reflections() {
    const auto off = [](const Graph& graph) {
        return [graph](SceneMaker& m) { add_mirror(m, Relief::none, graph); };
    };
    const auto by_pane = [](const Graph& wall, const Graph& pane) {
        return [=](SceneMaker& m) {
            add_mirror(m, Relief::none, wall);
            add_pane_over_mirror(m, pane);
        };
    };
    return {{row_of("rough R", kByWalks, off(kMetal)),
             row_of("rough R, Beckmann", kByWalks, off(beckmann(kMetal))),
             // What its diffuse part scatters is path tracing's.
             row_of("rough R of a mixture", kByWalks, off(combined(kMetal, diffuse(0.7f), 0.5f))),
             // Half of the light passes the pane straight on.
             row_of("rough R behind a pane", kBySheets,
                    [](SceneMaker& m) {
                        add_mirror(m, Relief::none, kMetal);
                        add_pane_before_mirror(m, combined(kMetal, transparent(1.0f), 0.5f));
                    }),
             // Next event estimation finds lights without size at rough vertices.
             row_of("rough R of a point", kByWalks, off(kMetal), 0.0f),
             row_of("rough T, rough R, rough T", kBySheets,
                    [](SceneMaker& m) {
                        add_mirror(m, Relief::none, kMetal);
                        add_pane_before_mirror(m, kFrosted);
                    }),
             row_of("rough R, T", kBySheets, by_pane(kMetal, refraction(1.3f))),
             row_of("R, rough T", kBySheets, by_pane(mirror(), refraction(1.3f, 0.15f))),
             row_of("rough R, rough T", kBySheets, by_pane(kMetal, refraction(1.3f, 0.15f)))}};
}

Table refractions() {
    const auto through = [](const Graph& graph) {
        return [graph](SceneMaker& m) { add_pane(m, 0.7f, graph); };
    };
    const auto pair = [](const Graph& below, const Graph& above) {
        return [=](SceneMaker& m) {
            add_pane_over_glass(m, 0.6f, below);
            add_pane(m, 0.8f, above);
        };
    };
    const Graph clear = refraction(1.4f);
    Row under_a_sun = row_of("rough T", kBySheets, through(refraction(1.4f, 0.28f)));
    under_a_sun.light = light("sun without a disc", lamp(LightType::sun, 100.0f));
    return {{row_of("rough T", kBySheets, through(kFrosted)),
             row_of("rough T, Beckmann", kBySheets, through(beckmann(kFrosted))),
             row_of("rough T, T", kBySheets, pair(kFrosted, clear)),
             row_of("rough T, T, Beckmann", kBySheets, pair(beckmann(kFrosted), clear)),
             row_of("rough T, rough T, Beckmann", kBySheets,
                    pair(beckmann(kFrosted), beckmann(kFrosted))),
             row_of("T, rough T", kBySheets, pair(clear, kFrosted), 0.2f), under_a_sun}};
}

Table pairs_of_slabs() {
    const auto slabs = [](const std::array<Graph, 4>& from_below) {
        return [=](SceneMaker& m) {
            for (size_t i = 0; i < 4; i += 2) {
                const float z = 0.3f + 0.25f * float(i);
                add_pane_over_glass(m, z, from_below[i]);
                add_pane(m, z + 0.2f, from_below[i + 1]);
            }
        };
    };
    constexpr float kLamp = 0.2f;
    const Graph clear = refraction(1.4f), frosted = refraction(1.4f, 0.12f);
    return {{row_of("rough T, T, T, T", kBySheets, slabs({frosted, clear, clear, clear}), kLamp),
             row_of("T, T, rough T, T", kBySheets, slabs({clear, clear, frosted, clear}), kLamp),
             row_of("four times rough T", kBySheets, slabs({frosted, frosted, frosted, frosted}),
                    kLamp)}};
}

Table ball() {
    ChainScene scene{"rough ball", 1, [](SceneMaker& m, Reliefs) {
                         add_for_light(m, sphere(32, 0.5),
                                       combined(kMetal, refraction(1.5f, 0.2f), 0.5f),
                                       translation({0.0f, 0.9f, 0.6f}));
                     }};
    scene.lamp = {0.1f, -0.4f, 1.3f};
    return {{chain_row(scene, {}, {kBySheets})}};
}

Table reliefs() {
    const auto mapped = [](const char* name, const Claim& claim, const Build& build,
                           Relief relief = Relief::normals) {
        return chain_row({name, 1, build}, {relief}, {claim});
    };
    const Build mirror_alone = [](SceneMaker&m, Reliefs r) { add_mirror(m, r.one, kMetal); },
                pane_alone = [](SceneMaker&m, Reliefs r) {
                    add_surface(m, 2.5f, beckmann(kFrosted), translation({0, 0, 0.7f}), r.one);
                };
    return {{mapped("rough R", kByWalks, mirror_alone),
             mapped("rough R", kByWalks, mirror_alone, Relief::heights),
             mapped("rough T, Beckmann", kBySheets, pane_alone),
             mapped("rough T, Beckmann", kBySheets, pane_alone, Relief::heights),
             mapped("rough T, R, rough T", kByManySheets,
                    [](SceneMaker& m, Reliefs r) {
                        add_mirror(m, r.others);
                        add_pane_before_mirror(m, kFrosted, r.one);
                    }),
             mapped("T, rough T", kByManySheets, [](SceneMaker& m, Reliefs r) {
                 add_surface(m, 2.5f, kFrosted, translation({0, 0, 0.8f}), r.one);
                 add_surface(m, 2.5f, refraction(1.4f), rotation_x(kPi, {0, 0, 0.6f}), r.others);
             })}};
}

}  // namespace

SPC_AGREEMENT(RoughReflections, reflections);
SPC_AGREEMENT(RoughRefractions, refractions);
SPC_AGREEMENT(RoughSlabs, pairs_of_slabs);
SPC_AGREEMENT(RoughBalls, ball);
SPC_AGREEMENT(RoughReliefs, reliefs);

}  // namespace spc::test
