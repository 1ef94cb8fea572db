// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/ashikhmin_shirley.h"

#include "math/warp.h"

namespace spc {
namespace {

// Of the cosine between half-vector and normal, along either axis.
float exponent_of(float alpha) { return 2.0f / sqr(std::min(alpha, 1.0f)) - 2.0f; }

Frame frame_of(const AshikhminShirley& c) {
    return c.alpha == c.alpha_y ? Frame::around(c.n) : Frame{c.tangent, cross(c.n, c.tangent), c.n};
}

}  // namespace

// f cos_i = p(h) cos_i / (4 h.wo max(cos_i, cos_o)), pdf = p(h) / (4 h.wo)  [Ashikhmin00 Eq. 4, 8],
// where p is the normalised density of the half-vector.
LobeEval eval_lobe(const AshikhminShirley& c, const Vec3& wo, const Vec3& wi, bool crosses) {
    const float cos_o = dot(c.n, wo), cos_i = dot(c.n, wi);
    if (crosses || !(cos_o > 0.0f) || !(cos_i > 0.0f)) return {};
    const Vec3 half = normalize(wo + wi), h = frame_of(c).to_local(half);
    const float o_h = dot(wo, half), across = sqr(h.x) + sqr(h.y);
    if (!(h.z > 0.0f) || !(o_h > 0.0f)) return {};
    const float nx = exponent_of(c.alpha), ny = exponent_of(c.alpha_y);
    const float n = across > 0.0f ? (nx * sqr(h.x) + ny * sqr(h.y)) / across : 0.0f;
    const float density =
        std::sqrt((nx + 1.0f) * (ny + 1.0f)) * 0.5f * kInvPi * std::pow(std::min(h.z, 1.0f), n);
    const float pdf = 0.25f * density / o_h;
    return {Spectrum(pdf * cos_i / std::max(cos_i, cos_o)), pdf};
}

// The azimuth of a quarter, turned into the other three; then a power of the cosine.
std::optional<LobeSample> sample_lobe(const AshikhminShirley& c, const Vec3& wo, float,
                                      const Vec2& u) {
    if (!(dot(c.n, wo) > 0.0f)) return std::nullopt;
    const float nx = exponent_of(c.alpha), ny = exponent_of(c.alpha_y);
    const Vec2 turn = unit_circle(u.x);
    const Vec2 stretched(turn.x * std::sqrt(ny + 1.0f), turn.y * std::sqrt(nx + 1.0f));
    const Vec2 d = stretched * (1.0f / std::sqrt(sqr(stretched.x) + sqr(stretched.y)));
    const float n = nx * sqr(d.x) + ny * sqr(d.y);
    const float z = std::pow(1.0f - u.y, 1.0f / (n + 1.0f));
    const float s = safe_sqrt((1.0f - z) * (1.0f + z));
    const Vec3 h = frame_of(c).to_world(Vec3(d.x * s, d.y * s, z));
    const float o_h = dot(wo, h);
    const Vec3 wi = h * (2.0f * o_h) - wo;
    if (!(o_h > 0.0f) || !(dot(c.n, wi) > 0.0f)) return std::nullopt;
    return LobeSample{wi, BounceKind::glossy};
}

Spectrum albedo_of(const AshikhminShirley& c, const Vec3& wo) {
    return Spectrum(dot(c.n, wo) > 0.0f ? 1.0f : 0.0f);
}

}  // namespace spc
