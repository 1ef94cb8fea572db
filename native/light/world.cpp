// SPDX-License-Identifier: GPL-3.0-or-later
// A world's strength is its radiance (Cycles 5.0.1: irradiance pi times it on an open plane).
#include "light/world.h"

#include "math/warp.h"

#include <atomic>
#include <thread>

namespace spc {
namespace {

constexpr uint32_t kDefaultWidth = 1024;  // without an image, as Cycles
constexpr uint32_t kLeastWidth = 256, kMostWidth = 4096;
// Least density of a direction against the mean, so that none which the table takes for black is out of reach.
constexpr float kDensityFloor = 1e-3f;

Vec3 to_direction(const Vec2& position) {
    const Vec2 azimuth = unit_circle(0.5f - position.x + (position.x > 0.5f ? 1.0f : 0.0f));
    const Vec2 polar = unit_circle(0.5f * (1.0f - position.y));  // of the angle from +z
    return {polar.y * azimuth.x, polar.y * azimuth.y, polar.x};
}

// Density over solid angle from one over the square: d omega = 2 pi^2 sin theta du dv.
float to_omega(float pdf_square, float sin_theta) { return pdf_square * 0.5f * kInvPi * kInvPi / sin_theta; }

// Width of the image that the world seems to show. Programs do not tell theirs; the widest panorama of the scene is
// the best guess, and a wrong one costs time at most.
uint32_t panorama_width(const Scene& scene) {
    uint32_t width = 0;
    for (const Image& image : scene.images)
        if (image.width == 2 * image.height) width = std::max(width, image.width);
    return width == 0 ? kDefaultWidth : width;
}

class Tabulation {
public:
    explicit Tabulation(const Scene& scene)
        : material_(scene.materials[scene.environment.material]), images_(scene.images) {
        const uint32_t wanted = panorama_width(scene);
        width_ = std::clamp(wanted, kLeastWidth, kMostWidth);
        height_ = width_ / 2;
        finer_ = std::clamp((wanted + width_ - 1) / width_, 1u, 4u);
        values_.resize(static_cast<size_t>(width_) * height_);
        first_ = evaluate_background(material_, images_, Vec3(0.0f, 0.0f, 1.0f));
    }

    void run() {
        const uint32_t threads = std::max(std::thread::hardware_concurrency(), 1u);
        std::vector<std::jthread> workers;
        for (uint32_t i = 0; i < threads; ++i)
            workers.emplace_back([this, i, threads] {
                for (uint32_t y = i; y < height_; y += threads) fill_row(y);
            });
    }

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    bool constant() const { return constant_; }
    Spectrum first() const { return first_; }
    std::vector<float>& values() { return values_; }

private:
    // Bilinear texels reach half a texel into their neighbours' cells. At one texel a cell, centre and corners
    // together see all that can be bright in it; with more, the corners' share is small.
    void fill_row(uint32_t y) {
        const uint32_t fine_width = width_ * finer_, fine_height = height_ * finer_;
        const auto brightness = [&](float fine_x, float fine_y) {
            const Vec2 position(fine_x / static_cast<float>(fine_width), fine_y / static_cast<float>(fine_height));
            const Spectrum color = evaluate_background(material_, images_, to_direction(position));
            if (color != first_) constant_.store(false, std::memory_order_relaxed);
            const float value = luminance(color);
            return std::isfinite(value) ? std::max(value, 0.0f) : 0.0f;
        };
        const auto corners = [&](uint32_t row, std::vector<float>& out) {
            for (uint32_t x = 0; x < width_; ++x)
                out[x] = brightness(static_cast<float>(x * finer_), static_cast<float>(row * finer_));
            out[width_] = out[0];
        };
        std::vector<float> below(width_ + 1), above(width_ + 1);
        corners(y, below);
        corners(y + 1, above);
        const float inv_count = 1.0f / static_cast<float>(finer_ * finer_);
        const float theta = kPi * (1.0f - (static_cast<float>(y) + 0.5f) / static_cast<float>(height_));
        const float sin_theta = std::sin(theta);
        for (uint32_t x = 0; x < width_; ++x) {
            float sum = 0.0f;
            for (uint32_t j = 0; j < finer_; ++j)
                for (uint32_t i = 0; i < finer_; ++i)
                    sum += brightness(static_cast<float>(x * finer_ + i) + 0.5f,
                                      static_cast<float>(y * finer_ + j) + 0.5f);
            const float corner = 0.25f * (below[x] + below[x + 1] + above[x] + above[x + 1]);
            values_[static_cast<size_t>(y) * width_ + x] = 0.5f * (sum * inv_count + corner) * sin_theta;
        }
    }

