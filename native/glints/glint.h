// SPDX-License-Identifier: GPL-3.0-or-later
// Glints: what a narrow lobe on a normal map or bump finer than a pixel does with the light from one
// direction, averaged over the pixel's footprint.
//
// Far field [Zeltner20 Sec. 4.5]: within a footprint the directions to camera and light, the
// interpolated normal and the lobe's parameters are those of one point; only the map's normal
// varies. Unbiased otherwise, for lobes of any width but zero, but for the methods that say so.
#pragma once

#include "glints/estimators.h"

namespace spc {

// The fields of all maps in which glints are looked for.
struct GlintSet {
    std::vector<SlopeField> fields;
    std::vector<uint32_t> of_material;  // index into `fields`, or kNone

    size_t memory_bytes() const;
};
// Tells in `report` which materials glint and which do not though they were asked to. `threads`
// 0 = all.
GlintSet build_glints(const Scene& scene, uint32_t threads, std::vector<std::string>& report);

enum class GlintMethod : uint8_t {
    search,        // of a pyramid of slopes
    walks,         // with a random number of trials
    walks_biased,  // `set_size` of them: loses the solutions that they miss
    yan            // [Yan16]: biased; a map, a pixel and a lobe are what Gaussians make of them
};

struct GlintSettings {
    GlintMethod method = GlintMethod::search;
    uint32_t set_size = 16;
    const FlakeSet* flakes = nullptr;  // of the set's fields, for `yan` alone
};

// With which closure sampling, at the points of a footprint, takes a direction, 1/sr.
struct GlintDensity {
    float mean = 0.0f;    // about that over all points; never 0
    float facet = 0.0f;   // about the most at one
    float facets = 1.0f;  // about the number of points between which it differs

    // The share of an estimate from `directions` to lights, of density `direct`, of which one is
    // looked at, in light that closure sampling finds, too.
    float share_of_direct(float directions, float direct) const;
};

// The lobes of a surface over a footprint.
class GlintPoint {
public:
    // Empty where there is nothing to average: no such lobe, or a footprint of next to nothing.
    // `distance` is that of the surface along the path's last ray.
    static std::optional<GlintPoint> at(const GlintSet& glints, const GlintSettings& settings,
                                        const Scene& scene, const Surface& surface,
                                        const PathDifferential& path, double distance,
                                        const PixelKernel& pixel);

    // From moments of the slopes alone, so that all samples of a pixel agree.
    GlintDensity density(const Vec3& wi) const;

    // An estimate of f |cos| averaged over the pixel. Only the search asks for a precision.
    Spectrum f_cos(const Vec3& wi, const GlintPrecision& precision, uint64_t seed,
                   GlintStats& stats) const;

private:
    GlintPoint(const GlintSite& site, const GlintSettings& settings)
        : site_(site), settings_(settings) {}

    GlintSite site_;
    GlintSettings settings_;
};

}  // namespace spc
