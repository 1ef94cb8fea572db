// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes of surfaces.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

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
constexpr InputSocket kOutputIn[] = {shader_input("Surface"), shader_input("Volume"),
                                     vector_input("Displacement", 0.0f)};
constexpr InputSocket kDiffuseIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.0f),
                                      kNormalInput};
constexpr InputSocket kTranslucentIn[] = {grey_input(0.8f), kNormalInput};
constexpr InputSocket kSheenIn[] = {grey_input(0.8f), scalar_input("Roughness", 0.5f), kNormalInput};
constexpr InputSocket kToonIn[] = {grey_input(0.8f), scalar_input("Size", 0.5f),
                                   scalar_input("Smooth", 0.0f), kNormalInput};
constexpr InputSocket kTangentInput{"Tangent", {}, vector, Unlinked::tangent};
constexpr InputSocket kFilmThicknessInput = scalar_input("Thin Film Thickness", 0.0f);  // nm
constexpr InputSocket kFilmIorInput = scalar_input("Thin Film IOR", 1.33f);
constexpr InputSocket kGlossyIn[] = {grey_input(0.8f),
                                     scalar_input("Roughness", 0.5f),
                                     kNormalInput,
                                     scalar_input("Anisotropy", 0.0f),
                                     scalar_input("Rotation", 0.0f),
                                     kTangentInput};
constexpr InputSocket kMetallicIn[] = {{"Base Color", {0.617f, 0.577f, 0.540f}, color},
                                       {"Edge Tint", {0.695f, 0.726f, 0.770f}, color},
                                       {"IOR", {2.757f, 2.513f, 2.231f}, vector},
                                       {"Extinction", {3.867f, 3.404f, 3.009f}, vector},
                                       scalar_input("Roughness", 0.5f),
                                       scalar_input("Anisotropy", 0.0f),
                                       scalar_input("Rotation", 0.0f),
                                       kNormalInput,
                                       kTangentInput,
                                       kFilmThicknessInput,
                                       kFilmIorInput};
constexpr NodeOption kMetallicModels[] = {{"distribution", "GGX|BECKMANN|MULTI_GGX"},
                                          {"fresnel_type", "F82|PHYSICAL_CONDUCTOR"}};
constexpr InputSocket kGlassIn[] = {grey_input(1.0f),          scalar_input("Roughness", 0.0f),
                                    scalar_input("IOR", 1.5f), kNormalInput,
                                    kFilmThicknessInput,       kFilmIorInput};
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
                                         {"Coat Normal", {}, vector, Unlinked::normal},
                                         scalar_input("Diffuse Roughness", 0.0f),
                                         scalar_input("Sheen Weight", 0.0f),
                                         scalar_input("Sheen Roughness", 0.5f),
                                         grey_input(1.0f, "Sheen Tint"),
                                         scalar_input("Anisotropic", 0.0f),
                                         scalar_input("Anisotropic Rotation", 0.0f),
                                         kTangentInput,
                                         scalar_input("Subsurface Weight", 0.0f),
                                         {"Subsurface Radius", {1.0f, 0.2f, 0.1f}, vector},
                                         scalar_input("Subsurface Scale", 0.05f),
                                         scalar_input("Subsurface IOR", 1.4f),
                                         scalar_input("Subsurface Anisotropy", 0.0f),
                                         kFilmThicknessInput,
                                         kFilmIorInput};
constexpr const char* kSubsurfaceMethods =
    "RANDOM_WALK|RANDOM_WALK_SKIN|RANDOM_WALK_FIXED_RADIUS|RANDOM_WALK_DIPOLE|BURLEY";
constexpr NodeOption kSubsurfaceOptions[] = {{"falloff", kSubsurfaceMethods}};
constexpr InputSocket kSubsurfaceIn[] = {grey_input(0.8f),
                                         scalar_input("Scale", 0.05f),
                                         {"Radius", {1.0f, 0.2f, 0.1f}, vector},
                                         scalar_input("IOR", 1.4f),
                                         scalar_input("Roughness", 1.0f),
                                         scalar_input("Anisotropy", 0.0f),
                                         kNormalInput};
constexpr OutputSocket kBssrdf[] = {{"BSSRDF", shader}};
constexpr InputSocket kHairIn[] = {grey_input(0.8f), scalar_input("Offset", 0.0f),
                                   scalar_input("RoughnessU", 0.1f),
                                   scalar_input("RoughnessV", 1.0f)};
constexpr NodeOption kHairModels[] = {{"component", "Reflection|Transmission"}};
constexpr InputSocket kPrincipledHairIn[] = {
    {"Color", {0.017513f, 0.005763f, 0.002059f}, color},
    scalar_input("Melanin", 0.8f),
    scalar_input("Melanin Redness", 1.0f),
    grey_input(1.0f, "Tint"),
    {"Absorption Coefficient", {0.245531f, 0.52f, 1.365f}, vector},
    scalar_input("Roughness", 0.3f),
    scalar_input("Radial Roughness", 0.3f),
    scalar_input("Coat", 0.0f),
    scalar_input("IOR", 1.55f),
    scalar_input("Offset", 0.0349066f),  // rad
    scalar_input("Random Color", 0.0f),
    scalar_input("Random Roughness", 0.0f),
    scalar_input("Random", 0.0f)};
constexpr NodeOption kPrincipledHairModels[] = {{"parametrization", "COLOR|MELANIN|ABSORPTION"},
                                                {"model", "CHIANG|HUANG"}};
constexpr InputSocket kPortalIn[] = {grey_input(1.0f)};
constexpr NodeOption kPrincipledModels[] = {{"distribution", "GGX|MULTI_GGX"},
                                            {"model", "LAYERED|BURLEY"},
                                            {"subsurface_method", kSubsurfaceMethods},
                                            {"film_on_metal", "True|False"}};

constexpr InputSocket kAovIn[] = {grey_input(0.0f), scalar_input("Value", 0.0f)};
constexpr NodeOption kAovName[] = {{"aov_name", ""}};

constexpr NodeKind kRows[] = {
    {.name = "output",
     .label = "Output",
     .inputs = kOutputIn,
     .shade = nodes::output,
     .part = ShaderPart::both},
    {.name = "aov_output", .label = "AOV Output", .inputs = kAovIn, .options = kAovName},
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
    {.name = "bsdf_metallic",
     .label = "Metallic BSDF",
     .inputs = kMetallicIn,
     .outputs = kBsdf,
     .options = kMetallicModels,
     .shade = nodes::metallic},
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
    {.name = "subsurface_scattering",
     .label = "Subsurface Scattering",
     .inputs = kSubsurfaceIn,
     .outputs = kBssrdf,
     .options = kSubsurfaceOptions,
     .shade = nodes::subsurface},
    {.name = "bsdf_hair",
     .label = "Hair BSDF",
     .inputs = kHairIn,
     .outputs = kBsdf,
     .options = kHairModels,
     .shade = nodes::hair},
    {.name = "bsdf_hair_principled",
     .label = "Principled Hair BSDF",
     .inputs = kPrincipledHairIn,
     .outputs = kBsdf,
     .options = kPrincipledHairModels,
     .shade = nodes::principled_hair},
    {.name = "bsdf_ray_portal",
     .label = "Ray Portal BSDF",
     .inputs = kPortalIn,
     .outputs = kBsdf,
     .shade = nodes::ray_portal},
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
