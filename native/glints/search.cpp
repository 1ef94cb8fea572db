// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/microfacet.h"
#include "core/random.h"
#include "glints/estimators.h"

namespace spc {

namespace {

// A footprint of more cells is not searched through for the narrowest lobes, of which each cell
// would matter: about so many nodes are, and the estimate has noise instead.
constexpr float kMostCells = 8192.0f;
// Halvings of a cell: with them any lobe that is not a delta is smooth within a piece.
constexpr int kMostHalvings = 20;

// Looks for the parts of a footprint whose normals may send the light on. A part is a node of the
// slope field, or a piece of a cell below; C is its area times a bound of what the estimate sums up
// there. While C exceeds `threshold` a part is split; then it is kept with the probability
// C / threshold and evaluated at one random point, so that no contribution exceeds the threshold,
// and the variance is at most threshold times mean.
class GlintSearch {
public:
    GlintSearch(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                const GlintPrecision& precision, uint64_t seed, GlintStats& stats)
        : s_(site),
          field_(*site.field),
          pyramid_(field_.pyramid()),
          target_(target),
          wi_(wi),
          seed_(seed),
          stats_(stats) {
        const float cos_o_h = std::max(dot(s_.wo, target.half), 0.0f);
        float mean_sum = 0.0f, most_sum = 0.0f;
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const auto k = static_cast<size_t>(i);
            const GlintLobe& glint = s_.lobe(i);
            scales_[k] = s_.scale(i, cos_o_h);
            mean_sum += scales_[k] * s_.mean_density(glint, target);
            most_sum += scales_[k] * normal_density(glint.lobe.model, glint.lobe.alpha, 1.0f, 0.0f);
        }
        const float radius = s_.pixel.filter->radius();
        const float cells = s_.texels_per_pixel() * sqr(2.0f * radius);
        const float most_mass = most_sum * sqr(s_.pixel.filter->weight(0.0f)) * cells;
        threshold_ =
            std::max(s_.texels_per_pixel() * std::max(mean_sum / precision.points, precision.faint),
                     most_mass / kMostCells * clamp01(cells / kMostCells - 1.0f));
    }

    Spectrum run() {
        if (!(threshold_ > 0.0f)) return Spectrum(0.0f);
        const auto repeat = [](float at, int size) {
            return static_cast<int>(std::floor(at / static_cast<float>(size)));
        };
        const int w = field_.width(), h = field_.height();
        search_repeats(repeat(s_.lower.x, w), repeat(s_.upper.x, w), repeat(s_.lower.y, h),
                       repeat(s_.upper.y, h));
        return sum_ * (1.0f / s_.texels_per_pixel());
    }

private:
    // A rectangle of texels; `corner` is the lower one of what it was clipped from.
    struct Part {
        Vec2 corner, lower, upper;
        float area() const { return (upper.x - lower.x) * (upper.y - lower.y); }
    };

    // Four parts side by side, and bounds of their slopes. Lanes that were not set are empty.
    struct Quad {
        std::array<Part, 4> part{};
        Lanes x0{}, x1{}, y0{}, y1{};  // of the parts
        LaneBounds slopes;             // as the frame takes them
    };

    // What is in the footprint's box of [x0, x1) x [y0, y1).
    Part clipped(const Vec2& lower, const Vec2& upper) const {
        return {lower,
                {std::max(lower.x, s_.lower.x), std::max(lower.y, s_.lower.y)},
                {std::min(upper.x, s_.upper.x), std::min(upper.y, s_.upper.y)}};
    }

    static bool is_empty(const Part& part) {
        return !(part.lower.x < part.upper.x) || !(part.lower.y < part.upper.y);
    }

    void set(Quad& quad, size_t k, const Part& part, const SlopeBounds& slopes) {
        ++stats_.nodes;
        const SlopeBounds taken = s_.frame.taken(slopes);
        quad.part[k] = part;
        quad.x0[k] = part.lower.x;
        quad.x1[k] = part.upper.x;
        quad.y0[k] = part.lower.y;
        quad.y1[k] = part.upper.y;
        quad.slopes.a0[k] = taken.lower.x;
        quad.slopes.a1[k] = taken.upper.x;
        quad.slopes.b0[k] = taken.lower.y;
        quad.slopes.b1[k] = taken.upper.y;
    }

