// SPDX-License-Identifier: GPL-3.0-or-later
// Beams: rays from one point of a light through the casters to receivers, joined to triangles.
#pragma once

#include "core/budget.h"
#include "manifold/emission.h"
#include "manifold/shooting.h"

namespace spc {

// What building light sheets needs.
struct SheetWorld {
    const Scene& scene;
    const LightSet& lights;
    const CasterSet& casters;
    const EmissionGuide& guide;
    uint32_t longest_chain;
    uint32_t threads;  // threads that build one sheet; 0: all
    // `budget` is that of all sheets. One sheet takes `most_rays` at most, or a little more to
    // finish its first emission cells or a round of splits.
    const Budget& budget;
    double most_rays = std::numeric_limits<double>::infinity();
};

// A ray behind its last caster.
struct BeamEdge {
    Vec3 last;    // vertex on that caster
    Vec3 d;       // unit direction behind it
    Vec3 landed;  // on a receiver
    // Derivatives of both points by the light point, as columns, while the ray's first vertex is
    // held. Per m or, for a distant light, per unit of its direction.
    std::array<Vec3, 3> last_moved, landed_moved;
};
// Three rays of one chain kind that are neighbours in the grid at the light.
struct Beam {
    std::array<uint32_t, 3> edges;
    uint32_t kind;
    float margin;  // by how much it extends beyond its rays, in barycentrics
    float depth;   // how far it extends along the rays, before and behind where they landed, m
    // Its light over the area across it where it landed: about the irradiance that a light point of
    // unit density gives.
    float density;
};
struct BeamSet {
    std::vector<BeamEdge> edges;
    std::vector<Beam> beams;
    std::vector<ChainKind> kinds;  // from the receiver on
    uint64_t rays = 0;
};
// Traces a grid of rays in each of about `emission_cells` parts of the light's unit square, which
// are smaller where the rays' fates vary most. `around`: see LightSheet.
BeamSet trace_beams(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells,
                    std::span<const LightPoint> around);

}  // namespace spc
