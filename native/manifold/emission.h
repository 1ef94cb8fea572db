// SPDX-License-Identifier: GPL-3.0-or-later
// Where light leaves for the casters: for each light a density of directions from its points, or of
// positions across its direction if it is distant.
#pragma once

#include "core/quadtree.h"
#include "manifold/caster.h"

namespace spc {

// Of one light. The unit square stands for the cone in which a point of the light sees the sphere
// that holds all casters; for a lamp's beam, the same from all of its points; or for a square across
// the direction of a distant light, around that sphere.
struct LightEmission {
    Frame frame{};           // z from a local light's centre towards the casters, or along the beam
    float narrowest = 2.0f;  // 1 - cos of the cone from its farthest point
    bool by_beam = false;
    QuadtreeDensity density;
};

struct EmissionGuide {
    Vec3 center{0.0f};  // of the sphere around all casters, world, m
    float radius = 0.0f;
    float start = 0.0f;  // m from the centre: outside the scene, where rays of distant lights begin
    std::vector<LightEmission> lights;
};

// Where a light path began, with what it added to the picture as its weight.
struct EmissionSample {
    uint32_t light;
    WeightedPoint place;  // in the light's unit square
};
// Whether the square of a lamp may stand for its beam, where that is narrower than the casters from
// each of its points.
enum class Squares : uint8_t { of_casters, of_beams };
// Aims at all of the casters' surfaces alike, save `learned`, which says more.
EmissionGuide aim_at_casters(const Scene& scene, const LightSet& lights, const CasterSet& casters,
                             Squares squares, std::span<const EmissionSample> learned = {});

struct EmittedRay {
    Vec3 origin;
    Vec3 direction;  // unit, away from the light
    Vec2 place;      // in the light's unit square
    float pdf;       // by solid angle from y (1/sr); distant: by area across the direction (1/m^2)
};
EmittedRay emit(const EmissionGuide& guide, const LightPoint& y, const Vec2& u);

// The ray that leaves y at a place of its light's unit square; of an emissive mesh it starts at y
// itself, not past its surface.
Ray ray_at(const EmissionGuide& guide, const LightPoint& y, const Vec2& place);
// Where a ray from y starts that begins at `origin`: past the surface of an emissive mesh.
Vec3 offset_from_light(const Scene& scene, const LightPoint& y, const Vec3& origin,
                       const Vec3& direction);
// Density of rays that are uniform over that square: by solid angle from y (1/sr); distant: by area
// across the direction (1/m^2).
float density_of_uniform(const EmissionGuide& guide, const LightPoint& y);
// Place at which light from the end of a chain goes through the point p; empty outside the square.
std::optional<Vec2> place_towards(const EmissionGuide& guide, uint32_t light, const ChainEnd& end,
                                  const Vec3& p);

// Density with which emit() sends light from the end of a chain through the point p; `light` is the
// end's.
float emission_pdf(const EmissionGuide& guide, uint32_t light, const ChainEnd& end, const Vec3& p);

}  // namespace spc
