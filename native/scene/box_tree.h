// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many boxes hold a point, by Embree's tree of them.
#pragma once

#include "math/bounds.h"

#include <memory>
#include <vector>

namespace spc {

class BoxTree {
public:
    explicit BoxTree(std::vector<Bounds> boxes);
    ~BoxTree();
    BoxTree(const BoxTree&) = delete;
    BoxTree& operator=(const BoxTree&) = delete;

    // Calls `act` with the index of each box that holds p.
    template <class Act>
    void visit(const Vec3& p, const Act& act) const {
        find(
            p,
            [](uint32_t index, const void* context) { (*static_cast<const Act*>(context))(index); },
            &act);
    }

private:
    using Visitor = void (*)(uint32_t index, const void* context);
    void find(const Vec3& p, Visitor visitor, const void* context) const;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace spc
