// SPDX-License-Identifier: GPL-3.0-or-later
#include "manifold/fold_directions.h"

#include "math/warp.h"

namespace spc {

FoldDirections::FoldDirections(const LightSheets& sheets, const Vec3& x) : x_(x) {
    // Time grows with them, while the share that each has of the directions shrinks.
    constexpr size_t kMost = 256;
    for (const std::unique_ptr<const LightSheet>& sheet : sheets.all) {
        if (sheet->find_folds(x, kMost, parallelograms_)) continue;
        parallelograms_.clear();
        return;
    }
}

std::optional<Vec3> FoldDirections::sample(const Vec3& u) const {
    const auto count = static_cast<float>(parallelograms_.size());
    const auto i = std::min(static_cast<size_t>(u.x * count), parallelograms_.size() - 1);
    const FoldParallelogram& parallelogram = *parallelograms_[i];
    const Vec2 b = uniform_triangle({u.y, u.z});
    const Vec3 to = parallelogram.p + parallelogram.e1 * b.x + parallelogram.e2 * b.y - x_;
    const float distance = length(to);
    if (!(distance > 0.0f)) return std::nullopt;
    return to * (1.0f / distance);
}

float FoldDirections::pdf(const Vec3& w) const {
    float sum = 0.0f;
    for (const FoldParallelogram* parallelogram : parallelograms_) {
        const Vec3 normal = cross(parallelogram->e1, parallelogram->e2);
        const float along = dot(normal, w);
        if (along == 0.0f) continue;
        const float scale = 1.0f / along;
        const Vec3 from = parallelogram->p - x_, across = cross(w, from);
        const float t = dot(from, normal) * scale;
        const float b1 = dot(across, parallelogram->e2) * -scale,
                    b2 = dot(across, parallelogram->e1) * scale;
        if (!(t > 0.0f) || !(b1 >= 0.0f) || !(b2 >= 0.0f) || !(b1 + b2 <= 1.0f)) continue;
        sum += 2.0f * sqr(t) * std::abs(scale);  // t^2 / (area |cos|)
    }
    return sum / static_cast<float>(std::max<size_t>(parallelograms_.size(), 1));
}

}  // namespace spc
