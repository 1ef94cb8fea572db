// SPDX-License-Identifier: GPL-3.0-or-later
// The state of one compilation: nodes add expressions and closure terms, then the terms become a
// program. Not seen outside of shading/.
#pragma once

#include "shading/program.h"
#include "shading/resolve.h"

namespace spc {

// What lies over a term: the inputs of Op::coat, and what it comes to.
struct CoatOver {
    ExprId normal = kNoExpr, layer = kNoExpr, tint = kNoExpr;
    ExprId through = kNoExpr;  // kNoExpr: there is none

    bool exists() const { return through != kNoExpr; }
};

// The grain of a brushed surface: its alpha along the tangent is `stretch` times that of the term,
// and across it as many times less.
struct Grain {
    ExprId stretch = kNoExpr, tangent = kNoExpr;  // kNoExpr: there is none

    bool exists() const { return stretch != kNoExpr; }
};

// The film over a reflection: its thickness in nm, and its index.
struct FilmOver {
    ExprId thickness = kNoExpr, ior = kNoExpr;  // kNoExpr: there is none

    bool exists() const { return thickness != kNoExpr; }
};

// What goes on below the diffuse part of a term: its share, the radius in m, and (anisotropy,
// alpha, index) of the medium and where light enters it.
struct BelowSurface {
    ExprId share = kNoExpr, radius = kNoExpr, entry = kNoExpr;  // kNoExpr: there is none

    bool exists() const { return share != kNoExpr; }
};

// A term of the surface with its operands as expressions.
struct ClosureTerm {
    ClosureOp op = ClosureOp::lambert;
    ClosureModes modes;
    uint32_t node = 0;
    std::string label;       // "Glass BSDF", for the log
    std::vector<ExprId> in;  // operands, as many as the row says
    CoatOver coat;
    Grain grain;
    FilmOver film;
    BelowSurface below;
    bool on_caster_normal = false, on_slope_map = false;

    // Dims what glints by the normal of each place of the slope map.
    bool coated_on_slope_map() const {
        return on_slope_map && coat.exists() && coat.normal == normal();
    }
    const ClosureOpTraits& row() const { return traits(op); }
    ExprId operand(int k) const { return in[static_cast<size_t>(k)]; }
    ExprId weight() const { return operand(kWeightOperand); }
    ExprId normal() const { return operand(kNormalOperand); }  // kNoExpr: interpolated
    ExprId alpha() const { return operand(row().alpha); }
    ExprId ior() const { return operand(row().ior); }
    bool reflects() const { return row().reflection != kAbsent && modes.reflects; }
    bool refracts() const { return row().refraction != kAbsent && modes.refracts; }
};

// What was asked of a program (codegen.cpp). kNoExpr for zero.
struct ProgramRoots {
    ExprId emission = kNoExpr, transparency = kNoExpr, caster_normal = kNoExpr,
           background = kNoExpr, displacement = kNoExpr, surface_normal = kNoExpr;
    struct Aov {
        ExprId color, value;
    };
    std::vector<Aov> aovs;
};

class Compiler {
public:
    Compiler(const Graph& graph, std::span<const Image> images);
    Material run();

    // Value of an input: its link's, converted to the input's type, or its constant; kNoExpr for
    // one that is unlinked and has no constant.
    ExprId input(uint32_t node, int index);
    const ResolvedNode& node(uint32_t index) const { return graph_.nodes[index]; }
    const std::string& material_name() const { return graph_.name; }
    bool is_world() const { return is_world_; }
    ShaderPart part() const { return part_; }  // whose shaders are asked
    std::span<const Image> images() const { return images_; }
    uint32_t attribute(AttributeKind kind, const std::string& name = "");
    void warn(uint32_t node, const std::string& text);

    void add_weight(uint32_t node, ExprId weight);  // to a shader that another one uses
    void add_term(ClosureTerm term);
    void add_emission(ExprId color, ExprId weight) {
        emission = expr.add(emission, expr.scale(color, weight));
    }

    void add_absorption(ExprId coefficient, ExprId weight) {
        absorption_ = expr.add(absorption_, expr.scale(coefficient, weight));
    }

    // The normal that stands where none is linked; kNoExpr: the interpolated one.
    ExprId surface_normal() const { return surface_normal_; }