    const Material& material_;
    std::span<const Image> images_;
    uint32_t width_, height_;
    uint32_t finer_;  // texels of the image to a cell, each way
    std::vector<float> values_;
    Spectrum first_{0.0f};
    std::atomic<bool> constant_ = true;  // every direction looked at shows the colour of the first
};

// Without an image, whatever varies does so over angles that this many directions do not miss.
bool looks_constant(const Material& material) {
    constexpr uint32_t kDirections = 4096;
    constexpr float kGolden = 0.618034f;
    const Spectrum color = evaluate_background(material, {}, Vec3(0.0f, 0.0f, 1.0f));
    for (uint32_t i = 0; i < kDirections; ++i) {
        const float turn = static_cast<float>(i) * kGolden;
        const Vec2 u((static_cast<float>(i) + 0.5f) / kDirections, turn - std::floor(turn));
        if (evaluate_background(material, {}, uniform_sphere(u)) != color) return false;
    }
    return true;
}

void set_constant(const Spectrum& color, LightSet& lights) {
    lights.world_is_constant = true;
    lights.world_constant = color;
    lights.has_world = luminance(color) > 0.0f;
}

}  // namespace

void build_world(const Scene& scene, LightSet& lights) {
    if (scene.environment.material == kNone) return;
    const Material& material = scene.materials[scene.environment.material];
    if (scene.images.empty() && looks_constant(material)) {
        set_constant(evaluate_background(material, {}, Vec3(0.0f, 0.0f, 1.0f)), lights);
        return;
    }
    Tabulation table(scene);
    table.run();
    if (table.constant()) {
        set_constant(table.first(), lights);
        return;
    }
    double sum = 0.0;
    for (const float value : table.values()) sum += value;
    if (!(sum > 0.0)) return;
    lights.has_world = true;
    // The floor is spread evenly over solid angle; the mean of sin theta is 2 / pi.
    const auto mean = static_cast<float>(sum / static_cast<double>(table.values().size()));
    for (uint32_t y = 0; y < table.height(); ++y) {
        const float sin_theta = std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(table.height()));
        const float least = kDensityFloor * mean * 0.5f * kPi * sin_theta;
        for (uint32_t x = 0; x < table.width(); ++x) {
            float& value = table.values()[static_cast<size_t>(y) * table.width() + x];
            value = std::max(value, least);
        }
    }
    lights.world_map = Distribution2D(table.values(), table.width(), table.height());
}

double world_total(const LightSet& lights) {
    constexpr double pi = std::numbers::pi;
    if (!lights.has_world) return 0.0;
    if (lights.world_is_constant) return 4.0 * pi * luminance(lights.world_constant);
    return 2.0 * pi * pi * lights.world_map.mean();
}

std::optional<WorldSample> sample_world(const LightSet& lights, const Vec2& u) {
    if (lights.world_is_constant) return WorldSample{uniform_sphere(u), kUniformSpherePdf};
    const Distribution2D::Sample s = lights.world_map.sample(u);
    const Vec3 wi = to_direction(s.position);
    const float sin_theta = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    if (!(sin_theta > 0.0f)) return std::nullopt;
    return WorldSample{wi, to_omega(s.pdf, sin_theta)};
}

float world_pdf(const LightSet& lights, const Vec3& wi) {
    if (lights.world_is_constant) return kUniformSpherePdf;
    const float sin_theta = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    if (!(sin_theta > 0.0f)) return 0.0f;
    // atan2 keeps the digits near the poles that acos loses.
    const Vec2 position(0.5f - std::atan2(wi.y, wi.x) * (0.5f * kInvPi),
                        1.0f - std::atan2(sin_theta, wi.z) * kInvPi);
    return to_omega(lights.world_map.pdf(position), sin_theta);
}

}  // namespace spc
