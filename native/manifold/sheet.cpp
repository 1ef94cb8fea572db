// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/sheet.h"

#include "core/parallel.h"

#include <utility>

namespace spc {

namespace {

constexpr uint32_t kCells = 16;  // of a tile, along each side
constexpr uint32_t kCorners = kCells + 1;
constexpr uint32_t kFinestLevel = 16;
constexpr float kLeastChance = 1.0f / 512;  // of a lead: chains may carry more than it promises

// Where one ray ends on a receiver.
struct Landing {
    ChainKind kind;    // from the light on
    uint32_t ordinal;  // among the receivers behind the last caster
    BeamEdge edge;
    float path;  // m from the light, or from where the rays of a distant one begin
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
        ray.origin = leave_light(scene_, y_, ray.origin, ray.direction);
        const Frame frame = Frame::around(y_.distant ? y_.direction : ray.direction);
        across_ = {frame.x, frame.y};
        const RayDual dual{.d = Vec3d(ray.direction), .dp = {}, .dd = {}};
        follow(ray, dual, 0.0f, ChainKind{}, 1.0f);
    }

private:
    void follow(Ray ray, const RayDual& dual, float path, const ChainKind& kind, float throughput) {
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
                land(ray, dual, path, *hit, kind, ordinal++, throughput);
            if (world_.casters.of_instance[hit->surface.instance] != kNone) {
                if (!in_shadow || is_lit_from_around(hit->surface))
                    branch(ray, dual, path, *hit, kind, throughput);
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
        const CasterPatch patch = evaluate_caster(scene_, hit, false);
        return std::any_of(around_.begin(), around_.end(), [&](const LightPoint& y) {
            ChainEnd end{y.distant, y.p, y.direction};
            if (y.surface.instance != kNone)
                end.margin = position_error(scene_, y.surface.instance, y.surface.triangle) /
                             std::max(kLeastCosine, dot(y.n, normalize(patch.p - y.p)));
            uint32_t transparent_left = kMostReceivers;
            Media media{};
            return !is_black(transmittance(scene_, {patch.p, patch.ng, patch.p_error}, end,
                                           kVisibleShadow, transparent_left, media, rays_,
                                           Opaque::casters_too));
        });
    }

    void land(const Ray& ray, const RayDual& dual, float path, const Hit& hit,
              const ChainKind& kind, uint32_t ordinal, float throughput) {
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
        landings_.push_back({kind, ordinal, edge, path + hit.t, hit.surface.instance, ng,
                             throughput, throughput * emitted_});
    }

    // Reflected and refracted, as far as either carries light.
    void branch(const Ray& ray, const RayDual& before, float path, const Hit& at,
                const ChainKind& kind, float throughput) {
        if (kind.count == world_.longest_chain) return;
        const SurfaceHit& hit = at.surface;
        const SpecularInterface& specular = scene_.material_of(hit).specular;
        Surface surface;
        evaluate_surface(scene_, hit, ray.direction * -1.0f, surface);
        const CasterPatch patch = evaluate_caster(scene_, hit, false);
        RayDual arriving = before;
        double distance = static_cast<double>(at.t);
        if (kind.count == 0) {
            emitted_ = emitted_to(patch.p, ray.direction);
            if (!(emitted_ > 0.0f)) return;
            // From points of the light next to y to this very point of the caster: its normal, which
            // may vary fast, stays.
            for (size_t j = 0; j < 2; ++j) {
                arriving.dp[j] = Vec3d(0.0);
                arriving.dd[j] = Vec3d(across_[j]) * (y_.distant ? -1.0 : -1.0 / distance);
            }
            distance = 0.0;
        }
        for (const Interaction interaction : {Interaction::reflection, Interaction::refraction}) {
            if (!has_interaction(specular, interaction)) continue;
            if (kind.count == 0 && !light_takes(interaction)) continue;
            const float eta = eta_seen_from(patch.ng, ray.direction * -1.0f, specular.ior);
            RayDual dual = arriving;
            if (!pass_vertex({interaction, eta, patch}, distance, dual)) continue;
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
            follow({origin, out, 0.0f, kInfinity}, dual, path + at.t, longer, left);
        }
    }

    // As Landing::light. A point of a lamp that this one does not light, one of its neighbours may.
    float emitted_to(const Vec3& p, const Vec3& direction) const {
        const bool lamp = y_.light < world_.lights.lamps.size();
        const float cosine = dot(y_.n, direction);
        const Spectrum radiance =
            lamp && !y_.distant && !y_.delta
                ? brightest_radiance(world_.lights.lamps[y_.light], p)
                : radiance_at(world_.lights, scene_, y_, cosine >= 0.0f ? direction : y_.n);
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

// A square's grid of rays, made into beams.
class Tile {
public:
    Tile(const SheetWorld& world, const LightPoint& y, std::span<const LightPoint> around,
         const Square& tile, BeamSet& out)
        : out_(out) {
        const float side = std::ldexp(1.0f, -static_cast<int>(tile.level));
        // Solid angle, or area across the direction of a distant light, of a beam.
        beam_size_ = 0.5f * sqr(side / kCells) / density_of_uniform(world.guide, y);
        for (uint32_t j = 0; j < kCorners; ++j)
            for (uint32_t i = 0; i < kCorners; ++i) {
                const auto at = [&](uint32_t corner, uint32_t k) {
                    const float place = (static_cast<float>(corner) +
                                         static_cast<float>(k) / static_cast<float>(kCells)) *
                                        side;
                    return std::min(place, 1.0f - 0x1p-24f);
                };
                begin_[j * kCorners + i] = static_cast<uint32_t>(landings_.size());
                SheetRay(world, y, around, landings_, out_.rays)
                    .follow({at(tile.x, i), at(tile.y, j)});
            }
        begin_[kCorners * kCorners] = static_cast<uint32_t>(landings_.size());
        marks_.resize(landings_.size());
        for (uint32_t j = 0; j < kCells; ++j)
            for (uint32_t i = 0; i < kCells; ++i) fill_cell(i, j);
        finish();
    }

    // How much of the tile's light comes by cells that are no smooth part of a sheet, in cells.
    float irregularity() const { return irregularity_; }

private:
    struct Mark {
        bool forward = false, backward = false;  // orientations of the beams around
        uint32_t beams = 0, expected = 0;
    };

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
            marks_[k].expected += c % 2 == 0 ? 2 : 1;
        }
        add_beam(ends[0], ends[1], ends[2]);
        add_beam(ends[0], ends[2], ends[3]);
        irregularity_ += throughput * (whole ? std::min(1.0f, bend(ends)) : 1.0f);
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
            (forward ? marks_[k].forward : marks_[k].backward) = true;
            ++marks_[k].beams;
        }
        out_.beams.push_back({{a, b, c}, 0, 0.0f, depth, 0.0f});
    }

