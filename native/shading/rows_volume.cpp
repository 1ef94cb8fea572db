// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the nodes of volumes.
#include "shading/node_rows.h"

namespace spc::rows {
namespace {

constexpr InputSocket kAbsorptionIn[] = {grey_input(0.8f), scalar_input("Density", 1.0f)};
constexpr InputSocket kPrincipledVolumeIn[] = {grey_input(0.5f), scalar_input("Density", 1.0f),
                                               grey_input(0.0f, "Absorption Color")};
constexpr OutputSocket kVolume[] = {{"Volume", shader}};

constexpr NodeKind kRows[] = {
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
};

}  // namespace

std::span<const NodeKind> volume() { return kRows; }

}  // namespace spc::rows
