// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers side by side, as the compiler knows them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace spc {

// As many floats, and words of their size, as one likes; the compiler cuts them into registers.
template <size_t Count>
struct LanesOf {
    typedef float Floats __attribute__((vector_size(4 * Count)));    // NOLINT(modernize-use-using)
    typedef int32_t Ints __attribute__((vector_size(4 * Count)));    // NOLINT(modernize-use-using)
    typedef uint32_t Words __attribute__((vector_size(4 * Count)));  // NOLINT(modernize-use-using)
};
using Lanes = LanesOf<4>::Floats;

inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }

}  // namespace spc
