// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps made ready to sample: everything that does not depend on the receiver computed once.
// Densities here are those of one lamp; light.h adds the choice among all.
#pragma once

#include "scene/description.h"

#include <variant>

namespace spc {

// Lamps below these extents are deltas: single precision cannot tell the directions to their points
// apart.
inline constexpr float kLeastLampRadius = 1e-9f;  // m
inline constexpr float kLeastSunAngle = 1e-5f;    // rad
// An area light below this has no surface that shines.
inline constexpr float kLeastLampArea = 1e-18f;  // m^2
// An area light's beam is no narrower.
inline constexpr float kLeastSpread = 0.1f * kPi / 180.0f;  // rad

// Brightness of a spot by direction; 1 everywhere for a point lamp.
struct SpotProfile {
    bool uniform = true;
    Vec3 x{0.0f}, y{0.0f}, z{0.0f};  // local = dot products with these; z is the unit axis
    float cos_half = -1.0f, inv_smooth = 0.0f;
    float cos_widest = -1.0f;  // of a cone around the axis that holds the whole beam

    float towards(const Vec3& direction) const;  // unit, away from the lamp
};
SpotProfile make_spot_profile(const LightDesc& desc);  // uniform, unless it is a spot

// Brightness of an area light by direction: what a fine grid of slats in front of it lets through.
// It keeps the flux: along the normal the light is the brighter.
struct SpreadProfile {
    bool uniform = true;
    float tan_half = 0.0f, gain = 0.0f;

    // `away` is unit, on the normal's side.
    float towards(const Vec3& normal, const Vec3& away) const;
};

struct PointLamp {  // delta
    Vec3 center;
    Spectrum intensity;  // W/sr on the axis
    SpotProfile profile;
};
// With soft falloff p sees in its place the disk around the centre that faces p. Its rays are those
// of the sphere's that pass the disk: a point of the sphere stands for both, and the light begins
// on the disk, behind the sphere's near side.
struct SphereLamp {
    Vec3 center;
    float radius;
    bool soft;
    Spectrum radiance;
    SpotProfile profile;
};
struct ParallelSun {  // delta
    Vec3 direction;   // unit, towards the sun
    Spectrum irradiance;
};
struct DiscSun {
    Frame frame;  // z towards the sun
    float one_minus_cos;
    Spectrum radiance;
};
struct AreaLamp {
    Vec3 center, normal;
    Vec3 half_x, half_y;
    Vec3 axis_x, axis_y;       // unit
    Vec3 dual_x, dual_y;       // dot products with these go from -1 to 1 over half_x, half_y
    float length_x, length_y;  // of the half extents
    float area;
    float near_squared;  // a rectangle is sampled by solid angle from receivers nearer than this
    bool ellipse;
    Spectrum radiance;  // of an even light of this flux
    SpreadProfile spread;
};
using Lamp = std::variant<PointLamp, SphereLamp, ParallelSun, DiscSun, AreaLamp>;

Lamp make_lamp(const LightDesc& desc);
// Flux in W, of luminance; of a sun the irradiance, W/m^2.
double lamp_flux(const LightDesc& desc, const Lamp& lamp);

struct LampSample {
    Vec3 wi;            // unit, towards the lamp
    float distance;     // kInfinity for a sun
    Spectrum radiance;  // of a delta: intensity / distance^2, or irradiance
    float density;      // 1/sr; 1 for a delta
    bool delta;
};
// Empty where the lamp does not shine on p.
std::optional<LampSample> sample_lamp(const Lamp& lamp, const Vec3& p, const Vec2& u);
// Density of sample_lamp for the unit direction wi, which meets the lamp at `distance`. 0 for a
// delta.
float lamp_pdf(const Lamp& lamp, const Vec3& p, const Vec3& wi, float distance);

// Radiance from the point q of the lamp's surface along the unit direction `away`. 0 for a delta.
Spectrum lamp_radiance(const Lamp& lamp, const Vec3& q, const Vec3& away);
// The same towards p from the point of a lamp of some extent that shines brightest there.
Spectrum brightest_radiance(const Lamp& lamp, const Vec3& p);
// Intensity of a point along `away`, or irradiance of a parallel sun. 0 for lamps of some extent.
Spectrum delta_strength(const Lamp& lamp, const Vec3& away);

// All directions in which a local lamp shines.
struct LampBeam {
    Vec3 axis;            // unit
    float one_minus_cos;  // of the cone around it; 2: all
};
LampBeam lamp_beam(const Lamp& lamp);

struct LampPoint {
    Vec3 p{0.0f};          // unset for a sun
    Vec3 n{0.0f};          // unit, on the shining side; zero for a point
    Vec3 direction{0.0f};  // sun: unit, towards it
    float pdf;             // 1/m^2, a sun 1/sr; 1 for a delta
};
LampPoint sample_lamp_point(const Lamp& lamp, const Vec2& u);
// The point by which sample_lamp_point has the light that p sees along the unit direction wi, where
// the lamp is at `distance`: with soft falloff the sphere's, else the one that p sees.
Vec3 lamp_point_seen(const Lamp& lamp, const Vec3& p, const Vec3& wi, float distance);
// Whether p sees the light that leaves the point q towards it, and from where on the way there must
// be free: q, but with soft falloff the disk.
bool lamp_shows(const Lamp& lamp, const Vec3& q, const Vec3& p);
Vec3 lamp_light_begins(const Lamp& lamp, const Vec3& q, const Vec3& p);
// Unit normal on the shining side at the point q of an area or sphere lamp.
Vec3 lamp_normal(const Lamp& lamp, const Vec3& q);
float lamp_point_pdf(const Lamp& lamp);  // of every point of it; 0 for a delta

// Whether a sun of some extent stands in this direction.
bool in_disc(const DiscSun& sun, const Vec3& wi);

inline bool is_delta(const Lamp& lamp) {
    return std::holds_alternative<PointLamp>(lamp) || std::holds_alternative<ParallelSun>(lamp);
}
inline bool is_sun(const Lamp& lamp) {
    return std::holds_alternative<ParallelSun>(lamp) || std::holds_alternative<DiscSun>(lamp);
}

}  // namespace spc
