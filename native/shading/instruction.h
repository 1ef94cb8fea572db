// SPDX-License-Identifier: GPL-3.0-or-later
// The compiled form of a material. Values live in a small array of registers; an operand names a
// register or, if negative, a constant, so that a material of constants has no value instructions
// at all.
#pragma once

#include <cstdint>
#include <vector>

#include "bsdf/closure.h"
#include "core/image.h"

namespace spc {

enum class Op : uint8_t {
    constant,  // an expression only, never an instruction
    // Arithmetic: depends on the inputs alone.
    add,
    subtract,
    multiply,
    divide,  // 0 where the divisor is 0
    scale,   // vector times scalar
    one_minus,
    clamp01,
    non_negative,
    maximum,
    square_root,
    luminance,
    mean,
    splat,
    normalize,        // 0 stays 0
    affine,           // a constant matrix
    rotate,           // by Euler angles XYZ
    rotate_back,      // by the inverse
    dielectric_ior,   // index from (IOR, Specular IOR Level)
    combine,          // three scalars to a vector
    equirectangular,  // direction to image coordinates
    mirror_ball,
    // What a point offers.
    uv,
    position,
    position_object,
    normal_object,   // unit, in object space, on the side of wo
    image,           // coordinates to colour, and alpha in a fourth lane
    image_alpha,     // an expression only: that fourth lane
    normal_map,      // (strength, colour) to a unit normal on the side of wo
    bump,            // (strength, distance, normal or none) to a unit normal on the side of wo
    shading_normal,  // any vector to a unit normal; the interpolated one where it is 0
    coat  // what a coat lets through: (normal or none, (share, alpha, index), tint); of floats alone
};

enum class NormalSpace : uint8_t { tangent, object, world };

// Instruction::mode of an image.
inline uint8_t image_mode(Interpolation interpolation, Extension extension, bool straight) {
    return static_cast<uint8_t>(static_cast<int>(interpolation) | static_cast<int>(extension) << 2 |
                                (straight ? 16 : 0));
}
inline Interpolation mode_interpolation(uint8_t mode) {
    return static_cast<Interpolation>(mode & 3);
}
inline Extension mode_extension(uint8_t mode) { return static_cast<Extension>(mode >> 2 & 3); }
inline bool mode_straight(uint8_t mode) { return (mode & 16) != 0; }

// i >= 0: register i; i < 0: constant ~i. Vectors take three in a row.
using Operand = int16_t;
inline constexpr Operand kNoOperand = INT16_MIN;
inline constexpr int kMaxRegisters = 256;

struct Instruction {
    Op op;
    uint8_t lanes;  // 1 or 3
    uint8_t mode;   // image: image_mode(); normal_map: NormalSpace; bump: 1 where inverted
    Operand out;
    Operand in[3];
    // Image, UV layer, where the rows of a matrix begin among the constants, or the height among
    // Program::heights.
    uint32_t index;
};

inline bool reads_layer(const Instruction& i) {
    return i.op == Op::uv ||
           (i.op == Op::normal_map && i.mode == static_cast<uint8_t>(NormalSpace::tangent));
}

// One term of a surface. Its operands: weight (a scalar), normal (kNoOperand: the interpolated
// one), then
enum class ClosureOp : uint8_t {
    lambert,      // colour
    transparent,  // colour
    glossy,       // alpha, colour
    metal,        // alpha, colour at normal incidence, tint at 82 degrees
    dielectric,   // alpha, IOR of a front face, reflection tint, transmission tint
    coated,  // alpha, index, reflectance at normal incidence, colour below: a dielectric's reflection over Lambert
    coat     // alpha, index: the reflection of what lies over other terms
};
inline constexpr int kMaxClosureOperands = 6;

struct ClosureModes {
    MicrofacetModel model = MicrofacetModel::ggx;
    bool energy_compensated = false;
    bool reflects = true, refracts = true, fresnel_weighted = true;  // dielectric
};

struct ClosureInstruction {
    ClosureOp op = ClosureOp::lambert;
    ClosureModes modes;
    bool on_caster_normal = false, on_slope_map = false;
    std::array<Operand, kMaxClosureOperands> in{};
    Operand through = kNoOperand;  // what the coat above lets through, a colour; none: all
    // For a lobe on the slope map under a coat: the coat's (share, alpha, index), and its tint.
    Operand coat = kNoOperand, coat_tint = kNoOperand;
};

// A run of value instructions and where they leave what was asked for (kNoOperand: zero).
struct Section {
    uint32_t begin = 0, end = 0;
    Operand result = kNoOperand;
};

struct Program {
    std::vector<Instruction> instructions;
    std::vector<float> constants;
    std::vector<ClosureInstruction> closures;
    Section surface;  // operands of the closures; its result is the emission
    Section emission, transparency, caster_normal, background;
    std::vector<Section> heights;  // of bumps; what they need is not part of the other sections
};

}  // namespace spc
