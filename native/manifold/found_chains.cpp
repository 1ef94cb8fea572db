// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/found_chains.h"

namespace spc {

FoundChain* find_chain(const ManifoldSettings& settings, FoundChains& found,
                       const ChainSolution& solution) {
    for (FoundChain& one : found)
        if (same_solution(settings, one.solution, solution)) return &one;
    return nullptr;
}

namespace {

FoundChain& add(const ManifoldSettings& settings, FoundChains& found, const ChainSolution& solution,
                float probability) {
    FoundChain* known = find_chain(settings, found, solution);
    if (known == nullptr) known = &found.emplace_back(FoundChain{solution, probability});
    known->probability = std::max(known->probability, probability);
    return *known;
}

}  // namespace

void shoot_seeds(const Scene& scene, const ManifoldSettings& settings, const LightSheet& sheet,
                 const RayStart& x, const LightPoint& y, float probability_per_density, float u,
                 FoundChains& found, ManifoldStats& stats) {
    static thread_local std::vector<SheetSeed> chain_seeds;
    chain_seeds.clear();
    const Vec3 shift = shift_between(sheet.light_point(), y);
    sheet.find_seeds(x.p, shift, probability_per_density, u, chain_seeds);
    constexpr float kLeastStep = 1e-4f, kLargestStep = 0.1f;  // rad
    std::vector<const SheetSeed*> arrived;
    for (const SheetSeed& chain_seed : chain_seeds) {
        const auto repeated = [&](const SheetSeed* other) { return repeats(chain_seed, *other); };
        if (std::any_of(arrived.begin(), arrived.end(), repeated)) continue;
        ++stats.chain_seeds;
        const auto shoot_along = [&](const Vec3& w) {
            return shoot(scene, settings, x, end_of(y), *chain_seed.kind, w,
                         chain_seed.inside ? settings.max_halvings : settings.seed_halvings, stats);
        };
        std::optional<ChainSolution> solution = shoot_along(chain_seed.w);
        if (!solution && chain_seed.inside)  // there is a chain, if nothing breaks the beam
            for (const Vec3& w : sheet.directions_around(chain_seed, x.p, shift))
                if ((solution = shoot_along(w))) break;
        if (!solution) continue;
        FoundChain& one = add(settings, found, *solution, chain_seed.probability);
        if ((solution->determinant > 0.0f) == chain_seed.positive) {
            arrived.push_back(&chain_seed);
            continue;
        }
        // The shot has slipped over a fold, to the other of two chains.
        if (one.crossed >= chain_seed.probability) continue;
        one.crossed = chain_seed.probability;
        const float off = std::clamp(length(chain_seed.w - solution->w), kLeastStep, kLargestStep);
        const std::optional<ChainSolution> meant = shoot_across_fold(
            scene, settings, x, end_of(y), *solution, off, settings.seed_halvings, stats);
        if (meant) add(settings, found, *meant, chain_seed.probability);
    }
}

std::optional<ChainSolution> shoot_from_mnee_seed(const Techniques& techniques, const RayStart& x,
                                                  const ChainEnd& end, Interaction first,
                                                  uint32_t caster, ManifoldStats& stats) {
    const Scene& scene = techniques.scene;
    const ManifoldSettings& settings = techniques.manifold;
    const CasterSet& casters = techniques.casters;
    const std::optional<ChainSeed> start =
        first == Interaction::refraction ? straight_chain(scene, settings, x, casters, end, stats)
                                         : central_reflection(x, casters.casters[caster]);
    if (!start) return std::nullopt;
    return shoot(scene, settings, x, end, start->kind, start->w, settings.max_halvings, stats);
}

void shoot_seeds(const Techniques& techniques, const RayStart& x, const LightPoint& y,
                 FoundChains& found, ManifoldStats& stats) {
    const ManifoldSettings& settings = techniques.manifold;
    for (const ChainSeed& chain_seed : techniques.camera_chains->chain_seeds[y.light]) {
        ++stats.chain_seeds;
        const std::optional<ChainSolution> solution =
            shoot(techniques.scene, settings, x, end_of(y), chain_seed.kind, chain_seed.w,
                  settings.seed_halvings, stats);
        if (solution && find_chain(settings, found, *solution) == nullptr)
            found.push_back({*solution, 1.0f});
    }
}

bool seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                const ChainSeed& chain_seed, const ChainSolution& solution, ManifoldStats& stats) {
    if (chain_seed.kind != solution.kind) return false;
    const ManifoldSettings& settings = techniques.manifold;
    const std::optional<ChainSolution> found =
        shoot(techniques.scene, settings, x, end, chain_seed.kind, chain_seed.w,
              settings.seed_halvings, stats);
    return found && same_solution(settings, *found, solution);
}

bool any_seed_finds(const Techniques& techniques, const RayStart& x, const ChainEnd& end,
                    uint32_t light, const ChainSolution& solution, ManifoldStats& stats) {
    const auto finds_it = [&](const ChainSeed& chain_seed) {
        return seed_finds(techniques, x, end, chain_seed, solution, stats);
    };
    const std::vector<ChainSeed>& chain_seeds = techniques.camera_chains->chain_seeds[light];
    return std::any_of(chain_seeds.begin(), chain_seeds.end(), finds_it);
}

