// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distribution.h"

#include "support/chi_square.h"

namespace spc::test {
namespace {

constexpr double kSignificance = 0.01;
constexpr float kBelowOne = 0x1.fffffep-1f;

TEST(DiscreteDistribution, ProbabilitiesFollowTheWeights) {
    const std::vector<float> weights = {0.0f, 1.0f, 3.0f, 0.0f, 0.5f, 0.0f};
    const DiscreteDistribution d(weights);
    ASSERT_EQ(d.size(), weights.size());
    EXPECT_DOUBLE_EQ(d.total(), 4.5);
    double sum = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(d.probability(i), weights[i] / 4.5, 1e-7);
        sum += d.probability(i);
    }
    EXPECT_NEAR(sum, 1.0, 1e-7);
}

TEST(DiscreteDistribution, IsEmptyWithoutWeight) {
    EXPECT_TRUE(DiscreteDistribution().empty());
    EXPECT_TRUE(DiscreteDistribution(std::vector<float>{}).empty());
    EXPECT_TRUE(DiscreteDistribution(std::vector<float>{0.0f, 0.0f}).empty());
}

TEST(DiscreteDistribution, SamplesTheirProbabilities) {
    const std::vector<float> weights = {0.0f, 1.0f, 3.0f, 0.0f, 0.5f, 7.0f, 0.0f, 0.01f};
    const DiscreteDistribution d(weights);
    constexpr int64_t kSamples = 200000;
    std::vector<int64_t> observed(weights.size());
    std::vector<double> expected(weights.size()), skewed(weights.size());
    Uniforms uniforms(1);
    for (int64_t i = 0; i < kSamples; ++i) {
        const DiscreteDistribution::Sample s = d.sample(uniforms());
        ASSERT_EQ(s.probability, d.probability(s.index));
        ASSERT_GT(weights[s.index], 0.0f);
        ++observed[s.index];
    }
    for (size_t i = 0; i < weights.size(); ++i) {
        expected[i] = static_cast<double>(kSamples) * weights[i] / d.total();
        skewed[i] = expected[i] * (i == 5 ? 1.02 : 1.0 - 0.02 * 7 / 4.51);
    }
    EXPECT_TRUE(chi_square(observed, expected).passes(kSignificance));
    EXPECT_FALSE(chi_square(observed, skewed).passes(kSignificance));
}

TEST(DiscreteDistribution, RemapsToTheWholeInterval) {
    const DiscreteDistribution d(std::vector<float>{1.0f, 2.0f, 1.0f});
    constexpr int kSteps = 4096;
    for (int i = 0; i < kSteps; ++i) {
        const float u = static_cast<float>(i) / kSteps;
        const DiscreteDistribution::Sample s = d.sample(u);
        const float start = s.index == 0 ? 0.0f : s.index == 1 ? 0.25f : 0.75f;
        EXPECT_NEAR(start + s.remapped * s.probability, u, 1e-6f);
        EXPECT_GE(s.remapped, 0.0f);
        EXPECT_LT(s.remapped, 1.0f);
    }
}

TEST(DiscreteDistribution, IsMonotoneSoThatStrataStay) {
    std::vector<float> weights(1000);
    Uniforms uniforms(2);
    for (float& weight : weights) weight = uniforms() < 0.3f ? 0.0f : uniforms();
    const DiscreteDistribution d(weights);
    uint32_t last = 0;
    for (int i = 0; i < 100000; ++i) {
        const uint32_t index = d.sample(static_cast<float>(i) * 1e-5f).index;
        ASSERT_GE(index, last);
        last = index;
    }
}

TEST(DiscreteDistribution, EndsOfTheIntervalAreEntriesOfWeight) {
    const DiscreteDistribution d(std::vector<float>{0.0f, 0.0f, 1.0f, 2.0f, 0.0f, 0.0f});
    EXPECT_EQ(d.sample(0.0f).index, 2u);
    EXPECT_EQ(d.sample(kBelowOne).index, 3u);
}

TEST(DiscreteDistribution, NothingThatWeighsIsOutOfReach) {
    // Twenty-four orders of magnitude, the small ones in every position.
    for (const int position : {0, 1, 2}) {
        std::vector<float> weights(3, 1e12f);
        weights[position] = 1e-12f;
        const DiscreteDistribution d(weights);
        EXPECT_GT(d.probability(position), 0.0f) << position;
        EXPECT_LT(d.probability(position), 1e-6f) << position;
    }
    std::vector<float> many(1 << 20, 1e-20f);
    many[12345] = 1.0f;
    const DiscreteDistribution d(many);
    double sum = 0;
    for (size_t i = 0; i < many.size(); ++i) {
        ASSERT_GT(d.probability(i), 0.0f) << i;
        sum += d.probability(i);
    }
    EXPECT_NEAR(sum, 1.0, 1e-7);
    EXPECT_GT(d.probability(12345), 0.85f);
}

std::vector<float> uneven_values(size_t width, size_t height) {
    std::vector<float> values(width * height);
    Uniforms uniforms(3);
    for (float& value : values) value = uniforms() < 0.2f ? 0.0f : uniforms();
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(2 * width), width,
                0.0f);  // a row that is never chosen
    return values;
}

