// SPDX-License-Identifier: GPL-3.0-or-later
// Light sheets: all chains between a receiver and one point of a light, without random walks.
//
// For one light point a chain of any length maps two coordinates at the light to a point on a
// receiver. So a grid of rays is traced once from the light through the casters. Its cells become
// triangles on the receivers, and the triangles around a point tell which chains lead to it.
// [Watt90] and [Nishita94] shaded with such beams; here each is a seed, and a shot finds the chain
// exactly.
#pragma once

#include "manifold/beams.h"
#include "manifold/prism_tree.h"

namespace spc {

// The part of the last caster from the light on where the chains of a beam at a fold leave it: a
// corner and two edges, world, m.
struct FoldParallelogram {
    Vec3 p, e1, e2;
};
struct HalfSpace {
    Vec3 normal;
    float upper;
    bool holds(const Vec3& p) const { return dot(normal, p) <= upper; }
};
// A chain seed from a beam: a chain kind and the direction at the receiver from which to shoot.
struct SheetSeed {
    const ChainKind* kind;
    Vec3 w;
    float probability;  // that a query returns this seed
    // `inside`: x lies between the beam's three rays, not in its margin. `positive`: sign that
    // ChainSolution::determinant has for the beam's chains, from the orientation of its rays.
    bool inside, positive;
    std::array<uint32_t, 3> edges;
};
// Whether `chain_seed`, from a beam's margin, is redundant beside `other`, from inside a
// neighbouring beam.
bool repeats(const SheetSeed& chain_seed, const SheetSeed& other);

// The shift from a sheet's light point to another point of the same light: m or, for distant
// lights, a difference of directions.
Vec3 shift_between(const LightPoint& from, const LightPoint& to);

class LightSheet {
public:
    // Builds a sheet of about `emission_cells` cells, which are smaller where the rays' fates vary
    // most. `reach`: length of the longest shift for which it will be asked (see shift_between()).
    // `around`: some light points within reach. If one of them sees a caster that y does not, the
    // sheet covers that part, too, so that penumbras have seeds. Once the budget is cancelled the
    // sheet is of no use.
    LightSheet(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells, float reach,
               std::span<const LightPoint> around = {});

    const LightPoint& light_point() const { return y_; }
    uint64_t rays() const { return all_.rays; }  // number of rays that building it took
    // Appends the seeds of the beams that hold x, those from margins last. A seed's probability is
    // the beam's density times `probability_per_density`, less in margins, within bounds. One
    // uniform number u decides for all seeds, so a chain that several seeds find has the largest of
    // their probabilities. `shift`: from the sheet's light point to that of the chains.
    void find_seeds(const Vec3& x, const Vec3& shift, float probability_per_density, float u,
                    std::vector<SheetSeed>& chain_seeds) const;
    // Directions at x towards the three rays of the seed's beam, to try if the seed itself finds
    // nothing.
    std::array<Vec3, 3> directions_around(const SheetSeed& chain_seed, const Vec3& x,
                                          const Vec3& shift) const;
    // Draws points where beams landed, in proportion to their light.
    std::vector<Vec3> lit_points(uint32_t count, Pcg& pcg) const;
    // Appends the parallelograms of beams at folds and at ends of the sheet that hold x for any
    // light point within reach. False if there would be more than `most`.
    bool find_folds(const Vec3& x, size_t most,
                    std::vector<const FoldParallelogram*>& parallelograms) const;

private:
    // A beam as the trees hold it, either its inside or its margin.
    struct Entry {
        Beam beam;
        bool inside;
        float density() const;
    };
    // Entries of similar density. Weak beams fill large volumes, which most queries may skip.
    struct Layer {
        float density;               // the largest
        std::vector<Entry> entries;  // in the tree's order
        PrismTree tree;
    };
    struct Fold {
        FoldParallelogram parallelogram;
        std::array<HalfSpace, 5> sides;  // bound where its beam may move
    };
    void build_layers(float reach, const SheetWorld& world);
    // Call before build_layers(), which moves the beams away.
    void build_folds(float reach, const Budget& budget);
    void add_seed(const Entry& entry, const Vec3& x, const Vec3& shift,
                  float probability_per_density, float u, std::vector<SheetSeed>& chain_seeds) const;

    const LightPoint y_;
    BeamSet all_;
    std::vector<Layer> layers_;
    std::vector<Fold> folds_;  // in the tree's order
    PrismTree fold_tree_;
};

}  // namespace spc