    // Light in the beam by area across it.
    float density_of(const Beam& beam) const {
        const Landing &a = landings_[beam.edges[0]], &b = landings_[beam.edges[1]],
                      &c = landings_[beam.edges[2]];
        const Vec3 e1 = b.edge.landed - a.edge.landed, e2 = c.edge.landed - a.edge.landed;
        const float area = 0.5f * std::abs(dot(cross(e1, e2), a.edge.d));
        return std::max({a.light, b.light, c.light}) * beam_size_ / std::max(area, 1e-20f);
    }

    // Where a sheet folds over or ends, chains lie beyond its triangles.
    void finish() {
        std::map<ChainKind, uint32_t> index;
        for (const Landing& landing : landings_) {
            out_.edges.push_back(landing.edge);
            const auto [at, added] =
                index.try_emplace(landing.kind, static_cast<uint32_t>(index.size()));
            if (added) out_.kinds.push_back(landing.kind.reversed());
        }
        for (Beam& beam : out_.beams) {
            beam.kind = index[landings_[beam.edges[0]].kind];
            beam.margin = 0.0f;
            beam.density = density_of(beam);
            const auto any = [&](const auto& test) {
                return std::any_of(beam.edges.begin(), beam.edges.end(),
                                   [&](uint32_t k) { return test(marks_[k]); });
            };
            if (any([](const Mark& mark) { return mark.forward && mark.backward; }))
                beam.margin = kFoldMargin;
            if (any([](const Mark& mark) { return mark.beams < mark.expected; }))
                beam.margin = kEndMargin;
        }
    }

    static constexpr float kFlat = 0.999f, kFlatDepth = 0.05f;
    static constexpr float kFoldMargin = 0.75f, kEndMargin = 1.0f;

