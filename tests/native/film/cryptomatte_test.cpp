// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

constexpr CryptoRequest kRequest{
    1u << uint32_t(CryptoKind::object) | 1u << uint32_t(CryptoKind::asset), 4};

void add_sample(Film& film, std::initializer_list<std::pair<CryptoIds, float>> parts) {
    Film::TileSums sums = film.copy_tile(0);
    PassValues values(PassSet(), true);
    for (const auto& [ids, share] : parts) values.coverage.add(ids, share);
    film.accumulate(sums, 0, {Spectrum(0.0f), 1.0f, &values});
    film.store_tile(0, sums);
}

std::vector<float> level_of(const Film& film, CryptoKind kind, uint32_t level) {
    std::vector<float> out(4);
    film.read_crypto(kind, level, out);
    return out;
}

TEST(Cryptomatte, RanksSharesOfAPixel) {
    Film film(1, 1, PassSet(), SplatSpread::all_pixels, kRequest);
    add_sample(film, {{{1.0f, 9.0f, 5.0f}, 1.0f}});
    add_sample(film, {{{2.0f, 9.0f, 5.0f}, 0.25f}, {{3.0f, 9.0f, 0.0f}, 0.75f}});
    add_sample(film, {{{3.0f, 9.0f, 5.0f}, 1.0f}});
    add_sample(film, {});  // nothing is hit
    EXPECT_EQ(level_of(film, CryptoKind::object, 0), (std::vector{3.0f, 1.75f / 4, 1.0f, 1.0f / 4}));
    EXPECT_EQ(level_of(film, CryptoKind::object, 1), (std::vector{2.0f, 0.25f / 4, 0.0f, 0.0f}));
    EXPECT_EQ(level_of(film, CryptoKind::asset, 0), (std::vector{5.0f, 2.25f / 4, 0.0f, 0.0f}));
}

TEST(Cryptomatte, PartsAddUp) {
    const auto empty = [] {
        return std::make_unique<Film>(1, 1, PassSet(), SplatSpread::all_pixels, kRequest);
    };
    const auto whole = empty(), early = empty(), late = empty();
    for (int i = 0; i < 9; ++i)
        for (Film* film : {whole.get(), i < 4 ? early.get() : late.get()})
            add_sample(*film, {{{float(1 + i % 3), 1.0f, 1.0f}, 0.3f},
                               {{float(1 + i % 5), 1.0f, 2.0f}, 0.1f}});
    late->add(*early, true);
    for (const uint32_t level : {0u, 1u})
        EXPECT_EQ(level_of(*late, CryptoKind::object, level),
                  level_of(*whole, CryptoKind::object, level));
    EXPECT_EQ(Film::from_bytes(late->to_bytes())->to_bytes(), late->to_bytes());
}

}  // namespace
}  // namespace spc
