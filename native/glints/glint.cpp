// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/glint.h"

#include "bsdf/microfacet.h"
#include "core/random.h"

#include <fmt/format.h>

namespace spc {

namespace {

// A footprint of less has nothing to average that the samples of a pixel do not find themselves.
constexpr float kLeastTexels = 1.0f;
// A footprint of more cells is not searched through for the narrowest lobes, of which each cell
// would matter: about so many nodes are, and the estimate has noise instead.
constexpr float kMostCells = 8192.0f;
// Beyond it, in texels, single precision does not resolve a footprint.
constexpr float kWidestFootprint = 1e6f;
// Halvings of a cell: with them any lobe that is not a delta is smooth within a piece.
constexpr int kMostHalvings = 20;
// Added to the density of directions, 1/sr.
constexpr float kLeastPdf = 0.01f;

float mean(const Spectrum& c) { return (c.x + c.y + c.z) * (1.0f / 3.0f); }

}  // namespace

size_t GlintSet::memory_bytes() const {
    size_t bytes = 0;
    for (const SlopeField& field : fields) bytes += field.memory_bytes();
    return bytes;
}

GlintSet build_glints(const Scene& scene, std::vector<std::string>& report) {
    GlintSet set;
    std::vector<bool> used(scene.materials.size());
    for (const Instance& instance : scene.instances)
        for (const uint32_t material : instance.materials) used[material] = true;
    std::vector<std::pair<uint32_t, float>> keys;  // image and strength of each field
    for (uint32_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        const SlopeMap& map = material.slopes;
        if (!used[i]) continue;
        if (!map.why_not.empty())
            report.push_back(fmt::format("{}: no glints: {}", material.name, map.why_not));
        if (map.image == kNone) continue;
        const Image& image = scene.images[map.image];
        set.of_material.resize(scene.materials.size(), kNone);
        const auto known = std::find(keys.begin(), keys.end(), std::pair(map.image, map.strength));
        if (known != keys.end()) {
            set.of_material[i] = static_cast<uint32_t>(known - keys.begin());
        } else if (std::optional<SlopeField> field = SlopeField::build(image, map.strength)) {
            set.of_material[i] = static_cast<uint32_t>(set.fields.size());
            set.fields.push_back(std::move(*field));
            keys.emplace_back(map.image, map.strength);
        } else {
            report.push_back(
                fmt::format("{}: no glints: normals of image \"{}\" point into the surface",
                            material.name, image.name));
            continue;
        }
        report.push_back(fmt::format("{}: glints ({}; image \"{}\", {} x {})", material.name,
                                     map.why, image.name, image.width, image.height));
    }
    return set;
}

// A direction of light, as the slopes of the map see it. For the normal n = W (a, b, 1) and the
// half-vector h, n.h is linear and |n x h|^2 quadratic in (a, b); the latter vanishes at `slope`.
struct GlintPoint::Target {
    Vec3 half;             // not normalised
    Vec3 linear;           // n.h = a x + b y + z
    Vec2 slope;            // of h itself
    bool inside;           // it has one: h is on the side of the interpolated normal
    float aa, ab, bb;      // of |n x h|^2 around `slope`
    float x_by_y, y_by_x;  // where that is least along a line of constant y, or x

