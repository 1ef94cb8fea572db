// SPDX-License-Identifier: GPL-3.0-or-later
// Procedural textures: known facts of their patterns, and in every mode the derivatives that
// differences say. That they are Cycles' is told by tests/blender/test_nodes_against_cycles.py.
#include "shading/textures.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

constexpr std::array<FractalType, 5> kFractalTypes{FractalType::fbm, FractalType::multifractal,
                                                   FractalType::hybrid, FractalType::ridged,
                                                   FractalType::hetero_terrain};

// f over one dual or float along a line: how many of its slopes, away from jumps, are differences'.
template <class Function>
int agreeing_slopes(const Function& f, float origin) {
    constexpr float kStep = 2e-3f;
    int agreed = 0;
    for (int i = 0; i < 50; ++i) {
        const float t = origin + 0.0371f * static_cast<float>(i);
        const float before = f(t - kStep), here = f(t), after = f(t + kStep);
        const Dual2 slope = f(Dual2(t, 1.0f, 0.0f));
        EXPECT_NEAR(slope.v, here, 1e-5f * (1 + std::abs(here)));
        const float difference = (after - before) / (2 * kStep);
        if (std::abs(slope.du - difference) < 0.02f * (1 + std::abs(difference))) ++agreed;
        EXPECT_EQ(slope.dv, 0.0f);
    }
    return agreed;
}

template <class T>
Vector3<T> on_line(const T& t) {
    return {t * T(0.8f) + T(0.3f), T(1.7f) - t * T(0.6f), t * T(0.3f) - T(0.45f)};
}

// Of hashword() in Jenkins' lookup3.c, with 13 for its initval.
TEST(Hash, IsLookup3) {
    EXPECT_EQ(lookup3<1>({1}), 0x4ad7c6a0u);
    EXPECT_EQ(lookup3<2>({1, 2}), 0x1037cb9du);
    EXPECT_EQ(lookup3<3>({1, 2, 3}), 0xb8d17a0au);
    EXPECT_EQ(lookup3<4>({1, 2, 3, 4}), 0x584dec1u);
}

TEST(Noise, IsZeroOnTheLatticeAndWithinOne) {
    Uniforms uniforms(7);
    EXPECT_EQ(perlin(Point<float, 3>{2.0f, -5.0f, 9.0f}), 0.0f);
    EXPECT_EQ(perlin(Point<float, 4>{1.0f, 0.0f, -1.0f, 3.0f}), 0.0f);
    for (int i = 0; i < 1000; ++i) {
        const auto x = [&] { return 40 * uniforms() - 20; };
        EXPECT_LE(std::abs(perlin(Point<float, 1>{x()})), 1.0f);
        EXPECT_LE(std::abs(perlin(Point<float, 2>{x(), x()})), 1.05f);
        EXPECT_LE(std::abs(perlin(Point<float, 3>{x(), x(), x()})), 1.05f);
        EXPECT_LE(std::abs(perlin(Point<float, 4>{x(), x(), x(), x()})), 1.05f);
    }
}

TEST(Noise, HoldsWhatIsNotFinite) {
    const float infinite = std::numeric_limits<float>::infinity();
    EXPECT_EQ(perlin(Point<float, 2>{infinite, 0.0f}), 0.0f);
    EXPECT_EQ(perlin(Point<float, 2>{std::nanf(""), 0.0f}), 0.0f);
    EXPECT_TRUE(std::isfinite(perlin(Point<float, 2>{1e30f, -1e20f})));
}

TEST(Noise, HasTheDerivativesThatDifferencesShow) {
    for (const FractalType type : kFractalTypes)
        for (int dimensions = 1; dimensions <= 4; ++dimensions) {
            SCOPED_TRACE(::testing::Message() << static_cast<int>(type) << " in " << dimensions);
            const auto value = [&]<class T>(const T& t) {
                const Fractal<T> f{.type = type,
                                   .detail = T(1.4f),
                                   .roughness = T(0.5f),
                                   .lacunarity = T(2.0f),
                                   .offset = T(0.7f),
                                   .gain = T(0.9f)};
                return in_dimensions(dimensions, on_line(t), t,
                                     [&](const auto& p) { return noise_value(f, p, T(0.3f)); });
            };
            EXPECT_GE(agreeing_slopes(value, 0.1f), 45);
        }
}

