// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distribution.h"

#include "support/chi_square.h"

#include <numeric>

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

constexpr uint32_t kWidth = 7, kHeight = 5;

bool everywhere(uint32_t, uint32_t) { return true; }

// What lies at the centres of texels, interpolated: periodic in x, zero above and below.
double interpolated(const std::vector<float>& values, double x, double y) {
    const auto row = [&](int j, double t) {
        if (j < 0) return 0.0;
        const int i = static_cast<int>(std::floor(t)), w = static_cast<int>(kWidth);
        const auto at = [&](int k) {
            return static_cast<double>(values[static_cast<size_t>(j * w + (k + w) % w)]);
        };
        return at(i) + (at(i + 1) - at(i)) * (t - i);
    };
    const double column = x * kWidth - 0.5, h = kHeight;
    if (y < 0.5 / h) return row(0, column) * 2.0 * h * y;
    if (y > 1.0 - 0.5 / h) return row(kHeight - 1, column) * 2.0 * h * (1.0 - y);
    const double line = std::min(y * h - 0.5, h - 1.0 - 1e-9);
    const int j = static_cast<int>(line);
    return row(j, column) + (row(j + 1, column) - row(j, column)) * (line - j);
}

// Twice as fine as cells, so that none of them lies in two.
constexpr size_t kBinsX = 2 * kWidth, kBinsY = 2 * kHeight;

// Means of `value` over bins.
template <class Value>
std::vector<double> over_bins(const Value& value) {
    constexpr size_t kSteps = 16;
    std::vector<double> means(kBinsX * kBinsY);
    for (size_t y = 0; y < kBinsY * kSteps; ++y)
        for (size_t x = 0; x < kBinsX * kSteps; ++x)
            means[y / kSteps * kBinsX + x / kSteps] +=
                value((static_cast<double>(x) + 0.5) / (kBinsX * kSteps),
                      (static_cast<double>(y) + 0.5) / (kBinsY * kSteps)) /
                (kSteps * kSteps);
    return means;
}

