// SPDX-License-Identifier: GPL-3.0-or-later
// The keyed random streams: stratified over a pixel's samples, independent of everything else,
// uniform.
#include "core/random.h"

#include "support/chi_square.h"

#include <gtest/gtest.h>

#include <set>

namespace spc {
namespace {

// Counts points in every elementary interval of 2^a x 2^b cells.
std::vector<int> interval_counts(const std::vector<Vec2>& points, int a, int b) {
    std::vector<int> counts(size_t{1} << (a + b));
    for (const Vec2& p : points) {
        const auto i = static_cast<size_t>(p.x * static_cast<float>(1 << a));
        const auto j = static_cast<size_t>(p.y * static_cast<float>(1 << b));
        ++counts.at((i << b) + j);
    }
    return counts;
}

// A (0, 2)-sequence: each aligned run of 2^m samples has one point in every elementary interval of
// area 2^-m.
TEST(Sampler, EveryAlignedRunIsANet) {
    for (const uint32_t pixel : {0u, 1u, 77u, 0xfffffffeu})
        for (int m = 0; m <= 10; ++m)
            for (const uint32_t run : {0u, 1u, 5u, 0xffffffffu >> m}) {
                std::vector<Vec2> points;
                for (uint32_t i = 0; i < 1u << m; ++i)
                    points.push_back(
                        Sampler(3, pixel, (run << m) + i).vertex(2)[Domain::light].two());
                for (int a = 0; a <= m; ++a)
                    for (const int count : interval_counts(points, a, m - a))
                        ASSERT_EQ(count, 1) << "pixel " << pixel << ", run " << run << " of 2^" << m
                                            << ", cells 2^" << a;
            }
}

// The three numbers of one draw: the pair (y, z) is a net, x by itself is stratified, and together
// they are a (1, 3)-sequence, the best there is in base 2: each aligned run of 2^m samples has two
// points in every elementary interval of volume 2^(1 - m).
TEST(Sampler, ThreeAreStratifiedTogether) {
    constexpr int m = 9;
    std::vector<Vec3> points;
    for (uint32_t i = 0; i < 1u << m; ++i)
        points.push_back(Sampler(1, 9, (5u << m) + i)[Domain::closure].three());
    const auto counts = [&](int a, int b, int c) {
        std::vector<int> found(size_t{1} << (a + b + c));
        for (const Vec3& u : points) {
            const auto i = static_cast<size_t>(u.x * static_cast<float>(1 << a));
            const auto j = static_cast<size_t>(u.y * static_cast<float>(1 << b));
            const auto k = static_cast<size_t>(u.z * static_cast<float>(1 << c));
            ++found.at((((i << b) + j) << c) + k);
        }
        return found;
    };
    for (int b = 0; b <= m; ++b)
        for (const int count : counts(0, b, m - b)) ASSERT_EQ(count, 1) << b;
    for (const int count : counts(m, 0, 0)) ASSERT_EQ(count, 1);
    for (int a = 0; a < m; ++a)
        for (int b = 0; a + b < m; ++b)
            for (const int count : counts(a, b, m - 1 - a - b))
                ASSERT_EQ(count, 2) << a << " " << b;
}

TEST(Sampler, OneIsTheFirstOfTwo) {
    for (uint32_t i = 0; i < 1000; ++i) {
        const Sampler sampler(i, 7 * i, 3 * i);
        EXPECT_EQ(sampler.one(), sampler.two().x);
    }
}

TEST(Sampler, NumbersLieInTheHalfOpenUnitInterval) {
    for (uint32_t i = 0; i < 200000; ++i) {
        const Sampler s(i * 7919u, i * 104729u, i * 2654435761u);
        const Vec3 u = s[Domain::film].three();
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(u[k] >= 0.0f && u[k] < 1.0f);
    }
    EXPECT_LT(to_unit_float(0xffffffffu), 1.0f);
    EXPECT_EQ(to_unit_float(0), 0.0f);
}

// Pearson's correlation of two equally long streams.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (size_t i = 0; i < a.size(); ++i) ma += a[i], mb += b[i];
    ma /= double(a.size()), mb /= double(a.size());
    for (size_t i = 0; i < a.size(); ++i) {
        aa += (a[i] - ma) * (a[i] - ma);
        bb += (b[i] - mb) * (b[i] - mb);
        ab += (a[i] - ma) * (b[i] - mb);
    }
    return ab / std::sqrt(aa * bb);
}

// Hypothesis: two streams of a path that differ in one part of their key are independent. Their
// joint distribution over pixels (one sample index each, so stratification plays no part) is tested
// by chi-square on a grid, and over the samples of one pixel by correlation, whose standard
// deviation is 1/sqrt(n) at most.
TEST(Sampler, StreamsAreIndependent) {
    using Draw = Vec2 (*)(uint32_t pixel, uint32_t index);
    struct Pair {
        const char* name;
        Draw a, b;
    };
    const Pair pairs[] = {
        {"domains", [](uint32_t p, uint32_t i) { return Sampler(0, p, i)[Domain::light].two(); },
         [](uint32_t p, uint32_t i) { return Sampler(0, p, i)[Domain::closure].two(); }},
        {"vertices",
         [](uint32_t p, uint32_t i) { return Sampler(0, p, i).vertex(0)[Domain::light].two(); },
         [](uint32_t p, uint32_t i) { return Sampler(0, p, i).vertex(1)[Domain::light].two(); }},
        {"film and the first vertex",
         [](uint32_t p, uint32_t i) { return Sampler(0, p, i)[Domain::film].two(); },
         [](uint32_t p, uint32_t i) { return Sampler(0, p, i).vertex(0)[Domain::closure].two(); }},
        {"neighbours",
         [](uint32_t p, uint32_t i) { return Sampler(0, 2 * p, i)[Domain::light].two(); },
         [](uint32_t p, uint32_t i) { return Sampler(0, 2 * p + 1, i)[Domain::light].two(); }},
        {"seeds", [](uint32_t p, uint32_t i) { return Sampler(0, p, i)[Domain::light].two(); },
         [](uint32_t p, uint32_t i) { return Sampler(1, p, i)[Domain::light].two(); }},
        {"first and rest of three",
         [](uint32_t p, uint32_t i) {
             const Vec3 u = Sampler(0, p, i).three();
             return Vec2(u.x, u.x);
         },
         [](uint32_t p, uint32_t i) {
             const Vec3 u = Sampler(0, p, i).three();
             return Vec2(u.y, u.z);
         }},
    };
    constexpr int kGrid = 16;
    constexpr uint32_t kPixels = 1u << 16, kSamples = 1024, kShownPixels = 64;
    const int comparisons = int(std::size(pairs)) * 4 * 2;
    const double significance = test::sidak(1e-4, comparisons);
    for (const Pair& pair : pairs)
        for (const int ca : {0, 1})
            for (const int cb : {0, 1}) {
                std::vector<int64_t> observed(kGrid * kGrid);
                for (uint32_t p = 0; p < kPixels; ++p) {
                    const auto i = size_t(pair.a(p, 5)[ca] * kGrid),
                               j = size_t(pair.b(p, 5)[cb] * kGrid);
                    ++observed[i * kGrid + j];
                }
                const std::vector<double> expected(observed.size(),
                                                   double(kPixels) / double(observed.size()));
                const test::ChiSquare over_pixels = test::chi_square(observed, expected);
                EXPECT_TRUE(over_pixels.passes(significance))
                    << pair.name << ": " << over_pixels.text();

                // The mean over pixels of correlations over samples: zero, with a known bound of
                // its spread.
                test::MeanEstimate mean;
                for (uint32_t p = 0; p < kShownPixels; ++p) {
                    std::vector<double> a, b;
                    for (uint32_t i = 0; i < kSamples; ++i) {
                        a.push_back(double(pair.a(p, i)[ca]));
                        b.push_back(double(pair.b(p, i)[cb]));
                    }
                    const double r = correlation(a, b);
                    EXPECT_LT(std::abs(r), 6.0 / std::sqrt(double(kSamples)))
                        << pair.name << ", pixel " << p;
                    mean.add(r);
                }
                EXPECT_TRUE(test::is_mean(mean, 0.0, significance)) << pair.name;
            }
}

// Over pixels at one index the numbers are uniform in both dimensions together: nothing is shared
// between pixels.
TEST(Sampler, UniformOverPixels) {
    for (const uint32_t index : {0u, 1u, 1000003u}) {
        std::vector<int64_t> observed(32 * 32);
        constexpr uint32_t kPixels = 1u << 17;
        for (uint32_t p = 0; p < kPixels; ++p) {
            const Vec2 u = Sampler(12, p, index).vertex(0)[Domain::closure].two();
            ++observed[size_t(u.x * 32) * 32 + size_t(u.y * 32)];
        }
        const test::ChiSquare result = test::chi_square(
            observed, std::vector<double>(observed.size(), double(kPixels) / 1024.0));
        EXPECT_TRUE(result.passes(test::sidak(1e-4, 3))) << result.text();
    }
}

TEST(Sampler, StreamSeedsDiffer) {
    std::set<uint64_t> seeds;
    for (uint32_t p = 0; p < 100; ++p)
        for (uint32_t i = 0; i < 100; ++i)
            for (uint32_t v = 0; v < 5; ++v)
                seeds.insert(Sampler(0, p, i).vertex(v)[Domain::manifold_seeds].stream_seed());
    EXPECT_EQ(seeds.size(), 50000u);
}

// Points in a random box of a tenth of the volume: independent ones would have a variance of 0.9
// N/10.
TEST(LatticePoint, LiesEvenlyHoweverManyThereAre) {
    Pcg pcg(3);
    for (const uint32_t count : {12u, 50u, 300u}) {
        double squares = 0.0;
        constexpr int kRounds = 4000;
        for (int round = 0; round < kRounds; ++round) {
            const Vec3 shift(pcg.one(), pcg.one(), pcg.one()),
                size(0.3f + 0.5f * pcg.one(), 0.3f + 0.5f * pcg.one(), 0.0f);
            const Vec3 side(size.x, size.y, 0.1f / (size.x * size.y));
            const Vec3 lower((1.0f - side.x) * pcg.one(), (1.0f - side.y) * pcg.one(),
                             (1.0f - side.z) * pcg.one());
            int inside = 0;
            for (uint32_t i = 0; i < count; ++i) {
                const Vec3 p = lattice_point(shift, i);
                bool in = true;
                for (int k = 0; k < 3; ++k) {
                    ASSERT_TRUE(p[k] >= 0.0f && p[k] < 1.0f);
                    in = in && p[k] >= lower[k] && p[k] < lower[k] + side[k];
                }
                inside += in;
            }
            squares += std::pow(inside - 0.1 * count, 2.0);
        }
        EXPECT_LT(squares / kRounds, (count > 100 ? 0.15 : 0.5) * 0.09 * count) << count;
    }
}

// Of a box of any place: what is random is `shift` alone.
TEST(LatticePoint, EachIsUniform) {
    for (const uint32_t i : {0u, 1u, 11u, 100000u})
        for (int k = 0; k < 3; ++k) {
            std::vector<int> counts(32);
            for (int j = 0; j < 3200; ++j) {
                const Vec3 shift((static_cast<float>(j) + 0.5f) / 3200.0f);
                ++counts.at(static_cast<size_t>(lattice_point(shift, i)[k] * 32.0f));
            }
            for (const int count : counts) EXPECT_NEAR(count, 100, 1);
        }
}

TEST(Pcg, MomentsAndPairs) {
    constexpr int kDraws = 1 << 20;
    Pcg pcg(42);
    test::MeanEstimate first, second, product;
    double previous = double(pcg.one());
    for (int i = 0; i < kDraws; ++i) {
        const double u = double(pcg.one());
        first.add(u);
        second.add(u * u);
        product.add(u * previous);
        previous = u;
    }
    const double significance = test::sidak(1e-4, 4);
    EXPECT_TRUE(test::is_mean(first, 0.5, significance));
    EXPECT_TRUE(test::is_mean(second, 1.0 / 3, significance));
    EXPECT_TRUE(test::is_mean(product, 0.25, significance));
    std::vector<int64_t> observed(64 * 64);
    for (int i = 0; i < kDraws; ++i) {
        const Vec2 u = pcg.two();
        ++observed[size_t(u.x * 64) * 64 + size_t(u.y * 64)];
    }
    const test::ChiSquare pairs =
        test::chi_square(observed, std::vector<double>(observed.size(), double(kDraws) / 4096));
    EXPECT_TRUE(pairs.passes(significance)) << pairs.text();
}

// The reference sequence of PCG32 [ONeill14] has its own increment; ours must at least not repeat
// or get stuck.
TEST(Pcg, SeedsGiveDifferentStreams) {
    std::set<uint64_t> starts;
    for (uint64_t seed = 0; seed < 10000; ++seed) {
        Pcg pcg(seed);
        const uint64_t high = pcg.bits();
        starts.insert(high << 32 | pcg.bits());
    }
    EXPECT_EQ(starts.size(), 10000u);
    // Streams of neighbouring seeds do not walk in step.
    std::vector<double> a, b;
    Pcg x(1), y(2);
    for (int i = 0; i < 10000; ++i) a.push_back(double(x.one())), b.push_back(double(y.one()));
    EXPECT_LT(std::abs(correlation(a, b)), 0.05);
}

}  // namespace
}  // namespace spc
