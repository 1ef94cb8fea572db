// SPDX-License-Identifier: GPL-3.0-or-later
// Which light to sample from a receiver: by how much of its light may come there, after [Conty18].
// Lights with a place are the leaves of a tree, whose nodes bound where they stand and where they
// shine to; distant ones are chosen by their irradiance. What stands in the way is not known, so a
// share of the choice is even.
#pragma once

#include "light/lamp.h"

#include <span>
#include <vector>

namespace spc {

// Of one light, as the choice sees it.
struct LightReach {
    bool distant = false;
    float strength =
        0.0f;  // luminance: W/sr where it shines brightest; distant: W/m^2. 0: never chosen
    Vec3 center{0.0f};  // of a sphere around it
    float radius = 0.0f;
    LampBeam beam{Vec3(0, 0, 1), 2.0f};
    bool cosine = false;  // falls with the cosine of the angle to the beam's axis
};

class LightTree {
public:
    LightTree() = default;
    explicit LightTree(std::span<const LightReach> lights);

    bool empty() const { return chosen_.empty(); }
    struct Sample {
        uint32_t light;
        float probability;
    };
    // From p; not of an empty tree.
    Sample sample(const Vec3& p, float u) const;
    float probability(uint32_t light, const Vec3& p) const;

private:
    struct Node {
        LightReach reach;  // of all lights below
        uint32_t parent = kNone, left = kNone, right = kNone;
        uint32_t light = kNone;  // of a leaf

        float importance(const Vec3& p) const;
    };
    using Leaves = std::span<Node>;
    uint32_t build(Leaves leaves);
    float share_of_tree(const Vec3& p) const;
    float share_of_left(const Node& node, const Vec3& p) const;
    float share_below_root(uint32_t leaf, const Vec3& p) const;

    std::vector<uint32_t> chosen_;   // lights that are
    std::vector<uint32_t> distant_;  // among them
    std::vector<float> strength_;    // of every light, if it is distant
    std::vector<Node> nodes_;        // children before parents, the root last
    std::vector<uint32_t> leaf_of_;  // node of every light, or kNone
    float distant_strength_ = 0.0f;
};

}  // namespace spc
