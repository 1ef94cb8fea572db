// SPDX-License-Identifier: GPL-3.0-or-later
// Methods without bias have one mean.
#include "scenes/build.h"
#include "scenes/watched_render.h"
#include "support/numerics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace spc::fuzz {
namespace {

constexpr uint32_t kSide = 16, kHalf = kSide / 2;  // pixels
constexpr uint32_t kPixels = kSide * kSide;
// A difference must show in all rounds, each with four times the samples of the one before and
// other random numbers, before it counts.
constexpr uint32_t kRounds = 3;
constexpr uint32_t kSamples = 32, kSamplesOfPathTracing = 1024;  // in the first
constexpr double kSeconds = 4.0;  // of the processor, in the first; what takes longer tells nothing
// So many methods of a scene, of which the first are what all others are held against.
constexpr size_t kMostMethods = 5, kHeldAgainst = 2;
// Loses the chains that its fixed starts miss.
constexpr Method kWithBias{"MNEE_BIASED", SPC_METHOD_MNEE_BIASED, SPC_LIGHT_TRACING_OFF, true};
// Chance that methods which agree differ in one round.
constexpr double kDoubt = 1e-3;
// Of means: what single precision makes of them, along different ways.
constexpr double kRounding = 1e-3;
// Noise of heavy tails is made by few pixels, and no variance is known where none of them was met.
// A wrong mean is that of many: it shows without these.
constexpr uint32_t kFewPixels = kPixels / 32;

struct Picture {
    std::vector<double> mean = std::vector<double>(kPixels), variance = mean;
    double capped = 0.0;  // what searches that gave up would have added to a pixel, about
};

// Of the four quarters, then of the whole.
struct Difference {
    double z;         // of the part that is farthest off, in standard errors
    double relative;  // there
    double limit;     // of |z|
    double noticed;   // relative, of the whole: what comes to that limit
    bool shows() const { return std::abs(z) > limit; }
};

Difference difference_of(const Picture& a, const Picture& b, std::vector<bool> without) {
    std::array<double, 5> off{}, mean{}, variance{};
    for (uint32_t i = 0; i < kPixels; ++i) {
        if (without[i]) continue;
        const uint32_t x = i % kSide, y = i / kSide;
        for (const uint32_t part : {(y < kHalf ? 0u : 2u) + (x < kHalf ? 0u : 1u), 4u}) {
            off[part] += a.mean[i] - b.mean[i];
            mean[part] += 0.5 * (a.mean[i] + b.mean[i]);
            variance[part] += a.variance[i] + b.variance[i];
        }
    }
    Difference worst{};
    for (size_t part = 0; part < off.size(); ++part) {
        const double pixels = part == 4 ? kPixels : kPixels / 4;
        const double allowed = kRounding * mean[part] + pixels * (a.capped + b.capped);
        const double beyond = std::max(std::abs(off[part]) - allowed, 0.0);
        if (beyond == 0.0) continue;
        const double z = std::copysign(beyond, off[part]) / std::sqrt(variance[part]);
        if (std::abs(z) > std::abs(worst.z)) worst = {z, off[part] / mean[part], 0.0, 0.0};
    }
    const double significance = test::sidak(kDoubt, off.size());
    double least = 0.0, most = 10.0;  // erfc(z / sqrt 2) falls
    while (most - least > 1e-6) {
        const double z = 0.5 * (least + most);
        (std::erfc(z / std::numbers::sqrt2) > significance ? least : most) = z;
    }
    worst.limit = most;
    worst.noticed = mean[4] > 0.0 ? kRounding + most * std::sqrt(variance[4]) / mean[4] : 1.0;
    return worst;
}

class Comparison {
public:
    Comparison(const Plan& plan, uint64_t seed, Tally& tally)
        : plan_(plan), dice_(seed), tally_(tally), scene_(build(plan, kSide)) {}

