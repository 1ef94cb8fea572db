// SPDX-License-Identifier: GPL-3.0-or-later
// Glints: the search of a footprint, and beside it walks on the same slopes [Zeltner20 Sec. 4.5],
// unbiased and biased, and Gaussians of position and slope [Yan16]. `relative_variance` is that of
// one estimate for one direction of light, averaged over directions in proportion to what they
// give, `found` the share of it that is found on average, `evaluations` are nodes, flakes and
// points, or slopes on walks. And what is prepared before a render for a map that glints.
#include "support/glints.h"

#include <numeric>
#include "kernels.h"

namespace spc::bench {
namespace {

constexpr uint32_t kDirections = 16;  // of light
constexpr uint32_t kEstimates = kBatch / kDirections;
constexpr float kRoughness = 0.14f;

// A footprint on a floor of Gaussian waves, and directions of light that it may glint in.
struct GlintScene {
    RenderScene world;
    FlakeSet flakes;
    PixelFilter filter{FilterKind::blackman_harris, 1.5f};
    PixelKernel pixel{&filter, Vec2(0.5f), Vec2(0.0f)};
    Surface surface;
    PathDifferential ray;
    double distance;
    std::vector<Vec3> wi;
};

const GlintScene& scene_of(double texels) {
    const auto make = [](double width) {
        test::GlintFloor floor{
            test::normal_mapped(
                test::single_shader("bsdf_glossy", {{1, "Roughness", {kRoughness, 0, 0, 0}}}),
                {1, 1}),
            test::plane_normals(512, 5.0 / 512, 0.2, 5), width, 0.5f, [](test::SceneMaker&) {}};
        auto made = std::make_unique<GlintScene>();
        made->world = test::finish(floor, GlintsMode::on);
        for (const SlopeField& field : made->world.glints.fields)
            made->flakes.emplace_back(field, 1);
        const Scene& scene = *made->world.scene;
        const Ray ray = scene.camera.ray(0.5f, 0.5f, Vec2(0.5f));
        const Hit hit = *scene.accel->intersect(ray, kVisibleCamera);
        evaluate_surface(scene, hit.surface, ray.direction * -1.0f, made->surface);
        made->ray = camera_differential(scene.camera, made->pixel, Vec2(0.5f), ray.direction);
        made->distance = static_cast<double>(hit.t);
        Pcg pcg(7);
        const Vec3 mirrored(-made->surface.wo.x, -made->surface.wo.y, made->surface.wo.z);
        for (uint32_t i = 0; i < kDirections; ++i)
            made->wi.push_back(normalize(mirrored + Vec3(pcg.one() - 0.5f, pcg.one() - 0.5f, 0.0f)));
        return made;
    };
    static const std::unique_ptr<GlintScene> few = make(5.0), many = make(20.0);
    return texels < 10.0 ? *few : *many;
}

// An estimator of the mean of what a footprint does with light from wi.
using Estimator = std::function<double(const Vec3& wi, uint64_t seed, uint64_t& evaluations)>;

Estimator by(const GlintScene& scene, GlintSettings settings, float points = 2.0f) {
    settings.flakes = &scene.flakes;
    const GlintPoint point = *GlintPoint::at(scene.world.glints, settings, *scene.world.scene,
                                             scene.surface, scene.ray, scene.distance, scene.pixel);
    return [point, points](const Vec3& wi, uint64_t seed, uint64_t& evaluations) {
        GlintStats stats;
        const Spectrum f = point.f_cos(wi, {points}, seed, stats);
        evaluations += stats.nodes + stats.points;
        return static_cast<double>(f.y);
    };
}

// Moments of an estimator for each direction.
struct Moments {
    std::vector<double> mean, variance;
    uint64_t evaluations = 0;
};
Moments moments_of(const GlintScene& scene, const Estimator& estimator) {
    Moments m;
    for (uint32_t d = 0; d < kDirections; ++d) {
        double sum = 0.0, squares = 0.0;
        for (uint32_t i = 0; i < kEstimates; ++i) {
            const double x = estimator(scene.wi[d], mix_bits(d * kEstimates + i + 1), m.evaluations);
            sum += x;
            squares += x * x;
        }
        m.mean.push_back(sum / kEstimates);
        m.variance.push_back(squares / kEstimates - m.mean.back() * m.mean.back());
    }
    return m;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void estimate(benchmark::State& state, const GlintScene& scene, const Estimator& estimator) {
    const Moments m = moments_of(scene, estimator), exact = moments_of(scene, by(scene, {}, 64.0f));
    const double squared = product(exact.mean, exact.mean), found = product(m.mean, exact.mean);
    if (!holds(state, found > 0.9 * std::sqrt(product(m.mean, m.mean) * squared),
               "it estimates something else"))
        return;
    state.counters["found"] = found / squared;
    state.counters["relative_variance"] =
        std::accumulate(m.variance.begin(), m.variance.end(), 0.0) / squared;
    state.counters["evaluations"] = share(m.evaluations, kBatch);
    time_passes(state, "estimate", kBatch, [&] {
        uint64_t evaluations = 0;
        for (uint32_t i = 0; i < kBatch; ++i)
            benchmark::DoNotOptimize(
                estimator(scene.wi[i % kDirections], mix_bits(i + 1), evaluations));
    });
}

// Waves of 5 texels, between 0 and 1.
Image tile_of(Relief relief) {
    constexpr uint32_t kSide = 256;
    constexpr double kWave = 5.0 / kSide;
    if (relief == Relief::normals) return test::plane_normals(kSide, kWave, 0.2, 5);
    Image tile = test::plane_heights(kSide, kSide, kWave, 0.2, 5);
    const auto [low, high] = std::minmax_element(tile.floats.begin(), tile.floats.end());
    const float least = *low, most = *high;
    for (float& height : tile.floats.writable()) height = (height - least) / (most - least);
    return tile;
}

// In bytes, as most files have it, over and over, with noise in their last digit.
Image large_map(uint32_t side, const Image& tile) {
    std::vector<uint8_t> texels;
    texels.reserve(size_t{side} * side * tile.channels);
    Pcg pcg(9);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            for (uint32_t c = 0; c < tile.channels; ++c) {
                const size_t texel = size_t{y % tile.height} * tile.width + x % tile.width;
                const float value = tile.floats[texel * tile.channels + c];
                texels.push_back(static_cast<uint8_t>(254.0f * value + pcg.one()));
            }
    return image_from_bytes("large", texels, side, side, tile.channels, ColorSpace::data,
                            AlphaMode::none);
}

// What a render needs beside the image of such a map.
void prepare_map(benchmark::State& state, Relief relief) {
    constexpr uint32_t kSide = 4096;
    const Image map = large_map(kSide, tile_of(relief));
    const auto prepare = [&] {
        return relief == Relief::heights ? SlopeField::of_heights(map, 1)
                                         : SlopeField::of_normals(map, 1.0f, 1);
    };
    const std::optional<SlopeField> field = prepare();
    if (!holds(state, field && field->pyramid().levels() == 13, "there is no field of the map"))
        return;
    state.counters["bytes_for_each_texel"] =
        static_cast<double>(field->memory_bytes()) / (double{kSide} * kSide);
    time_passes(state, "texel", uint64_t{kSide} * kSide,
                [&] { benchmark::DoNotOptimize(prepare()); });
}

}  // namespace

void add_glints() {
    struct Row {
        const char* name;
        GlintSettings settings;
        float points = 2.0f;
    };
    for (const Row& row :
         {Row{"search_2", {}, 2.0f}, Row{"search_8", {}, 8.0f},
          Row{"walks_unbiased", {GlintMethod::walks}},
          Row{"walks_biased_8", {GlintMethod::walks_biased, 8}},
          Row{"walks_biased_32", {GlintMethod::walks_biased, 32}}, Row{"yan", {GlintMethod::yan}}})
        for (const auto& [size, texels] : {std::pair("5_texels", 5.0), std::pair("20_texels", 20.0)})
            benchmark::RegisterBenchmark((std::string("glints/") + row.name + "/" + size).c_str(),
                                         [row, texels = texels](benchmark::State& state) {
                                             const GlintScene& scene = scene_of(texels);
                                             estimate(state, scene,
                                                      by(scene, row.settings, row.points));
                                         });
    for (const auto& [name, relief] : {std::pair("glints/prepare_normals_4096", Relief::normals),
                                       std::pair("glints/prepare_heights_4096", Relief::heights)})
        benchmark::RegisterBenchmark(
            name, [relief = relief](benchmark::State& state) { prepare_map(state, relief); });
}

}  // namespace spc::bench