    // C of each; 0 where a part has nothing to add.
    Lanes importance(const Quad& q) const {
        const Lanes half_x = (q.x1 - q.x0) * 0.5f, half_y = (q.y1 - q.y0) * 0.5f,
                    x = (q.x0 + q.x1) * 0.5f - s_.middle.x, y = (q.y0 + q.y1) * 0.5f - s_.middle.y;
        Lanes c = half_x * half_y * 4.0f;
        for (const Vec2& row : s_.to_film) {
            const Lanes middle = x * row.x + y * row.y,
                        spread = half_x * std::abs(row.x) + half_y * std::abs(row.y),
                        nearest = max(max(middle, -middle) - spread, Lanes{});
            for (size_t k = 0; k < 4; ++k) c[k] *= s_.pixel.filter->weight(nearest[k]);
        }
        const Lanes cos = target_.linear.z +
                          max(q.slopes.a0 * target_.linear.x, q.slopes.a1 * target_.linear.x) +
                          max(q.slopes.b0 * target_.linear.y, q.slopes.b1 * target_.linear.y),
                    cos2 = cos * cos, sin2 = target_.least_sine2(q.slopes);
        Lanes density{};
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const MicrofacetReflection& lobe = s_.lobe(i).lobe;
            for (size_t k = 0; k < 4; ++k)
                density[k] += scales_[static_cast<size_t>(i)] *
                              normal_density(lobe.model, lobe.alpha, cos2[k], sin2[k]);
        }
        return cos > 0.0f ? c * density : Lanes{};
    }

    // Keeps what is small, and splits the rest: split(k).
    template <class Split>
    void search(const Quad& quad, const Split& split) {
        const Lanes c = importance(quad);
        for (size_t k = 0; k < 4; ++k) {
            if (!(c[k] > 0.0f)) continue;
            if (c[k] <= threshold_)
                keep(quad.part[k], c[k]);
            else
                split(k);
        }
    }

    // Whole repeats, a range of them.
    void search_repeats(int x0, int x1, int y0, int y1) {
        const int w = field_.width(), h = field_.height(), top = pyramid_.levels() - 1;
        const Vec2 size(static_cast<float>(w), static_cast<float>(h));
        const Vec2 repeat(static_cast<float>(x0) * size.x, static_cast<float>(y0) * size.y);
        const Part part = clipped(
            repeat, Vec2(static_cast<float>(x1 + 1) * size.x, static_cast<float>(y1 + 1) * size.y));
        if (is_empty(part)) return;
        Quad quad;
        set(quad, 0, part, pyramid_.bounds(top, 0, 0));
        search(quad, [&](size_t) {
            if (x0 == x1 && y0 == y1) return split_node(top, 0, 0, repeat);
            if (x1 - x0 >= y1 - y0) {
                const int middle = x0 + (x1 - x0) / 2;
                search_repeats(x0, middle, y0, y1);
                search_repeats(middle + 1, x1, y0, y1);
            } else {
                const int middle = y0 + (y1 - y0) / 2;
                search_repeats(x0, x1, y0, middle);
                search_repeats(x0, x1, middle + 1, y1);
            }
        });
    }

    void split_node(int level, int x, int y, const Vec2& repeat) {
        if (level == 1) {
            const auto act = [&](const auto& texels) { split_into_cells(texels, x, y, repeat); };
            return field_.visit_texels(act);
        }
        const int w = field_.width(), h = field_.height(), size = 1 << (level - 1);
        Quad quad;
        size_t count = 0, last = 0;
        for (size_t k = 0; k < 4; ++k) {
            const auto [cx, cy] = child(x, y, k);
            const Vec2 lower(static_cast<float>(cx * size), static_cast<float>(cy * size)),
                upper(static_cast<float>(std::min((cx + 1) * size, w)),
                      static_cast<float>(std::min((cy + 1) * size, h)));
            const Part part = clipped(repeat + lower, repeat + upper);
            if (is_empty(part)) continue;
            set(quad, k, part, pyramid_.bounds(level - 1, cx, cy));
            ++count;
            last = k;
        }
        if (count == 1) {  // no smaller than what was split
            const auto [cx, cy] = child(x, y, last);
            return split_node(level - 1, cx, cy, repeat);
        }
        search(quad, [&](size_t k) {
            const auto [cx, cy] = child(x, y, k);
            split_node(level - 1, cx, cy, repeat);
        });
    }

