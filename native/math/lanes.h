// SPDX-License-Identifier: GPL-3.0-or-later
// Four floats side by side, as the compiler knows them.
#pragma once

namespace spc {

using Lanes = float __attribute__((vector_size(16)));

inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }

}  // namespace spc