    float dot_at(const Vec2& s) const { return linear.x * s.x + linear.y * s.y + linear.z; }
    float sine2_at(const Vec2& d) const {
        return aa * d.x * d.x + 2.0f * ab * d.x * d.y + bb * d.y * d.y;
    }
    // Bounds over a box of slopes.
    float most_dot(const SlopeBounds& b) const {
        return linear.z + std::max(linear.x * b.lower.x, linear.x * b.upper.x) +
               std::max(linear.y * b.lower.y, linear.y * b.upper.y);
    }
    // Of a convex function the minimum over a box is on a side that faces the free minimum.
    float least_sine2(const SlopeBounds& b) const {
        if (!inside) return 0.0f;
        const Vec2 low = b.lower - slope, high = b.upper - slope;
        float least = kInfinity;
        if (low.x > 0.0f || high.x < 0.0f) {
            const float x = low.x > 0.0f ? low.x : high.x;
            least = sine2_at({x, std::clamp(y_by_x * x, low.y, high.y)});
        }
        if (low.y > 0.0f || high.y < 0.0f) {
            const float y = low.y > 0.0f ? low.y : high.y;
            least = std::min(least, sine2_at({std::clamp(x_by_y * y, low.x, high.x), y}));
        }
        return std::isinf(least) ? 0.0f : least;
    }
};

GlintPoint::Target GlintPoint::target_of(const Vec3& wi) const {
    const std::array<Vec3, 3>& w = footprint_.frame.w;
    Target t;
    t.half = normalize(wo_ + wi);
    t.linear = {dot(w[0], t.half), dot(w[1], t.half), dot(w[2], t.half)};
    const Vec3 c0 = cross(w[0], t.half), c1 = cross(w[1], t.half);
    t.aa = dot(c0, c0);
    t.ab = dot(c0, c1);
    t.bb = dot(c1, c1);
    t.x_by_y = -t.ab / t.aa;
    t.y_by_x = -t.ab / t.bb;
    // Cramer's rule for W (a, b, 1) = c h.
    const float along = dot(cross(w[0], w[1]), t.half);
    const float det = dot(cross(w[0], w[1]), w[2]);
    t.inside = along * det > 1e-6f * std::abs(det);
    t.slope = t.inside ? Vec2(dot(cross(w[1], w[2]), t.half), dot(cross(w[2], w[0]), t.half)) / along
                       : Vec2(0.0f, 0.0f);
    return t;
}

std::optional<GlintPoint> GlintPoint::at(const GlintSet& glints, const Scene& scene,
                                         const Surface& surface, const RayDual& ray,
                                         double distance, const PixelKernel& pixel) {
    if (surface.closures.glint_count == 0) return std::nullopt;
    const uint32_t material = scene.material_index(surface.hit.instance, surface.hit.triangle);
    const uint32_t index = glints.of_material[material];
    if (index == kNone) return std::nullopt;
    GlintPoint point;
    point.field_ = &glints.fields[index];
    const std::optional<Footprint> footprint =
        footprint_at(scene, scene.materials[material].slopes, point.field_->width(),
                     point.field_->height(), surface, ray, distance);
    if (!footprint) return std::nullopt;
    const auto& [dx, dy] = footprint->by_film;
    const float det = dx.x * dy.y - dx.y * dy.x;
    if (!(std::abs(det) >= kLeastTexels) || !std::isfinite(det)) return std::nullopt;
    point.footprint_ = *footprint;
    point.closures_ = &surface.closures;
    point.pixel_ = pixel;
    point.wo_ = surface.wo;
    point.ng_ = surface.ng;
    point.to_film_ = {Vec2(dy.y, -dy.x) / det, Vec2(-dx.y, dx.x) / det};
    const Vec2 middle = footprint->at - dx * pixel.offset.x - dy * pixel.offset.y;
    const Vec2 reach = Vec2(std::abs(dx.x) + std::abs(dy.x), std::abs(dx.y) + std::abs(dy.y)) *
                       pixel.filter->reach();
    if (!(std::max(reach.x, reach.y) < kWidestFootprint)) return std::nullopt;
    point.lower_ = middle - reach;
    point.upper_ = middle + reach;
    // The filter's mass is nearer to the middle than its reach.
    point.moments_ = point.field_->moments(middle - reach * 0.5f, middle + reach * 0.5f);
    return point;
}

// Mean over the footprint of D, if the slopes were distributed normally, with the lobe's own spread
// [Olano10]; and a tail that falls no faster than the lobe's own.
float GlintPoint::mean_density(const GlintLobe& glint, const Target& t) const {
    const MicrofacetReflection& lobe = glint.lobe;
    const float dot_mean = t.dot_at(moments_.mean);
    const float tail =
        dot_mean > 0.0f
            ? normal_density(lobe.model, lobe.alpha, sqr(dot_mean),
                             length_squared(cross(footprint_.frame.normal(moments_.mean), t.half)))
            : 0.0f;
    if (!t.inside) return tail;
    // Near its peak the lobe sees the angle^2 as d^T Q d, with Q as follows; its variance is half of
    // alpha^2 in each direction.
    const float scale = 1.0f / sqr(t.dot_at(t.slope));
    const float qaa = t.aa * scale, qab = t.ab * scale, qbb = t.bb * scale;
    const float det_q = qaa * qbb - qab * qab;
    const float spread = 0.5f * sqr(lobe.alpha) / det_q;
    const float saa = moments_.aa + spread * qbb, sab = moments_.ab - spread * qab,
                sbb = moments_.bb + spread * qaa;
    const float det_s = saa * sbb - sab * sab;
    const Vec2 d = t.slope - moments_.mean;
    const float m = (sbb * d.x * d.x - 2.0f * sab * d.x * d.y + saa * d.y * d.y) / det_s;
    const float normal = std::exp(-0.5f * m) * 0.5f * kInvPi / std::sqrt(det_s * det_q);
    return (std::isfinite(normal) ? normal : 0.0f) + tail;
}

float GlintPoint::pdf(const Vec3& wi) const {
    constexpr float kLeastCosine = 0.05f;
    const Target target = target_of(wi);
    const Vec3 n = normalize(footprint_.frame.normal(moments_.mean));
    const float cos_o = std::clamp(dot(n, wo_), kLeastCosine, 1.0f);
    float sum = 0.0f, weights = 0.0f;
    for (int i = 0; i < closures_->glint_count; ++i) {
        const GlintLobe& glint = closures_->glints[static_cast<size_t>(i)];
        const MicrofacetReflection& lobe = glint.lobe;
        const float weight = mean(glint.weight) * mean(fresnel(lobe.fresnel, cos_o));
        const float g1_by_cos = 1.0f / (cos_o + lambda_cos(lobe.model, lobe.alpha, cos_o));
        sum += weight * mean_density(glint, target) * 0.25f * g1_by_cos;
        weights += weight;
    }
    return (weights > 0.0f ? sum / weights : 0.0f) + kLeastPdf;
}

// Looks for the parts of a footprint whose normals may send the light on. A part is a node of the
// slope field, or a piece of a cell below; C is its area times a bound of what the estimate sums up
// there. While C exceeds `threshold` a part is split; then it is kept with the probability
// C / threshold and evaluated at one random point, so that no contribution exceeds the threshold,
// and the variance is at most threshold times mean.
class GlintSearch {
public:
    GlintSearch(const GlintPoint& point, const GlintPoint::Target& target, const Vec3& wi,
                float points, uint64_t seed, GlintStats& stats)
        : p_(point), field_(*point.field_), target_(target), wi_(wi), seed_(seed), stats_(stats) {
        const ClosureList& closures = *p_.closures_;
        const float cos_o_h = std::max(dot(p_.wo_, target.half), 0.0f);
        float mean_sum = 0.0f, most_sum = 0.0f;
        for (int i = 0; i < closures.glint_count; ++i) {
            const auto k = static_cast<size_t>(i);
            const GlintLobe& glint = closures.glints[k];
            scales_[k] = mean(glint.weight) * mean(fresnel(glint.lobe.fresnel, cos_o_h));
            mean_sum += scales_[k] * p_.mean_density(glint, target);
            most_sum += scales_[k] * normal_density(glint.lobe.model, glint.lobe.alpha, 1.0f, 0.0f);
        }
        const float reach = p_.pixel_.filter->reach();
        const float cells = p_.footprint_.texels_per_pixel() * sqr(2.0f * reach);
        const float most_mass = most_sum * sqr(p_.pixel_.filter->weight(0.0f)) * cells;
        threshold_ = std::max(p_.footprint_.texels_per_pixel() * mean_sum / points,
                              most_mass / kMostCells * clamp01(cells / kMostCells - 1.0f));
    }

