// SPDX-License-Identifier: GPL-3.0-or-later
// A world's strength is its radiance (Cycles 5.0.1: irradiance pi times it on an open plane).
#include "light/world.h"

#include "core/limits.h"
#include "core/parallel.h"
#include "math/warp.h"

namespace spc {
namespace {

constexpr uint32_t kDefaultWidth = 1024;  // without an image, as Cycles
constexpr uint32_t kLeastWidth = 256, kMostWidth = 4096;
// Least density of a direction against the mean, so that none which the table takes for black is
// out of reach.
constexpr float kDensityFloor = 1e-3f;
// Radiance of a peak, at least, over the mean.
constexpr float kPeak = 16.0f;
// Mean square of radiance over the square of its mean: a world of less is left to closures, as a
// constant one is. A choice between it and a sun would cost more than it saves.
constexpr double kLeastContrast = 2.0;

Vec3 to_direction(const Vec2& position) {
    const Vec2 azimuth = unit_circle(0.5f - position.x + (position.x > 0.5f ? 1.0f : 0.0f));
    const Vec2 polar = unit_circle(0.5f * (1.0f - position.y));  // of the angle from +z
    return {polar.y * azimuth.x, polar.y * azimuth.y, polar.x};
}

// Density over solid angle from one over the square: d omega = 2 pi^2 sin theta du dv.
float to_omega(float pdf_square, float sin_theta) {
    return pdf_square * 0.5f * kInvPi * kInvPi / sin_theta;
}

// Columns of directions at which no texel of the world's images falls between two of them, as the
// nodes for panoramas spread it: a panorama of the usual shape has so many columns, another one as
// many rows, and a mirror ball is nowhere finer than pi / 2 times its width. (Near their poles
// images are finer than that; a mapping that turns them away from the table's own may hide a texel
// there, which is left to kDensityFloor.)
uint32_t columns_to_look_at(const Scene& scene, const Material& material) {
    uint32_t columns = 0;
    for (const uint32_t index : material.images) {
        const Image& image = scene.images[index];
        columns = std::max({columns, image.width, 2 * image.height});
    }
    return columns == 0 ? kDefaultWidth : columns;
}

// Luminance at the middles of the cells of a grid of directions, row by row from -z; where the
// image has several texels in a cell, their mean.
struct Table {
    uint32_t width, height;
    std::vector<float> values;

