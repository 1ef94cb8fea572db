// SPDX-License-Identifier: GPL-3.0-or-later
// The film against sums made by hand.
#include "film/film.h"

#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

FilmSample random_sample(test::Uniforms& uniforms) {
    const auto vector = [&] {
        const Vec3 u = uniforms.three();
        return Vec3(u.x * 4.0f - 2.0f, u.y * 4.0f - 2.0f, u.z * 4.0f - 2.0f);
    };
    FilmSample sample;
    sample.radiance = Spectrum(uniforms() * 5.0f, uniforms(), std::pow(uniforms(), 8.0f) * 1000.0f);
    sample.caustics = Spectrum(uniforms(), uniforms(), uniforms());
    sample.position = vector();
    sample.normal = vector();
    sample.alpha = uniforms();
    sample.depth = uniforms() * 10.0f;
    const auto count = [&] { return static_cast<uint64_t>(uniforms() * 3.0f); };
    sample.walks = {count() + count(), count(), count(), count() * 10};
    return sample;
}

std::vector<float> read(const Film& film, Pass pass) {
    std::vector<float> out(size_t{pass_channels(pass)} * film.width() * film.height(), -1.0f);
    film.read(pass, out);
    return out;
}

// Every pass of every pixel, with a different number of samples in each, on a frame that its tiles
// do not fill.
TEST(Film, PassesAreWhatTheSamplesSay) {
    constexpr uint32_t kWidth = 37, kHeight = 21;
    Film film(kWidth, kHeight);
    EXPECT_EQ(film.tile_count(), 6u);
    std::vector<std::vector<FilmSample>> samples(kWidth * kHeight);
    test::Uniforms uniforms(5);
    std::vector<int> covered(samples.size());
    for (uint32_t t = 0; t < film.tile_count(); ++t) {
        const Film::TileBounds b = film.bounds(t);
        for (int batch = 0; batch < 2; ++batch) {
            std::vector<PixelSums> pixels = film.copy_tile(t);
            ASSERT_EQ(pixels.size(), size_t{b.width} * b.height);
            for (uint32_t y = 0; y < b.height; ++y)
                for (uint32_t x = 0; x < b.width; ++x) {
                    const size_t at = size_t{b.y0 + y} * kWidth + b.x0 + x;
                    if (batch == 0) ++covered[at];
                    for (size_t i = 0; i < (at + size_t(batch)) % 5; ++i) {
                        samples[at].push_back(random_sample(uniforms));
                        accumulate(pixels[size_t{y} * b.width + x], samples[at].back());
                    }
                }
            film.store_tile(t, pixels);
        }
    }
    for (const int count : covered) ASSERT_EQ(count, 1) << "tiles must cover the frame once";

    const std::vector<float> combined = read(film, Pass::combined), depth = read(film, Pass::depth),
                             position = read(film, Pass::position),
                             normal = read(film, Pass::normal),
                             caustics = read(film, Pass::caustics),
                             variance = read(film, Pass::variance),
                             success = read(film, Pass::walk_success),
                             trials = read(film, Pass::walk_trials);
    ASSERT_EQ(combined.size(), samples.size() * 4);
    ASSERT_EQ(depth.size(), samples.size());
    for (size_t at = 0; at < samples.size(); ++at) {
        const std::vector<FilmSample>& s = samples[at];
        const double n = double(s.size());
        const auto mean = [&](auto value) {
            double sum = 0;
            for (const FilmSample& sample : s) sum += double(value(sample));
            return s.empty() ? 0.0 : sum / n;
        };
        EXPECT_NEAR(combined[4 * at + 3], mean([](const FilmSample& f) { return f.alpha; }), 1e-6);
        EXPECT_EQ(depth[at], s.empty() ? 0.0f : s[0].depth);
        const auto share = [&](uint64_t WalkCounts::*part, uint64_t WalkCounts::*whole) {
            double parts = 0.0, wholes = 0.0;
            for (const FilmSample& f : s) {
                parts += double(f.walks.*part);
                wholes += double(f.walks.*whole);
            }
            return wholes > 0.0 ? float(parts / wholes) : 0.0f;
        };
        EXPECT_EQ(success[at], share(&WalkCounts::converged, &WalkCounts::walks));
        EXPECT_EQ(trials[at], share(&WalkCounts::trials, &WalkCounts::trial_estimates));
        for (int c = 0; c < 3; ++c) {
            const size_t i = 3 * at + size_t(c);
            const double m = mean([&](const FilmSample& f) { return f.radiance[c]; });
            EXPECT_NEAR(combined[4 * at + size_t(c)], m, 1e-6 * (1 + m));
            EXPECT_EQ(position[i], s.empty() ? 0.0f : s[0].position[c]);
            EXPECT_NEAR(normal[i], mean([&](const FilmSample& f) { return f.normal[c]; }), 1e-6);
            EXPECT_NEAR(caustics[i], mean([&](const FilmSample& f) { return f.caustics[c]; }), 1e-6);
            // Of the mean: squares about the mean over n (n - 1).
            const double squares =
                n * mean([&](const FilmSample& f) {
                    return (double(f.radiance[c]) - m) * (double(f.radiance[c]) - m);
                });
            const double expected = s.size() > 1 ? squares / (n * (n - 1)) : 0.0;
            EXPECT_NEAR(variance[i], expected, 1e-5 * expected + 1e-12);
        }
    }
}

