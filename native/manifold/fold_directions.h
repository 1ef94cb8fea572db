// SPDX-License-Identifier: GPL-3.0-or-later
// Directions from a receiver in which light may arrive that light sheets gather at their folds.
//
// At a fold the geometry term of a chain has no bound. Who draws light points meets such a chain
// rarely and then finds much of it. Who draws directions at the receiver finds it without that term:
// next to folds they are drawn where the beams that fold over there come from.
#pragma once

#include "manifold/sheet_pool.h"

namespace spc {

class FoldDirections {
public:
    FoldDirections() = default;  // nowhere
    // None where the folds that meet at x are too many for each of them to tell anything.
    FoldDirections(const LightSheets& sheets, const Vec3& x);

    bool empty() const { return parallelograms_.empty(); }
    // Unit, from x. Towards a point of one parallelogram, all alike. Empty where that is at x itself.
    std::optional<Vec3> sample(const Vec3& u) const;
    float pdf(const Vec3& w) const;  // 1/sr

private:
    Vec3 x_;
    std::vector<const FoldParallelogram*> parallelograms_;
};

}  // namespace spc
