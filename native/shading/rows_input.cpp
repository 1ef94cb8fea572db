// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes that read how a surface is seen.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr InputSocket kFresnelIn[] = {scalar_input("IOR", 1.5f), kNormalInput};
constexpr InputSocket kLayerWeightIn[] = {scalar_input("Blend", 0.5f), kNormalInput};
constexpr OutputSocket kLayerWeightOut[] = {{"Fresnel", scalar}, {"Facing", scalar}};
constexpr OutputSocket kGeometryOut[] = {{"Position", vector},         {"Normal", vector},
                                         {"True Normal", vector},      {"Incoming", vector},
                                         {"Backfacing", scalar},       {"Pointiness", scalar},
                                         {"Random Per Island", scalar}};
constexpr OutputSocket kAttributeOut[] = {
    {"Color", color}, {"Vector", vector}, {"Fac", scalar}, {"Alpha", scalar}};
constexpr NodeOption kAttributeOptions[] = {
    {"attribute_type", "GEOMETRY|OBJECT|INSTANCER|VIEW_LAYER"}, {"attribute_name", ""}};
constexpr NodeOption kLayerName[] = {{"layer_name", ""}};
constexpr InputSocket kObjectInfoIn[] = {scalar_input("Material Index", 0.0f)};
constexpr OutputSocket kObjectInfoOut[] = {{"Location", vector},       {"Color", color},
                                           {"Alpha", scalar},          {"Object Index", scalar},
                                           {"Material Index", scalar}, {"Random", scalar}};
constexpr OutputSocket kParticleInfoOut[] = {
    {"Index", scalar},    {"Random", scalar}, {"Age", scalar},      {"Lifetime", scalar},
    {"Location", vector}, {"Size", scalar},   {"Velocity", vector}, {"Angular Velocity", vector}};

constexpr NodeKind kRows[] = {
    {.name = "fresnel",
     .label = "Fresnel",
     .inputs = kFresnelIn,
     .outputs = kFacOut,
     .value = nodes::fresnel},
    {.name = "layer_weight",
     .label = "Layer Weight",
     .inputs = kLayerWeightIn,
     .outputs = kLayerWeightOut,
     .value = nodes::layer_weight},
    {.name = "geometry", .label = "Geometry", .outputs = kGeometryOut, .value = nodes::geometry},
    {.name = "attribute",
     .label = "Attribute",
     .outputs = kAttributeOut,
     .options = kAttributeOptions,
     .value = nodes::attribute},
    {.name = "vertex_color",
     .label = "Color Attribute",
     .outputs = kColorAlphaOut,
     .options = kLayerName,
     .value = nodes::vertex_color},
    {.name = "object_info",
     .label = "Object Info",
     .inputs = kObjectInfoIn,
     .outputs = kObjectInfoOut,
     .value = nodes::object_info},
    {.name = "particle_info",
     .label = "Particle Info",
     .outputs = kParticleInfoOut,
     .value = nodes::particle_info},
};

}  // namespace

std::span<const NodeKind> input() { return kRows; }

}  // namespace spc::rows
