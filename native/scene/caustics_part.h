// SPDX-License-Identifier: GPL-3.0-or-later
// What part an object has in caustics, by its materials, its role and its visibility alone.
#pragma once

#include "scene/description.h"

namespace spc {

struct CausticsPart {
    bool caster = false;        // throws caustics by deltas
    bool rough_caster = false;  // throws blurred ones by narrow lobes
    bool receiver = false;
    // Whether chains with rough vertices turn at it: at its facets, or only if its normal map turns
    // out to be coarse.
    bool chains_turn = false, chains_may_turn = false;
    std::string why, why_rough;  // a lobe by which it is either
    // Why not: empty if every material casts by deltas, or if the role rules casting out.
    std::string why_not;

    bool casts() const { return caster || rough_caster; }
};

CausticsPart caustics_part(std::span<const Material* const> materials, CausticsRole role,
                           uint32_t visibility);

}  // namespace spc
