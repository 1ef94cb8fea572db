// SPDX-License-Identifier: GPL-3.0-or-later
// Every kind of chain by the manifold alone, on smooth casters and on maps.
#include "agreement/chain_scenes.h"

#include <set>
#include <stdexcept>

namespace spc::test {
namespace {

const Claim kByWalks = alone(kManifold, 3750), kBySheets = alone(kSheetsAlone, 940),
            kByManySheets = alone(kSheetsAlone, 2500);

// Those of the scenes that are named.
std::vector<Row> rows(const std::set<std::string>& names, Reliefs reliefs, const Claim& claim) {
    std::vector<Row> rows;
    for (const ChainScene& scene : chain_scenes())
        if (names.contains(scene.name)) rows.push_back(chain_row(scene, reliefs, {claim}));
    if (rows.size() != names.size()) throw std::invalid_argument("no chain scene of that name");
    return rows;
}
Table table_of(std::initializer_list<std::vector<Row>> parts) {
    Table table;
    for (const std::vector<Row>& rows : parts)
        table.rows.insert(table.rows.end(), rows.begin(), rows.end());
    return table;
}

// Of longer chains walks leave most light to path tracing, where it finds the lamp.
Table smooth() {
    Table table;
    for (const ChainScene& scene : chain_scenes())
        table.rows.push_back(chain_row(
            scene, {},
            scene.interactions == 1 ? std::vector{kByWalks, kBySheets} : std::vector{kBySheets}));
    return table;
}
Table mapped() {
    constexpr Reliefs kOne{Relief::normals}, kOthers{Relief::none, Relief::normals},
        kAllOfThem{Relief::normals, Relief::normals};
    Table table = table_of({rows({"RT", "TT", "TRT", "TTTT"}, kOne, kBySheets),
                            rows({"RT", "TRT"}, kOthers, kByManySheets),
                            rows({"RT", "TT", "TTTT"}, kAllOfThem, kByManySheets)});
    for (Row& row : rows({"R", "T"}, kOne, kByWalks)) {
        row.claims.push_back(kBySheets);
        table.rows.push_back(row);
    }
    return table;
}
Table bumped() {
    constexpr Reliefs kOne{Relief::heights}, kAllOfThem{Relief::heights, Relief::heights};
    Table table =
        table_of({rows({"RT", "TT"}, kOne, kBySheets), rows({"TT"}, kAllOfThem, kBySheets)});
    for (Row& row : rows({"R", "T"}, kOne, kByWalks)) {
        row.claims.push_back(kBySheets);
        table.rows.push_back(row);
    }
    return table;
}

// Beside strong waves directions next to folds bring a sixth of the light. Walks, which know of no
// folds, tell whether it is all.
Table folds() {
    return {{{.casters = {"strong waves",
                          [](SceneMaker& maker) {
                              maker.builder.add_image(plane_normals(128, 0.25, 0.1, 5));
                              add_caster(maker, square(0.8f),
                                         normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
                                         rotation_x(1.3f, {0.0f, 0.9f, 0.8f}));
                          }},
              .light = bulb("", {0.3f, -1.2f, 2.6f}, 0.05f),
              .camera = camera_above(0.5f),
              .reference = {25000, kManifold},
              .claims = {{kSheetsAlone, 3125, 0.1, 0.25}}}}};
}

}  // namespace

SPC_AGREEMENT(Chains, smooth);
SPC_AGREEMENT(MappedChains, mapped);
SPC_AGREEMENT(BumpedChains, bumped);
SPC_AGREEMENT(Folds, folds);

}  // namespace spc::test