TEST(Noise, HasTheSecondDerivativesThatDifferencesOfSlopesShow) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        SCOPED_TRACE(dimensions);
        const auto value = [&]<class T>(const T& t) {
            return in_dimensions(dimensions, on_line(t), t, [](const auto& p) { return perlin(p); });
        };
        constexpr float kStep = 2e-3f;
        for (int i = 0; i < 50; ++i) {
            const float t = 0.1f + 0.0371f * static_cast<float>(i);
            const Dual2 line(t, 1.0f, 0.0f);
            const Dual<Dual2> twice = value(Dual<Dual2>(line, Dual2(1.0f), Dual2(0.0f)));
            const float slope_before = value(Dual2(t - kStep, 1.0f, 0.0f)).du,
                        slope_after = value(Dual2(t + kStep, 1.0f, 0.0f)).du;
            EXPECT_NEAR(value_of(twice.du), value(line).du, 1e-5f);
            EXPECT_EQ(twice.v.du, value_of(twice.du));
            EXPECT_NEAR(twice.du.du, (slope_after - slope_before) / (2 * kStep), 0.05f);
        }
    }
}

TEST(Noise, FadesInItsLastOctave) {
    const auto at = [](float detail) {
        const Fractal<float> f{.detail = detail, .roughness = 0.6f, .lacunarity = 2.1f};
        return fractal_noise(f, Point<float, 3>{0.3f, 1.2f, -0.4f});
    };
    EXPECT_NEAR(at(1.999f), at(2.0f), 1e-3f);
    EXPECT_NEAR(at(2.001f), at(2.0f), 1e-3f);
    EXPECT_NEAR(at(1.5f), 0.5f * (at(1.0f) + at(2.0f)), 1e-6f);
    EXPECT_EQ(at(15.0f), at(40.0f));
}

TEST(Checker, AlternatesOverFaces) {
    const auto at = [](float x, float y, float z) { return checker(Vector3<float>{x, y, z}); };
    EXPECT_EQ(at(0.5f, 0.5f, 0.5f), 0.0f);
    EXPECT_EQ(at(1.5f, 0.5f, 0.5f), 1.0f);
    EXPECT_EQ(at(1.5f, 1.5f, 0.5f), 0.0f);
    EXPECT_EQ(at(-0.5f, 0.5f, 0.5f), 1.0f);
    EXPECT_EQ(at(0.5f, 0.5f, 0.0f), at(0.5f, 0.5f, 0.5f));  // not between two cells
}

TEST(Gradient, RunsFromZeroToOne) {
    const auto at = [](GradientType type, float x, float y) {
        return gradient(type, Vector3<float>{x, y, 0.0f});
    };
    EXPECT_EQ(at(GradientType::linear, -1.0f, 0.0f), 0.0f);
    EXPECT_EQ(at(GradientType::linear, 0.25f, 0.0f), 0.25f);
    EXPECT_EQ(at(GradientType::quadratic, 0.5f, 0.0f), 0.25f);
    EXPECT_EQ(at(GradientType::easing, 0.5f, 0.0f), 0.5f);
    EXPECT_EQ(at(GradientType::diagonal, 0.5f, 0.3f), 0.4f);
    EXPECT_EQ(at(GradientType::spherical, 1.0f, 0.0f), 0.0f);
    EXPECT_NEAR(at(GradientType::radial, 0.0f, 1.0f), 0.75f, 1e-6f);
}

TEST(Wave, HasTheDerivativesThatDifferencesShow) {
    for (int shape = 0; shape < 8; ++shape)
        for (int profile = 0; profile < 3; ++profile) {
            SCOPED_TRACE(::testing::Message() << shape << ", " << profile);
            const auto value = [&]<class T>(const T& t) {
                const Wave<T> w{.shape = static_cast<WaveShape>(shape),
                                .profile = static_cast<WaveProfile>(profile),
                                .distortion = T(0.5f),
                                .detail = T(1.0f),
                                .detail_scale = T(1.3f),
                                .detail_roughness = T(0.4f),
                                .phase = T(0.2f)};
                const Vector3<T> p = on_line(t);
                return wave(w, times(p, 0.2f));
            };
            EXPECT_GE(agreeing_slopes(value, 0.1f), 44);
        }
}

