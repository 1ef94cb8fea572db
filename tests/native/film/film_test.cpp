// SPDX-License-Identifier: GPL-3.0-or-later
// The film against sums made by hand.
#include "film/film.h"

#include "film/exact_sum.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

const PassSet kCaustics(1u << uint32_t(Pass::caustics));
// All passes that there are.
const PassSet kAllPasses((uint64_t{1} << kPasses) - 1);

// A sample with the values that it refers to.
struct Sampled {
    Spectrum radiance;
    float alpha;
    PassValues values{kAllPasses};
    FilmSample film_sample() const { return {radiance, alpha, &values}; }
};
Sampled random_sample(test::Uniforms& uniforms) {
    Sampled sample;
    sample.radiance = Spectrum(uniforms() * 5.0f, uniforms(), std::pow(uniforms(), 8.0f) * 1000.0f);
    sample.alpha = uniforms();
    for (uint32_t pass = 0; pass < kPasses; ++pass)
        sample.values[Pass(pass)] = uniforms.three() * 4.0f;
    const auto count = [&] { return std::floor(uniforms() * 3.0f); };
    for (const Pass pass : {Pass::walk_success, Pass::walk_trials})
        sample.values[pass] = Vec3(count(), count() + count(), 0.0f);
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
    Film film(kWidth, kHeight, kAllPasses);
    EXPECT_EQ(film.tile_count(), 6u);
    std::vector<std::vector<Sampled>> samples(kWidth * kHeight);
    test::Uniforms uniforms(5);
    std::vector<int> covered(samples.size());
    for (uint32_t t = 0; t < film.tile_count(); ++t) {
        const Film::TileBounds b = film.bounds(t);
        for (int batch = 0; batch < 2; ++batch) {
            Film::TileSums sums = film.copy_tile(t);
            ASSERT_EQ(sums.pixels.size(), size_t{b.width} * b.height);
            for (uint32_t y = 0; y < b.height; ++y)
                for (uint32_t x = 0; x < b.width; ++x) {
                    const size_t at = size_t{b.y0 + y} * kWidth + b.x0 + x;
                    if (batch == 0) ++covered[at];
                    for (size_t i = 0; i < (at + size_t(batch)) % 5; ++i) {
                        samples[at].push_back(random_sample(uniforms));
                        film.accumulate(sums, size_t{y} * b.width + x,
                                        samples[at].back().film_sample());
                    }
                }
            film.store_tile(t, sums);
        }
    }
    for (const int count : covered) ASSERT_EQ(count, 1) << "tiles must cover the frame once";

    for (uint32_t number = 0; number < kPasses; ++number) {
        const Pass pass = Pass(number);
        SCOPED_TRACE(describe(pass).name);
        const size_t channels = pass_channels(pass);
        const std::vector<float> seen = read(film, pass);
        ASSERT_EQ(seen.size(), samples.size() * channels);
        for (size_t at = 0; at < samples.size(); ++at) {
            const std::vector<Sampled>& s = samples[at];
            const double n = double(s.size());
            const auto mean = [&](auto value) {
                double sum = 0;
                for (const Sampled& sample : s) sum += double(value(sample));
                return s.empty() ? 0.0 : sum / n;
            };
            const auto mean_of = [&](Pass of, int c) {
                return mean([&](const Sampled& f) { return f.values[of][c]; });
            };
            for (int c = 0; c < int(channels); ++c) {
                const double m =
                    mean([&](const Sampled& f) { return c < 3 ? f.radiance[c] : f.alpha; });
                double expected = 0.0;
                if (pass == Pass::combined) {
                    expected = m;
                } else if (pass == Pass::sample_count) {
                    expected = n;
                } else if (pass == Pass::variance) {  // squares about the mean over n (n - 1)
                    const double squares =
                        n * mean([&](const Sampled& f) {
                            return (double(f.radiance[c]) - m) * (double(f.radiance[c]) - m);
                        });
                    expected = s.size() > 1 ? squares / (n * (n - 1)) : 0.0;
                } else if (pass == Pass::walk_success || pass == Pass::walk_trials) {
                    const double whole = mean_of(pass, 1);
                    expected = whole > 0.0 ? mean_of(pass, 0) / whole : 0.0;
                } else if (describe(pass).accumulation == Accumulation::first) {
                    expected = s.empty() ? 0.0 : double(s[0].values[pass][c]);
                } else if (describe(pass).accumulation == Accumulation::light_by_color) {
                    const Pass color =
                        Pass(uint32_t(Pass::diffuse_color) +
                             (number - uint32_t(Pass::diffuse_direct)) % uint32_t(kLobes));
                    expected = s.empty() ? 0.0 : mean_of(pass, c) / mean_of(color, c);
                } else {
                    expected = mean_of(pass, c);
                }
                EXPECT_NEAR(seen[at * channels + size_t(c)], expected, 2e-6 * (0.1 + expected));
            }
        }
    }
}

