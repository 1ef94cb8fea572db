// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes of surfaces.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr OutputSocket kBsdf[] = {{"BSDF", shader}};
constexpr OutputSocket kShader[] = {{"Shader", shader}};
constexpr NodeOption kReflectionModels[] = {{"distribution", "GGX|BECKMANN|MULTI_GGX"}};
constexpr NodeOption kRefractionModels[] = {{"distribution", "GGX|BECKMANN"}};
constexpr InputSocket kOutputIn[] = {shader_input("Surface"), shader_input("Volume"),
                                     vector_input("Displacement", 0.0f)};
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

constexpr NodeKind kRows[] = {
    {.name = "output",
     .label = "Output",
     .inputs = kOutputIn,
     .shade = nodes::output,
     .part = ShaderPart::both},
    {.name = "bsdf_diffuse",
     .label = "Diffuse BSDF",
     .inputs = kDiffuseIn,
     .outputs = kBsdf,
     .shade = nodes::diffuse},
    {.name = "bsdf_glossy",
     .label = "Glossy BSDF",
     .inputs = kGlossyIn,
     .outputs = kBsdf,
     .options = kReflectionModels,
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
};

}  // namespace

std::span<const NodeKind> surface() { return kRows; }

}  // namespace spc::rows
