// SPDX-License-Identifier: GPL-3.0-or-later
// In which normal or height map of a material glints are looked for.
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
           std::span<const AttributeName> attributes, std::vector<ClosureTerm>& terms)
        : expr_(expr), mode_(mode), images_(images), attributes_(attributes), terms_(terms) {}

    SlopeMap run() {
        SlopeMap map;
        if (mode_ == GlintsMode::off) return map;
        ExprId normal = kNoExpr;
        int count = 0;
        for (ClosureTerm& term : terms_) {
            if (!term.row().may_glint) continue;
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
        if (term.normal() == kNoExpr) return "no normal map or bump";
        if (term.grain.exists()) return "its facets are spread along a grain";
        if (!expr_.is_constant(term.alpha()))
            return mode_ == GlintsMode::on ? "" : "roughness varies";
        const float alpha = expr_.scalar(term.alpha());
        const bool wide = mode_ == GlintsMode::automatic && alpha > kWidestAlpha;
        if (wide || alpha <= kDeltaAlpha)
            return "roughness " + fmt::format("{:.4g}", std::sqrt(alpha));
        return "";
    }

    // These fill `map`, or say why that cannot be.
    std::string read_normal(ExprId id, SlopeMap& map) const {
        map = {};
        const Expr& normal = expr_[id];
        if (normal.op == Op::space_normal) return "its normal map is not in tangent space";
        if (normal.op == Op::tangent_normal) return read_normal_map(normal, map);
        if (normal.op == Op::bump) return read_bump(normal, map);
        return "its normal is not a Normal Map or Bump node";
    }

    std::string read_normal_map(const Expr& normal, SlopeMap& map) const {
        const std::string reason = read_strength(normal.in[0], "normal map", map);
        if (!reason.empty()) return reason;
        const Expr& image = expr_[normal.in[1]];
        if (image.op != Op::image) return "its normal map is not an image alone";
        if (mode_interpolation(image.mode) != Interpolation::linear)
            return "its normal map is not interpolated linearly";
        map.tangent_layer = normal.index;
        return read_image(image, "normal map", map);
    }

    // However its image would be filtered elsewhere: heights are smooth.
    std::string read_bump(const Expr& bump, SlopeMap& map) const {
        if (bump.in[2] != kNoExpr) return "its bump rises from another normal";
        const std::string reason = read_strength(bump.in[0], "bump", map);
        if (!reason.empty()) return reason;
        if (map.strength > 1.0f) return "the strength of its bump is above 1";
        if (!expr_.is_constant(bump.in[1])) return "the distance of its bump varies";
        map.distance = expr_.scalar(bump.in[1]) * (bump.mode != 0 ? -1.0f : 1.0f);
        if (map.distance == 0.0f) return "the distance of its bump is 0";
        const Expr& height = expr_[static_cast<ExprId>(bump.index)];
        if (height.op != Op::luminance || expr_[height.in[0]].op != Op::image)
            return "its height is not the colour of an image alone";
        map.relief = Relief::heights;
        const std::string why_not = read_image(expr_[height.in[0]], "height map", map);
        map.tangent_layer = map.uv_layer;
        return why_not;
    }

    std::string read_strength(ExprId strength, const char* of, SlopeMap& map) const {
        if (!expr_.is_constant(strength)) return fmt::format("the strength of its {} varies", of);
        map.strength = expr_.scalar(strength);
        return map.strength > 0.0f ? "" : fmt::format("the strength of its {} is 0", of);
    }

    // The image, and where it lies on the surface.
    std::string read_image(const Expr& image, const char* what, SlopeMap& map) const {
        const auto its = [&](const char* fault) { return fmt::format("its {} {}", what, fault); };
        if (mode_extension(image.mode) != Extension::repeat) return its("is not repeated");
        const Image& texels = images_[image.index];
        if (texels.srgb_encoded) return its("is not Non-Color data");
        if (mode_straight(image.mode) && texels.premultiplied) return its("has an alpha");
        const Expr* at = &expr_[image.in[0]];
        if (at->op == Op::affine) {
            const std::vector<float>& m = expr_.block_values(at->index);
            map.to_image = {Vec2(m[0], m[1]), Vec2(m[4], m[5])};
            map.offset = {m[3], m[7]};
            at = &expr_[at->in[0]];
        }
        if (at->op != Op::attribute || attributes_[at->index].kind != AttributeKind::uv)
            return its("is not placed by a UV map and a constant Mapping");
        map.image = image.index;
        map.uv_layer = at->index;
        return "";
    }

    const ExprBuilder& expr_;
    GlintsMode mode_;
    std::span<const Image> images_;
    std::span<const AttributeName> attributes_;
    std::vector<ClosureTerm>& terms_;
    std::string reasons_;
};

}  // namespace

SlopeMap find_slope_map(const ExprBuilder& expr, GlintsMode mode, std::span<const Image> images,
                        std::span<const AttributeName> attributes, std::vector<ClosureTerm>& terms) {
    return Finder(expr, mode, images, attributes, terms).run();
}

}  // namespace spc
