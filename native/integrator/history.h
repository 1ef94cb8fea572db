// SPDX-License-Identifier: GPL-3.0-or-later
// What a path remembers: how its last light connections were sampled, for MIS and ownership, and
// its bounce counts.
#pragma once

#include "integrator/path.h"

namespace spc {

struct BounceCounts {
    uint32_t total = 0, diffuse = 0, glossy = 0, transmission = 0, transparent = 0;

    void add(BounceKind kind) {
        switch (kind) {
            case BounceKind::diffuse: ++diffuse; break;
            case BounceKind::glossy: ++glossy; break;
            case BounceKind::transmission: ++transmission; break;
            case BounceKind::transparent:
                ++transparent;
                return;  // not counted in the total, as in Cycles
        }
        ++total;
    }
    // Past a limit a path still sees lights, but no more surfaces: its last vertex had its direct
    // light already.
    bool exhausted(const BounceLimits& limits) const {
        return total > limits.total || diffuse > limits.diffuse || glossy > limits.glossy ||
               transmission > limits.transmission;
    }
    // Surfaces that the path may still look through, and every shadow ray that it casts.
    uint32_t transparent_left(const BounceLimits& limits) const {
        return limits.transparent - std::min(limits.transparent, transparent);
    }
    // Whether a vertex here may scatter once more, by whichever smooth closure, and be lit at the
    // next vertex.
    bool leaves_room_for_chain(const BounceLimits& limits) const {
        return total < limits.total && diffuse < limits.diffuse && glossy < limits.glossy &&
               transmission < limits.transmission;
    }
};

// The stretch of path since the last vertex that next event estimation or the manifold could have
// connected.
struct PathHistory {
    enum class Stage : uint8_t {
        unconnected,  // from the camera through deltas alone, or beyond a chain that nobody else can find
        scattered,  // one smooth scattering at x: shared with next event estimation
        chain       // then one delta interaction that the manifold owns
    };
    Stage stage = Stage::unconnected;
    TracedChain chain;            // as far as it has come
    bool receiver = false;        // x may begin a chain (role, closures, bounces left)
    bool through_caster = false;  // passed straight through part of a caster since x

    void append_smooth(const Surface& surface, float pdf, bool may_receive) {
        stage = Stage::scattered;
        chain = {.x = surface.p,
                 .sides = {surface.ng, has_smooth_transmission(surface.closures)},
                 .pdf_omega = pdf};
        receiver = may_receive;
        through_caster = false;
    }
    // Whether the manifold shares the chain that this delta interaction continues; the caller then
    // sets chain.lobe_probability.
    bool append_delta(const SurfaceHit& hit, const ClosureSample& sample,
                      const ManifoldSettings& settings, const CasterSet& casters) {
        const Interaction turn =
            sample.refracted ? Interaction::refraction : Interaction::reflection;
        const ChainClass kind{receiver, hit.instance, sample.on_caster_normal, turn, through_caster};
        const bool owned = stage == Stage::scattered && manifold_owns(settings, casters, kind);
        stage = owned ? Stage::chain : Stage::unconnected;
        chain.vertex = hit;
        chain.interaction = turn;
        return owned;
    }
    void append_transparent(const Instance& instance) {
        if (stage == Stage::scattered && instance.caster) through_caster = true;
    }
};

}  // namespace spc