    Spectrum run() {
        if (!(threshold_ > 0.0f)) return Spectrum(0.0f);
        const auto tile = [](float at, int size) {
            return static_cast<int>(std::floor(at / static_cast<float>(size)));
        };
        const int w = field_.width(), h = field_.height();
        search_tiles(tile(p_.lower_.x, w), tile(p_.upper_.x, w), tile(p_.lower_.y, h),
                     tile(p_.upper_.y, h));
        return sum_ * (1.0f / p_.footprint_.texels_per_pixel());
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
                {std::max(lower.x, p_.lower_.x), std::max(lower.y, p_.lower_.y)},
                {std::min(upper.x, p_.upper_.x), std::min(upper.y, p_.upper_.y)}};
    }

    Vec2 film_at(const Vec2& texel) const {
        const Vec2 d = texel - p_.footprint_.at;
        return Vec2(p_.to_film_[0].dot(d), p_.to_film_[1].dot(d)) + p_.pixel_.offset;
    }

    // C; 0 where the part has nothing to add.
    float importance(const Part& part, const SlopeBounds& slopes) {
        ++stats_.nodes;
        if (!(part.lower.x < part.upper.x) || !(part.lower.y < part.upper.y)) return 0.0f;
        const Vec2 middle = film_at((part.lower + part.upper) * 0.5f);
        const Vec2 half = (part.upper - part.lower) * 0.5f;
        float weight = part.area();
        for (size_t i = 0; i < 2; ++i) {
            const float spread =
                std::abs(p_.to_film_[i].x) * half.x + std::abs(p_.to_film_[i].y) * half.y;
            const float nearest = std::abs(middle[static_cast<int>(i)]) - spread;
            weight *= p_.pixel_.filter->weight(std::max(nearest, 0.0f));
        }
        if (weight == 0.0f) return 0.0f;
        const float cos = target_.most_dot(slopes);
        if (!(cos > 0.0f)) return 0.0f;
        const float cos2 = cos * cos, sin2 = target_.least_sine2(slopes);
        float density = 0.0f;
        for (int i = 0; i < p_.closures_->glint_count; ++i) {
            const auto k = static_cast<size_t>(i);
            const MicrofacetReflection& lobe = p_.closures_->glints[k].lobe;
            density += scales_[k] * normal_density(lobe.model, lobe.alpha, cos2, sin2);
        }
        return weight * density;
    }

