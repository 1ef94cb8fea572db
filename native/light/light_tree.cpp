// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/light_tree.h"

#include "core/error.h"
#include "math/bounds.h"

namespace spc {
namespace {

// Places of a split, in parts of the lights between; so a tree is never deeper than some logarithm.
constexpr size_t kSplits = 8;

// Cosine of the least angle between `axis` and the directions between a point and those of a
// sphere, of which `along` is the one to its middle.
float nearest_cosine(const Vec3& axis, const Vec3& along, float distance_squared, float radius) {
    const float sine_squared = sqr(radius) / distance_squared;  // of the sphere's half angle
    if (!(sine_squared < 1.0f)) return 1.0f;
    const float cos = dot(axis, along) / std::sqrt(distance_squared);
    const float cos_sphere = std::sqrt(1.0f - sine_squared);
    if (cos >= cos_sphere) return 1.0f;
    const float sin = std::sqrt(std::max(1.0f - cos * cos, 0.0f));
    return cos * cos_sphere + sin * std::sqrt(sine_squared);
}

// What brings the largest strength near 1, without rounding: then importances are finite, and none
// is lost to denormals that is worth a choice.
float unit_of_strength(std::span<const LightBounds> lights) {
    constexpr int kMostDoublings = 100;
    float largest = 0.0f;
    for (const LightBounds& light : lights) largest = std::max(largest, light.strength);
    if (!(largest > 0.0f)) return 1.0f;
    return std::ldexp(1.0f, std::clamp(-std::ilogb(largest), -kMostDoublings, kMostDoublings));
}
constexpr float kLeastStrength = 0x1p-60f;  // in those units

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

Bounds box_around(const LightBounds& light) {
    Bounds box;
    box.extend(light.center - Vec3(light.radius));
    box.extend(light.center + Vec3(light.radius));
    return box;
}

LightBounds joined(const LightBounds& a, const LightBounds& b) {
    Bounds box = box_around(a);
    box.extend(box_around(b));
    LightBounds sum;
    sum.strength = a.strength + b.strength;
    sum.center = (box.lower + box.upper) * 0.5f;
    sum.radius = std::max(length(sum.center - a.center) + a.radius,
                          length(sum.center - b.center) + b.radius);
    sum.beam = joined(a.beam, b.beam);
    const bool on_all = a.receivers == 0 || b.receivers == 0;
    sum.receivers = on_all ? 0 : a.receivers | b.receivers;
    return sum;
}

// What a node is to be avoided for: strength times the size of its sphere and of its beam.
float cost(const LightBounds& bounds) {
    return bounds.strength * sqr(bounds.radius) * bounds.beam.one_minus_cos;
}

// u in parts of [begin, end).
float remapped(float u, float begin, float end) {
    return std::min((u - begin) / (end - begin), kBelowOne);
}

}  // namespace

float LightTree::Node::importance(const LitPoint& at) const {
    constexpr float kLeast =
        1e-24f;  // m^2: smaller than any scene, so that every one has its choice
    if (!is_linked(bounds.receivers, at.receives)) return 0.0f;
    const Vec3 to_p = at.p - bounds.center;
    const float d2 = length_squared(to_p);
    float result = bounds.strength / std::max({d2, sqr(bounds.radius), kLeast});
    if (at.n != Vec3(0.0f))
        result *= std::max(nearest_cosine(at.n, to_p * -1.0f, d2, bounds.radius), 0.0f);
    if (bounds.beam.one_minus_cos >= 2.0f) return result;
    const float cos = nearest_cosine(bounds.beam.axis, to_p, d2, bounds.radius);
    if (1.0f - cos > bounds.beam.one_minus_cos) return 0.0f;
    return bounds.cosine ? result * std::max(cos, 0.0f) : result;
}

float LightTree::Distant::importance(const LitPoint& at) const {
    if (!is_linked(bounds.receivers, at.receives)) return 0.0f;
    const bool from_one_side = at.n != Vec3(0.0f) && bounds.center != Vec3(0.0f);
    return from_one_side ? bounds.strength * std::max(dot(at.n, bounds.center), 0.0f)
                         : bounds.strength;
}

// Two children to a node; the root last.
struct LightTree::Binary {
    LightBounds bounds;
    uint32_t left = kNone, right = kNone;
    uint32_t light = kNone;  // of a leaf

