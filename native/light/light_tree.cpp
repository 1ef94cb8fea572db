// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/light_tree.h"

#include "core/error.h"
#include "math/bounds.h"

namespace spc {
namespace {

// Share of the choice that goes to all lights alike: next to a lamp in a closet the sun outside does
// not matter, and the other way round.
constexpr float kEvenShare = 0.2f;
// Places of a split, in parts of the lights between; so a tree is never deeper than some logarithm.
constexpr size_t kSplits = 8;
constexpr float kBelowOne = 0x1.fffffep-1f;

// Cosine of the least angle between `axis` and the directions from a sphere's points to p.
float nearest_cosine(const Vec3& axis, const Vec3& to_p, float distance_squared, float radius) {
    const float sine_squared = sqr(radius) / distance_squared;  // of the sphere's half angle
    if (!(sine_squared < 1.0f)) return 1.0f;
    const float cos = dot(axis, to_p) / std::sqrt(distance_squared);
    const float cos_sphere = std::sqrt(1.0f - sine_squared);
    if (cos >= cos_sphere) return 1.0f;
    const float sin = std::sqrt(std::max(1.0f - cos * cos, 0.0f));
    return cos * cos_sphere + sin * std::sqrt(sine_squared);
}

float half_angle(const LampBeam& beam) {
    return std::acos(std::max(1.0f - beam.one_minus_cos, -1.0f));
}

// The narrowest cone that holds both.
LampBeam joined(const LampBeam& a, const LampBeam& b) {
    const LampBeam all{a.axis, 2.0f};
    if (a.one_minus_cos < b.one_minus_cos) return joined(b, a);
    const float between = std::acos(std::clamp(dot(a.axis, b.axis), -1.0f, 1.0f));
    const float wide = half_angle(a), narrow = half_angle(b);
    if (a.one_minus_cos >= 2.0f || between + narrow <= wide) return a;
    const float half = 0.5f * (wide + between + narrow);
    const Vec3 side = b.axis - a.axis * dot(a.axis, b.axis);
    if (half >= kPi || !(length_squared(side) > 0.0f)) return all;
    const float turn = half - wide;
    const Vec3 axis = a.axis * std::cos(turn) + normalize(side) * std::sin(turn);
    return {normalize(axis), 1.0f - std::cos(half)};
}

Bounds box_around(const LightReach& light) {
    Bounds box;
    box.extend(light.center - Vec3(light.radius));
    box.extend(light.center + Vec3(light.radius));
    return box;
}

LightReach joined(const LightReach& a, const LightReach& b) {
    Bounds box = box_around(a);
    box.extend(box_around(b));
    LightReach sum;
    sum.strength = a.strength + b.strength;
    sum.center = (box.lower + box.upper) * 0.5f;
    sum.radius = std::max(length(sum.center - a.center) + a.radius,
                          length(sum.center - b.center) + b.radius);
    sum.beam = joined(a.beam, b.beam);
    return sum;
}

// What a node is to be avoided for: strength times the size of its sphere and of its beam.
float cost(const LightReach& reach) {
    return reach.strength * sqr(reach.radius) * reach.beam.one_minus_cos;
}

// u in parts of [begin, end).
float remapped(float u, float begin, float end) {
    return std::min((u - begin) / (end - begin), kBelowOne);
}

}  // namespace

float LightTree::Node::importance(const Vec3& p) const {
    constexpr float kLeast = 1e-12f;  // m^2
    const Vec3 to_p = p - reach.center;
    const float d2 = length_squared(to_p);
    const float even = reach.strength / std::max({d2, sqr(reach.radius), kLeast});
    if (reach.beam.one_minus_cos >= 2.0f) return even;
    const float cos = nearest_cosine(reach.beam.axis, to_p, d2, reach.radius);
    if (1.0f - cos > reach.beam.one_minus_cos) return 0.0f;
    return reach.cosine ? even * std::max(cos, 0.0f) : even;
}

LightTree::LightTree(std::span<const LightReach> lights)
    : strength_(lights.size(), 0.0f), leaf_of_(lights.size(), kNone) {
    std::vector<Node> leaves;
    for (uint32_t i = 0; i < lights.size(); ++i) {
        if (!(lights[i].strength > 0.0f)) continue;
        chosen_.push_back(i);
        if (lights[i].distant) {
            distant_.push_back(i);
            strength_[i] = lights[i].strength;
            distant_strength_ += lights[i].strength;
        } else {
            Node leaf;
            leaf.reach = lights[i];
            leaf.light = i;
            leaves.push_back(leaf);
        }
    }
    if (leaves.empty()) return;
    nodes_.reserve(2 * leaves.size());
    build(leaves);
}

uint32_t LightTree::build(Leaves leaves) {
    const auto append = [&](const Node& node) {
        nodes_.push_back(node);
        return static_cast<uint32_t>(nodes_.size() - 1);
    };
    if (leaves.size() == 1) return leaf_of_[leaves[0].light] = append(leaves[0]);

    float least = kInfinity;
    int best_axis = 0;
    size_t best_split = leaves.size() / 2;
    const auto sort_along = [&](int axis) {
        std::sort(leaves.begin(), leaves.end(), [&](const Node& a, const Node& b) {
            const float x = a.reach.center[axis], y = b.reach.center[axis];
            return x != y ? x < y : a.light < b.light;
        });
    };
    for (int axis = 0; axis < 3; ++axis) {
        sort_along(axis);
        const size_t count = leaves.size(), step = std::max<size_t>(count / kSplits, 1);
        std::vector<LightReach> until(count), from(count);
        until[0] = leaves[0].reach;
        for (size_t i = 1; i < count; ++i) until[i] = joined(until[i - 1], leaves[i].reach);
        from[count - 1] = leaves[count - 1].reach;
        for (size_t i = count - 1; i-- > 0;) from[i] = joined(leaves[i].reach, from[i + 1]);
        for (size_t split = step; split < count; split += step) {
            const float sum = cost(until[split - 1]) + cost(from[split]);
            if (sum < least) {
                least = sum;
                best_axis = axis;
                best_split = split;
            }
        }
    }
    sort_along(best_axis);
    Node node;
    node.left = build(leaves.first(best_split));
    node.right = build(leaves.subspan(best_split));
    node.reach = joined(nodes_[node.left].reach, nodes_[node.right].reach);
    const uint32_t index = append(node);
    nodes_[node.left].parent = nodes_[node.right].parent = index;
    return index;
}

float LightTree::share_of_tree(const Vec3& p) const {
    if (nodes_.empty()) return 0.0f;
    if (distant_.empty()) return 1.0f;
    const float near = nodes_.back().importance(p);
    return near / (near + distant_strength_);
}

float LightTree::share_of_left(const Node& node, const Vec3& p) const {
    const Node &left = nodes_[node.left], &right = nodes_[node.right];
    const float a = left.importance(p), b = right.importance(p);
    // Where none of them shines it does not matter.
    return a + b > 0.0f ? a / (a + b) : 0.5f;
}

float LightTree::share_below_root(uint32_t leaf, const Vec3& p) const {
    float share = 1.0f;
    for (uint32_t at = leaf; nodes_[at].parent != kNone; at = nodes_[at].parent) {
        const Node& parent = nodes_[nodes_[at].parent];
        const float left = share_of_left(parent, p);
        share *= parent.left == at ? left : 1.0f - left;
    }
    return share;
}

float LightTree::probability(uint32_t light, const Vec3& p) const {
    const uint32_t leaf = leaf_of_[light];
    const bool distant = strength_[light] > 0.0f;
    if (leaf == kNone && !distant) return 0.0f;
    if (chosen_.size() == 1) return 1.0f;
    const float tree = share_of_tree(p);
    const float share = distant ? (1.0f - tree) * (strength_[light] / distant_strength_)
                                : tree * share_below_root(leaf, p);
    return kEvenShare / static_cast<float>(chosen_.size()) + (1.0f - kEvenShare) * share;
}

LightTree::Sample LightTree::sample(const Vec3& p, float u) const {
    SPC_ASSERT(!empty());
    const auto chosen = [&](uint32_t light) { return Sample{light, probability(light, p)}; };
    const auto count = static_cast<float>(chosen_.size());
    if (chosen_.size() == 1) return {chosen_[0], 1.0f};
    if (u < kEvenShare)
        return chosen(chosen_[static_cast<size_t>(remapped(u, 0.0f, kEvenShare) * count)]);
    u = remapped(u, kEvenShare, 1.0f);
    const float tree = share_of_tree(p);
    if (u >= tree) {
        float rest = remapped(u, tree, 1.0f) * distant_strength_;
        size_t i = 0;
        while (i + 1 < distant_.size() && rest >= strength_[distant_[i]])
            rest -= strength_[distant_[i++]];
        return chosen(distant_[i]);
    }
    u = remapped(u, 0.0f, tree);
    const Node* node = &nodes_.back();
    while (node->light == kNone) {
        const float left = share_of_left(*node, p);
        const bool goes_left = u < left;
        u = goes_left ? remapped(u, 0.0f, left) : remapped(u, left, 1.0f);
        node = &nodes_[goes_left ? node->left : node->right];
    }
    return chosen(node->light);
}

}  // namespace spc
