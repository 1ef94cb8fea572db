// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/node_table.h"

#include "shading/color_functions.h"
#include "shading/graph.h"
#include "shading/named_ops.h"
#include "shading/nodes.h"

#include <fmt/format.h>

namespace spc {
namespace {

using enum SocketType;

constexpr InputSocket color_input(float r, float g, float b, const char* name = "Color") {
    return {name, {r, g, b}, color};
}
constexpr InputSocket grey_input(float grey, const char* name = "Color") {
    return color_input(grey, grey, grey, name);
}
constexpr InputSocket scalar_input(const char* name, float value) {
    return {name, {value, 0, 0}, scalar};
}
constexpr InputSocket vector_input(const char* name, float value) {
    return {name, {value, value, value}, vector};
}
constexpr InputSocket shader_input(const char* name) { return {name, {}, shader}; }
constexpr InputSocket kNormalInput{"Normal", {}, vector, Unlinked::normal};

constexpr OutputSocket kBsdf[] = {{"BSDF", shader}};
constexpr OutputSocket kShader[] = {{"Shader", shader}};
constexpr OutputSocket kHoldoutOut[] = {{"Holdout", shader}};
constexpr NodeOption kDiffuseModels[] = {{"multiple_scattering", "True|False"}};
constexpr NodeOption kSheenModels[] = {{"distribution", "MICROFIBER|ASHIKHMIN"}};
constexpr NodeOption kToonModels[] = {{"component", "DIFFUSE|GLOSSY"}};
constexpr NodeOption kGlossyModels[] = {
    {"distribution", "GGX|BECKMANN|MULTI_GGX|ASHIKHMIN_SHIRLEY"}};
constexpr NodeOption kReflectionModels[] = {{"distribution", "GGX|BECKMANN|MULTI_GGX"}};
constexpr NodeOption kRefractionModels[] = {{"distribution", "GGX|BECKMANN"}};

constexpr InputSocket kOutputIn[] = {shader_input("Surface"), shader_input("Volume")};
constexpr InputSocket kDiffuseIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.0f),
                                      kNormalInput};
constexpr InputSocket kTranslucentIn[] = {grey_input(0.8f), kNormalInput};
constexpr InputSocket kSheenIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.5f),
                                    kNormalInput};
constexpr InputSocket kToonIn[] = {grey_input(0.8f), scalar_input("Size", 0.5f),
                                   scalar_input("Smooth", 0.0f), kNormalInput};
constexpr InputSocket kGlossyIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.5f),
                                     kNormalInput};
constexpr InputSocket kGlassIn[] = {grey_input(1.0f), scalar_input("Roughness", 0.0f),
                                    scalar_input("IOR", 1.5f), kNormalInput};
constexpr InputSocket kRefractionIn[] = {grey_input(1.0f), scalar_input("Roughness", 0.0f),
                                         scalar_input("IOR", 1.45f), kNormalInput};
constexpr InputSocket kTransparentIn[] = {grey_input(1.0f)};
constexpr InputSocket kEmissionIn[] = {grey_input(1.0f), scalar_input("Strength", 1.0f)};
constexpr InputSocket kBackgroundIn[] = {grey_input(0.8f), scalar_input("Strength", 1.0f)};
constexpr OutputSocket kEmissionOut[] = {{"Emission", shader}};
constexpr OutputSocket kBackgroundOut[] = {{"Background", shader}};
constexpr InputSocket kMixIn[] = {scalar_input("Fac", 0.5f), shader_input("Shader"),
                                  shader_input("Shader_001")};
constexpr InputSocket kAddIn[] = {shader_input("Shader"), shader_input("Shader_001")};
constexpr InputSocket kPrincipledIn[] = {grey_input(0.8f, "Base Color"),
                                         scalar_input("Metallic", 0.0f),
                                         scalar_input("Roughness", 0.5f),
                                         scalar_input("IOR", 1.5f),
                                         scalar_input("Alpha", 1.0f),
                                         kNormalInput,
                                         scalar_input("Specular IOR Level", 0.5f),
                                         grey_input(1.0f, "Specular Tint"),
                                         scalar_input("Transmission Weight", 0.0f),
                                         grey_input(1.0f, "Emission Color"),
                                         scalar_input("Emission Strength", 0.0f),
                                         scalar_input("Coat Weight", 0.0f),
                                         scalar_input("Coat Roughness", 0.03f),
                                         scalar_input("Coat IOR", 1.5f),
                                         grey_input(1.0f, "Coat Tint"),
                                         {"Coat Normal", {}, vector, Unlinked::normal}};
