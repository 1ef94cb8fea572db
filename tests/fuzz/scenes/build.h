// SPDX-License-Identifier: GPL-3.0-or-later
// A plan's scene, committed.
#pragma once

#include "scenes/plan.h"
#include "support/api_scene.h"

namespace spc::fuzz {

// As a camera of `side` x `side` pixels sees it.
test::ScenePtr build(const Plan& plan, uint32_t side);

}  // namespace spc::fuzz
