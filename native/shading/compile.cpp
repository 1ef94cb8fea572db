// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"
#include "shading/compiler.h"

#include <fmt/format.h>

namespace spc {
namespace {

bool has_background(const ResolvedGraph& graph) {
    for (uint32_t i : graph.order)
        if (graph.nodes[i].kind->name == std::string_view("background")) return true;
    return false;
}

}  // namespace

Compiler::Compiler(const Graph& graph, std::span<const Image> images)
    : emission(expr.constant(Vec3(0.0f))),
      graph_(resolve(graph, images.size())),
      glints_(graph.glints),
      bump_correction_(graph.bump_correction),
      images_(images),
      outputs_(graph_.nodes.size()),
      absorption_(emission),
      is_world_(has_background(graph_)) {
    for (size_t i = 0; i < outputs_.size(); ++i)
        outputs_[i].assign(graph_.nodes[i].kind->outputs.size(), kNoExpr);
}

ExprId Compiler::convert(ExprId value, SocketType from, SocketType to) {
    if (from == to) return value;
    if (to == SocketType::scalar)
        return from == SocketType::color ? expr.luminance(value) : expr.mean(value);
    return from == SocketType::scalar ? expr.splat(value) : value;
}

ExprId Compiler::input(uint32_t index, int socket) {
    const ResolvedNode& node = graph_.nodes[index];
    const ResolvedInput& input = node.inputs[static_cast<size_t>(socket)];
    const InputSocket& kind = node.kind->inputs[static_cast<size_t>(socket)];
    if (input.from_node != kNone) {
        const SocketType from =
            graph_.nodes[input.from_node].kind->outputs[static_cast<size_t>(input.from_output)].type;
        return convert(output(input.from_node, input.from_output), from, kind.type);
    }
    if (kind.unlinked != Unlinked::constant) return kNoExpr;
    const std::array<float, 3>& value = input.given ? input.value : kind.value;
    return kind.type == SocketType::scalar ? expr.constant(value[0])
                                           : expr.constant(Vec3(value[0], value[1], value[2]));
}

ExprId Compiler::output(uint32_t index, int socket) {
    ExprId& known = outputs_[index][static_cast<size_t>(socket)];
    if (known == kNoExpr) {
        NodeContext context(*this, index);
        known = graph_.nodes[index].kind->value(context, socket);
    }
    return known;
}

uint32_t Compiler::uv_layer(const std::string& name) {
    const auto found = std::find(uv_layers_.begin(), uv_layers_.end(), name);
    const uint32_t index = static_cast<uint32_t>(found - uv_layers_.begin());
    if (found == uv_layers_.end()) uv_layers_.push_back(name);
    return index;
}

void Compiler::warn(uint32_t index, const std::string& text) {
    const std::string warning = where(graph_.name, *graph_.nodes[index].graph) + ": " + text;
    if (std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end())
        warnings_.push_back(warning);
}

void Compiler::add_weight(uint32_t index, ExprId weight) {
    ExprId& sum = shader_weights_[index];
    sum = sum == kNoExpr ? weight : expr.add(sum, weight);
}

void Compiler::add_term(ClosureTerm term) {
    const ClosureOpTraits& row = term.row();
    SPC_ASSERT(term.in.size() == row.arity);
    if (is_black(term.weight())) return;
    if (is_world_) return warn(term.node, std::string(term.label) + " in a background is ignored");
    const bool matched = row.matched_index_is_black && expr.is_constant(term.ior(), 1.0f);
    term.modes.reflects = term.reflects() && scatters(term, row.reflection) && !matched;
    term.modes.refracts = term.refracts() && scatters(term, row.refraction);
    const bool facets = term.modes.reflects || term.modes.refracts;
    if (!facets && !scatters(term, row.diffuse) && !scatters(term, row.straight) && !row.holds_out)
        return;
    if (!facets && row.has_facets()) {  // what lies below the reflection is left
        term.in = {term.weight(), term.normal(), term.operand(row.diffuse),
                   term.operand(row.diffuse_roughness)};
        term.op = ClosureOp::rough_diffuse;
    }
    if (term.op == ClosureOp::rough_diffuse && !term.below.exists() &&
        expr.is_constant(term.in.back(), 0.0f)) {
        term.in.pop_back();
        term.op = ClosureOp::lambert;
    }
    if (term.grain.exists() && expr.is_constant(term.alpha(), 0.0f)) term.grain = {};  // a mirror
    terms_.push_back(std::move(term));
}

void Compiler::check_closure_count() const {
    int count = 0;
    for (const ClosureTerm& term : terms_)
        count += term.row().closures + (term.below.exists() ? 1 : 0);
    if (count <= kMaxClosures) return;
    throw Error(ErrorKind::invalid_argument,
                where(graph_.name, *graph_.nodes[terms_.back().node].graph) + ": " +
                    std::to_string(count) + " closures; at most " + std::to_string(kMaxClosures));
}

// Light that such a lobe scatters stays together.
std::string Compiler::narrow_lobe(const ClosureTerm& term) const {
    constexpr float kWidestAlpha = 0.16f;  // roughness 0.4
    if (!term.row().has_facets() || term.row().weak) return "";
    if (!expr.is_constant(term.alpha())) return term.label + ", roughness varies";
    const float alpha = expr.scalar(term.alpha());
    if (alpha <= kDeltaAlpha || alpha > kWidestAlpha) return "";
    return fmt::format("{}, roughness {:.4g}", term.label, std::sqrt(alpha));
}

// What the rest of the core wants to know without running the program.
void Compiler::describe(Material& material) {
    const auto delta = [&](ExprId alpha) {
        return expr.is_constant(alpha) && expr.scalar(alpha) <= kDeltaAlpha;
    };
    for (const ClosureTerm& term : terms_) {
        const ClosureOpTraits& row = term.row();
        if (material.narrow_lobe.empty()) material.narrow_lobe = narrow_lobe(term);
        material.has_subsurface |= term.below.exists();
        material.may_be_transparent |= row.straight != kAbsent;
        material.has_smooth |=
            scatters(term, row.diffuse) || (row.has_facets() && !delta(term.alpha()));
    }
    material.bump_correction = bump_correction_;
    material.is_background = is_world_;
    material.constant_background = is_world_ && expr.is_constant(emission);
    material.emits = !is_black(emission);
    if (material.emits) material.mean_emission = Spectrum(expr.mean_value(emission, images_));
    material.absorption = medium();
}

// Coefficients of a homogeneous medium.
Spectrum Compiler::medium() {
    if (is_world_) {
        if (!expr.is_constant(absorption_, 0.0f))
            warn(graph_.output, "the volume of a world has no effect");
        return Spectrum(0.0f);
    }
    if (!expr.is_constant(absorption_))
        warn(graph_.output, "the volume's absorption varies; its mean is used");
    return Spectrum(expr.mean_value(absorption_, images_));
}

// What the shaders of a part add up to: from the output down, so that a shader's weight is complete
// before it hands it on.
void Compiler::gather(ShaderPart part) {
    part_ = part;
    shader_weights_.assign(graph_.nodes.size(), kNoExpr);
    add_weight(graph_.output, expr.constant(1.0f));
    for (uint32_t index : graph_.order) {
        const NodeKind& kind = *graph_.nodes[index].kind;
        if (kind.shade == nullptr || shader_weights_[index] == kNoExpr) continue;
        if (expr.is_constant(shader_weights_[index], 0.0f)) continue;
        NodeContext context(*this, index);
        if (kind.part == part || kind.part == ShaderPart::both)
            kind.shade(context, shader_weights_[index]);
        else
            warn(index, std::string(kind.label) +
                            (part == ShaderPart::volume ? " in a volume" : " on a surface") +
                            " has no effect");
    }
}

Material Compiler::run() {
    // Values from the leaves up, so that every input is known when it is asked for, however long
    // the chain.
    for (auto index = graph_.order.rbegin(); index != graph_.order.rend(); ++index) {
        const ResolvedNode& node = graph_.nodes[*index];
        for (size_t i = 0; i < node.used_outputs.size(); ++i)
            if (node.kind->value != nullptr && node.used_outputs[i])
                output(*index, static_cast<int>(i));
    }
    gather(ShaderPart::surface);
    gather(ShaderPart::volume);
    check_closure_count();

    Material material;
    material.name = graph_.name;
    describe(material);
    ProgramRoots roots;
    find_specular_interfaces(expr, graph_, terms_, material, roots.caster_normal, warnings_);
    material.slopes = find_slope_map(expr, glints_, images_, terms_);
    if (material.emits) (is_world_ ? roots.background : roots.emission) = emission;
    for (const ClosureTerm& term : terms_) {
        if (term.row().straight == kAbsent) continue;
        const ExprId weight = expr.scale(term.operand(term.row().straight), term.weight());
        roots.transparency =
            roots.transparency == kNoExpr ? weight : expr.add(roots.transparency, weight);
    }
    material.program.reset(new Program(generate(expr, terms_, roots, graph_.name)));
    Program& program = *material.program;
    material.reads =
        reads_of(program, {0, static_cast<uint32_t>(program.instructions.size()), kNoOperand});
    material.normal_reads = reads_of(program, program.caster_normal);
    for (const Section& height : program.heights)
        material.height_reads |= reads_of(program, height);
    material.images = images_of(program);
    material.uv_layers = keep_used_layers(program, material.slopes);
    material.warnings = std::move(warnings_);
    return material;
}

// Layers of values that came to nothing are not read.
std::vector<std::string> Compiler::keep_used_layers(Program& program, SlopeMap& slopes) const {
    std::vector<std::string> kept;
    const auto keep = [&](uint32_t layer) {
        const std::string& name = uv_layers_[layer];
        const auto found = std::find(kept.begin(), kept.end(), name);
        const auto index = static_cast<uint32_t>(found - kept.begin());
        if (found == kept.end()) kept.push_back(name);
        return index;
    };
    for (Instruction& i : program.instructions)
        if (traits(i.op).index == IndexOf::uv_layer) i.index = keep(i.index);
    if (slopes.image != kNone) {
        slopes.uv_layer = keep(slopes.uv_layer);
        slopes.tangent_layer = keep(slopes.tangent_layer);
    }
    return kept;
}

void ProgramDeleter::operator()(Program* program) const { delete program; }

Material compile(const Graph& graph, std::span<const Image> images) {
    return Compiler(graph, images).run();
}

}  // namespace spc
