// SPDX-License-Identifier: GPL-3.0-or-later
#include "glints/slope_frame.h"

namespace spc {

SlopeJet SlopeFrame::taken(const SlopeJet& jet) const {
    if (strength == 1.0f) return jet;
    const Vec3 raised = w[0] * jet.slope.x + w[1] * jet.slope.y;
    const float k = factor(length(raised)), r = std::sqrt(1.0f + length_squared(raised));
    const float dk_dr = -k * k * (1.0f - strength) / strength;
    const auto by = [&](const Vec2& d) {
        const float dr = dot(raised, w[0] * d.x + w[1] * d.y) / r;
        return d * k + jet.slope * (dk_dr * dr);
    };
    return {jet.slope * k, by(jet.by_s), by(jet.by_t)};
}

// k falls with the rise, which differs from that in the middle by no more than the box is wide.
SlopeBounds SlopeFrame::taken(const SlopeBounds& bounds) const {
    if (strength == 1.0f) return bounds;
    const Vec2 half = (bounds.upper - bounds.lower) * 0.5f;
    const float middle = rise((bounds.lower + bounds.upper) * 0.5f),
                spread = length(w[0]) * half.x + length(w[1]) * half.y;
    const float least = factor(middle + spread), most = factor(std::max(middle - spread, 0.0f));
    const auto times = [](const Vec2& slope, float positive, float negative) {
        return Vec2(slope.x * (slope.x > 0.0f ? positive : negative),
                    slope.y * (slope.y > 0.0f ? positive : negative));
    };
    return {times(bounds.lower, least, most), times(bounds.upper, most, least)};
}

SlopeMoments SlopeFrame::taken(const SlopeMoments& m) const {
    if (strength == 1.0f) return m;
    const float k = factor(rise(m.mean)), k2 = k * k;
    return {m.mean * k, m.aa * k2, m.ab * k2, m.bb * k2};
}

}  // namespace spc
