// SPDX-License-Identifier: GPL-3.0-or-later
// One path of light as each technique comes to describe it: their weights sum to one, and no fold
// outshines them.
#include "integrator/traced.h"
#include "support/power.h"

#include <map>

namespace spc::test {
namespace {

// Of one path.
struct Weighed {
    double deviation;           // of the sum of all weights from one
    double deviation_if_wrong;  // where a light path's record differs by a hundredth
    // What light tracing and the manifold multiply its light with, over 1 / (p_bsdf prod P): at
    // most, and if the manifold's own density alone divided it.
    double scale, scale_of_manifold_alone;
    bool missed;  // by sheets
};
// By the number of smooth vertices and of interactions; of paths that turn between smooth vertices,
// all together with 0.
using Paths = std::map<std::array<size_t, 2>, std::vector<Weighed>>;

std::optional<Weighed> weigh(const Bench& bench, const Traced& path) {
    constexpr float kWrong = 1.01f;
    const std::optional<CausticDensities> light = by_light(bench, path, 1.0f),
                                          wrong_light = by_light(bench, path, kWrong);
    const std::optional<ByManifold> manifold = by_manifold(bench, path);
    if (!light || !wrong_light || !manifold) return std::nullopt;
    const CausticDensities& p = manifold->p;
    const auto deviation = [&](const CausticDensities& of_light) {
        return path.share + of_light.light_tracing / of_light.sum() + manifold->share() - 1.0;
    };
    Weighed weighed{deviation(*light), deviation(*wrong_light),
                    std::max(light->scale(), p.scale()) * path.p_camera,
                    p.geometry / p.manifold * path.p_camera, manifold->trials > 0};
    if (weighed.missed && p.missed_are_apart())
        weighed.scale = std::max(weighed.scale, p.geometry * p.share_of_searches(manifold->trials) /
                                                    double(path.y.pdf) * path.p_camera);
    return weighed;
}

bool has_specular_transfer(const Traced& path) {
    return std::any_of(path.between.begin(), path.between.end(),
                       [](const Stretch& stretch) { return !stretch.chain.empty(); });
}

Paths weighed_paths(ChainFinder finder, uint32_t tries, uint32_t emission_cells = 64) {
    Paths result;
    for (const CasterCase& caster : casters())
        for (const LightCase& light : lights()) {
            SceneMaker maker;
            add_receivers(maker);
            caster.add(maker);
            light.add(maker);
            const Bench bench(maker, finder, emission_cells);
            int found = 0, failed = 0;
            for (uint32_t i = 0; i < tries; ++i) {
                const std::optional<Traced> path = bench.trace(i);
                if (!path) continue;
                ++found;
                if (const std::optional<Weighed> weighed = weigh(bench, *path))
                    result[{path->smooth.size(), has_specular_transfer(*path) ? 0 : path->chain.size()}]
                        .push_back(*weighed);
                else
                    ++failed;
            }
            EXPECT_GT(found, 0) << caster.name << " under " << light.name;
            EXPECT_LE(failed, found / 10) << caster.name << " under " << light.name;
        }
    return result;
}

double largest_deviation(const std::vector<Weighed>& paths, double Weighed::*deviation) {
    double largest = 0.0;
    for (const Weighed& path : paths) {
        EXPECT_TRUE(std::isfinite(path.*deviation));
        largest = std::max(largest, std::abs(path.*deviation));
    }
    return largest;
}

constexpr double kRounding = 1e-5;
const size_t kEnough = power(10, 20);  // paths of a kind
const uint32_t kTries = power(100000, 300000);

void expect_sums_of_one(const Paths& all) {
    size_t met_often = 0;
    for (const auto& [kind, found] : all) {
        const std::string what = std::to_string(kind[0]) + " smooth vertices, " +
                                 std::to_string(kind[1]) + " interactions, " +
                                 std::to_string(found.size()) + " paths";
        const double largest = largest_deviation(found, &Weighed::deviation);
        std::cout << what << ": sums differ from one by " << largest << std::endl;
        EXPECT_LE(largest, kRounding) << what;
        if (found.size() < kEnough) continue;
        EXPECT_GT(largest_deviation(found, &Weighed::deviation_if_wrong), 20.0 * kRounding)
            << what << ": a wrong record does not show";
        ++met_often;
    }
    EXPECT_GE(met_often, 9u);  // one to three of both, few of which have three twice; turned ones
}

// Where path tracing finds a path, nothing that the others make of it is larger than what it would
// make of it alone; without its share in the weights folds would be.
void expect_bounded_folds(const Paths& all) {
    constexpr double kFold = 100.0;
    double most = 0.0, most_alone = 0.0;
    for (const auto& [kind, found] : all)
        for (const Weighed& path : found) {
            most = std::max(most, path.scale);
            most_alone = std::max(most_alone, path.scale_of_manifold_alone);
        }
    std::cout << "largest scale " << most << ", of the manifold alone " << most_alone << std::endl;
    EXPECT_LE(most, 1.0 + kRounding);
    EXPECT_GT(most_alone, kFold);
}

TEST(CausticWeightsSlow, SumToOneOverTheirOwnRecords) {
    const Paths all = weighed_paths(ChainFinder::walks, kTries);
    expect_sums_of_one(all);
    expect_bounded_folds(all);
}
TEST(CausticWeightsSlow, BesideSheetsSumToOneOverTheirOwnRecords) {
    const Paths all = weighed_paths(ChainFinder::sheets, kTries);
    expect_sums_of_one(all);
    expect_bounded_folds(all);
    for (size_t count = 1; count <= 3; ++count) {
        size_t found = 0, missed = 0;
        for (const auto& [kind, paths] : all)
            for (const Weighed& path : paths)
                if (kind[1] == count) ++(path.missed ? missed : found);
        std::cout << "of " << count << " interactions sheets find " << found << ", miss " << missed
                  << std::endl;
        EXPECT_GE(std::min(found, missed), kEnough) << count;
    }
}

// What path tracing, walks and light paths have of a chain that sheets miss.
TEST(CausticWeightsSlow, OfMissedChainsSumToOne) {
    CausticDensities p;
    p.path_tracing = 0.01;
    p.folds = 0.03;
    p.manifold = 0.4;
    p.light_tracing = 0.2;
    p.missed = 0.3;
    EXPECT_EQ(p.share_of_folds(), 0.75);
    ASSERT_TRUE(p.missed_are_apart());
    double before = 0.0;
    for (const double trials : {1.0, 7.0, 5000.0}) {
        const double share = p.share_of_directions(trials);
        EXPECT_NEAR(share + p.share_of_searches(trials) + p.light_tracing / p.sum(), 1.0, 1e-12);
        EXPECT_GT(share, before);  // the harder to find, the more
        before = share;
    }
    EXPECT_GT(p.share_of_searches(5000.0), 0.0);
    p.path_tracing = p.folds = 0.0;
    EXPECT_EQ(p.share_of_directions(7.0), 0.0);
    EXPECT_NEAR(p.share_of_searches(7.0) + p.light_tracing / p.sum(), 1.0, 1e-12);
}

// Trials are counted as far as they tell: next to nothing is left to searches then, of any chain to
// which directions come at all.
TEST(CausticWeights, TrialsThatTellEndWhereSearchesHaveNextToNothing) {
    constexpr uint32_t kMost = 1 << 16;
    CausticDensities p;
    p.manifold = 200.0;
    p.missed = 50.0;
    for (const double directions : {0.02, 0.05, 7.0, 300.0}) {
        p.path_tracing = directions;
        const uint32_t trials = p.telling_trials(kMost);
        ASSERT_LT(trials, kMost);
        EXPECT_LE(p.share_of_searches(trials), 1.0 / 16 * p.shared_by_camera());
        if (trials > 1) {
            EXPECT_GT(p.share_of_searches(trials - 1), 1.0 / 17 * p.shared_by_camera());
        }
    }
    p.path_tracing = 2e-3;
    EXPECT_EQ(p.telling_trials(kMost), kMost);
    for (const double blind : {0.0, 1e-6}) {
        p.path_tracing = blind;
        EXPECT_EQ(p.telling_trials(kMost), 1u);
        EXPECT_LE(p.share_of_directions(kMost), 1.0 / 16 * p.shared_by_camera());
    }
    p.path_tracing = 1.0;
    p.missed = 0.0;  // MNEE seeds
    EXPECT_EQ(p.telling_trials(kMost), 1u);
}

// What MNEE seeds miss is path tracing's alone, but for the share of light paths.
TEST(CausticWeightsSlow, OfChainsThatMneeSeedsMissSumToOne) {
    CausticDensities p;
    p.geometry = 0.7;
    p.light_tracing = 0.2;
    p.missed = 0.0;
    for (const double path_tracing : {0.0, 0.01, 4.0}) {  // of a lamp without shadow; usual ones
        p.path_tracing = path_tracing;
        p.manifold = 0.4;
        ASSERT_TRUE(p.missed_are_apart());
        EXPECT_NEAR(p.share_of_directions(1.0) + p.light_tracing / p.sum(), 1.0, 1e-12);
    }
}

}  // namespace
}  // namespace spc::test
