// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/chain.h"

namespace spc {

namespace {

// A direction and its derivatives by the surface parameters.
struct DirectionDual {
    Vec3 w, dw_du, dw_dv;
};

// Unit direction from the moving vertex to a fixed point at `distance`; a distant end does not
// turn.
DirectionDual direction_to(const Vec3& w, float distance, const DifferentialGeometry& vertex) {
    const float inv = std::isinf(distance) ? 0.0f : 1.0f / distance;
    return {w, (w * dot(w, vertex.dp_du) - vertex.dp_du) * inv,
            (w * dot(w, vertex.dp_dv) - vertex.dp_dv) * inv};
}

std::optional<ConstraintValue> half_vector(Interaction interaction, float eta,
                                           const DirectionDual& wi, const DirectionDual& wo,
                                           const DifferentialGeometry& vertex) {
    // [Walter07 Eq. 16], unnormalised; its sign does not matter to a root.
    const float scale = interaction == Interaction::reflection ? 1.0f : eta;
    const Vec3 sum = wi.w + wo.w * scale;
    const float l = length(sum);
    if (!(l > 1e-6f)) return std::nullopt;  // opposite directions through no interface
    const Vec3 h = sum * (1.0f / l);
    const Frame frame = Frame::around(vertex.n);
    const float nh = dot(vertex.n, h);
    // The frame follows the normal without spin: ds = -(s . dn) n.
    const auto derivative = [&](const Vec3& dwi, const Vec3& dwo, const Vec3& dn) {
        const Vec3 dsum = dwi + dwo * scale;
        const Vec3 dh = (dsum - h * dot(h, dsum)) * (1.0f / l);
        return Vec2(dot(frame.x, dh) - dot(frame.x, dn) * nh,
                    dot(frame.y, dh) - dot(frame.y, dn) * nh);
    };
    return ConstraintValue{Vec2(dot(frame.x, h), dot(frame.y, h)),
                           derivative(wi.dw_du, wo.dw_du, vertex.dn_du),
                           derivative(wi.dw_dv, wo.dw_dv, vertex.dn_dv), 1.0f / l};
}

// Direction into which light from wi leaves, with derivatives. Empty at total internal reflection.
std::optional<DirectionDual> scattered(Interaction interaction, float eta, const DirectionDual& wi,
                                       const DifferentialGeometry& vertex) {
    const Vec3& n = vertex.n;
    const float cos_i = dot(wi.w, n);
    if (interaction == Interaction::reflection) {
        const auto derivative = [&](const Vec3& dw, const Vec3& dn) {
            return n * (2.0f * (dot(dw, n) + dot(wi.w, dn))) + dn * (2.0f * cos_i) - dw;
        };
        return DirectionDual{n * (2.0f * cos_i) - wi.w, derivative(wi.dw_du, vertex.dn_du),
                             derivative(wi.dw_dv, vertex.dn_dv)};
    }
    // w' = -wi/eta + mu n with mu = cos_i/eta - sign(cos_i) cos_t.
    const float inv = 1.0f / eta;
    const float cos2_t = 1.0f - inv * inv * (1.0f - cos_i * cos_i);
    if (!(cos2_t > 1e-6f)) return std::nullopt;
    const float cos_t = std::copysign(std::sqrt(cos2_t), cos_i);
    const float mu = cos_i * inv - cos_t;
    const float dmu_dcos = inv - inv * inv * cos_i / cos_t;
    const auto derivative = [&](const Vec3& dw, const Vec3& dn) {
        return dw * -inv + n * (dmu_dcos * (dot(dw, n) + dot(wi.w, dn))) + dn * mu;
    };
    return DirectionDual{wi.w * -inv + n * mu, derivative(wi.dw_du, vertex.dn_du),
                         derivative(wi.dw_dv, vertex.dn_dv)};
}

std::optional<ConstraintValue> angle_difference(Interaction interaction, float eta,
                                                const DirectionDual& wi, const DirectionDual& wo,
                                                const DifferentialGeometry& vertex) {
    const std::optional<DirectionDual> s = scattered(interaction, eta, wi, vertex);
    if (!s) return std::nullopt;
    // Stereographic, 2 tan(angle / 2) along the plane across wo: no pole near a solution, nothing
    // to wrap.
    const Frame frame = Frame::around(wo.w);
    const float cosine = dot(s->w, wo.w), scale = 2.0f / std::max(1.0f + cosine, 1e-6f);
    const Vec2 c(scale * dot(s->w, frame.x), scale * dot(s->w, frame.y));
    // The frame follows wo without spin: dx = -(x . dwo) wo.
    const auto derivative = [&](const Vec3& ds, const Vec3& dwo) {
        const float closer = 0.5f * (dot(ds, wo.w) + dot(s->w, dwo));
        return Vec2(scale * (dot(ds, frame.x) - dot(dwo, frame.x) * cosine - c.x * closer),
                    scale * (dot(ds, frame.y) - dot(dwo, frame.y) * cosine - c.y * closer));
    };
    // Near the critical angle the refracted direction magnifies every error by 1 / cos_t.
    const float magnified =
        interaction == Interaction::refraction ? 1.0f / std::abs(dot(s->w, vertex.n)) : 1.0f;
    return ConstraintValue{c, derivative(s->dw_du, wo.dw_du), derivative(s->dw_dv, wo.dw_dv),
                           magnified};
}

}  // namespace

bool has_interaction(const SpecularInterface& specular, Interaction interaction) {
    return interaction == Interaction::reflection ? specular.reflects : specular.refracts;
}

bool sides_agree(const DifferentialGeometry& geometry, const Vec3& wi, const Vec3& wo,
                 Interaction interaction) {
    const float geometric = dot(geometry.ng, wi) * dot(geometry.ng, wo),
                shading = dot(geometry.n, wi) * dot(geometry.n, wo);
    return interaction == Interaction::reflection ? geometric > 0.0f && shading > 0.0f
                                                  : geometric < 0.0f && shading < 0.0f;
}

float eta_seen_from(const Vec3& front_ng, const Vec3& towards, float ior) {
    return dot(front_ng, towards) >= 0.0f ? ior : 1.0f / ior;
}

Constraint constraint_for(Constraint preferred, Interaction interaction, float eta) {
    constexpr float kNoHalfVector = 1e-3f;  // |eta - 1| below which few of its digits are left
    const bool no_half_vector =
        interaction == Interaction::refraction && std::abs(eta - 1.0f) < kNoHalfVector;
    return no_half_vector ? Constraint::angle_difference : preferred;
}

std::optional<ConstraintValue> evaluate_constraint(Constraint constraint, Interaction interaction,
                                                   float eta, const Vec3& x,
                                                   const DifferentialGeometry& vertex,
                                                   const ChainEnd& end) {
    const Vec3 to_x = x - vertex.p;
    const float distance_x = length(to_x);
    float distance_y = 0.0f;
    const Vec3 wo = end.from(vertex.p, distance_y);
    if (!(distance_x > 0.0f) || !(distance_y > 0.0f)) return std::nullopt;
    const DirectionDual wi_dual = direction_to(to_x * (1.0f / distance_x), distance_x, vertex);
    const DirectionDual wo_dual = direction_to(wo, distance_y, vertex);
    std::optional<ConstraintValue> value =
        constraint == Constraint::half_vector
            ? half_vector(interaction, eta, wi_dual, wo_dual, vertex)
            : angle_difference(interaction, eta, wi_dual, wo_dual, vertex);
    if (value) {
        // The two see directions of this error; so far `noise` holds how much each magnifies it.
        value->noise *=
            kUnitRoundoff * (2.0f + std::max(largest_coordinate(x), largest_coordinate(vertex.p)) /
                                        std::min(distance_x, distance_y));
        // A vertex is where a ray from x meets the surface: at a grazing angle it slips far. And
        // barycentrics have a spacing of their own, which a detailed normal map magnifies.
        const float cosine = std::abs(dot(vertex.ng, to_x)) / distance_x;
        const float slip = distance_x / std::max(cosine, 1e-3f);
        value->noise += 0x1p-24f * (value->dc_du.length() * (1.0f + slip / length(vertex.dp_du)) +
                                    value->dc_dv.length() * (1.0f + slip / length(vertex.dp_dv)));
    }
    return value;
}

RayDual ray_dual_from(const Vec3& w) {
    const Frame frame = Frame::around(w);
    return {Vec3d(w), {Vec3d(0.0), Vec3d(0.0)}, {Vec3d(frame.x), Vec3d(frame.y)}};
}

bool propagate_through_vertex(const ChainVertex& vertex, double distance, RayDual& ray) {
    const DifferentialGeometry& geometry = vertex.geometry;
    const Vec3d pu(geometry.dp_du), pv(geometry.dp_dv), nu(geometry.dn_du), nv(geometry.dn_dv),
        ng(geometry.ng);
    const Vec3d d = ray.d;
    // The normal on the side that the ray comes from.
    const double side = dot(Vec3d(geometry.n), d) > 0.0 ? -1.0 : 1.0;
    const Vec3d n = Vec3d(geometry.n) * side;
    const double dn = dot(d, n), dng = dot(d, ng);
    if (std::abs(dng) < 1e-9 || std::abs(dn) < 1e-9) return false;

    const bool reflects = vertex.interaction == Interaction::reflection;
    double mu = 0.0, dmu_factor = 0.0;
    // Index in front over behind.
    const double ratio = reflects ? 1.0 : 1.0 / static_cast<double>(vertex.eta);
    if (reflects) {
        ray.d = d - n * (2.0 * dn);
    } else {
        const double cos2 = 1.0 - ratio * ratio * (1.0 - dn * dn);
        if (cos2 <= 0.0) return false;
        const double dn_out = -std::sqrt(cos2);  // d' . n
        mu = ratio * dn - dn_out;
        dmu_factor = ratio - ratio * ratio * dn / dn_out;
        ray.d = d * ratio - n * mu;
    }
    const double out_n = dot(ray.d, n), out_ng = dot(ray.d, ng);
    // Projected solid angles by the normal that bends, over those by the geometry.
    ray.etendue *= ratio * ratio * std::abs(out_ng * dn / (out_n * dng));

    const double uu = dot(pu, pu), uv = dot(pu, pv), vv = dot(pv, pv), det_uv = uu * vv - uv * uv;
    for (size_t j = 0; j < 2; ++j) {
        const Vec3d dd = ray.dd[j];
        const Vec3d free = ray.dp[j] + dd * distance;
        const Vec3d dp = free - d * (dot(free, ng) / dng);
        const double bu = dot(dp, pu), bv = dot(dp, pv);
        const double du = (bu * vv - bv * uv) / det_uv, dv = (bv * uu - bu * uv) / det_uv;
        const Vec3d dnormal = (nu * du + nv * dv) * side;
        const double dcos = dot(dd, n) + dot(d, dnormal);
        ray.dp[j] = dp;
        ray.dd[j] = reflects ? dd - (dnormal * dn + n * dcos) * 2.0
                             : dd * ratio - (n * (dmu_factor * dcos) + dnormal * mu);
    }
    return true;
}

std::optional<ChainDerivative> chain_derivative(const Vec3& x, std::span<const ChainVertex> chain,
                                                const ChainEnd& end) {
    Vec3d from(x);
    float unused;
    RayDual ray =
        ray_dual_from(chain.empty() ? end.from(x, unused) : normalize(chain.front().geometry.p - x));
    for (const ChainVertex& vertex : chain) {
        const Vec3d along = Vec3d(vertex.geometry.p) - from;
        const double distance = length(along);
        ray.d = along / distance;
        if (!propagate_through_vertex(vertex, distance, ray)) return std::nullopt;
        from = Vec3d(vertex.geometry.p);
    }
    const Frame frame = Frame::around(Vec3(ray.d));
    const Vec3d e1(frame.x), e2(frame.y);
    const double distance = end.distant ? 0.0 : length(Vec3d(end.p) - from);
    const auto landing = [&](size_t j) {
        return end.distant ? ray.dd[j] : ray.dp[j] + ray.dd[j] * distance;
    };
    const Vec3d dq1 = landing(0), dq2 = landing(1);
    const double det = std::abs(dot(e1, dq1) * dot(e2, dq2) - dot(e2, dq1) * dot(e1, dq2));
    // On a fold all light of the chain meets: the density there is infinite, but nothing ever
    // samples it exactly.
    return ChainDerivative{1.0 / std::max(det, 1e-30), ray.etendue};
}

}  // namespace spc
