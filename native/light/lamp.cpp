// SPDX-License-Identifier: GPL-3.0-or-later
// Units: from Blender's power P to what a lamp sends out, confirmed against Cycles 5.0.1 to 5
// digits by the irradiance on a diffuse plane:
//   point, radius 0   intensity  P / (4 pi)
//   point, radius r   radiance   P / (4 pi^2 r^2) from a sphere; from inside it too
//   spot              the same times smoothstep((cos - cos_half) / ((1 - cos_half) blend)), cos in
//                     the lamp's own, possibly scaled, space: the power is that of the point lamp
//                     which the beam is cut from. Inside the sphere it shines everywhere
//   sun               irradiance P across its direction; disc of half angle h: P / (pi sin^2 h)
//   area              radiance   P / (pi area) on one side; the area includes the transform's scale
//   spread s          the same times max(tan h - tan a, 0) / (tan h - h), h = s / 2, at the angle a
//                     with the normal
// The lamps' scale changes nothing but areas, and beams where it is uneven. With "soft falloff" a
// disk of the sphere's radiance faces the receiver: E d^2 / (d^2 + r^2) instead of E.
#include "light/lamp.h"

#include "light/rectangle.h"
#include "math/warp.h"

namespace spc {
namespace {

// A rectangle whose half diagonal is below this share of the distance is sampled by area: the
// density then varies by 15 % at most, and trigonometry is saved.
constexpr float kFarRectangle = 0.05f;

float smoothstep(float t) {
    const float s = clamp01(t);
    return s * s * (3.0f - 2.0f * s);
}

SpreadProfile make_spread(float spread) {
    const double half = 0.5 * static_cast<double>(std::max(spread, kLeastSpread));
    // Closer to a right angle single precision cannot tell the profile from an even one.
    constexpr double kEven = 0.5 * std::numbers::pi - 1e-6;
    if (half > kEven) return {};
    const double tan_half = std::tan(half);
    return {false, static_cast<float>(tan_half), static_cast<float>(1.0 / (tan_half - half))};
}

Spectrum scaled(const Spectrum& power, double factor) { return power * static_cast<float>(factor); }

// Squared sine of the cone that a lamp fills from a distance, whose square is d2, from outside.
float sine_squared(const SphereLamp& lamp, float d2) {
    const float r2 = lamp.radius * lamp.radius;
    return lamp.soft ? r2 / (d2 + r2) : r2 / d2;
}

// How far a sphere is along a direction whose angle with that to its centre, d away, has this
// cosine and squared sine.
float distance_to_sphere(float d, float radius, float cos, float sin2) {
    return d * cos - safe_sqrt(radius * radius - d * d * sin2);
}

float one_minus_cos_of(float sin2) { return sin2 / (1.0f + safe_sqrt(1.0f - sin2)); }

// Along a direction as for distance_to_sphere.
float distance_to(const SphereLamp& lamp, float d, float cos, float sin2) {
    return lamp.soft ? d / cos : distance_to_sphere(d, lamp.radius, cos, sin2);
}

// Whether p is inside, from where a hard lamp shines all around.
bool is_inside(const SphereLamp& lamp, float d2) {
    return !lamp.soft && !(d2 > lamp.radius * lamp.radius);
}

bool is_seen(const SphereLamp& lamp, const Vec3& p, const Vec3& wi) {
    const Vec3 to_center = lamp.center - p;
    const float along = dot(to_center, wi), d2 = length_squared(to_center);
    return along > 0.0f && length_squared(to_center - wi * along) <= d2 * sine_squared(lamp, d2);
}

// A narrow beam from a sphere that fills a wider cone is sampled by the beam's directions instead.
bool by_beam(const SphereLamp& lamp, float sphere_cone) {
    return !lamp.profile.uniform && 1.0f - lamp.profile.cos_widest < sphere_cone;
}

std::optional<LampSample> sample_one(const PointLamp& lamp, const Vec3& p, const Vec2&) {
    const Vec3 to_lamp = lamp.center - p;
    const float d2 = length_squared(to_lamp);
    if (!(d2 > 0.0f)) return std::nullopt;
    const float d = std::sqrt(d2);
    const Vec3 wi = to_lamp * (1.0f / d);
    const float profile = lamp.profile.towards(wi * -1.0f);
    if (!(profile > 0.0f)) return std::nullopt;
    return LampSample{wi, d, lamp.intensity * (profile / d2), 1.0f, true};
}

std::optional<LampSample> sample_one(const SphereLamp& lamp, const Vec3& p, const Vec2& u) {
    const Vec3 to_center = lamp.center - p;
    const float d2 = length_squared(to_center);
    if (!(d2 > 0.0f) && lamp.soft) return std::nullopt;
    if (is_inside(lamp, d2)) {
        const Vec3 wi = uniform_sphere(u);
        const float along = dot(wi, to_center);
        const float t =
            along + safe_sqrt(lamp.radius * lamp.radius - length_squared(to_center - wi * along));
        return LampSample{wi, t, lamp.radiance, kUniformSpherePdf, false};
    }
    const float d = std::sqrt(d2);
    const float widest = sine_squared(lamp, d2), cone = one_minus_cos_of(widest);
    const Vec3 center_direction = to_center * (1.0f / d);
    if (by_beam(lamp, cone)) {
        const float beam = 1.0f - lamp.profile.cos_widest;
        const Vec3 wi = Frame::around(lamp.profile.z * -1.0f).to_world(uniform_cone(u, beam));
        const float profile = lamp.profile.towards(wi * -1.0f);
        const float cos = dot(wi, center_direction);
        const float sin2 = length_squared(center_direction - wi * cos);
        if (!(profile > 0.0f && cos > 0.0f && sin2 < widest)) return std::nullopt;
        return LampSample{wi, distance_to(lamp, d, cos, sin2), lamp.radiance * profile,
                          uniform_cone_pdf(beam), false};
    }
    const Vec3 local = uniform_cone(u, cone);
    const Vec3 wi = Frame::around(center_direction).to_world(local);
    const float profile = lamp.profile.towards(wi * -1.0f);
    if (!(profile > 0.0f)) return std::nullopt;
    const float sin2 = local.x * local.x + local.y * local.y;
    return LampSample{wi, distance_to(lamp, d, local.z, sin2), lamp.radiance * profile,
                      uniform_cone_pdf(cone), false};
}

std::optional<LampSample> sample_one(const ParallelSun& lamp, const Vec3&, const Vec2&) {
    return LampSample{lamp.direction, kInfinity, lamp.irradiance, 1.0f, true};
}

std::optional<LampSample> sample_one(const DiscSun& lamp, const Vec3&, const Vec2& u) {
    return LampSample{lamp.frame.to_world(uniform_cone(u, lamp.one_minus_cos)), kInfinity,
                      lamp.radiance, uniform_cone_pdf(lamp.one_minus_cos), false};
}

// The rectangle as p sees it, if it is to be sampled by solid angle. `height` is p's distance to
// its plane.
std::optional<SphericalRectangle> near_rectangle(const AreaLamp& lamp, const Vec3& from_p,
                                                 float height) {
    if (!(length_squared(from_p) < lamp.near_squared)) return std::nullopt;
    const float x = dot(from_p, lamp.axis_x), y = dot(from_p, lamp.axis_y);
    const SphericalRectangle rectangle(x - lamp.length_x, x + lamp.length_x, y - lamp.length_y,
                                       y + lamp.length_y, height);
    if (!(rectangle.solid_angle > kLeastRectangleSolidAngle)) return std::nullopt;
    return rectangle;
}

// Radius of the circle around the foot of the perpendicular from which light gets to a receiver at
// this height, if that is a smaller part of the lamp's plane than the lamp: it is sampled instead.
std::optional<float> lit_radius(const AreaLamp& lamp, float height) {
    const float radius = height * lamp.spread.tan_half;
    if (lamp.spread.uniform || !(kPi * sqr(radius) < lamp.area)) return std::nullopt;
    return radius;
}

bool is_on(const AreaLamp& lamp, const Vec3& from_center) {
    const float a = dot(from_center, lamp.dual_x), b = dot(from_center, lamp.dual_y);
    return lamp.ellipse ? a * a + b * b <= 1.0f : std::abs(a) <= 1.0f && std::abs(b) <= 1.0f;
}

// A point of the lamp as a receiver sees it, with its density by area or by solid angle.
struct SeenPoint {
    Vec3 to_q;
    float pdf_area, pdf_omega;  // one of them is 0
};
std::optional<SeenPoint> sample_seen(const AreaLamp& lamp, const Vec3& to_center, float height,
                                     const Vec2& u) {
    if (const auto radius = lit_radius(lamp, height)) {
        const Vec2 q = concentric_disk(u) * *radius;
        const Vec3 to_q =
            lamp.axis_x * q.x + cross(lamp.normal, lamp.axis_x) * q.y - lamp.normal * height;
        if (!is_on(lamp, to_q - to_center)) return std::nullopt;
        return SeenPoint{to_q, kInvPi / sqr(*radius), 0.0f};
    }
    if (const auto rectangle = near_rectangle(lamp, to_center, height)) {
        const Vec2 q = rectangle->sample(u);
        return SeenPoint{lamp.axis_x * q.x + lamp.axis_y * q.y - lamp.normal * height, 0.0f,
                         1.0f / rectangle->solid_angle};
    }
    const Vec2 q = lamp.ellipse ? concentric_disk(u) : Vec2(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f);
    return SeenPoint{to_center + lamp.half_x * q.x + lamp.half_y * q.y, 1.0f / lamp.area, 0.0f};
}

std::optional<LampSample> sample_one(const AreaLamp& lamp, const Vec3& p, const Vec2& u) {
    const Vec3 to_center = lamp.center - p;
    const float height = -dot(to_center, lamp.normal);
    if (!(height > 0.0f)) return std::nullopt;
    const std::optional<SeenPoint> seen = sample_seen(lamp, to_center, height, u);
    if (!seen) return std::nullopt;
    const float d2 = length_squared(seen->to_q), d = std::sqrt(d2);
    const Vec3 wi = seen->to_q * (1.0f / d);
    const float profile = lamp.spread.towards(lamp.normal, wi * -1.0f);
    if (!(profile > 0.0f)) return std::nullopt;
    const float pdf_omega =
        seen->pdf_omega > 0.0f ? seen->pdf_omega : seen->pdf_area * d2 * d / height;
    return LampSample{wi, d, lamp.radiance * profile, pdf_omega, false};
}

float pdf_one(const PointLamp&, const Vec3&, const Vec3&, float) { return 0.0f; }
float pdf_one(const ParallelSun&, const Vec3&, const Vec3&, float) { return 0.0f; }
float pdf_one(const SphereLamp& lamp, const Vec3& p, const Vec3& wi, float) {
    const float d2 = length_squared(lamp.center - p);
    if (is_inside(lamp, d2)) return kUniformSpherePdf;
    if (!(lamp.profile.towards(wi * -1.0f) > 0.0f)) return 0.0f;
    // Of the points of the sphere only some show themselves.
    if (lamp.soft && !is_seen(lamp, p, wi)) return 0.0f;
    const float cone = one_minus_cos_of(sine_squared(lamp, d2));
    return uniform_cone_pdf(by_beam(lamp, cone) ? 1.0f - lamp.profile.cos_widest : cone);
}
float pdf_one(const DiscSun& lamp, const Vec3&, const Vec3& wi, float) {
    return in_disc(lamp, wi) ? uniform_cone_pdf(lamp.one_minus_cos) : 0.0f;
}
float pdf_one(const AreaLamp& lamp, const Vec3& p, const Vec3& wi, float distance) {
    const Vec3 to_center = lamp.center - p;
    const float height = -dot(to_center, lamp.normal);
    if (!(height > 0.0f && lamp.spread.towards(lamp.normal, wi * -1.0f) > 0.0f)) return 0.0f;
    const float by_area = distance * distance * distance / height;
    if (const auto radius = lit_radius(lamp, height)) return by_area * (kInvPi / sqr(*radius));
    if (const auto rectangle = near_rectangle(lamp, to_center, height))
        return 1.0f / rectangle->solid_angle;
    return by_area / lamp.area;
}

Spectrum radiance_one(const PointLamp&, const Vec3&, const Vec3&) { return Spectrum(0.0f); }
Spectrum radiance_one(const ParallelSun&, const Vec3&, const Vec3&) { return Spectrum(0.0f); }
Spectrum radiance_one(const SphereLamp& lamp, const Vec3& q, const Vec3& away) {
    const bool inwards = !lamp.soft && dot(q - lamp.center, away) < 0.0f;
    return inwards ? lamp.radiance : lamp.radiance * lamp.profile.towards(away);
}
Spectrum radiance_one(const DiscSun& lamp, const Vec3&, const Vec3& away) {
    return in_disc(lamp, away * -1.0f) ? lamp.radiance : Spectrum(0.0f);
}
Spectrum radiance_one(const AreaLamp& lamp, const Vec3&, const Vec3& away) {
    return dot(lamp.normal, away) > 0.0f ? lamp.radiance * lamp.spread.towards(lamp.normal, away)
                                         : Spectrum(0.0f);
}

// The nearest point of an area lamp to p's foot; outside an ellipse, of the rectangle around it.
Vec3 below_of(const AreaLamp& lamp, const Vec3& p) {
    const auto clamped = [&](const Vec3& dual) {
        return std::clamp(dot(p - lamp.center, dual), -1.0f, 1.0f);
    };
    return lamp.center + lamp.half_x * clamped(lamp.dual_x) + lamp.half_y * clamped(lamp.dual_y);
}

LampPoint point_one(const PointLamp& lamp, const Vec2&) { return {.p = lamp.center, .pdf = 1.0f}; }
LampPoint point_one(const SphereLamp& lamp, const Vec2& u) {
    const Vec3 n = uniform_sphere(u);
    return {.p = lamp.center + n * lamp.radius, .n = n, .pdf = kUniformSpherePdf / sqr(lamp.radius)};
}
LampPoint point_one(const ParallelSun& lamp, const Vec2&) {
    return {.direction = lamp.direction, .pdf = 1.0f};
}
LampPoint point_one(const DiscSun& lamp, const Vec2& u) {
    return {.direction = lamp.frame.to_world(uniform_cone(u, lamp.one_minus_cos)),
            .pdf = uniform_cone_pdf(lamp.one_minus_cos)};
}
LampPoint point_one(const AreaLamp& lamp, const Vec2& u) {
    const Vec2 q = lamp.ellipse ? concentric_disk(u) : Vec2(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f);
    return {.p = lamp.center + lamp.half_x * q.x + lamp.half_y * q.y,
            .n = lamp.normal,
            .pdf = 1.0f / lamp.area};
}

AreaLamp make_area(const LightDesc& desc) {
    AreaLamp lamp{};
    lamp.center = desc.position();
    lamp.half_x = desc.half_x();
    lamp.half_y = desc.half_y();
    const Vec3 across = cross(lamp.half_x, lamp.half_y);
    lamp.normal =
        safe_normalize(dot(across, desc.axis()) < 0.0f ? across * -1.0f : across, desc.axis());
    lamp.length_x = length(lamp.half_x);
    lamp.length_y = length(lamp.half_y);
    lamp.axis_x = safe_normalize(lamp.half_x, Vec3(0.0f));
    lamp.axis_y = safe_normalize(lamp.half_y, Vec3(0.0f));
    const float inv = 1.0f / std::max(length(across), 1e-30f);
    lamp.dual_x = cross(lamp.half_y, across * inv) * inv;
    lamp.dual_y = cross(across * inv, lamp.half_x) * inv;
    lamp.spread = make_spread(desc.spread);
    lamp.ellipse = desc.shape == AreaShape::ellipse;
    lamp.area = length(across) * (lamp.ellipse ? kPi : 4.0f);
    lamp.radiance = lamp.area > kLeastLampArea
                        ? scaled(desc.power, 1.0 / (std::numbers::pi * lamp.area))
                        : Spectrum(0.0f);
    constexpr float kRightAngle = 1e-4f;  // cosine below which the sides count as orthogonal
    const bool rectangle = !lamp.ellipse && std::abs(dot(lamp.axis_x, lamp.axis_y)) < kRightAngle;
    lamp.near_squared =
        rectangle ? (sqr(lamp.length_x) + sqr(lamp.length_y)) / sqr(kFarRectangle) : 0.0f;
    return lamp;
}

}  // namespace

SpotProfile make_spot_profile(const LightDesc& desc) {
    SpotProfile profile;
    if (desc.type != LightType::spot) return profile;
    profile.uniform = false;
    const Vec3 x = desc.to_world.column(0), y = desc.to_world.column(1),
               z = desc.to_world.column(2) * -1.0f;
    const auto over_square = [](const Vec3& a) {
        return a * (1.0f / std::max(length_squared(a), 1e-30f));
    };
    const float unit = length(z);
    profile.x = over_square(x) * unit;
    profile.y = over_square(y) * unit;
    profile.z = over_square(z) * unit;
    const float half = 0.5f * desc.spot_angle;
    profile.cos_half = std::cos(half);
    profile.inv_smooth = std::min(1.0f / ((1.0f - profile.cos_half) * desc.spot_blend), 1e30f);
    const float widest =
        std::tan(half) * std::sqrt(std::max(length_squared(x), length_squared(y))) / unit;
    profile.cos_widest = half < 0.5f * kPi ? 1.0f / std::sqrt(1.0f + widest * widest) : 0.0f;
    return profile;
}

float SpotProfile::towards(const Vec3& direction) const {
    if (uniform) return 1.0f;
    const Vec3 local(dot(direction, x), dot(direction, y), dot(direction, z));
    const float cos = local.z / length(local);
    return smoothstep((cos - cos_half) * inv_smooth);
}

float SpreadProfile::towards(const Vec3& normal, const Vec3& away) const {
    if (uniform) return 1.0f;
    // Beams may be so narrow that the cosine has no digits left for the tangent.
    const float cos = dot(normal, away);
    const float sin = length(away - normal * cos);
    return cos > 0.0f ? std::max((tan_half - sin / cos) * gain, 0.0f) : 0.0f;
}

bool in_disc(const DiscSun& sun, const Vec3& wi) {
    // |a - b|^2 = 2 (1 - cos) keeps the digits that the cosine of a small angle loses.
    return 0.5f * length_squared(wi - sun.frame.z) <= sun.one_minus_cos;
}

Lamp make_lamp(const LightDesc& desc) {
    constexpr double pi = std::numbers::pi;
    switch (desc.type) {
        case LightType::point:
        case LightType::spot: {
            const SpotProfile profile = make_spot_profile(desc);
            if (!(desc.radius > kLeastLampRadius))
                return PointLamp{desc.position(), scaled(desc.power, 1.0 / (4.0 * pi)), profile};
            const double r = desc.radius;
            return SphereLamp{desc.position(), desc.radius, desc.soft_falloff,
                              scaled(desc.power, 1.0 / (4.0 * pi * pi * r * r)), profile};
        }
        case LightType::sun: {
            const Vec3 direction = desc.axis() * -1.0f;
            if (!(desc.sun_angle > kLeastSunAngle)) return ParallelSun{direction, desc.power};
            const double s = std::sin(0.5 * desc.sun_angle);
            return DiscSun{Frame::around(direction), one_minus_cos(0.5f * desc.sun_angle),
                           scaled(desc.power, 1.0 / (pi * s * s))};
        }
        case LightType::area: break;
    }
    return make_area(desc);
}

double lamp_flux(const LightDesc& desc, const Lamp& lamp) {
    if (const auto* area = std::get_if<AreaLamp>(&lamp);
        area != nullptr && !(area->area > kLeastLampArea))
        return 0.0;
    const double power = luminance(desc.power);
    if (desc.type != LightType::spot) return power;
    // Share of the sphere inside the beam; the soft part counts half.
    return power * one_minus_cos(0.5f * desc.spot_angle) * 0.5 * (1.0 - 0.5 * desc.spot_blend);
}

std::optional<LampSample> sample_lamp(const Lamp& lamp, const Vec3& p, const Vec2& u) {
    return std::visit([&](const auto& l) { return sample_one(l, p, u); }, lamp);
}
float lamp_pdf(const Lamp& lamp, const Vec3& p, const Vec3& wi, float distance) {
    return std::visit([&](const auto& l) { return pdf_one(l, p, wi, distance); }, lamp);
}
Spectrum lamp_radiance(const Lamp& lamp, const Vec3& q, const Vec3& away) {
    return std::visit([&](const auto& l) { return radiance_one(l, q, away); }, lamp);
}
Spectrum brightest_radiance(const Lamp& lamp, const Vec3& p) {
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) {
        const Vec3 to_p = p - below_of(*area, p);
        return radiance_one(*area, p, safe_normalize(to_p, area->normal));
    }
    const auto& sphere = std::get<SphereLamp>(lamp);
    return sphere.radiance *
           sphere.profile.towards(safe_normalize(p - sphere.center, sphere.profile.z));
}
LampBeam lamp_beam(const Lamp& lamp) {
    constexpr float kMargin = 1e-3f;  // of the cone, for directions that are rounded at its edge
    const auto spot = [](const SpotProfile& profile) {
        return profile.uniform ? LampBeam{Vec3(0, 0, 1), 2.0f}
                               : LampBeam{profile.z, (1.0f - profile.cos_widest) * (1.0f + kMargin)};
    };
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) {
        const float half = area->spread.uniform ? 0.5f * kPi : std::atan(area->spread.tan_half);
        return {area->normal, one_minus_cos(half) * (1.0f + kMargin)};
    }
    if (const auto* sphere = std::get_if<SphereLamp>(&lamp)) return spot(sphere->profile);
    return spot(std::get<PointLamp>(lamp).profile);
}
Spectrum delta_strength(const Lamp& lamp, const Vec3& away) {
    if (const auto* point = std::get_if<PointLamp>(&lamp))
        return point->intensity * point->profile.towards(away);
    if (const auto* sun = std::get_if<ParallelSun>(&lamp)) return sun->irradiance;
    return Spectrum(0.0f);
}
LampPoint sample_lamp_point(const Lamp& lamp, const Vec2& u) {
    return std::visit([&](const auto& l) { return point_one(l, u); }, lamp);
}
Vec3 lamp_point_seen(const Lamp& lamp, const Vec3& p, const Vec3& wi, float distance) {
    const auto* sphere = std::get_if<SphereLamp>(&lamp);
    if (sphere == nullptr || !sphere->soft) return p + wi * distance;
    const Vec3 to_center = sphere->center - p;
    const float along = dot(to_center, wi), r2 = sphere->radius * sphere->radius;
    const float side = length_squared(to_center) > r2 ? -1.0f : 1.0f;
    const Vec3 foot = wi * along - to_center;  // from the centre
    return sphere->center + foot + wi * (side * safe_sqrt(r2 - length_squared(foot)));
}
bool lamp_shows(const Lamp& lamp, const Vec3& q, const Vec3& p) {
    const auto* sphere = std::get_if<SphereLamp>(&lamp);
    return sphere == nullptr || !sphere->soft || is_seen(*sphere, p, normalize(q - p));
}
Vec3 lamp_light_begins(const Lamp& lamp, const Vec3& q, const Vec3& p) {
    const auto* sphere = std::get_if<SphereLamp>(&lamp);
    if (sphere == nullptr || !sphere->soft) return q;
    const Vec3 to_center = sphere->center - p, wi = normalize(q - p);
    return p + wi * (length_squared(to_center) / dot(to_center, wi));
}
Vec3 lamp_normal(const Lamp& lamp, const Vec3& q) {
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) return area->normal;
    return normalize(q - std::get<SphereLamp>(lamp).center);
}

float lamp_point_pdf(const Lamp& lamp) {
    if (const auto* sphere = std::get_if<SphereLamp>(&lamp))
        return kUniformSpherePdf / sqr(sphere->radius);
    if (const auto* sun = std::get_if<DiscSun>(&lamp)) return uniform_cone_pdf(sun->one_minus_cos);
    if (const auto* area = std::get_if<AreaLamp>(&lamp)) return 1.0f / area->area;
    return 0.0f;
}

}  // namespace spc
