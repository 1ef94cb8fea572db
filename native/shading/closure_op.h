// SPDX-License-Identifier: GPL-3.0-or-later
// The terms that a surface is made of, one row each: which operands they have and what light does
// there. Compilation, the search for casters and for glints read the row; the closures of a term
// are built in evaluate.cpp.
#pragma once

#include <array>

#include "bsdf/closure.h"

namespace spc {

enum class ClosureOp : uint8_t {  // operands after weight and normal
    lambert,                      // colour
    rough_diffuse,                // colour, roughness
    translucent,                  // colour
    sheen,                        // colour, roughness
    velvet,                       // colour, sigma
    burley_diffuse,               // colour, roughness
    schlick_sheen,                // colour
    diffuse_toon,                 // colour, plateau, fade
    glossy_toon,                  // colour, plateau, fade
    transparent,                  // colour
    holdout,                      // none
    glossy,                       // alpha, colour
    ashikhmin_shirley,            // alpha, colour
    metal,                        // alpha, colour at normal incidence, tint at 82 degrees
    conductor,                    // alpha, index, extinction
    dielectric,  // alpha, index of a front face, tints of reflection, transmission, normal incidence
    coated,  // alpha, index, reflectance at normal incidence, colour and roughness below: a dielectric's reflection over
             // rough_diffuse
    hair_fibre,         // tangent, absorption, roughness along and around, coat, index, tilt
    hair_reflection,    // colour, tangent, roughness along and around, offset
    hair_transmission,  // likewise
    coat,               // alpha, index: the reflection of what lies over other terms
    count
};

// Operands of every term: its weight, a scalar, and its normal; without one it is the interpolated
// one.
inline constexpr int kWeightOperand = 0, kNormalOperand = 1;

// A part of a term that scatters light in one way: the operand that colours it, and without which
// there is none.
inline constexpr int8_t kAbsent = -1;    // the term has no such part
inline constexpr int8_t kUncolored = 0;  // the part is always there

struct ClosureOpTraits {
    ClosureOp op;
    uint8_t arity;
    uint8_t closures = 1;                   // most entries of a ClosureList
    int8_t alpha = kAbsent, ior = kAbsent;  // operands
    int8_t diffuse = kAbsent;               // what goes anywhere, without facets
    int8_t diffuse_roughness = kAbsent;
    int8_t straight = kAbsent;
    bool holds_out = false;  // a hole in the picture
    // What facets do, around a normal and by an alpha: a delta where that is 0, on which chains
    // turn.
    int8_t reflection = kAbsent, refraction = kAbsent;
    bool matched_index_is_black = false;  // an index of 1 reflects nothing
    bool weak = false;          // beside what lies below: it throws no blurred caustics of its own
    bool may_glint = false;     // where its normal comes from a map
    bool other_facets = false;  // than those of microfacet.h: chains turn there only at a delta

    constexpr bool has_facets() const { return alpha != kAbsent; }
};

inline constexpr std::array<ClosureOpTraits, static_cast<size_t>(ClosureOp::count)> kClosureOpTraits{{
    {.op = ClosureOp::lambert, .arity = 3, .diffuse = 2},
    {.op = ClosureOp::rough_diffuse, .arity = 4, .diffuse = 2, .diffuse_roughness = 3},
    {.op = ClosureOp::translucent, .arity = 3, .diffuse = 2},
    {.op = ClosureOp::sheen, .arity = 4, .diffuse = 2},
    {.op = ClosureOp::velvet, .arity = 4, .diffuse = 2},
    {.op = ClosureOp::burley_diffuse, .arity = 4, .diffuse = 2},
    {.op = ClosureOp::schlick_sheen, .arity = 3, .diffuse = 2},
    {.op = ClosureOp::diffuse_toon, .arity = 5, .diffuse = 2},
    {.op = ClosureOp::glossy_toon, .arity = 5, .diffuse = 2},
    {.op = ClosureOp::transparent, .arity = 3, .straight = 2},
    {.op = ClosureOp::holdout, .arity = 2, .closures = 0, .holds_out = true},
    {.op = ClosureOp::glossy, .arity = 4, .alpha = 2, .reflection = 3, .may_glint = true},
    {.op = ClosureOp::ashikhmin_shirley, .arity = 4, .alpha = 2, .reflection = 3, .other_facets = true},
    // Black at normal incidence it still reflects at grazing angles.
    {.op = ClosureOp::metal, .arity = 5, .alpha = 2, .reflection = kUncolored, .may_glint = true},
    {.op = ClosureOp::conductor, .arity = 5, .alpha = 2, .reflection = kUncolored, .may_glint = true},
    {.op = ClosureOp::dielectric, .arity = 7, .alpha = 2, .ior = 3, .reflection = 4, .refraction = 5},
    {.op = ClosureOp::coated,
     .arity = 7,
     .closures = 2,
     .alpha = 2,
     .ior = 3,
     .diffuse = 5,
     .diffuse_roughness = 6,
     .reflection = kUncolored,
     .matched_index_is_black = true,
     .weak = true,
     .may_glint = true},
    {.op = ClosureOp::hair_fibre, .arity = 9, .diffuse = kUncolored},
    {.op = ClosureOp::hair_reflection, .arity = 7, .diffuse = 2},
    {.op = ClosureOp::hair_transmission, .arity = 7, .diffuse = 2},
    {.op = ClosureOp::coat,
     .arity = 4,
     .alpha = 2,
     .ior = 3,
     .reflection = kUncolored,
     .matched_index_is_black = true,
     .weak = true,
     .may_glint = true},
}};

inline constexpr const ClosureOpTraits& traits(ClosureOp op) {
    return kClosureOpTraits[static_cast<size_t>(op)];
}

static_assert(
    [] {
        for (size_t i = 0; i < kClosureOpTraits.size(); ++i)
            if (kClosureOpTraits[i].op != static_cast<ClosureOp>(i)) return false;
        return true;
    }(),
    "rows stand in the order of ClosureOp");

}  // namespace spc
