// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/facet.h"

#include "bsdf/microfacet.h"

namespace spc {

namespace {

// Along no axis of anything: normals along it have no frame.
const Vec3 kAxis = normalize(Vec3(0.36f, 0.51f, 0.78f));
constexpr float kLeastSine = 1e-4f;  // of the angle to it

// The normal that mirrors or refracts wi to wo, not normalised, on either side.
Vec3 half_vector(Interaction interaction, float eta, const Vec3& wi, const Vec3& wo) {
    return wi + wo * (interaction == Interaction::reflection ? 1.0f : eta);
}

}  // namespace

Vec2 sample_facet(const SpecularInterface& interface, const Vec2& u) {
    const float tangent2 =
        interface.model == MicrofacetModel::ggx ? u.x / (1.0f - u.x) : -std::log(1.0f - u.x);
    return unit_circle(u.y) * (interface.alpha * std::sqrt(tangent2));
}

std::optional<Vec2> facet_between(const DifferentialGeometry& geometry, Interaction interaction,
                                  float eta, const Vec3& wi, const Vec3& wo) {
    const Vec3 h = half_vector(interaction, eta, wi, wo), &n = geometry.n;
    const Vec3 across = kAxis - n * dot(kAxis, n);
    const float sine = length(across), along = dot(h, n);
    if (!(sine > kLeastSine) || along == 0.0f) return std::nullopt;
    const Vec3 s = across * (1.0f / sine);
    return Vec2(dot(h, s), dot(h, cross(n, s))) / along;
}

void lean(DifferentialGeometry& geometry, const Vec2& slope) {
    const Vec3 n = geometry.n;
    const float cosine = dot(kAxis, n);
    const Vec3 across = kAxis - n * cosine;
    const float inv_sine = 1.0f / std::max(length(across), kLeastSine);
    const Vec3 s = across * inv_sine, t = cross(n, s);
    const Vec3 facet = n + s * slope.x + t * slope.y;
    const float inv = 1.0f / length(facet);
    geometry.n = facet * inv;
    const auto derivative = [&](const Vec3& dn) {
        const Vec3 turned = dn * -cosine - n * dot(kAxis, dn);
        const Vec3 ds = (turned - s * dot(s, turned)) * inv_sine;
        const Vec3 d = dn + ds * slope.x + (cross(dn, s) + cross(n, ds)) * slope.y;
        return (d - geometry.n * dot(geometry.n, d)) * inv;
    };
    geometry.dn_du = derivative(geometry.dn_du);
    geometry.dn_dv = derivative(geometry.dn_dv);
}

float facet_pdf(const SpecularInterface& interface, const DifferentialGeometry& geometry,
                Interaction interaction, float eta, const Vec3& wi, const Vec3& wo) {
    const Vec3 half = half_vector(interaction, eta, wi, wo);
    const float l = length(half);
    if (!(l > 0.0f)) return 0.0f;
    const Vec3 h = half * (1.0f / l);
    const float cosine = std::abs(dot(geometry.n, h));
    const float density = normal_density(interface.model, interface.alpha, sqr(cosine),
                                         length_squared(cross(geometry.n, h))) *
                          cosine;
    // [Walter07 Eq. 14, 17]
    return interaction == Interaction::reflection ? density / (4.0f * std::abs(dot(wi, h)))
                                                  : density * sqr(eta / l) * std::abs(dot(wo, h));
}

}  // namespace spc