constexpr NodeOption kPrincipledModels[] = {{"distribution", "GGX|MULTI_GGX"}};
constexpr InputSocket kAbsorptionIn[] = {grey_input(0.8f), scalar_input("Density", 1.0f)};
constexpr InputSocket kPrincipledVolumeIn[] = {grey_input(0.5f), scalar_input("Density", 1.0f),
                                               grey_input(0.0f, "Absorption Color")};
constexpr OutputSocket kVolume[] = {{"Volume", shader}};

constexpr InputSocket kImageIn[] = {{"Vector", {}, vector, Unlinked::uv}};
constexpr OutputSocket kColorAlphaOut[] = {{"Color", color}, {"Alpha", scalar}};
constexpr NodeOption kImageOptions[] = {{"interpolation", "Linear|Closest|Cubic|Smart"},
                                        {"extension", "REPEAT|EXTEND|CLIP|MIRROR"}};
constexpr InputSocket kEnvironmentIn[] = {{"Vector", {}, vector, Unlinked::direction}};
constexpr OutputSocket kColorOut[] = {{"Color", color}};
constexpr NodeOption kEnvironmentOptions[] = {{"projection", "EQUIRECTANGULAR|MIRROR_BALL"},
                                              {"interpolation", "Linear|Closest|Cubic|Smart"}};
constexpr InputSocket kNormalMapIn[] = {scalar_input("Strength", 1.0f),
                                        color_input(0.5f, 0.5f, 1.0f)};
constexpr OutputSocket kNormalOut[] = {{"Normal", vector}};
constexpr NodeOption kNormalMapOptions[] = {{"space", "TANGENT|OBJECT|WORLD"}, {"uv_map", ""}};
constexpr InputSocket kBumpIn[] = {scalar_input("Strength", 1.0f), scalar_input("Distance", 1.0f),
                                   scalar_input("Height", 1.0f), kNormalInput};
constexpr NodeOption kBumpOptions[] = {{"invert", "False|True"}};
constexpr OutputSocket kUvOut[] = {{"UV", vector}};
constexpr NodeOption kUvOptions[] = {{"uv_map", ""}};
constexpr OutputSocket kCoordinateOut[] = {
    {"Generated", vector}, {"Normal", vector}, {"UV", vector}, {"Object", vector}};
constexpr InputSocket kMappingIn[] = {vector_input("Vector", 0.0f), vector_input("Location", 0.0f),
                                      vector_input("Rotation", 0.0f), vector_input("Scale", 1.0f)};
constexpr OutputSocket kVectorOut[] = {{"Vector", vector}};
constexpr NodeOption kMappingOptions[] = {{"vector_type", "POINT|TEXTURE|VECTOR|NORMAL"}};
constexpr InputSocket kColorRampIn[] = {scalar_input("Fac", 0.5f)};
constexpr NodeOption kColorRampOptions[] = {
    {"interpolation", "LINEAR|EASE|B_SPLINE|CARDINAL|CONSTANT"}};
constexpr NodeArray kColorRampArrays[] = {{"Table", 4}};
constexpr NodeOption kUseClamp{"use_clamp", "False|True"};
constexpr InputSocket kMathIn[] = {scalar_input("Value", 0.5f), scalar_input("Value_001", 0.5f),
                                   scalar_input("Value_002", 0.5f)};
constexpr NodeOption kMathOptions[] = {{"operation", kJoinedNames<kMathOps>.data()}, kUseClamp};
constexpr InputSocket kVectorMathIn[] = {
    vector_input("Vector", 0.0f), vector_input("Vector_001", 0.0f),
    vector_input("Vector_002", 0.0f), scalar_input("Scale", 1.0f)};
