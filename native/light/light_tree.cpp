// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/light_tree.h"

#include "core/error.h"
#include "math/bounds.h"

namespace spc {
namespace {

// Share of the choice that goes to all lights alike: next to a lamp in a closet the sun outside does
// not matter, and the other way round.
constexpr float kEvenShare = 0.1f;
// Places of a split, in parts of the lights between; so a tree is never deeper than some logarithm.
constexpr size_t kSplits = 8;

// Cosine of the least angle between `axis` and the directions between a point and those of a sphere,
// of which `along` is the one to its middle.
float nearest_cosine(const Vec3& axis, const Vec3& along, float distance_squared, float radius) {
    const float sine_squared = sqr(radius) / distance_squared;  // of the sphere's half angle
    if (!(sine_squared < 1.0f)) return 1.0f;
    const float cos = dot(axis, along) / std::sqrt(distance_squared);
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
    if (a.one_minus_cos >= 2.0f) return a;
    const float between = std::acos(std::clamp(dot(a.axis, b.axis), -1.0f, 1.0f));
    const float wide = half_angle(a), narrow = half_angle(b);
    if (between + narrow <= wide) return a;
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

float LightTree::Node::importance(const LitPoint& at) const {
    constexpr float kLeast = 1e-12f;  // m^2
    const Vec3 to_p = at.p - reach.center;
    const float d2 = length_squared(to_p);
    float result = reach.strength / std::max({d2, sqr(reach.radius), kLeast});
    if (at.n != Vec3(0.0f))
        result *= std::max(nearest_cosine(at.n, to_p * -1.0f, d2, reach.radius), 0.0f);
    if (reach.beam.one_minus_cos >= 2.0f) return result;
    const float cos = nearest_cosine(reach.beam.axis, to_p, d2, reach.radius);
    if (1.0f - cos > reach.beam.one_minus_cos) return 0.0f;
    return reach.cosine ? result * std::max(cos, 0.0f) : result;
}

float LightTree::Distant::importance(const LitPoint& at) const {
    const bool from_one_side = at.n != Vec3(0.0f) && reach.center != Vec3(0.0f);
    return from_one_side ? reach.strength * std::max(dot(at.n, reach.center), 0.0f) : reach.strength;
}

LightTree::LightTree(std::span<const LightReach> lights)
    : leaf_of_(lights.size(), kNone), distant_of_(lights.size(), kNone) {
    std::vector<Node> leaves;
    std::vector<float> even(lights.size(), 0.0f);
    for (uint32_t i = 0; i < lights.size(); ++i) {
        if (!(lights[i].strength > 0.0f)) continue;
        even[i] = lights[i].even;
        if (lights[i].distant) {
            distant_of_[i] = static_cast<uint32_t>(distant_.size());
            distant_.push_back({lights[i], i});
        } else {
            Node leaf;
            leaf.reach = lights[i];
            leaf.light = i;
            leaves.push_back(leaf);
        }
    }
    evenly_ = DiscreteDistribution(even);
    if (leaves.size() + distant_.size() == 1)
        only_ = leaves.empty() ? distant_[0].light : leaves[0].light;
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

float LightTree::distant_importance(const LitPoint& at) const {
    float sum = 0.0f;
    for (const Distant& distant : distant_) sum += distant.importance(at);
    return sum;
}

float LightTree::share_of_left(const Node& node, const LitPoint& at) const {
    const Node &left = nodes_[node.left], &right = nodes_[node.right];
    const float a = left.importance(at), b = right.importance(at);
    // Where none of them shines it does not matter.
    return a + b > 0.0f ? a / (a + b) : 0.5f;
}

float LightTree::share_below_root(uint32_t leaf, const LitPoint& at) const {
    float share = 1.0f;
    for (uint32_t i = leaf; nodes_[i].parent != kNone; i = nodes_[i].parent) {
        const Node& parent = nodes_[nodes_[i].parent];
        const float left = share_of_left(parent, at);
        share *= parent.left == i ? left : 1.0f - left;
    }
    return share;
}

float LightTree::probability(uint32_t light, const LitPoint& at) const {
    const uint32_t leaf = leaf_of_[light], distant = distant_of_[light];
    if (leaf == kNone && distant == kNone) return 0.0f;
    if (only_ != kNone) return 1.0f;
    const float even = evenly_.probability(light);
    const float afar = distant_importance(at);
    const float near = nodes_.empty() ? 0.0f : nodes_.back().importance(at);
    if (!(afar + near > 0.0f)) return even;
    const float part = leaf == kNone ? distant_[distant].importance(at)
                       : near > 0.0f ? near * share_below_root(leaf, at)
                                     : 0.0f;
    return kEvenShare * even + (1.0f - kEvenShare) * (part / (afar + near));
}

LightTree::Sample LightTree::sample(const LitPoint& at, float u) const {
    SPC_ASSERT(!empty());
    const auto chosen = [&](uint32_t light) { return Sample{light, probability(light, at)}; };
    const auto evenly = [&](float v) { return chosen(evenly_.sample(v).index); };
    if (only_ != kNone) return {only_, 1.0f};
    const float afar = distant_importance(at);
    const float near = nodes_.empty() ? 0.0f : nodes_.back().importance(at);
    if (!(afar + near > 0.0f)) return evenly(u);
    if (u < kEvenShare) return evenly(remapped(u, 0.0f, kEvenShare));
    u = remapped(u, kEvenShare, 1.0f) * (afar + near);
    if (u >= near) {
        float rest = u - near;
        uint32_t light = kNone;
        for (const Distant& distant : distant_) {
            const float part = distant.importance(at);
            if (part > 0.0f) light = distant.light;
            if (rest < part) break;
            rest -= part;
        }
        if (light != kNone) return chosen(light);
        u = near;  // by rounding
    }
    u = remapped(u, 0.0f, near);
    const Node* node = &nodes_.back();
    while (node->light == kNone) {
        const float left = share_of_left(*node, at);
        const bool goes_left = u < left;
        u = goes_left ? remapped(u, 0.0f, left) : remapped(u, left, 1.0f);
        node = &nodes_[goes_left ? node->left : node->right];
    }
    return chosen(node->light);
}

}  // namespace spc
