// SPDX-License-Identifier: GPL-3.0-or-later
#include "light/light_tree.h"

#include "light/bench.h"
#include "math/warp.h"
#include "support/chi_square.h"

namespace spc::test {
namespace {

constexpr double kSignificance = 0.01;
constexpr double kEvenShare = 0.1;

LightBounds point(float strength, const Vec3& center) {
    return {.strength = strength, .center = center};
}

// Of every kind, anywhere in a cube of 4 m; some never chosen.
std::vector<LightBounds> mixed_lights(uint32_t count, uint64_t seed) {
    Uniforms uniforms(seed);
    std::vector<LightBounds> lights(count);
    for (LightBounds& light : lights) {
        light.strength = uniforms() < 0.1f ? 0.0f : 0.1f + 10.0f * uniforms();
        light.distant = uniforms() < 0.05f;
        light.center = (uniforms.three() - Vec3(0.5f)) * 4.0f;
        light.radius = uniforms() < 0.5f ? 0.0f : 0.5f * uniforms();
        const float kind = uniforms();
        if (kind < 0.3f) continue;
        light.cosine = kind < 0.6f;
        light.beam = {normalize(uniforms.three() - Vec3(0.5f)),
                      light.cosine ? 1.0f : 0.02f + uniforms()};
    }
    return lights;
}

TEST(LightTree, ProbabilitiesAddUpEverywhere) {
    for (const uint32_t count : {1u, 2u, 3u, 40u, 700u}) {
        const std::vector<LightBounds> lights = mixed_lights(count, 10 + count);
        const LightTree tree(lights);
        Uniforms uniforms(1);
        for (int i = 0; i < 200; ++i) {
            const Vec3 p = (uniforms.three() - Vec3(0.5f)) * (i % 2 == 0 ? 4.0f : 40.0f);
            const LitPoint at(p, i % 3 == 0 ? Vec3(0.0f) : normalize(uniforms.three() - Vec3(0.5f)));
            double sum = 0;
            for (uint32_t light = 0; light < count; ++light) {
                const float share = tree.probability(light, at);
                EXPECT_EQ(share > 0.0f, lights[light].strength > 0.0f);
                sum += static_cast<double>(share);
            }
            ASSERT_NEAR(sum, 1.0, 1e-5) << count << " " << p;
        }
    }
}

TEST(LightTree, ChoosesByItsProbabilities) {
    constexpr int64_t kSamples = 200000;
    constexpr uint32_t kCount = 60;
    const LightTree tree(mixed_lights(kCount, 2));
    Uniforms uniforms(3);
    const LitPoint points[] = {Vec3(0.0f),
                               {Vec3(1.9f, -1.5f, 0.3f), Vec3(0, 0, 1)},
                               {Vec3(30, 0, 0), Vec3(-1, 0, 0)},
                               {Vec3(30, 0, 0), Vec3(1, 0, 0)}};
    for (const LitPoint& p : points) {
        std::vector<int64_t> observed(kCount);
        std::vector<double> expected(kCount);
        for (int64_t i = 0; i < kSamples; ++i) {
            const LightTree::Sample s = tree.sample(p, uniforms());
            ASSERT_EQ(s.probability, tree.probability(s.light, p));
            ++observed[s.light];
        }
        for (uint32_t i = 0; i < kCount; ++i)
            expected[i] = static_cast<double>(tree.probability(i, p)) * kSamples;
        const ChiSquare fit = chi_square(observed, expected);
        EXPECT_TRUE(fit.passes(kSignificance / 4)) << fit.text();
        for (uint32_t i = 0; i < kCount; ++i) expected[i] *= i % 2 == 0 ? 1.06 : 0.94;
        EXPECT_FALSE(chi_square(observed, expected).passes(kSignificance / 4));
    }
}

// What shines on others has its part of the even choice, and no more.
TEST(LightTree, LightsOnOthersAreNotImportant) {
    constexpr uint32_t kCount = 64;
    Uniforms uniforms(7);
    std::vector<LightBounds> lights(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        lights[i] = point(1.0f + static_cast<float>(i), uniforms.three() * 4.0f);
        lights[i].distant = i % 7 == 0;
        lights[i].receivers = uint64_t{i % 4};  // all, or 1, 2, or both
    }
    const LightTree tree(lights);
    for (int i = 0; i < 200; ++i) {
        const Vec3 p = (uniforms.three() - Vec3(0.5f)) * 6.0f;
        for (const uint64_t receives : {0, 1, 2, 3, 4}) {
            const LitPoint at(p, Vec3(0.0f), receives);
            double sum = 0.0;
            for (uint32_t light = 0; light < kCount; ++light) {
                const float share = tree.probability(light, at);
                if (!is_linked(lights[light].receivers, receives)) {
                    EXPECT_NEAR(share, kEvenShare / kCount, 1e-6);
                }
                sum += static_cast<double>(share);
            }
            EXPECT_NEAR(sum, 1.0, 1e-5) << receives;
        }
    }
}

// As a sum over all lights of what each sample would add: 1 for each light, whichever finds it.
TEST(LightTree, TwoSamplesHaveTheMeanOfOne) {
    constexpr int kSamples = 400000;
    constexpr uint32_t kCount = 40;
    const LightTree tree(mixed_lights(kCount, 4));
    Uniforms uniforms(5);
    const LitPoint points[] = {
        Vec3(0.0f), {Vec3(1.9f, -1.5f, 0.3f), Vec3(0, 0, 1)}, {Vec3(30, 0, 0), Vec3(1, 0, 0)}};
    for (const LitPoint& p : points) {
        std::vector<double> sum(kCount), squares(kCount);
        const auto add = [&](const LightTree::Sample& s) {
            ASSERT_NEAR(s.probability, tree.probability(s.light, p), 1e-6f * s.probability);
            const double value = static_cast<double>(s.weight / s.probability);
            sum[s.light] += value;
            squares[s.light] += value * value;
        };
        for (int i = 0; i < kSamples; ++i) {
            add(tree.first_of_two(p, uniforms()));
            if (uniforms() < LightTree::kSecond) add(tree.second_of_two(p, uniforms()));
        }
        for (uint32_t i = 0; i < kCount; ++i) {
            if (tree.probability(i, p) == 0.0f) continue;
            EXPECT_NEAR(sum[i], kSamples, 5.0 * std::sqrt(squares[i])) << i << " " << p.p;
            EXPECT_LT(std::sqrt(squares[i]), 0.05 * kSamples);
        }
    }
}

// Where importance is right, two samples differ by next to nothing, one by a tenth.
TEST(LightTree, OfOneLightThatShinesTheFirstOfTwoHasNearlyAll) {
    const std::vector<LightBounds> lights = {
        point(1, {0, 0, 1}), {.strength = 1, .center = {3, 0, 1}, .beam = {Vec3(0, 0, 1), 0.1f}}};
    const LightTree tree(lights);
    const LitPoint at(Vec3(0.0f), Vec3(0, 0, 1));
    const LightTree::Sample first = tree.first_of_two(at, 0.7f);
    EXPECT_EQ(first.light, 0u);
    EXPECT_NEAR(first.weight / first.probability, 1.0f / (1.0f + sqr(LightTree::kSecond / 2)),
                1e-5f);
}

TEST(LightTree, NearLightsAreChosenByTheSquareOfTheirDistance) {
    const std::vector<LightBounds> two = {point(1, {0, 0, 1}), point(1, {0, 0, -3})};
    const LightTree tree(two);
    EXPECT_NEAR(tree.probability(0, Vec3(0.0f)), 0.5 * kEvenShare + (1 - kEvenShare) * 0.9, 1e-5);
    const std::vector<LightBounds> with_sun = {
        point(1, {0, 0, 1}), {.distant = true, .strength = 3, .center = {0, 0.8f, 0.6f}}};
    const LightTree beside_sun(with_sun);
    EXPECT_NEAR(beside_sun.probability(0, Vec3(0.0f)), 0.5 * kEvenShare + (1 - kEvenShare) * 0.25,
                1e-5);
    // By the cosines on the side that is lit.
    EXPECT_NEAR(beside_sun.probability(0, {Vec3(0.0f), Vec3(0, 0, 1)}),
                0.5 * kEvenShare + (1 - kEvenShare) / (1 + 3 * 0.6), 1e-5);
    EXPECT_NEAR(beside_sun.probability(0, {Vec3(0.0f), Vec3(0, 1, 0)}), 0.5 * kEvenShare, 1e-5);
    EXPECT_NEAR(beside_sun.probability(0, {Vec3(0.0f), Vec3(0, 0, -1)}), 0.5, 1e-5);
}

// No bound of a node hides a light: wherever it shines, it has more than its part of the even
// share.
TEST(LightTree, WhatShinesOnAPointIsFoundByTheTreeThere) {
    constexpr uint32_t kCount = 300;
    const std::vector<LightBounds> lights = mixed_lights(kCount, 5);
    const LightTree tree(lights);
    const auto chosen = static_cast<double>(std::count_if(
        lights.begin(), lights.end(), [](const LightBounds& l) { return l.strength > 0.0f; }));
    Uniforms uniforms(6);
    int lit = 0, dark = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = (uniforms.three() - Vec3(0.5f)) * 8.0f;
        const LitPoint at(p, i % 3 == 0 ? Vec3(0.0f) : normalize(uniforms.three() - Vec3(0.5f)));
        for (uint32_t light = 0; light < kCount; ++light) {
            const LightBounds& l = lights[light];
            if (l.distant || !(l.strength > 0.0f)) continue;
            // From a point of its sphere.
            const Vec3 y = l.center + uniform_sphere(uniforms.two()) * (0.999f * l.radius);
            const Vec3 wi = normalize(y - p);
            const float cos = -dot(wi, l.beam.axis);
            const bool shines = (at.n == Vec3(0.0f) || dot(at.n, wi) > 1e-3f) &&
                                (l.cosine ? cos > 1e-3f : 1.0f - cos < l.beam.one_minus_cos - 1e-3f);
            const bool found = static_cast<double>(tree.probability(light, at)) >
                               (1.0 + 1e-6) * kEvenShare / chosen;
            if (shines) {
                ++lit;
                EXPECT_TRUE(found) << light << " " << p;
            } else {
                dark += !found;
            }
        }
    }
    EXPECT_GT(lit, 100000);
    EXPECT_GT(dark, 50000);  // and many a light is left to the even share where it does not shine
}

TEST(LightTree, StandsLightsInOnePlaceAndExtremes) {
    std::vector<LightBounds> lights(1000, point(1, {1, 2, 3}));
    lights[7].strength = 1e12f;
    lights[8].strength = 1e-12f;
    const LightTree tree(lights);
    for (const Vec3& p : {Vec3(1, 2, 3), Vec3(0.0f), Vec3(1e6f, 0, 0)}) {
        for (const uint32_t light : {0u, 7u, 8u, 999u}) {
            const float share = tree.probability(light, p);
            EXPECT_TRUE(std::isfinite(share) && share > 0.0f) << light << " " << p;
        }
        EXPECT_GT(tree.probability(7, p), 0.75f);
    }
    // Strengths whose sums and quotients by squared distances single precision cannot hold.
    for (const float unit : {1e-30f, 1e20f, 1e37f}) {
        std::vector<LightBounds> alike;
        for (int i = 0; i < 20; ++i) alike.push_back(point(1, Vec3(0.1f * float(i), 0, 0)));
        const LightTree plain(alike);
        for (LightBounds& light : alike) light.strength *= unit;
        const LightTree scaled(alike);
        for (const Vec3& p : {Vec3(0.0f), Vec3(1e-5f, 0, 0), Vec3(1, 2, 3), Vec3(1e8f, 0, 0)})
            for (uint32_t light = 0; light < 20; ++light)
                EXPECT_NEAR(scaled.probability(light, p), plain.probability(light, p), 1e-5f)
                    << unit << " " << light << " " << p;
    }
    EXPECT_TRUE(LightTree().empty());
    EXPECT_TRUE(LightTree(std::vector<LightBounds>(3)).empty());
    EXPECT_EQ(LightTree(std::vector<LightBounds>(3)).probability(1, Vec3(0.0f)), 0.0f);
}

}  // namespace
}  // namespace spc::test
