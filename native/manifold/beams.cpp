// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/beams.h"

#include "core/parallel.h"

#include <map>

namespace spc {

namespace {

constexpr uint32_t kGridCells = 16;  // cells of the grid of rays along a side of an emission cell
constexpr uint32_t kCorners = kGridCells + 1;
constexpr uint32_t kFinestLevel = 16;

// Where one ray ends on a receiver.
struct Landing {
    ChainKind kind;    // from the light on
    uint32_t ordinal;  // among the receivers behind the last caster
    BeamEdge edge;
    uint32_t instance;
    Vec3 ng;
    float throughput;  // largest component
    float light;  // that arrives, by solid angle at the light or area across it, largest channel
};

// Follows one ray from the light along every way through the casters.
class SheetRay {
public:
    SheetRay(const SheetWorld& world, const LightPoint& y, std::span<const LightPoint> around,
             std::vector<Landing>& landings, uint64_t& rays)
        : world_(world),
          scene_(world.scene),
          y_(y),
          around_(around),
          landings_(landings),
          rays_(rays) {}

    void follow(const Vec2& place) {
        Ray ray = ray_at(world_.guide, y_, place);
        ray.origin = offset_from_light(scene_, y_, ray.origin, ray.direction);
        const Frame frame = Frame::around(y_.distant ? y_.direction : ray.direction);
        across_ = {frame.x, frame.y};
        const RayDual dual{.d = Vec3d(ray.direction), .dp = {}, .dd = {}};
        follow(ray, dual, ChainKind{}, 1.0f);
    }

private:
    void follow(Ray ray, const RayDual& dual, const ChainKind& kind, float throughput) {
        uint32_t ordinal = 0;
        bool in_shadow = false;
        for (;;) {
            ++rays_;
            const std::optional<Hit> hit = scene_.accel->intersect(ray, kVisibleScattered);
            if (!hit) return;
            ray.t_near = past(hit->t);
            if (hit->light != kNone) continue;  // lamps are looked through
            const Instance& instance = scene_.instances[hit->surface.instance];
            if (kind.count > 0 && instance.receiver)
                land(ray, dual, *hit, kind, ordinal++, throughput);
            if (world_.casters.of_instance[hit->surface.instance] != kNone) {
                if (!in_shadow || is_lit_from_around(hit->surface))
                    branch(ray, dual, *hit, kind, throughput);
                return;
            }
            const bool transparent =
                scene_.any_transparency && ordinal < kMostReceivers &&
                !is_black(surface_transparency(scene_, hit->surface, ray.direction * -1.0f));
            if (transparent) continue;
            if (kind.count > 0 || around_.empty()) return;
            in_shadow = true;
        }
    }

    bool is_lit_from_around(const SurfaceHit& hit) {
        const DifferentialGeometry geometry = evaluate_caster(scene_, hit, false);
        return std::any_of(around_.begin(), around_.end(), [&](const LightPoint& y) {
            uint32_t transparent_left = kMostReceivers;
            Media media{};
            return !is_black(transmittance(scene_, {geometry.p, geometry.ng, geometry.p_error},
                                           ray_end(scene_, y), kVisibleShadow, transparent_left,
                                           media, rays_, Opaque::casters_too,
                                           blockers_of(world_.lights, y.light)));
        });
    }

    void land(const Ray& ray, const RayDual& dual, const Hit& hit, const ChainKind& kind,
              uint32_t ordinal, float throughput) {
        const Vec3 landed = surface_position(scene_, hit.surface);
        const Vec3 ng = front_normal(scene_, hit.surface.instance, hit.surface.triangle);
        BeamEdge edge{ray.origin, ray.direction, landed, {}, {}};
        edge.last_moved.fill(Vec3(0.0f));
        edge.landed_moved.fill(Vec3(0.0f));
        const float cosine = dot(ray.direction, ng);
        for (size_t j = 0; j < 2 && cosine != 0.0f; ++j) {
            const Vec3 last(dual.dp[j]);
            const Vec3 free = last + Vec3(dual.dd[j]) * hit.t;
            const Vec3 on_receiver = free - ray.direction * (dot(free, ng) / cosine);
            for (int k = 0; k < 3; ++k) {
                edge.last_moved[static_cast<size_t>(k)] += last * across_[j][k];
                edge.landed_moved[static_cast<size_t>(k)] += on_receiver * across_[j][k];
            }
        }
        landings_.push_back(
            {kind, ordinal, edge, hit.surface.instance, ng, throughput, throughput * emitted_});
    }