    static uint32_t build(std::span<Binary> leaves, std::vector<Binary>& nodes);
};

LightTree::LightTree(std::span<const LightBounds> lights)
    : leaf_of_(lights.size(), kNone), distant_of_(lights.size(), kNone) {
    std::vector<Binary> leaves;
    std::vector<float> even(lights.size(), 0.0f);
    const float unit = unit_of_strength(lights);
    for (uint32_t i = 0; i < lights.size(); ++i) {
        if (!(lights[i].strength > 0.0f)) continue;
        even[i] = lights[i].even;
        LightBounds bounds = lights[i];
        bounds.strength = std::max(bounds.strength * unit, kLeastStrength);
        if (bounds.distant) {
            distant_of_[i] = static_cast<uint32_t>(distant_.size());
            distant_.push_back({bounds, i});
        } else {
            leaves.push_back({.bounds = bounds, .light = i});
        }
    }
    evenly_ = DiscreteDistribution(even);
    if (leaves.size() + distant_.size() == 1)
        only_ = leaves.empty() ? distant_[0].light : leaves[0].light;
    if (leaves.empty()) return;
    std::vector<Binary> tree;
    tree.reserve(2 * leaves.size());
    const uint32_t root = Binary::build(leaves, tree);
    nodes_.reserve(tree.size());
    nodes_.emplace_back();
    adopt(tree, root, 0);
}

uint32_t LightTree::Binary::build(std::span<Binary> leaves, std::vector<Binary>& nodes) {
    const auto append = [&](const Binary& node) {
        nodes.push_back(node);
        return static_cast<uint32_t>(nodes.size() - 1);
    };
    if (leaves.size() == 1) return append(leaves[0]);

    float least = kInfinity;
    int best_axis = 0;
    size_t best_split = leaves.size() / 2;
    const auto sort_along = [&](int axis) {
        std::sort(leaves.begin(), leaves.end(), [&](const Binary& a, const Binary& b) {
            const float x = a.bounds.center[axis], y = b.bounds.center[axis];
            return x != y ? x < y : a.light < b.light;
        });
    };
    for (int axis = 0; axis < 3; ++axis) {
        sort_along(axis);
        const size_t count = leaves.size(), step = std::max<size_t>(count / kSplits, 1);
        std::vector<LightBounds> until(count), from(count);
        until[0] = leaves[0].bounds;
        for (size_t i = 1; i < count; ++i) until[i] = joined(until[i - 1], leaves[i].bounds);
        from[count - 1] = leaves[count - 1].bounds;
        for (size_t i = count - 1; i-- > 0;) from[i] = joined(leaves[i].bounds, from[i + 1]);
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
    Binary node;
    node.left = build(leaves.first(best_split), nodes);
    node.right = build(leaves.subspan(best_split), nodes);
    node.bounds = joined(nodes[node.left].bounds, nodes[node.right].bounds);
    return append(node);
}

// What nodes bound is the looser the more they hold, so that a choice among their parts is better
// than several between two: those parts become children that are to be avoided most as a whole.
void LightTree::adopt(const std::vector<Binary>& tree, uint32_t from, uint32_t to) {
    nodes_[to].bounds = tree[from].bounds;
    nodes_[to].light = tree[from].light;
    if (tree[from].light != kNone) {
        leaf_of_[tree[from].light] = to;
        return;
    }
    std::vector<uint32_t> children{tree[from].left, tree[from].right};
    while (children.size() < kWidth) {
        const auto worst =
            std::max_element(children.begin(), children.end(), [&](uint32_t a, uint32_t b) {
                const auto badness = [&](uint32_t i) {
                    return tree[i].light == kNone ? cost(tree[i].bounds) : -1.0f;
                };
                return badness(a) < badness(b);
            });
        const Binary& opened = tree[*worst];
        if (opened.light != kNone) break;  // all are leaves
        *worst = opened.left;
        children.push_back(opened.right);
    }
    const auto first = static_cast<uint32_t>(nodes_.size());
    nodes_[to].first = first;
    nodes_[to].count = static_cast<uint32_t>(children.size());
    nodes_.resize(nodes_.size() + children.size());
    for (uint32_t i = 0; i < children.size(); ++i) {
        nodes_[first + i].parent = to;
        adopt(tree, children[i], first + i);
    }
}

float LightTree::distant_importance(const LitPoint& at) const {
    float sum = 0.0f;
    for (const Distant& distant : distant_) sum += distant.importance(at);
    return sum;
}

LightTree::Parts LightTree::parts(const Node& node, const LitPoint& at) const {
    Parts parts;
    parts.count = std::max(node.count, 1u);
    for (uint32_t i = 0; i < parts.count; ++i)
        parts.sum += parts.of[i] = (node.count > 0 ? nodes_[node.first + i] : node).importance(at);
    return parts;
}

float LightTree::Parts::share(uint32_t child) const {
    // Where none of them shines it does not matter.
    return sum > 0.0f ? of[child] / sum : 1.0f / static_cast<float>(count);
}

float LightTree::part(uint32_t node, const LitPoint& at) const {
    const uint32_t parent = nodes_[node].parent;
    if (parent == kNone || nodes_[parent].parent == kNone) return nodes_[node].importance(at);
    return part(parent, at) * parts(nodes_[parent], at).share(node - nodes_[parent].first);
}

LightTree::Sums LightTree::sums(const LitPoint& at) const {
    Sums sums{nodes_.empty() ? Parts{} : parts(nodes_.front(), at), distant_importance(at), 0.0f};
    sums.all = sums.near.sum + sums.afar;
    return sums;
}

float LightTree::share(uint32_t light, const LitPoint& at, const Sums& sums) const {
    if (!(sums.all > 0.0f)) return evenly_.probability(light);
    const uint32_t leaf = leaf_of_[light];
    return (leaf != kNone ? part(leaf, at) : distant_[distant_of_[light]].importance(at)) / sums.all;
}

LightTree::Choice LightTree::choose(const LitPoint& at, const Sums& sums, float u) const {
    if (!(sums.all > 0.0f)) {
        const DiscreteDistribution::Sample one = evenly_.sample(u);
        return {one.index, one.probability};
    }
    u *= sums.all;
    if (u >= sums.near.sum) {
        float rest = u - sums.near.sum;
        const Distant* chosen = nullptr;
        for (const Distant& distant : distant_) {
            const float importance = distant.importance(at);
            if (importance > 0.0f) chosen = &distant;
            if (rest < importance) break;
            rest -= importance;
        }
        if (chosen != nullptr) return {chosen->light, chosen->importance(at) / sums.all};
        u = sums.near.sum;  // by rounding
    }
    u = remapped(u, 0.0f, sums.near.sum);
    uint32_t node = 0;
    float part = nodes_[0].importance(at);
    for (Parts parts = sums.near; nodes_[node].count > 0; parts = this->parts(nodes_[node], at)) {
        float before = 0.0f;
        uint32_t child = 0;
        for (; child + 1 < parts.count && u >= before + parts.share(child); ++child)
            before += parts.share(child);
        // The last may have none, by rounding.
        while (parts.share(child) == 0.0f) before -= parts.share(--child);
        u = remapped(u, before, before + parts.share(child));
        part = node == 0 ? parts.of[child] : part * parts.share(child);
        node = nodes_[node].first + child;
    }
    return {nodes_[node].light, part / sums.all};
}

float LightTree::mixed(const Choice& choice) const {
    return kEvenShare * evenly_.probability(choice.light) + (1.0f - kEvenShare) * choice.share;
}

float LightTree::probability(uint32_t light, const LitPoint& at) const {
    if (leaf_of_[light] == kNone && distant_of_[light] == kNone) return 0.0f;
    return only_ != kNone ? 1.0f : mixed({light, share(light, at, sums(at))});
}

LightTree::Sample LightTree::sample(const LitPoint& at, float u) const {
    SPC_ASSERT(!empty());
    if (only_ != kNone) return {only_, 1.0f};
    const Sums all = sums(at);
    if (u >= kEvenShare) {
        const Choice choice = choose(at, all, remapped(u, kEvenShare, 1.0f));
        return {choice.light, mixed(choice)};
    }
    const uint32_t light = evenly_.sample(remapped(u, 0.0f, kEvenShare)).index;
    return {light, mixed({light, share(light, at, all)})};
}

namespace {

// Power heuristic for a sample of density `own` beside one of density `other`, for a probability
// that LightTree::mixed has blended from both.
float weight_of(float own, float other) {
    return (1.0f - LightTree::kEvenShare) * (own + other) * own / (sqr(own) + sqr(other));
}

}  // namespace

LightTree::Sample LightTree::first_of_two(const LitPoint& at, float u) const {
    SPC_ASSERT(!empty());
    if (only_ != kNone) return {only_, 1.0f};
    const Choice choice = choose(at, sums(at), u);
    return {choice.light, mixed(choice),
            weight_of(choice.share, kSecond * evenly_.probability(choice.light))};
}

LightTree::Sample LightTree::second_of_two(const LitPoint& at, float u) const {
    const DiscreteDistribution::Sample even = evenly_.sample(u);
    const Choice choice{even.index, share(even.index, at, sums(at))};
    return {choice.light, mixed(choice), weight_of(kSecond * even.probability, choice.share)};
}

}  // namespace spc
