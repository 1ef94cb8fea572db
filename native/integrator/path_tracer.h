// SPDX-License-Identifier: GPL-3.0-or-later
// A camera path under way and the steps that path_radiance() takes with it. Private to the
// integrator's path*.cpp; each of them implements one group of steps.
#pragma once

#include "integrator/history.h"
#include "manifold/fold_directions.h"

namespace spc {

// Weight of an estimate of density `own` beside one of density `other` [Veach97]. Not the balance
// heuristic: the denser technique is stratified, so it is better than its density says.
inline float power_heuristic(float own, float other) { return 1.0f / (1.0f + sqr(other / own)); }

// Closures with glints draw so many directions to lights and keep one.
inline constexpr uint32_t kGlintCandidates = 12;
// Weight of next event estimation by closures with glints, of density `direct` for each candidate,
// beside closure sampling of density `closure`.
inline float shared_by_glints(float direct, const GlintDensity& closure) {
    return closure.share_of_direct(static_cast<float>(kGlintCandidates), direct);
}

// What light paths gather, and where it goes: into the picture, and to the passes that tell it
// apart.
struct PathLight {
    Spectrum total{0.0f};
    PassValues* values = nullptr;  // null: no pass asks
    Spectrum scale{1.0f};          // of what goes to passes, beside the picture
};

constexpr Lobe lobe_of(BounceKind kind) {  // of all but transparent
    return static_cast<Lobe>(kind);
}
// What part of the light from wi each lobe of the surface scatters to the path.
LobeShares lobe_shares(const Surface& surface, const Vec3& wi);

// Follows a camera path to the first surface that is no mirror and no clear glass, and tells the
// denoiser what is seen there.
class Features {
public:
    // At each surface, `length` (m) from the one before. Returns whether it is the one.
    bool look(const Scene& scene, const Surface& surface, float length, PassValues& values);
    void look_at_world(const Spectrum& radiance, PassValues& values) const;
    void scatter(const ClosureSample& next) { throughput_ *= next.weight; }

private:
    Spectrum throughput_{1.0f};
};

struct PathTracer {
    const RenderScene& world;
    const IntegratorSettings& settings;
    const RoundState& round;
    PathStats& stats;
    Pcg& pcg;  // for searches for chains that sheets miss
    Vec2 lens;
    Ray ray;
    Media media;             // media that the ray is in
    Vec3 from = ray.origin;  // the path's last vertex; the ray's origin is offset from it
    Spectrum throughput{1.0f};
    PathHistory history{};
    BounceCounts bounces{};
    uint32_t ray_kind = kVisibleCamera;
    bool sees_film = true;            // through nothing but what lets it through
    bool in_hole = false;             // has come to a hole in the picture
    uint32_t ray_kinds = kRayCamera;  // of RayKind
    // That the ray left by its last scattering; null: it is the camera's.
    const Instance* scattered_by = nullptr;
    float ray_begins = ray.t_near;  // where graphs count the ray's length from, as Cycles does
    // Set while the path may meet glints: its differential, and the footprint on its last surface.
    std::optional<PathDifferential> differential{};
    std::optional<GlintPoint> glints{};
    // Fold directions at the current surface, and at history.caustic.x.
    FoldDirections folds_here{}, folds_at_x{};
    bool from_folds = false;                 // the path left x along one of folds_at_x
    bool writes_aovs = false;                // what the camera sees first is still to come
    LobeShares lobes = only(Lobe::diffuse);  // of the first scattering, once there was one

    const Scene& scene() const { return *world.scene; }
    bool has_chain_casters() const {
        return !(world.casters.empty() && world.rough_chain_casters.empty());
    }
    // Whether another technique than path tracing may find the path's light.
    bool shares() const {
        return (settings.manifold.enabled && has_chain_casters()) ||
               settings.light_tracing.guide != nullptr;
    }

    // ---- path.cpp: from surface to surface

