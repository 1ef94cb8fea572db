// SPDX-License-Identifier: GPL-3.0-or-later
// Light sheets: all chains between a receiver and one point of a light, without random walks.
//
// For one light point a chain of any length maps two coordinates at the light to a point on a
// receiver. So a grid of rays is traced from the light through the casters once; its cells become
// triangles on the receivers, one sheet of them for each kind of chain, and the triangles around a
// point tell which chains lead to it ([Watt90], [Nishita94] traced beams so, to shade with). Here
// each is the start of a shot that finds the chain exactly.
#pragma once

#include "manifold/beams.h"
#include "manifold/prism_tree.h"

namespace spc {

// A part of the last caster, as seen from the light, where chains of a beam at a fold meet it: a corner,
// and the edges from there.
struct FoldParallelogram {
    Vec3 p, e1, e2;
};
struct HalfSpace {
    Vec3 normal;
    float upper;
    bool holds(const Vec3& p) const { return dot(normal, p) <= upper; }
};
// A chain that may exist, and the direction at the receiver in which to look for it.
struct SheetSeed {
    const ChainKind* kind;
    Vec3 w;
    float probability;  // that a query has this chain seed
    // Of the beam that gave it: x lies between its rays themselves; the sign of the determinant that
    // chains in it have, by how the rays turn around it.
    bool inside, positive;
    std::array<uint32_t, 3> edges;
};
// Whether `chain_seed`, which is beside its beam, says no more than `other`, inside a neighbour of that
// beam.
bool repeats(const SheetSeed& chain_seed, const SheetSeed& other);

// From the point of one sheet to another point of its light.
Vec3 shift_between(const LightPoint& from, const LightPoint& to);

class LightSheet {
public:
    // Of some `emission_cells` parts, which are smaller where what becomes of the rays varies most. `reach`:
    // how far from y light points may lie whose chains it is asked for, m or, of a distant light, as
    // a difference of directions. `around`: some of those. Where something stands between y and a
    // caster, but not between one of them and the caster, its penumbra is part of the sheet.
    LightSheet(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells, float reach,
               std::span<const LightPoint> around = {});

    const LightPoint& light_point() const { return y_; }
    uint64_t rays() const { return all_.rays; }  // that it took
    // The beams that x lies in or, by their margin, next to. Each is there with a probability: its density
    // times `probability_per_density`, less where x is beside it, within bounds; u, uniform, decides for all of them. So
    // the probability of a chain to which several lead is the largest of theirs. Those that x lies in come
    // first. `shift`: from the sheet's light point to that of the chains.
    void find_seeds(const Vec3& x, const Vec3& shift, float probability_per_density, float u,
                    std::vector<SheetSeed>& chain_seeds) const;
    // Those of the three rays of the chain seed's beam, where the chain seed itself does not lead to a chain.
    std::array<Vec3, 3> directions_around(const SheetSeed& chain_seed, const Vec3& x,
                                          const Vec3& shift) const;
    // Points where beams landed, drawn in proportion to the light that they brought there.
    std::vector<Vec3> lit_points(uint32_t count, Pcg& pcg) const;
    // Adds the parallelograms of beams at folds and ends that x lies in for any light point within reach.
    // False where that makes more than `most`.
    bool find_folds(const Vec3& x, size_t most,
                    std::vector<const FoldParallelogram*>& parallelograms) const;

private:
    // Where to look at a beam: for what lies inside it, or beside it within its margin.
    struct Entry {
        Beam beam;
        bool inside;
        float density() const;
    };
    // Entries of similar density: weak ones spread over large volumes, in which most queries need
    // not look.
    struct Layer {
        float density;               // the largest
        std::vector<Entry> entries;  // in the tree's order
        PrismTree tree;
    };
    struct Fold {
        FoldParallelogram parallelogram;
        std::array<HalfSpace, 5> sides;  // of where its beam may go
    };
    void build_layers(float reach, uint32_t threads);
    // Before build_layers(), which takes the beams.
    void build_folds(float reach);
    void add_seed(const Entry& entry, const Vec3& x, const Vec3& shift,
                  float probability_per_density, float u, std::vector<SheetSeed>& chain_seeds) const;

    const LightPoint y_;
    BeamSet all_;
    std::vector<Layer> layers_;
    std::vector<Fold> folds_;  // in the tree's order
    PrismTree fold_tree_;
};

}  // namespace spc