TEST(Magic, HasTheDerivativesThatDifferencesShow) {
    for (int depth = 0; depth <= kMostMagic; ++depth) {
        SCOPED_TRACE(depth);
        const auto value = [&]<class T>(const T& t) {
            return magic(depth, times(on_line(t), 0.2f), T(1.0f), T(1.1f)).x;
        };
        EXPECT_GE(agreeing_slopes(value, 0.1f), 44);
    }
}

TEST(Brick, HasMortarAroundIt) {
    const Brick<float> b{.mortar_size = 0.02f, .width = 0.5f, .row_height = 0.25f};
    const auto mortar = [&](float x, float y) {
        return brick(b, Vector3<float>{x, y, 0.0f}).mortar;
    };
    EXPECT_EQ(mortar(0.0f, 0.125f), 0.0f);  // the first row is moved by half a brick
    EXPECT_EQ(mortar(0.25f, 0.125f), 1.0f);
    EXPECT_EQ(mortar(0.5f, 0.375f), 1.0f);
    EXPECT_EQ(mortar(0.1f, 0.26f), 1.0f);
    EXPECT_EQ(mortar(0.1f, 0.3f), 0.0f);
}

TEST(Voronoi, HasTheDerivativesThatDifferencesShow) {
    for (int feature = 0; feature < 5; ++feature)
        for (int metric = 0; metric < 4; ++metric)
            for (int dimensions = 1; dimensions <= 3; ++dimensions) {
                // Both hashes, in turn.
                const auto hash = static_cast<VoronoiHash>((feature + metric + dimensions) % 2);
                const uint8_t mode = voronoi_mode(dimensions, static_cast<VoronoiFeature>(feature),
                                                  static_cast<VoronoiMetric>(metric), false, hash);
                SCOPED_TRACE(::testing::Message()
                             << feature << ", " << metric << ", " << dimensions);
                const auto value = [&]<class T>(const T& t) {
                    const Voronoi<T> v{.feature = mode_voronoi_feature(mode),
                                       .metric = static_cast<VoronoiMetric>(metric),
                                       .hash = mode_voronoi_hash(mode),
                                       .detail = T(0.5f),
                                       .roughness = T(0.5f),
                                       .lacunarity = T(2.0f),
                                       .smoothness = T(0.3f),
                                       .exponent = T(1.5f),
                                       .randomness = T(0.9f)};
                    return in_dimensions(dimensions, on_line(t), t,
                                         [&](const auto& p) { return voronoi_at(v, p).distance; });
                };
                EXPECT_GE(agreeing_slopes(value, 0.1f), 40);
            }
}

TEST(Voronoi, AModeHoldsEachChoice) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions)
        for (int feature = 0; feature < 5; ++feature)
            for (int metric = 0; metric < 4; ++metric)
                for (const bool normalized : {false, true})
                    for (const VoronoiHash hash : {VoronoiHash::lookup3, VoronoiHash::pcg}) {
                        const auto f = static_cast<VoronoiFeature>(feature);
                        const auto m = static_cast<VoronoiMetric>(metric);
                        const uint8_t mode = voronoi_mode(dimensions, f, m, normalized, hash);
                        EXPECT_EQ(mode_dimensions(mode), dimensions);
                        EXPECT_EQ(mode_voronoi_feature(mode), f);
                        if (f < VoronoiFeature::distance_to_edge) {
                            EXPECT_EQ(mode_voronoi_metric(mode), m);
                        }
                        EXPECT_EQ(mode_voronoi_normalized(mode), normalized);
                        EXPECT_EQ(mode_voronoi_hash(mode), hash);
                    }
}

TEST(Voronoi, OfNoRandomnessIsALatticeOfCubes) {
    Voronoi<float> v{.randomness = 0.0f};
    EXPECT_NEAR(voronoi_at(v, Point<float, 2>{3.3f, 4.1f}).distance, std::hypot(0.3f, 0.1f), 1e-6f);
    v.feature = VoronoiFeature::sphere_radius;
    EXPECT_NEAR(voronoi_at(v, Point<float, 3>{3.3f, 4.1f, 0.0f}).distance, 0.5f, 1e-6f);
    v.feature = VoronoiFeature::distance_to_edge;
    EXPECT_NEAR(voronoi_at(v, Point<float, 3>{3.3f, 4.1f, 0.0f}).distance, 0.2f, 1e-6f);
}

}  // namespace
}  // namespace spc::test
