// SPDX-License-Identifier: GPL-3.0-or-later
// What a path remembers: how its last light connections were sampled, for MIS and ownership, and
// its bounce counts.
#pragma once

#include "integrator/path.h"

namespace spc {

// The stretch of path since the last vertex that next event estimation or the manifold could have
// connected.
struct PathHistory {
    enum class Stage : uint8_t {
        unconnected,  // from the camera through deltas alone, or beyond a chain that nobody else can find
        scattered,  // one smooth scattering at x: shared with next event estimation
        chain       // then interactions with casters
    };
    Stage stage = Stage::unconnected;
    CausticPath caustic;         // as far as it has come
    bool passed_caster = false;  // straight through a part of one, since the last vertex

    // `before`: the path's bounces when it came here.
    void append_smooth(const Surface& surface, float pdf, bool may_receive, float film_per_area,
                       const BounceCounts& before) {
        stage = Stage::scattered;
        caustic.x = surface.p;
        caustic.sides = {surface.ng, has_smooth_transmission(surface.closures)};
        caustic.pdf_omega = pdf;
        caustic.receiver = may_receive;
        caustic.through_caster = passed_caster = false;
        caustic.before = before;
        caustic.film_per_area = film_per_area;
        caustic.count = 0;
    }
    // Whether the chain goes on with this delta interaction; the caller then sets the probability
    // of its lobe.
    bool append_delta(const SurfaceHit& hit, const ClosureSample& sample, const CasterSet& casters) {
        const bool goes_on = stage != Stage::unconnected && sample.on_caster_normal &&
                             casters.of_instance[hit.instance] != kNone &&
                             caustic.count < kLongestChain;
        stage = goes_on ? Stage::chain : Stage::unconnected;
        caustic.through_caster |= passed_caster;
        passed_caster = false;
        if (goes_on)
            caustic.vertices[caustic.count++] = {
                hit, sample.refracted ? Interaction::refraction : Interaction::reflection, 0.0f};
        return goes_on;
    }
    void append_transparent(const Instance& instance) {
        passed_caster |= instance.caster;
    }
};

}  // namespace spc