    // Follows the ray to the next surface and evaluates it. Adds the emission that the ray meets on
    // the way and at the surface. Empty if the ray leaves the scene, or the picture in a hole.
    std::optional<Hit> go_to_surface(Surface& surface, PathLight& light);
    bool is_held_out(const Hit& hit) const {
        return sees_film && scene().instances[hit.surface.instance].holdout;
    }
    // Whether the film is seen past such a scattering.
    bool lets_film_through(const ClosureSample& next) const {
        return settings.transparent_glass && next.kind == BounceKind::transmission &&
               next.alpha <= settings.transparent_glass_alpha;
    }
    CameraSubpath camera_subpath_to(const Surface& surface) const;
    // Adds the light that techniques other than the path's own rays find at the surface; how it
    // goes on.
    struct Onward {
        std::optional<ClosureSample> next;
        bool receives;
        CameraSubpath camera_subpath;
    };
    Onward shade(const Hit& hit, Surface& surface, const Sampler& here, const PixelKernel* pixel,
                 PathLight& light, PathSample& out);
    // These return whether the path continues. `surface` becomes the one where light leaves.
    bool go_below(Surface& surface, const ClosureSample& entry, const Sampler& here);
    bool scatter(const Hit& hit, const Surface& surface, const ClosureSample& next, bool receives,
                 const CameraSubpath& camera_subpath, const Sampler& sampler, PathLight& light);
    bool look_for_lights_behind(const Hit& hit, const Surface& surface);

    // What graphs are told of the path's ray, and of one of these `kinds` from its last vertex to a
    // light, which is a bounce further.
    RayState seen_by(float length) const {
        return ray_state(ray_kinds, length - ray_begins, bounces.total);
    }
    RayState to_light(uint32_t kinds) const { return ray_state(kinds, 0.0f, bounces.total + 1); }
    RayState ray_state(uint32_t kinds, float length, uint32_t depth) const {
        return {kinds,
                length,
                depth,
                bounces.diffuse,
                bounces.glossy,
                bounces.transparent,
                bounces.transmission};
    }
    std::optional<Hit> intersect();
    void evaluate(const Hit& hit, Surface& surface) const;
    void go_towards(const Vec3& wi) {
        if (shares()) history.set_direction(scene(), wi);
    }
    void come_to(const Vec3& p) {
        if (shares()) history.set_next(scene(), p);
    }
    bool look_through(const Hit& hit);
    void spawn_ray(const Surface& surface, const ClosureSample& next);
    bool survive_roulette(const Sampler& sampler);
    std::optional<CausticVertex> rough_vertex_at(const Surface& surface,
                                                 const ClosureSample& next) const;
    // The rough chain that arrives at the surface and may continue there.
    RoughVisit rough_visit(const Surface& surface) const;

    // ---- path_emission.cpp: emission that the path meets, weighed against the techniques that
    // could have connected to it. The path's throughput is not included.

    // Adds the world and every sun with a disc, in the direction of a ray that leaves the scene.
    // The path's throughput is included.
    void add_from_afar(PathLight& light) const;
    // The path's throughput is not included.
    Spectrum emission_of_sun(uint32_t sun) const;
    Spectrum emission_of_lamp(const Hit& hit) const;
    Spectrum emission_of_surface(const Hit& hit, const Surface& surface) const;

    Spectrum emission_of_world() const;
    // Weight of path tracing. `end.pdf` and `end.pdf_direct` are 0 if that technique never draws
    // `end`.
    float weight_of(const LightEnd& end) const;
    // Next event estimation passes through everything if a lamp casts no shadow. Rays do not, so
    // they leave such a lamp to it.
    float weight_of_lamp(const LightEnd& end) const;
    float weight_since_x(const LightEnd& end) const;
    float weight_of_chain(const LightEnd& end) const;
    // Whether weight_of() reads `end.pdf`.
    bool light_points_count() const;
    LightEnd end_afar(uint32_t light, float pdf, float pdf_direct) const;
    // Densities of a path that a rough caster at path.x reflects; empty if light tracing cannot
    // find it.
    std::optional<CausticDensities> shared_with_light_paths(const CausticPath& path,
                                                            const LightEnd& end) const;

    // ---- path_linking.cpp: light that is tied to some instances

    // Whether the emission that the ray meets is that of a light with such links. What shines
    // through things is left to add_shadow_linked().
    bool meets(const LightLinks& links) const {
        return scattered_by == nullptr ||
               (links.blockers == 0 && is_linked(links.receivers, scattered_by->sets.receives));
    }
    // Adds light that the ray which has just left the surface meets of lights that not everything
    // shadows, whatever stands in between that is none of their blockers.
    void add_shadow_linked(const Surface& surface, PathLight& light);
    void add_shadow_linked_mesh(const Surface& surface, uint32_t emitter, PathLight& light);
    // What the light's blockers let pass from the surface. The path's throughput is included.
    Spectrum past_blockers(const Surface& surface, uint32_t of_light, const RayEnd& end);

    // ---- path_direct.cpp: next event estimation over all lights

