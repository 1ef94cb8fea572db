// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/prism_tree.h"

#include <algorithm>
#include <numeric>

namespace spc {

namespace {

// A volume of more prisms holds the balls around them: it is so much larger than they are that
// their shapes make no difference to it.
constexpr uint32_t kManyPrisms = 64;

// Where a prism is and how it moves: what lies near and moves alike agrees in all of them.
struct Place {
    Vec3 center;
    std::array<Vec3, 3> motion;
    float size;    // its longest edge
    float radius;  // of a ball that moves with the place and always holds the prism

    static constexpr int kCoordinates = 12;
    float coordinate(int i, float reach) const {  // m
        return i < 3 ? center[i] : reach * motion[static_cast<size_t>(i / 3 - 1)][i % 3];
    }
};

std::array<Vec3, 3> edges_of(const MovingPrism& prism) {
    const auto& [a, b, c] = prism.corners;
    return {b.p - a.p, c.p - b.p, a.p - c.p};
}

Place place_of(const MovingPrism& prism, float reach) {
    constexpr float kThird = 1.0f / 3;
    Place place{Vec3(0.0f), {Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)}, 0.0f, 0.0f};
    for (const MovingPrism::Corner& corner : prism.corners) {
        place.center += corner.p * kThird;
        for (size_t j = 0; j < 3; ++j) place.motion[j] += corner.motion[j] * kThird;
    }
    for (const Vec3& edge : edges_of(prism)) place.size = std::max(place.size, length(edge));
    for (const MovingPrism::Corner& corner : prism.corners) {
        float squares = 0.0f;  // the norm bounds how far a shift of length 1 leads from the place's
        for (size_t j = 0; j < 3; ++j)
            squares += length_squared(corner.motion[j] - place.motion[j]);
        place.radius = std::max(place.radius, length(corner.p - place.center) +
                                                  length(corner.half) + reach * std::sqrt(squares));
    }
    return place;
}

// The component along `normal` of each of them.
Vec3 along(const Vec3& normal, const std::array<Vec3, 3>& motion) {
    return Vec3(dot(normal, motion[0]), dot(normal, motion[1]), dot(normal, motion[2]));
}

// Normals of planes that fit closely: the narrowest way first, which decides most queries.
std::array<Vec3, 3> normals_around(const MovingPrism& prism) {
    const std::array<Vec3, 3> edges = edges_of(prism);
    const Vec3 longest = *std::max_element(
        edges.begin(), edges.end(),
        [](const Vec3& a, const Vec3& b) { return length_squared(a) < length_squared(b); });
    const Vec3& along = prism.corners[0].half;
    const Vec3 across = cross(longest, along);
    const std::array<Vec3, 3> normals{across, cross(across, along), cross(edges[0], edges[1])};
    std::array<Vec3, 3> result{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (size_t i = 0; i < 3; ++i) {
        const float size = length(normals[i]);
        if (size > 0.0f && std::isfinite(size)) result[i] = normals[i] * (1.0f / size);
    }
    return result;
}

// Between two planes.
struct Slab {
    Vec3 normal;
    Vec3 motion;  // along the normal, by component of the shift
    float lower = kInfinity, upper = -kInfinity;

    // What moves so and reaches `half` to both sides of p, and how far rounding may take it.
    void extend(const Vec3& p, const std::array<Vec3, 3>& moved, float half, float reach) {
        constexpr float kRounding = 0x1p-21f;
        const Vec3 off = along(normal, moved) - motion;
        const float far = half + reach * length(off) +
                          kRounding * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
        const float center = dot(normal, p);
        lower = std::min(lower, center - far);
        upper = std::max(upper, center + far);
    }
};

}  // namespace

class PrismTree::Builder {
public:
    Builder(PrismTree& tree, const Shape& shape, float reach, std::vector<uint32_t>& order,
            Volumes volumes, const Budget& budget)
        : nodes_(tree.nodes_),
          order_(order),
          shape_(shape),
          reach_(reach),
          volumes_(volumes),
          budget_(budget) {
        places_.reserve(order_.size());
        for (const uint32_t i : order_) {
            if (budget_.is_cancelled()) return;
            places_.push_back(place_of(shape(i), reach));
        }
    }