    static std::pair<int, int> child(int x, int y, size_t k) {
        return {2 * x + static_cast<int>(k & 1), 2 * y + static_cast<int>(k >> 1)};
    }

    template <class Texels>
    void split_into_cells(const Texels& texels, int x, int y, const Vec2& repeat) {
        std::array<decltype(texels.cell(0, 0)), 4> cells;
        Quad quad;
        for (size_t k = 0; k < 4; ++k) {
            const auto [cx, cy] = child(x, y, k);
            if (cx >= field_.width() || cy >= field_.height()) continue;
            const Vec2 lower = repeat + Vec2(static_cast<float>(cx), static_cast<float>(cy));
            const Part part = clipped(lower, lower + Vec2(1.0f, 1.0f));
            if (is_empty(part)) continue;
            cells[k] = texels.cell(cx, cy);
            set(quad, k, part, cells[k].bounds());
        }
        search(quad,
               [&](size_t k) { split_patch(cells[k], quad.part[k].corner, 1.0f, kMostHalvings); });
    }

    // A piece of a cell: the square of `size` at `lower`.
    template <class Patch>
    void split_patch(const Patch& patch, const Vec2& lower, float size, int halvings) {
        const float half = 0.5f * size;
        std::array<Patch, 4> quarters;
        Quad quad;
        for (size_t k = 0; k < 4; ++k) {
            const Vec2 corner =
                lower + Vec2(half * static_cast<float>(k & 1), half * static_cast<float>(k >> 1));
            const Part part = clipped(corner, corner + Vec2(half, half));
            if (is_empty(part)) continue;
            quarters[k] = patch.quarter(static_cast<int>(k));
            set(quad, k, part, quarters[k].bounds());
        }
        search(quad, [&](size_t k) {
            const Part& part = quad.part[k];
            if (halvings == 1) return evaluate(part, random(part), 1.0f);
            split_patch(quarters[k], part.corner, half, halvings - 1);
        });
    }

    // A part's own numbers, whatever else the search meets: in an animation its noise changes no
    // faster than what is searched.
    Pcg random(const Part& part) const {
        const auto bits = [](float x) { return static_cast<uint64_t>(std::bit_cast<uint32_t>(x)); };
        return Pcg(seed_ ^ mix_bits(bits(part.corner.x) << 32 | bits(part.corner.y)));
    }

    void keep(const Part& part, float c) {
        Pcg pcg = random(part);
        const float probability = c / threshold_;
        if (pcg.one() < probability) evaluate(part, pcg, probability);
    }

    void evaluate(const Part& part, Pcg pcg, float probability) {
        ++stats_.points;
        const Vec2 u = pcg.two();
        const Vec2 at = part.lower + (part.upper - part.lower) * u;
        const float weight = s_.filter_at(at) * part.area() / probability;
        if (weight == 0.0f) return;
        const auto place = [](float s, int n, int& cell) {
            const auto size = static_cast<float>(n);
            s -= std::floor(s / size) * size;
            cell = std::min(static_cast<int>(s), n - 1);
            return s - static_cast<float>(cell);
        };
        int x = 0, y = 0;
        const float s = place(at.x, field_.width(), x), t = place(at.y, field_.height(), y);
        const SlopeFrame& frame = s_.frame;
        const Vec3 n = normalize(frame.normal(frame.taken(slope_at(field_.cell(x, y), s, t))));
        for (int i = 0; i < s_.closures->glint_count; ++i)
            sum_ += eval_glint(s_.lobe(i), n, s_.wo, wi_) * weight;
    }

    const GlintSite& s_;
    const SlopeField& field_;
    const SlopePyramid& pyramid_;
    const GlintTarget& target_;
    const Vec3& wi_;
    const uint64_t seed_;
    GlintStats& stats_;
    std::array<float, kMaxGlints> scales_{};
    float threshold_ = 0.0f;
    Spectrum sum_{0.0f};
};

}  // namespace

Spectrum search_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                          const GlintPrecision& precision, uint64_t seed, GlintStats& stats) {
    return GlintSearch(site, target, wi, precision, seed, stats).run();
}

}  // namespace spc