constexpr OutputSocket kVectorValueOut[] = {{"Vector", vector}, {"Value", scalar}};
constexpr NodeOption kVectorMathOptions[] = {{"operation", kJoinedNames<kVectorMathOps>.data()}};
constexpr InputSocket kMixIns[] = {
    scalar_input("Factor_Float", 0.5f), vector_input("Factor_Vector", 0.5f),
    scalar_input("A_Float", 0.0f),      scalar_input("B_Float", 0.0f),
    vector_input("A_Vector", 0.0f),     vector_input("B_Vector", 0.0f),
    grey_input(0.5f, "A_Color"),        grey_input(0.5f, "B_Color")};
constexpr OutputSocket kMixOut[] = {
    {"Result_Float", scalar}, {"Result_Vector", vector}, {"Result_Color", color}};
constexpr NodeOption kMixOptions[] = {{"factor_mode", "UNIFORM|NON_UNIFORM"},
                                      {"blend_type", kBlendTypes},
                                      {"clamp_factor", "True|False"},
                                      {"clamp_result", "False|True"}};
constexpr InputSocket kMixRgbIn[] = {scalar_input("Fac", 0.5f), grey_input(0.5f, "Color1"),
                                     grey_input(0.5f, "Color2")};
constexpr NodeOption kMixRgbOptions[] = {{"blend_type", kBlendTypes}, kUseClamp};
constexpr InputSocket kMapRangeIn[] = {
    scalar_input("Value", 1.0f),           scalar_input("From Min", 0.0f),
    scalar_input("From Max", 1.0f),        scalar_input("To Min", 0.0f),
    scalar_input("To Max", 1.0f),          scalar_input("Steps", 4.0f),
    vector_input("Vector", 0.0f),          vector_input("From_Min_FLOAT3", 0.0f),
    vector_input("From_Max_FLOAT3", 1.0f), vector_input("To_Min_FLOAT3", 0.0f),
    vector_input("To_Max_FLOAT3", 1.0f),   vector_input("Steps_FLOAT3", 4.0f)};
constexpr OutputSocket kMapRangeOut[] = {{"Result", scalar}, {"Vector", vector}};
constexpr NodeOption kMapRangeOptions[] = {
    {"interpolation_type", "LINEAR|STEPPED|SMOOTHSTEP|SMOOTHERSTEP"}, {"clamp", "True|False"}};
constexpr InputSocket kClampIn[] = {scalar_input("Value", 1.0f), scalar_input("Min", 0.0f),
                                    scalar_input("Max", 1.0f)};
constexpr OutputSocket kResultOut[] = {{"Result", scalar}};
constexpr NodeOption kClampOptions[] = {{"clamp_type", "MINMAX|RANGE"}};
constexpr InputSocket kVectorIn[] = {vector_input("Vector", 0.0f)};
constexpr OutputSocket kXyzOut[] = {{"X", scalar}, {"Y", scalar}, {"Z", scalar}};
constexpr InputSocket kXyzIn[] = {scalar_input("X", 0.0f), scalar_input("Y", 0.0f),
                                  scalar_input("Z", 0.0f)};
constexpr InputSocket kColorIn[] = {grey_input(0.8f)};
constexpr OutputSocket kChannelsOut[] = {{"Red", scalar}, {"Green", scalar}, {"Blue", scalar}};
constexpr InputSocket kChannelsIn[] = {scalar_input("Red", 0.0f), scalar_input("Green", 0.0f),
                                       scalar_input("Blue", 0.0f)};
constexpr NodeOption kColorModes[] = {{"mode", "RGB|HSV|HSL"}};
constexpr InputSocket kVectorRotateIn[] = {vector_input("Vector", 0.0f),
                                           vector_input("Center", 0.0f),
                                           {"Axis", {0, 0, 1}, vector},
                                           scalar_input("Angle", 0.0f),
                                           vector_input("Rotation", 0.0f)};
constexpr NodeOption kVectorRotateOptions[] = {
    {"rotation_type", "AXIS_ANGLE|X_AXIS|Y_AXIS|Z_AXIS|EULER_XYZ"}, {"invert", "False|True"}};
