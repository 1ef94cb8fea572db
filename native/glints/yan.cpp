// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/microfacet.h"
#include "glints/estimators.h"

#include <span>

namespace spc {

namespace {

constexpr float kMostExponent = 0.5f * kGaussianRadius * kGaussianRadius;
// A footprint of more flakes is one Gaussian of slopes, by its moments: it glitters no more, and to
// look at all of its flakes would take forever.
constexpr float kMostFlakes = 65536.0f;

// A lobe's density of normals is about a sum of Gaussians of the angle's tangent,
//
//     D = 1 / (pi alpha^2) sum_k mass w exp(-w tan^2 / alpha^2).
//
// [Yan16] has a single one. That is Beckmann's distribution; GGX has tails, for which these three
// were fitted: within 12 % up to tan = 5 alpha, where one would be wrong by any factor.
struct LobeGaussian {
    float mass, w;
};
constexpr std::array<LobeGaussian, 1> kBeckmann{{{1.0f, 1.0f}}};
constexpr std::array<LobeGaussian, 3> kGgx{
    {{0.33077f, 2.14496f}, {0.47523f, 0.54512f}, {0.19400f, 0.10427f}}};

std::span<const LobeGaussian> gaussians_of(MicrofacetModel model) {
    if (model == MicrofacetModel::beckmann) return kBeckmann;
    return kGgx;
}

// The mean over the footprint of each lobe's density of normals at the half-vector. Flakes are
// looked for where both the pixel's Gaussian and the widest lobe's reach them.
class FlakeQuery {
public:
    FlakeQuery(const FlakeField& flakes, const GlintSite& site, const GlintTarget& target,
               GlintStats& stats)
        : s_(site),
          flakes_(flakes),
          target_(target),
          metric_(target),
          film_variance_(site.pixel.filter->variance()),
          stats_(stats) {
        const auto& [dx, dy] = s_.axes;
        const auto& [to_x, to_y] = s_.to_film;
        constexpr float kFlakeVariance = kFlakeSigma * kFlakeSigma;
        for (int i = 0; i < 2; ++i) {
            const Vec2& row = s_.to_film[static_cast<size_t>(i)];
            film_radius_[i] =
                kGaussianRadius * std::sqrt(film_variance_ + kFlakeVariance * row.dot(row));
            texel_radius_[i] =
                kGaussianRadius *
                std::sqrt(film_variance_ * (sqr(dx[i]) + sqr(dy[i])) + kFlakeVariance);
        }
        const float inv = 1.0f / film_variance_;
        paa_ = (to_x.x * to_x.x + to_y.x * to_y.x) * inv;
        pab_ = (to_x.x * to_x.y + to_y.x * to_y.y) * inv;
        pbb_ = (to_x.y * to_x.y + to_y.y * to_y.y) * inv;
        add_terms();
    }

    // Density of a lobe's normals, and the mean slope of the facets that contribute to it.
    struct Density {
        float density = 0.0f;
        Vec2 slope{0, 0};  // times the density
    };
    using Densities = std::array<Density, kMaxGlints>;

    const Densities& run() {
        if (4.0f * texel_radius_.x * texel_radius_.y > kMostFlakes)
            use_moments();
        else
            query_repeats();
        return densities_;
    }

private:
    // A Gaussian of a lobe.
    struct Term {
        int lobe;
        float precision;  // of d^T Q d
        float peak;       // of D, times what all flakes have in common
    };

    void add_terms() {
        const float common =
            1.0f / (s_.texels_per_pixel() * film_variance_ * 2.0f * kPi * sqr(kFlakeSigma));
        widest_ = kInfinity;
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const MicrofacetReflection& lobe = s_.lobe(i).lobe;
            const float inv = 1.0f / sqr(lobe.alpha);
            for (const auto& [mass, w] : gaussians_of(lobe.model)) {
                const float precision = 2.0f * w * inv;
                terms_[static_cast<size_t>(term_count_++)] = {i, precision,
                                                              mass * w * inv * kInvPi * common};
                widest_ = std::min(widest_, precision);
            }
        }
    }

    void use_moments() {
        for (int i = 0; i < s_.closures->glint_count; ++i) {
            const MicrofacetReflection& lobe = s_.lobe(i).lobe;
            Density& d = densities_[static_cast<size_t>(i)];
            for (const auto& [mass, w] : gaussians_of(lobe.model))
                d.density += mass * s_.normal_slopes_density(lobe.alpha / std::sqrt(w), target_);
            d.slope = target_.slope * d.density;
        }
    }

    void query_repeats() {
        const Vec2 lower = s_.middle - texel_radius_, upper = s_.middle + texel_radius_;
        const int w = flakes_.width(), h = flakes_.height();
        const auto repeat = [](float at, int size) {
            return static_cast<int>(std::floor(at / static_cast<float>(size)));
        };
        // A flake is in the middle of its cell: the last one of a repeat is not beyond its end.
        for (int y = repeat(lower.y, h); y <= repeat(upper.y, h); ++y)
            for (int x = repeat(lower.x, w); x <= repeat(upper.x, w); ++x)
                query(flakes_.pyramid().levels() - 1, 0, 0,
                      Vec2(static_cast<float>(x * w), static_cast<float>(y * h)));
    }

