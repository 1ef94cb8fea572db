// SPDX-License-Identifier: GPL-3.0-or-later
// What a path remembers: how its last light connections were sampled, for MIS and ownership, and
// its bounce counts. The histories of a path from the camera and of one from the light describe the
// same path of light alike.
#pragma once

#include "integrator/path.h"

namespace spc {

constexpr uint32_t ray_kind_after(BounceKind kind) {
    return kind == BounceKind::diffuse  ? kVisibleDiffuse
           : kind == BounceKind::glossy ? kVisibleGlossy
                                        : kVisibleTransmission;
}

// The kinds of scattering by whose rays a light of this visibility would be found.
inline uint32_t kinds_seeing(uint32_t visibility) {
    uint32_t kinds = 0;
    for (const BounceKind kind : {BounceKind::diffuse, BounceKind::glossy, BounceKind::transmission})
        if ((visibility & ray_kind_after(kind)) != 0) kinds |= kind_bit(kind);
    return kinds;
}

// The stretch of path since the last vertex that next event estimation or the manifold could have
// connected.
struct PathHistory {
    enum class Stage : uint8_t {
        unconnected,  // from the camera through deltas alone, or beyond a chain that nobody else can find
        scattered,  // one smooth scattering at x: shared with next event estimation
        chain  // then, or from the camera where that may see camera chains, interactions with casters
    };
    Stage stage = Stage::unconnected;
    CausticPath caustic;  // as far as it has come, without the probabilities of its vertices' lobes
    // Where that began on a rough surface: the chain from an earlier x to there and on; else empty.
    CausticPath rough_chain;
    Surface surface;                 // at x
    CameraSubpath camera_subpath{};  // to it
    bool crossed_caster = false;     // straight through a part of one, since the last vertex
    // Of the scattering at x, for its share with next event estimation: of its direction or, if it
    // was by closures with glints, of the footprint.
    float pdf_direct = 0.0f;
    std::optional<GlintDensity> glints{};

    void begin_at_camera(const Camera& camera, const Ray& ray) {
        stage = Stage::chain;
        caustic = camera_path(camera, ray.origin, ray.direction);
    }
    // x, as the choice of a light saw it. After a scattering there.
    LitPoint lit_point() const {
        return {caustic.x, caustic.sides.below ? Vec3(0.0f) : caustic.sides.ng};
    }
    // Whether all that is since then has begun with a smooth scattering.
    bool has_scattered() const { return stage != Stage::unconnected && !caustic.from_camera; }
    // The path goes from x in the direction wi: as those see it who know its vertices alone. Rays
    // start beside theirs.
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
    // Of the camera's path to a surface that it meets after the last one.
    CameraSubpath camera_subpath_to(const Scene& scene, const BounceLimits& limits,
                                    const Surface& next) const;
    // A chain that comes here, and may go on with a rough vertex; null if there is none, as behind a
    // transparent part of a caster: CausticPath::through_caster.
    const CausticPath* chain_so_far() const {
        if (stage == Stage::unconnected || crossed_caster) return nullptr;
        const CausticPath* chain = rough_chain.count > 0 ? &rough_chain : &caustic;
        return chain->begins_rough && chain->count < kLongestChain ? chain : nullptr;
    }
    // Goes on from there, before append_smooth(); without a vertex no chain does.
    void append_rough(const std::optional<CausticVertex>& vertex) {
        const CausticPath* chain = vertex ? chain_so_far() : nullptr;
        if (chain == nullptr) {
            rough_chain.count = 0;
            return;
        }
        if (chain != &rough_chain) rough_chain = *chain;
        rough_chain.folds = nullptr;  // no direction next to folds leads to rough vertices
        rough_chain.append(*vertex);
    }
    // `before`: the path's bounces when it came here.
    void append_smooth(const Scene& scene, const Surface& at, const ClosureSample& sample,
                       bool may_receive, const CameraSubpath& camera_subpath_to_it,
                       const BounceCounts& before) {
        const bool reached_by_scattering = has_scattered();
        stage = Stage::scattered;
        pdf_direct = sample.pdf_omega;
        glints.reset();
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
    // After append_smooth(), for set_direction(): where nobody shares paths, nobody needs that.
    void keep(const Surface& at, const CameraSubpath& camera_subpath_to_it) {
        surface = at;
        camera_subpath = camera_subpath_to_it;
    }
    // After append_smooth(): the scattering was by closures with glints.
    void set_glints(const GlintDensity& of_footprint) { glints = of_footprint; }
    // The chain goes on with this delta interaction, if it can.
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

// A light path so far: its chain, which may be empty, then smooth scatterings from the receiver, or
// from a rough caster, on, and chains between them.
struct LightHistory {
    struct Vertex {
        Vec3 p;
        CausticVertex vertex;  // its other probability is chain_throughput()'s
    };
    // Casters since the light or the last scattering; `count` are valid.
    std::array<Vertex, kLongestChain> vertices;
    uint32_t count = 0;
    bool crossed_caster = false;  // straight through a part of one since the last vertex
    bool through_caster = false;  // or between earlier ones

    // Of a path that has scattered: as the camera's has it, film_density but for what comes next,
    // and its throughput.
    CausticPath path{};
    Spectrum throughput{0.0f};
    Vec3 last{0.0f};  // where it scattered

    bool has_scattered() const { return path.camera_subpath.scatterings > 0; }
    // Between the light and the receiver.
    uint32_t chain_length() const { return has_scattered() ? path.count : count; }
    // Whether the chain goes on with this delta interaction.
    bool append_delta(const Surface& surface, const ClosureSample& sample, const CasterSet& casters);
    void append_transparent(const Instance& instance) {
        crossed_caster = crossed_caster || instance.turns_light();
    }
    // The whole path from a surface that the camera sees, or a path from there: `surface` is what
    // it sees. film_density is short of the factor that it has at that surface. Empty where no
    // light goes on that way. `light_visibility`: light that comes straight to a surface shows itself
    // to those closures alone whose rays see it.
    struct Arrival {
        CausticPath path;
        Spectrum throughput;  // of the camera's path from this surface on, over its densities before x
    };
    std::optional<Arrival> arrive(const Scene& scene, const ChainEnd& end,
                                  uint32_t light_visibility, const Surface& surface) const;
    // The path goes on where `arrival` sees the surface from, with a density of `pdf` (1/sr).
    void append_smooth(const Surface& surface, const Arrival& arrival, float pdf);

private:
    // To where the path was before it came to p.
    Vec3 direction_back(const ChainEnd& end, const Vec3& p) const;
    // Adds the vertices to a path that begins at its x.
    void append_back(CausticPath& back) const;
};

}  // namespace spc
