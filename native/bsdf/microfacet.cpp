// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/microfacet.h"

namespace spc {
namespace {

constexpr float kInvSqrtPi = std::numbers::inv_sqrtpi_v<float>;
// Slopes of a unit-roughness Beckmann surface beyond this have probability 1.5e-12.
constexpr float kFarSlope = 5.0f;

// Inverse error function to a few parts in a thousand [Winitzki08]: a start for Newton's method.
float inverse_erf_guess(float y) {
    constexpr float kA = 0.147f;
    const float log_term = std::log(std::max((1.0f - y) * (1.0f + y), 1e-30f));
    const float b = 2.0f / (kPi * kA) + 0.5f * log_term;
    return std::copysign(safe_sqrt(std::sqrt(b * b - log_term / kA) - b), y);
}

// Slope x along wo of the visible facets of a unit-roughness surface: root of g(x) = u g(cot),
// where g(x) = 1 + erf(x) + tan exp(-x^2) / sqrt(pi) is the unnormalised distribution up to the
// facets that turn away at x = cot [Heitz14b]. With tan = 0 it is a plain Gaussian. Newton's method
// inside a shrinking bracket, started where exp(-x^2) = 1 - erf(x)^2 would solve it [Jakob14].
float sample_visible_slope(float tan_o, float u) {
    constexpr int kMaxSteps = 40;
    constexpr float kLastStep =
        5e-4f;  // of a slope of order 1; convergence is quadratic, so what is left is 1e-6
    const float k = tan_o * kInvSqrtPi;
    const auto distribution = [&](float x) { return std::erfc(-x) + k * std::exp(-x * x); };
    float low = -kFarSlope;
    float high = tan_o * kFarSlope > 1.0f ? 1.0f / tan_o : kFarSlope;
    const float target = u * distribution(high);

    const float erf_high = std::erf(high);
    const float offset = u * (1.0f + erf_high + k * (1.0f - erf_high * erf_high)) - 1.0f - k;
    const float erf_start = 2.0f * offset / (1.0f + safe_sqrt(1.0f - 4.0f * k * offset));
    float x = inverse_erf_guess(std::clamp(erf_start, -1.0f, 1.0f));
    if (!(x > low && x < high)) x = 0.5f * (low + high);

    for (int step = 0; step < kMaxSteps; ++step) {
        const float density = std::exp(-x * x);
        const float residual = std::erfc(-x) + k * density - target;
        (residual > 0.0f ? high : low) = x;
        const float slope = 2.0f * kInvSqrtPi * density * (1.0f - x * tan_o);
        float next = x - residual / slope;
        if (!(next >= low && next <= high)) next = 0.5f * (low + high);
        if (std::abs(next - x) <= kLastStep) return next;
        x = next;
    }
    return x;
}

}  // namespace

float beckmann_lambda_cos(float alpha, float cos_theta) {
    const float alpha_sin = alpha * safe_sqrt(1.0f - cos_theta * cos_theta);
    if (cos_theta >= 4.0f * alpha_sin) return 0.0f;  // Lambda(a = 4) is 2e-10
    const float a = cos_theta / alpha_sin;
    return std::max(0.5f * (std::exp(-a * a) * kInvSqrtPi * alpha_sin - cos_theta * std::erfc(a)),
                    0.0f);
}

Vec3 sample_beckmann_normal(float alpha, const Vec3& wo_local, const Vec2& u) {
    constexpr float kMaxTan =
        1e6f;  // of the stretched direction; beyond it the distribution no longer changes
    const float horizontal = std::sqrt(wo_local.x * wo_local.x + wo_local.y * wo_local.y);
    const Vec2 along =
        horizontal > 0.0f ? Vec2(wo_local.x, wo_local.y) * (1.0f / horizontal) : Vec2(1, 0);
    const float tan_o = std::min(alpha * horizontal / std::max(wo_local.z, 1e-20f), kMaxTan);
    const Vec2 slope(sample_visible_slope(tan_o, u.x), sample_visible_slope(0.0f, u.y));
    return normalize(Vec3(-alpha * (slope.x * along.x - slope.y * along.y),
                          -alpha * (slope.x * along.y + slope.y * along.x), 1.0f));
}

}  // namespace spc
