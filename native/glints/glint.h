// SPDX-License-Identifier: GPL-3.0-or-later
// Glints: light from one direction that a narrow lobe on a normal map or bump reflects, averaged
// over a pixel's footprint, for maps finer than a pixel.
//
// Far field [Zeltner20 Sec. 4.5]: within a footprint only the map's normal varies. Directions to
// camera and light, interpolated normal and parameters of the lobe are those of one point. Apart
// from that the methods are unbiased unless they say otherwise, for lobes of any width but zero.
#pragma once

#include "glints/estimators.h"

namespace spc {

// The slope fields of all maps that may glint.
struct GlintSet {
    // What tells fields apart.
    struct Key {
        const void* texels;  // Image::texels()
        Relief relief;
        float strength;  // of normals; heights have theirs at the surface
        bool operator==(const Key&) const = default;
    };
    std::vector<Shared<SlopeField>> fields;
    std::vector<Key> keys;              // of `fields`
    std::vector<uint32_t> of_material;  // index into `fields`, or kNone

    size_t memory_bytes() const;
};
// Builds those that `before`, if it is not null, does not have; its images must still live.
// `report` receives which materials glint, and which cannot although they were asked to. `threads`
// 0 = all.
GlintSet build_glints(const Scene& scene, uint32_t threads, const GlintSet* before,
                      std::vector<std::string>& report);

enum class GlintMethod : uint8_t {
    search,        // search of a pyramid of slopes
    walks,         // Newton walks with a random number of trials
    walks_biased,  // `set_size` walks: loses the solutions that they miss
    yan            // [Yan16]: map, pixel and lobe as Gaussians; biased
};

struct GlintSettings {
    GlintMethod method = GlintMethod::search;
    uint32_t set_size = 16;
    const FlakeSet* flakes = nullptr;  // flakes of the GlintSet's fields; for `yan` alone
};

// Density (1/sr) with which closure sampling at the points of a footprint takes a direction.
struct GlintDensity {
    float mean = 0.0f;    // approximate mean over all points; never 0
    float facet = 0.0f;   // approximate maximum at one point
    float facets = 1.0f;  // approximate number of points that differ

    // Weight of next event estimation beside closure sampling. It draws `directions` directions of
    // density `direct` each and keeps one.
    float share_of_direct(float directions, float direct) const;
};

// The lobes of a surface, averaged over a footprint.
class GlintPoint {
public:
    // Empty if there is nothing to average: no lobe that glints, or a negligible footprint.
    // `distance`: length of the path's last segment, m.
    static std::optional<GlintPoint> at(const GlintSet& glints, const GlintSettings& settings,
                                        const Scene& scene, const Surface& surface,
                                        const PathDifferential& path, double distance,
                                        const PixelKernel& pixel);

    // Uses the moments of the slopes alone, so that all samples of a pixel agree.
    GlintDensity density(const Vec3& wi) const;

    // An estimate of f |cos| averaged over the pixel. Only the search uses `precision`.
    Spectrum f_cos(const Vec3& wi, const GlintPrecision& precision, uint64_t seed,
                   GlintStats& stats) const;

private:
    GlintPoint(const GlintSite& site, const GlintSettings& settings)
        : site_(site), settings_(settings) {}

    GlintSite site_;
    GlintSettings settings_;
};

}  // namespace spc
