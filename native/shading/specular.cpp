// SPDX-License-Identifier: GPL-3.0-or-later
// What the manifold may walk on: the delta closures of a material that share one normal and one
// index.
#include "shading/compiler.h"

#include <fmt/format.h>

namespace spc {
namespace {

class Finder {
public:
    Finder(const ExprBuilder& expr, const ResolvedGraph& graph, std::vector<ClosureTerm>& terms)
        : expr_(expr), graph_(graph), terms_(terms) {}

    SpecularInterface run(ExprId& caster_normal, std::vector<std::string>& warnings) {
        SpecularInterface result;
        const ClosureTerm* first = leading_term();
        if (first == nullptr) {
            result.why_not = reasons_.empty() ? "no specular closure" : reasons_;
            return result;
        }
        caster_normal = first->normal();
        result.mapped_normal = caster_normal != kNoExpr;
        if (refracts(*first)) result.ior = expr_.scalar(first->ior());
        for (ClosureTerm& term : terms_) {
            if (!why_not(term).empty() || !is_specular(term)) continue;
            const bool other_normal = term.normal() != caster_normal;
            if (other_normal || (refracts(term) && expr_.scalar(term.ior()) != result.ior)) {
                warnings.push_back(where(graph_.name, *graph_.nodes[term.node].graph) + ": " +
                                   term.label + " has another " + (other_normal ? "normal" : "IOR") +
                                   " than " + first->label + " and is left to path tracing");
                continue;
            }
            term.on_caster_normal = true;
            result.reflects |= reflects(term);
            result.refracts |= refracts(term);
            result.why += (result.why.empty() ? "" : "; ") + text(term);
        }
        return result;
    }

private:
    static bool is_specular(const ClosureTerm& term) {
        return term.op != ClosureOp::lambert && term.op != ClosureOp::transparent;
    }
    static bool reflects(const ClosureTerm& term) {
        return term.op != ClosureOp::dielectric || term.modes.reflects;
    }
    static bool refracts(const ClosureTerm& term) {
        return term.op == ClosureOp::dielectric && term.modes.refracts;
    }

    // Empty for a term that can be walked on.
    std::string why_not(const ClosureTerm& term) const {
        if (!is_specular(term)) return "";
        if (!expr_.is_constant(term.alpha())) return "roughness varies";
        const float alpha = expr_.scalar(term.alpha());
        if (alpha > kDeltaAlpha) return "roughness " + fmt::format("{:.4g}", std::sqrt(alpha));
        if (term.op == ClosureOp::dielectric && !expr_.is_constant(term.ior())) return "IOR varies";
        return "";
    }

    // The first that refracts, as only refractions care for the index; else the first that
    // reflects.
    const ClosureTerm* leading_term() {
        const ClosureTerm* leading = nullptr;
        for (const ClosureTerm& term : terms_) {
            if (!is_specular(term)) continue;
            const std::string reason = why_not(term);
            if (!reason.empty())
                reasons_ += (reasons_.empty() ? "" : "; ") + std::string(term.label) + ": " + reason;
            else if (leading == nullptr || (refracts(term) && !refracts(*leading)))
                leading = &term;
        }
        return leading;
    }

    std::string text(const ClosureTerm& term) const {
        std::string s = term.label + ", roughness " +
                        fmt::format("{:.4g}", std::sqrt(expr_.scalar(term.alpha())));
        if (term.op == ClosureOp::dielectric)
            s += ", IOR " + fmt::format("{:.4g}", expr_.scalar(term.ior()));
        if (term.op == ClosureOp::coated && expr_.is_constant(term.ior()))
            s += ", IOR " + fmt::format("{:.4g}", expr_.scalar(term.ior()));
        if (term.normal() != kNoExpr) s += ", mapped normal";
        return s;
    }

    const ExprBuilder& expr_;
    const ResolvedGraph& graph_;
    std::vector<ClosureTerm>& terms_;
    std::string reasons_;
};

}  // namespace

SpecularInterface find_specular_interface(const ExprBuilder& expr, const ResolvedGraph& graph,
                                          std::vector<ClosureTerm>& terms, ExprId& caster_normal,
                                          std::vector<std::string>& warnings) {
    return Finder(expr, graph, terms).run(caster_normal, warnings);
}

}  // namespace spc