    ExprBuilder expr;
    ExprId emission;  // of a surface or of the world

private:
    ExprId output(uint32_t node, int index);
    ExprId convert(ExprId value, SocketType from, SocketType to);
    void evaluate_values();
    void displace(DisplacementMode mode, Material& material, ProgramRoots& roots);
    ExprId bump_of(ExprId displacement);
    void gather(ShaderPart part);
    void find_aovs(Material& material, ProgramRoots& roots);
    void check_closure_count() const;
    std::string narrow_lobe(const ClosureTerm& term) const;
    bool is_black(ExprId id) const { return expr.is_constant(id, 0.0f); }
    // Whether light is scattered by the part of a term that this operand colours (kAbsent,
    // kUncolored: closure_op.h).
    bool scatters(const ClosureTerm& term, int part) const {
        return part != kAbsent && (part == kUncolored || !is_black(term.operand(part)));
    }
    void describe(Material& material);
    Spectrum medium();
    std::vector<AttributeName> keep_used_attributes(Program& program, SlopeMap& slopes) const;

    ResolvedGraph graph_;
    GlintsMode glints_;
    BumpCorrection bump_correction_;
    std::span<const Image> images_;
    std::vector<std::vector<ExprId>> outputs_;  // known values of [node][output]
    std::vector<ExprId> shader_weights_;
    std::vector<ClosureTerm> terms_;
    std::vector<AttributeName> attributes_;
    std::vector<std::string> warnings_;
    ExprId absorption_;  // 1/m
    ExprId surface_normal_ = kNoExpr;
    DisplacementMode displacement_;
    bool is_world_ = false;
    ShaderPart part_ = ShaderPart::surface;
};

// A node as its row's functions see it. Inputs and options go by their place in the row.
class NodeContext {
public:
    NodeContext(Compiler& compiler, uint32_t node) : c(compiler), e(compiler.expr), index(node) {}

    ExprId input(int i) { return c.input(index, i); }
    // Of a shading normal: unit, on the side of wo; kNoExpr for the interpolated one. The surface's
    // own stands in for none and for zero.
    ExprId normal(int i) {
        const ExprId given = input(i);
        if (given == kNoExpr || e.is_constant(given, 0.0f)) return c.surface_normal();
        if (traits(e[given].op).gives_normal) return given;
        return e.make(Op::shading_normal, {given});
    }
    ExprId attribute(AttributeKind kind, const std::string& name = "") {
        return e.make(Op::attribute, {}, 0, c.attribute(kind, name));
    }
    bool linked(int i) const { return source(i).from_node != kNone; }
    const ResolvedInput& source(int i) const {
        return c.node(index).inputs[static_cast<size_t>(i)];
    }
    const std::string& option(int i) const { return c.node(index).options[static_cast<size_t>(i)]; }
    bool has_array(int i) const { return c.node(index).arrays[static_cast<size_t>(i)] != nullptr; }
    const std::vector<float>& array(int i) const {
        return *c.node(index).arrays[static_cast<size_t>(i)];
    }
    // A table of colours, as Op::ramp looks it up.
    uint32_t ramp(int array_index) {
        const std::vector<float>& rows = array(array_index);
        std::vector<float> block{static_cast<float>(rows.size() / 4)};
        block.insert(block.end(), rows.begin(), rows.end());
        return e.block(block);
    }
    bool enabled(int i) const { return option(i) == "True"; }
    bool output_used(int i) const { return c.node(index).used_outputs[static_cast<size_t>(i)]; }
    uint32_t image() const { return c.node(index).graph->image; }
    const char* label() const { return c.node(index).kind->label; }
    void warn(const std::string& text) { c.warn(index, text); }

    Compiler& c;
    ExprBuilder& e;
    uint32_t index;
};

// The widest lobe on which chains turn: beyond it path tracing's noise is the smaller one.
inline constexpr float kWidestChainAlpha = 0.0901f;  // roughness 0.3
// Decides what the manifold walks on, marks the terms that belong to it (specular.cpp).
// `caster_normal` is set to its normal, kNoExpr for the interpolated one.
void find_specular_interfaces(const ExprBuilder& expr, const ResolvedGraph& graph,
                              std::vector<ClosureTerm>& terms, Material& material,
                              ExprId& caster_normal, std::vector<std::string>& warnings);

// Decides in which normal or height map glints are looked for, marks the terms that belong to it
// (slope_map.cpp). Its layers are indices of `attributes`, as the expressions' are.
SlopeMap find_slope_map(const ExprBuilder& expr, GlintsMode mode, std::span<const Image> images,
                        std::span<const AttributeName> attributes, std::vector<ClosureTerm>& terms);

// Throws Error naming `material` if registers or constants do not suffice.
Program generate(const ExprBuilder& expr, const std::vector<ClosureTerm>& terms,
                 const ProgramRoots& roots, const std::string& material);
// The bits of ProgramReads that a section's instructions read.
uint32_t reads_of(const Program& program, const Section& section);
std::vector<uint32_t> images_of(const Program& program);  // each once

}  // namespace spc