// The variance's own purpose: the spread of means over many pixels is what the pass says of each.
TEST(Film, VarianceIsThatOfTheMean) {
    constexpr uint32_t kSide = 64;
    constexpr int kSamples = 16;
    Film film(kSide, kSide);
    test::Uniforms uniforms(8);
    for (uint32_t t = 0; t < film.tile_count(); ++t) {
        std::vector<PixelSums> pixels = film.copy_tile(t);
        for (PixelSums& pixel : pixels)
            for (int i = 0; i < kSamples; ++i) {
                FilmSample sample{};
                sample.radiance = Spectrum(uniforms() < 0.25f ? 3.0f : 0.0f);
                accumulate(pixel, sample);
            }
        film.store_tile(t, pixels);
    }
    // A quarter of the samples is 3: mean 3/4, variance 27/16 each.
    test::MeanEstimate mean, variance;
    const std::vector<float> combined = read(film, Pass::combined),
                             told = read(film, Pass::variance);
    for (size_t i = 0; i < size_t{kSide} * kSide; ++i) {
        mean.add(double(combined[4 * i]));
        variance.add(double(told[3 * i]));
    }
    EXPECT_TRUE(test::is_mean(mean, 0.75, test::sidak(1e-4, 2)));
    EXPECT_TRUE(test::is_mean(variance, 27.0 / 16.0 / kSamples, test::sidak(1e-4, 2)));
}

TEST(Film, LargeRadianceKeepsItsVariance) {
    Film film(1, 1);
    std::vector<PixelSums> pixels = film.copy_tile(0);
    for (int i = 0; i < 1000; ++i) {
        FilmSample sample{};
        sample.radiance = Spectrum(1e6f + float(i % 2));
        accumulate(pixels[0], sample);
    }
    film.store_tile(0, pixels);
    // Half a unit to either side, over n - 1.
    EXPECT_NEAR(read(film, Pass::variance)[0], 0.25 / 999.0, 1e-5);
}

TEST(Film, UntouchedPixelsAreZeroInEveryPass) {
    const Film film(5, 3);
    for (uint32_t pass = 0; pass < uint32_t(Pass::count); ++pass)
        for (const float value : read(film, Pass(pass))) EXPECT_EQ(value, 0.0f) << "pass " << pass;
}

// ---- light paths

double sum_of(const std::vector<float>& image, size_t channels) {
    double sum = 0.0;
    for (size_t i = 0; i < image.size(); i += channels) sum += double(image[i]);
    return sum;
}

