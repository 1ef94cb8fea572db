// SPDX-License-Identifier: GPL-3.0-or-later
// Manifold walks: Newton iterations, whole walks, and the candidates among which seeds are chosen.
#include "kernels.h"
#include "manifold/walk.h"
#include "support/casters.h"

namespace spc::bench {
namespace {

using test::CausticScene;

struct Start {
    ChainQuery query;
    Seed seed;
};

// Random receivers and points of the lamp, as the estimator would ask for them.
std::vector<ChainQuery> draw_queries(const CausticScene& scene) {
    const RenderScene& world = scene.world;
    std::vector<ChainQuery> queries;
    Pcg pcg(1);
    while (queries.size() < kBatch) {
        const Vec3 x = scene.receiver(pcg);
        const Vec2 u = pcg.two();
        const std::optional<LightPoint> y =
            sample_light_point(world.lights, *world.scene, Vec3(u.x, u.y, pcg.one()));
        if (y) queries.push_back({x, {y->distant, y->p, y->direction}, &world.casters.casters[0]});
    }
    return queries;
}

std::vector<Start> draw_starts(const CausticScene& scene, const ManifoldSettings& settings) {
    std::vector<Start> starts;
    Pcg pcg(2);
    ManifoldStats stats;
    for (const ChainQuery& query : draw_queries(scene))
        if (const auto seed = sample_seed(*scene.world.scene, settings, query, pcg, stats))
            starts.push_back({query, *seed});
    return starts;
}

// The law of reflection or refraction: the normal is along the half-vector [Walter07 Eq. 16].
bool obeys_law(const ChainQuery& query, const ChainRoot& root) {
    constexpr float kTolerance = 1e-3f;  // radians; walks end at the noise of single precision
    float distance = 0.0f;
    const Vec3 wi = normalize(query.x - root.geometry.p),
               wo = query.end.from(root.geometry.p, distance);
    const float scale = root.interaction == Interaction::reflection ? 1.0f : root.eta;
    return length(cross(normalize(wi + wo * scale), root.geometry.n)) < kTolerance;
}

struct Tally {
    ManifoldStats stats;
    bool lawful = true;
    void add(const ChainQuery& query, const std::optional<ChainRoot>& root) {
        lawful = lawful && (!root || obeys_law(query, *root));
    }
};

// One pass that is not timed: what the walks of the batch come to.
bool check_walks(benchmark::State& state, const Tally& tally) {
    const ManifoldStats& stats = tally.stats;
    if (!holds(state, stats.converged > 0, "no walk converges") ||
        !holds(state, tally.lawful, "a walk ends where light does not pass"))
        return false;
    state.counters["success"] = share(stats.converged, stats.walks);
    state.counters["iterations_per_walk"] = share(stats.iterations, stats.walks);
    state.counters["rays_per_walk"] = share(stats.rays, stats.walks);
    return true;
}

// From seeds that stand ready.
void newton(benchmark::State& state, const CausticScene& scene, const ManifoldSettings& settings) {
    const std::vector<Start> starts = draw_starts(scene, settings);
    Tally tally;
    for (const auto& [query, seed] : starts)
        tally.add(query, walk_from(*scene.world.scene, settings, query, seed, tally.stats));
    if (!check_walks(state, tally)) return;
    time_passes(state, "iteration", tally.stats.iterations, [&] {
        ManifoldStats stats;
        for (const auto& [query, seed] : starts) {
            const auto root = walk_from(*scene.world.scene, settings, query, seed, stats);
            benchmark::DoNotOptimize(root);
        }
    });
}

void whole_walk(benchmark::State& state, const CausticScene& scene,
                const ManifoldSettings& settings) {
    const std::vector<ChainQuery> queries = draw_queries(scene);
    Tally tally;
    Pcg pcg(2);
    for (const ChainQuery& query : queries)
        tally.add(query, random_walk(*scene.world.scene, settings, query, pcg, tally.stats));
    if (!check_walks(state, tally)) return;
    time_passes(state, "walk", queries.size(), [&] {
        ManifoldStats stats;
        Pcg again(2);
        for (const ChainQuery& query : queries) {
            const auto root = random_walk(*scene.world.scene, settings, query, again, stats);
            benchmark::DoNotOptimize(root);
        }
    });
}

void seed(benchmark::State& state, const CausticScene& scene, const ManifoldSettings& settings) {
    const std::vector<ChainQuery> queries = draw_queries(scene);
    const uint64_t found = draw_starts(scene, settings).size();
    if (!holds(state, found > 0, "no seed is found")) return;
    state.counters["found"] = share(found, queries.size());
    time_passes(state, "candidate", queries.size() * settings.seed_candidates, [&] {
        ManifoldStats stats;
        Pcg pcg(2);
        for (const ChainQuery& query : queries) {
            const auto one = sample_seed(*scene.world.scene, settings, query, pcg, stats);
            benchmark::DoNotOptimize(one);
        }
    });
}

const CausticScene& reflective_plane() {
    static const CausticScene scene = test::reflective_plane();
    return scene;
}
const CausticScene& refractive_sphere() {
    static const CausticScene scene = test::refractive_sphere();
    return scene;
}
const CausticScene& smooth_ring() {
    static const CausticScene scene = test::smooth_ring();
    return scene;
}

}  // namespace

void add_walks() {
    using Kernel = void (*)(benchmark::State&, const CausticScene&, const ManifoldSettings&);
    const std::pair<const char*, Kernel> kernels[] = {
        {"newton", newton}, {"walk", whole_walk}, {"seed", seed}};
    const std::pair<const char*, const CausticScene& (*)()> scenes[] = {
        {"reflective_plane", reflective_plane},
        {"refractive_sphere", refractive_sphere},
        {"smooth_ring", smooth_ring}};
    const std::pair<const char*, Constraint> constraints[] = {
        {"half_vector", Constraint::half_vector},
        {"angle_difference", Constraint::angle_difference}};
    for (const auto& [what, kernel] : kernels)
        for (const auto& [where, scene] : scenes)
            for (const auto& [how, constraint] : constraints) {
                ManifoldSettings settings;
                settings.enabled = true;
                settings.constraint = constraint;
                const std::string name = std::string(what) + "/" + where + "/" + how;
                benchmark::RegisterBenchmark(
                    name.c_str(), [kernel = kernel, scene = scene, settings](auto& state) {
                        kernel(state, scene(), settings);
                    });
            }
}

}  // namespace spc::bench
