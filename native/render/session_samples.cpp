// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of a tile's pixels.
#include "render/session.h"

#include <utility>

namespace spc {

namespace {

// On the mesh's active layer; the third is 1 where there is one.
Vec3 uv_seen(const Scene& scene, const SurfaceHit& hit) {
    const Mesh& mesh = scene.meshes[scene.instances[hit.instance].mesh];
    const AttributeName active{AttributeKind::uv, ""};
    for (const Attribute& layer : mesh.attributes) {
        if (!layer.is_uv_layer() || !layer.called.answers(active)) continue;
        const size_t first = size_t{3} * hit.triangle;
        const Vec2 at = layer.uv(first) * (1.0f - hit.u - hit.v) + layer.uv(first + 1) * hit.u +
                        layer.uv(first + 2) * hit.v;
        return {at.x, at.y, 1.0f};
    }
    return Vec3(0.0f);
}

}  // namespace

// With n estimates a pixel's variance V / n falls by V / n^2 for one more, of cost c. Samples of
// the whole picture, of the variance V' and the cost C on average, lower it as fast where n =
// sqrt(V / V' C / c). V is that of some samples with one estimate, and of others with more, so n is
// doubled.
GlintSampling Session::glint_sampling(const PixelSums& pixel, double variance_of_tile) const {
    constexpr double kMost = 16.0;
    if (is_part() || pixel.count < kLeastSamples) return {};
    const double variance = sample_variance({&pixel, 1}).value_or(0.0);
    const double best = variance_ > 0.0
                            ? 2.0 * std::sqrt(std::max(variance, 0.0) / variance_ * work_by_glint_)
                            : 1.0;
    return {static_cast<uint32_t>(std::clamp(best, 1.0, kMost)),
            static_cast<float>(std::sqrt(std::max(variance_of_tile, 0.0)))};
}

// Those of small error whose neighbours in the tile have a small one, too: one pixel's own estimate
// may be small by chance. Of the tile alone, so that threads do not show.
std::vector<bool> Session::pixels_that_end(const Film::TileBounds& bounds,
                                           const Film::TileSums& sums) const {
    // As many as Cycles takes if the artist does not say.
    const float by_threshold = std::ceil(16.0f / std::pow(settings_.noise_threshold, 0.3f));
    const uint32_t least =
        settings_.min_samples > 0 ? settings_.min_samples : static_cast<uint32_t>(by_threshold);
    std::vector<bool> noisy(sums.pixels.size());
    for (size_t i = 0; i < noisy.size(); ++i)
        noisy[i] = sums.pixels[i].count < std::max(least, 2u) ||
                   relative_error(sums.pixels[i], sums.halves[i]) >= settings_.noise_threshold;
    std::vector<bool> ends(noisy.size(), true);
    const auto width = static_cast<int64_t>(bounds.width), height = int64_t{bounds.height};
    for (int64_t y = 0; y < height; ++y)
        for (int64_t x = 0; x < width; ++x)
            for (int64_t v = std::max<int64_t>(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
                for (int64_t u = std::max<int64_t>(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
                    if (noisy[static_cast<size_t>(v * width + u)])
                        ends[static_cast<size_t>(y * width + x)] = false;
    return ends;
}

bool Session::render_pixels(uint32_t tile, uint32_t round, Film::TileSums& sums, RenderStats& stats) {
    const uint32_t first = round_begin(round), count = round_begin(round + 1) - first;
    const Film::TileBounds b = film_.bounds(tile);
    const std::vector<PixelSums>& pixels = sums.pixels;
    RoundState state{is_part() ? first_probabilities_
                               : activation_for(evidence_[tile], pixels, first_probabilities_),
                     sheets_,
                     {}};
    const bool may_glint = !world_.glints.fields.empty();
    const double variance = may_glint ? sample_variance(pixels).value_or(0.0) : 0.0;
    std::vector<bool> ends;
    if (is_adaptive()) {
        ends = pixels_that_end(b, sums);
        if (std::find(ends.begin(), ends.end(), false) == ends.end()) {
            if (std::exchange(tile_ended_[tile], uint8_t{1}) == 0) ++tiles_ended_;
            return true;
        }
    }
    std::optional<PassValues> values;
    if (film_.has_planes()) values.emplace(film_.passes(), film_.crypto().any());
    const auto& crop = world_.scene->camera.crop;
    for (uint32_t y = 0; y < b.height; ++y) {
        for (uint32_t x = 0; x < b.width; ++x) {
            const size_t pixel = static_cast<size_t>(y) * b.width + x;
            if (!ends.empty() && ends[pixel]) continue;
            if (may_glint) state.glints = glint_sampling(pixels[pixel], variance);
            for (uint32_t i = 0; i < count; ++i) {
                if (stops_in(round)) return false;
                if (values) values->clear();
                const FilmSample sample = take_sample(
                    crop[0] + b.x0 + x, crop[1] + b.y0 + y, settings_.first_sample + first + i,
                    settings_.integrator, state, stats, values ? &*values : nullptr);
                if (cut_short_.load(std::memory_order_relaxed))
                    return false;  // so is this, perhaps
                film_.accumulate(sums, pixel, sample);
            }
        }
        look_at_clock();
    }
    return true;
}

// x and y in the full frame: a crop is a window into the same picture.
FilmSample Session::take_sample(uint32_t x, uint32_t y, uint32_t index,
                                const IntegratorSettings& integrator, const RoundState& state,
                                RenderStats& stats, PassValues* values) const {
    const Camera& camera = world_.scene->camera;
    const Sampler sampler(settings_.seed, y * camera.width + x, index);
    const Vec2 offset = filter_.sample(sampler[Domain::film].two());
    const Vec2 lens = camera.aperture_radius > 0.0f ? sampler[Domain::lens].two() : Vec2(0.0f, 0.0f);
    const Vec2 film = Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) + offset;
    const PixelKernel pixel{&filter_, film, offset};
    const ManifoldStats before = stats.path.manifold;
    PathSample path;
    if (camera.sees(film))
        path = path_radiance(world_, integrator, state, camera.ray(film.x, film.y, lens), lens,
                             sampler, stats.path, &pixel, values);
    else
        path.alpha = 0.0f;
    ++stats.samples;
    if (!can_be_held(path.radiance) || !can_be_held(path.caustics) || !is_finite(path.position) ||
        !is_finite(path.normal) || !std::isfinite(path.alpha)) {
        ++stats.nan_samples;
        path = PathSample{};
        if (values != nullptr) values->clear();
    }
    stats.manifold_energy += static_cast<double>(luminance(path.caustics));
    if (values != nullptr) tell_passes(path, before, stats.path.manifold, *values);
    return {path.radiance, path.alpha, values};
}

// Passes of the first surface, and of what the path has cost.
void Session::tell_passes(const PathSample& path, const ManifoldStats& before,
                          const ManifoldStats& after, PassValues& values) const {
    constexpr float kNoSurface = 1e10f;
    const Scene& scene = *world_.scene;
    const auto ratio = [](uint64_t part, uint64_t whole) {
        return Vec3(static_cast<float>(part), static_cast<float>(whole), 0.0f);
    };
    values[Pass::caustics] = path.caustics;
    values[Pass::walk_success] =
        ratio(after.converged - before.converged, after.walks - before.walks);
    values[Pass::walk_trials] =
        ratio(after.trials - before.trials, after.trial_estimates - before.trial_estimates);
    values[Pass::normal] = path.normal;
    values[Pass::depth].x = kNoSurface;
    values[Pass::mist].x = 1.0f;
    if (!path.hit) return;
    const Camera& camera = scene.camera;
    const float depth = camera.depth(path.position);
    const float distance = camera.projection == Projection::orthographic
                               ? depth
                               : length(path.position - camera.to_world.translation);
    values[Pass::position] = path.position + scene.origin;
    values[Pass::depth].x = depth;
    values[Pass::mist].x = settings_.mist.at(distance);
    values[Pass::object_index].x =
        static_cast<float>(scene.instances[path.surface.instance].pass_index);
    values[Pass::material_index].x = static_cast<float>(scene.material_of(path.surface).pass_index);
    if (values.asked().has(Pass::uv)) values[Pass::uv] = uv_seen(scene, path.surface);
}

}  // namespace spc
