// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"
#include "shading/compiler.h"
#include "shading/nodes.h"

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
      displacement_(graph.displacement),
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

namespace {

uint32_t index_in(std::vector<AttributeName>& attributes, const AttributeName& wanted) {
    const auto found = std::find(attributes.begin(), attributes.end(), wanted);
    const auto index = static_cast<uint32_t>(found - attributes.begin());
    if (found == attributes.end()) attributes.push_back(wanted);
    return index;
}

}  // namespace

uint32_t Compiler::attribute(AttributeKind kind, const std::string& name) {
    return index_in(attributes_, {kind, name});
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
    const bool matched =
        row.matched_index_is_black && !term.film.exists() && expr.is_constant(term.ior(), 1.0f);
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
    const bool brushed = term.row().has_facets() && !expr.is_constant(term.alpha(), 0.0f);
    if (!brushed) term.grain = {};
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
    const auto reads_ray = [&](ExprId id) {
        return id != kNoExpr && (expr.reads(id) & (kReadsRay | kReadsRayLength)) != 0;
    };
    for (const ClosureTerm& term : terms_) {
        const ClosureOpTraits& row = term.row();
        for (const ExprId operand : term.in) material.depends_on_ray |= reads_ray(operand);
        material.depends_on_ray |= reads_ray(term.film.thickness) || reads_ray(term.film.ior);
        if (material.narrow_lobe.empty()) material.narrow_lobe = narrow_lobe(term);
        material.has_subsurface |= term.below.exists();
        material.may_be_transparent |= row.straight != kAbsent;
        material.has_smooth |=
            scatters(term, row.diffuse) || (row.has_facets() && !delta(term.alpha()));
    }
    material.bump_correction = bump_correction_;
    material.is_background = is_world_;
    material.constant_emission = expr.is_constant(emission);
    material.emits = !is_black(emission);
    material.emission_reads = expr.reads(emission);
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

// From the leaves up, so that every input is known when it is asked for, however long the chain.
void Compiler::evaluate_values() {
    for (std::vector<ExprId>& known : outputs_) std::fill(known.begin(), known.end(), kNoExpr);
    for (auto index = graph_.order.rbegin(); index != graph_.order.rend(); ++index) {
        const ResolvedNode& node = graph_.nodes[*index];
        for (size_t i = 0; i < node.used_outputs.size(); ++i)
            if (node.kind->value != nullptr && node.used_outputs[i])
                output(*index, static_cast<int>(i));
    }
}

// A bump turns the normal before any node of the surface reads it, but what displaces sees the
// surface as it was.
void Compiler::displace(DisplacementMode mode, Material& material, ProgramRoots& roots) {
    const ExprId displacement = input(graph_.output, nodes::kDisplacementOfOutput);
    if (is_world_ || is_black(displacement)) return;
    material.displacement = mode;
    material.moves_vertices = mode != DisplacementMode::bump;
    if (material.moves_vertices) roots.displacement = displacement;
    if (mode == DisplacementMode::vertices) return;
    surface_normal_ = roots.surface_normal = bump_of(displacement);
    evaluate_values();
}

// The normal of a surface whose points stand where `displacement` moves them along the normal.
ExprId Compiler::bump_of(ExprId displacement) {
    const ExprId height = expr.make(Op::dot, {displacement, expr.make(Op::normal, {}, kHeldStill)});
    if (expr.derivatives(height) < 2) {
        warn(graph_.output,
             "a displacement that depends on a bump is not supported; the surface is flat");
        return kNoExpr;
    }
    const ExprId one = expr.constant(1.0f);
    return expr.make(Op::bump, {one, one, kNoExpr}, 0, static_cast<uint32_t>(height));
}

void Compiler::find_aovs(Material& material, ProgramRoots& roots) {
    enum { kColor, kValue };
    for (const uint32_t index : graph_.aovs) {
        material.aovs.push_back(graph_.nodes[index].options[0]);
        roots.aovs.push_back({input(index, kColor), input(index, kValue)});
    }
}

Material Compiler::run() {
    Material material;
    material.name = graph_.name;
    ProgramRoots roots;
    evaluate_values();
    displace(displacement_, material, roots);
    gather(ShaderPart::surface);
    gather(ShaderPart::volume);
    check_closure_count();
    find_aovs(material, roots);

    describe(material);
    if (material.depends_on_ray) {
        material.specular.why_not = "its look depends on the kind of ray";
        material.narrow_lobe.clear();
    } else {
        find_specular_interfaces(expr, graph_, terms_, material, roots.caster_normal, warnings_);
    }
    material.slopes = find_slope_map(expr, glints_, images_, attributes_, terms_);
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
    material.displacement_reads = reads_of(program, program.displacement);
    for (const Section& height : program.heights)
        material.height_reads |= reads_of(program, height);
    material.images = images_of(program);
    material.attributes = keep_used_attributes(program, material.slopes);
    material.warnings = std::move(warnings_);
    return material;
}

// Attributes of values that came to nothing are not read.
std::vector<AttributeName> Compiler::keep_used_attributes(Program& program, SlopeMap& slopes) const {
    std::vector<AttributeName> kept;
    const auto keep = [&](uint32_t& index) { index = index_in(kept, attributes_[index]); };
    for (Instruction& i : program.instructions)
        if (traits(i.op).index == IndexOf::attribute) keep(i.index);
    if (slopes.image != kNone) {
        keep(slopes.uv_layer);
        keep(slopes.tangent_layer);
    }
    if (kept.size() > kMaxAttributes)
        throw Error(ErrorKind::invalid_argument,
                    fmt::format("{}: reads {} attributes; at most {}",
                                named("material", graph_.name), kept.size(), kMaxAttributes));
    return kept;
}

void ProgramDeleter::operator()(Program* program) const { delete program; }

Material compile(const Graph& graph, std::span<const Image> images) {
    return Compiler(graph, images).run();
}

}  // namespace spc
