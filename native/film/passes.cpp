// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/passes.h"

#include <cstring>

namespace spc {

namespace {

constexpr std::array<PassDesc, kPasses> kTable{{
    {"Combined", "RGBA", Accumulation::picture},
    {"Depth", "Z", Accumulation::first},
    {"Position", "XYZ", Accumulation::first},
    {"Normal", "XYZ", Accumulation::mean},
    {"Caustics", "RGB", Accumulation::light},
    {"Variance", "RGB", Accumulation::picture},
    {"Walk Success", "X", Accumulation::ratio},
    {"Walk Trials", "X", Accumulation::ratio},
    {"UV", "UVA", Accumulation::first},
    {"Mist", "Z", Accumulation::mean},
    {"Object Index", "X", Accumulation::first},
    {"Material Index", "X", Accumulation::first},
    {"Emission", "RGB", Accumulation::light},
    {"Environment", "RGB", Accumulation::light},
    {"Diffuse Direct", "RGB", Accumulation::light_by_color},
    {"Glossy Direct", "RGB", Accumulation::light_by_color},
    {"Transmission Direct", "RGB", Accumulation::light_by_color},
    {"Diffuse Indirect", "RGB", Accumulation::light_by_color},
    {"Glossy Indirect", "RGB", Accumulation::light_by_color},
    {"Transmission Indirect", "RGB", Accumulation::light_by_color},
    {"Diffuse Color", "RGB", Accumulation::mean},
    {"Glossy Color", "RGB", Accumulation::mean},
    {"Transmission Color", "RGB", Accumulation::mean},
    {"Denoising Albedo", "RGB", Accumulation::mean},
    {"Denoising Normal", "XYZ", Accumulation::mean},
    {"Denoising Depth", "Z", Accumulation::mean},
    {"Debug Sample Count", "X", Accumulation::picture},
}};

constexpr std::array<PassDesc, kCustomKinds> kCustomTable{{
    {"Light Group", "RGB", Accumulation::light},
    {"Color AOV", "RGBA", Accumulation::mean},
    {"Value AOV", "X", Accumulation::mean},
}};

}  // namespace

const PassDesc& describe(Pass pass) {
    if (pass < Pass::count) return kTable[static_cast<size_t>(pass)];
    return kCustomTable[static_cast<uint32_t>(pass) / kMostCustom - 1];
}

bool is_pass(uint32_t number) {
    return number < kPasses || (number >= kMostCustom && number < (kCustomKinds + 1) * kMostCustom);
}

uint32_t pass_channels(Pass pass) {
    return static_cast<uint32_t>(std::strlen(describe(pass).channels));
}

PassSet PassSet::with_colors() const {
    PassSet result = *this;
    for (size_t i = 0; i < kLobes; ++i) {
        const auto lobe = static_cast<Lobe>(i);
        if (has(pass_of(Pass::diffuse_direct, lobe)) || has(pass_of(Pass::diffuse_indirect, lobe)))
            result.add(pass_of(Pass::diffuse_color, lobe));
    }
    return result;
}

}  // namespace spc
