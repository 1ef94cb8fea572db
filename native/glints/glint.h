// SPDX-License-Identifier: GPL-3.0-or-later
// Glints: what a narrow lobe on a normal map finer than a pixel does with the light from one
// direction, averaged over the pixel's footprint.
//
// Far field [Zeltner20 Sec. 4.5]: within a footprint the directions to camera and light, the
// interpolated normal and the lobe's parameters are those of one point; only the map's normal
// varies. Unbiased otherwise, for lobes of any width but zero.
#pragma once

#include "glints/footprint.h"
#include "glints/slope_field.h"

namespace spc {

// The fields of all maps in which glints are looked for.
struct GlintSet {
    std::vector<SlopeField> fields;
    std::vector<uint32_t> of_material;  // index into `fields`, or kNone

    size_t memory_bytes() const;
};
// Tells in `report` which materials glint and which do not though they were asked to.
GlintSet build_glints(const Scene& scene, std::vector<std::string>& report);

struct GlintStats {
    uint64_t estimates = 0;
    uint64_t nodes = 0;   // of slope fields that were looked at
    uint64_t points = 0;  // of the map at which lobes were evaluated
    void add(const GlintStats& other) {
        estimates += other.estimates;
        nodes += other.nodes;
        points += other.points;
    }
};

// The lobes of a surface over a footprint.
class GlintPoint {
public:
    // Empty where there is nothing to average: no such lobe, or a footprint within a texel.
    // `distance` is that of the surface along the ray.
    static std::optional<GlintPoint> at(const GlintSet& glints, const Scene& scene,
                                        const Surface& surface, const RayDual& ray, double distance,
                                        const PixelKernel& pixel);

    // About the density with which closure sampling, at the points of the footprint, takes the
    // direction, 1/sr; never 0. From moments of the slopes alone, so that all samples of a pixel
    // agree.
    float pdf(const Vec3& wi) const;

    // An estimate of f |cos| averaged over the pixel. Its variance is at most the mean squared over
    // `points`, where the moments tell the mean: about so many points are evaluated where there
    // are glints.
    Spectrum f_cos(const Vec3& wi, float points, uint64_t seed, GlintStats& stats) const;

private:
    friend class GlintSearch;
    struct Target;

    Target target_of(const Vec3& wi) const;
    float mean_density(const GlintLobe& lobe, const Target& target) const;

    const SlopeField* field_ = nullptr;
    const ClosureList* closures_ = nullptr;
    PixelKernel pixel_{};
    Footprint footprint_{};
    Vec3 wo_, ng_;
    Vec2 lower_, upper_;  // box around the footprint, texels
    SlopeMoments moments_;
    std::array<Vec2, 2> to_film_;  // rows: film from texels
};

}  // namespace spc
