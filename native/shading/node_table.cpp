// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/node_table.h"

#include "shading/graph.h"
#include "shading/nodes.h"

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
constexpr NodeOption kReflectionModels[] = {{"distribution", "GGX|BECKMANN|MULTI_GGX"}};
constexpr NodeOption kRefractionModels[] = {{"distribution", "GGX|BECKMANN"}};

constexpr InputSocket kOutputIn[] = {shader_input("Surface"), shader_input("Volume")};
constexpr InputSocket kDiffuseIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.0f),
                                      kNormalInput};
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
constexpr OutputSocket kImageOut[] = {{"Color", color}, {"Alpha", scalar}};
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
constexpr InputSocket kRgbIn[] = {grey_input(0.5f)};
constexpr InputSocket kValueIn[] = {scalar_input("Value", 0.5f)};
constexpr OutputSocket kValueOut[] = {{"Value", scalar}};

// kind, label, inputs, outputs, options, reads an image, value, shade, part
constexpr NodeKind kTable[] = {
    {"output", "Output", kOutputIn, {}, {}, false, nullptr, nodes::output, ShaderPart::both},
    {"bsdf_diffuse", "Diffuse BSDF", kDiffuseIn, kBsdf, {}, false, nullptr, nodes::diffuse},
    {"bsdf_glossy", "Glossy BSDF", kGlossyIn, kBsdf, kReflectionModels, false, nullptr,
     nodes::glossy},
    {"bsdf_glass", "Glass BSDF", kGlassIn, kBsdf, kReflectionModels, false, nullptr, nodes::glass},
    {"bsdf_refraction", "Refraction BSDF", kRefractionIn, kBsdf, kRefractionModels, false, nullptr,
     nodes::refraction},
    {"bsdf_transparent", "Transparent BSDF", kTransparentIn, kBsdf, {}, false, nullptr, nodes::transparent},
    {"bsdf_principled", "Principled BSDF", kPrincipledIn, kBsdf, kPrincipledModels, false, nullptr,
     nodes::principled},
    {"emission", "Emission", kEmissionIn, kEmissionOut, {}, false, nullptr, nodes::emission},
    {"background", "Background", kBackgroundIn, kBackgroundOut, {}, false, nullptr, nodes::background},
    {"volume_absorption",
     "Volume Absorption",
     kAbsorptionIn,
     kVolume,
     {},
     false,
     nullptr,
     nodes::volume_absorption,
     ShaderPart::volume},
    {"volume_principled",
     "Principled Volume",
     kPrincipledVolumeIn,
     kVolume,
     {},
     false,
     nullptr,
     nodes::volume_principled,
     ShaderPart::volume},
    {"mix_shader", "Mix Shader", kMixIn, kShader, {}, false, nullptr, nodes::mix_shader, ShaderPart::both},
    {"add_shader", "Add Shader", kAddIn, kShader, {}, false, nullptr, nodes::add_shader, ShaderPart::both},
    {"image_texture", "Image Texture", kImageIn, kImageOut, kImageOptions, true,
     nodes::image_texture, nullptr},
    {"environment_texture", "Environment Texture", kEnvironmentIn, kColorOut, kEnvironmentOptions,
     true, nodes::environment_texture, nullptr},
    {"normal_map", "Normal Map", kNormalMapIn, kNormalOut, kNormalMapOptions, false,
     nodes::normal_map, nullptr},
    {"bump", "Bump", kBumpIn, kNormalOut, kBumpOptions, false, nodes::bump, nullptr},
    {"uv_map", "UV Map", {}, kUvOut, kUvOptions, false, nodes::uv_map, nullptr},
    {"texture_coordinate",
     "Texture Coordinate",
     {},
     kCoordinateOut,
     {},
     false,
     nodes::texture_coordinate,
     nullptr},
    {"mapping", "Mapping", kMappingIn, kVectorOut, kMappingOptions, false, nodes::mapping, nullptr},
    {"rgb", "RGB", kRgbIn, kColorOut, {}, false, nodes::same_as_input, nullptr},
    {"value", "Value", kValueIn, kValueOut, {}, false, nodes::same_as_input, nullptr},
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

std::span<const NodeKind> node_table() { return kTable; }

const char* node_kinds_text() {
    static const std::string text = table_text();
    return text.c_str();
}

}  // namespace spc
