// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes that read images, coordinates and constants.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr InputSocket kImageIn[] = {{"Vector", {}, vector, Unlinked::uv},
                                    scalar_input("Blend", 0.0f)};
constexpr NodeOption kImageOptions[] = {{"interpolation", "Linear|Closest|Cubic|Smart"},
                                        {"extension", "REPEAT|EXTEND|CLIP|MIRROR"},
                                        {"projection", "FLAT|BOX|SPHERE|TUBE"}};
// Of a picture in tiles: the number of each, counted from 0 in rows of ten, and its image.
constexpr NodeArray kImageArrays[] = {{"Tiles", 2, true}};
constexpr InputSocket kEnvironmentIn[] = {{"Vector", {}, vector, Unlinked::direction}};
constexpr NodeOption kEnvironmentOptions[] = {{"projection", "EQUIRECTANGULAR|MIRROR_BALL"},
                                              {"interpolation", "Linear|Closest|Cubic|Smart"}};
constexpr InputSocket kNormalMapIn[] = {scalar_input("Strength", 1.0f),
                                        color_input(0.5f, 0.5f, 1.0f)};
constexpr OutputSocket kNormalOut[] = {{"Normal", vector}};
constexpr NodeOption kNormalMapOptions[] = {
    {"space", "TANGENT|OBJECT|WORLD|BLENDER_OBJECT|BLENDER_WORLD"}, {"uv_map", ""}};
constexpr InputSocket kBumpIn[] = {scalar_input("Strength", 1.0f), scalar_input("Distance", 1.0f),
                                   scalar_input("Height", 1.0f), kNormalInput};
constexpr NodeOption kBumpOptions[] = {{"invert", "False|True"}};
constexpr OutputSocket kUvOut[] = {{"UV", vector}};
constexpr InputSocket kDisplacementIn[] = {scalar_input("Height", 0.0f),
                                           scalar_input("Midlevel", 0.5f),
                                           scalar_input("Scale", 1.0f), kNormalInput};
constexpr NodeOption kDisplacementOptions[] = {{"space", "OBJECT|WORLD"}};
constexpr InputSocket kVectorDisplacementIn[] = {
    grey_input(0.0f, "Vector"), scalar_input("Midlevel", 0.0f), scalar_input("Scale", 1.0f)};
constexpr NodeOption kVectorDisplacementOptions[] = {{"space", "TANGENT|OBJECT|WORLD"}};
constexpr OutputSocket kDisplacementOut[] = {{"Displacement", vector}};
constexpr NodeOption kFromInstancer{"from_instancer", "False|True"};
constexpr NodeOption kUvOptions[] = {{"uv_map", ""}, kFromInstancer};
constexpr NodeOption kCoordinateOptions[] = {kFromInstancer};
constexpr OutputSocket kCoordinateOut[] = {
    {"Generated", vector}, {"Normal", vector}, {"UV", vector},        {"Object", vector},
    {"Camera", vector},    {"Window", vector}, {"Reflection", vector}};
constexpr NodeArray kCoordinateArrays[] = {{"Object", 4, true}};  // rows from the world to it
constexpr InputSocket kMappingIn[] = {vector_input("Vector", 0.0f), vector_input("Location", 0.0f),
                                      vector_input("Rotation", 0.0f), vector_input("Scale", 1.0f)};
constexpr NodeOption kMappingOptions[] = {{"vector_type", "POINT|TEXTURE|VECTOR|NORMAL"}};
constexpr InputSocket kRgbIn[] = {grey_input(0.5f)};
constexpr InputSocket kValueIn[] = {scalar_input("Value", 0.5f)};

constexpr NodeKind kRows[] = {
    {.name = "image_texture",
     .label = "Image Texture",
     .inputs = kImageIn,
     .outputs = kColorAlphaOut,
     .options = kImageOptions,
     .arrays = kImageArrays,
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
    {.name = "displacement",
     .label = "Displacement",
     .inputs = kDisplacementIn,
     .outputs = kDisplacementOut,
     .options = kDisplacementOptions,
     .value = nodes::displacement},
    {.name = "vector_displacement",
     .label = "Vector Displacement",
     .inputs = kVectorDisplacementIn,
     .outputs = kDisplacementOut,
     .options = kVectorDisplacementOptions,
     .value = nodes::vector_displacement},
    {.name = "uv_map",
     .label = "UV Map",
     .outputs = kUvOut,
     .options = kUvOptions,
     .value = nodes::uv_map},
    {.name = "texture_coordinate",
     .label = "Texture Coordinate",
     .outputs = kCoordinateOut,
     .options = kCoordinateOptions,
     .arrays = kCoordinateArrays,
     .value = nodes::texture_coordinate},
    {.name = "mapping",
     .label = "Mapping",
     .inputs = kMappingIn,
     .outputs = kVectorOut,
     .options = kMappingOptions,
     .value = nodes::mapping},
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

}  // namespace

std::span<const NodeKind> value() { return kRows; }

}  // namespace spc::rows
