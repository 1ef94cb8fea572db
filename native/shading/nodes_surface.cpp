// SPDX-License-Identifier: GPL-3.0-or-later
// Shader nodes: what each adds to a surface. Semantics are Cycles'; docs/nodes.md lists what
// differs.
#include "shading/nodes.h"

namespace spc::nodes {
namespace {

// A term of the node; `operands` are those of the row of `op`, the weight and the normal first.
ClosureTerm term(NodeContext& node, ClosureOp op, const std::string& part,
                 std::vector<ExprId> operands, const ClosureModes& modes = {}) {
    ClosureTerm t;
    t.op = op;
    t.modes = modes;
    t.node = node.index;
    t.label = node.label() + part;
    t.in = std::move(operands);
    return t;
}

ExprId alpha_of(NodeContext& node, ExprId roughness) {
    const ExprId r = node.e.clamp01(roughness);
    return node.e.multiply(r, r);
}

// Indices at and below zero mean nothing; Cycles' bound.
ExprId ior_of(NodeContext& node, ExprId ior) { return node.e.maximum(ior, node.e.constant(1e-5f)); }

// Along a socket's tangent, or around the mesh's Z axis, turned about the normal by a share of a
// whole turn.
Grain grain_of(NodeContext& node, ExprId stretch, ExprId normal, int tangent_socket,
               int turn_socket) {
    ExprBuilder& e = node.e;
    if (e.is_constant(stretch, 1.0f)) return {};
    ExprId tangent = node.input(tangent_socket);
    if (tangent == kNoExpr) tangent = radial_tangent(node, 2);
    const ExprId turn = node.input(turn_socket);
    if (!e.is_constant(turn, 0.0f)) {
        const ExprId axis = normal == kNoExpr ? e.make(Op::normal, {}) : normal;
        const ExprId angle = e.multiply(turn, e.constant(2.0f * kPi));
        tangent = e.make(Op::rotate_axis, {tangent, axis, angle});
    }
    return {stretch, tangent};
}

// Of nodes that follow [Burley12]: alphas are in a ratio of 1 - 0.9 of the anisotropy.
ExprId stretch_of(NodeContext& node, ExprId anisotropic) {
    ExprBuilder& e = node.e;
    const ExprId ratio = e.one_minus(e.multiply(e.clamp01(anisotropic), e.constant(0.9f)));
    return e.divide(e.constant(1.0f), e.square_root(ratio));
}

// None where it is of no thickness.
FilmOver film_of(NodeContext& node, int thickness_socket, int ior_socket) {
    const ExprId thickness = node.input(thickness_socket);
    if (node.e.is_constant(thickness) && !(node.e.scalar(thickness) > 0.0f)) return {};
    return {thickness, node.input(ior_socket)};
}

ClosureModes modes_of(const std::string& distribution) {
    ClosureModes modes;
    if (distribution == "BECKMANN") modes.model = MicrofacetModel::beckmann;
    modes.energy_compensated = distribution == "MULTI_GGX";
    return modes;
}

// What lies below `coat`, which covers a share of the surface, has over it.
CoatOver coat_over(NodeContext& node, const ClosureTerm& coat, ExprId share, ExprId tint) {
    CoatOver over;
    if (node.e.is_constant(share, 0.0f)) return over;
    over.normal = coat.normal();
    over.layer = node.e.combine(share, coat.alpha(), coat.ior());
    over.tint = node.e.clamp01(tint);
    over.through = node.e.make(Op::coat, {over.normal, over.layer, over.tint});
    return over;
}

// Halfway, by `share`, from one normal to another one; kNoExpr is the interpolated normal.
ExprId between_normals(NodeContext& node, ExprId from, ExprId to, ExprId share) {
    ExprBuilder& e = node.e;
    if (from == to || e.is_constant(share, 0.0f)) return from;
    if (e.is_constant(share, 1.0f)) return to;
    const auto known = [&](ExprId n) { return n == kNoExpr ? e.make(Op::normal, {}) : n; };
    return e.make(Op::shading_normal,
                  {e.add(e.scale(known(from), e.one_minus(share)), e.scale(known(to), share))});
}

// From white to the colour at a luminance of 1.
ExprId hue_of(NodeContext& node, ExprId color, ExprId factor) {
    ExprBuilder& e = node.e;
    const ExprId one = e.constant(Vec3(1.0f));
    const ExprId hue = e.divide(color, e.splat(e.luminance(color)));
    return e.add(e.scale(one, e.one_minus(factor)), e.scale(hue, factor));
}

// Adds the sheen that lies over the rest. The share of light that goes on below it.
ExprId sheen_layer(NodeContext& node, ExprId weight, ExprId normal, ExprId color, ExprId roughness) {
    ExprBuilder& e = node.e;
    if (e.is_constant(color, 0.0f)) return e.constant(1.0f);
    node.c.add_term(term(node, ClosureOp::sheen, " (sheen)", {weight, normal, color, roughness}));
    const ExprId albedo = e.make(Op::sheen_albedo, {e.make(Op::facing, {normal}), roughness});
    const ExprId largest =
        e.maximum(e.maximum(e.lane(color, 0), e.lane(color, 1)), e.lane(color, 2));
    return e.one_minus(e.clamp01(e.multiply(largest, albedo)));
}

void mix_into(NodeContext& node, int socket, ExprId weight) {
    const ResolvedInput& source = node.source(socket);
    if (source.from_node == kNone) return;
    const OutputSocket& from =
        node.c.node(source.from_node).kind->outputs[static_cast<size_t>(source.from_output)];
    if (from.type == SocketType::shader) return node.c.add_weight(source.from_node, weight);
    if (node.c.part() == ShaderPart::volume)
        return node.warn("a value in place of a volume has no effect");
    node.c.add_emission(node.input(socket), weight);  // Blender takes a value for an emission
}

}  // namespace

void output(NodeContext& node, ExprId weight) {
    enum { kSurface, kVolume };
    mix_into(node, node.c.part() == ShaderPart::surface ? kSurface : kVolume, weight);
}

void mix_shader(NodeContext& node, ExprId weight) {
    enum { kFac, kShader, kShader1 };
    const ExprId fac = node.e.clamp01(node.input(kFac));
    mix_into(node, kShader, node.e.multiply(weight, node.e.one_minus(fac)));
    mix_into(node, kShader1, node.e.multiply(weight, fac));
}

void add_shader(NodeContext& node, ExprId weight) {
    mix_into(node, 0, weight);
    mix_into(node, 1, weight);
}

void emission(NodeContext& node, ExprId weight) {
    enum { kColor, kStrength };
    node.c.add_emission(node.e.scale(node.input(kColor), node.input(kStrength)), weight);
}

void background(NodeContext& node, ExprId weight) { emission(node, weight); }

void diffuse(NodeContext& node, ExprId weight) {
    enum { kColor, kRoughness, kNormal };
    ClosureModes modes;
    modes.exchanges = node.enabled(0);
    node.c.add_term(term(node, ClosureOp::rough_diffuse, "",
                         {weight, node.normal(kNormal), node.input(kColor), node.input(kRoughness)},
                         modes));
}

void translucent(NodeContext& node, ExprId weight) {
    enum { kColor, kNormal };
    node.c.add_term(
        term(node, ClosureOp::translucent, "", {weight, node.normal(kNormal), node.input(kColor)}));
}

void sheen(NodeContext& node, ExprId weight) {
    enum { kColor, kRoughness, kNormal };
    const bool velvet = node.option(0) == "ASHIKHMIN";
    node.c.add_term(term(node, velvet ? ClosureOp::velvet : ClosureOp::sheen, "",
                         {weight, node.normal(kNormal), node.input(kColor), node.input(kRoughness)}));
}

void toon(NodeContext& node, ExprId weight) {
    enum { kColor, kSize, kSmooth, kNormal };
    const bool glossy = node.option(0) == "GLOSSY";
    node.c.add_term(term(
        node, glossy ? ClosureOp::glossy_toon : ClosureOp::diffuse_toon, "",
        {weight, node.normal(kNormal), node.input(kColor), node.input(kSize), node.input(kSmooth)}));
}

void holdout(NodeContext& node, ExprId weight) {
    node.c.add_term(term(node, ClosureOp::holdout, "", {weight, kNoExpr}));
}

void glossy(NodeContext& node, ExprId weight) {
    enum { kColor, kRoughness, kNormal, kAnisotropy, kRotation, kTangent };
    ExprBuilder& e = node.e;
    const ExprId alpha = alpha_of(node, node.input(kRoughness));
    const bool phong = node.option(0) == "ASHIKHMIN_SHIRLEY";
    ClosureTerm lobe =
        term(node, phong ? ClosureOp::ashikhmin_shirley : ClosureOp::glossy, "",
             {weight, node.normal(kNormal), alpha, node.input(kColor)}, modes_of(node.option(0)));
    // Cycles' bounds; a negative one stretches across the tangent what a positive one does along
    // it.
    const ExprId bound = e.constant(0.99f), one = e.constant(1.0f);
    const ExprId anisotropy =
        e.make(Op::clamp, {node.input(kAnisotropy), e.constant(-0.99f), bound});
    const ExprId stretch =
        e.divide(e.one_minus(e.non_negative(anisotropy)),
                 e.subtract(one, e.non_negative(e.subtract(e.constant(0.0f), anisotropy))));
    lobe.grain = grain_of(node, stretch, lobe.normal(), kTangent, kRotation);
    node.c.add_term(lobe);
}

void metallic(NodeContext& node, ExprId weight) {
    enum {
        kBaseColor,
        kEdgeTint,
        kIndex,
        kExtinction,
        kRoughness,
        kAnisotropy,
        kRotation,
        kNormal,
        kTangent,
        kFilmThickness,
        kFilmIor
    };
    ExprBuilder& e = node.e;
    const ExprId normal = node.normal(kNormal), alpha = alpha_of(node, node.input(kRoughness));
    const bool physical = node.option(1) == "PHYSICAL_CONDUCTOR";
    ClosureTerm lobe = physical ? term(node, ClosureOp::conductor, "",
                                       {weight, normal, alpha, e.non_negative(node.input(kIndex)),
                                        e.non_negative(node.input(kExtinction))},
                                       modes_of(node.option(0)))
                                : term(node, ClosureOp::metal, "",
                                       {weight, normal, alpha, e.clamp01(node.input(kBaseColor)),
                                        e.clamp01(node.input(kEdgeTint))},
                                       modes_of(node.option(0)));
    lobe.grain =
        grain_of(node, stretch_of(node, node.input(kAnisotropy)), normal, kTangent, kRotation);
    lobe.film = film_of(node, kFilmThickness, kFilmIor);
    node.c.add_term(lobe);
}

void glass(NodeContext& node, ExprId weight) {
    enum { kColor, kRoughness, kIor, kNormal, kFilmThickness, kFilmIor };
    const ExprId color = node.input(kColor), white = node.e.constant(Vec3(1.0f));
    ClosureTerm interface =
        term(node, ClosureOp::dielectric, "",
             {weight, node.normal(kNormal), alpha_of(node, node.input(kRoughness)),
              ior_of(node, node.input(kIor)), color, color, white},
             modes_of(node.option(0)));
    interface.film = film_of(node, kFilmThickness, kFilmIor);
    node.c.add_term(interface);
}

void refraction(NodeContext& node, ExprId weight) {
    enum { kColor, kRoughness, kIor, kNormal };
    ClosureModes modes = modes_of(node.option(0));
    modes.reflects = modes.fresnel_weighted = false;
    const ExprId black = node.e.constant(Vec3(0.0f)), white = node.e.constant(Vec3(1.0f));
    node.c.add_term(term(node, ClosureOp::dielectric, "",
                         {weight, node.normal(kNormal), alpha_of(node, node.input(kRoughness)),
                          ior_of(node, node.input(kIor)), black, node.input(kColor), white},
                         modes));
}

void transparent(NodeContext& node, ExprId weight) {
    node.c.add_term(term(node, ClosureOp::transparent, "", {weight, kNoExpr, node.input(0)}));
}

namespace {

// Of a node's inputs. With method BURLEY a random walk stands in for it.
BelowSurface below_of(NodeContext& node, ClosureModes& modes, const std::string& method,
                      ExprId share, ExprId radius, ExprId anisotropy, ExprId alpha, ExprId ior) {
    if (node.e.is_constant(share, 0.0f) || node.e.is_constant(radius, 0.0f)) return {};
    if (method == "BURLEY")
        node.warn("Christensen and Burley's method is not supported, a random walk stands in");
    modes.entry = method == "RANDOM_WALK"        ? SubsurfaceEntry::facets
                  : method == "RANDOM_WALK_SKIN" ? SubsurfaceEntry::both
                                                 : SubsurfaceEntry::diffuse;
    modes.dipole_radius = method == "RANDOM_WALK_SKIN" || method == "RANDOM_WALK_DIPOLE";
    return {share, radius, node.e.combine(anisotropy, alpha, ior)};
}

}  // namespace

void subsurface(NodeContext& node, ExprId weight) {
    enum { kColor, kScale, kRadius, kIor, kRoughness, kAnisotropy, kNormal };
    ExprBuilder& e = node.e;
    const std::string& method = node.option(0);
    const bool skin = method == "RANDOM_WALK_SKIN";
    ClosureModes modes;
    const BelowSurface below = below_of(
        node, modes, method, e.constant(1.0f), e.scale(node.input(kRadius), node.input(kScale)),
        node.input(kAnisotropy), skin ? e.constant(1.0f) : node.input(kRoughness), node.input(kIor));
    ClosureTerm diffuse =
        term(node, ClosureOp::rough_diffuse, "",
             {weight, node.normal(kNormal), node.input(kColor), e.constant(0.0f)}, modes);
    diffuse.below = below;
    node.c.add_term(diffuse);
}

// Layers from the top: Alpha over all, then sheen, the coat, then emission, then a mix of metal, of
// glass, and of a dielectric's reflection over what is diffuse. The last pair divides light by the
// reflection's albedo where it is evaluated. The coat's term comes last: where terms compete for
// what only one of them gets, it is the weakest.
void principled(NodeContext& node, ExprId weight) {
    enum {
        kBaseColor,
        kMetallic,
        kRoughness,
        kIor,
        kAlpha,
        kNormal,
        kSpecularLevel,
        kSpecularTint,
        kTransmission,
        kEmissionColor,
        kEmissionStrength,
        kCoatWeight,
        kCoatRoughness,
        kCoatIor,
        kCoatTint,
        kCoatNormal,
        kDiffuseRoughness,
        kSheenWeight,
        kSheenRoughness,
        kSheenTint,
        kAnisotropic,
        kAnisotropicRotation,
        kTangent,
        kSubsurface,
        kSubsurfaceRadius,
        kSubsurfaceScale,
        kSubsurfaceIor,
        kSubsurfaceAnisotropy,
        kFilmThickness,
        kFilmIor
    };
    ExprBuilder& e = node.e;
    const ClosureModes modes = modes_of(node.option(0));
    const ExprId one = e.constant(Vec3(1.0f));
    const ExprId normal = node.normal(kNormal);
    const ExprId base = e.non_negative(node.input(kBaseColor)), clamped_base = e.clamp01(base);
    const ExprId tint = e.non_negative(node.input(kSpecularTint)), clamped_tint = e.clamp01(tint);
    const ExprId rough_alpha = alpha_of(node, node.input(kRoughness));
    const ExprId ior = ior_of(node, node.input(kIor));
    const Grain grain = grain_of(node, stretch_of(node, node.input(kAnisotropic)), normal, kTangent,
                                 kAnisotropicRotation);
    const FilmOver film = film_of(node, kFilmThickness, kFilmIor);

    const ExprId coverage = e.clamp01(node.input(kAlpha));
    node.c.add_term(term(node, ClosureOp::transparent, " (alpha)",
                         {e.multiply(weight, e.one_minus(coverage)), kNoExpr, one}));
    weight = e.multiply(weight, coverage);

    const ExprId share = e.clamp01(node.input(kCoatWeight));
    const ExprId sheen = e.non_negative(node.input(kSheenWeight)),
                 sheen_tint = e.non_negative(node.input(kSheenTint));
    const bool layered = node.option(1) == "LAYERED";
    if (layered)
        weight = e.multiply(
            weight, sheen_layer(node, weight,
                                between_normals(node, normal, node.normal(kCoatNormal), share),
                                e.scale(sheen_tint, sheen), node.input(kSheenRoughness)));

    const ClosureTerm coat = term(node, ClosureOp::coat, " (coat)",
                                  {e.multiply(weight, share), node.normal(kCoatNormal),
                                   alpha_of(node, node.input(kCoatRoughness)),
                                   e.maximum(node.input(kCoatIor), e.constant(1.0f))},
                                  modes_of("MULTI_GGX"));
    const CoatOver over = coat_over(node, coat, share, node.input(kCoatTint));

    const ExprId glow = e.scale(node.input(kEmissionColor), node.input(kEmissionStrength));
    node.c.add_emission(over.exists() ? e.multiply(glow, over.through) : glow, weight);

    const ExprId metallic = e.clamp01(node.input(kMetallic));
    ClosureTerm metal = term(
        node, ClosureOp::metal, " (metal)",
        {e.multiply(weight, metallic), normal, rough_alpha, clamped_base, clamped_tint}, modes);
    metal.coat = over;
    metal.grain = grain;
    if (node.enabled(3)) metal.film = film;
    node.c.add_term(metal);
    weight = e.multiply(weight, e.one_minus(metallic));

    const ExprId transmission = e.clamp01(node.input(kTransmission));
    // Light crosses such an interface twice.
    ClosureTerm glass = term(node, ClosureOp::dielectric, " (transmission)",
                             {e.multiply(weight, transmission), normal, rough_alpha, ior,
                              e.constant(Vec3(1.0f)), e.square_root(clamped_base), tint},
                             modes);
    glass.coat = over;
    glass.film = film;
    node.c.add_term(glass);
    weight = e.multiply(weight, e.one_minus(transmission));

    const ExprId index = e.make(Op::dielectric_ior, {ior, node.input(kSpecularLevel)});
    const ExprId ratio =
        e.divide(e.subtract(index, e.constant(1.0f)), e.add(index, e.constant(1.0f)));
    const ExprId f0 = e.clamp01(e.scale(tint, e.multiply(ratio, ratio)));
    ClosureModes base_modes = modes;
    const std::string& method = node.option(2);
    const bool skin = method == "RANDOM_WALK_SKIN";
    const ExprId scattered = e.clamp01(node.input(kSubsurface));
    const BelowSurface below =
        below_of(node, base_modes, method, scattered,
                 e.scale(node.input(kSubsurfaceRadius), node.input(kSubsurfaceScale)),
                 node.input(kSubsurfaceAnisotropy), skin ? e.constant(1.0f) : rough_alpha,
                 skin ? node.input(kSubsurfaceIor) : index);
    ClosureTerm coated =
        term(node, ClosureOp::coated, " (specular)",
             {weight, normal, rough_alpha, index, f0, layered ? base : e.constant(Vec3(0.0f)),
              node.input(kDiffuseRoughness)},
             layered ? base_modes : modes);
    if (layered) {
        coated.below = below;
    } else {
        node.c.add_term(
            term(node, ClosureOp::schlick_sheen, " (sheen)",
                 {e.multiply(weight, sheen), normal, hue_of(node, base, e.lane(sheen_tint, 0))}));
        node.c.add_term(term(
            node, ClosureOp::burley_diffuse, " (base)",
            {e.multiply(weight, e.one_minus(scattered)), normal, base, node.input(kRoughness)}));
        ClosureTerm walks =
            term(node, ClosureOp::rough_diffuse, " (subsurface)",
                 {e.multiply(weight, scattered), normal, base, e.constant(0.0f)}, base_modes);
        walks.below = {one, below.radius, below.entry};
        node.c.add_term(walks);
    }
    coated.coat = over;
    coated.grain = grain;
    coated.film = film;
    node.c.add_term(coated);
    node.c.add_term(coat);
}

}  // namespace spc::nodes
