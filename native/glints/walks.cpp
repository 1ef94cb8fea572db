// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/microfacet.h"
#include "core/random.h"
#include "glints/estimators.h"

namespace spc {

namespace {

// Bernoulli trials, as of manifold walks.
constexpr int kMostTrials = 1 << 16;
constexpr int kMostSteps = 20;
constexpr float kLongestStep = 2.0f;  // texels
// A step of less, texels, ends a walk: Newton's method squares what is left.
constexpr float kLastStep = 1e-3f;
// Solutions that are nearer to each other are one, texels.
constexpr float kSame = 2e-3f;
// Where the normals of a texel would cover less than this share of what the narrowest lobe does,
// the map counts as flat.
constexpr float kFlat = 0.01f;

// Solves s(t) = s for the place t on the map, where s is the slope of a normal drawn from the lobes
// around the half-vector [Zeltner20 Sec. 4.5]. With the density q of s and all places t_i that
// solve it, for the filter's density h by texels,
//
//     average = E[ f_r(n(s)) cos / q(s) sum_i h(t_i) / |det ds/dt(t_i)| ].
//
// Where the map is flat there is nothing to solve for; there f_r is evaluated at a place drawn from
// h itself, so that no light is lost.
class GlintWalks {
public:
    GlintWalks(const GlintSite& site, const GlintTarget& target, const Vec3& wi, uint64_t seed,
               GlintStats& stats)
        : s_(site), target_(target), wi_(wi), pcg_(seed), stats_(stats) {
        const float cos_o_h = std::max(dot(s_.wo, target.half), 0.0f);
        float narrowest = kInfinity;
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            probability_[static_cast<size_t>(i)] = s_.scale(i, cos_o_h);
            total_ += probability_[static_cast<size_t>(i)];
            narrowest = std::min(narrowest, s_.lobe(i).lobe.alpha);
        }
        least_det_ = kFlat * kPi * sqr(narrowest) / s_.frame.angle_per_slope();
        base_x_ = static_cast<int>(std::floor(s_.middle.x));
        base_y_ = static_cast<int>(std::floor(s_.middle.y));
        middle_ = s_.middle - Vec2(static_cast<float>(base_x_), static_cast<float>(base_y_));
    }

    // [Zeltner20 Alg. 2].
    Spectrum unbiased() {
        if (!(total_ > 0.0f)) return Spectrum(0.0f);
        const Vec2 start = draw_start();
        Spectrum sum = where_flat(start);
        if (!draw_slope()) return sum;
        const std::optional<Root> root = walk(start);
        if (!root) return sum;
        int trials = 1;
        while (trials < kMostTrials) {
            const std::optional<Root> again = walk(draw_start());
            if (again && same(*again, *root)) break;
            ++trials;
        }
        if (trials == kMostTrials) ++stats_.capped;
        return sum + value_ * (root->density * static_cast<float>(trials));
    }

    // [Zeltner20 Alg. 3].
    Spectrum biased(uint32_t walks) {
        if (!(total_ > 0.0f)) return Spectrum(0.0f);
        Vec2 start = draw_start();
        Spectrum sum = where_flat(start);
        if (!draw_slope()) return sum;
        std::vector<Root> roots;
        for (uint32_t i = 0; i < walks; ++i) {
            const std::optional<Root> root = walk(start);
            start = draw_start();
            const auto known = [&](const Root& r) { return same(r, *root); };
            if (!root || std::any_of(roots.begin(), roots.end(), known)) continue;
            roots.push_back(*root);
            sum += value_ * root->density;
        }
        return sum;
    }

private:
    // Places are texels from a corner near the pixel's middle: on large maps single precision would
    // not tell solutions apart.
    struct Root {
        Vec2 at;
        float density;  // of slopes: h over the determinant
    };
    static bool same(const Root& a, const Root& b) { return (a.at - b.at).length() < kSame; }

    Vec2 draw_start() {
        const Vec2 film = s_.pixel.filter->sample(pcg_.two());
        return middle_ + s_.axes[0] * film.x + s_.axes[1] * film.y;
    }

    float filter_at(const Vec2& at) const { return s_.filter_at(at - middle_ + s_.middle); }

    SlopeJet jet_at(const Vec2& at) {
        ++stats_.nodes;
        const Vec2 cell(std::floor(at.x), std::floor(at.y));
        const SlopePatch patch =
            s_.field->cell(base_x_ + static_cast<int>(cell.x), base_y_ + static_cast<int>(cell.y));
        return s_.frame.taken(spc::jet_at(patch, at.x - cell.x, at.y - cell.y));
    }

