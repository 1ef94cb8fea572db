// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of rough casters.
#pragma once

#include "support/scenes.h"

namespace spc::test {

inline Graph metal(float roughness) {
    return single_shader("bsdf_glossy", {{1, "Color", {0.9f, 0.8f, 0.7f, 1}},
                                         {1, "Roughness", {roughness, 0, 0, 0}}});
}
inline Graph frosted_glass(float roughness) {
    return single_shader("bsdf_glass", {{1, "Color", {1, 1, 1, 1}},
                                        {1, "Roughness", {roughness, 0, 0, 0}},
                                        {1, "IOR", {1.45f, 0, 0, 0}}});
}

}  // namespace spc::test