constexpr OutputSocket kValOut[] = {{"Val", scalar}};
constexpr InputSocket kInvertIn[] = {scalar_input("Fac", 1.0f), grey_input(0.0f)};
constexpr InputSocket kGammaIn[] = {grey_input(1.0f), scalar_input("Gamma", 1.0f)};
constexpr InputSocket kBrightContrastIn[] = {grey_input(1.0f), scalar_input("Bright", 0.0f),
                                             scalar_input("Contrast", 0.0f)};
constexpr InputSocket kHueSaturationIn[] = {
    scalar_input("Hue", 0.5f), scalar_input("Saturation", 1.0f), scalar_input("Value", 1.0f),
    scalar_input("Fac", 1.0f), grey_input(0.8f)};
constexpr NodeOption kCurvesOptions[] = {{"extend", "EXTRAPOLATED|HORIZONTAL"}};
constexpr NodeArray kThreeCurves[] = {{"Table", 4}};
constexpr NodeArray kOneCurve[] = {{"Table", 2}};
constexpr InputSocket kRgbCurvesIn[] = {scalar_input("Fac", 1.0f), grey_input(0.0f)};
constexpr InputSocket kVectorCurvesIn[] = {scalar_input("Fac", 1.0f), vector_input("Vector", 0.0f)};
constexpr InputSocket kFloatCurveIn[] = {scalar_input("Factor", 1.0f), scalar_input("Value", 1.0f)};
constexpr InputSocket kDirectionIn[] = {vector_input("Normal", 0.0f),
                                        {"Direction", {0, 0, 1}, vector}};
constexpr OutputSocket kDirectionOut[] = {{"Normal", vector}, {"Dot", scalar}};
constexpr InputSocket kFresnelIn[] = {scalar_input("IOR", 1.5f), kNormalInput};
constexpr OutputSocket kFacOut[] = {{"Fac", scalar}};
constexpr InputSocket kLayerWeightIn[] = {scalar_input("Blend", 0.5f), kNormalInput};
constexpr OutputSocket kLayerWeightOut[] = {{"Fresnel", scalar}, {"Facing", scalar}};
constexpr OutputSocket kGeometryOut[] = {{"Position", vector},
                                         {"Normal", vector},
                                         {"True Normal", vector},
                                         {"Incoming", vector},
                                         {"Backfacing", scalar}};
constexpr InputSocket kRgbIn[] = {grey_input(0.5f)};
constexpr InputSocket kValueIn[] = {scalar_input("Value", 0.5f)};
constexpr OutputSocket kValueOut[] = {{"Value", scalar}};

constexpr InputSocket kTextureVector{"Vector", {}, vector, Unlinked::generated};
constexpr OutputSocket kColorFacOut[] = {{"Color", color}, {"Fac", scalar}};
constexpr const char* kDimensions = "3D|1D|2D|4D";
constexpr const char* kFractals =
    "FBM|MULTIFRACTAL|HYBRID_MULTIFRACTAL|RIDGED_MULTIFRACTAL|HETERO_TERRAIN";
constexpr InputSocket kCheckerIn[] = {kTextureVector, grey_input(0.8f, "Color1"),
                                      grey_input(0.2f, "Color2"), scalar_input("Scale", 5.0f)};
constexpr InputSocket kGradientIn[] = {kTextureVector};
constexpr NodeOption kGradientOptions[] = {
    {"gradient_type", "LINEAR|QUADRATIC|EASING|DIAGONAL|SPHERICAL|QUADRATIC_SPHERE|RADIAL"}};