    // Of at least one prism; returns its place. Once cancelled, children are missing.
    uint32_t build(uint32_t begin, uint32_t end) {
        uint32_t room = 1;  // of a child
        while (uint64_t{room} * kWidth < end - begin) room *= kWidth;
        const auto node = static_cast<uint32_t>(nodes_.size());
        nodes_.push_back({});
        clear(nodes_[node]);
        uint32_t child = 0;
        split(begin, end, room, [&](uint32_t first, uint32_t past) {
            const std::array<Slab, 3> slabs = slabs_around(first, past);
            const uint32_t place = past - first == 1 ? first | kPrism : build(first, past);
            set(nodes_[node], child++, slabs, place);
        });
        return node;
    }

private:
    static void clear(Node& node) {
        for (Slabs& slabs : node.slabs) {
            slabs.lower = Lanes{} + kInfinity;
            slabs.upper = Lanes{} - kInfinity;
        }
    }

    static void set(Node& node, uint32_t child, const std::array<Slab, 3>& slabs, uint32_t place) {
        node.children[child] = place;
        for (size_t k = 0; k < 3; ++k) {
            Slabs& to = node.slabs[k];
            for (int j = 0; j < 3; ++j) {
                to.normal[j][child] = slabs[k].normal[j];
                to.motion[j][child] = slabs[k].motion[j];
            }
            to.lower[child] = slabs[k].lower;
            to.upper[child] = slabs[k].upper;
        }
    }

    // Halves the range, across its widest extent, until what is left has room in one child. All
    // children but one are full.
    template <class Act>
    void split(uint32_t begin, uint32_t end, uint32_t room, const Act& act) {
        if (budget_.is_cancelled()) return;
        const uint32_t children = (end - begin + room - 1) / room;
        if (children == 1) return act(begin, end);
        const int widest = widest_coordinate(begin, end);
        const uint32_t middle = begin + children / 2 * room;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](uint32_t i, uint32_t k) {
                             return places_[i].coordinate(widest, reach_) <
                                    places_[k].coordinate(widest, reach_);
                         });
        split(begin, middle, room, act);
        split(middle, end, room, act);
    }

    int widest_coordinate(uint32_t begin, uint32_t end) const {
        std::array<float, Place::kCoordinates> least, most;
        least.fill(kInfinity);
        most.fill(-kInfinity);
        for (uint32_t i = begin; i < end; ++i)
            for (size_t c = 0; c < least.size(); ++c) {
                const float at = places_[order_[i]].coordinate(static_cast<int>(c), reach_);
                least[c] = std::min(least[c], at);
                most[c] = std::max(most[c], at);
            }
        size_t widest = 0;
        for (size_t c = 1; c < least.size(); ++c)
            if (most[c] - least[c] > most[widest] - least[widest]) widest = c;
        return static_cast<int>(widest);
    }

    // The largest prism gives the directions.
    std::array<Slab, 3> slabs_around(uint32_t begin, uint32_t end) const {
        const uint32_t largest = *std::max_element(
            order_.begin() + begin, order_.begin() + end,
            [&](uint32_t i, uint32_t k) { return places_[i].size < places_[k].size; });
        const std::array<Vec3, 3> normals = normals_around(shape_(largest));
        std::array<Vec3, 3> motion{Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)};
        const float share = 1.0f / static_cast<float>(end - begin);
        for (uint32_t i = begin; volumes_ == Volumes::move && i < end; ++i)
            for (size_t j = 0; j < 3; ++j) motion[j] += places_[order_[i]].motion[j] * share;
        std::array<Slab, 3> slabs;
        for (size_t k = 0; k < 3; ++k) slabs[k] = {normals[k], along(normals[k], motion)};
        for (uint32_t i = begin; i < end; ++i)
            end - begin > kManyPrisms ? hold_ball(order_[i], slabs) : hold_prism(order_[i], slabs);
        return slabs;
    }

    void hold_ball(uint32_t i, std::array<Slab, 3>& slabs) const {
        const Place& place = places_[i];
        for (Slab& slab : slabs) slab.extend(place.center, place.motion, place.radius, reach_);
    }

    void hold_prism(uint32_t i, std::array<Slab, 3>& slabs) const {
        const MovingPrism prism = shape_(i);
        for (Slab& slab : slabs)
            for (const auto& [p, half, motion] : prism.corners)
                slab.extend(p, motion, std::abs(dot(slab.normal, half)), reach_);
    }

    std::vector<Node>& nodes_;
    std::vector<uint32_t>& order_;
    const Shape& shape_;
    const float reach_;
    const Volumes volumes_;
    const Budget& budget_;
    std::vector<Place> places_;
};

PrismTree::PrismTree(uint32_t count, const Shape& shape, float reach, std::vector<uint32_t>& order,
                     Volumes volumes, const Budget& budget) {
    order.resize(count);
    std::iota(order.begin(), order.end(), 0u);
    if (count > 0) Builder(*this, shape, reach, order, volumes, budget).build(0, count);
}

}  // namespace spc
