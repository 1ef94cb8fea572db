// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/sheet.h"

#include "core/parallel.h"
#include "math/warp.h"

#include <utility>

namespace spc {

namespace {

constexpr float kLeastProbability =
    1.0f / 512;  // of a chain seed: chains may carry more than it promises

// Where x lies between the three rays of a beam: barycentrics of the second and third, and m along
// the rays from where they landed. Two steps of Newton's method on p(b) + s d(b) = x.
std::optional<Vec3> locate(const std::array<const BeamEdge*, 3>& edges,
                           const std::array<Vec3, 3>& landed, const Vec3& x) {
    const Vec3 p0 = landed[0], e1 = landed[1] - p0, e2 = landed[2] - p0;
    const Vec3 d0 = edges[0]->d, f1 = edges[1]->d - d0, f2 = edges[2]->d - d0;
    Vec3 at(1.0f / 3, 1.0f / 3, 0.0f);
    for (int i = 0; i < 2; ++i) {
        const Vec3 d = d0 + f1 * at.x + f2 * at.y;
        const Vec3 c1 = e1 + f1 * at.z, c2 = e2 + f2 * at.z;
        const Vec3 off = x - (p0 + e1 * at.x + e2 * at.y + d * at.z);
        const Vec3 normal = cross(c1, c2);
        const float det = dot(normal, d);
        if (std::abs(det) < 1e-30f) return std::nullopt;
        at += Vec3(dot(cross(off, c2), d), dot(cross(c1, off), d), dot(normal, off)) * (1.0f / det);
    }
    return at;
}

// All that is beside the beam by its margin at most, and nearly as deep.
MovingPrism prism_of(const std::array<const BeamEdge*, 3>& edges, const Beam& beam, float margin) {
    const float scale = 1.0f + 3.0f * margin;
    const auto widen = [&](const auto& of) {
        const Vec3 center = (of(0) + of(1) + of(2)) * (1.0f / 3);
        std::array<Vec3, 3> wide;
        for (size_t i = 0; i < 3; ++i) wide[i] = center + (of(i) - center) * scale;
        return wide;
    };
    const std::array<Vec3, 3> landed = widen([&](size_t i) { return edges[i]->landed; });
    MovingPrism prism;
    for (size_t i = 0; i < 3; ++i) {
        prism.corners[i].p = landed[i];
        prism.corners[i].half = edges[i]->d * beam.depth;
    }
    for (size_t j = 0; j < 3; ++j) {
        const std::array<Vec3, 3> moved = widen([&](size_t i) { return edges[i]->landed_moved[j]; });
        for (size_t i = 0; i < 3; ++i) prism.corners[i].motion[j] = moved[i];
    }
    return prism;
}

std::array<const BeamEdge*, 3> edges_of(const BeamSet& set, const Beam& beam) {
    return {&set.edges[beam.edges[0]], &set.edges[beam.edges[1]], &set.edges[beam.edges[2]]};
}

// Around a prism, wherever shifts within reach take it.
std::array<HalfSpace, 5> sides_around(const MovingPrism& prism, float reach) {
    const auto& [a, b, c] = prism.corners;
    const auto before = [&](const Vec3& direction) {
        const float size = length(direction);
        HalfSpace side{size > 0.0f ? direction * (1.0f / size) : Vec3(0.0f), -kInfinity};
        for (const auto& [p, half, motion] : prism.corners) {
            float squares = 0.0f;
            for (const Vec3& moved : motion) squares += sqr(dot(side.normal, moved));
            const float far = std::abs(dot(side.normal, half)) + reach * std::sqrt(squares);
            side.upper = std::max(side.upper, dot(side.normal, p) + far);
        }
        return side;
    };
    const Vec3 along = a.half + b.half + c.half;
    const bool forward = dot(cross(b.p - a.p, c.p - a.p), along) > 0.0f;
    const Vec3 d = forward ? along : along * -1.0f;
    return {before(cross(b.p - a.p, d)), before(cross(c.p - b.p, d)), before(cross(a.p - c.p, d)),
            before(d), before(d * -1.0f)};
}

Vec3 moved_by(const std::array<Vec3, 3>& moved, const Vec3& shift) {
    return moved[0] * shift.x + moved[1] * shift.y + moved[2] * shift.z;
}

}  // namespace

LightSheet::LightSheet(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells,
                       float reach, std::span<const LightPoint> around)
    : y_(y), all_(trace_beams(world, y, emission_cells, around)) {
    if (!y.delta) build_folds(reach, world.budget);  // rays do not come to points
    if (!world.budget.is_cancelled()) build_layers(reach, world);
}

float LightSheet::Entry::density() const {
    // Where few chain seeds arrive, mostly at chains that others lead to as well.
    constexpr float kBeside = 1.0f / 16;
    return beam.density * (inside ? 1.0f : kBeside);
}

void LightSheet::build_layers(float reach, const SheetWorld& world) {
    constexpr size_t kMostLayers = 24;
    std::vector<Entry> unordered;
    for (const Beam& beam : std::exchange(all_.beams, {})) {
        unordered.push_back({beam, true});
        if (beam.margin > 0.0f) unordered.push_back({beam, false});
    }
    struct Key {
        float density;
        uint32_t entry;
        bool operator<(const Key& other) const {  // the densest first
            return density != other.density ? density > other.density : entry < other.entry;
        }
    };
    std::vector<Key> keys;
    for (uint32_t i = 0; i < unordered.size(); ++i) keys.push_back({unordered[i].density(), i});
    std::sort(keys.begin(), keys.end());
    const auto least = static_cast<long>(keys.size() / kMostLayers + 1);
    std::vector<std::span<const Key>> keys_of_layers;
    for (auto begin = keys.begin(), end = begin; begin != keys.end(); begin = end) {
        const float largest = begin->density;
        while (end != keys.end() && (end < begin + least || end->density > 0.5f * largest)) ++end;
        layers_.push_back({largest, {}, {}});
        keys_of_layers.emplace_back(begin, end);
    }
    parallel_for(world.threads, static_cast<uint32_t>(layers_.size()), [&](uint32_t k) {
        Layer& layer = layers_[k];
        const std::span<const Key> own = keys_of_layers[k];
        const auto shape = [&](uint32_t i) {
            const auto& [beam, inside] = unordered[own[i].entry];
            return prism_of(edges_of(all_, beam), beam, inside ? 0.0f : beam.margin);
        };
        std::vector<uint32_t> order;
        layer.tree = PrismTree(static_cast<uint32_t>(own.size()), shape, reach, order,
                               PrismTree::Volumes::move, world.budget);
        if (world.budget.is_cancelled()) return;
        layer.entries.reserve(order.size());
        for (const uint32_t i : order) layer.entries.push_back(unordered[own[i].entry]);
    });
}

void LightSheet::build_folds(float reach, const Budget& budget) {
    const auto parallelogram_of = [&](const Beam& beam) {
        const auto [a, b, c] = edges_of(all_, beam);
        return FoldParallelogram{a->last, b->last - a->last, c->last - a->last};
    };
    std::vector<const Beam*> beams;
    for (const Beam& beam : all_.beams) {
        if (!(beam.margin > 0.0f)) continue;
        const FoldParallelogram parallelogram = parallelogram_of(beam);
        // Without area it would be drawn, but no density would tell of it.
        if (length_squared(cross(parallelogram.e1, parallelogram.e2)) > 0.0f)
            beams.push_back(&beam);
    }
    const auto shape = [&](uint32_t i) {
        return prism_of(edges_of(all_, *beams[i]), *beams[i], 0.0f);
    };
    std::vector<uint32_t> order;
    fold_tree_ = PrismTree(static_cast<uint32_t>(beams.size()), shape, reach, order,
                           PrismTree::Volumes::stay, budget);
    for (const uint32_t i : order) {
        if (budget.is_cancelled()) return;
        folds_.push_back({parallelogram_of(*beams[i]), sides_around(shape(i), reach)});
    }
}

bool LightSheet::find_folds(const Vec3& x, size_t most,
                            std::vector<const FoldParallelogram*>& parallelograms) const {
    bool few = true;
    fold_tree_.visit(x, Vec3(0.0f), [&](uint32_t i) {
        const auto& [parallelogram, sides] = folds_[i];
        if (!std::all_of(sides.begin(), sides.end(), [&](const HalfSpace& s) { return s.holds(x); }))
            return true;
        few = parallelograms.size() < most;
        if (few) parallelograms.push_back(&parallelogram);
        return few;
    });
    return few;
}

std::vector<Vec3> LightSheet::lit_points(uint32_t count, Pcg& pcg) const {
    std::vector<const Beam*> beams;
    std::vector<float> light;
    const auto corner = [&](const Beam& beam, size_t i) { return all_.edges[beam.edges[i]].landed; };
    for (const Layer& layer : layers_)
        for (const Entry& entry : layer.entries) {
            if (!entry.inside) continue;
            const Vec3 p = corner(entry.beam, 0);
            beams.push_back(&entry.beam);
            light.push_back(entry.beam.density *
                            length(cross(corner(entry.beam, 1) - p, corner(entry.beam, 2) - p)));
        }
    const DiscreteDistribution by_light(light);
    std::vector<Vec3> points;
    for (uint32_t k = 0; k < count && !by_light.empty(); ++k) {
        const Beam& beam = *beams[by_light.sample(pcg.one()).index];
        const Vec2 b = uniform_triangle(pcg.two());
        const Vec3 p = corner(beam, 0);
        points.push_back(p + (corner(beam, 1) - p) * b.x + (corner(beam, 2) - p) * b.y);
    }
    return points;
}

Vec3 shift_between(const LightPoint& from, const LightPoint& to) {
    return from.distant ? to.direction - from.direction : to.p - from.p;
}

bool repeats(const SheetSeed& chain_seed, const SheetSeed& other) {
    if (chain_seed.inside || !other.inside || other.probability < chain_seed.probability ||
        chain_seed.kind != other.kind || chain_seed.positive != other.positive)
        return false;
    const auto shared = [&](uint32_t edge) {
        return std::find(other.edges.begin(), other.edges.end(), edge) != other.edges.end();
    };
    return std::any_of(chain_seed.edges.begin(), chain_seed.edges.end(), shared);
}

std::array<Vec3, 3> LightSheet::directions_around(const SheetSeed& chain_seed, const Vec3& x,
                                                  const Vec3& shift) const {
    std::array<Vec3, 3> directions;
    for (size_t i = 0; i < 3; ++i) {
        const BeamEdge& edge = all_.edges[chain_seed.edges[i]];
        directions[i] = normalize(edge.last + moved_by(edge.last_moved, shift) - x);
    }
    return directions;
}

void LightSheet::find_seeds(const Vec3& x, const Vec3& shift, float probability_per_density,
                            float u, std::vector<SheetSeed>& chain_seeds) const {
    for (const Layer& layer : layers_)
        if (std::max(layer.density * probability_per_density, kLeastProbability) > u)
            layer.tree.visit(x, shift, [&](uint32_t i) {
                add_seed(layer.entries[i], x, shift, probability_per_density, u, chain_seeds);
                return true;
            });
    std::partition(chain_seeds.begin(), chain_seeds.end(),
                   [](const SheetSeed& chain_seed) { return chain_seed.inside; });
}

void LightSheet::add_seed(const Entry& entry, const Vec3& x, const Vec3& shift,
                          float probability_per_density, float u,
                          std::vector<SheetSeed>& chain_seeds) const {
    const Beam& beam = entry.beam;
    const float probability =
        std::clamp(entry.density() * probability_per_density, kLeastProbability, 1.0f);
    if (!(probability > u)) return;
    const std::array<const BeamEdge*, 3> edges = edges_of(all_, beam);
    std::array<Vec3, 3> landed;
    for (size_t i = 0; i < 3; ++i)
        landed[i] = edges[i]->landed + moved_by(edges[i]->landed_moved, shift);
    const std::optional<Vec3> at = locate(edges, landed, x);
    if (!at || !(std::abs(at->z) <= beam.depth)) return;
    const float b0 = 1.0f - at->x - at->y, least = std::min({b0, at->x, at->y});
    if (entry.inside ? least < 0.0f : least >= 0.0f || least < -beam.margin) return;
    const auto last_of = [&](size_t i) {
        return edges[i]->last + moved_by(edges[i]->last_moved, shift);
    };
    const Vec3 last = last_of(0) * b0 + last_of(1) * at->x + last_of(2) * at->y;
    const Vec3 to = last - x;
    const float distance = length(to);
    if (!(distance > 0.0f)) return;
    const bool forward =
        dot(cross(landed[1] - landed[0], landed[2] - landed[0]), edges[0]->d) > 0.0f;
    // Across the direction of a distant light places turn the other way.
    chain_seeds.push_back({&all_.kinds[beam.kind], to * (1.0f / distance), probability,
                           entry.inside, forward != y_.distant, beam.edges});
}

}  // namespace spc
