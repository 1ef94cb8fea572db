// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/prism_tree.h"

#include "core/random.h"

#include <gtest/gtest.h>

#include <set>

namespace spc {
namespace {

constexpr float kReach = 0.1f;

Vec3 direction(Pcg& pcg) {
    Vec3 d;
    do {
        const Vec2 xy = pcg.two();
        d = Vec3(xy.x, xy.y, pcg.one()) * 2.0f - Vec3(1.0f);
    } while (length(d) > 1.0f || length(d) < 0.1f);
    return normalize(d);
}

// Slivers that lie across the axes and move as their place has it, but for a little; each hundredth
// is large.
MovingPrism prism(Pcg& pcg, bool large) {
    const Vec3 p(pcg.two().x, pcg.two().x, 0.3f * pcg.one());
    const Vec3 along = direction(pcg), across = direction(pcg), up = direction(pcg);
    const float size = large ? 0.3f : 0.03f;
    MovingPrism result;
    for (size_t i = 0; i < 3; ++i) {
        MovingPrism::Corner& corner = result.corners[i];
        corner.p = p + along * (i == 1 ? size : 0.0f) + across * (i == 2 ? 0.02f * size : 0.0f);
        corner.half = up * (0.1f * size);
        for (size_t j = 0; j < 3; ++j)
            corner.motion[j] = Vec3(p.y, p.z, p.x) * static_cast<float>(j) + direction(pcg) * 0.02f;
    }
    return result;
}

// Within it, for that shift.
Vec3 point_in(const MovingPrism& prism, const Vec3& shift, Pcg& pcg) {
    Vec2 b = pcg.two();
    if (b.x + b.y > 1.0f) b = Vec2(1.0f - b.x, 1.0f - b.y);
    const std::array<float, 3> weights{1.0f - b.x - b.y, b.x, b.y};
    const float depth = 2.0f * pcg.one() - 1.0f;
    Vec3 p(0.0f);
    for (size_t i = 0; i < 3; ++i) {
        const MovingPrism::Corner& c = prism.corners[i];
        p += (c.p + c.half * depth + c.motion[0] * shift.x + c.motion[1] * shift.y +
              c.motion[2] * shift.z) *
             weights[i];
    }
    return p;
}

// Finds each of many prisms from a point in it, for some shift; returns how many others a query
// comes to, on average.
double visited_by_queries(PrismTree::Volumes volumes, uint64_t seed) {
    Pcg pcg(seed);
    std::vector<MovingPrism> prisms;
    for (int i = 0; i < 3000; ++i) prisms.push_back(prism(pcg, i % 100 == 0));
    std::vector<uint32_t> order;
    const PrismTree tree(
        static_cast<uint32_t>(prisms.size()), [&](uint32_t i) { return prisms[i]; }, kReach, order,
        volumes);
    size_t visited = 0;
    for (uint32_t i = 0; i < prisms.size(); ++i) {
        const Vec3 shift = direction(pcg) * (0.99f * kReach * pcg.one());
        const Vec3 told = volumes == PrismTree::Volumes::move ? shift : Vec3(0.0f);
        std::set<uint32_t> found;
        tree.visit(point_in(prisms[i], shift, pcg), told, [&](uint32_t k) {
            EXPECT_TRUE(found.insert(order[k]).second) << k << " twice";
            return true;
        });
        EXPECT_EQ(found.count(i), 1u) << i;
        visited += found.size();
    }
    return static_cast<double>(visited) / static_cast<double>(prisms.size());
}

TEST(PrismTree, FindsThePrismsThatHoldAPoint) {
    EXPECT_LT(visited_by_queries(PrismTree::Volumes::move, 1), 60.0);
}
TEST(PrismTree, FindsThePrismsThatMayHoldAPoint) {
    EXPECT_LT(visited_by_queries(PrismTree::Volumes::stay, 2), 60.0);
}

bool no_prism(uint32_t) {
    ADD_FAILURE();
    return true;
}

TEST(PrismTree, TakesDegeneratePrisms) {
    const Vec3 zero(0.0f);
    const MovingPrism::Corner corner{Vec3(1, 2, 3), zero, {zero, zero, zero}};
    const MovingPrism point{{corner, corner, corner}};
    std::vector<uint32_t> order;
    const PrismTree tree(
        9, [&](uint32_t) { return point; }, kReach, order);
    size_t found = 0;
    tree.visit(Vec3(1, 2, 3), Vec3(0.0f), [&](uint32_t) { return ++found < 20; });
    EXPECT_EQ(found, 9u);
    found = 0;
    tree.visit(Vec3(1, 2, 3), Vec3(0.0f), [&](uint32_t) { return ++found < 4; });
    EXPECT_EQ(found, 4u);
    tree.visit(Vec3(1, 2, 3.1f), Vec3(0.0f), no_prism);
}

TEST(PrismTree, MayBeEmpty) {
    const PrismTree tree;
    tree.visit(Vec3(0.0f), Vec3(0.0f), no_prism);
}

}  // namespace
}  // namespace spc
