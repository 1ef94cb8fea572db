// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of sessions that several tests render with.
#pragma once

#include "render/session.h"

#include "support/radiance.h"

namespace spc::test {

inline RenderSettings manifold_settings(uint32_t samples, uint32_t threads) {
    RenderSettings settings;
    settings.integrator.manifold = unbiased_manifold();
    settings.samples = samples;
    settings.threads = threads;
    return settings;
}

// Light sheets and light paths on two threads, of which each caster has what serves it.
inline RenderSettings automatic_settings(uint32_t samples, uint32_t bounces, uint32_t seed) {
    RenderSettings settings = manifold_settings(samples, 2);
    settings.integrator.limits.total = bounces;
    settings.integrator.manifold.finder = ChainFinder::sheets;
    settings.light_tracing = true;
    settings.chooses = true;
    settings.seed = seed;
    return settings;
}

}  // namespace spc::test