constexpr InputSocket kWhiteNoiseIn[] = {vector_input("Vector", 0.0f), scalar_input("W", 0.0f)};
constexpr OutputSocket kWhiteNoiseOut[] = {{"Value", scalar}, {"Color", color}};
constexpr NodeOption kWhiteNoiseOptions[] = {{"noise_dimensions", kDimensions}};
constexpr InputSocket kNoiseIn[] = {
    kTextureVector,
    scalar_input("W", 0.0f),
    scalar_input("Scale", 5.0f),
    scalar_input("Detail", 2.0f),
    scalar_input("Roughness", 0.5f),
    scalar_input("Lacunarity", 2.0f),
    scalar_input("Offset", 0.0f),
    scalar_input("Gain", 1.0f),
    scalar_input("Distortion", 0.0f),
};
constexpr OutputSocket kFacColorOut[] = {{"Fac", scalar}, {"Color", color}};
constexpr NodeOption kNoiseOptions[] = {
    {"noise_dimensions", kDimensions}, {"noise_type", kFractals}, {"normalize", "True|False"}};
constexpr InputSocket kMusgraveIn[] = {
    kTextureVector,
    scalar_input("W", 0.0f),
    scalar_input("Scale", 5.0f),
    scalar_input("Detail", 2.0f),
    scalar_input("Dimension", 2.0f),
    scalar_input("Lacunarity", 2.0f),
    scalar_input("Offset", 0.0f),
    scalar_input("Gain", 1.0f),
};
constexpr NodeOption kMusgraveOptions[] = {{"musgrave_dimensions", kDimensions},
                                           {"musgrave_type", kFractals}};
constexpr InputSocket kVoronoiIn[] = {
    kTextureVector,
    scalar_input("W", 0.0f),
    scalar_input("Scale", 5.0f),
    scalar_input("Detail", 0.0f),
    scalar_input("Roughness", 0.5f),
    scalar_input("Lacunarity", 2.0f),
    scalar_input("Smoothness", 1.0f),
    scalar_input("Exponent", 0.5f),
    scalar_input("Randomness", 1.0f),
};
constexpr OutputSocket kVoronoiOut[] = {
    {"Distance", scalar}, {"Color", color}, {"Position", vector}, {"W", scalar}, {"Radius", scalar}};
constexpr NodeOption kVoronoiOptions[] = {
    {"voronoi_dimensions", kDimensions},
    {"feature", "F1|F2|SMOOTH_F1|DISTANCE_TO_EDGE|N_SPHERE_RADIUS"},
    {"distance", "EUCLIDEAN|MANHATTAN|CHEBYCHEV|MINKOWSKI"},
    {"normalize", "False|True"},
    {"hash", "LOOKUP3|PCG"}};
constexpr InputSocket kWaveIn[] = {kTextureVector,
                                   scalar_input("Scale", 5.0f),
                                   scalar_input("Distortion", 0.0f),
                                   scalar_input("Detail", 2.0f),
                                   scalar_input("Detail Scale", 1.0f),
                                   scalar_input("Detail Roughness", 0.5f),
                                   scalar_input("Phase Offset", 0.0f)};
constexpr NodeOption kWaveOptions[] = {{"wave_type", "BANDS|RINGS"},
                                       {"bands_direction", "X|Y|Z|DIAGONAL"},
                                       {"rings_direction", "X|Y|Z|SPHERICAL"},
                                       {"wave_profile", "SIN|SAW|TRI"}};
constexpr InputSocket kMagicIn[] = {kTextureVector, scalar_input("Scale", 5.0f),
                                    scalar_input("Distortion", 1.0f)};
constexpr NodeOption kMagicOptions[] = {{"turbulence_depth", "2|0|1|3|4|5|6|7|8|9|10"}};
constexpr InputSocket kBrickIn[] = {kTextureVector,
                                    grey_input(0.8f, "Color1"),
                                    grey_input(0.2f, "Color2"),
                                    grey_input(0.0f, "Mortar"),
                                    scalar_input("Scale", 5.0f),
                                    scalar_input("Mortar Size", 0.02f),
                                    scalar_input("Mortar Smooth", 0.1f),
                                    scalar_input("Bias", 0.0f),
                                    scalar_input("Brick Width", 0.5f),
                                    scalar_input("Row Height", 0.25f)};
constexpr NodeArray kBrickArrays[] = {{"Rows", 2}};  // offset and squash with their frequencies

