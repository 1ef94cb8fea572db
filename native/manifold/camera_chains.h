// SPDX-License-Identifier: GPL-3.0-or-later
// Lights that the camera sees in casters: chains from the camera itself. A lamp that is small in the
// picture is met by a ray in a pixel now and then, as one bright sample. Where chains come to it is
// learned before rendering.
#pragma once

#include "manifold/shooting.h"

namespace spc {

struct CameraChains {
    std::vector<std::vector<ChainSeed>> chain_seeds;  // of each light
    double estimates =
        0.0;  // for each sample of the picture; each shoots all chain seeds of one light
    // In each pixel of the film for each sample of the picture: random searches, which begin there, for
    // chains that no chain seed comes to and that are seen there.
    double searches = 0.0;
    bool has(uint32_t light) const { return !chain_seeds[light].empty(); }
};

}  // namespace spc
