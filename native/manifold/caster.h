// SPDX-License-Identifier: GPL-3.0-or-later
// The casters of a scene as the manifold sees them, and how an estimate chooses one.
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
    DiscreteDistribution triangles;  // by area; those of specular materials alone, where seeds lie
    // Mean and standard deviation of the slopes of the mapped normal in Frame::around(smooth
    // normal) [Olano10], for the first of two stages.
    Vec2 slope_mean{0.0f}, slope_deviation{0.0f};
    double slope_bends = 0.0;  // 1/m^2: mean |det d slope / d p| of the map; 0 without one
};

// Bounds of several casters side by side, for choose_caster().
struct CasterPacket {
    static constexpr uint32_t kWidth = 4;
    using Lanes = float __attribute__((vector_size(4 * kWidth)));
    Lanes center[3]{}, half_extent[3]{}, squared_radius{};
    Lanes used{};  // 1 for a caster, 0 for padding
};

struct CasterSet {
    std::vector<Caster> casters;
    std::vector<CasterPacket> packets;  // of `casters`, in their order
    std::vector<uint32_t> of_instance;  // index into `casters`, or kNone
    // Rough casters: walks do not use them, but light paths aim at them. An instance may be both.
    std::vector<Caster> rough;
    bool empty() const { return casters.empty(); }
    std::vector<const Caster*> aims() const;
};
CasterSet build_casters(const Scene& scene);
// The set without the casters that are left out. Rough casters stay.
CasterSet without(const CasterSet& casters, const std::vector<bool>& left_out);
// Casters at which rough chains turn: all with a specular or a rough interface, or none if no
// interface is rough. Casters whose fine map would make too many chains are left out and named in
// the report.
CasterSet build_rough_chain_casters(const Scene& scene, std::vector<std::string>& report);

// Draws a point uniformly over the caster's specular area.
SurfaceHit sample_on(const Caster& caster, Pcg& pcg);

// Maps u in [0, 1)^2 to a direction uniform in the cone in which x sees the caster's bounding
// sphere.
Vec3 towards_caster(const Caster& caster, const Vec3& x, const Vec2& u);

// The sides on which light can arrive at a receiver.
struct ReceiverSides {
    Vec3 ng;
    bool below;  // the receiver transmits smoothly, so light may also arrive from behind `ng`
};

// Chooses the caster for an estimate at x towards `end`, in proportion to a bound of the light that
// the caster can throw at x. A floor keeps every caster that may contribute; casters wholly below
// the receiver's horizon cannot and get zero.
struct CasterChoice {
    uint32_t index = kNone;  // kNone: no caster can contribute
    float probability = 0.0f;
};
CasterChoice choose_caster(const CasterSet& set, const Vec3& x, const ReceiverSides& sides,
                           const ChainEnd& end, float u);
float caster_probability(const CasterSet& set, uint32_t caster, const Vec3& x,
                         const ReceiverSides& sides, const ChainEnd& end);

}  // namespace spc