double mean_of(const std::vector<double>& values) {
    return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

TEST(BilinearMap, DensityIsThatOfTheInterpolatedValues) {
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const BilinearMap map(values, kWidth, kHeight);
    const BilinearMap::Cells all = map.cells(everywhere);
    const double mean =
        mean_of(over_bins([&](double x, double y) { return interpolated(values, x, y); }));
    EXPECT_NEAR(all.mean, mean, 1e-5);
    Uniforms uniforms(6);
    for (int i = 0; i < 20000; ++i) {
        const Vec2 p = uniforms.two();
        EXPECT_NEAR(map.pdf(all, p),
                    interpolated(values, static_cast<double>(p.x), static_cast<double>(p.y)) / mean,
                    1e-4)
            << p;
    }
}

TEST(BilinearMap, SamplesItsDensity) {
    constexpr int64_t kSamples = 300000;
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const BilinearMap map(values, kWidth, kHeight);
    const BilinearMap::Cells all = map.cells(everywhere);
    const BilinearMap::Cells part =
        map.cells([](uint32_t x, uint32_t y) { return x == 0 && y > 2; });
    for (const BilinearMap::Cells* cells : {&all, &part}) {
        std::vector<int64_t> observed(kBinsX * kBinsY);
        Uniforms uniforms(4);
        for (int64_t i = 0; i < kSamples; ++i) {
            const BilinearMap::Sample s = map.sample(*cells, uniforms.two());
            ++observed[static_cast<size_t>(s.position.y * kBinsY) * kBinsX +
                       static_cast<size_t>(s.position.x * kBinsX)];
        }
        std::vector<double> expected = over_bins([&](double x, double y) {
            return static_cast<double>(
                map.pdf(*cells, {static_cast<float>(x), static_cast<float>(y)}));
        });
        EXPECT_NEAR(mean_of(expected), 1.0, 1e-3);
        for (double& count : expected) count *= static_cast<double>(kSamples) / (kBinsX * kBinsY);
        const ChiSquare fit = chi_square(observed, expected);
        EXPECT_TRUE(fit.passes(kSignificance)) << fit.text();
        for (size_t i = 0; i < expected.size(); ++i) expected[i] *= i % 2 == 0 ? 1.05 : 0.95;
        EXPECT_FALSE(chi_square(observed, expected).passes(kSignificance));
    }
}

TEST(BilinearMap, SomeCellsHaveTheSameDensityAndTheOthersNone) {
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const BilinearMap map(values, kWidth, kHeight);
    const BilinearMap::Cells all = map.cells(everywhere);
    const BilinearMap::Cells part =
        map.cells([](uint32_t x, uint32_t y) { return x == 6 && y == 3; });
    Uniforms uniforms(7);
    for (int i = 0; i < 20000; ++i) {
        const Vec2 p = uniforms.two();
        // Cells around the centre of texel (6, 3): from that of column 5 to that of 0.
        const bool inside = (p.x > 5.5f / kWidth || p.x < 0.5f / kWidth) && p.y > 2.5f / kHeight &&
                            p.y < 4.5f / kHeight;
        const double expected =
            inside ? static_cast<double>(map.pdf(all, p)) * all.mean / part.mean : 0.0;
        EXPECT_NEAR(map.pdf(part, p), expected, 1e-4 * expected) << p;
    }
    EXPECT_TRUE(map.cells([](uint32_t, uint32_t) { return false; }).empty());
}

TEST(BilinearMap, IsEmptyWithoutValues) {
    const BilinearMap map(std::vector<float>(kWidth * kHeight), kWidth, kHeight);
    EXPECT_TRUE(map.cells(everywhere).empty());
}

// Hypothesis: of what is interpolated like it, the ratio of value to density is the same
// everywhere, so that nothing of a sum over samples is left to chance.
TEST(BilinearMap, RatioOfValueToDensityIsTheMean) {
    const std::vector<float> values = uneven_values(kWidth, kHeight);
    const BilinearMap map(values, kWidth, kHeight);
    const BilinearMap::Cells all = map.cells(everywhere);
    Uniforms uniforms(8);
    for (int i = 0; i < 20000; ++i) {
        const BilinearMap::Sample s = map.sample(all, uniforms.two());
        const double value = interpolated(values, static_cast<double>(s.position.x),
                                          static_cast<double>(s.position.y));
        EXPECT_NEAR(value / static_cast<double>(s.pdf), all.mean, 2e-3 * all.mean) << s.position;
    }
}

TEST(BilinearMap, DensityAtASampleIsTheSamples) {
    for (const uint32_t width : {1u, 3u, 257u, 4096u}) {
        constexpr uint32_t kRows = 3;
        const std::vector<float> values = [&] {
            std::vector<float> v(static_cast<size_t>(width) * kRows);
            Uniforms uniforms(width);
            for (float& value : v) value = 0.1f + uniforms();
            return v;
        }();
        const BilinearMap map(values, width, kRows);
        const BilinearMap::Cells all = map.cells(everywhere);
        const BilinearMap::Cells part =
            map.cells([](uint32_t x, uint32_t y) { return x % 7 == 0 && y == 1; });
        for (const BilinearMap::Cells* cells : {&all, &part}) {
            Uniforms uniforms(5);
            for (int i = 0; i < 100000; ++i) {
                const Vec2 u = i == 0   ? Vec2(0.0f)
                               : i == 1 ? Vec2(kBelowOne, kBelowOne)
                                        : uniforms.two();
                const BilinearMap::Sample s = map.sample(*cells, u);
                ASSERT_GE(std::min(s.position.x, s.position.y), 0.0f);
                ASSERT_LT(std::max(s.position.x, s.position.y), 1.0f);
                ASSERT_GT(s.pdf, 0.0f) << width << " " << s.position;
                ASSERT_EQ(s.pdf, map.pdf(*cells, s.position)) << width << " " << s.position;
            }
        }
    }
}

}  // namespace
}  // namespace spc::test