    // Reflected and refracted, as far as either carries light.
    void branch(const Ray& ray, const RayDual& before, const Hit& at, const ChainKind& kind,
                float throughput) {
        if (kind.count == world_.longest_chain) return;
        const SurfaceHit& hit = at.surface;
        const SpecularInterface& specular = scene_.material_of(hit).specular;
        Surface surface;
        evaluate_surface(scene_, hit, ray.direction * -1.0f, surface);
        const DifferentialGeometry geometry = evaluate_caster(scene_, hit, false);
        RayDual arriving = before;
        double distance = static_cast<double>(at.t);
        if (kind.count == 0) {
            emitted_ = emitted_to(geometry.p, ray.direction);
            if (!(emitted_ > 0.0f)) return;
            // From points of the light next to y to this very point of the caster: its normal,
            // which may vary fast, stays.
            for (size_t j = 0; j < 2; ++j) {
                arriving.dp[j] = Vec3d(0.0);
                arriving.dd[j] = Vec3d(across_[j]) * (y_.distant ? -1.0 : -1.0 / distance);
            }
            distance = 0.0;
        }
        for (const Interaction interaction : {Interaction::reflection, Interaction::refraction}) {
            if (!has_interaction(specular, interaction)) continue;
            if (kind.count == 0 && !light_takes(interaction)) continue;
            const float eta = eta_seen_from(geometry.ng, ray.direction * -1.0f, specular.ior);
            RayDual dual = arriving;
            if (!propagate_through_vertex({interaction, eta, geometry}, distance, dual)) continue;
            const Vec3 out(dual.d);
            const bool refracts = interaction == Interaction::refraction;
            if ((dot(out, surface.ng) < 0.0f) != refracts) continue;
            const DeltaLobe lobe =
                delta_lobe(surface.closures, surface.ng, surface.wo, out, refracts);
            const float left = throughput * max_component(lobe.throughput);
            if (!(left > kLeastThroughput)) continue;
            ChainKind longer = kind;
            longer.append({hit.instance, interaction});
            const Vec3 origin = offset_origin({surface.p, surface.ng, surface.p_error}, out);
            follow({origin, out, 0.0f, kInfinity}, dual, longer, left);
        }
    }

    // See Landing::light. For a lamp it is the largest over the lamp's points: where this light
    // point does not shine, a neighbour may.
    float emitted_to(const Vec3& p, const Vec3& direction) const {
        const float cosine = dot(y_.n, direction);
        const Spectrum radiance =
            brightest_at(world_.lights, scene_, y_, p, cosine >= 0.0f ? direction : y_.n);
        return max_component(radiance) *
               (y_.distant || y_.delta ? 1.0f : std::max(kLeastCosine, cosine));
    }

    bool light_takes(Interaction interaction) const {
        const uint32_t kind =
            interaction == Interaction::reflection ? kVisibleGlossy : kVisibleTransmission;
        return (light_visibility(world_.lights, y_.light) & kind) != 0;
    }

    static constexpr uint32_t kMostReceivers = 4;
    static constexpr float kLeastThroughput = 1.0f / 8192;
    static constexpr float kLeastCosine = 1.0f / 4;  // at the light, for the points around

