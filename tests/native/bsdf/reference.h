// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacet closures straight from the papers, in double and in terms of angles: what eval() and
// sample() are compared with. Shares no code with them.
#pragma once

#include "bsdf/closure.h"
#include "support/numerics.h"

namespace spc::test {

inline Vec3d to_double(const Vec3& v) { return {v.x, v.y, v.z}; }

inline double reference_d(MicrofacetModel model, double alpha, double cos_h) {
    const double pi = std::numbers::pi;
    if (cos_h <= 0) return 0;
    const double tan2 = 1 / (cos_h * cos_h) - 1, cos4 = std::pow(cos_h, 4), a2 = alpha * alpha;
    if (model == MicrofacetModel::ggx)
        return a2 / (pi * cos4 * std::pow(a2 + tan2, 2));  // [Walter07 Eq. 33]
    return std::exp(-tan2 / a2) / (pi * a2 * cos4);        // [Walter07 Eq. 25]
}
inline double reference_lambda(MicrofacetModel model, double alpha, double cos_theta) {
    const double tan_theta = std::sqrt(std::max(1 / (cos_theta * cos_theta) - 1, 0.0));
    if (tan_theta == 0) return 0;
    const double a = 1 / (alpha * tan_theta);
    if (model == MicrofacetModel::ggx)
        return 0.5 * (std::sqrt(1 + 1 / (a * a)) - 1);  // [Heitz14 Eq. 72]
    return 0.5 * (std::exp(-a * a) / (a * std::sqrt(std::numbers::pi)) -
                  std::erfc(a));  // [Heitz14 Eq. 66]
}
inline double reference_g2(MicrofacetModel model, double alpha, double cos_o, double cos_i) {
    return 1 / (1 + reference_lambda(model, alpha, cos_o) + reference_lambda(model, alpha, cos_i));
}
inline double reference_fresnel(double cos_i, double eta) {
    const double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin2_t);
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t),
                 p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

// Facets with an alpha along each axis, directions in the frame (tangent, n x tangent, n)
// [Heitz14 Eq. 84, 85, 80].
inline double reference_d(MicrofacetModel model, double ax, double ay, const Vec3d& h) {
    const double pi = std::numbers::pi;
    if (h.z <= 0) return 0;
    const double x = h.x / (ax * h.z), y = h.y / (ay * h.z), cos4 = std::pow(h.z, 4);
    if (model == MicrofacetModel::ggx)
        return 1 / (pi * ax * ay * cos4 * std::pow(1 + x * x + y * y, 2));
    return std::exp(-x * x - y * y) / (pi * ax * ay * cos4);
}
inline double reference_alpha(double ax, double ay, const Vec3d& w) {
    const double phi = std::atan2(w.y, w.x);
    return std::hypot(ax * std::cos(phi), ay * std::sin(phi));
}

// f |cos_i| of a white reflection times `reflectance(cos_facet)`.
template <class Reflectance>
double reference_reflection(MicrofacetModel model, double alpha, const Vec3d& n, const Vec3d& wo,
                            const Vec3d& wi, const Reflectance& reflectance) {
    const double cos_o = dot(n, wo), cos_i = dot(n, wi);
    if (cos_o <= 0 || cos_i <= 0) return 0;
    const Vec3d h = normalize(wo + wi);
    return reflectance(dot(wo, h)) * reference_d(model, alpha, dot(n, h)) *
           reference_g2(model, alpha, cos_o, cos_i) / (4 * cos_o);
}
// f |cos_i| of a transmission, with light coming from wi in a medium of index eta to wo in one of
// index 1: [Walter07 Eq. 21] for radiance, times eta^2 for basic radiance.
template <class Transmittance>
double reference_transmission(MicrofacetModel model, double alpha, double eta, const Vec3d& n,
                              const Vec3d& wo, const Vec3d& wi, const Transmittance& transmittance) {
    const double cos_o = dot(n, wo), cos_i = -dot(n, wi);
    if (cos_o <= 0 || cos_i <= 0) return 0;
    Vec3d h = normalize(wo + wi * eta);
    if (dot(h, n) < 0) h = -h;
    const double o_h = dot(wo, h), i_h = dot(wi, h);
    if (o_h <= 0 || i_h >= 0) return 0;
    const double walter = std::abs(i_h * o_h) / (cos_i * cos_o) * transmittance(o_h) *
                          reference_g2(model, alpha, cos_o, cos_i) *
                          reference_d(model, alpha, dot(n, h)) / std::pow(eta * i_h + o_h, 2);
    return walter * eta * eta * cos_i;
}

}  // namespace spc::test
