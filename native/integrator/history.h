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
        chain       // then interactions with casters
    };
    Stage stage = Stage::unconnected;
    CausticPath caustic;  // as far as it has come
    // Of the scattering at x, for its share with next event estimation: of its direction or, of
    // closures with glints, a mean over the footprint.
    float pdf_direct = 0.0f;
    bool glints = false;

    void append_smooth(const Surface& surface, float pdf, bool may_receive, float film_per_area) {
        stage = Stage::scattered;
        pdf_direct = pdf;
        glints = false;
        caustic.x = surface.p;
        caustic.sides = {surface.ng, has_smooth_transmission(surface.closures)};
        caustic.pdf_omega = pdf;
        caustic.receiver = may_receive;
        caustic.through_caster = false;
        caustic.film_per_area = film_per_area;
        caustic.count = 0;
    }
    // After append_smooth(): the scattering was by closures with glints.
    void set_glints(float mean_pdf) {
        pdf_direct = mean_pdf;
        glints = true;
    }
    // Whether the chain goes on with this delta interaction; the caller then sets the probability
    // of its lobe.
    bool append_delta(const SurfaceHit& hit, const ClosureSample& sample, const CasterSet& casters) {
        const bool goes_on = stage != Stage::unconnected && sample.on_caster_normal &&
                             casters.of_instance[hit.instance] != kNone &&
                             caustic.count < kLongestChain;
        stage = goes_on ? Stage::chain : Stage::unconnected;
        if (goes_on)
            caustic.vertices[caustic.count++] = {
                hit, sample.refracted ? Interaction::refraction : Interaction::reflection, 0.0f};
        return goes_on;
    }
    void append_transparent(const Instance& instance) {
        if (stage == Stage::scattered && instance.caster) caustic.through_caster = true;
    }
};

}  // namespace spc
