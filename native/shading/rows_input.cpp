// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes that read how a surface is seen.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr InputSocket kFresnelIn[] = {scalar_input("IOR", 1.5f), kNormalInput};
constexpr InputSocket kLayerWeightIn[] = {scalar_input("Blend", 0.5f), kNormalInput};
constexpr OutputSocket kLayerWeightOut[] = {{"Fresnel", scalar}, {"Facing", scalar}};
constexpr OutputSocket kGeometryOut[] = {{"Position", vector},
                                         {"Normal", vector},
                                         {"True Normal", vector},
                                         {"Incoming", vector},
                                         {"Backfacing", scalar}};

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
};

}  // namespace

std::span<const NodeKind> input() { return kRows; }

}  // namespace spc::rows
