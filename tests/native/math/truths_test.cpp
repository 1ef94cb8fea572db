// SPDX-License-Identifier: GPL-3.0-or-later
// The truths that other tests keep.
#include "support/truths.h"

#include <gtest/gtest-spi.h>

namespace spc::test {
namespace {

constexpr uint32_t kSamples = 20000;

// Means of numbers between an offset and one more.
Estimates means_beyond(std::initializer_list<double> offsets, uint32_t samples) {
    Estimates means;
    for (const double offset : offsets) {
        Uniforms uniforms(means.size());
        MeanEstimate& mean = means.emplace_back();
        for (uint32_t i = 0; i < samples; ++i) mean.add(offset + double(uniforms()));
    }
    return means;
}
Estimates truth_beyond(std::initializer_list<double> offsets, uint32_t samples = kSamples) {
    return truth("offsets", samples, [=](uint32_t count) { return means_beyond(offsets, count); });
}

// Whether they are read from the file or, at night, found anew.
TEST(Truths, HaveAllTheirSamples) {
    const Estimates kept = truth_beyond({0.0, 5.0}), found = means_beyond({0.0, 5.0}, kSamples);
    ASSERT_EQ(kept.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(kept[i].count(), kSamples);
        EXPECT_NEAR(kept[i].mean(), found[i].mean(), 1e-8);
        EXPECT_NEAR(kept[i].standard_error(), found[i].standard_error(), 1e-10);
    }
}

// A share of the samples has a standard error of a hundredth here.
TEST(Truths, NoticeThatBruteForceFindsAnother) {
    truth_beyond({0.0, 5.0});
    if (writes_truths()) GTEST_SKIP() << "whatever it is, it is kept";
    EXPECT_NONFATAL_FAILURE(truth_beyond({0.0, 5.06}), "brute force finds 5.5");
    EXPECT_FATAL_FAILURE(truth_beyond({0.0}), "truth of offsets");
    EXPECT_NONFATAL_FAILURE(truth_beyond({0.0, 5.0}, kSamples / 2), "no truth of offsets");
}

}  // namespace
}  // namespace spc::test