    const SheetWorld& world_;
    const Scene& scene_;
    const LightPoint& y_;
    std::span<const LightPoint> around_;  // points of the same light
    std::vector<Landing>& landings_;
    uint64_t& rays_;
    std::array<Vec3, 2> across_;  // unit, across the light's first ray
    float emitted_ = 0.0f;        // as Landing::light
};

// A square of a light's unit square, of side 2^-level.
struct Square {
    uint32_t x, y, level;
    float area() const { return std::ldexp(1.0f, -2 * static_cast<int>(level)); }
};

// What beams there are around one ray.
struct Mark {
    bool forward = false, backward = false;  // their orientations
    uint32_t beams = 0, expected = 0;

    void add(const Mark& other) {
        forward = forward || other.forward;
        backward = backward || other.backward;
        beams += other.beams;
        expected += other.expected;
    }
};
// A ray on an emission cell's border, which neighbouring emission cells have as well. Its key is
// its place on the finest grid, its chain kind, and Landing::ordinal.
struct BorderRay {
    std::array<uint32_t, 4> key;  // place, kind, Landing::ordinal
    uint32_t edge;
};
struct MarkedBeams {
    BeamSet set;
    std::vector<Mark> marks;  // of the set's edges
    std::vector<BorderRay> border;
};
struct TracedCell {
    Square square;
    // Area of the unit square that falls to grid cells which are no smooth part of a sheet.
    float irregular = 0.0f;
    MarkedBeams beams;
};

// A square's grid of rays, made into beams; without any once the budget is cancelled.
class EmissionCell {
public:
    EmissionCell(const SheetWorld& world, const LightPoint& y, std::span<const LightPoint> around,
                 const Square& emission_cell) {
        const float side = std::ldexp(1.0f, -static_cast<int>(emission_cell.level));
        // Solid angle, or area across the direction of a distant light, of a beam.
        beam_size_ = 0.5f * sqr(side / kGridCells) / density_of_uniform(world.guide, y);
        for (uint32_t j = 0; j < kCorners; ++j)
            for (uint32_t i = 0; i < kCorners; ++i) {
                if (world.budget.is_cancelled()) return;
                const auto at = [&](uint32_t corner, uint32_t k) {
                    const float place = (static_cast<float>(corner) +
                                         static_cast<float>(k) / static_cast<float>(kGridCells)) *
                                        side;
                    return std::min(place, 1.0f - 0x1p-24f);
                };
                begin_[j * kCorners + i] = static_cast<uint32_t>(landings_.size());
                SheetRay(world, y, around, landings_, traced_.beams.set.rays)
                    .follow({at(emission_cell.x, i), at(emission_cell.y, j)});
            }
        begin_[kCorners * kCorners] = static_cast<uint32_t>(landings_.size());
        traced_.beams.marks.resize(landings_.size());
        for (uint32_t j = 0; j < kGridCells; ++j)
            for (uint32_t i = 0; i < kGridCells; ++i) fill_cell(i, j);
        finish(emission_cell);
        traced_.square = emission_cell;
        traced_.irregular =
            emission_cell.level == kFinestLevel ? 0.0f : irregularity_ * emission_cell.area();
    }
    TracedCell take() { return std::move(traced_); }

private:
    uint32_t corner(uint32_t i, uint32_t j) const { return j * kCorners + i; }

    // The landing of the same kind at another corner, or kNone.
    uint32_t counterpart(const Landing& landing, uint32_t at) const {
        for (uint32_t k = begin_[at]; k < begin_[at + 1]; ++k)
            if (landings_[k].ordinal == landing.ordinal && landings_[k].kind == landing.kind)
                return k;
        return kNone;
    }

    void fill_cell(uint32_t i, uint32_t j) {
        const std::array<uint32_t, 4> corners{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1),
                                              corner(i, j + 1)};
        for (size_t c = 0; c < 4; ++c)
            for (uint32_t k = begin_[corners[c]]; k < begin_[corners[c] + 1]; ++k) {
                std::array<uint32_t, 4> ends;
                bool first = true;  // the corner at which this kind comes first
                for (size_t o = 0; o < 4; ++o) {
                    ends[o] = o == c ? k : counterpart(landings_[k], corners[o]);
                    first = first && (o >= c || ends[o] == kNone);
                }
                if (first) fill_kind(ends);
            }
    }

