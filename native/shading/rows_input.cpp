// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes that read how a surface is seen.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr InputSocket kFresnelIn[] = {scalar_input("IOR", 1.5f), kNormalInput};
constexpr InputSocket kLayerWeightIn[] = {scalar_input("Blend", 0.5f), kNormalInput};
constexpr OutputSocket kLayerWeightOut[] = {{"Fresnel", scalar}, {"Facing", scalar}};
constexpr OutputSocket kGeometryOut[] = {
    {"Position", vector},    {"Normal", vector},     {"Tangent", vector},
    {"True Normal", vector}, {"Incoming", vector},   {"Parametric", vector},
    {"Backfacing", scalar},  {"Pointiness", scalar}, {"Random Per Island", scalar}};
constexpr OutputSocket kTangentOut[] = {{"Tangent", vector}};
constexpr NodeOption kTangentOptions[] = {
    {"direction_type", "RADIAL|UV_MAP"}, {"axis", "Z|X|Y"}, {"uv_map", ""}};
constexpr OutputSocket kCameraOut[] = {
    {"View Vector", vector}, {"View Z Depth", scalar}, {"View Distance", scalar}};
constexpr InputSocket kTransformIn[] = {vector_input("Vector", 0.5f)};
constexpr NodeOption kTransformOptions[] = {{"vector_type", "VECTOR|POINT|NORMAL"},
                                            {"convert_from", "WORLD|OBJECT|CAMERA"},
                                            {"convert_to", "OBJECT|WORLD|CAMERA"}};
constexpr InputSocket kWireframeIn[] = {scalar_input("Size", 0.01f)};
constexpr NodeOption kWireframeOptions[] = {{"use_pixel_size", "False|True"}};
constexpr InputSocket kBlackbodyIn[] = {scalar_input("Temperature", 1500.0f)};
constexpr InputSocket kWavelengthIn[] = {scalar_input("Wavelength", 500.0f)};
constexpr NodeArray kColorTable[] = {{"Table", 4}};
constexpr InputSocket kBevelIn[] = {scalar_input("Radius", 0.05f), kNormalInput};
constexpr OutputSocket kNormalOut[] = {{"Normal", vector}};
constexpr InputSocket kOcclusionIn[] = {grey_input(1.0f)};
constexpr OutputSocket kOcclusionOut[] = {{"Color", color}, {"AO", scalar}};
constexpr OutputSocket kHairOut[] = {{"Is Strand", scalar},      {"Intercept", scalar},
                                     {"Length", scalar},         {"Thickness", scalar},
                                     {"Tangent Normal", vector}, {"Random", scalar}};
constexpr OutputSocket kPointOut[] = {{"Position", vector}, {"Radius", scalar}, {"Random", scalar}};
constexpr OutputSocket kVolumeOut[] = {
    {"Color", color}, {"Density", scalar}, {"Flame", scalar}, {"Temperature", scalar}};
// Those of the kinds of rays stand in the order of RayKind's bits.
constexpr OutputSocket kLightPathOut[] = {
    {"Is Camera Ray", scalar},       {"Is Shadow Ray", scalar},
    {"Is Diffuse Ray", scalar},      {"Is Glossy Ray", scalar},
    {"Is Singular Ray", scalar},     {"Is Reflection Ray", scalar},
    {"Is Transmission Ray", scalar}, {"Is Volume Scatter Ray", scalar},
    {"Ray Length", scalar},          {"Ray Depth", scalar},
    {"Diffuse Depth", scalar},       {"Glossy Depth", scalar},
    {"Transparent Depth", scalar},   {"Transmission Depth", scalar},
    {"Portal Depth", scalar}};
constexpr InputSocket kLightFalloffIn[] = {scalar_input("Strength", 100.0f),
                                           scalar_input("Smooth", 0.0f)};
constexpr OutputSocket kLightFalloffOut[] = {
    {"Quadratic", scalar}, {"Linear", scalar}, {"Constant", scalar}};
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
    {.name = "tangent",
     .label = "Tangent",
     .outputs = kTangentOut,
     .options = kTangentOptions,
     .value = nodes::tangent},
    {.name = "camera_data", .label = "Camera Data", .outputs = kCameraOut, .value = nodes::camera_data},
    {.name = "vector_transform",
     .label = "Vector Transform",
     .inputs = kTransformIn,
     .outputs = kVectorOut,
     .options = kTransformOptions,
     .value = nodes::vector_transform},
    {.name = "wireframe",
     .label = "Wireframe",
     .inputs = kWireframeIn,
     .outputs = kFacOut,
     .options = kWireframeOptions,
     .value = nodes::wireframe},
    {.name = "blackbody",
     .label = "Blackbody",
     .inputs = kBlackbodyIn,
     .outputs = kColorOut,
     .arrays = kColorTable,
     .value = nodes::blackbody},
    {.name = "wavelength",
     .label = "Wavelength",
     .inputs = kWavelengthIn,
     .outputs = kColorOut,
     .arrays = kColorTable,
     .value = nodes::wavelength},
    {.name = "bevel",
     .label = "Bevel",
     .inputs = kBevelIn,
     .outputs = kNormalOut,
     .value = nodes::bevel},
    {.name = "ambient_occlusion",
     .label = "Ambient Occlusion",
     .inputs = kOcclusionIn,
     .outputs = kOcclusionOut,
     .value = nodes::ambient_occlusion},
    {.name = "hair_info", .label = "Curves Info", .outputs = kHairOut, .value = nodes::hair_info},
    {.name = "point_info", .label = "Point Info", .outputs = kPointOut, .value = nodes::absent_info},
    {.name = "volume_info", .label = "Volume Info", .outputs = kVolumeOut, .value = nodes::absent_info},
    {.name = "light_path", .label = "Light Path", .outputs = kLightPathOut, .value = nodes::light_path},
    {.name = "light_falloff",
     .label = "Light Falloff",
     .inputs = kLightFalloffIn,
     .outputs = kLightFalloffOut,
     .value = nodes::light_falloff},
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
