// SPDX-License-Identifier: GPL-3.0-or-later
// The emission guide: for each light a density of the directions that lead from its points to the
// casters or, for a distant light, of the positions across its direction.
#pragma once

#include "core/quadtree.h"
#include "manifold/caster.h"

namespace spc {

// The guide of one light. Its unit square parametrises one of three things: the cone in which a
// point of the light sees the sphere around all casters; a lamp's beam, the same from all of its
// points; or, for a distant light, a square across its direction around that sphere.
struct LightEmission {
    Frame frame{};           // z from a local light's centre towards the casters, or along the beam
    float narrowest = 2.0f;  // 1 - cos of the cone from its point farthest from the casters
    bool by_beam = false;    // the square stands for the beam
    QuadtreeDensity density;
};

struct EmissionGuide {
    Vec3 center{0.0f};  // of the sphere around all casters, world, m
    float radius = 0.0f;
    float start = 0.0f;  // distance from the centre at which rays of distant lights begin, m
    std::vector<LightEmission> lights;
};

// Where a light path began; the weight of `place` is what the path added to the picture.
struct EmissionSample {
    uint32_t light;
    WeightedPoint place;  // in the light's unit square
};
// Whether a lamp's unit square may stand for its beam, if the beam is narrower than the cone of
// casters from every point of the lamp.
enum class Squares : uint8_t { of_casters, of_beams };
// Builds a guide that aims at all surfaces of the casters evenly or, if there are samples, where
// those began.
EmissionGuide aim_at_casters(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                             Squares squares, std::span<const EmissionSample> learned = {});

struct EmittedRay {
    Vec3 origin;
    Vec3 direction;  // unit, away from the light
    Vec2 place;      // in the light's unit square
    float pdf;       // by solid angle from y (1/sr); distant: by area across the direction (1/m^2)
};
EmittedRay emit(const EmissionGuide& guide, const LightPoint& y, const Vec2& u);

// The ray from y through a place of the light's unit square. From an emissive mesh it starts at y
// itself; see offset_from_light().
Ray ray_at(const EmissionGuide& guide, const LightPoint& y, const Vec2& place);
// `origin`, moved off the surface if y lies on an emissive mesh.
Vec3 offset_from_light(const Scene& scene, const LightPoint& y, const Vec3& origin,
                       const Vec3& direction);
// Density of rays from y that are uniform over the unit square: by solid angle (1/sr) or, if
// distant, by area across the direction (1/m^2).
float density_of_uniform(const EmissionGuide& guide, const LightPoint& y);
// The place in the light's unit square of the ray from a chain's end through the point p. Empty
// outside the square.
std::optional<Vec2> place_towards(const EmissionGuide& guide, uint32_t light, const ChainEnd& end,
                                  const Vec3& p);

// Density with which emit() sends a ray from a chain's end through the point p; unit as in
// EmittedRay. `light` is the light that the end belongs to.
float emission_pdf(const EmissionGuide& guide, uint32_t light, const ChainEnd& end, const Vec3& p);

}  // namespace spc