// However samples are divided among films of planes that nobody else asked for, a pass is the same.
TEST(Film, PlanesDoNotDependOnEachOther) {
    Film all(1, 1, kAllPasses), one(1, 1, PassSet(1u << uint32_t(Pass::mist)));
    EXPECT_FALSE(one.can_read(Pass::normal));
    EXPECT_TRUE(one.can_read(Pass::variance));
    test::Uniforms uniforms(6);
    for (int i = 0; i < 5; ++i) {
        const Sampled sample = random_sample(uniforms);
        for (Film* film : {&all, &one}) {
            Film::TileSums sums = film->copy_tile(0);
            film->accumulate(sums, 0, sample.film_sample());
            film->store_tile(0, sums);
        }
    }
    for (const Pass pass : {Pass::combined, Pass::mist, Pass::variance, Pass::sample_count})
        EXPECT_EQ(read(all, pass), read(one, pass));
    EXPECT_GT(read(one, Pass::mist)[0], 0.0f);
}

// Sums of terms that a double alone would round: any grouping gives the same bits, and the plain
// sum does not.
TEST(ExactSum, DoesNotDependOnGrouping) {
    test::Uniforms uniforms(7);
    std::vector<float> terms;
    for (int i = 0; i < 300; ++i) terms.push_back(std::exp2(uniforms() * 40.0f - 20.0f));
    const auto in_groups_of = [&](size_t size) {
        double high = 0.0, plain = 0.0;
        float low = 0.0f;
        for (size_t begin = 0; begin < terms.size(); begin += size) {
            double part = 0.0, plain_part = 0.0;
            float part_low = 0.0f;
            for (size_t i = begin; i < std::min(begin + size, terms.size()); ++i) {
                add_exactly(part, part_low, double(terms[i]));
                plain_part += double(terms[i]);
            }
            add_exactly(high, low, part);
            add_exactly(high, low, double(part_low));
            plain += plain_part;
        }
        return std::array{high, double(low), plain};
    };
    const auto whole = in_groups_of(terms.size());
    int plain_differs = 0;
    for (size_t size = 1; size < 100; ++size) {
        const auto parts = in_groups_of(size);
        EXPECT_EQ(parts[0], whole[0]);
        EXPECT_EQ(parts[1], whole[1]);
        plain_differs += parts[2] != whole[2];
    }
    EXPECT_GT(plain_differs, 10);
}

