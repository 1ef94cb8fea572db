// SPDX-License-Identifier: GPL-3.0-or-later
// Settings, tolerances and statistics of the manifold estimators.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace spc {

enum class Interaction : uint8_t { reflection, refraction };

// Largest number of interactions: of any chain, and of chains that the manifold looks for from
// receivers.
inline constexpr uint32_t kLongestChain = 13, kLongestManifoldChain = 6;

enum class Constraint : uint8_t { half_vector, angle_difference };

// How an estimate finds its chains: by random walks [Zeltner20]; by the seeds of light sheets, and
// random shots for what those miss; or by MNEE seeds [Hanika15].
enum class ChainFinder : uint8_t { walks, sheets, mnee };

struct ManifoldSettings {
    bool enabled = false;
    ChainFinder finder = ChainFinder::walks;
    // Walks: sum over the solutions that `set_size` walks find [Zeltner20 Alg. 3]. MNEE: what its
    // seeds miss is lost. Sheets have no biased variant.
    bool biased = false;
    // Most interactions of a chain from a receiver. Camera chains may have kLongestChain.
    uint32_t longest_chain = kLongestManifoldChain;
    // The only chains that are looked for, as interactions from the receiver on; for figures of
    // [Zeltner20]. Empty: all.
    std::vector<Interaction> family;
    uint32_t set_size = 16;
    Constraint constraint = Constraint::angle_difference;
    bool two_stage = true;
    // Whether light may reach a diffuse surface by reflection or by refraction at all, by any
    // technique.
    bool reflections = true, refractions = true;

    int max_iterations = 20;  // walks that need more nearly always diverge
    int max_halvings = 6;     // halvings of one step before a walk gives up
    int seed_halvings = 1;  // the same for shots from chain seeds: most that need more find nothing
    // Share of the seeds that are uniform over the caster. The rest are drawn from what x sees of
    // it.
    float seeds_by_area = 0.5f;
    // The best of so many points becomes a seed. More of them find small basins, but cost time.
    uint32_t seed_candidates = 4;
    // Probability that an estimate by sheets searches for what they miss.
    float search_probability = 1.0f / 4;
    // Two solutions closer than this many of their resolutions are one.
    float identity_factor = 4.0f;
    // Largest number of Bernoulli trials. An estimate that hits it keeps its count and is reported.
    // The trials by which chains that seeds miss are weighed end here, too.
    uint32_t trial_cap = 1u << 16;
    // Once set, estimates end at once, and their samples must be thrown away.
    const std::atomic<bool>* cancelled = nullptr;

    bool looks_for_singles() const { return family.size() <= 1; }
    bool looks_for_longer() const { return longest_chain > 1 && family.size() != 1; }
};

// Estimates by their number of trials: bin i counts [2^i, 2^(i+1)), the last one the cap and all
// beyond.
using TrialHistogram = std::array<uint64_t, 17>;

struct ManifoldStats {
    uint64_t estimates = 0;
    uint64_t walks = 0;
    uint64_t converged = 0;
    uint64_t iterations = 0;
    uint64_t rays = 0;
    uint64_t trial_estimates = 0;
    uint64_t trials = 0;
    uint64_t max_trials = 0;
    TrialHistogram trial_histogram{};  // of trial_estimates
    uint64_t capped = 0;
    uint64_t chain_seeds = 0;    // chain seeds that were shot
    uint64_t roots = 0;          // different chains that they found
    uint64_t missed = 0;         // chains that only searches found
    double missed_energy = 0.0;  // luminance that those gave to their estimates
    double capped_energy = 0.0;  // luminance that capped estimates gave to their pixels
    uint64_t work() const { return iterations + rays; }
    void add(const ManifoldStats& other) {
        estimates += other.estimates;
        walks += other.walks;
        converged += other.converged;
        iterations += other.iterations;
        rays += other.rays;
        trial_estimates += other.trial_estimates;
        trials += other.trials;
        chain_seeds += other.chain_seeds;
        roots += other.roots;
        missed += other.missed;
        missed_energy += other.missed_energy;
        for (size_t i = 0; i < trial_histogram.size(); ++i)
            trial_histogram[i] += other.trial_histogram[i];
        max_trials = std::max(max_trials, other.max_trials);
        capped += other.capped;
        capped_energy += other.capped_energy;
    }
};

}  // namespace spc
