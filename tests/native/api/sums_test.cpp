// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of films through the interface: parts add up, and misuse is refused.
#include "support/api_scene.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <thread>

namespace spc::test {
namespace {

using Bytes = std::vector<unsigned char>;

Bytes sums_of(spc_session* session, uint32_t samples) {
    auto sums = sized<spc_sums>();
    EXPECT_EQ(spc_film_export(session, &sums), SPC_OK) << spc_last_error();
    EXPECT_EQ(sums.samples, samples);
    const auto* data = static_cast<const unsigned char*>(sums.data);
    return {data, data + sums.size};
}

Bytes rendered(const spc_scene* scene, uint32_t first, uint32_t end, uint32_t total,
               uint32_t crypto_kinds = 1u << SPC_CRYPTO_OBJECT) {
    spc_render_settings settings = quick_settings(end - first);
    settings.first_sample = first;
    settings.total_samples = total;
    settings.crypto_kinds = crypto_kinds;
    settings.crypto_ranks = crypto_kinds == 0 ? 0 : 2;
    const SessionPtr session = start(scene, settings);
    wait_for(session.get());
    return sums_of(session.get(), end - first);
}

TEST(Sums, OfPartsAreThoseOfTheWhole) {
    const ScenePtr scene = committed_scene();
    const Bytes whole = rendered(scene.get(), 0, 5, 5), late = rendered(scene.get(), 2, 5, 5);
    Bytes sum = rendered(scene.get(), 0, 2, 5);
    ASSERT_EQ(spc_sums_add(sum.data(), late.data(), sum.size(), 0), SPC_OK) << spc_last_error();
    EXPECT_EQ(sum, whole);
    uint32_t extent[2];
    ASSERT_EQ(spc_sums_extent(sum.data(), sum.size(), extent), SPC_OK);
    std::vector<float> pixels(size_t{4} * extent[0] * extent[1]), ids = pixels;
    EXPECT_EQ(spc_sums_read(sum.data(), sum.size(), SPC_PASS_COMBINED, pixels.data(), pixels.size()),
              SPC_OK);
    EXPECT_GT(*std::max_element(pixels.begin(), pixels.end()), 0.0f);
    EXPECT_EQ(
        spc_sums_read_crypto(sum.data(), sum.size(), SPC_CRYPTO_OBJECT, 0, ids.data(), ids.size()),
        SPC_OK);
}

// Each thread has sums of its own, and the render stands still for one after the other.
TEST(SumsThreads, ThreadsExportAtOnce) {
    constexpr uint32_t kSamples = 64;
    const ScenePtr scene = committed_scene();
    spc_render_settings settings = quick_settings(kSamples);
    settings.total_samples = kSamples;
    const SessionPtr session = start(scene.get(), settings);
    const auto exported = [&] {
        auto sums = sized<spc_sums>();
        EXPECT_EQ(spc_film_export(session.get(), &sums), SPC_OK) << spc_last_error();
        const auto* data = static_cast<const unsigned char*>(sums.data);
        return std::pair(sums.samples, Bytes(data, data + sums.size));
    };
    std::array<std::map<uint32_t, Bytes>, 3> found;
    {
        std::vector<std::jthread> threads;
        for (auto& of_thread : found)
            threads.emplace_back([&] {
                for (int i = 0; i < 8; ++i) of_thread.insert(exported());
            });
    }
    wait_for(session.get());
    const Bytes whole = sums_of(session.get(), kSamples);
    for (const auto& of_thread : found)
        for (const auto& [samples, sums] : of_thread) {
            Bytes sum = sums;
            if (samples < kSamples) {
                const Bytes rest = rendered(scene.get(), samples, kSamples, kSamples, 0);
                ASSERT_EQ(spc_sums_add(sum.data(), rest.data(), sum.size(), 0), SPC_OK);
            }
            EXPECT_EQ(sum, whole) << samples;
        }
}

TEST(SumsMisuse, IsRefused) {
    const ScenePtr scene = committed_scene();
    Bytes sums = rendered(scene.get(), 0, 1, 2);
    const Bytes other = rendered(scene.get(), 1, 2, 2);
    uint32_t extent[2];
    std::vector<float> pixels(8);
    expect_refused(spc_sums_add(nullptr, other.data(), sums.size(), 0), SPC_INVALID_ARGUMENT,
                   {"null"});
    expect_refused(spc_sums_add(sums.data(), nullptr, sums.size(), 0), SPC_INVALID_ARGUMENT,
                   {"null"});
    expect_refused(spc_sums_extent(sums.data(), sums.size(), nullptr), SPC_INVALID_ARGUMENT,
                   {"extent"});
    for (const size_t size : {size_t{0}, size_t{3}, size_t{60}, sums.size() - 1})
        expect_refused(spc_sums_extent(sums.data(), size, extent), SPC_INVALID_ARGUMENT, {});
    expect_refused(spc_sums_read(sums.data(), sums.size(), SPC_PASS_COMBINED, pixels.data(), 8),
                   SPC_INVALID_ARGUMENT, {"floats"});
    expect_refused(
        spc_sums_read_crypto(sums.data(), sums.size(), SPC_CRYPTO_ASSET, 0, pixels.data(), 8),
        SPC_INVALID_ARGUMENT, {"not asked for"});
    auto out = sized<spc_sums>();
    expect_refused(spc_film_export(nullptr, &out), SPC_INVALID_ARGUMENT, {"session"});
    spc_render_settings settings = quick_settings(4);
    for (const uint32_t total : {3u, 1u}) {
        settings.total_samples = total;
        spc_session* session = nullptr;
        expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_INVALID_ARGUMENT,
                       {"total_samples"});
    }
    settings.total_samples = 4;
    settings.time_limit = 1.0f;
    spc_session* session = nullptr;
    expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_INVALID_ARGUMENT,
                   {"time limit"});
    settings = quick_settings(4);
    settings.passes = uint64_t{1} << SPC_PASS_COUNT;
    expect_refused(spc_render_start(scene.get(), &settings, &session), SPC_INVALID_ARGUMENT,
                   {"passes"});
}

}  // namespace
}  // namespace spc::test
