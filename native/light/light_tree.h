// SPDX-License-Identifier: GPL-3.0-or-later
// Which light to sample from a receiver: by how much of its light may come there, after [Conty18].
// Lights with a place are the leaves of a tree, whose nodes bound where they stand and where they
// shine to; distant ones are chosen by their irradiance. What stands in the way is not known, so a
// share of the choice is even.
#pragma once

#include "core/distribution.h"
#include "light/lamp.h"

#include <span>
#include <vector>

namespace spc {

// A point to be lit. `n` is unit, on the side that light may come to; zero: both are.
struct LitPoint {
    Vec3 p, n;

    LitPoint(const Vec3& point, const Vec3& normal = Vec3(0.0f)) : p(point), n(normal) {}
};

// Of one light, or a part of it, as the choice sees it.
struct LightReach {
    bool distant = false;
    // Luminance: W/sr where it shines brightest; distant: W/m^2. 0: never chosen.
    float strength = 0.0f;
    // Of a sphere around it; distant: unit, towards it, or zero for what is all around.
    Vec3 center{0.0f};
    float radius = 0.0f;
    LampBeam beam{Vec3(0, 0, 1), 2.0f};
    bool cosine = false;  // falls with the cosine of the angle to the beam's axis
    float even = 1.0f;    // of the even choice: a light's share of it, over its parts
};

class LightTree {
public:
    LightTree() = default;
    explicit LightTree(std::span<const LightReach> lights);

    bool empty() const { return evenly_.empty(); }
    struct Sample {
        uint32_t light;
        float probability;
    };
    // Not of an empty tree.
    Sample sample(const LitPoint& at, float u) const;
    float probability(uint32_t light, const LitPoint& at) const;

private:
    struct Node {
        LightReach reach;  // of all lights below
        uint32_t parent = kNone, left = kNone, right = kNone;
        uint32_t light = kNone;  // of a leaf

        float importance(const LitPoint& at) const;
    };
    struct Distant {
        LightReach reach;
        uint32_t light;

        float importance(const LitPoint& at) const;
    };
    using Leaves = std::span<Node>;
    uint32_t build(Leaves leaves);
    float distant_importance(const LitPoint& at) const;
    float share_of_left(const Node& node, const LitPoint& at) const;
    float share_below_root(uint32_t leaf, const LitPoint& at) const;

    DiscreteDistribution evenly_;
    uint32_t only_ = kNone;  // the light, if there is one alone
    std::vector<Distant> distant_;
    std::vector<Node> nodes_;  // children before parents, the root last
    // Of every light: its node, or its place among the distant ones; kNone elsewhere.
    std::vector<uint32_t> leaf_of_, distant_of_;
};

}  // namespace spc
