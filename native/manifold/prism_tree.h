// SPDX-License-Identifier: GPL-3.0-or-later
// A tree over prisms that move: it finds those that hold a point, for any shift. Each prism moves
// linearly in the shift, in its own way.
#pragma once

#include "core/budget.h"
#include "math/vec.h"

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace spc {

// A triangle extended by `half` to both sides. For the shift s a corner lies at
// p + motion[0] s.x + motion[1] s.y + motion[2] s.z.
struct MovingPrism {
    struct Corner {
        Vec3 p, half;
        std::array<Vec3, 3> motion;
    };
    std::array<Corner, 3> corners;
};

// Bounding volumes lie between three pairs of planes, which may be oblique, since prisms may be
// slivers across all axes. A volume follows the mean motion of its prisms, so it hardly grows where
// they move alike. A node tests the volumes of its eight children at once.
class PrismTree {
public:
    using Shape = std::function<MovingPrism(uint32_t)>;
    PrismTree() = default;  // holds nothing
    enum class Volumes {
        move,
        stay  // large enough for every shift, so visit() gets a zero shift
    };
    // `reach`: length of the longest shift. `order` receives the indices of the prisms in the
    // tree's order; data that belong to them should be stored in that order. Once the budget is
    // cancelled the tree lacks prisms.
    PrismTree(uint32_t count, const Shape& shape, float reach, std::vector<uint32_t>& order,
              Volumes volumes = Volumes::move, const Budget& budget = {});

    // Calls `act` with the place in that order of each prism that may hold p, until `act` returns
    // false. Some of these prisms do not hold p.
    template <class Act>
    void visit(const Vec3& p, const Vec3& shift, const Act& act) const {
        if (nodes_.empty()) return;
        constexpr size_t kMostWaiting = kWidth * 11;  // 8^11 is more than 2^32
        std::array<uint32_t, kMostWaiting> waiting;
        waiting[0] = 0;
        for (size_t count = 1; count > 0;) {
            const Node& node = nodes_[waiting[--count]];
            for (uint32_t holds = node.holds(p, shift); holds != 0; holds &= holds - 1) {
                const uint32_t child = node.children[static_cast<size_t>(std::countr_zero(holds))];
                if ((child & kPrism) == 0)
                    waiting[count++] = child;
                else if (!act(child & ~kPrism))
                    return;
            }
        }
    }

private:
    static constexpr uint32_t kWidth = 8;
    static constexpr uint32_t kPrism = 1u << 31;  // marks a child that is a prism's place

    // Of each child, by lanes.
    using Lanes = float __attribute__((vector_size(4 * kWidth)));
    using Bits = int32_t __attribute__((vector_size(4 * kWidth)));
    // One pair of planes.
    struct Slabs {
        Lanes normal[3];
        Lanes motion[3];  // along the normal, by component of the shift
        Lanes lower, upper;
    };
    struct Node {
        Slabs slabs[3];
        uint32_t children[kWidth];

        // One bit for each child that holds p.
        uint32_t holds(const Vec3& p, const Vec3& shift) const {
            Bits all = {1, 2, 4, 8, 16, 32, 64, 128};
            for (const Slabs& s : slabs) {
                const Lanes at = s.normal[0] * p.x + s.normal[1] * p.y + s.normal[2] * p.z -
                                 s.motion[0] * shift.x - s.motion[1] * shift.y -
                                 s.motion[2] * shift.z;
                all &= (at >= s.lower) & (at <= s.upper);
            }
            all |= __builtin_shufflevector(all, all, 4, 5, 6, 7, 0, 1, 2, 3);
            all |= __builtin_shufflevector(all, all, 2, 3, 0, 1, 6, 7, 4, 5);
            all |= __builtin_shufflevector(all, all, 1, 0, 3, 2, 5, 4, 7, 6);
            return static_cast<uint32_t>(all[0]);
        }
    };
    class Builder;

    std::vector<Node> nodes_;
};

}  // namespace spc