TEST(Film, PreviewStandsForPixelsWithoutASample) {
    constexpr uint32_t kWidth = 21, kHeight = 18, kBlock = 4, kAcross = 6, kDown = 5;
    Film film(kWidth, kHeight);
    std::vector<std::array<float, 4>> colors;
    for (uint32_t i = 0; i < kAcross * kDown; ++i)
        colors.push_back({static_cast<float>(i), 1.0f, 2.0f, 0.5f});
    film.set_preview(kBlock, colors);
    std::vector<PixelSums> pixels = film.copy_tile(0);
    const FilmSample sample{Spectrum(7.0f), Spectrum(0.0f), Vec3(0.0f), Vec3(0.0f), 1.0f, 1.0f, {}};
    accumulate(pixels[1], sample);  // x = 1, y = 0
    film.store_tile(0, pixels);
    // What light paths have brought is in path tracing's preview, too.
    film.add_splats(SplatSource::light_paths, std::array{Splat{{20.5f, 17.5f}, Spectrum(3.0f)}},
                    PixelFilter(FilterKind::box, 1.0f), 1, 1.0);
    const std::vector<float> combined = read(film, Pass::combined);
    const auto red = [&](uint32_t x, uint32_t y) { return combined[4 * (size_t{y} * kWidth + x)]; };
    EXPECT_EQ(red(0, 0), 0.0f);
    EXPECT_EQ(red(1, 0), 7.0f);
    EXPECT_EQ(red(2, 0), 0.0f);
    EXPECT_EQ(red(4, 0), 1.0f);
    EXPECT_EQ(red(20, 17), static_cast<float>(kAcross * kDown - 1));
    EXPECT_EQ(combined[3], 0.5f);
    for (const float value : read(film, Pass::caustics)) EXPECT_TRUE(std::isfinite(value));
    EXPECT_EQ(read(film, Pass::variance)[0], 0.0f);
}

TEST(FilmOfLightPaths, BoxTakesEachSplatOnce) {
    const PixelFilter box(FilterKind::box, 1.0f);
    test::Uniforms uniforms(2);
    std::vector<Vec2> places{{0.0f, 0.0f}, {1.0f, 2.0f}, {2.5f, 3.0f}, {3.0f, 1.5f}};  // borders, too
    for (int i = 0; i < 100; ++i) places.push_back(uniforms.two() * 4.0f);
    for (const Vec2& place : places) {
        Film film(4, 4);
        const Splat splat{place, Spectrum(3.0f)};
        film.add_splats(SplatSource::light_paths, {&splat, 1}, box, 1, 1.0);
        const std::vector<float> combined = read(film, Pass::combined);
        EXPECT_NEAR(combined[4 * (size_t(place.y) * 4 + size_t(place.x))], 3.0f, 1e-5f) << place;
        EXPECT_NEAR(sum_of(combined, 4), 3.0, 1e-5) << place;
    }
}

// A pixel takes of splats what it would have taken of its own samples, on average, and a splat
// gives all that it has.
TEST(FilmOfLightPaths, FiltersAsSamplesAre) {
    for (const FilterKind kind : {FilterKind::gaussian, FilterKind::blackman_harris}) {
        const PixelFilter filter(kind, 1.5f);
        test::Uniforms uniforms(3);
        test::MeanEstimate total, by_splats, by_samples, power;
        const auto radiance = [](const Vec2& p) { return std::exp(0.4f * p.x - 0.3f * p.y) * 0.1f; };
        constexpr uint32_t kSize = 9, kMiddle = 4;
        for (int i = 0; i < 20000; ++i) {
            const Vec2 place = uniforms.two() * float(kSize);
            Film film(kSize, kSize);
            const float density = 1.0f / (kSize * kSize);
            const Splat splat{place, Spectrum(radiance(place) / density)},
                inside{Vec2(4.0f, 4.0f) + uniforms.two(), Spectrum(1.0f)};
            film.add_splats(SplatSource::light_paths, {&splat, 1}, filter, 1, 1.0);
            by_splats.add(double(read(film, Pass::combined)[4 * (kMiddle * kSize + kMiddle)]));
            Film other(kSize, kSize);
            other.add_splats(SplatSource::light_paths, {&inside, 1}, filter, 1, 1.0);
            total.add(sum_of(read(other, Pass::combined), 4));
            const double sample = double(radiance(Vec2(4.5f, 4.5f) + filter.sample(uniforms.two())));
            by_samples.add(sample);
            power.add(1.05 * sample);
        }
        EXPECT_TRUE(test::same_mean(by_splats, by_samples, 1e-3));
        EXPECT_TRUE(test::is_mean(total, 1.0, 1e-3, 1e-5));
        EXPECT_FALSE(test::is_mean(power, by_samples.mean(), 1e-3));
    }
}

