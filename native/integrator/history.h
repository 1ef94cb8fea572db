// SPDX-License-Identifier: GPL-3.0-or-later
// What a path remembers of its last vertices: all that multiple importance sampling and ownership
// ask for when it meets a light. The history of a camera path and that of a light path describe the
// same path of light alike.
#pragma once

#include "integrator/path.h"

namespace spc {

constexpr uint32_t ray_kind_after(BounceKind kind) {
    return kind == BounceKind::diffuse  ? kVisibleDiffuse
           : kind == BounceKind::glossy ? kVisibleGlossy
                                        : kVisibleTransmission;
}

// Kinds of scattering whose rays see a light of this visibility.
inline uint32_t kinds_seeing(uint32_t visibility) {
    uint32_t kinds = 0;
    for (const BounceKind kind : {BounceKind::diffuse, BounceKind::glossy, BounceKind::transmission})
        if ((visibility & ray_kind_after(kind)) != 0) kinds |= kind_bit(kind);
    return kinds;
}

// The camera path since x, its last vertex that next event estimation or the manifold could have
// connected to a light.
struct PathHistory {
    enum class Stage : uint8_t {
        unconnected,  // path tracing alone finds the path: deltas from the camera on, or beyond a chain
        scattered,  // one smooth scattering at x: next event estimation finds the path, too
        chain       // casters after x, or after the camera where camera chains are looked for
    };
    Stage stage = Stage::unconnected;
    CausticPath caustic;  // the chain so far, without the probabilities of its vertices' lobes
    // If x lies on a rough caster: the chain from an earlier receiver through x and on. Else empty.
    CausticPath rough_chain;
    Surface surface;                 // at x
    uint64_t receives = 0;           // LinkSets of x
    CameraSubpath camera_subpath{};  // to x
    bool crossed_caster = false;  // went straight through a transparent part since the last vertex
    // Density of the scattering at x (1/sr), for the weight against next event estimation. Closures
    // with glints state that of the footprint instead.
    float pdf_direct = 0.0f;
    std::optional<GlintDensity> glints{};

