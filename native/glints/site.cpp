// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/site.h"

#include "bsdf/microfacet.h"

namespace spc {

GlintTarget::GlintTarget(const SlopeFrame& frame, const Vec3& half_vector) : half(half_vector) {
    const std::array<Vec3, 3>& w = frame.w;
    linear = {dot(w[0], half), dot(w[1], half), dot(w[2], half)};
    const Vec3 c0 = cross(w[0], half), c1 = cross(w[1], half);
    aa = dot(c0, c0);
    ab = dot(c0, c1);
    bb = dot(c1, c1);
    x_by_y = -ab / aa;
    y_by_x = -ab / bb;
    const Vec3 direction = frame.coordinates(half);
    inside = direction.z > 1e-6f;
    slope = inside ? slope_of(direction) : Vec2(0.0f, 0.0f);
}

SlopeMetric::SlopeMetric(const GlintTarget& target)
    : scale(1.0f / sqr(target.dot_at(target.slope))),
      aa(target.aa * scale),
      ab(target.ab * scale),
      bb(target.bb * scale) {}

float GlintSite::scale(int i, float cos_wo_h) const {
    const GlintLobe& glint = lobe(i);
    return mean(glint.weight) * mean(fresnel(glint.lobe.fresnel, cos_wo_h));
}

// A lobe sees the angle^2 as d^T Q d; the variance of its normals is half of alpha^2 in each
// direction.
float GlintSite::normal_slopes_density(float alpha, const GlintTarget& t) const {
    if (!t.inside) return 0.0f;
    const SlopeMetric q(t);
    const float spread = 0.5f * sqr(alpha) / q.det();
    const float saa = moments.aa + spread * q.bb, sab = moments.ab - spread * q.ab,
                sbb = moments.bb + spread * q.aa;
    const float det_s = saa * sbb - sab * sab;
    const Vec2 d = t.slope - moments.mean;
    const float m = (sbb * d.x * d.x - 2.0f * sab * d.x * d.y + saa * d.y * d.y) / det_s;
    const float density = std::exp(-0.5f * m) * 0.5f * kInvPi / std::sqrt(det_s * q.det());
    return std::isfinite(density) ? density : 0.0f;
}

float GlintSite::mean_density(const GlintLobe& glint, const GlintTarget& t) const {
    const MicrofacetReflection& lobe = glint.lobe;
    const float dot_mean = t.dot_at(moments.mean);
    const float tail =
        dot_mean > 0.0f ? normal_density(lobe.model, lobe.alpha, sqr(dot_mean),
                                         length_squared(cross(frame.normal(moments.mean), t.half)))
                        : 0.0f;
    return normal_slopes_density(lobe.alpha, t) + tail;
}

}  // namespace spc