    static float det(const SlopeJet& jet) {
        return jet.by_s.x * jet.by_t.y - jet.by_s.y * jet.by_t.x;
    }
    bool is_flat(const SlopeJet& jet) const { return !(std::abs(det(jet)) >= least_det_); }

    Spectrum f_cos(const Vec3& n) {
        ++stats_.points;
        Spectrum sum(0.0f);
        for (int i = 0; i < s_.closures->glint_count; ++i)
            sum += eval_glint(s_.lobe(i), n, s_.wo, wi_);
        return sum;
    }

    // f cos at a place drawn from h, if the map is flat there.
    Spectrum where_flat(const Vec2& at) {
        const SlopeJet jet = jet_at(at);
        return is_flat(jet) ? f_cos(normalize(s_.frame.normal(jet.slope))) : Spectrum(0.0f);
    }

    // Draws the slope to solve for, and what stands before the sum. False where that is zero.
    bool draw_slope() {
        const SlopeFrame& frame = s_.frame;
        const Frame around = Frame::around(target_.half);
        const Vec2 tangent = draw_tangent();
        const Vec3 normal = target_.half + around.x * tangent.x + around.y * tangent.y;
        const Vec3 along = frame.coordinates(normal);
        if (!(along.z > 0.0f)) return false;
        slope_ = slope_of(along);
        // From the plane of tangents to that of slopes; the normal's component along h is one.
        const float q = density_of(tangent) * std::abs(frame.det()) * along.z * along.z * along.z;
        value_ = f_cos(normalize(normal)) * (1.0f / q);
        return !is_black(value_) && is_finite(value_);
    }

    // Draws the angle between half-vector and normal, in the plane that touches the sphere at the
    // half-vector.
    Vec2 draw_tangent() {
        float u = pcg_.one() * total_;
        int i = 0;
        while (i + 1 < s_.closures->glint_count && u >= probability_[static_cast<size_t>(i)])
            u -= probability_[static_cast<size_t>(i++)];
        const MicrofacetReflection& lobe = s_.lobe(i).lobe;
        const Vec2 v = pcg_.two();
        const float r2 = lobe.model == MicrofacetModel::ggx ? v.x / (1.0f - v.x) : -std::log1p(-v.x);
        return unit_circle(v.y) * (lobe.alpha * std::sqrt(r2));
    }
    float density_of(const Vec2& tangent) const {
        float density = 0.0f;
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const MicrofacetReflection& lobe = s_.lobe(i).lobe;
            const float alpha2 = sqr(lobe.alpha), x = tangent.dot(tangent) / alpha2;
            const float shape =
                lobe.model == MicrofacetModel::ggx ? 1.0f / sqr(1.0f + x) : std::exp(-x);
            density += probability_[static_cast<size_t>(i)] * shape * kInvPi / alpha2;
        }
        return density / total_;
    }

    std::optional<Root> walk(Vec2 at) {
        for (int step = 0; step < kMostSteps; ++step) {
            const float h = filter_at(at);
            if (h == 0.0f) return std::nullopt;
            const SlopeJet jet = jet_at(at);
            if (is_flat(jet)) return std::nullopt;
            const Vec2 c = slope_ - jet.slope;
            const float inv = 1.0f / det(jet);
            const Vec2 d =
                Vec2(jet.by_t.y * c.x - jet.by_t.x * c.y, jet.by_s.x * c.y - jet.by_s.y * c.x) * inv;
            const float length = d.length();
            const Vec2 next = at + d * std::min(1.0f, kLongestStep / length);
            // Beyond a cell's edge its slopes are not the map's.
            if (length < kLastStep && std::floor(next.x) == std::floor(at.x) &&
                std::floor(next.y) == std::floor(at.y))
                return Root{next, h * std::abs(inv) / s_.texels_per_pixel()};
            at = next;
        }
        return std::nullopt;
    }

    const GlintSite& s_;
    const GlintTarget& target_;
    const Vec3& wi_;
    Pcg pcg_;
    GlintStats& stats_;
    std::array<float, kMaxGlints> probability_{};  // of lobes, times `total_`
    float total_ = 0.0f, least_det_;
    int base_x_, base_y_;
    Vec2 middle_;  // of the pixel
    Vec2 slope_{0, 0};
    Spectrum value_{0.0f};
};

}  // namespace

Spectrum walk_footprint(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                        uint64_t seed, GlintStats& stats) {
    return GlintWalks(site, target, wi, seed, stats).unbiased();
}

Spectrum walk_footprint_biased(const GlintSite& site, const GlintTarget& target, const Vec3& wi,
                               uint32_t walks, uint64_t seed, GlintStats& stats) {
    return GlintWalks(site, target, wi, seed, stats).biased(walks);
}

}  // namespace spc