constexpr NodeKind kTable[] = {
    {.name = "output",
     .label = "Output",
     .inputs = kOutputIn,
     .shade = nodes::output,
     .part = ShaderPart::both},
    {.name = "bsdf_diffuse",
     .label = "Diffuse BSDF",
     .inputs = kDiffuseIn,
     .outputs = kBsdf,
     .options = kDiffuseModels,
     .shade = nodes::diffuse},
    {.name = "bsdf_translucent",
     .label = "Translucent BSDF",
     .inputs = kTranslucentIn,
     .outputs = kBsdf,
     .shade = nodes::translucent},
    {.name = "bsdf_sheen",
     .label = "Sheen BSDF",
     .inputs = kSheenIn,
     .outputs = kBsdf,
     .options = kSheenModels,
     .shade = nodes::sheen},
    {.name = "bsdf_toon",
     .label = "Toon BSDF",
     .inputs = kToonIn,
     .outputs = kBsdf,
     .options = kToonModels,
     .shade = nodes::toon},
    {.name = "holdout", .label = "Holdout", .outputs = kHoldoutOut, .shade = nodes::holdout},
    {.name = "bsdf_glossy",
     .label = "Glossy BSDF",
     .inputs = kGlossyIn,
     .outputs = kBsdf,
     .options = kGlossyModels,
     .shade = nodes::glossy},
    {.name = "bsdf_glass",
     .label = "Glass BSDF",
     .inputs = kGlassIn,
     .outputs = kBsdf,
     .options = kReflectionModels,
     .shade = nodes::glass},
    {.name = "bsdf_refraction",
     .label = "Refraction BSDF",
     .inputs = kRefractionIn,
     .outputs = kBsdf,
     .options = kRefractionModels,
     .shade = nodes::refraction},
    {.name = "bsdf_transparent",
     .label = "Transparent BSDF",
     .inputs = kTransparentIn,
     .outputs = kBsdf,
     .shade = nodes::transparent},
    {.name = "bsdf_principled",
     .label = "Principled BSDF",
     .inputs = kPrincipledIn,
     .outputs = kBsdf,
     .options = kPrincipledModels,
     .shade = nodes::principled},
    {.name = "emission",
     .label = "Emission",
     .inputs = kEmissionIn,
     .outputs = kEmissionOut,
     .shade = nodes::emission},
    {.name = "background",
     .label = "Background",
     .inputs = kBackgroundIn,
     .outputs = kBackgroundOut,
     .shade = nodes::background},
    {.name = "volume_absorption",
     .label = "Volume Absorption",
     .inputs = kAbsorptionIn,
     .outputs = kVolume,
     .shade = nodes::volume_absorption,
     .part = ShaderPart::volume},
    {.name = "volume_principled",
     .label = "Principled Volume",
     .inputs = kPrincipledVolumeIn,
     .outputs = kVolume,
     .shade = nodes::volume_principled,
     .part = ShaderPart::volume},
    {.name = "mix_shader",
     .label = "Mix Shader",
     .inputs = kMixIn,
     .outputs = kShader,
     .shade = nodes::mix_shader,
     .part = ShaderPart::both},
    {.name = "add_shader",
     .label = "Add Shader",
     .inputs = kAddIn,
     .outputs = kShader,
     .shade = nodes::add_shader,
     .part = ShaderPart::both},
    {.name = "image_texture",
     .label = "Image Texture",
     .inputs = kImageIn,
     .outputs = kColorAlphaOut,
     .options = kImageOptions,
     .reads_image = true,
     .value = nodes::image_texture},
    {.name = "environment_texture",
     .label = "Environment Texture",
     .inputs = kEnvironmentIn,
     .outputs = kColorOut,
     .options = kEnvironmentOptions,
     .reads_image = true,
     .value = nodes::environment_texture},
    {.name = "normal_map",
     .label = "Normal Map",
     .inputs = kNormalMapIn,
     .outputs = kNormalOut,
     .options = kNormalMapOptions,
     .value = nodes::normal_map},
    {.name = "bump",
     .label = "Bump",
     .inputs = kBumpIn,
     .outputs = kNormalOut,
     .options = kBumpOptions,
     .value = nodes::bump},
    {.name = "uv_map",
     .label = "UV Map",
     .outputs = kUvOut,
     .options = kUvOptions,
     .value = nodes::uv_map},
    {.name = "texture_coordinate",
     .label = "Texture Coordinate",
     .outputs = kCoordinateOut,
     .value = nodes::texture_coordinate},
    {.name = "mapping",
     .label = "Mapping",
     .inputs = kMappingIn,
     .outputs = kVectorOut,
     .options = kMappingOptions,
     .value = nodes::mapping},
    {.name = "color_ramp",
     .label = "Color Ramp",
     .inputs = kColorRampIn,
     .outputs = kColorAlphaOut,
     .options = kColorRampOptions,
     .arrays = kColorRampArrays,
     .value = nodes::color_ramp},
    {.name = "math",
     .label = "Math",
     .inputs = kMathIn,
     .outputs = kValueOut,
     .options = kMathOptions,
     .value = nodes::math},
    {.name = "vector_math",
     .label = "Vector Math",
     .inputs = kVectorMathIn,
     .outputs = kVectorValueOut,
     .options = kVectorMathOptions,
     .value = nodes::vector_math},
    {.name = "mix",
     .label = "Mix",
     .inputs = kMixIns,
     .outputs = kMixOut,
     .options = kMixOptions,
     .value = nodes::mix},
    {.name = "mix_rgb",
     .label = "Mix Color",
     .inputs = kMixRgbIn,
     .outputs = kColorOut,
     .options = kMixRgbOptions,
     .value = nodes::mix_rgb},
    {.name = "map_range",
     .label = "Map Range",
     .inputs = kMapRangeIn,
     .outputs = kMapRangeOut,
     .options = kMapRangeOptions,
     .value = nodes::map_range},
    {.name = "clamp",
     .label = "Clamp",
     .inputs = kClampIn,
     .outputs = kResultOut,
     .options = kClampOptions,
     .value = nodes::clamp},
    {.name = "separate_xyz",
     .label = "Separate XYZ",
     .inputs = kVectorIn,
     .outputs = kXyzOut,
     .value = nodes::separate_xyz},
    {.name = "combine_xyz",
     .label = "Combine XYZ",
     .inputs = kXyzIn,
     .outputs = kVectorOut,
     .value = nodes::combine_xyz},
    {.name = "separate_color",
     .label = "Separate Color",
     .inputs = kColorIn,
     .outputs = kChannelsOut,
     .options = kColorModes,
     .value = nodes::separate_color},
    {.name = "combine_color",
     .label = "Combine Color",
     .inputs = kChannelsIn,
     .outputs = kColorOut,
     .options = kColorModes,
     .value = nodes::combine_color},
    {.name = "vector_rotate",
     .label = "Vector Rotate",
     .inputs = kVectorRotateIn,
     .outputs = kVectorOut,
     .options = kVectorRotateOptions,
     .value = nodes::vector_rotate},
    {.name = "rgb_to_bw",
     .label = "RGB to BW",
     .inputs = kColorIn,
     .outputs = kValOut,
     .value = nodes::rgb_to_bw},
    {.name = "invert",
     .label = "Invert Color",
     .inputs = kInvertIn,
     .outputs = kColorOut,
     .value = nodes::invert},
    {.name = "gamma", .label = "Gamma", .inputs = kGammaIn, .outputs = kColorOut, .value = nodes::gamma},
    {.name = "bright_contrast",
     .label = "Brightness/Contrast",
     .inputs = kBrightContrastIn,
     .outputs = kColorOut,
     .value = nodes::bright_contrast},
    {.name = "hue_saturation",
     .label = "Hue/Saturation/Value",
     .inputs = kHueSaturationIn,
     .outputs = kColorOut,
     .value = nodes::hue_saturation},
    {.name = "rgb_curves",
     .label = "RGB Curves",
     .inputs = kRgbCurvesIn,
     .outputs = kColorOut,
     .options = kCurvesOptions,
     .arrays = kThreeCurves,
     .value = nodes::curves},
    {.name = "vector_curves",
     .label = "Vector Curves",
     .inputs = kVectorCurvesIn,
     .outputs = kVectorOut,
     .options = kCurvesOptions,
     .arrays = kThreeCurves,
     .value = nodes::curves},
    {.name = "float_curve",
     .label = "Float Curve",
     .inputs = kFloatCurveIn,
     .outputs = kValueOut,
     .options = kCurvesOptions,
     .arrays = kOneCurve,
     .value = nodes::curves},
    {.name = "normal",
     .label = "Normal",
     .inputs = kDirectionIn,
     .outputs = kDirectionOut,
     .value = nodes::normal},
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
    {.name = "checker_texture",
     .label = "Checker Texture",
     .inputs = kCheckerIn,
     .outputs = kColorFacOut,
     .value = nodes::checker_texture},
    {.name = "gradient_texture",
     .label = "Gradient Texture",
     .inputs = kGradientIn,
     .outputs = kColorFacOut,
     .options = kGradientOptions,
     .value = nodes::gradient_texture},
    {.name = "white_noise_texture",
     .label = "White Noise Texture",
     .inputs = kWhiteNoiseIn,
     .outputs = kWhiteNoiseOut,
     .options = kWhiteNoiseOptions,
     .value = nodes::white_noise_texture},
    {.name = "noise_texture",
     .label = "Noise Texture",
     .inputs = kNoiseIn,
     .outputs = kFacColorOut,
     .options = kNoiseOptions,
     .value = nodes::noise_texture},
    {.name = "musgrave_texture",
     .label = "Musgrave Texture",
     .inputs = kMusgraveIn,
     .outputs = kFacOut,
     .options = kMusgraveOptions,
     .value = nodes::musgrave_texture},
    {.name = "voronoi_texture",
     .label = "Voronoi Texture",
     .inputs = kVoronoiIn,
     .outputs = kVoronoiOut,
     .options = kVoronoiOptions,
     .value = nodes::voronoi_texture},
    {.name = "wave_texture",
     .label = "Wave Texture",
     .inputs = kWaveIn,
     .outputs = kColorFacOut,
     .options = kWaveOptions,
     .value = nodes::wave_texture},
    {.name = "magic_texture",
     .label = "Magic Texture",
     .inputs = kMagicIn,
     .outputs = kColorFacOut,
     .options = kMagicOptions,
     .value = nodes::magic_texture},
    {.name = "brick_texture",
     .label = "Brick Texture",
     .inputs = kBrickIn,
     .outputs = kColorFacOut,
     .arrays = kBrickArrays,
     .value = nodes::brick_texture},
    {.name = "rgb",
     .label = "RGB",
     .inputs = kRgbIn,
     .outputs = kColorOut,
     .value = nodes::same_as_input},
    {.name = "value",
     .label = "Value",
     .inputs = kValueIn,
     .outputs = kValueOut,
     .value = nodes::same_as_input},
};

