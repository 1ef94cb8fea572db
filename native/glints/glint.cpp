// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/glint.h"

#include "bsdf/microfacet.h"

#include <fmt/format.h>

namespace spc {

namespace {

// Smallest footprint, texels. The samples of a pixel average smaller ones as well, for roughness
// 0.3; for narrower lobes less well, but with next to no light.
constexpr float kLeastTexels = 1.0f / 16;
// Beyond it, in texels, single precision does not resolve a footprint.
constexpr float kWidestFootprint = 1e6f;
// Largest turn of the half-vector over the directions that stand for a rough bounce, as a share of
// the narrowest lobe's alpha. By the variance of Beckmann's slopes, alpha^2 / 2, this blurs as much
// as a lobe that is 6 % wider.
constexpr float kMostTurn = 0.25f;
// Added to the density of directions, 1/sr.
constexpr float kLeastPdf = 0.01f;

GlintSet::Key key_of(const SlopeMap& map, const Image& image) {
    return {image.texels(), map.relief, map.relief == Relief::normals ? map.strength : 1.0f};
}

std::optional<Shared<SlopeField>> build_field(const Image& image, const GlintSet::Key& key,
                                              uint32_t threads, const GlintSet* before) {
    if (before != nullptr) {
        const auto known = std::find(before->keys.begin(), before->keys.end(), key);
        if (known != before->keys.end())
            return before->fields[static_cast<size_t>(known - before->keys.begin())];
    }
    if (key.relief == Relief::heights) return SlopeField::of_heights(image, threads);
    std::optional<SlopeField> field = SlopeField::of_normals(image, key.strength, threads);
    if (!field) return std::nullopt;
    return std::move(*field);
}

}  // namespace

size_t GlintSet::memory_bytes() const {
    size_t bytes = 0;
    for (const SlopeField& field : fields) bytes += field.memory_bytes();
    return bytes;
}

GlintSet build_glints(const Scene& scene, uint32_t threads, const GlintSet* before,
                      std::vector<std::string>& report) {
    GlintSet set;
    std::vector<bool> used(scene.materials.size());
    for (const Instance& instance : scene.instances)
        for (const uint32_t material : instance.materials) used[material] = true;
    for (uint32_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        const SlopeMap& map = material.slopes;
        if (!used[i]) continue;
        if (!map.why_not.empty())
            report.push_back(fmt::format("{}: no glints: {}", material.name, map.why_not));
        if (map.image == kNone) continue;
        const Image& image = scene.images[map.image];
        set.of_material.resize(scene.materials.size(), kNone);
        const GlintSet::Key key = key_of(map, image);
        const auto known = std::find(set.keys.begin(), set.keys.end(), key);
        if (known != set.keys.end()) {
            set.of_material[i] = static_cast<uint32_t>(known - set.keys.begin());
        } else if (std::optional<Shared<SlopeField>> field =
                       build_field(image, key, threads, before)) {
            set.of_material[i] = static_cast<uint32_t>(set.fields.size());
            set.fields.push_back(std::move(*field));
            set.keys.push_back(key);
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

std::optional<GlintPoint> GlintPoint::at(const GlintSet& glints, const GlintSettings& settings,
                                         const Scene& scene, const Surface& surface,
                                         const PathDifferential& path, double distance,
                                         const PixelKernel& pixel) {
    if (surface.closures.glint_count == 0) return std::nullopt;
    const uint32_t material = scene.material_index(surface.hit.instance, surface.hit.triangle);
    const uint32_t index = glints.of_material[material];
    if (index == kNone) return std::nullopt;
    const SlopeField& field = glints.fields[index];
    const std::optional<Footprint> footprint =
        footprint_at(scene, scene.materials[material]->slopes, field.width(), field.height(),
                     surface, path, distance);
    if (!footprint) return std::nullopt;
    float alpha = kInfinity;
    for (int i = 0; i < surface.closures.glint_count; ++i)
        alpha = std::min(alpha, surface.closures.glints[static_cast<size_t>(i)].lobe.alpha);
    const std::array<Vec2, 2> axes = footprint->axes(pixel.filter->variance(), kMostTurn * alpha);
    const auto& [dx, dy] = axes;
    const float det = dx.x * dy.y - dx.y * dy.x;
    if (!(std::abs(det) >= kLeastTexels) || !std::isfinite(det)) return std::nullopt;
    // All samples of a pixel share its filter; a lobe's directions stand for those next to them.
    const Vec2 middle = footprint->at - footprint->by_film[0] * pixel.offset.x -
                        footprint->by_film[1] * pixel.offset.y;
    const Vec2 extent = Vec2(std::abs(dx.x) + std::abs(dy.x), std::abs(dx.y) + std::abs(dy.y)) *
                        pixel.filter->radius();
    if (!(std::max(extent.x, extent.y) < kWidestFootprint)) return std::nullopt;
    GlintSite site{
        index,
        &field,
        &surface.closures,
        pixel,
        footprint->frame,
        axes,
        {Vec2(dy.y, -dy.x) / det, Vec2(-dx.y, dx.x) / det},
        surface.wo,
        surface.ng,
        middle,
        middle - extent,
        middle + extent,
        // The filter's mass is nearer to the middle than its extent.
        footprint->frame.taken(field.moments(middle - extent * 0.5f, middle + extent * 0.5f))};
    return GlintPoint(site, settings);
}

// Both are means over a footprint, so that the power heuristic [Veach97] is the safer one. Of
// lights that are wider than a facet's lobe one direction tells little: with S = 1 / mean, a = 1 /
// facet and light of solid angle W it has a variance of W^2 / (S facets) (1 / a - 1 / W), and
// closure sampling, in the light or not, of W / S. In inverse proportion to these, `direct` = 1 / W
// stands against (facet - direct) / facets.
float GlintDensity::share_of_direct(float directions, float direct) const {
    const float closure = mean + directions * std::max(facet - direct, 0.0f) / facets;
    return sqr(directions * direct) / (sqr(directions * direct) + sqr(closure));
}

GlintDensity GlintPoint::density(const Vec3& wi) const {
    constexpr float kLeastCosine = 0.05f;
    const SlopeFrame& frame = site_.frame;
    const GlintTarget target(frame, normalize(site_.wo + wi));
    const Vec3 n = normalize(frame.normal(site_.moments.mean));
    const float cos_o = std::clamp(dot(n, site_.wo), kLeastCosine, 1.0f);
    float mean = 0.0f, peak = 0.0f, weights = 0.0f;
    for (int i = 0; i < site_.closures->glint_count; ++i) {
        const MicrofacetReflection& lobe = site_.lobe(i).lobe;
        const float weight = site_.scale(i, cos_o);
        const float by_cos = 0.25f / (cos_o + lambda_cos(lobe.model, lobe.alpha, cos_o));
        mean += weight * by_cos * site_.mean_density(site_.lobe(i), target);
        peak += weight * by_cos * normal_density(lobe.model, lobe.alpha, 1.0f, 0.0f);
        weights += weight;
    }
    // A normal distribution covers 4 pi of its variance, and texels differ at most.
    const float texels = 4.0f * kPi * site_.pixel.filter->variance() * site_.texels_per_pixel();
    const float scale = weights > 0.0f ? 1.0f / weights : 0.0f;
    return {mean * scale + kLeastPdf, peak * scale, std::max(texels, 1.0f)};
}

Spectrum GlintPoint::f_cos(const Vec3& wi, const GlintPrecision& precision, uint64_t seed,
                           GlintStats& stats) const {
    if (!(dot(site_.ng, wi) > 0.0f)) return Spectrum(0.0f);
    ++stats.estimates;
    const GlintTarget target(site_.frame, normalize(site_.wo + wi));
    switch (settings_.method) {
        case GlintMethod::search:
            return search_footprint(site_, target, wi, precision, seed, stats);
        case GlintMethod::walks: return walk_footprint(site_, target, wi, seed, stats);
        case GlintMethod::walks_biased:
            return walk_footprint_biased(site_, target, wi, settings_.set_size, seed, stats);
        case GlintMethod::yan:
            return query_flakes((*settings_.flakes)[site_.index], site_, target, wi, stats);
    }
    return Spectrum(0.0f);
}

}  // namespace spc
