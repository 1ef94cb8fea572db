// SPDX-License-Identifier: GPL-3.0-or-later
// Camera chains: specular chains from the camera itself to the lights that it sees in casters. Path
// tracing meets a lamp that is smaller than a pixel rarely, as one bright sample. So chain seeds
// that lead to such lamps are learned before rendering.
#pragma once

#include "manifold/shooting.h"

namespace spc {

struct CameraChains {
    std::vector<std::vector<ChainSeed>> chain_seeds;  // of each light
    // Estimates for each sample of the picture. Each shoots all chain seeds of one light.
    double estimates = 0.0;
    // Random searches for each pixel and sample of the picture. A search starts in its pixel and
    // looks for a chain that is seen in that pixel and that no chain seed finds.
    double searches = 0.0;
    bool has(uint32_t light) const { return !chain_seeds[light].empty(); }
};

}  // namespace spc
