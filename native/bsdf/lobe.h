// SPDX-License-Identifier: GPL-3.0-or-later
// What closure.cpp asks of one closure of weight 1. Directions as in closure.h.
#pragma once

#include "bsdf/closure_traits.h"
#include "math/vec.h"

namespace spc {

struct LobeEval {
    Spectrum f_cos{0.0f};    // f |cos|
    float pdf_omega = 0.0f;  // 1/sr; zero for a delta
};

// One direction, before the geometry has its say. Empty where eval_lobe() has no density: a lobe
// may send light to the wrong side of its normal, where another closure of the list may have some.
struct LobeSample {
    Vec3 wi;
    BounceKind kind;
    bool delta = false;
    // For a delta lobe alone: its throughput, and its probability within the closure.
    Spectrum throughput{0.0f};
    float probability = 1.0f;
};

}  // namespace spc
