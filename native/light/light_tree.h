// SPDX-License-Identifier: GPL-3.0-or-later
// Which light to sample from a receiver: by how much of its light may come there, after [Conty18].
// Lights with a place are the leaves of a wide tree, whose nodes bound where they stand and where
// they shine to; distant ones are chosen by their irradiance. What stands in the way is not known,
// so a share of the choice is even.
#pragma once

#include "core/distribution.h"
#include "light/lamp.h"

#include <array>
#include <span>
#include <vector>

namespace spc {

// A point to be lit. `n`: unit normal on the side that receives light; zero if both sides do.
// `receives`: LinkSets of its instance.
struct LitPoint {
    Vec3 p, n;
    uint64_t receives;

    LitPoint(const Vec3& point, const Vec3& normal = Vec3(0.0f), uint64_t receives_ = 0)
        : p(point), n(normal), receives(receives_) {}
};

// Bounds of a light, of a part of it, or of several lights: where they stand and how they shine.
struct LightBounds {
    bool distant = false;
    // Luminance in the brightest direction, W/sr; distant: W/m^2. 0: never chosen.
    float strength = 0.0f;
    // Centre and radius of a sphere around it. Distant: `center` is a unit vector towards it, or
    // zero for light from all around.
    Vec3 center{0.0f};
    float radius = 0.0f;
    LampBeam beam{Vec3(0, 0, 1), 2.0f};
    bool cosine = false;     // falls with the cosine of the angle to the beam's axis
    uint64_t receivers = 0;  // LightLinks: of several, the sets on which any of them shines
    float even =
        1.0f;  // relative probability in the even choice: 1 for a light, shared by its parts
};

class LightTree {
public:
    // Share of the choice that is even over all lights. Importance alone may be wrong: beside a
    // lamp in a closet the sun outside does not matter, and the other way round.
    static constexpr float kEvenShare = 0.1f;

    LightTree() = default;
    explicit LightTree(std::span<const LightBounds> lights);

    bool empty() const { return evenly_.empty(); }
    struct Sample {
        uint32_t light;
        float probability;    // LightTree::probability()
        float weight = 1.0f;  // MIS weight beside the other of two samples
    };
    // Chooses a light by importance or, with probability kEvenShare, evenly. The tree must not be
    // empty.
    Sample sample(const LitPoint& at, float u) const;
    float probability(uint32_t light, const LitPoint& at) const;
    // The same choice as two samples, the second of which is made with probability kSecond. The
    // power heuristic [Veach97] weighs them, so that the second takes next to nothing where
    // importance is right. The sum of weight / probability has the same mean.
    static constexpr float kSecond = kEvenShare / (1.0f - kEvenShare);
    Sample first_of_two(const LitPoint& at, float u) const;
    Sample second_of_two(const LitPoint& at, float u) const;
    bool has_second() const { return only_ == kNone && !empty(); }

private:
    struct Node {
        LightBounds bounds;  // around all lights below
        uint32_t parent = kNone;
        uint32_t first = 0, count = 0;  // its children; none: a leaf
        uint32_t light = kNone;         // of a leaf

        float importance(const LitPoint& at) const;
    };
    struct Distant {
        LightBounds bounds;
        uint32_t light;

        float importance(const LitPoint& at) const;
    };
    struct Binary;
    static constexpr uint32_t kWidth = 8;  // children of a node, at most
    void adopt(const std::vector<Binary>& tree, uint32_t from, uint32_t to);
    // Importances of a node's children, or of a leaf.
    struct Parts {
        std::array<float, kWidth> of{};
        uint32_t count = 0;
        float sum = 0.0f;

        float share(uint32_t child) const;
    };
    Parts parts(const Node& node, const LitPoint& at) const;
    // A node's share of the importance, as a part of the sum over the root's children.
    float part(uint32_t node, const LitPoint& at) const;
    float distant_importance(const LitPoint& at) const;
    struct Sums {
        Parts near;  // of the root
        float afar, all;
    };
    Sums sums(const LitPoint& at) const;
    // A choice by importance alone.
    struct Choice {
        uint32_t light;
        float share;
    };
    Choice choose(const LitPoint& at, const Sums& sums, float u) const;
    float share(uint32_t light, const LitPoint& at, const Sums& sums) const;
    float mixed(const Choice& choice) const;

    DiscreteDistribution evenly_;
    uint32_t only_ = kNone;  // the light, if there is one alone
    std::vector<Distant> distant_;
    std::vector<Node> nodes_;  // the root first; children side by side
    // By light: its node, or its place among the distant lights; else kNone.
    std::vector<uint32_t> leaf_of_, distant_of_;
};

}  // namespace spc
