// SPDX-License-Identifier: GPL-3.0-or-later
// What the manifold may walk on: the delta closures of a material that share one normal and one
// index.
#include "shading/compiler.h"

#include <fmt/format.h>

namespace spc {
namespace {

// Why a term may not be part of an interface; an empty string if it may.
using Refusal = std::string (*)(const ExprBuilder&, const ClosureTerm&);

class Finder {
public:
    Finder(const ExprBuilder& expr, const ResolvedGraph& graph, std::vector<ClosureTerm>& terms,
           Refusal refusal)
        : expr_(expr), graph_(graph), terms_(terms), refusal_(refusal) {}

    SpecularInterface run(ExprId& caster_normal, std::vector<std::string>& warnings) {
        SpecularInterface result;
        const ClosureTerm* first = leading_term();
        if (first == nullptr) {
            result.why_not = reasons_.empty() ? "no specular closure" : reasons_;
            return result;
        }
        caster_normal = first->normal();
        result.mapped_normal = caster_normal != kNoExpr;
        if (first->refracts()) result.ior = expr_.scalar(first->ior());
        const float alpha = expr_.scalar(first->alpha());
        if (alpha > kDeltaAlpha) {
            result.alpha = alpha;
            result.model = first->modes.model;
        }
        for (ClosureTerm& term : terms_) {
            if (!why_not(term).empty() || !term.row().has_facets()) continue;
            const char* other = difference(term, *first, result);
            if (other != nullptr) {
                warnings.push_back(
                    fmt::format("{}: {} has another {} than {} and is left to path tracing",
                                where(graph_.name, *graph_.nodes[term.node].graph), term.label,
                                other, first->label));
                continue;
            }
            term.on_caster_normal = true;
            result.reflects |= term.reflects();
            result.refracts |= term.refracts();
            if (!result.why.empty()) result.why += "; ";
            result.why += text(term);
        }
        return result;
    }

private:
    std::string why_not(const ClosureTerm& term) const {
        return term.row().has_facets() ? refusal_(expr_, term) : "";
    }

    // In what a term does not belong to the interface of `first`; null if it does.
    const char* difference(const ClosureTerm& term, const ClosureTerm& first,
                           const SpecularInterface& interface) const {
        if (term.normal() != first.normal()) return "normal";
        if (term.refracts() && expr_.scalar(term.ior()) != interface.ior) return "IOR";
        const bool same =
            expr_.scalar(term.alpha()) == interface.alpha && term.modes.model == interface.model;
        return interface.is_rough() && !same ? "roughness" : nullptr;
    }

    // The first that refracts, as only refractions care for the index; else the first that
    // reflects.
    const ClosureTerm* leading_term() {
        const ClosureTerm* leading = nullptr;
        for (const ClosureTerm& term : terms_) {
            if (!term.row().has_facets()) continue;
            const std::string reason = why_not(term);
            if (!reason.empty())
                reasons_ += (reasons_.empty() ? "" : "; ") + std::string(term.label) + ": " + reason;
            else if (leading == nullptr || (term.refracts() && !leading->refracts()))
                leading = &term;
        }
        return leading;
    }

    std::string text(const ClosureTerm& term) const {
        std::string s = term.label + ", roughness " +
                        fmt::format("{:.4g}", std::sqrt(expr_.scalar(term.alpha())));
        if (term.row().ior != kAbsent && expr_.is_constant(term.ior()))
            s += ", IOR " + fmt::format("{:.4g}", expr_.scalar(term.ior()));
        if (term.normal() != kNoExpr) s += ", mapped normal";
        return s;
    }

    const ExprBuilder& expr_;
    const ResolvedGraph& graph_;
    std::vector<ClosureTerm>& terms_;
    const Refusal refusal_;
    std::string reasons_;
};

std::string not_constant(const ExprBuilder& expr, const ClosureTerm& term) {
    if (!expr.is_constant(term.alpha())) return "roughness varies";
    if (term.row().refraction != kAbsent && !expr.is_constant(term.ior())) return "IOR varies";
    if (term.normal() != kNoExpr && expr.derivatives(term.normal()) < 1)
        return "its normal has no derivatives";
    return "";
}

std::string not_a_delta(const ExprBuilder& expr, const ClosureTerm& term) {
    if (!expr.is_constant(term.alpha())) return "roughness varies";
    const float alpha = expr.scalar(term.alpha());
    if (alpha > kDeltaAlpha) return "roughness " + fmt::format("{:.4g}", std::sqrt(alpha));
    return not_constant(expr, term);
}

std::string not_narrow(const ExprBuilder& expr, const ClosureTerm& term) {
    if (term.row().weak) return "weak beside what it covers";
    if (term.grain.exists()) return "its facets are spread along a grain";
    if (term.row().other_facets) return "its lobe has no facets on which chains turn";
    const std::string varies = not_constant(expr, term);
    if (!varies.empty()) return varies;
    const float alpha = expr.scalar(term.alpha());
    return alpha > kDeltaAlpha && alpha <= kWidestChainAlpha
               ? ""
               : "roughness " + fmt::format("{:.4g}", std::sqrt(alpha));
}

std::string not_narrow_and_plain(const ExprBuilder& expr, const ClosureTerm& term) {
    return term.normal() != kNoExpr ? "mapped normal" : not_narrow(expr, term);
}

}  // namespace

void find_specular_interfaces(const ExprBuilder& expr, const ResolvedGraph& graph,
                              std::vector<ClosureTerm>& terms, Material& material,
                              ExprId& caster_normal, std::vector<std::string>& warnings) {
    material.specular = Finder(expr, graph, terms, not_a_delta).run(caster_normal, warnings);
    if (material.specular.exists()) return;
    std::vector<std::string> unsaid;  // light paths find the rest
    // Facets beside the plain normal first: those beside a map may be left out for its chains.
    for (const Refusal refusal : {not_narrow_and_plain, not_narrow})
        if (!material.rough.exists())
            material.rough = Finder(expr, graph, terms, refusal).run(caster_normal, unsaid);
}

}  // namespace spc
