// SPDX-License-Identifier: GPL-3.0-or-later
// The weights that each technique gives to one path, by its own record, sum to one.
#include "scenes/build.h"
#include "scenes/checks.h"

#include "api/handles.h"
#include "integrator/traced.h"
#include "scenes/watched_render.h"

#include <fmt/format.h>

namespace spc::fuzz {
namespace {

constexpr double kSeconds = 1.0;                  // for each way to find chains
constexpr uint32_t kTries = 20000, kEnough = 60;  // paths
constexpr uint32_t kTiles = 64;                   // of sheets: so few that they miss some chains
// Two records of a path next to a fold differ by rounding, which magnifies there.
constexpr double kTolerance = 1e-3;

// The scene in which all that test::Bench follows may happen, and nothing else.
Plan for_weights(Plan plan, Dice& dice) {
    for (Caster& c : plan.casters) {
        c.roughness = c.coat = c.absorption = 0.0f;
        c.visibility = kVisibleAll;
        if (c.role == CausticsRole::off || c.role == CausticsRole::receiver)
            c.role = CausticsRole::automatic;
    }
    for (Receiver& r : plan.receivers) {
        r.gloss = 0.4f;
        r.visibility = kVisibleAll;
    }
    if (plan.lamps.empty()) plan.lamps.push_back({.name = "lamp"});
    Lamp lamp = dice.one_of(plan.lamps);
    lamp.visibility = lamp.kind == LampKind::mesh ? uint32_t{kVisibleAll} : test::kInCasters;
    lamp.extent = std::max(lamp.extent, 0.25f);
    lamp.feeds_caustics = true;
    lamp.soft = false;  // the disk of which has no normal of its own
    plan.lamps = {lamp};
    plan.sky = Sky::none;
    plan.aperture = 0.0f;
    plan.reflective = plan.refractive = true;
    return plan;
}

double deviation_of(const test::Bench& bench, const test::Traced& path) {
    const std::optional<CausticDensities> light = test::by_light(bench, path, 1.0f);
    const std::optional<test::ByManifold> manifold = test::by_manifold(bench, path);
    if (!light || !manifold) return 0.0;  // rounding led one of them elsewhere
    return path.share + light->light_tracing / light->sum() + manifold->share() - 1.0;
}

}  // namespace

void check_weights(const Plan& plan, uint64_t seed, Tally& tally) {
    Dice dice(seed);
    const Plan simple = for_weights(plan, dice);
    for (const ChainFinder finder : {ChainFinder::walks, ChainFinder::sheets}) {
        const test::ScenePtr scene = build(simple, 1);
        if (scene->world->casters.casters.empty()) return;
        const test::Bench bench(std::move(*scene->world), finder, kTiles);
        const Stopwatch watch;
        uint32_t found = 0;
        for (uint32_t i = 0; i < kTries && found < kEnough && watch.seconds() < kSeconds; ++i) {
            const std::optional<test::Traced> path = bench.trace(i);
            if (!path) continue;
            ++found;
            ++tally.paths;
            const double deviation = deviation_of(bench, *path);
            tally.worst_sum = std::max(tally.worst_sum, std::abs(deviation));
            if (!(std::abs(deviation) <= kTolerance))
                throw Broken{Check::weights,
                             fmt::format("beside {} those of path {} sum to one and {}: {} smooth "
                                         "vertices, {} interactions",
                                         finder == ChainFinder::walks ? "walks" : "sheets", i,
                                         deviation, path->smooth.size(), path->chain.size())};
        }
    }
}

}  // namespace spc::fuzz