    void fill_kind(const std::array<uint32_t, 4>& ends) {
        float throughput = 0.0f;
        bool whole = true;
        for (size_t c = 0; c < 4; ++c) {
            const uint32_t k = ends[c];
            whole = whole && k != kNone;
            if (k == kNone) continue;
            throughput = std::max(throughput, landings_[k].throughput);
            traced_.beams.marks[k].expected += c % 2 == 0 ? 2 : 1;
        }
        add_beam(ends[0], ends[1], ends[2]);
        add_beam(ends[0], ends[2], ends[3]);
        irregularity_ += throughput * (whole ? std::min(1.0f, bend(ends)) : kEnd);
    }

    // How far the cell's fourth corner lies from where three of them would have it, by their
    // distances.
    float bend(const std::array<uint32_t, 4>& ends) const {
        const auto p = [&](size_t i) { return landings_[ends[i]].edge.landed; };
        const float off = length(p(0) + p(2) - p(1) - p(3));
        const float size = std::max(
            {length(p(1) - p(0)), length(p(2) - p(1)), length(p(3) - p(2)), length(p(0) - p(3))});
        return size > 0.0f ? off / size : 0.0f;
    }

    void add_beam(uint32_t a, uint32_t b, uint32_t c) {
        if (a == kNone || b == kNone || c == kNone) return;
        const Landing &la = landings_[a], &lb = landings_[b], &lc = landings_[c];
        const Vec3 e1 = lb.edge.landed - la.edge.landed, e2 = lc.edge.landed - la.edge.landed;
        const float longest = std::max({length(e1), length(e2), length(e1 - e2)});
        const bool flat = la.instance == lb.instance && la.instance == lc.instance &&
                          dot(la.ng, lb.ng) > kFlat && dot(la.ng, lc.ng) > kFlat;
        const float depth =
            longest * (flat ? kFlatDepth : 1.0f) + 1e-5f * length(la.edge.landed - la.edge.last);
        const bool forward = dot(cross(e1, e2), la.edge.d) > 0.0f;
        for (const uint32_t k : {a, b, c}) {
            (forward ? traced_.beams.marks[k].forward : traced_.beams.marks[k].backward) = true;
            ++traced_.beams.marks[k].beams;
        }
        traced_.beams.set.beams.push_back({{a, b, c}, 0, 0.0f, depth, 0.0f});
    }

    // Light in the beam by area across it.
    float density_of(const Beam& beam) const {
        const Landing &a = landings_[beam.edges[0]], &b = landings_[beam.edges[1]],
                      &c = landings_[beam.edges[2]];
        const Vec3 e1 = b.edge.landed - a.edge.landed, e2 = c.edge.landed - a.edge.landed;
        const float area = 0.5f * std::abs(dot(cross(e1, e2), a.edge.d));
        return std::max({a.light, b.light, c.light}) * beam_size_ / std::max(area, 1e-20f);
    }

    void finish(const Square& emission_cell) {
        std::map<ChainKind, uint32_t> index;
        for (const Landing& landing : landings_) {
            traced_.beams.set.edges.push_back(landing.edge);
            const auto [at, added] =
                index.try_emplace(landing.kind, static_cast<uint32_t>(index.size()));
            if (added) traced_.beams.set.kinds.push_back(landing.kind.reversed());
        }
        for (Beam& beam : traced_.beams.set.beams) {
            beam.kind = index[landings_[beam.edges[0]].kind];
            beam.density = density_of(beam);
        }
        list_border(emission_cell, index);
    }

    void list_border(const Square& emission_cell, std::map<ChainKind, uint32_t>& kinds) {
        const uint32_t cell = 1u << (kFinestLevel - emission_cell.level);
        for (uint32_t j = 0; j < kCorners; ++j)
            for (uint32_t i = 0; i < kCorners; ++i) {
                if (i % kGridCells != 0 && j % kGridCells != 0) continue;
                const uint32_t x = (emission_cell.x * kGridCells + i) * cell,
                               y = (emission_cell.y * kGridCells + j) * cell;
                const uint32_t at = corner(i, j);
                for (uint32_t k = begin_[at]; k < begin_[at + 1]; ++k)
                    traced_.beams.border.push_back(
                        {{x, y, kinds[landings_[k].kind], landings_[k].ordinal}, k});
            }
    }

