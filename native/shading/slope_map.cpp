// SPDX-License-Identifier: GPL-3.0-or-later
// In which normal map of a material glints are looked for.
#include "shading/compiler.h"

#include <fmt/format.h>

namespace spc {
namespace {

// Lobes that are wider than the slopes of most maps show no glints: evaluating them where the ray
// hit is as good and costs less.
constexpr float kWidestAlpha = 0.16f;  // roughness 0.4

class Finder {
public:
    Finder(const ExprBuilder& expr, GlintsMode mode, std::span<const Image> images,
           std::vector<ClosureTerm>& terms)
        : expr_(expr), mode_(mode), images_(images), terms_(terms) {}

    SlopeMap run() {
        SlopeMap map;
        if (mode_ == GlintsMode::off) return map;
        ExprId normal = kNoExpr;
        int count = 0;
        for (ClosureTerm& term : terms_) {
            if (term.op != ClosureOp::glossy && term.op != ClosureOp::metal &&
                term.op != ClosureOp::coated)
                continue;
            std::string reason = why_not(term);
            if (reason.empty() && normal == kNoExpr) reason = read_normal(term.normal(), map);
            const bool fits = normal == kNoExpr || (term.normal() == normal && count < kMaxGlints);
            if (!reason.empty() || !fits) {
                // Told where there is no map at all.
                reasons_ += (reasons_.empty() ? "" : "; ") + term.label + ": " + reason;
                continue;
            }
            normal = term.normal();
            term.on_slope_map = true;
            ++count;
            map.why += (map.why.empty() ? "" : "; ") + term.label;
            if (expr_.is_constant(term.alpha()))
                map.why +=
                    ", roughness " + fmt::format("{:.4g}", std::sqrt(expr_.scalar(term.alpha())));
        }
        if (normal == kNoExpr) {
            map = {};
            if (mode_ == GlintsMode::on)
                map.why_not = reasons_.empty() ? "no glossy closure" : reasons_;
        }
        return map;
    }

private:
    std::string why_not(const ClosureTerm& term) const {
        if (term.normal() == kNoExpr) return "no normal map";
        if (!expr_.is_constant(term.alpha()))
            return mode_ == GlintsMode::on ? "" : "roughness varies";
        const float alpha = expr_.scalar(term.alpha());
        const bool wide = mode_ == GlintsMode::automatic && alpha > kWidestAlpha;
        if (wide || alpha <= kDeltaAlpha)
            return "roughness " + fmt::format("{:.4g}", std::sqrt(alpha));
        return "";
    }

    // Fills `map`, or says why that cannot be.
    std::string read_normal(ExprId id, SlopeMap& map) const {
        map = {};
        const Expr& normal = expr_[id];
        if (normal.op != Op::normal_map) return "its normal is not a Normal Map node";
        if (normal.mode != static_cast<uint8_t>(NormalSpace::tangent))
            return "its normal map is not in tangent space";
        if (!expr_.is_constant(normal.in[0])) return "the strength of its normal map varies";
        const float strength = expr_.scalar(normal.in[0]);
        if (!(strength > 0.0f)) return "the strength of its normal map is 0";
        const Expr& image = expr_[normal.in[1]];
        if (image.op != Op::image) return "its normal map is not an image alone";
        if (mode_interpolation(image.mode) != Interpolation::linear)
            return "its normal map is not interpolated linearly";
        if (mode_extension(image.mode) != Extension::repeat)
            return "its normal map is not repeated";
        const Image& texels = images_[image.index];
        if (texels.srgb_encoded) return "its normal map is not Non-Color data";
        if (mode_straight(image.mode) && texels.premultiplied) return "its normal map has an alpha";
        const Expr* at = &expr_[image.in[0]];
        if (at->op == Op::affine) {
            const std::array<float, 12>& m = expr_.matrix(at->index);
            map.to_image = {Vec2(m[0], m[1]), Vec2(m[4], m[5])};
            map.offset = {m[3], m[7]};
            at = &expr_[at->in[0]];
        }
        if (at->op != Op::uv)
            return "its normal map is not placed by a UV map and a constant Mapping";
        map.image = image.index;
        map.uv_layer = at->index;
        map.tangent_layer = normal.index;
        map.strength = strength;
        return "";
    }

    const ExprBuilder& expr_;
    GlintsMode mode_;
    std::span<const Image> images_;
    std::vector<ClosureTerm>& terms_;
    std::string reasons_;
};

}  // namespace

SlopeMap find_slope_map(const ExprBuilder& expr, GlintsMode mode, std::span<const Image> images,
                        std::vector<ClosureTerm>& terms) {
    return Finder(expr, mode, images, terms).run();
}

}  // namespace spc
