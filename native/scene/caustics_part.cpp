// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/caustics_part.h"

namespace spc {

CausticsPart caustics_part(std::span<const Material* const> materials, CausticsRole role,
                           uint32_t visibility) {
    CausticsPart part;
    // Chains stand for paths of scattered rays: what hides from those casts nothing.
    const bool seen = (visibility & kVisibleScattered) == kVisibleScattered;
    const bool asked = role == CausticsRole::automatic || role == CausticsRole::caster ||
                       role == CausticsRole::both;
    const bool may_cast = asked && seen;
    const bool may_receive = role == CausticsRole::automatic || role == CausticsRole::receiver ||
                             role == CausticsRole::both;
    if (asked && !seen) part.why_not = "hidden from diffuse, glossy or transmission rays";
    for (const Material* material : materials) {
        const bool specular = material->specular.exists();
        part.caster |= may_cast && specular;
        part.rough_caster |= may_cast && !material->narrow_lobe.empty();
        part.receiver |= may_receive && material->has_smooth;
        if (specular && part.why.empty()) part.why = material->specular.why;
        if (asked && !specular && part.why_not.empty()) part.why_not = material->specular.why_not;
        if (part.why_rough.empty()) part.why_rough = material->narrow_lobe;
        if (material->rough.exists())
            (material->rough.mapped_normal ? part.chains_may_turn : part.chains_turn) = true;
    }
    return part;
}

}  // namespace spc