    float& at(uint32_t x, uint32_t y) { return values[static_cast<size_t>(y) * width + x]; }
    float at(uint32_t x, uint32_t y) const { return values[static_cast<size_t>(y) * width + x]; }
};

Table tabulate(const Scene& scene, const Material& material, uint32_t threads) {
    const uint32_t wanted = columns_to_look_at(scene, material);
    const uint32_t finer = (wanted + kMostWidth - 1) / kMostWidth;
    const uint32_t height = (std::max((wanted + finer - 1) / finer, kLeastWidth) + 1) / 2,
                   width = 2 * height;
    Table table{width, height, std::vector<float>(static_cast<size_t>(width) * height)};
    const auto brightness = [&](uint32_t fine_x, uint32_t fine_y) {
        const Vec2 position(
            (static_cast<float>(fine_x) + 0.5f) / static_cast<float>(width * finer),
            (static_cast<float>(fine_y) + 0.5f) / static_cast<float>(height * finer));
        const float value = luminance(
            evaluate_background(material, scene.images, to_direction(position), {}, scene.view));
        return std::isfinite(value) ? std::clamp(value, 0.0f, kLargestNumber) : 0.0f;
    };
    parallel_for(threads, height, [&](uint32_t y) {
        for (uint32_t x = 0; x < width; ++x) {
            float sum = 0.0f;
            for (uint32_t j = 0; j < finer; ++j)
                for (uint32_t i = 0; i < finer; ++i)
                    sum += brightness(x * finer + i, y * finer + j);
            table.at(x, y) = sum / static_cast<float>(finer * finer);
        }
    });
    return table;
}

float sin_theta(const Table& table, uint32_t y) {
    return std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(table.height));
}

struct Moments {
    double mean, mean_square;  // over the sphere
};
Moments moments(const Table& table) {
    double sum = 0.0, squares = 0.0, weight = 0.0;
    for (uint32_t y = 0; y < table.height; ++y) {
        const double sine = sin_theta(table, y);
        for (uint32_t x = 0; x < table.width; ++x) {
            const auto value = static_cast<double>(table.at(x, y));
            sum += sine * value;
            squares += sine * value * value;
        }
        weight += sine * table.width;
    }
    return {sum / weight, squares / weight};
}

// From radiance to density over the square, which is wider than the sphere towards the poles.
// Closures find what the world has everywhere: what is brighter than its mean is left to this
// density [Karlik19].
BilinearMap density_over_square(Table table, float mean) {
    for (uint32_t y = 0; y < table.height; ++y)
        for (uint32_t x = 0; x < table.width; ++x)
            table.at(x, y) =
                std::max(table.at(x, y) - mean, kDensityFloor * mean) * sin_theta(table, y);
    return {std::move(table.values), table.width, table.height};
}

std::optional<WorldSample> sample_map(const BilinearMap& map, const BilinearMap::Cells& cells,
                                      const Vec2& u) {
    const BilinearMap::Sample s = map.sample(cells, u);
    const Vec3 wi = to_direction(s.position);
    const float sin_theta = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    if (!(sin_theta > 0.0f)) return std::nullopt;
    return WorldSample{wi, to_omega(s.pdf, sin_theta)};
}

float map_pdf(const BilinearMap& map, const BilinearMap::Cells& cells, const Vec3& wi) {
    const float sin_theta = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    if (!(sin_theta > 0.0f)) return 0.0f;
    // atan2 keeps the digits near the poles that acos loses.
    const Vec2 position(0.5f - std::atan2(wi.y, wi.x) * (0.5f * kInvPi),
                        1.0f - std::atan2(sin_theta, wi.z) * kInvPi);
    return to_omega(map.pdf(cells, position), sin_theta);
}

void take_world(const LightSet& from, LightSet& lights) {
    lights.has_world = from.has_world;
    lights.world_material = from.world_material;
    lights.world_map = from.world_map;
    lights.world_cells = from.world_cells;
    lights.world_peaks = from.world_peaks;
    lights.world_constant = from.world_constant;
    lights.world_is_constant = from.world_is_constant;
}

double integral_of(const BilinearMap::Cells& cells) {
    constexpr double pi = std::numbers::pi;
    return 2.0 * pi * pi * cells.mean;
}

}  // namespace

void build_world(const Scene& scene, LightSet& lights, uint32_t threads, const LightSet* before) {
    if (scene.environment.material == kNone) return;
    const Material& material = scene.materials[scene.environment.material];
    if (before != nullptr && before->world_material == &material) {
        take_world(*before, lights);
        return;
    }
    lights.world_material = &material;
    if (material.constant_emission) {
        lights.world_is_constant = true;
        lights.world_constant = evaluate_background(material, scene.images, Vec3(0.0f, 0.0f, 1.0f));
        lights.has_world = luminance(lights.world_constant) > 0.0f;
        return;
    }
    const Table table = tabulate(scene, material, threads);
    const Moments of_table = moments(table);
    const auto mean = static_cast<float>(of_table.mean);
    lights.has_world = mean > 0.0f;
    lights.world_map = density_over_square(table, mean);
    if (of_table.mean_square >= kLeastContrast * of_table.mean * of_table.mean)
        lights.world_cells = lights.world_map.cells([](uint32_t, uint32_t) { return true; });
    lights.world_peaks = lights.world_map.cells(
        [&](uint32_t x, uint32_t y) { return table.at(x, y) > kPeak * mean; });
}

double world_excess(const LightSet& lights) {
    return lights.world_is_constant ? 0.0 : integral_of(lights.world_cells);
}

double world_excess_of_peaks(const LightSet& lights) { return integral_of(lights.world_peaks); }

std::optional<WorldSample> sample_world(const LightSet& lights, const Vec2& u) {
    if (lights.world_is_constant) return WorldSample{uniform_sphere(u), kUniformSpherePdf};
    return sample_map(lights.world_map, lights.world_cells, u);
}

float world_pdf(const LightSet& lights, const Vec3& wi) {
    return lights.world_is_constant ? kUniformSpherePdf
                                    : map_pdf(lights.world_map, lights.world_cells, wi);
}

std::optional<WorldSample> sample_world_peaks(const LightSet& lights, const Vec2& u) {
    return sample_map(lights.world_map, lights.world_peaks, u);
}

float world_peaks_pdf(const LightSet& lights, const Vec3& wi) {
    return map_pdf(lights.world_map, lights.world_peaks, wi);
}

}  // namespace spc