    void query(int level, int x, int y, const Vec2& repeat) {
        ++stats_.nodes;
        const int w = flakes_.width(), h = flakes_.height(), size = 1 << level;
        const Vec2 first = repeat + Vec2(static_cast<float>(x * size) + 0.5f,
                                         static_cast<float>(y * size) + 0.5f),
                   last = repeat + Vec2(static_cast<float>(std::min((x + 1) * size, w)) - 0.5f,
                                        static_cast<float>(std::min((y + 1) * size, h)) - 0.5f);
        if (!reaches((first + last) * 0.5f, (last - first) * 0.5f)) return;
        const SlopeFrame& frame = s_.frame;
        if (level == 0) return add(frame.taken(flakes_.flake(x, y)), s_.middle - first);
        const float least =
            target_.least_sine2(frame.taken(flakes_.pyramid().bounds(level, x, y))) * metric_.scale;
        if (0.5f * widest_ * least > kMostExponent) return;
        const int half = size / 2;
        for (int k = 0; k < 4; ++k) {
            const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
            if (cx * half < w && cy * half < h) query(level - 1, cx, cy, repeat);
        }
    }

    // Whether the pixel reaches flakes with their middles in a box.
    bool reaches(const Vec2& middle, const Vec2& half) const {
        const Vec2 film = s_.film_at(middle), texel = middle - s_.middle;
        for (int i = 0; i < 2; ++i) {
            const Vec2& row = s_.to_film[static_cast<size_t>(i)];
            const float spread = std::abs(row.x) * half.x + std::abs(row.y) * half.y;
            if (std::abs(film[i]) - spread > film_radius_[i] ||
                std::abs(texel[i]) - half[i] > texel_radius_[i])
                return false;
        }
        return true;
    }

    // The integral over positions of three Gaussians: of the pixel, of the flake, and of the lobe
    // around the flake's slope at each. `p` is where the pixel's middle is from the flake's. With x
    // from there, too, and e the slope that is missing, the exponent is -1/2 of
    //
    //     (x - p)^T P (x - p) + x^T x / sigma^2 + m (e - J x)^T Q (e - J x),
    //
    // which is x^T A x - 2 b^T x + c: the integral is 2 pi / sqrt(det A) exp((b^T A^-1 b - c) / 2).
    void add(const SlopeJet& flake, const Vec2& p) {
        constexpr float kInvVariance = 1.0f / (kFlakeSigma * kFlakeSigma);
        const Vec2 e = target_.slope - flake.slope;
        const float ee = metric_.product(e, e), jaa = metric_.product(flake.by_s, flake.by_s),
                    jab = metric_.product(flake.by_s, flake.by_t),
                    jbb = metric_.product(flake.by_t, flake.by_t);
        const Vec2 je(metric_.product(flake.by_s, e), metric_.product(flake.by_t, e));
        const Vec2 pp(paa_ * p.x + pab_ * p.y, pab_ * p.x + pbb_ * p.y);
        const float c_of_pixel = pp.dot(p);
        for (int i = 0; i < term_count_; ++i) {
            const Term& term = terms_[static_cast<size_t>(i)];
            const float m = term.precision;
            const float aaa = paa_ + kInvVariance + m * jaa, aab = pab_ + m * jab,
                        abb = pbb_ + kInvVariance + m * jbb;
            const Vec2 b = pp + je * m;
            const float det = aaa * abb - aab * aab;
            const Vec2 x = Vec2(abb * b.x - aab * b.y, aaa * b.y - aab * b.x) * (1.0f / det);
            const float exponent = 0.5f * (c_of_pixel + m * ee - b.dot(x));
            if (!(exponent < 2.0f * kMostExponent)) continue;  // of two Gaussians
            ++stats_.points;
            const float density = term.peak / std::sqrt(det) * std::exp(-exponent);
            Density& sum = densities_[static_cast<size_t>(term.lobe)];
            sum.density += density;
            sum.slope += (flake.slope + flake.by_s * x.x + flake.by_t * x.y) * density;
        }
    }

    const GlintSite& s_;
    const FlakeField& flakes_;
    const GlintTarget& target_;
    const SlopeMetric metric_;
    const float film_variance_;  // of the pixel's Gaussian
    GlintStats& stats_;
    Vec2 film_radius_, texel_radius_;
    float paa_, pab_, pbb_;  // inverse of the pixel's covariance, texels
    std::array<Term, kMaxGlints * kGgx.size()> terms_{};
    int term_count_ = 0;
    float widest_;  // least precision
    Densities densities_{};
};

}  // namespace

// Everything but the density of normals (masking, Fresnel, energy compensation) is that of the
// facets that reflect, at their mean slope.
Spectrum query_flakes(const FlakeField& flakes, const GlintSite& site, const GlintTarget& target,
                      const Vec3& wi, GlintStats& stats) {
    Spectrum sum(0.0f);
    if (!target.inside) return sum;
    FlakeQuery query(flakes, site, target, stats);
    const FlakeQuery::Densities& densities = query.run();
    for (int i = 0; i < site.closures->glint_count; ++i) {
        const auto& [density, slope] = densities[static_cast<size_t>(i)];
        if (!(density > 0.0f)) continue;
        const MicrofacetReflection& lobe = site.lobe(i).lobe;
        const Vec3 n = normalize(site.frame.normal(slope * (1.0f / density)));
        const float own = normal_density(lobe.model, lobe.alpha, sqr(dot(n, target.half)),
                                         length_squared(cross(n, target.half)));
        if (own > 0.0f) sum += eval_glint(site.lobe(i), n, site.wo, wi) * (density / own);
    }
    return sum;
}

}  // namespace spc