    // Whole tiles, a range of them.
    void search_tiles(int x0, int x1, int y0, int y1) {
        const int w = field_.width(), h = field_.height();
        const Vec2 size(static_cast<float>(w), static_cast<float>(h));
        const Vec2 tile(static_cast<float>(x0) * size.x, static_cast<float>(y0) * size.y);
        if (x0 == x1 && y0 == y1) return search_node(field_.levels() - 1, 0, 0, tile);
        const Part part = clipped(
            tile, Vec2(static_cast<float>(x1 + 1) * size.x, static_cast<float>(y1 + 1) * size.y));
        const float c = importance(part, field_.bounds(field_.levels() - 1, 0, 0));
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
        if (level == 0) return search_patch(field_.cell(x, y), tile + lower, 1.0f, kMostHalvings);
        const float c = importance(part, field_.bounds(level, x, y));
        if (c == 0.0f) return;
        if (c <= threshold_) return keep(part, c);
        const int half = size / 2;
        for (int k = 0; k < 4; ++k) {
            const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
            if (cx * half < w && cy * half < h) search_node(level - 1, cx, cy, tile);
        }
    }

    // A piece of a cell: the square of `size` at `lower`.
    void search_patch(const SlopePatch& patch, const Vec2& lower, float size, int halvings) {
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
        const Vec2 film = film_at(at);
        const float weight = p_.pixel_.filter->weight(film.x) * p_.pixel_.filter->weight(film.y) *
                             part.area() / chance;
        if (weight == 0.0f) return;
        const auto place = [](float s, int n, int& cell) {
            const auto size = static_cast<float>(n);
            s -= std::floor(s / size) * size;
            cell = std::min(static_cast<int>(s), n - 1);
            return s - static_cast<float>(cell);
        };
        int x = 0, y = 0;
        const float s = place(at.x, field_.width(), x), t = place(at.y, field_.height(), y);
        const Vec3 n = normalize(p_.footprint_.frame.normal(field_.cell(x, y).slope(s, t)));
        for (int i = 0; i < p_.closures_->glint_count; ++i)
            sum_ +=
                eval_glint(p_.closures_->glints[static_cast<size_t>(i)], n, p_.wo_, wi_) * weight;
    }

    const GlintPoint& p_;
    const SlopeField& field_;
    const GlintPoint::Target& target_;
    const Vec3& wi_;
    const uint64_t seed_;
    GlintStats& stats_;
    std::array<float, kMaxGlints> scales_{};
    float threshold_ = 0.0f;
    Spectrum sum_{0.0f};
};

Spectrum GlintPoint::f_cos(const Vec3& wi, float points, uint64_t seed, GlintStats& stats) const {
    if (!(dot(ng_, wi) > 0.0f)) return Spectrum(0.0f);
    ++stats.estimates;
    const Target target = target_of(wi);
    return GlintSearch(*this, target, wi, points, seed, stats).run();
}

}  // namespace spc
