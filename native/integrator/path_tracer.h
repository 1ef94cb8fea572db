// SPDX-License-Identifier: GPL-3.0-or-later
// One camera path under way, and the steps that path_radiance() takes with it. Private to the
// integrator's path*.cpp, each of which has one group of steps.
#pragma once

#include "integrator/history.h"
#include "manifold/fold_directions.h"

namespace spc {

// The share of an estimate of density `own` in light that another one finds with `other`: by the
// power heuristic [Veach97], since the one with the larger density is better than that, stratified.
inline float power_heuristic(float own, float other) { return 1.0f / (1.0f + sqr(other / own)); }

// Directions to lights of which closures with glints take one.
inline constexpr uint32_t kGlintCandidates = 12;
// The share of kGlintCandidates directions of density `direct` in light that closures with glints
// find with `closure`.
inline float shared_by_glints(float direct, const GlintDensity& closure) {
    return closure.share_of_direct(static_cast<float>(kGlintCandidates), direct);
}

struct PathTracer {
    const RenderScene& world;
    const IntegratorSettings& settings;
    const RoundState& round;
    PathStats& stats;
    Pcg& pcg;  // of searches for chains that sheets miss
    Vec2 lens;
    Ray ray;
    Media media;             // that the ray is in
    Vec3 from = ray.origin;  // the path's last vertex, beside which the ray starts
    Spectrum throughput{1.0f};
    PathHistory history{};
    BounceCounts bounces{};
    uint32_t ray_kind = kVisibleCamera;
    // Where there may be glints: how the path moves with what it was drawn from, and what its last
    // surface makes of that.
    std::optional<PathDifferential> differential{};
    std::optional<GlintPoint> glints{};
    // At the surface where the path is, and at history.caustic.x.
    FoldDirections folds_here{}, folds_at_x{};
    bool from_folds = false;  // whether one of folds_at_x has been drawn there

    const Scene& scene() const { return *world.scene; }
    bool has_chain_casters() const {
        return !(world.casters.empty() && world.rough_chain_casters.empty());
    }
    // Whether somebody else may find what path tracing does.
    bool shares() const {
        return (settings.manifold.enabled && has_chain_casters()) ||
               settings.light_tracing.guide != nullptr;
    }

    // ---- path.cpp: from surface to surface

    // Along the ray to a surface, which the path then evaluates: adds the light that it runs into on
    // the way and there. Empty where it leaves the scene.
    std::optional<Hit> go_to_surface(Surface& surface, Spectrum& radiance);
    CameraSubpath camera_subpath_to(const Surface& surface) const;
    // Both tell whether the path goes on.
    bool scatter(const Hit& hit, const Surface& surface, const ClosureSample& next, bool receives,
                 const CameraSubpath& camera_subpath, const Sampler& sampler);
    bool look_for_lights_behind(const Hit& hit, const Surface& surface);

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
    // The chain that comes to the surface and may go on there.
    RoughVisit rough_visit(const Surface& surface) const;

    // ---- path_emission.cpp: light that the path runs into, weighed against the estimators that could
    // have connected to it. Without throughput.

    // The world and every sun with a disc, in the direction of a ray that leaves the scene.
    Spectrum emission_from_afar() const;
    Spectrum emission_of_lamp(const Hit& hit) const;
    Spectrum emission_of_surface(const Hit& hit, const Surface& surface) const;

    Spectrum emission_of_world() const;
    // `end.pdf`: 0 where light points are never drawn there; `end.pdf_direct`: likewise.
    float weight_of(const LightEnd& end) const;
    // Next event estimation looks through everything for a lamp without shadow: rays, which do not,
    // leave the lamp to it.
    float weight_of_lamp(const LightEnd& end) const;
    float weight_since_x(const LightEnd& end) const;
    float weight_of_chain(const LightEnd& end) const;
    // Whether weight_of() asks for the density of light points.
    bool light_points_count() const;
    LightEnd end_afar(uint32_t light, float pdf, float pdf_direct) const;
    // Of light that a rough caster at path.x throws on; empty where light paths do not find it.
    std::optional<CausticDensities> shared_with_light_paths(const CausticPath& path,
                                                            const LightEnd& end) const;

    // ---- path_direct.cpp: next event estimation over all lights

    // Without throughput.
    Spectrum direct_radiance(const Surface& surface, const CameraSubpath& camera_subpath,
                             const Sampler& sampler);
    Spectrum direct_radiance(const Surface& surface, const CameraSubpath& camera_subpath,
                             const DirectSample& light);

    // f |cos|, less what rough chains find.
    Spectrum left_of_direct(const Surface& surface, const DirectSample& light, const ClosureEval& f,
                            uint32_t kinds) const;
    float weight_of_direct(const Surface& surface, const CameraSubpath& camera_subpath,
                           const DirectSample& light, const ClosureEval& f) const;
    LightEnd end_of_direct(const Surface& surface, const DirectSample& light) const;
    // Whether light paths may find light that comes to the surface, as a rough caster throws it on.
    bool throws_on(const Surface& surface, const CameraSubpath& camera_subpath) const;
    Spectrum unblocked(const Surface& surface, const DirectSample& light);

    // ---- path_glints.cpp: next event estimation by closures with glints, averaged over the pixel

    // Whether the surface is looked at through the path's footprint, in `glints`.
    void look_for_glints(const Hit& hit, Surface& surface, const CameraSubpath& camera_subpath,
                         const PixelKernel* pixel);
    // Throughput included.
    Spectrum glint_radiance(const Surface& surface, const Sampler& sampler);

    // Whether rough chains may find light that comes to the surface and is reflected.
    bool turns_rough_chain(const Surface& surface) const;
    Spectrum glint_estimate(const Surface& surface, const Sampler& sampler, uint32_t estimate);

    // ---- path_caustics.cpp: light that chains bring to receivers

    bool may_receive(const Surface& surface) const;
    // Before caustic_radiance().
    void look_for_folds(const Surface& surface, const CameraSubpath& camera_subpath, bool receives);
    // Of chains of deltas, and of those with rough vertices. Throughput included.
    Spectrum caustic_radiance(const Surface& surface, const CameraSubpath& camera_subpath,
                              const Sampler& sampler);

    Receiver receiver_at(const Surface& surface, const CameraSubpath& camera_subpath) const;
    // See CausticPath::begins_rough. Where the camera comes as light paths do, they find them.
    bool may_begin_rough_chain(const Surface& surface, const CameraSubpath& camera_subpath) const;
    // Of what chains bring, that the manifold counts; those that light paths rarely meet bring all.
    float share_beside_light_paths(const CameraSubpath& camera_subpath) const;
    // Of kind `i` of Activation, by radiance(receiver, whether it has what is left to chance);
    // `u` decides that. Throughput included.
    template <class Estimate>
    Spectrum estimate(const Surface& surface, const CameraSubpath& camera_subpath, size_t i,
                      float u, const Estimate& radiance);
    // Of chains of deltas, by a direction next to folds.
    void add_folds(const Surface& surface, const Sampler& sampler, ManifoldRadiance& to) const;
    // Of a path that such a direction has begun. Throughput included.
    Spectrum light_behind_deltas(const Sampler& sampler);
};

}  // namespace spc
