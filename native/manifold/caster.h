// SPDX-License-Identifier: GPL-3.0-or-later
// The casters of a scene as the manifold sees them, and the choice of one for an estimate.
#pragma once

#include "core/random.h"
#include "manifold/chain.h"

#include <span>

namespace spc {

struct Caster {
    uint32_t instance;
    Vec3 center;  // of bounding box and sphere, world, m
    Vec3 half_extent;
    float radius;
    bool mapped_normal;
    DiscreteDistribution triangles;  // by area, those of specular materials alone: where seeds start
    // Slopes of the mapped normal over the smooth one, in Frame::around(smooth normal): mean and
    // standard deviation [Olano10], for the first of two stages.
    Vec2 slope_mean{0.0f}, slope_deviation{0.0f};
    double slope_bends = 0.0;  // 1/m^2: mean |det d slope / d p| of the map; 0 without one
};

// Spheres and boxes around several casters, by lanes: what choose_caster() looks at of each.
struct CasterPacket {
    static constexpr uint32_t kWidth = 4;
    using Lanes = float __attribute__((vector_size(4 * kWidth)));
    Lanes center[3]{}, half_extent[3]{}, squared_radius{};
    Lanes used{};  // 1 or 0
};

struct CasterSet {
    std::vector<Caster> casters;
    std::vector<CasterPacket> packets;  // of `casters`, in their order
    std::vector<uint32_t> of_instance;  // index into `casters`, or kNone
    // With narrow lobes: nothing to walk on, but light paths aim at them, too. An instance may be
    // both.
    std::vector<Caster> rough;
    bool empty() const { return casters.empty(); }
    std::vector<const Caster*> aims() const;
};
CasterSet build_casters(const Scene& scene);
// All of them but those that are left out; those with narrow lobes stay.
CasterSet without(const CasterSet& casters, const std::vector<bool>& left_out);
// Those, and what has a rough interface, if anything has: where chains with rough vertices turn. Not
// where a fine map makes too many chains. The report tells of maps.
CasterSet build_rough_chain_casters(const Scene& scene, std::vector<std::string>& report);

// A point uniform over the caster's specular area.
SurfaceHit sample_on(const Caster& caster, Pcg& pcg);

// A direction uniform in the cone in which x sees the caster's bounding sphere.
Vec3 towards_caster(const Caster& caster, const Vec3& x, const Vec2& u);

// Where light can arrive at a receiver.
struct ReceiverSides {
    Vec3 ng;
    bool below;  // from below the horizon of `ng` too: the receiver transmits smoothly
};

// Probability that an estimate at x towards `end` walks on each caster: in proportion to a bound of the
// light that the caster can throw at x, with a floor so that no caster that may contribute is ever
// left out. Casters wholly below a horizon that counts get zero: they contribute nothing.
struct CasterChoice {
    uint32_t index = kNone;  // kNone: no caster can contribute
    float probability = 0.0f;
};
CasterChoice choose_caster(const CasterSet& set, const Vec3& x, const ReceiverSides& sides,
                           const ChainEnd& end, float u);
float caster_probability(const CasterSet& set, uint32_t caster, const Vec3& x,
                         const ReceiverSides& sides, const ChainEnd& end);

}  // namespace spc