    void run(bool with_bias) {
        std::vector<const Method*> methods;
        for (const Method& method : kMethods)
            if (plan_.is_found_by_rays() || !method.by_rays) methods.push_back(&method);
        if (with_bias) methods = {&kMethods[0], &kWithBias};
        while (methods.size() > kMostMethods)
            methods.erase(methods.begin() + kHeldAgainst +
                          dice_.below(methods.size() - kHeldAgainst));
        std::vector<std::optional<Picture>> pictures;
        for (const Method* method : methods) pictures.push_back(render(*method, 0));
        for (size_t i = 0; i < std::min(kHeldAgainst, methods.size()); ++i)
            for (size_t j = i + 1; j < methods.size(); ++j)
                compare(*methods[i], pictures[i], *methods[j], pictures[j]);
    }

private:
    // Empty where it takes too long.
    std::optional<Picture> render(const Method& method, uint32_t round) {
        const bool path_tracing = method.method == SPC_METHOD_PT;
        spc_render_settings settings = settings_of(plan_, method, dice_.below(1u << 30));
        settings.samples = (path_tracing ? kSamplesOfPathTracing : kSamples) << (2 * round);
        WatchedRender render(scene_.get(), settings, method.name);
        const Stopwatch watch;
        while (render.wait(20).state == SPC_RENDER_RUNNING)
            if (watch.seconds() > kSeconds * double(1u << (2 * round))) return std::nullopt;
        render.check_stages();
        for (uint32_t pass = 0; pass < SPC_PASS_COUNT; ++pass) render.read(pass, kSide);
        const std::vector<float> combined = render.read(SPC_PASS_COMBINED, kSide),
                                 variance = render.read(SPC_PASS_VARIANCE, kSide);
        Picture picture;
        for (uint32_t i = 0; i < kPixels; ++i)
            for (uint32_t c = 0; c < 3; ++c) {
                picture.mean[i] += double(combined[4 * i + c]) / 3.0;
                // At most that of the channels' mean.
                picture.variance[i] += double(variance[3 * i + c]) / 3.0;
            }
        const spc_render_stats stats = render.stats();
        picture.capped = stats.capped_energy / double(std::max<uint64_t>(stats.samples, 1));
        return picture;
    }

    void compare(const Method& a, const std::optional<Picture>& first_a, const Method& b,
                 const std::optional<Picture>& first_b) {
        ++tally_.pairs;
        std::optional<Picture> of_a = first_a, of_b = first_b;
        Difference all{};
        std::string history;
        for (uint32_t round = 0;; ++round) {
            if (!of_a || !of_b) {
                ++tally_.undecided;
                return;
            }
            const Difference before = all;
            all = difference_of(*of_a, *of_b, std::vector<bool>(kPixels));
            if (round == 0) tally_.log_noticed += std::log(all.noticed);
            history +=
                fmt::format(" {:+.2f} % ({:+.1f} standard errors)", 100.0 * all.relative, all.z);
            if (!all.shows() || all.z * before.z < 0.0) {
                tally_.doubted += round > 0;
                return;
            }
            if (round + 1 == kRounds) break;
            of_a = render(a, round + 1);
            of_b = render(b, round + 1);
        }
        if (const Difference most = difference_of(*of_a, *of_b, few_pixels(*of_a, *of_b));
            !most.shows() || most.z * all.z < 0.0) {
            ++tally_.undecided;
            std::fprintf(stderr, "FUZZ: a few pixels of %s and %s differ:%s\n", a.name, b.name,
                         history.c_str());
            return;
        }
        throw Broken{Check::means, fmt::format("{} is not {}:{}", a.name, b.name, history)};
    }

    static std::vector<bool> few_pixels(const Picture& a, const Picture& b) {
        std::vector<uint32_t> order(kPixels);
        for (uint32_t i = 0; i < kPixels; ++i) order[i] = i;
        const auto off = [&](uint32_t i) { return std::abs(a.mean[i] - b.mean[i]); };
        std::sort(order.begin(), order.end(),
                  [&](uint32_t i, uint32_t j) { return off(i) > off(j); });
        std::vector<bool> few(kPixels, false);
        for (uint32_t i = 0; i < kFewPixels; ++i) few[order[i]] = true;
        return few;
    }

    const Plan& plan_;
    Dice dice_;
    Tally& tally_;
    test::ScenePtr scene_;
};

}  // namespace

void check_means(const Plan& plan, uint64_t seed, bool with_bias, Tally& tally) {
    Comparison(plan, seed, tally).run(with_bias);
}

}  // namespace spc::fuzz
