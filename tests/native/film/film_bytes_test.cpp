// SPDX-License-Identifier: GPL-3.0-or-later
// Films of parts of the samples add up to the film of all, to the bit.
#include "core/error.h"
#include "film/film.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

constexpr uint32_t kWidth = 19, kHeight = 5, kSamples = 24;
const PassSet kAllPasses((uint64_t{1} << kPasses) - 1, {{2, 3, 1}});

// Samples [first, end) of a picture whose numbers are of very different sizes.
std::unique_ptr<Film> film_of(uint32_t first, uint32_t end) {
    auto film = std::make_unique<Film>(kWidth, kHeight, kAllPasses);
    const PixelFilter filter(FilterKind::blackman_harris, 1.5f);
    for (uint32_t sample = first; sample < end; ++sample) {
        test::Uniforms uniforms(100 + sample);
        const auto large_or_small = [&] { return std::exp2(uniforms() * 16.0f - 8.0f); };
        for (uint32_t t = 0; t < film->tile_count(); ++t) {
            Film::TileSums sums = film->copy_tile(t);
            for (size_t pixel = 0; pixel < sums.pixels.size(); ++pixel) {
                PassValues values(kAllPasses);
                kAllPasses.each([&](Pass pass) {
                    values.value(pass) = {uniforms.three() * large_or_small(), uniforms()};
                });
                film->accumulate(
                    sums, pixel,
                    {Spectrum(large_or_small(), uniforms(), 0.3f), uniforms(), &values});
            }
            film->store_tile(t, sums);
        }
        std::vector<Splat> splats;
        for (int i = 0; i < 50; ++i) {
            const Vec2 u = uniforms.two();
            splats.push_back({{u.x * kWidth, u.y * kHeight}, Spectrum(large_or_small())});
            splats.back().shares = {Spectrum(0.5f), Spectrum(0.25f), Spectrum(0.25f)};
            splats.back().light_group = i % 3 == 2 ? kNoGroup : uint32_t(i) % 3;
        }
        film->add_splats(SplatSource::light_paths, splats, filter, 70, 140.0);
    }
    return film;
}

TEST(FilmBytes, AreTheFilm) {
    const std::vector<std::byte> bytes = film_of(0, 4)->to_bytes();
    EXPECT_EQ(Film::from_bytes(bytes)->to_bytes(), bytes);
}

TEST(FilmBytes, PartsAddUpToTheBitInAnyOrder) {
    const std::vector<std::byte> whole = film_of(0, kSamples)->to_bytes();
    test::Uniforms uniforms(3);
    for (int trial = 0; trial < 8; ++trial) {
        std::vector<uint32_t> ends{0, kSamples};
        for (int cut = 0; cut < trial; ++cut)
            ends.push_back(1 + uint32_t(uniforms() * (kSamples - 1)));
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        std::vector<std::pair<uint32_t, std::unique_ptr<Film>>> parts;
        for (size_t i = 0; i + 1 < ends.size(); ++i)
            parts.emplace_back(ends[i], film_of(ends[i], ends[i + 1]));
        while (parts.size() > 1) {
            const size_t a = size_t(uniforms() * float(parts.size()));
            const size_t b = (a + 1 + size_t(uniforms() * float(parts.size() - 1))) % parts.size();
            if (a == b) continue;
            parts[a].second->add(*parts[b].second, parts[b].first < parts[a].first);
            parts[a].first = std::min(parts[a].first, parts[b].first);
            parts.erase(parts.begin() + ptrdiff_t(b));
        }
        EXPECT_TRUE(parts[0].second->to_bytes() == whole) << ends.size() - 1 << " parts";
    }
    EXPECT_FALSE(film_of(1, kSamples)->to_bytes() == whole);
}

TEST(FilmBytes, OthersAreRefused) {
    const std::vector<std::byte> bytes = film_of(0, 1)->to_bytes();
    for (const size_t size : {size_t{0}, size_t{10}, size_t{100}, bytes.size() - 1})
        EXPECT_THROW(Film::from_bytes(std::span(bytes).first(size)), Error) << size;
    std::vector<std::byte> longer = bytes, other = bytes;
    longer.push_back(std::byte{0});
    EXPECT_THROW(Film::from_bytes(longer), Error);
    other[0] ^= std::byte{1};
    EXPECT_THROW(Film::from_bytes(other), Error);
    EXPECT_THROW(Film(kWidth, kHeight).add(*film_of(0, 1), false), Error);
    EXPECT_THROW(Film(kHeight, kWidth, kAllPasses).add(*film_of(0, 1), false), Error);
}

}  // namespace
}  // namespace spc
