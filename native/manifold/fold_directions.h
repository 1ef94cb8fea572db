// SPDX-License-Identifier: GPL-3.0-or-later
// Directions at a receiver towards the places on casters where light sheets fold over.
//
// At a fold the geometry term of a chain is unbounded. A technique that draws light points meets
// such a chain rarely, and then as a very bright sample. Drawing directions at the receiver does
// not involve that term, so near folds some are drawn towards the beams that fold over there.
#pragma once

#include "manifold/sheet_pool.h"

namespace spc {

class FoldDirections {
public:
    FoldDirections() = default;  // empty
    // Empty if no folds are near x, or too many for their directions to be of use.
    FoldDirections(const LightSheets& sheets, const Vec3& x);

    bool empty() const { return parallelograms_.empty(); }
    // Draws a unit direction from x: towards a uniform point of a parallelogram, each chosen with
    // equal probability. Empty if that point is x itself.
    std::optional<Vec3> sample(const Vec3& u) const;
    float pdf(const Vec3& w) const;  // 1/sr

private:
    Vec3 x_;
    std::vector<const FoldParallelogram*> parallelograms_;
};

}  // namespace spc
