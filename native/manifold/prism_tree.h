// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many prisms hold a point, where all of them move, each in its own way, as one vector does.
#pragma once

#include "math/vec.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace spc {

// A triangle, extended by `half` to both sides of it. For the shift s a corner lies at
// p + motion[0] s.x + motion[1] s.y + motion[2] s.z.
struct MovingPrism {
    struct Corner {
        Vec3 p, half;
        std::array<Vec3, 3> motion;
    };
    std::array<Corner, 3> corners;
};

// A tree of volumes between three pairs of planes, which may be oblique: prisms may be slivers that
// lie across all axes. They move as their prisms do on average, and so are hardly larger for it where
// those move alike.
class PrismTree {
public:
    using Shape = std::function<MovingPrism(uint32_t)>;
    PrismTree() = default;  // holds nothing
    // `reach`: the longest shift. `order` receives the indices of the prisms as they lie in the tree:
    // what belongs to them is found fastest if it is put in this order.
    PrismTree(uint32_t count, const Shape& shape, float reach, std::vector<uint32_t>& order);

    // Calls `act` with the place in that order of each prism that holds p, and of some that do not.
    template <class Act>
    void visit(const Vec3& p, const Vec3& shift, const Act& act) const {
        for (size_t i = 0; i < nodes_.size();) {
            const Node& node = nodes_[i];
            if (!node.holds(p, shift)) {
                i = node.past;
                continue;
            }
            for (uint32_t k = 0; k < node.count; ++k) act(node.first + k);
            ++i;
        }
    }

private:
    struct Slab {
        Vec3 normal;
        Vec3 motion;  // along the normal, by component of the shift
        float lower, upper;

        float at(const Vec3& p, const Vec3& shift) const {
            return dot(normal, p) - dot(motion, shift);
        }
        // What moves so and reaches `half` to both sides of p.
        void extend(const Vec3& p, const std::array<Vec3, 3>& moved, float half, float reach);
    };
    // In the order of a walk that goes down first.
    struct Node {
        std::array<Slab, 3> slabs;
        uint32_t past;          // the next one outside it
        uint32_t first, count;  // prisms; none but in leaves

        bool holds(const Vec3& p, const Vec3& shift) const {
            for (const Slab& slab : slabs) {
                const float at = slab.at(p, shift);
                if (!(at >= slab.lower && at <= slab.upper)) return false;
            }
            return true;
        }
    };
    class Builder;

    std::vector<Node> nodes_;
};

}  // namespace spc
