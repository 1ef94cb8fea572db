// SPDX-License-Identifier: GPL-3.0-or-later
// The functions behind the rows of the node table. Inputs and options are named by their place in
// the row.
#pragma once

#include "shading/compiler.h"

namespace spc::nodes {

// nodes_value.cpp
ExprId image_texture(NodeContext& node, int output);
ExprId environment_texture(NodeContext& node, int output);
ExprId normal_map(NodeContext& node, int output);
ExprId bump(NodeContext& node, int output);
ExprId uv_map(NodeContext& node, int output);
ExprId texture_coordinate(NodeContext& node, int output);
ExprId mapping(NodeContext& node, int output);
ExprId same_as_input(NodeContext& node, int output);

// nodes_converter.cpp
ExprId math(NodeContext& node, int output);
ExprId vector_math(NodeContext& node, int output);
ExprId mix(NodeContext& node, int output);
ExprId mix_rgb(NodeContext& node, int output);
ExprId map_range(NodeContext& node, int output);
ExprId clamp(NodeContext& node, int output);
ExprId separate_xyz(NodeContext& node, int output);
ExprId combine_xyz(NodeContext& node, int output);
ExprId separate_color(NodeContext& node, int output);
ExprId combine_color(NodeContext& node, int output);
ExprId vector_rotate(NodeContext& node, int output);
ExprId rgb_to_bw(NodeContext& node, int output);
ExprId invert(NodeContext& node, int output);
ExprId gamma(NodeContext& node, int output);
ExprId bright_contrast(NodeContext& node, int output);
ExprId hue_saturation(NodeContext& node, int output);
ExprId curves(NodeContext& node, int output);
ExprId normal(NodeContext& node, int output);
ExprId color_ramp(NodeContext& node, int output);

// nodes_texture.cpp
ExprId checker_texture(NodeContext& node, int output);
ExprId gradient_texture(NodeContext& node, int output);
ExprId white_noise_texture(NodeContext& node, int output);
ExprId ies_texture(NodeContext& node, int output);
ExprId noise_texture(NodeContext& node, int output);
ExprId musgrave_texture(NodeContext& node, int output);
ExprId voronoi_texture(NodeContext& node, int output);
ExprId wave_texture(NodeContext& node, int output);
ExprId magic_texture(NodeContext& node, int output);
ExprId brick_texture(NodeContext& node, int output);

// nodes_displacement.cpp
inline constexpr int kDisplacementOfOutput = 2;  // input of the output that says where points move
ExprId displacement(NodeContext& node, int output);
ExprId vector_displacement(NodeContext& node, int output);

// nodes_input.cpp
ExprId fresnel(NodeContext& node, int output);
ExprId layer_weight(NodeContext& node, int output);
ExprId geometry(NodeContext& node, int output);
ExprId attribute(NodeContext& node, int output);
ExprId light_path(NodeContext& node, int output);
ExprId light_falloff(NodeContext& node, int output);
ExprId blackbody(NodeContext& node, int output);
ExprId wavelength(NodeContext& node, int output);
ExprId bevel(NodeContext& node, int output);
ExprId ambient_occlusion(NodeContext& node, int output);
ExprId hair_info(NodeContext& node, int output);
ExprId absent_info(NodeContext& node, int output);
ExprId vertex_color(NodeContext& node, int output);
ExprId object_info(NodeContext& node, int output);
ExprId particle_info(NodeContext& node, int output);

// nodes_space.cpp
ExprId radial_tangent(NodeContext& node, int axis);
ExprId tangent(NodeContext& node, int output);
ExprId camera_data(NodeContext& node, int output);
ExprId vector_transform(NodeContext& node, int output);
ExprId wireframe(NodeContext& node, int output);

// nodes_volume.cpp
void volume_absorption(NodeContext& node, ExprId weight);
void volume_principled(NodeContext& node, ExprId weight);

// nodes_surface.cpp
void diffuse(NodeContext& node, ExprId weight);
void translucent(NodeContext& node, ExprId weight);
void sheen(NodeContext& node, ExprId weight);
void toon(NodeContext& node, ExprId weight);
void holdout(NodeContext& node, ExprId weight);
void glossy(NodeContext& node, ExprId weight);
void metallic(NodeContext& node, ExprId weight);
void glass(NodeContext& node, ExprId weight);
void refraction(NodeContext& node, ExprId weight);
void transparent(NodeContext& node, ExprId weight);
void emission(NodeContext& node, ExprId weight);
void background(NodeContext& node, ExprId weight);
void mix_shader(NodeContext& node, ExprId weight);
void add_shader(NodeContext& node, ExprId weight);
void output(NodeContext& node, ExprId weight);
void principled(NodeContext& node, ExprId weight);
void subsurface(NodeContext& node, ExprId weight);

// nodes_stand_ins.cpp
void hair(NodeContext& node, ExprId weight);
void principled_hair(NodeContext& node, ExprId weight);
void ray_portal(NodeContext& node, ExprId weight);

}  // namespace spc::nodes