    static constexpr float kFlat = 0.999f, kFlatDepth = 0.05f;
    // Irregularity of a grid cell in which a sheet ends; a bent one has at most 1. Beyond its beams
    // there are chains that no beam leads to, as at the silhouette of a rippled caster.
    static constexpr float kEnd = 3.0f;

    TracedCell traced_;
    float beam_size_;
    std::vector<Landing> landings_;
    std::array<uint32_t, kCorners * kCorners + 1> begin_{};
    float irregularity_ = 0.0f;
};

// Squares of one level into which the places fall, and their neighbours.
std::vector<Square> squares_around(std::span<const Vec2> places, uint32_t level) {
    const uint32_t side = 1u << level;
    std::map<std::pair<uint32_t, uint32_t>, bool> set;
    for (const Vec2& place : places) {
        const auto x = static_cast<uint32_t>(place.x * static_cast<float>(side));
        const auto y = static_cast<uint32_t>(place.y * static_cast<float>(side));
        for (uint32_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, side - 1); ++j)
            for (uint32_t i = x > 0 ? x - 1 : 0; i <= std::min(x + 1, side - 1); ++i)
                set[{j, i}] = true;
    }
    std::vector<Square> squares;
    squares.reserve(set.size());
    for (const auto& [at, used] : set) squares.push_back({at.second, at.first, level});
    return squares;
}

// Where random points of the casters lie in the light's square.
std::vector<Vec2> places_of_casters(const SheetWorld& world, const LightPoint& y) {
    constexpr uint32_t kPoints = 1u << 14;
    std::vector<Vec2> places;
    Pcg pcg(y.light);
    for (uint32_t i = 0; i < kPoints; ++i) {
        const Caster& caster = world.casters.casters[i % world.casters.casters.size()];
        const Vec3 p = surface_position(world.scene, sample_on(caster, pcg));
        if (const std::optional<Vec2> place =
                place_towards(world.guide, y.light, {y.distant, y.p, y.direction}, p))
            places.push_back(*place);
    }
    return places;
}

// The finest level at which the places fill no more squares than that.
std::vector<Square> first_squares(std::span<const Vec2> places, size_t most) {
    std::vector<Square> squares = squares_around(places, 0);
    for (uint32_t level = 1; level <= kFinestLevel; ++level) {
        std::vector<Square> finer = squares_around(places, level);
        if (finer.size() > most) break;
        squares = std::move(finer);
    }
    return squares;
}

// Traces emission cells, and splits the least regular ones, an eighth of them at a time.
std::vector<TracedCell> trace_cells(const SheetWorld& world, const LightPoint& y,
                                    std::span<const LightPoint> around, size_t budget) {
    std::vector<TracedCell> emission_cells;
    double rays = 0.0;
    const auto add = [&](const std::vector<Square>& squares) {
        std::vector<TracedCell> traced(squares.size());
        parallel_for(world.threads, static_cast<uint32_t>(squares.size()), [&](uint32_t i) {
            if (world.budget.must_end()) return;
            traced[i] = EmissionCell(world, y, around, squares[i]).take();
        });
        for (TracedCell& emission_cell : traced) {
            rays += static_cast<double>(emission_cell.beams.set.rays);
            if (!emission_cell.beams.set.edges.empty())
                emission_cells.push_back(std::move(emission_cell));
        }
    };
    const std::vector<Vec2> places = places_of_casters(world, y);
    add(first_squares(places, budget / 4));
    while (!emission_cells.empty() && emission_cells.size() < budget && rays < world.most_rays &&
           !world.budget.must_end()) {
        const auto by_need = [](const TracedCell& a, const TracedCell& b) {
            return a.irregular < b.irregular;
        };
        std::stable_sort(emission_cells.begin(), emission_cells.end(), by_need);
        size_t splits =
            std::min(emission_cells.size() / 8 + 1, (budget - emission_cells.size()) / 3 + 1);
        std::vector<Square> finer;
        for (; splits > 0 && !emission_cells.empty() && emission_cells.back().irregular > 0.0f;
             --splits) {
            const Square& coarse = emission_cells.back().square;
            for (uint32_t q = 0; q < 4; ++q)
                finer.push_back({2 * coarse.x + (q & 1), 2 * coarse.y + (q >> 1), coarse.level + 1});
            emission_cells.pop_back();
        }
        if (finer.empty()) break;
        add(finer);
    }
    return emission_cells;
}