    void begin_at_camera(const Camera& camera, const Ray& ray) {
        stage = Stage::chain;
        caustic = camera_path(camera, ray.origin, ray.direction);
    }
    // x as the choice of a light saw it. Valid after a scattering at x.
    LitPoint lit_point() const {
        return {caustic.x, caustic.sides.below ? Vec3(0.0f) : caustic.sides.ng, receives};
    }
    // Whether the part of the path that is remembered begins with a smooth scattering.
    bool has_scattered() const { return stage != Stage::unconnected && !caustic.from_camera; }
    // Sets the direction from x to wi. Other techniques know the path's vertices alone, so wi must
    // lead from vertex to vertex; rays start a little beside them.
    void set_direction(const Scene& scene, const Vec3& wi) {
        if (stage != Stage::scattered) return;
        caustic.pdf_omega = eval(surface.closures, surface.ng, surface.wo, wi).pdf_omega;
        set_film_density(scene, camera_subpath, surface.hit, surface.wo, wi, caustic);
        pdf_direct = caustic.pdf_omega;
    }
    void set_next(const Scene& scene, const Vec3& p) {
        const Vec3 along = p - caustic.x;
        if (length_squared(along) > 0.0f) set_direction(scene, normalize(along));
    }
    // The subpath up to the next surface that scatters.
    CameraSubpath camera_subpath_to(const Scene& scene, const BounceLimits& limits,
                                    const Surface& next) const;
    // The chain that arrives here, if a rough vertex may continue it; else null, as behind a
    // transparent part of a caster (CausticPath::through_caster).
    const CausticPath* chain_so_far() const {
        if (stage == Stage::unconnected || crossed_caster) return nullptr;
        const CausticPath* chain = rough_chain.count > 0 ? &rough_chain : &caustic;
        return chain->begins_rough && chain->count < kLongestChain ? chain : nullptr;
    }
    // Continues chain_so_far() with a rough vertex; without one, ends it. Call before
    // append_smooth().
    void append_rough(const std::optional<CausticVertex>& vertex) {
        const CausticPath* chain = vertex ? chain_so_far() : nullptr;
        if (chain == nullptr) {
            rough_chain.count = 0;
            return;
        }
        if (chain != &rough_chain) rough_chain = *chain;
        rough_chain.folds = nullptr;  // fold directions do not lead to rough vertices
        rough_chain.append(*vertex);
    }
    // Starts a new chain at the smooth scattering `at`. `before`: the path's bounces when it
    // arrived.
    void append_smooth(const Scene& scene, const Surface& at, const ClosureSample& sample,
                       bool may_receive, const CameraSubpath& camera_subpath_to_it,
                       const BounceCounts& before) {
        const bool reached_by_scattering = has_scattered();
        stage = Stage::scattered;
        pdf_direct = sample.pdf_omega;
        glints.reset();
        receives = scene.instances[at.hit.instance].sets.receives;
        caustic.x = at.p;
        caustic.p_error = at.p_error;
        caustic.sides = {at.ng, has_smooth_transmission(at.closures)};
        caustic.pdf_omega = sample.pdf_omega;
        caustic.receiver = may_receive;
        caustic.from_camera = false;
        caustic.rough_caster = scene.instances[at.hit.instance].rough_caster;
        caustic.begins_rough = !(reached_by_scattering && caustic.rough_caster);
        caustic.through_caster = crossed_caster = false;
        caustic.before = before;
        caustic.camera_subpath = camera_subpath_to_it.bounces;
        caustic.film_density = 0.0f;
        caustic.folds = nullptr;
        caustic.count = 0;
    }
    // Keeps what set_direction() needs. Call after append_smooth() if other techniques share the
    // path.
    void keep(const Surface& at, const CameraSubpath& camera_subpath_to_it) {
        surface = at;
        camera_subpath = camera_subpath_to_it;
    }
    // Tells that closures with glints scattered at x. Call after append_smooth().
    void set_glints(const GlintDensity& of_footprint) { glints = of_footprint; }
    // Continues the chain with a delta interaction, or ends it if that is not with a caster.
    void append_delta(const SurfaceHit& hit, const ClosureSample& sample, const CasterSet& casters) {
        const bool goes_on = stage != Stage::unconnected && sample.on_caster_normal &&
                             casters.of_instance[hit.instance] != kNone &&
                             caustic.count < kLongestChain;
        stage = goes_on ? Stage::chain : Stage::unconnected;
        caustic.through_caster |= crossed_caster;
        rough_chain.through_caster |= crossed_caster;
        crossed_caster = false;
        if (goes_on) {
            const CausticVertex vertex{
                hit, sample.refracted ? Interaction::refraction : Interaction::reflection};
            caustic.append(vertex);
            if (rough_chain.count > 0 && rough_chain.count < kLongestChain)
                rough_chain.append(vertex);
            else
                rough_chain.count = 0;
        } else {
            rough_chain.count = 0;
        }
    }
    void append_transparent(const Instance& instance) { crossed_caster |= instance.turns_light(); }
};

// A light path so far: a chain, which may be empty, to the first receiver or rough caster; then
// smooth scatterings with chains between them.
struct LightHistory {
    struct Vertex {
        Vec3 p;
        CausticVertex vertex;  // without `probability`, which chain_throughput() fills in
    };
    // Interactions with casters since the light or the last scattering; the first `count` are
    // valid.
    std::array<Vertex, kLongestChain> vertices;
    uint32_t count = 0;
    bool crossed_caster = false;  // straight through a part of one since the last vertex
    bool through_caster = false;  // or between earlier ones

    // Of a path that has scattered: the same path as the camera would record it, with its
    // throughput. film_density lacks the factor of the next vertex.
    CausticPath path{};
    Spectrum throughput{0.0f};
    Vec3 last{0.0f};  // point of the last scattering

    bool has_scattered() const { return path.camera_subpath.scatterings > 0; }
    // Interactions between the light and the receiver.
    uint32_t chain_length() const { return has_scattered() ? path.count : count; }
    // Continues the chain with a delta interaction; false if it cannot.
    bool append_delta(const Surface& surface, const ClosureSample& sample, const CasterSet& casters);
    void append_transparent(const Instance& instance) {
        crossed_caster = crossed_caster || instance.turns_light();
    }
    // The path of light that has arrived at `surface`, recorded from the receiver x on as a camera
    // path would be. film_density lacks the factor of `surface`. Empty if no light arrives this
    // way. `light_visibility`: of a light that shines on the surface directly; closures whose rays
    // do not see it get nothing.
    struct Arrival {
        CausticPath path;
        Spectrum throughput;  // from this surface to the light, over the densities before x
    };
    std::optional<Arrival> arrive(const Scene& scene, const ChainEnd& end,
                                  uint32_t light_visibility, const Surface& surface) const;
    // Scatters at the surface; `pdf` (1/sr) is the density of the direction that the path takes.
    void append_smooth(const Surface& surface, const Arrival& arrival, float pdf);

private:
    // Unit direction from p to the path's vertex before it, or to the light.
    Vec3 direction_back(const ChainEnd& end, const Vec3& p) const;
    // Appends the chain's vertices in reverse order, from the receiver on.
    void append_back(CausticPath& back) const;
};

}  // namespace spc
