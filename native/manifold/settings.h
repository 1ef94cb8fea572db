// SPDX-License-Identifier: GPL-3.0-or-later
// What a render asks of the manifold, its tolerances, and what it counts.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace spc {

enum class Interaction : uint8_t { reflection, refraction };

// Interactions of a chain, at most: of any, and of those that the manifold looks for from receivers.
inline constexpr uint32_t kLongestChain = 13, kLongestManifoldChain = 6;

enum class Constraint : uint8_t { half_vector, angle_difference };

// How an estimate comes to its chains: by random walks [Zeltner20], from the chain seeds of light sheets
// and by walks for what those miss, or from MNEE seeds [Hanika15].
enum class ChainFinder : uint8_t { walks, sheets, mnee };

struct ManifoldSettings {
    bool enabled = false;
    ChainFinder finder = ChainFinder::walks;
    // Walks: the sum over the solutions of `set_size` of them [Zeltner20 Alg. 3]; mnee: what it
    // misses is left out. Sheets have no such variant.
    bool biased = false;
    // Interactions. Camera chains may have as many as any chain.
    uint32_t longest_chain = kLongestManifoldChain;
    // The only chains that are looked for, from the receiver on, as in most figures of [Zeltner20];
    // empty: all.
    std::vector<Interaction> family;
    uint32_t set_size = 16;
    Constraint constraint = Constraint::angle_difference;
    bool two_stage = true;
    // Whether light may reach a diffuse surface by reflection, by refraction, through any method at
    // all.
    bool reflections = true, refractions = true;

    int max_iterations = 20;  // walks that need more nearly always diverge
    int max_halvings = 6;     // of one step, before the walk gives up
    int seed_halvings =
        1;  // the same from a chain seed of a sheet: most that need more lead nowhere
    // Share of the seeds that are uniform over the caster; the rest is what x sees of it.
    float seeds_by_area = 0.5f;
    // Points from which the best becomes a seed. More find small basins, and cost time elsewhere.
    uint32_t seed_candidates = 4;
    // Share of the estimates by sheets that look for what those miss.
    float search_probability = 1.0f / 4;
    // Two solutions closer than this many of their resolutions are one.
    float identity_factor = 4.0f;
    // Bernoulli trials; beyond, the estimate keeps what it counted and reports it. Those by which
    // chains are weighed that chain seeds miss end there, too.
    uint32_t trial_cap = 1u << 16;
    // Once set, estimates end where they are; whoever sets it throws their samples away.
    const std::atomic<bool>* cancelled = nullptr;

    bool looks_for_singles() const { return family.size() <= 1; }
    bool looks_for_longer() const { return longest_chain > 1 && family.size() != 1; }
};

// Trials by their number: [2^i, 2^(i+1)) in bin i, the last of which has the cap and all beyond.
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
    uint64_t chain_seeds = 0;    // chains that sheets or camera chains told to look for
    uint64_t roots = 0;          // different ones that were there
    uint64_t missed = 0;         // found by walks beside them
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
