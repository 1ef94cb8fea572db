// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes that convert values.
#include "shading/color_functions.h"
#include "shading/named_ops.h"
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

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

constexpr NodeKind kRows[] = {
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
};

}  // namespace

std::span<const NodeKind> converter() { return kRows; }

}  // namespace spc::rows