// The same splats on a window of the film are the window of the whole picture.
TEST(FilmOfLightPaths, CropIsAWindow) {
    const PixelFilter filter(FilterKind::blackman_harris, 1.5f);
    test::Uniforms uniforms(4);
    Film whole(12, 9), window(5, 4);
    std::vector<Splat> splats;
    for (int i = 0; i < 300; ++i)
        splats.push_back({{uniforms() * 16.0f - 2.0f, uniforms() * 13.0f - 2.0f}, Spectrum(1.0f)});
    whole.add_splats(SplatSource::light_paths, splats, filter, 100, 10.0);
    for (Splat& splat : splats) splat.film -= Vec2(3.0f, 2.0f);
    window.add_splats(SplatSource::light_paths, splats, filter, 100, 10.0);
    for (const Pass pass : {Pass::combined, Pass::caustics, Pass::variance}) {
        const size_t channels = pass_channels(pass);
        const std::vector<float> all = read(whole, pass), part = read(window, pass);
        for (size_t y = 0; y < 4; ++y)
            for (size_t x = 0; x < 5; ++x)
                EXPECT_NEAR(part[(y * 5 + x) * channels], all[((y + 2) * 12 + x + 3) * channels],
                            1e-5f * all[((y + 2) * 12 + x + 3) * channels] + 1e-7f);
    }
}

// Paths of which a few splat: the pass against the spread of many pictures, and against the closed
// form of a sum of independent ones.
TEST(FilmOfLightPaths, VarianceIsThatOfThePicture) {
    const PixelFilter box(FilterKind::box, 1.0f);
    constexpr uint64_t kPaths = 400;
    constexpr double kPerPicture = 50.0, kProbability = 0.1, kValue = 2.0;
    test::Uniforms uniforms(5);
    test::MeanEstimate mean, squared, told;
    const double expected = kPerPicture * kProbability * kValue;
    for (int trial = 0; trial < 4000; ++trial) {
        Film film(1, 1);
        for (int batch = 0; batch < 2; ++batch) {
            std::vector<Splat> splats;
            for (uint64_t i = 0; i < kPaths / 2; ++i)
                if (double(uniforms()) < kProbability)
                    splats.push_back({{0.5f, 0.5f}, Spectrum(float(kValue))});
            film.add_splats(SplatSource::light_paths, splats, box, kPaths / 2, kPerPicture);
        }
        const double value = double(read(film, Pass::combined)[0]);
        EXPECT_EQ(read(film, Pass::caustics)[0], float(value));
        mean.add(value);
        squared.add((value - expected) * (value - expected));
        told.add(double(read(film, Pass::variance)[0]));
    }
    const double variance = kPerPicture * kPerPicture / double(kPaths) * kProbability *
                            (1.0 - kProbability) * kValue * kValue;
    const double significance = test::sidak(1e-3, 3);
    EXPECT_TRUE(test::is_mean(mean, expected, significance));
    EXPECT_TRUE(test::is_mean(squared, variance, significance));
    EXPECT_TRUE(test::is_mean(told, variance, significance, 3e-3 * variance));
}

// Each source has its own number of estimates: one that never varies has no variance beside another.
// Camera chains are no caustics.
TEST(FilmOfCameraChains, AreApartFromLightPaths) {
    const PixelFilter box(FilterKind::box, 1.0f);
    const std::vector<Splat> steady(64, Splat{{0.5f, 0.5f}, Spectrum(0.25f)}),
        rare(4, Splat{{0.5f, 0.5f}, Spectrum(2.0f)});
    Film film(1, 1), light_alone(1, 1);
    film.add_splats(SplatSource::camera_chains, steady, box, 64, 8.0);
    for (Film* each : {&film, &light_alone})
        each->add_splats(SplatSource::light_paths, rare, box, 100, 50.0);
    EXPECT_FLOAT_EQ(read(light_alone, Pass::combined)[0], 4.0f);
    EXPECT_FLOAT_EQ(read(film, Pass::combined)[0], 8 * 0.25f + 4.0f);
    EXPECT_FLOAT_EQ(read(film, Pass::caustics)[0], 4.0f);
    EXPECT_FLOAT_EQ(read(film, Pass::variance)[0], read(light_alone, Pass::variance)[0]);
    EXPECT_GT(read(light_alone, Pass::variance)[0], 0.0f);
}

}  // namespace
}  // namespace spc