std::string table_text() {
    std::string text;
    for (const NodeKind& kind : kTable) {
        text += std::string(kind.name) + ":";
        for (const InputSocket& s : kind.inputs)
            text += std::string(" in ") + s.name + ":" + type_name(s.type);
        for (const OutputSocket& s : kind.outputs)
            text += std::string(" out ") + s.name + ":" + type_name(s.type);
        for (const NodeOption& o : kind.options)
            text += std::string(" option ") + o.name + "=" + (*o.values != '\0' ? o.values : "TEXT");
        for (const NodeArray& a : kind.arrays)
            text += fmt::format(" array {}:{}", a.name, a.columns);
        if (kind.reads_image) text += " image";
        text += "\n";
    }
    return text;
}

}  // namespace

const char* type_name(SocketType type) {
    switch (type) {
        case scalar: return "float";
        case color: return "color";
        case vector: return "vector";
        case shader: return "shader";
    }
    return "";
}

int choice_of(std::string_view choices, std::string_view value) {
    for (int i = 0;; ++i) {
        const size_t bar = choices.find('|');
        if (choices.substr(0, bar) == value) return i;
        if (bar == std::string_view::npos) return -1;
        choices.remove_prefix(bar + 1);
    }
}

std::span<const NodeKind> node_table() { return kTable; }

const char* node_kinds_text() {
    static const std::string text = table_text();
    return text.c_str();
}

}  // namespace spc
