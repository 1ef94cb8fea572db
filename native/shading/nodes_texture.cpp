// SPDX-License-Identifier: GPL-3.0-or-later
// Procedural textures. Semantics are Cycles'; docs/nodes.md lists what differs.
#include <string>

#include "core/error.h"
#include "shading/light_profile.h"
#include "shading/node_table.h"
#include "shading/nodes.h"
#include "shading/textures.h"

namespace spc::nodes {
namespace {

// Unlinked, a texture is laid out by Generated coordinates.
ExprId coordinates(NodeContext& node, int input) {
    const ExprId linked = node.input(input);
    if (linked != kNoExpr) return linked;
    return node.c.is_world() ? node.e.make(Op::position, {})
                             : node.attribute(AttributeKind::generated);
}

// What a noise reads of its space: (coordinates, W), scaled; 0 where it has no such dimension.
struct Place {
    int dimensions;
    ExprId vector, w;
};
Place place(NodeContext& node, const std::string& dimensions, int vector, int w, ExprId scale) {
    ExprBuilder& e = node.e;
    const int count = dimensions[0] - '0';
    return {count, count == 1 ? e.constant(Vec3(0.0f)) : e.scale(coordinates(node, vector), scale),
            count == 1 || count == 4 ? e.multiply(node.input(w), scale) : e.constant(0.0f)};
}

FractalType fractal_type(const std::string& name) {
    if (name == "MULTIFRACTAL") return FractalType::multifractal;
    if (name == "HYBRID_MULTIFRACTAL") return FractalType::hybrid;
    if (name == "RIDGED_MULTIFRACTAL") return FractalType::ridged;
    return name == "HETERO_TERRAIN" ? FractalType::hetero_terrain : FractalType::fbm;
}

uint8_t choice(NodeContext& node, int option) {
    const NodeOption& row = node.c.node(node.index).kind->options[static_cast<size_t>(option)];
    return static_cast<uint8_t>(choice_of(row.values, node.option(option)));
}

// From the point to where it is seen from.
ExprId opposite_of_ray(NodeContext& node) {
    ExprBuilder& e = node.e;
    return node.c.is_world() ? e.scale(e.make(Op::position, {}), e.constant(-1.0f))
                             : e.make(Op::incoming, {});
}

}  // namespace

ExprId checker_texture(NodeContext& node, int output) {
    enum { kVector, kColor1, kColor2, kScale };
    enum { kColor, kFac };
    ExprBuilder& e = node.e;
    const ExprId cell =
        e.make(Op::checker, {e.scale(coordinates(node, kVector), node.input(kScale))});
    if (output == kFac) return cell;
    return e.make(Op::mix, {node.input(kColor2), node.input(kColor1), e.splat(cell)});
}

ExprId gradient_texture(NodeContext& node, int output) {
    enum { kColor, kFac };
    const ExprId value = node.e.make(Op::gradient, {coordinates(node, 0)}, choice(node, 0));
    return output == kFac ? value : node.e.splat(value);
}

ExprId white_noise_texture(NodeContext& node, int output) {
    enum { kVector, kW };
    enum { kValue, kColor };
    const Place at = place(node, node.option(0), kVector, kW, node.e.constant(1.0f));
    const ExprId color = node.e.make(Op::white_noise, {at.vector, at.w},
                                     noise_mode(at.dimensions, FractalType::fbm, false));
    return output == kColor ? color : node.e.lane(color, 0);
}

ExprId noise_texture(NodeContext& node, int output) {
    enum { kVector, kW, kScale, kDetail, kRoughness, kLacunarity, kOffset, kGain, kDistortion };
    enum { kDimensions, kType, kNormalize };
    enum { kFac, kColor };
    const Place at = place(node, node.option(kDimensions), kVector, kW, node.input(kScale));
    const uint8_t mode =
        noise_mode(at.dimensions, fractal_type(node.option(kType)), node.enabled(kNormalize));
    return node.e.make(
        output == kColor ? Op::noise_color : Op::noise,
        {at.vector, at.w, node.input(kDetail), node.input(kRoughness), node.input(kLacunarity),
         node.input(kOffset), node.input(kGain), node.input(kDistortion)},
        mode);
}

// Until 4.0 the fractals were a node of their own, which counted its octaves from one and fell off
// with lacunarity to the power of -dimension.
ExprId musgrave_texture(NodeContext& node, int) {
    enum { kVector, kW, kScale, kDetail, kDimension, kLacunarity, kOffset, kGain };
    enum { kDimensions, kType };
    ExprBuilder& e = node.e;
    const Place at = place(node, node.option(kDimensions), kVector, kW, node.input(kScale));
    const FractalType type = fractal_type(node.option(kType));
    const ExprId least = e.constant(1e-5f), zero = e.constant(0.0f), one = e.constant(1.0f);
    const ExprId lacunarity = e.maximum(node.input(kLacunarity), least);
    const ExprId dimension = e.maximum(node.input(kDimension), least);
    const ExprId roughness = e.make(Op::power, {lacunarity, e.subtract(zero, dimension)});
    const ExprId octaves = e.make(Op::clamp, {node.input(kDetail), zero, e.constant(kMostDetail)});
    const ExprId noise = e.make(Op::noise,
                                {at.vector, at.w, e.subtract(octaves, one), roughness, lacunarity,
                                 node.input(kOffset), node.input(kGain), zero},
                                noise_mode(at.dimensions, type, false));
    // Less than one octave fades from nothing, which is 1 where octaves are multiplied.
    const ExprId first = e.make(Op::minimum, {octaves, one});
    if (type == FractalType::fbm) return e.multiply(noise, first);
    return type == FractalType::multifractal ? e.make(Op::mix, {one, noise, first}) : noise;
}

ExprId voronoi_texture(NodeContext& node, int output) {
    enum {
        kVector,
        kW,
        kScale,
        kDetail,
        kRoughness,
        kLacunarity,
        kSmoothness,
        kExponent,
        kRandomness
    };
    enum { kDimensions, kFeature, kMetric, kNormalize, kHash };
    enum { kDistance, kColor, kPosition, kWOut, kRadius };
    ExprBuilder& e = node.e;
    const auto feature = static_cast<VoronoiFeature>(choice(node, kFeature));
    const bool radius = feature == VoronoiFeature::sphere_radius;
    const bool cells = !radius && feature != VoronoiFeature::distance_to_edge;
    // Blender hides the outputs that a feature has not.
    if (output == kDistance ? radius : output == kRadius ? !radius : !cells)
        return output == kColor || output == kPosition ? e.constant(Vec3(0.0f)) : e.constant(0.0f);
    const ExprId scale = node.input(kScale);
    const Place at = place(node, node.option(kDimensions), kVector, kW, scale);
    const uint8_t mode =
        voronoi_mode(at.dimensions, feature, static_cast<VoronoiMetric>(choice(node, kMetric)),
                     node.enabled(kNormalize), static_cast<VoronoiHash>(choice(node, kHash)));
    const auto make = [&](Op op) {
        return e.make(
            op,
            {at.vector, at.w, node.input(kDetail), node.input(kRoughness), node.input(kLacunarity),
             node.input(kSmoothness), node.input(kExponent), node.input(kRandomness)},
            mode);
    };
    if (output == kDistance || output == kRadius) return make(Op::voronoi);
    if (output == kColor) return make(Op::voronoi_color);
    const ExprId position = make(Op::voronoi_position);
    if (output == kWOut) return e.divide(e.lane(position, 3), scale);
    return e.divide(position, e.splat(scale));
}

ExprId wave_texture(NodeContext& node, int output) {
    enum { kVector, kScale, kDistortion, kDetail, kDetailScale, kDetailRoughness, kPhase };
    enum { kType, kBands, kRings, kProfile };
    enum { kColor, kFac };
    ExprBuilder& e = node.e;
    const bool rings = node.option(kType) == "RINGS";
    const int shape = (rings ? 4 : 0) + choice(node, rings ? kRings : kBands);
    const ExprId value = e.make(
        Op::wave,
        {e.scale(coordinates(node, kVector), node.input(kScale)), node.input(kDistortion),
         node.input(kDetail), node.input(kDetailScale), node.input(kDetailRoughness),
         node.input(kPhase)},
        wave_mode(static_cast<WaveShape>(shape), static_cast<WaveProfile>(choice(node, kProfile))));
    return output == kFac ? value : e.splat(value);
}

ExprId magic_texture(NodeContext& node, int output) {
    enum { kVector, kScale, kDistortion };
    enum { kColor, kFac };
    const ExprId color = node.e.make(
        Op::magic, {coordinates(node, kVector), node.input(kScale), node.input(kDistortion)},
        static_cast<uint8_t>(std::stoi(node.option(0))));
    return output == kColor ? color : node.e.mean(color);
}

ExprId brick_texture(NodeContext& node, int output) {
    enum {
        kVector,
        kColor1,
        kColor2,
        kMortar,
        kScale,
        kMortarSize,
        kMortarSmooth,
        kBias,
        kWidth,
        kRowHeight
    };
    enum { kColor, kFac };
    ExprBuilder& e = node.e;
    const ExprId found = e.make(
        Op::brick,
        {e.scale(coordinates(node, kVector), node.input(kScale)), node.input(kMortarSize),
         node.input(kMortarSmooth), node.input(kBias), node.input(kWidth), node.input(kRowHeight)},
        0, e.block(node.array(0)));
    const ExprId mortar = e.lane(found, 1);
    if (output == kFac) return mortar;
    const ExprId stone =
        e.make(Op::mix, {node.input(kColor1), node.input(kColor2), e.splat(e.lane(found, 0))});
    return e.make(Op::mix, {stone, node.input(kMortar), e.splat(mortar)});
}

// The profile is stored without its mean, which stands before it: what varies then has a mean of 1.
ExprId ies_texture(NodeContext& node, int) {
    enum { kVector, kStrength };
    ExprBuilder& e = node.e;
    std::vector<float> table = node.array(0);
    if (!LightProfile::is_valid(table))
        throw Error(ErrorKind::invalid_argument,
                    where(node.c.material_name(), *node.c.node(node.index).graph) +
                        ", array \"Profile\": not the table of a lamp");
    const auto mean = static_cast<float>(LightProfile(table.data()).mean());
    if (mean > 0.0f)
        for (auto value = table.begin() + 2 + static_cast<long>(table[0] + table[1]);
             value != table.end(); ++value)
            *value /= mean;
    ExprId direction = node.input(kVector);
    if (direction == kNoExpr)
        direction =
            e.make(Op::transform, {opposite_of_ray(node)},
                   transform_mode(VectorSpace::world, VectorSpace::object, VectorMeaning::normal));
    const ExprId strength = e.multiply(node.input(kStrength), e.constant(mean));
    return e.multiply(strength, e.make(Op::light_profile, {direction}, 0, e.block(table)));
}

}  // namespace spc::nodes