TEST(Distribution2D, DensityIntegratesToOneAndIsProportional) {
    constexpr uint32_t kWidth = 7, kHeight = 5;
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const Distribution2D d(values, kWidth, kHeight);
    double sum = 0, mean = 0;
    for (const float value : values) mean += value / (kWidth * kHeight);
    EXPECT_NEAR(d.mean(), mean, 1e-6);
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const float pdf = d.pdf({(static_cast<float>(x) + 0.5f) / kWidth,
                                     (static_cast<float>(y) + 0.5f) / kHeight});
            EXPECT_NEAR(pdf, values[y * kWidth + x] / mean, 1e-5);
            sum += pdf / (kWidth * kHeight);
        }
    EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(Distribution2D, SamplesItsDensity) {
    constexpr uint32_t kWidth = 7, kHeight = 5, kFiner = 3;
    constexpr int64_t kSamples = 300000;
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const Distribution2D d(values, kWidth, kHeight);
    constexpr size_t kX = kWidth * kFiner, kY = kHeight * kFiner;
    std::vector<int64_t> observed(kX * kY);
    std::vector<double> expected(kX * kY);
    Uniforms uniforms(4);
    for (int64_t i = 0; i < kSamples; ++i) {
        const Distribution2D::Sample s = d.sample(uniforms.two());
        ++observed[static_cast<uint32_t>(s.position.y * kY) * kX +
                   static_cast<uint32_t>(s.position.x * kX)];
    }
    for (uint32_t y = 0; y < kY; ++y)
        for (uint32_t x = 0; x < kX; ++x)
            expected[y * kX + x] = static_cast<double>(kSamples) *
                                   values[y / kFiner * kWidth + x / kFiner] / (d.mean() * kX * kY);
    const ChiSquare fit = chi_square(observed, expected);
    EXPECT_TRUE(fit.passes(kSignificance)) << fit.text();
    for (size_t i = 0; i < expected.size(); ++i) expected[i] *= i % 2 == 0 ? 1.05 : 0.95;
    EXPECT_FALSE(chi_square(observed, expected).passes(kSignificance));
}

TEST(Distribution2D, DensityAtASampleIsTheSamples) {
    for (const uint32_t width : {1u, 3u, 257u, 4096u}) {
        constexpr uint32_t kHeight = 3;
        const std::vector<float> values = [&] {
            std::vector<float> v(static_cast<size_t>(width) * kHeight);
            Uniforms uniforms(width);
            for (float& value : v) value = 0.1f + uniforms();
            return v;
        }();
        const Distribution2D d(values, width, kHeight);
        Uniforms uniforms(5);
        for (int i = 0; i < 100000; ++i) {
            const Vec2 u = i == 0   ? Vec2(0.0f)
                           : i == 1 ? Vec2(kBelowOne, kBelowOne)
                                    : uniforms.two();
            const Distribution2D::Sample s = d.sample(u);
            ASSERT_GE(std::min(s.position.x, s.position.y), 0.0f);
            ASSERT_LT(std::max(s.position.x, s.position.y), 1.0f);
            ASSERT_EQ(s.pdf, d.pdf(s.position)) << width << " " << s.position;
        }
    }
}

}  // namespace
}  // namespace spc::test
