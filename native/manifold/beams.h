// SPDX-License-Identifier: GPL-3.0-or-later
// Rays from one point of a light through the casters to receivers, and what lies between them.
#pragma once

#include "core/budget.h"
#include "manifold/emission.h"
#include "manifold/shooting.h"

namespace spc {

// What sheets are made of.
struct SheetWorld {
    const Scene& scene;
    const LightSet& lights;
    const CasterSet& casters;
    const EmissionGuide& guide;
    uint32_t longest_chain;
    uint32_t threads;  // that build one; 0: all
    // Of all sheets; one takes so many rays at most, up to what its first emission cells and a round need.
    const Budget& budget;
    double most_rays = std::numeric_limits<double>::infinity();
};

// A ray behind its last caster.
struct BeamEdge {
    Vec3 last;    // vertex on that caster
    Vec3 d;       // unit direction behind it
    Vec3 landed;  // on a receiver
    // By how much both move as the light point does, while the ray keeps to the point where it met its
    // first caster: columns, per m of the light point or, for a distant light, per unit of its
    // direction.
    std::array<Vec3, 3> last_moved, landed_moved;
};
// Three rays of one kind of chain that are neighbours at the light.
struct Beam {
    std::array<uint32_t, 3> edges;
    uint32_t kind;
    float margin;  // in barycentrics, by which it reaches beyond its rays
    float depth;   // m along the rays, before and behind where they landed
    // Light in it, by area across it where it landed: about what irradiance, for a light point of unit
    // density, it gives.
    float density;
};
struct BeamSet {
    std::vector<BeamEdge> edges;
    std::vector<Beam> beams;
    std::vector<ChainKind> kinds;  // from the receiver on
    uint64_t rays = 0;
};
// Of some `emission_cells` parts of the light's unit square, which are smaller where what becomes of the rays
// varies most. `around`: see LightSheet.
BeamSet trace_beams(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells,
                    std::span<const LightPoint> around);

}  // namespace spc