    BeamSet& out_;
    float beam_size_;
    std::vector<Landing> landings_;
    std::vector<Mark> marks_;
    std::array<uint32_t, kCorners * kCorners + 1> begin_{};
    float irregularity_ = 0.0f;
};

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

struct TracedTile {
    Square square;
    float irregular;  // by area of the unit square
    BeamSet beams;
};

// Splits the least regular tiles, an eighth of them at a time.
std::vector<TracedTile> trace_tiles(const SheetWorld& world, const LightPoint& y,
                                    std::span<const LightPoint> around, size_t budget) {
    std::vector<TracedTile> tiles;
    const auto is_cancelled = [&] {
        return world.cancelled != nullptr && world.cancelled->load(std::memory_order_relaxed);
    };
    const auto add = [&](const std::vector<Square>& squares) {
        std::vector<TracedTile> traced(squares.size());
        parallel_for(world.threads, static_cast<uint32_t>(squares.size()), [&](uint32_t i) {
            if (is_cancelled()) return;
            const Square& square = squares[i];
            Tile tile(world, y, around, square, traced[i].beams);
            traced[i].square = square;
            traced[i].irregular =
                square.level == kFinestLevel ? 0.0f : tile.irregularity() * square.area();
        });
        for (TracedTile& tile : traced)
            if (!tile.beams.edges.empty()) tiles.push_back(std::move(tile));
    };
    const std::vector<Vec2> places = places_of_casters(world, y);
    add(first_squares(places, budget / 4));
    while (!tiles.empty() && tiles.size() < budget && !is_cancelled()) {
        const auto by_need = [](const TracedTile& a, const TracedTile& b) {
            return a.irregular < b.irregular;
        };
        std::stable_sort(tiles.begin(), tiles.end(), by_need);
        size_t splits = std::min(tiles.size() / 8 + 1, (budget - tiles.size()) / 3 + 1);
        std::vector<Square> finer;
        for (; splits > 0 && !tiles.empty() && tiles.back().irregular > 0.0f; --splits) {
            const Square& coarse = tiles.back().square;
            for (uint32_t q = 0; q < 4; ++q)
                finer.push_back({2 * coarse.x + (q & 1), 2 * coarse.y + (q >> 1), coarse.level + 1});
            tiles.pop_back();
        }
        if (finer.empty()) break;
        add(finer);
    }
    return tiles;
}

}  // namespace

LightSheet::LightSheet(const SheetWorld& world, const LightPoint& y, uint32_t tiles, float reach,
                       std::span<const LightPoint> around)
    : y_(y) {
    std::map<ChainKind, uint32_t> kinds;
    for (const TracedTile& tile : trace_tiles(world, y, around, tiles)) append(tile.beams, kinds);
    if (!y.delta) build_folds(reach);
    build_layers(reach, world.threads);
}

float LightSheet::Entry::density() const {
    // Where few leads arrive, mostly at chains that others lead to as well.
    constexpr float kBeside = 1.0f / 16;
    return beam.density * (inside ? 1.0f : kBeside);
}

void LightSheet::build_layers(float reach, uint32_t threads) {
    constexpr size_t kMostLayers = 24;
    std::vector<Entry> entries;
    for (const Beam& beam : std::exchange(all_.beams, {})) {
        entries.push_back({beam, true});
        if (beam.margin > 0.0f) entries.push_back({beam, false});
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.density() > b.density(); });
    const auto least = static_cast<long>(entries.size() / kMostLayers + 1);
    for (auto begin = entries.begin(), end = begin; begin != entries.end(); begin = end) {
        const float largest = begin->density();
        while (end != entries.end() && (end < begin + least || end->density() > 0.5f * largest))
            ++end;
        layers_.push_back({largest, {begin, end}, {}});
    }
    parallel_for(threads, static_cast<uint32_t>(layers_.size()), [&](uint32_t k) {
        Layer& layer = layers_[k];
        const std::vector<Entry> unordered = std::move(layer.entries);
        const auto shape = [&](uint32_t i) {
            const auto& [beam, inside] = unordered[i];
            return prism_of(edges_of(all_, beam), beam, inside ? 0.0f : beam.margin);
        };
        std::vector<uint32_t> order;
        layer.tree = PrismTree(static_cast<uint32_t>(unordered.size()), shape, reach, order);
        for (const uint32_t i : order) layer.entries.push_back(unordered[i]);
    });
}

void LightSheet::build_folds(float reach) {
    std::vector<const Beam*> beams;
    for (const Beam& beam : all_.beams)
        if (beam.margin > 0.0f) beams.push_back(&beam);
    const auto shape = [&](uint32_t i) {
        return prism_of(edges_of(all_, *beams[i]), *beams[i], 0.0f);
    };
    std::vector<uint32_t> order;
    fold_tree_ = PrismTree(static_cast<uint32_t>(beams.size()), shape, reach, order,
                           PrismTree::Volumes::stay);
    for (const uint32_t i : order) {
        const auto [a, b, c] = edges_of(all_, *beams[i]);
        const FoldPatch patch{a->last, b->last - a->last, c->last - a->last};
        folds_.push_back({patch, sides_around(shape(i), reach)});
    }
}

