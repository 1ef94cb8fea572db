// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that shines: lamps, emissive meshes and the world, behind one choice.
//
// Two ways to sample. Next event estimation samples a direction from a receiver (solid angle at the
// receiver). The manifold samples a point of a light, or a direction to a distant one, without
// regard to a receiver (area or solid angle at the light). All probabilities include the choice of
// the light. A light without extent (point, or sun of angle 0) is `delta`: its density is the
// selection probability alone, and no ray ever hits it.
#pragma once

#include "core/distribution.h"
#include "light/lamp_shading.h"
#include "light/light_tree.h"
#include "scene/scene.h"
#include "scene/transmittance.h"

namespace spc {

// Index of a light: lamps first (as in Scene::lights), then emissive instances, then the world.
struct EmissiveInstance {
    // Triangles that lie together: a leaf of the light tree.
    struct Part {
        std::vector<uint32_t> triangles;
        DiscreteDistribution choice;  // of a triangle, by area times mean radiance
    };
    struct Place {
        uint32_t part = kNone, index = 0;  // of Part::triangles
    };
    uint32_t instance;
    DiscreteDistribution triangles;  // of all triangles, by area times mean radiance
    std::vector<float> inv_area;     // 1/m^2 per triangle, world space; 0 where it does not emit
    std::vector<Part> parts;
    std::vector<Place> places;  // of each triangle
    uint32_t first_leaf = 0;    // of its parts in the light tree
};

struct LightSet {
    // Chooses a light for a receiver; never a world that is nearly even. Its leaves are the lamps,
    // then parts of emissive instances, then the world.
    LightTree tree;
    struct Leaf {
        uint32_t light, part;
    };
    std::vector<Leaf> leaves;
    // Chooses a light for casters, among those that feed them: by power, mixed with an even choice,
    // so that no light starves.
    DiscreteDistribution caustic_selection;
    std::vector<Lamp> lamps;              // as Scene::lights
    std::vector<LampShading> shadings;    // likewise
    std::vector<uint32_t> disc_suns;      // lamps that are suns of some extent
    std::vector<uint32_t> visibility;     // of every light
    std::vector<LightLinks> links;        // likewise; without blockers if it casts no shadow
    std::vector<uint32_t> shadow_linked;  // lights that have blockers
    std::vector<EmissiveInstance> emissive;
    std::vector<uint32_t> emissive_of_instance;  // index into `emissive`, or kNone
    bool has_world = false;
    const Material* world_material = nullptr;  // what the rest is made of: the world's, or null
    // The world's radiance above its mean in latitude-longitude, solid angle accounted for.
    BilinearMap world_map;
    BilinearMap::Cells world_cells;  // all cells; empty if closure sampling finds the light as well
    // The world's narrow bright parts, which feed casters. The rest is so smooth that path tracing
    // finds it easily.
    BilinearMap::Cells world_peaks;
    Spectrum world_constant{0.0f};  // valid if world_is_constant
    bool world_is_constant = false;

