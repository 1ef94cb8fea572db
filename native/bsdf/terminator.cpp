// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/terminator.h"

namespace spc {
namespace {

// [Chiang19 Eq. 4]: a cubic in what is left of the light at the smooth surface.
float fade_smoothed(const Vec3& smooth_n, const Vec3& n, const Vec3& wi) {
    const float base = dot(n, wi) * dot(smooth_n, n);
    const float g = base != 0.0f ? dot(smooth_n, wi) / base : 0.0f;
    if (g >= 1.0f) return 1.0f;
    return g < 0.0f ? 0.0f : g * (1.0f + g * (1.0f - g));
}

// [Estevez19]: the map's slopes as those of a rough surface, whose masking G1 takes the light.
float fade_microfacet(const Vec3& smooth_n, const Vec3& n, const Vec3& wi) {
    constexpr float kGrazing = 1e-6f;
    const float smooth_i = dot(smooth_n, wi), between = dot(smooth_n, n);
    if (smooth_i * between * dot(n, wi) < 0.0f) return 0.0f;
    const float cos_i = std::abs(smooth_i), cos_n = std::abs(between);
    if (cos_n >= 1.0f || cos_i >= 1.0f) return 1.0f;
    if (cos_i < kGrazing) return 0.0f;
    const float alpha2 = clamp01(0.125f * (1.0f / sqr(cos_n) - 1.0f));
    return 2.0f / (1.0f + std::sqrt(1.0f + alpha2 * (1.0f / sqr(cos_i) - 1.0f)));
}

}  // namespace

// With z along ng and n in the plane of x and z: n' = (x, z) mirrors wo to the height `least` where
// 4 a z^4 - 2 b z^2 + c = 0; of both roots one belongs to the sign of wo's x.
Vec3 bent_normal(const Vec3& ng, const Vec3& wo, const Vec3& n) {
    const float o_z = dot(wo, ng);
    const float least = std::min(0.9f * o_z, 0.01f);  // a ray may leave as shallow as wo
    if (2.0f * dot(n, wo) * dot(n, ng) - o_z >= least) return n;
    const Vec3 across = n - ng * dot(n, ng);
    if (!(length_squared(across) > 0.0f)) return n;
    const Vec3 x = normalize(across);
    const float o_x = dot(wo, x);
    const float a = sqr(o_x) + sqr(o_z), b = 2.0f * (a + o_z * least), c = sqr(least + o_z);
    const float root = safe_sqrt(sqr(b) - 4.0f * a * c);
    const float z2 = 0.25f * (o_x < 0.0f ? b + root : b - root) / a;
    return x * safe_sqrt(1.0f - z2) + ng * safe_sqrt(z2);
}

float fade(const Terminator& terminator, const ClosureTraits& row, const Vec3& n, const Vec3& wi) {
    float factor = 1.0f;
    const float cos_i = dot(n, wi);
    if (terminator.stretch != 1.0f && cos_i > 0.0f) {
        const float angle = std::acos(std::min(cos_i, 1.0f));
        factor = std::max(std::cos(angle * terminator.stretch), 0.0f) / std::min(cos_i, 1.0f);
    }
    if (row.reflected != BounceKind::diffuse || n == terminator.smooth_n) return factor;
    switch (terminator.bump) {
        case BumpCorrection::none: break;
        case BumpCorrection::smoothed: return factor * fade_smoothed(terminator.smooth_n, n, wi);
        case BumpCorrection::microfacet:
            return factor * fade_microfacet(terminator.smooth_n, n, wi);
    }
    return factor;
}

}  // namespace spc