bool LightSheet::find_folds(const Vec3& x, size_t most,
                            std::vector<const FoldPatch*>& patches) const {
    bool few = true;
    fold_tree_.visit(x, Vec3(0.0f), [&](uint32_t i) {
        const auto& [patch, sides] = folds_[i];
        if (!std::all_of(sides.begin(), sides.end(), [&](const HalfSpace& s) { return s.holds(x); }))
            return true;
        few = patches.size() < most;
        if (few) patches.push_back(&patch);
        return few;
    });
    return few;
}

void LightSheet::append(const BeamSet& part, std::map<ChainKind, uint32_t>& kinds) {
    const auto offset = static_cast<uint32_t>(all_.edges.size());
    all_.edges.insert(all_.edges.end(), part.edges.begin(), part.edges.end());
    std::vector<uint32_t> index(part.kinds.size());
    for (size_t k = 0; k < part.kinds.size(); ++k) {
        const auto [at, added] =
            kinds.try_emplace(part.kinds[k], static_cast<uint32_t>(kinds.size()));
        if (added) all_.kinds.push_back(part.kinds[k]);
        index[k] = at->second;
    }
    for (Beam beam : part.beams) {
        for (uint32_t& edge : beam.edges) edge += offset;
        beam.kind = index[beam.kind];
        all_.beams.push_back(beam);
    }
    all_.rays += part.rays;
}

Vec3 shift_between(const LightPoint& from, const LightPoint& to) {
    return from.distant ? to.direction - from.direction : to.p - from.p;
}

bool repeats(const Lead& lead, const Lead& other) {
    if (lead.inside || !other.inside || other.chance < lead.chance || lead.kind != other.kind ||
        lead.positive != other.positive)
        return false;
    const auto shared = [&](uint32_t edge) {
        return std::find(other.edges.begin(), other.edges.end(), edge) != other.edges.end();
    };
    return std::any_of(lead.edges.begin(), lead.edges.end(), shared);
}

void LightSheet::find_leads(const Vec3& x, const Vec3& shift, float worth, float u,
                            std::vector<Lead>& leads) const {
    for (const Layer& layer : layers_)
        if (std::max(layer.density * worth, kLeastChance) > u)
            layer.tree.visit(x, shift, [&](uint32_t i) {
                add_lead(layer.entries[i], x, shift, worth, u, leads);
                return true;
            });
    std::partition(leads.begin(), leads.end(), [](const Lead& lead) { return lead.inside; });
}

void LightSheet::add_lead(const Entry& entry, const Vec3& x, const Vec3& shift, float worth,
                          float u, std::vector<Lead>& leads) const {
    const Beam& beam = entry.beam;
    const float chance = std::clamp(entry.density() * worth, kLeastChance, 1.0f);
    if (!(chance > u)) return;
    const std::array<const BeamEdge*, 3> edges = edges_of(all_, beam);
    const auto by_shift = [&](const std::array<Vec3, 3>& moved) {
        return moved[0] * shift.x + moved[1] * shift.y + moved[2] * shift.z;
    };
    std::array<Vec3, 3> landed;
    for (size_t i = 0; i < 3; ++i) landed[i] = edges[i]->landed + by_shift(edges[i]->landed_moved);
    const std::optional<Vec3> at = locate(edges, landed, x);
    if (!at || !(std::abs(at->z) <= beam.depth)) return;
    const float b0 = 1.0f - at->x - at->y, least = std::min({b0, at->x, at->y});
    if (entry.inside ? least < 0.0f : least >= 0.0f || least < -beam.margin) return;
    const auto last_of = [&](size_t i) { return edges[i]->last + by_shift(edges[i]->last_moved); };
    const Vec3 last = last_of(0) * b0 + last_of(1) * at->x + last_of(2) * at->y;
    const Vec3 to = last - x;
    const float distance = length(to);
    if (!(distance > 0.0f)) return;
    const bool forward =
        dot(cross(landed[1] - landed[0], landed[2] - landed[0]), edges[0]->d) > 0.0f;
    // Across the direction of a distant light places turn the other way.
    leads.push_back({&all_.kinds[beam.kind], to * (1.0f / distance), chance, entry.inside,
                     forward != y_.distant, beam.edges});
}

}  // namespace spc