// The variance's own purpose: the spread of means over many pixels is what the pass says of each.
TEST(Film, VarianceIsThatOfTheMean) {
    constexpr uint32_t kSide = 64;
    constexpr int kSamples = 16;
    Film film(kSide, kSide);
    test::Uniforms uniforms(8);
    for (uint32_t t = 0; t < film.tile_count(); ++t) {
        Film::TileSums sums = film.copy_tile(t);
        for (size_t pixel = 0; pixel < sums.pixels.size(); ++pixel)
            for (int i = 0; i < kSamples; ++i)
                film.accumulate(sums, pixel, {Spectrum(uniforms() < 0.25f ? 3.0f : 0.0f), 1.0f});
        film.store_tile(t, sums);
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
    Film::TileSums sums = film.copy_tile(0);
    for (int i = 0; i < 1000; ++i) film.accumulate(sums, 0, {Spectrum(1e6f + float(i % 2)), 1.0f});
    film.store_tile(0, sums);
    // Half a unit to either side, over n - 1.
    EXPECT_NEAR(read(film, Pass::variance)[0], 0.25 / 999.0, 1e-5);
}

TEST(Film, UntouchedPixelsAreZeroInEveryPass) {
    const Film film(5, 3, kAllPasses);
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
    Film film(kWidth, kHeight, kCaustics);
    std::vector<std::array<float, 4>> colors;
    for (uint32_t i = 0; i < kAcross * kDown; ++i)
        colors.push_back({static_cast<float>(i), 1.0f, 2.0f, 0.5f});
    film.set_preview(kBlock, colors);
    Film::TileSums sums = film.copy_tile(0);
    const PassValues no_caustics(kCaustics);
    film.accumulate(sums, 1, {Spectrum(7.0f), 1.0f, &no_caustics});  // x = 1, y = 0
    film.store_tile(0, sums);
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
class SplatsFilter : public testing::TestWithParam<std::tuple<FilterKind, SplatSpread>> {};
TEST_P(SplatsFilter, AsSamplesAre) {
    const auto [kind, spread] = GetParam();
    const PixelFilter filter(kind, 1.5f);
    test::Uniforms uniforms(3);
    test::MeanEstimate total, by_splats, by_samples, power;
    const auto radiance = [](const Vec2& p) { return std::exp(0.4f * p.x - 0.3f * p.y) * 0.1f; };
    constexpr uint32_t kSize = 9, kMiddle = 4;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 place = uniforms.two() * float(kSize);
        Film film(kSize, kSize, PassSet(), spread);
        const float density = 1.0f / (kSize * kSize);
        Splat splat{place, Spectrum(radiance(place) / density)},
            inside{Vec2(4.0f, 4.0f) + uniforms.two(), Spectrum(1.0f)};
        splat.u = inside.u = uniforms.two();
        film.add_splats(SplatSource::light_paths, {&splat, 1}, filter, 1, 1.0);
        by_splats.add(double(read(film, Pass::combined)[4 * (kMiddle * kSize + kMiddle)]));
        Film other(kSize, kSize, PassSet(), spread);
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
INSTANTIATE_TEST_SUITE_P(
    AllFilters, SplatsFilter,
    testing::Combine(testing::Values(FilterKind::gaussian, FilterKind::blackman_harris),
                     testing::Values(SplatSpread::all_pixels, SplatSpread::one_pixel)));

// Light passes take of a splat what its lobes scatter.
TEST(FilmOfLightPaths, LobesShareASplat) {
    Film film(1, 1, kAllPasses);
    Splat splat{{0.5f, 0.5f}, Spectrum(2.0f)};
    splat.shares = {Spectrum(0.25f), Spectrum(0.75f, 0.5f, 0.0f), Spectrum(0.0f, 0.25f, 0.75f)};
    film.add_splats(SplatSource::light_paths, {&splat, 1}, PixelFilter(FilterKind::box, 1.0f), 1,
                    1.0);
    Film::TileSums sums = film.copy_tile(0);
    PassValues values(kAllPasses);
    for (const Pass color : {Pass::diffuse_color, Pass::glossy_color, Pass::transmission_color})
        values[color] = Vec3(0.5f);
    film.accumulate(sums, 0, {Spectrum(0.0f), 1.0f, &values});
    film.store_tile(0, sums);
    EXPECT_EQ(read(film, Pass::diffuse_indirect), (std::vector{1.0f, 1.0f, 1.0f}));
    EXPECT_EQ(read(film, Pass::glossy_indirect), (std::vector{3.0f, 2.0f, 0.0f}));
    EXPECT_EQ(read(film, Pass::transmission_indirect), (std::vector{0.0f, 1.0f, 3.0f}));
    EXPECT_EQ(read(film, Pass::glossy_direct), (std::vector{0.0f, 0.0f, 0.0f}));
}

// The same splats on a window of the film are the window of the whole picture.
TEST(FilmOfLightPaths, CropIsAWindow) {
    const PixelFilter filter(FilterKind::blackman_harris, 1.5f);
    test::Uniforms uniforms(4);
    Film whole(12, 9, kCaustics), window(5, 4, kCaustics);
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
        Film film(1, 1, kCaustics);
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

// Each source has its own number of estimates: one that never varies has no variance beside
// another. Camera chains are no caustics.
TEST(FilmOfCameraChains, AreApartFromLightPaths) {
    const PixelFilter box(FilterKind::box, 1.0f);
    const std::vector<Splat> steady(64, Splat{{0.5f, 0.5f}, Spectrum(0.25f)}),
        rare(4, Splat{{0.5f, 0.5f}, Spectrum(2.0f)});
    Film film(1, 1, kCaustics), light_alone(1, 1, kCaustics);
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