    // Indices of lights.
    uint32_t of_emitter(uint32_t emitter) const {
        return static_cast<uint32_t>(lamps.size()) + emitter;
    }
    uint32_t of_world() const { return of_emitter(static_cast<uint32_t>(emissive.size())); }
    uint32_t world_leaf() const { return static_cast<uint32_t>(leaves.size() - 1); }
    bool is_distant(uint32_t light) const {
        return light < lamps.size() ? is_sun(lamps[light]) : light == of_world();
    }
    uint32_t count() const { return of_world() + (has_world ? 1u : 0u); }
};
// `before`: of another scene, which still lives, or null; a world of the same material is taken
// over from it. `threads` 0 = all.
LightSet build_lights(const Scene& scene, uint32_t threads = 0, const LightSet* before = nullptr);

// Bits of Visibility: the rays that see a light. kVisibleShadow: objects cast shadows of it; only
// lamps can lack it.
uint32_t light_visibility(const LightSet& lights, uint32_t light);

// Whether a light shines on what lies in these sets (LinkSets::receives).
bool shines_on(const LightSet& lights, uint32_t light, uint64_t receives);
// LightLinks::blockers.
uint64_t blockers_of(const LightSet& lights, uint32_t light);
// Whether paths from the light know what stops them: not if it shines through things on others.
bool sends_light_paths(const LightSet& lights, uint32_t light);

// Radiance that a ray meets at the point q of a lamp, which shines along the unit direction `away`;
// its nodes included. q is unset for a sun.
Spectrum radiance_of_lamp(const LightSet& lights, const Scene& scene, uint32_t light, const Vec3& q,
                          const Vec3& away, const RayState& ray);

// ---- from a receiver

// The point of a surface for the choice of a light. A surface that transmits light is lit from both
// sides.
LitPoint lit_point(const Scene& scene, const Surface& surface);

struct DirectSample {
    Vec3 wi;         // unit, towards the light
    float distance;  // kInfinity for a distant light
    // Radiance that arrives along wi if unblocked. For a delta light radiance times solid angle:
    // intensity / distance^2, or irradiance.
    Spectrum radiance;
    float density;  // 1/sr; for a delta light the probability of its selection
    bool delta;
    uint32_t light;
    SurfaceHit surface{kNone, 0, 0, 0};  // for emissive meshes
    float weight = 1.0f;                 // LightTree::Sample::weight
};
// `ray`: what a light's graph is told of the ray to it; its length is found.
std::optional<DirectSample> sample_direct(const LightSet& lights, const Scene& scene,
                                          const LitPoint& at, const Vec3& u,
                                          const RayState& ray = {});
// Two samples instead of one, with less noise from the choice of the light. The sum of weight
// radiance / density has the same mean. The second exists if lights.tree.has_second(), and is
// mostly empty.
std::optional<DirectSample> sample_direct_first(const LightSet& lights, const Scene& scene,
                                                const LitPoint& at, const Vec3& u,
                                                const RayState& ray = {});
std::optional<DirectSample> sample_direct_second(const LightSet& lights, const Scene& scene,
                                                 const LitPoint& at, const Vec3& u,
                                                 const RayState& ray = {});

// Density (1/sr) with which sample_direct() at `at` takes the direction `wi` to the point that a
// ray has hit. A ray that leaves the scene meets the world and each of LightSet::disc_suns that it
// points at, each with a density of its own.
float pdf_direct_lamp(const LightSet& lights, const LitPoint& at, const Vec3& wi, const Hit& hit);
float pdf_direct_surface(const LightSet& lights, const Scene& scene, const LitPoint& at,
                         const Vec3& wi, const Hit& hit);
float pdf_direct_world(const LightSet& lights, const LitPoint& at, const Vec3& wi);
// 0 outside the sun's disc.
float pdf_direct_sun(const LightSet& lights, const LitPoint& at, uint32_t light, const Vec3& wi);

Spectrum world_radiance(const LightSet& lights, const Scene& scene, const Vec3& direction,
                        RayState ray = {});

// ---- from the light

// A point y of a light, or a direction to a distant one.
struct LightPoint {
    uint32_t light;
    bool distant;
    bool delta;
    Vec3 p;          // on the light; unset if distant
    Vec3 n;          // unit normal there, on the shining side; zero for a point light
    Vec3 direction;  // distant: unit, from the scene towards the light
    SurfaceHit surface{kNone, 0, 0, 0};  // for emissive meshes
    // Density by area (1/m^2) or, distant, by solid angle (1/sr); of a delta light the probability
    // of its selection.
    float pdf;
};
// Draws a point of one light; its `pdf` is without the choice of the light.
std::optional<LightPoint> sample_point_of_light(const LightSet& lights, const Scene& scene,
                                                uint32_t light, const Vec2& u);
// Draws a point of the lights that feed casters: u[0] selects the light, u[1] and u[2] the point.
std::optional<LightPoint> sample_light_point(const LightSet& lights, const Scene& scene,
                                             const Vec3& u);

// Radiance of the light at y towards the unit direction `away` (distant lights: radiance from
// y.direction). For delta lights intensity (W/sr) or irradiance (W/m^2): geometry_term() is the
// Jacobian that belongs to either.
// Of the ray from y its graph is told the length alone.
Spectrum radiance_at(const LightSet& lights, const Scene& scene, const LightPoint& y,
                     const Vec3& away, float length);
// Whether it depends on the length.
bool shines_by_length(const LightSet& lights, const Scene& scene, const LightPoint& y);
// For some point of y's light that shines brightest towards p.
Spectrum brightest_at(const LightSet& lights, const Scene& scene, const LightPoint& y,
                      const Vec3& p, const Vec3& away);

// Whether p sees the light of y, which only some lamps can hide, and the point between which and p
// there must be no occluder. For lights that are not distant.
bool shows_itself(const LightSet& lights, const LightPoint& y, const Vec3& p);
Vec3 light_begins(const LightSet& lights, const LightPoint& y, const Vec3& p);

// Density (as LightPoint::pdf) with which sample_light_point finds the point that a ray from p
// along wi hit; 0 for a light that does not feed casters.
float pdf_light_point_lamp(const LightSet& lights, const Hit& hit);
float pdf_light_point_surface(const LightSet& lights, const SurfaceHit& hit);
float pdf_light_point_world(const LightSet& lights, const Vec3& wi);
float pdf_light_point_sun(const LightSet& lights, uint32_t light, const Vec3& wi);

// DirectSample::density with which sample_direct() at `at` finds y; y.pdf is not read.
float pdf_direct(const LightSet& lights, const Scene& scene, const LitPoint& at,
                 const LightPoint& y);
// The light point of a direct sample from p, with the density of sample_light_point().
LightPoint light_point_of(const LightSet& lights, const Scene& scene, const Vec3& p,
                          const DirectSample& sample);
// Where a shadow ray from p ends. The light itself, or a surface that it lies in, does not block
// it.
RayEnd ray_end(const LightSet& lights, const Scene& scene, const Vec3& p,
               const DirectSample& sample);
RayEnd ray_end(const Scene& scene, const LightPoint& y);

}  // namespace spc