    void add_direct(const Surface& surface, const CameraSubpath& camera_subpath,
                    const Sampler& sampler, PathLight& light);
    bool connects_to(uint32_t light) const {
        return light >= world.lights.lamps.size() ||
               bounces.total <= scene().lights[light].max_bounces;
    }
    // The path's throughput is not included.
    Spectrum direct_radiance(const Surface& surface, const CameraSubpath& camera_subpath,
                             const DirectSample& light);

    // f |cos| without the share that rough chains take.
    Spectrum left_of_direct(const Surface& surface, const DirectSample& light, const ClosureEval& f,
                            uint32_t kinds) const;
    float weight_of_direct(const Surface& surface, const CameraSubpath& camera_subpath,
                           const DirectSample& light, const ClosureEval& f) const;
    LightEnd end_of_direct(const Surface& surface, const DirectSample& light) const;
    // Whether the surface is a rough caster whose reflected light light tracing may find.
    bool throws_on(const Surface& surface, const CameraSubpath& camera_subpath) const;
    Spectrum unblocked(const Surface& surface, const DirectSample& light);

    // ---- path_glints.cpp: next event estimation by closures with glints, averaged over the pixel

    // Sets `glints` if the surface's glints are averaged over the path's footprint.
    void look_for_glints(const Hit& hit, Surface& surface, const CameraSubpath& camera_subpath,
                         const PixelKernel* pixel);
    void add_glints(const Surface& surface, const Sampler& sampler, PathLight& light);

    // Whether rough chains may find light that the surface reflects.
    bool turns_rough_chain(const Surface& surface) const;
    // Light of one light, that was chosen. The path's throughput is included.
    struct GlintLight {
        Spectrum radiance{0.0f};
        uint32_t light = kNone;  // there is none
    };
    GlintLight glint_estimate(const Surface& surface, const Sampler& sampler, uint32_t estimate);

    // ---- path_caustics.cpp: light that chains bring to receivers

    bool may_receive(const Surface& surface) const;
    // Call before caustic_radiance().
    void look_for_folds(const Surface& surface, const CameraSubpath& camera_subpath, bool receives);
    // Adds light of chains of deltas and of rough chains; returns how much.
    Spectrum add_caustics(const Surface& surface, const CameraSubpath& camera_subpath,
                          const Sampler& sampler, PathLight& light);

    Receiver receiver_at(const Surface& surface, const CameraSubpath& camera_subpath) const;
    // See CausticPath::begins_rough. Not where light tracing finds rough chains.
    bool may_begin_rough_chain(const Surface& surface, const CameraSubpath& camera_subpath) const;
    // Expected share of a chain's light that the manifold counts: 1 where light paths rarely
    // arrive.
    float share_beside_light_paths(const CameraSubpath& camera_subpath) const;
    // Estimate of kind `i` of Activation by `radiance(receiver, draws)`; the uniform number `u`
    // decides whether it draws, that is, makes its random search. The path's throughput is
    // included.
    template <class Estimate>
    Spectrum estimate(const Surface& surface, const CameraSubpath& camera_subpath, size_t i,
                      float u, const Estimate& radiance, PathLight& light);
    // Adds light of chains of deltas that a fold direction finds; what passes have of it to
    // `light`.
    void add_folds(const Surface& surface, const Sampler& sampler, ManifoldRadiance& to,
                   const PathLight& light) const;
    // Light of a path that a fold direction has begun. The path's throughput is included.
    void add_light_behind_deltas(const Sampler& sampler, PathLight& light);

    // ---- path_passes.cpp: what passes tell of the light, and of the surfaces that the camera sees

    // Adds emission that the path meets. The path's throughput is included.
    void add_met(const Spectrum& emitted, Pass if_seen, uint32_t light_group,
                 PathLight& light) const;
    // Adds light of a light that the surface scatters from wi to the path.
    void add_scattered(const Spectrum& value, const Surface& surface, const Vec3& wi,
                       uint32_t of_light, PathLight& light, bool direct) const;
    void tell_scattered(const Spectrum& value, const Surface& surface, const Vec3& wi,
                        uint32_t of_light, PassValues& values, bool direct) const;
    // Scatterings up to here, the one along a fold direction included.
    uint32_t scatterings() const { return bounces.total + (from_folds ? 1u : 0u); }
    // Adds colours and coverage of a surface that the camera sees straight.
    void tell_surface(const Surface& surface, PassValues& values) const;
    // Adds AOVs of the surface, at the end of a ray of some `length`, and of the world.
    void tell_aovs(const Surface& surface, float length, PassValues& values);
    void tell_aovs_of_world(PassValues& values) const;
    // That the ray meets if it leaves the scene.
    Spectrum world_seen() const;
};

}  // namespace spc
