// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics of a rough surface: density of normals D, Smith's masking G1 and shadowing G2 in
// the height-correlated form that Cycles uses [Heitz14 Eq. 99], and the sampling of visible
// normals.
#pragma once

#include "bsdf/closure.h"
#include "math/warp.h"

namespace spc {

// D(h), 1/sr, from the squared cosine and sine of the angle between h and the normal, both scaled
// by any common factor: an unnormalised half-vector H serves as it is, (n.H)^2 and |n x H|^2.
// Taking the sine from a cross product and not from 1 - cos^2 keeps its digits where alpha is
// small.
inline float normal_density(MicrofacetModel model, float alpha, float cos2, float sin2) {
    const float alpha2 = alpha * alpha;
    const float scale = cos2 + sin2;
    if (model == MicrofacetModel::ggx) return alpha2 * kInvPi * sqr(scale / (alpha2 * cos2 + sin2));
    return std::exp(-sin2 / (alpha2 * cos2)) * kInvPi / alpha2 * sqr(scale / cos2);
}

// The same of facets with an alpha along each axis [Heitz14 Sec. 5.4], from the components of h in
// the frame (tangent, n x tangent, n), scaled likewise.
inline float normal_density(MicrofacetModel model, const Vec2& alpha, const Vec3& h_local) {
    const float spread = sqr(h_local.x / alpha.x) + sqr(h_local.y / alpha.y), z2 = sqr(h_local.z);
    const float scale = length_squared(h_local) * kInvPi / (alpha.x * alpha.y);
    if (model == MicrofacetModel::ggx) return scale * length_squared(h_local) / sqr(spread + z2);
    return scale * length_squared(h_local) * std::exp(-spread / z2) / sqr(z2);
}
// The isotropic alpha whose masking is that of facets with two, seen from `w_local`.
inline float alpha_towards(const Vec2& alpha, const Vec3& w_local) {
    const float x2 = sqr(w_local.x), y2 = sqr(w_local.y);
    if (!(x2 + y2 > 0.0f)) return alpha.x;
    return std::sqrt((x2 * sqr(alpha.x) + y2 * sqr(alpha.y)) / (x2 + y2));
}

// Smith's Lambda times the cosine of the direction, cos > 0: finite at grazing angles, where Lambda
// is not. GGX [Heitz14 Eq. 72]; Beckmann exact [Heitz14] (Cycles uses a rational fit, 0.4 %
// off, but a density must integrate to 1).
float beckmann_lambda_cos(float alpha, float cos_theta);
inline float lambda_cos(MicrofacetModel model, float alpha, float cos_theta) {
    if (model == MicrofacetModel::beckmann) return beckmann_lambda_cos(alpha, cos_theta);
    const float cos2 = cos_theta * cos_theta;
    return 0.5f * (std::sqrt(cos2 + alpha * alpha * std::max(1.0f - cos2, 0.0f)) - cos_theta);
}

// G1(wo) / cos_o = 1 / (cos_o + lambda_cos_o) and G2(wo, wi) / cos_o, both cosines positive (the
// absolute value, for a transmitted wi).
struct Masking {
    float g1_by_cos_o, g2_by_cos_o;
};
inline Masking masking(MicrofacetModel model, float alpha_o, float alpha_i, float cos_o,
                       float cos_i) {
    const float a_o = cos_o + lambda_cos(model, alpha_o, cos_o);
    const float l_i = lambda_cos(model, alpha_i, cos_i);
    return {1.0f / a_o, cos_i / (a_o * cos_i + cos_o * l_i)};
}
inline Masking masking(MicrofacetModel model, float alpha, float cos_o, float cos_i) {
    return masking(model, alpha, alpha, cos_o, cos_i);
}

// A normal with density G1(wo) max(0, wo.m) D(m) / cos_o, in the frame where z is the macroscopic
// normal and wo_local.z > 0. GGX by spherical caps [Dupuy23], which draws from the distribution of
// [Heitz18]: reflections of wo at a hemisphere's visible normals are uniform over a cap.
Vec3 sample_beckmann_normal(float alpha, const Vec3& wo_local, const Vec2& u);
inline Vec3 sample_visible_ggx_normal(const Vec2& alpha, const Vec3& wo_local, const Vec2& u) {
    const Vec3 w = normalize(Vec3(alpha.x * wo_local.x, alpha.y * wo_local.y, wo_local.z));
    const float height = (1.0f - u.x) * (1.0f + w.z);  // of the half-vector, 0 .. 1 + w.z
    const float z = height - w.z;
    const float radius = safe_sqrt((1.0f - z) * (1.0f + z));
    const Vec2 c = unit_circle(u.y);
    return normalize(Vec3(alpha.x * (radius * c.x + w.x), alpha.y * (radius * c.y + w.y), height));
}
inline Vec3 sample_visible_normal(MicrofacetModel model, float alpha, const Vec3& wo_local,
                                  const Vec2& u) {
    if (model == MicrofacetModel::beckmann) return sample_beckmann_normal(alpha, wo_local, u);
    return sample_visible_ggx_normal(Vec2(alpha, alpha), wo_local, u);
}
// Stretched until both are 1, facets with an alpha along each axis are isotropic.
inline Vec3 sample_visible_normal(MicrofacetModel model, const Vec2& alpha, const Vec3& wo_local,
                                  const Vec2& u) {
    if (model == MicrofacetModel::ggx) return sample_visible_ggx_normal(alpha, wo_local, u);
    const Vec3 w = normalize(Vec3(alpha.x * wo_local.x, alpha.y * wo_local.y, wo_local.z));
    const Vec3 m = sample_beckmann_normal(1.0f, w, u);
    return normalize(Vec3(alpha.x * m.x, alpha.y * m.y, m.z));
}

}  // namespace spc
