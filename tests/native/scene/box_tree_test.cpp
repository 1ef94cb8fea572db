// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/box_tree.h"

#include "core/random.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

TEST(BoxTree, FindsEveryBoxThatHoldsAPoint) {
    Pcg pcg(1);
    const auto point = [&] {
        const Vec2 xy = pcg.two();
        return Vec3(xy.x, xy.y, pcg.one());
    };
    std::vector<Bounds> boxes;
    for (int i = 0; i < 3000; ++i) {
        Bounds box;
        const Vec3 center = point();
        const float half = i % 100 == 0 ? 0.5f : 0.03f;
        box.extend(center - point() * half);
        box.extend(center + point() * half);
        boxes.push_back(box);
    }
    const BoxTree tree(boxes);
    size_t total = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 p = point();
        std::vector<uint32_t> expected, found;
        for (uint32_t k = 0; k < boxes.size(); ++k) {
            const Bounds& b = boxes[k];
            bool inside = true;
            for (int axis = 0; axis < 3; ++axis)
                inside = inside && p[axis] >= b.lower[axis] && p[axis] <= b.upper[axis];
            if (inside) expected.push_back(k);
        }
        tree.visit(p, [&](uint32_t k) { found.push_back(k); });
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
        total += expected.size();
    }
    EXPECT_GT(total, 500u);
}

TEST(BoxTree, MayBeEmpty) {
    const BoxTree tree({});
    tree.visit(Vec3(0.0f), [](uint32_t) { FAIL(); });
}

}  // namespace
}  // namespace spc