namespace {

Vec2 pixel_of(const Camera& camera, const RayStart& x, const ChainSolution& solution) {
    const Vec2 film =
        camera.film_towards(x.p, normalize(solution.chain.vertices[0].geometry.p - x.p));
    return {std::floor(film.x), std::floor(film.y)};
}

bool is_same(const ManifoldSettings& settings, const ChainSolution& one,
             const std::optional<ChainSolution>& other) {
    return other && same_solution(settings, one, *other);
}

}  // namespace

std::optional<ChainSolution> search_pixel(const Techniques& techniques, const RayStart& x,
                                          const Vec2& pixel, const ChainEnd& end, Pcg& pcg,
                                          ManifoldStats& stats) {
    constexpr float kRadius = 4.0f;  // pixels
    const Scene& scene = techniques.scene;
    const ManifoldSettings& settings = techniques.manifold;
    const std::optional<FollowedRay> ray =
        follow_camera_ray(scene, settings, scene.camera.ray_from(x.p, pixel + pcg.two()),
                          techniques.casters, pcg, stats);
    if (!ray) return std::nullopt;
    // Light may wait behind any of the vertices.
    const float radius = kRadius / std::sqrt(scene.camera.film_density_omega(ray->w));
    uint32_t near = 0, chosen = 0;
    for (uint32_t n = ray->fewest; n <= ray->kind.count; ++n)
        if (turn_towards(ray->behind[n - 1], end) < radius &&
            pcg.one() * static_cast<float>(++near) < 1.0f)
            chosen = n;
    if (chosen == 0) return std::nullopt;
    const std::optional<ChainSolution> found = shoot(
        scene, settings, x, end, ray->kind.first(chosen), ray->w, settings.max_halvings, stats);
    if (!found || !(pixel_of(scene.camera, x, *found) == pixel)) return std::nullopt;
    return found;
}

namespace {

RayStart start_of(const CausticPath& path) { return {path.x, path.sides.ng, path.p_error}; }

// The light point that corresponds to the end of a path that another technique has found.
LightPoint light_point(const LightEnd& end) {
    LightPoint y{};
    y.light = end.light;
    y.distant = end.end.distant;
    y.p = end.end.p;
    y.direction = end.end.direction;
    return y;
}

// The path's chain as a shot comes to it; empty where none does, by the accuracy that there is.
std::optional<ChainSolution> shoot_along(const Techniques& techniques, const CausticPath& path,
                                         const LightEnd& end, ManifoldStats& stats) {
    ChainKind kind;
    for (uint32_t i = 0; i < path.count; ++i)
        kind.append({path.vertices[i].hit.instance, path.vertices[i].interaction});
    const Vec3 first = surface_position(techniques.scene, path.vertices[0].hit);
    return shoot(techniques.scene, techniques.manifold, start_of(path), end.end, kind,
                 normalize(first - path.x), techniques.manifold.max_halvings, stats);
}

bool comes_by_definite_search(const Techniques& techniques, const LightSheets& sheets,
                              const CausticPath& path, const LightEnd& end,
                              const ChainSolution& own, ManifoldStats& stats) {
    const ManifoldSettings& settings = techniques.manifold;
    const LightPoint y = light_point(end);
    FoundChains found;
    if (path.from_camera)
        return any_seed_finds(techniques, start_of(path), end.end, end.light, own, stats);
    if (settings.finder == ChainFinder::sheets) {
        if (const LightSheet* sheet = nearest_sheet(sheets, y))
            shoot_seeds(techniques.scene, settings, *sheet, start_of(path), y,
                        std::numeric_limits<float>::max(), 0.0f, found, stats);
    } else if (const std::optional<ChainSolution> one = shoot_from_mnee_seed(
                   techniques, start_of(path), end.end, path.vertices[0].interaction,
                   techniques.casters.of_instance[path.vertices[0].hit.instance], stats)) {
        found.push_back({*one, 1.0f});
    }
    return find_chain(settings, found, own) != nullptr;
}

}  // namespace

uint32_t trials_if_missed(const Techniques& techniques, const LightSheets& sheets,
                          const CausticPath& path, const LightEnd& end, uint32_t most, Pcg& pcg,
                          ManifoldStats& stats) {
    const ManifoldSettings& settings = techniques.manifold;
    const std::optional<ChainSolution> own = shoot_along(techniques, path, end, stats);
    if (own && comes_by_definite_search(techniques, sheets, path, end, *own, stats)) return 0;
    if (!path.from_camera && settings.finder != ChainFinder::sheets) return 1;
    if (!own) return most;
    const RayStart x = start_of(path);
    if (path.from_camera) {
        const Vec2 pixel = pixel_of(techniques.scene.camera, x, *own);
        return count_trials(settings, most, [&] {
            return is_same(settings, *own, search_pixel(techniques, x, pixel, end.end, pcg, stats));
        });
    }
    const uint32_t first = techniques.casters.of_instance[path.vertices[0].hit.instance];
    return count_trials(settings, most, [&] {
        const std::optional<ChainSeed> start =
            sample_chain(techniques.scene, settings, x, techniques.casters, first, pcg, stats);
        return start && is_same(settings, *own,
                                shoot(techniques.scene, settings, x, end.end, start->kind, start->w,
                                      settings.max_halvings, stats));
    });
}

}  // namespace spc