// Appends the beams of an emission cell to those of all. `kinds`: indices of all chain kinds so
// far.
void append(const MarkedBeams& part, std::map<ChainKind, uint32_t>& kinds, MarkedBeams& all) {
    const auto offset = static_cast<uint32_t>(all.set.edges.size());
    all.set.edges.insert(all.set.edges.end(), part.set.edges.begin(), part.set.edges.end());
    all.marks.insert(all.marks.end(), part.marks.begin(), part.marks.end());
    std::vector<uint32_t> index(part.set.kinds.size());
    for (size_t k = 0; k < index.size(); ++k) {
        const auto [at, added] =
            kinds.try_emplace(part.set.kinds[k], static_cast<uint32_t>(kinds.size()));
        if (added) all.set.kinds.push_back(part.set.kinds[k]);
        index[k] = at->second;
    }
    for (Beam beam : part.set.beams) {
        for (uint32_t& edge : beam.edges) edge += offset;
        beam.kind = index[beam.kind];
        all.set.beams.push_back(beam);
    }
    for (BorderRay ray : part.border) {
        ray.key[2] = index[ray.key[2]];
        ray.edge += offset;
        all.border.push_back(ray);
    }
    all.set.rays += part.set.rays;
}

// Combines what rays on borders have around them in each of their emission cells.
void join_borders(MarkedBeams& all) {
    std::stable_sort(all.border.begin(), all.border.end(),
                     [](const BorderRay& a, const BorderRay& b) { return a.key < b.key; });
    for (auto begin = all.border.begin(), end = begin; begin != all.border.end(); begin = end) {
        Mark joined;
        for (; end != all.border.end() && end->key == begin->key; ++end)
            joined.add(all.marks[end->edge]);
        for (auto ray = begin; ray != end; ++ray) all.marks[ray->edge] = joined;
    }
}

// Where a sheet folds over or ends, chains lie beyond its triangles.
void set_margins(MarkedBeams& all) {
    constexpr float kFoldMargin = 0.75f, kEndMargin = 1.0f;
    for (Beam& beam : all.set.beams) {
        const auto any = [&](const auto& test) {
            return std::any_of(beam.edges.begin(), beam.edges.end(),
                               [&](uint32_t k) { return test(all.marks[k]); });
        };
        beam.margin = 0.0f;
        if (any([](const Mark& mark) { return mark.forward && mark.backward; }))
            beam.margin = kFoldMargin;
        if (any([](const Mark& mark) { return mark.beams < mark.expected; }))
            beam.margin = kEndMargin;
    }
}

}  // namespace

BeamSet trace_beams(const SheetWorld& world, const LightPoint& y, uint32_t emission_cells,
                    std::span<const LightPoint> around) {
    MarkedBeams all;
    std::map<ChainKind, uint32_t> kinds;
    const std::vector<TracedCell> traced = trace_cells(world, y, around, emission_cells);
    for (const TracedCell& emission_cell : traced) {
        if (world.budget.is_cancelled()) return {};  // nobody waits for what takes as long again
        append(emission_cell.beams, kinds, all);
    }
    join_borders(all);
    set_margins(all);
    return std::move(all.set);
}

}  // namespace spc
