// SPDX-License-Identifier: GPL-3.0-or-later
// The compiled form of a material. Values live in a small array of registers; an operand names a
// register or, if negative, a constant, so that a material of constants has no value instructions
// at all.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "shading/closure_op.h"
#include "shading/operation.h"

namespace spc {

enum class RayDepth : uint8_t { total, diffuse, glossy, transparent, transmission };

// Of Vector Transform.
enum class VectorSpace : uint8_t { world, object, camera };
enum class VectorMeaning : uint8_t { vector, point, normal };

// Instruction::mode of a transform.
inline uint8_t transform_mode(VectorSpace from, VectorSpace to, VectorMeaning meaning) {
    return static_cast<uint8_t>(static_cast<int>(from) | static_cast<int>(to) << 2 |
                                static_cast<int>(meaning) << 4);
}

enum class NormalSpace : uint8_t { tangent, object, world };  // of a Normal Map

// Instruction::mode of an image.
inline uint8_t image_mode(Interpolation interpolation, Extension extension, bool straight) {
    return static_cast<uint8_t>(static_cast<int>(interpolation) | static_cast<int>(extension) << 2 |
                                (straight ? 16 : 0));
}
inline Interpolation mode_interpolation(uint8_t mode) {
    return static_cast<Interpolation>(mode & 3);
}
inline uint8_t with_interpolation(uint8_t mode, Interpolation interpolation) {
    return static_cast<uint8_t>((mode & ~3) | static_cast<int>(interpolation));
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
    uint8_t mode;  // image: image_mode(); textures: textures.h; ramp: Interpolation; space_normal: NormalSpace; bump: 1 where inverted;
                   // normal, normal_object: kHeldStill or 0
    Operand out;
    uint32_t operands;  // where its row's `arity` of them begin in Program::operands
    uint32_t index;     // of what its row's `index` says; a block by where it begins
};

struct ClosureModes {
    MicrofacetModel model = MicrofacetModel::ggx;
    bool energy_compensated = false;
    SubsurfaceEntry entry = SubsurfaceEntry::diffuse;
    bool dipole_radius = true;
    bool exchanges = true;  // diffuse facets give light to each other
    bool reflects = true, refracts = true, fresnel_weighted = true;  // dielectric
};

struct ClosureInstruction {
    ClosureOp op = ClosureOp::lambert;
    ClosureModes modes;
    bool on_caster_normal = false, on_slope_map = false;
    uint32_t operands = 0;         // as of an instruction
    Operand through = kNoOperand;  // what the coat above lets through, a colour; none: all
    // Of a lobe that is stretched along a tangent, by a factor that the other axis lacks; none: it
    // is round.
    Operand stretch = kNoOperand, tangent = kNoOperand;
    Operand film_thickness = kNoOperand, film_ior = kNoOperand;  // nm; none: there is no film
    // Of a diffuse part of which a share goes on below: the share, the radius in m, and
    // (anisotropy, alpha, index).
    Operand below_share = kNoOperand, below_radius = kNoOperand, below_entry = kNoOperand;
    // For a lobe on the slope map under a coat: the coat's (share, alpha, index), and its tint.
    Operand coat = kNoOperand, coat_tint = kNoOperand;
};

// Mode of a normal that has no derivatives, as where a height is measured along it.
inline constexpr uint8_t kHeldStill = 1;

// A run of value instructions and where they leave what was asked for (kNoOperand: zero).
struct Section {
    uint32_t begin = 0, end = 0;
    Operand result = kNoOperand;
};

struct Program {
    std::vector<Instruction> instructions;
    std::vector<Operand> operands;
    std::vector<float> constants;
    std::vector<float> blocks;  // of numbers that an operation looks up: rows of matrices
    std::vector<ClosureInstruction> closures;
    Section surface;  // operands of the closures; its result is the emission
    Section emission, transparency, caster_normal, background;
    struct Aov {
        Section color, value;
    };
    std::vector<Aov> aovs;
    Operand surface_normal =
        kNoOperand;        // of the surface's section: after displacement; none: interpolated
    Section displacement;  // by which vertices move: m, world
    std::vector<Section> heights;  // of bumps; what they need is not part of the other sections
};

}  // namespace spc
