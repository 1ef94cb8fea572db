// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace spc {
namespace {

TEST(ParallelFor, ActsOnceOnEachIndex) {
    for (const uint32_t threads : {0u, 1u, 3u, 64u})
        for (const uint32_t count : {0u, 1u, 2u, 1000u}) {
            std::vector<std::atomic<int>> acted(count);
            parallel_for(threads, count, [&](uint32_t i) { ++acted[i]; });
            for (const std::atomic<int>& times : acted) EXPECT_EQ(times, 1);
        }
}

TEST(ParallelFor, ThrowsWhatARoundThrowsAndEndsEarly) {
    constexpr uint32_t kCount = 1u << 20;
    for (const uint32_t threads : {1u, 4u}) {
        std::atomic<uint32_t> acted{0};
        const auto run = [&] {
            parallel_for(threads, kCount, [&](uint32_t i) {
                ++acted;
                if (i == 3) throw std::runtime_error("third");
            });
        };
        EXPECT_THROW(run(), std::runtime_error);
        EXPECT_GE(acted, 4u);
        EXPECT_LT(acted, kCount);
    }
}

TEST(InOrder, CallsInOrderWhoeverComesFirst) {
    InOrder in_order;
    std::vector<int> called;
    for (const int i : {2, 1, 4}) in_order.call(i, [&called, i] { called.push_back(i); });
    EXPECT_TRUE(called.empty());
    in_order.call(0, [&called] { called.push_back(0); });
    EXPECT_EQ(called, (std::vector{0, 1, 2}));
    in_order.call(3, [&called] { called.push_back(3); });
    EXPECT_EQ(called, (std::vector{0, 1, 2, 3, 4}));
}

TEST(InOrder, IsSafeOnSeveralThreads) {
    constexpr uint32_t kCount = 10000;
    InOrder in_order;
    std::vector<uint32_t> called;
    parallel_for(4, kCount, [&](uint32_t i) {
        const uint32_t number = i ^ 7;
        in_order.call(number, [&called, number] { called.push_back(number); });
    });
    ASSERT_EQ(called.size(), kCount);
    for (uint32_t i = 0; i < kCount; ++i) EXPECT_EQ(called[i], i);
}

}  // namespace
}  // namespace spc
