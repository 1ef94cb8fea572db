// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes of procedural textures.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

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

constexpr InputSocket kIesIn[] = {{"Vector", {}, vector, Unlinked::incoming},
                                  scalar_input("Strength", 1.0f)};
constexpr NodeArray kIesArrays[] = {{"Profile", 1}};  // as LightProfile reads it

constexpr NodeKind kRows[] = {
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
    {.name = "ies_texture",
     .label = "IES Texture",
     .inputs = kIesIn,
     .outputs = kFacOut,
     .arrays = kIesArrays,
     .value = nodes::ies_texture},
};

}  // namespace

std::span<const NodeKind> texture() { return kRows; }

}  // namespace spc::rows
