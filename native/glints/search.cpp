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
    GlintSearch(const GlintSite& site, const GlintTarget& target, const Vec3& wi, float points,
                uint64_t seed, GlintStats& stats)
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
        const float reach = s_.pixel.filter->reach();
        const float cells = s_.footprint.texels_per_pixel() * sqr(2.0f * reach);
        const float most_mass = most_sum * sqr(s_.pixel.filter->weight(0.0f)) * cells;
        threshold_ = std::max(s_.footprint.texels_per_pixel() * mean_sum / points,
                              most_mass / kMostCells * clamp01(cells / kMostCells - 1.0f));
    }

    Spectrum run() {
        if (!(threshold_ > 0.0f)) return Spectrum(0.0f);
        const auto tile = [](float at, int size) {
            return static_cast<int>(std::floor(at / static_cast<float>(size)));
        };
        const int w = field_.width(), h = field_.height();
        search_tiles(tile(s_.lower.x, w), tile(s_.upper.x, w), tile(s_.lower.y, h),
                     tile(s_.upper.y, h));
        return sum_ * (1.0f / s_.footprint.texels_per_pixel());
    }

private:
    // A rectangle of texels; `corner` is the lower one of what it was clipped from.
    struct Part {
        Vec2 corner, lower, upper;
        float area() const { return (upper.x - lower.x) * (upper.y - lower.y); }
    };

    // What is in the footprint's box of [x0, x1) x [y0, y1).
    Part clipped(const Vec2& lower, const Vec2& upper) const {
        return {lower,
                {std::max(lower.x, s_.lower.x), std::max(lower.y, s_.lower.y)},
                {std::min(upper.x, s_.upper.x), std::min(upper.y, s_.upper.y)}};
    }

    // C; 0 where the part has nothing to add.
    float importance(const Part& part, const SlopeBounds& slopes) {
        ++stats_.nodes;
        if (!(part.lower.x < part.upper.x) || !(part.lower.y < part.upper.y)) return 0.0f;
        const Vec2 middle = s_.film_at((part.lower + part.upper) * 0.5f);
        const Vec2 half = (part.upper - part.lower) * 0.5f;
        float weight = part.area();
        for (size_t i = 0; i < 2; ++i) {
            const float spread =
                std::abs(s_.to_film[i].x) * half.x + std::abs(s_.to_film[i].y) * half.y;
            const float nearest = std::abs(middle[static_cast<int>(i)]) - spread;
            weight *= s_.pixel.filter->weight(std::max(nearest, 0.0f));
        }
        if (weight == 0.0f) return 0.0f;
        const SlopeBounds taken = s_.footprint.frame.taken(slopes);
        const float cos = target_.most_dot(taken);
        if (!(cos > 0.0f)) return 0.0f;
        const float cos2 = cos * cos, sin2 = target_.least_sine2(taken);
        float density = 0.0f;
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const MicrofacetReflection& lobe = s_.lobe(i).lobe;
            density += scales_[static_cast<size_t>(i)] *
                       normal_density(lobe.model, lobe.alpha, cos2, sin2);
        }
        return weight * density;
    }

    // Whole tiles, a range of them.
    void search_tiles(int x0, int x1, int y0, int y1) {
        const int w = field_.width(), h = field_.height();
        const Vec2 size(static_cast<float>(w), static_cast<float>(h));
        const Vec2 tile(static_cast<float>(x0) * size.x, static_cast<float>(y0) * size.y);
        if (x0 == x1 && y0 == y1) return search_node(pyramid_.levels() - 1, 0, 0, tile);
        const Part part = clipped(
            tile, Vec2(static_cast<float>(x1 + 1) * size.x, static_cast<float>(y1 + 1) * size.y));
        const float c = importance(part, pyramid_.bounds(pyramid_.levels() - 1, 0, 0));
        if (c == 0.0f) return;
        if (c <= threshold_) return keep(part, c);
        if (x1 - x0 >= y1 - y0) {
            const int middle = x0 + (x1 - x0) / 2;
            search_tiles(x0, middle, y0, y1);
            search_tiles(middle + 1, x1, y0, y1);
        } else {
            const int middle = y0 + (y1 - y0) / 2;
            search_tiles(x0, x1, y0, middle);
            search_tiles(x0, x1, middle + 1, y1);
        }
    }

    void search_node(int level, int x, int y, const Vec2& tile) {
        const int w = field_.width(), h = field_.height(), size = 1 << level;
        const Vec2 lower(static_cast<float>(x * size), static_cast<float>(y * size)),
            upper(static_cast<float>(std::min((x + 1) * size, w)),
                  static_cast<float>(std::min((y + 1) * size, h)));
        const Part part = clipped(tile + lower, tile + upper);
        if (!(part.lower.x < part.upper.x) || !(part.lower.y < part.upper.y)) return;
        if (level == 0) return search_cell(x, y, tile + lower);
        const float c = importance(part, pyramid_.bounds(level, x, y));
        if (c == 0.0f) return;
        if (c <= threshold_) return keep(part, c);
        const int half = size / 2;
        for (int k = 0; k < 4; ++k) {
            const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
            if (cx * half < w && cy * half < h) search_node(level - 1, cx, cy, tile);
        }
    }

    void search_cell(int x, int y, const Vec2& lower) {
        std::visit([&](const auto& cell) { search_patch(cell, lower, 1.0f, kMostHalvings); },
                   field_.cell(x, y));
    }

    // A piece of a cell: the square of `size` at `lower`.
    template <class Patch>
    void search_patch(const Patch& patch, const Vec2& lower, float size, int halvings) {
        const Part part = clipped(lower, lower + Vec2(size, size));
        const float c = importance(part, patch.bounds());
        if (c == 0.0f) return;
        if (c <= threshold_) return keep(part, c);
        if (halvings == 0) return evaluate(part, random(part), 1.0f);
        const float half = 0.5f * size;
        for (int k = 0; k < 4; ++k)
            search_patch(
                patch.quarter(k),
                lower + Vec2(half * static_cast<float>(k & 1), half * static_cast<float>(k >> 1)),
                half, halvings - 1);
    }

    // A part's own numbers, whatever else the search meets: in an animation its noise changes no
    // faster than what is searched.
    Pcg random(const Part& part) const {
        const auto bits = [](float x) { return static_cast<uint64_t>(std::bit_cast<uint32_t>(x)); };
        return Pcg(seed_ ^ mix_bits(bits(part.corner.x) << 32 | bits(part.corner.y)));
    }

    void keep(const Part& part, float c) {
        Pcg pcg = random(part);
        const float chance = c / threshold_;
        if (pcg.one() < chance) evaluate(part, pcg, chance);
    }

    void evaluate(const Part& part, Pcg pcg, float chance) {
        ++stats_.points;
        const Vec2 u = pcg.two();
        const Vec2 at = part.lower + (part.upper - part.lower) * u;
        const float weight = s_.filter_at(at) * part.area() / chance;
        if (weight == 0.0f) return;
        const auto place = [](float s, int n, int& cell) {
            const auto size = static_cast<float>(n);
            s -= std::floor(s / size) * size;
            cell = std::min(static_cast<int>(s), n - 1);
            return s - static_cast<float>(cell);
        };
        int x = 0, y = 0;
        const float s = place(at.x, field_.width(), x), t = place(at.y, field_.height(), y);
        const SlopeFrame& frame = s_.footprint.frame;
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
                          float points, uint64_t seed, GlintStats& stats) {
    return GlintSearch(site, target, wi, points, seed, stats).run();
}

}  // namespace spc
