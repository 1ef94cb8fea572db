// SPDX-License-Identifier: GPL-3.0-or-later
// What every estimator of glints gets: the site, which is a surface's lobes with a footprint; and
// the target, which is a half-vector in the map's space of slopes.
#pragma once

#include "glints/footprint.h"
#include "glints/slope_field.h"
#include "math/lanes.h"

namespace spc {

// Four boxes of slopes (a, b), by lanes.
struct LaneBounds {
    Lanes a0{}, a1{}, b0{}, b1{};
};

// A half-vector h seen from slopes (a, b). For the normal n = W (a, b, 1), n.h is linear and |n x
// h|^2 quadratic in (a, b); the latter vanishes at `slope`.
struct GlintTarget {
    Vec3 half;             // unit
    Vec3 linear;           // n.h = a x + b y + z
    Vec2 slope;            // slope of h itself
    bool inside;           // h has a slope: it lies on the side of the interpolated normal
    float aa, ab, bb;      // quadratic form of |n x h|^2 around `slope`
    float x_by_y, y_by_x;  // position of its minimum along a line of constant y, or x

    GlintTarget(const SlopeFrame& frame, const Vec3& half);

    float dot_at(const Vec2& s) const { return linear.x * s.x + linear.y * s.y + linear.z; }
    float sine2_at(const Vec2& d) const {
        return aa * d.x * d.x + 2.0f * ab * d.x * d.y + bb * d.y * d.y;
    }
    // Smallest |n x h|^2 in each of four boxes of slopes.
    Lanes least_sine2(const LaneBounds& box) const;
    float least_sine2(const SlopeBounds& box) const {
        return least_sine2({Lanes{} + box.lower.x, Lanes{} + box.upper.x, Lanes{} + box.lower.y,
                            Lanes{} + box.upper.y})[0];
    }
};

// A convex function has its minimum over a box on a side that faces the free minimum.
inline Lanes GlintTarget::least_sine2(const LaneBounds& box) const {
    if (!inside) return Lanes{};
    const Lanes a0 = box.a0 - slope.x, a1 = box.a1 - slope.x, b0 = box.b0 - slope.y,
                b1 = box.b1 - slope.y;
    const auto sine2 = [&](Lanes a, Lanes b) {
        return a * a * aa + a * b * (2.0f * ab) + b * b * bb;
    };
    const Lanes none = Lanes{} + kInfinity, zero{};
    const Lanes side_a = a0 > 0.0f ? a0 : a1, side_b = b0 > 0.0f ? b0 : b1;
    const Lanes by_a = sine2(side_a, min(max(side_a * y_by_x, b0), b1)),
                by_b = sine2(min(max(side_b * x_by_y, a0), a1), side_b);
    const Lanes least =
        min(a0 > 0.0f || a1 < 0.0f ? by_a : none, b0 > 0.0f || b1 < 0.0f ? by_b : none);
    return least == none ? zero : least;
}

// How the squared angle between a normal and h grows with the distance d of their slopes, next to
// h: d^T Q d.
struct SlopeMetric {
    float scale;  // ratio of Q to the target's quadratic form
    float aa, ab, bb;
    // Requires target.inside.
    explicit SlopeMetric(const GlintTarget& target);

    float det() const { return aa * bb - ab * ab; }
    float product(const Vec2& d, const Vec2& e) const {
        return aa * d.x * e.x + ab * (d.x * e.y + d.y * e.x) + bb * d.y * e.y;
    }
};

struct GlintSite {
    uint32_t index;  // of the slope field in GlintSet::fields
    const SlopeField* field;
    const ClosureList* closures;
    PixelKernel pixel;
    SlopeFrame frame;
    // The kernel over the map has the shape of the pixel filter. `axes`: texels per pixel, as
    // columns; `to_film`: the inverse, as rows.
    std::array<Vec2, 2> axes, to_film;
    Vec3 wo, ng;
    Vec2 middle, lower, upper;  // of the kernel and the box around it, texels
    SlopeMoments moments;

    float texels_per_pixel() const {
        return std::abs(axes[0].x * axes[1].y - axes[0].y * axes[1].x);
    }
    // Offset of a texel from the kernel's middle, in pixels.
    Vec2 film_at(const Vec2& texel) const {
        const Vec2 d = texel - middle;
        return {to_film[0].dot(d), to_film[1].dot(d)};
    }
    // The filter's density there, 1/pixel^2.
    float filter_at(const Vec2& texel) const {
        const Vec2 film = film_at(texel);
        return pixel.filter->weight(film.x) * pixel.filter->weight(film.y);
    }

    const GlintLobe& lobe(int i) const { return closures->glints[static_cast<size_t>(i)]; }
    // Weight of lobe i times its Fresnel term, mean of the channels.
    float scale(int i, float cos_wo_h) const;
    // Density of a Beckmann lobe's normals at h, averaged over the footprint as if slopes had a
    // normal distribution [Olano10].
    float normal_slopes_density(float alpha, const GlintTarget& target) const;
    // The same for any lobe, with a tail that falls no faster than the lobe's own.
    float mean_density(const GlintLobe& glint, const GlintTarget& target) const;
};

}  // namespace spc
