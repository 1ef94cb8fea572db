// SPDX-License-Identifier: GPL-3.0-or-later
// Values between a graph and its program: an acyclic graph of operations, equal ones shared,
// constants folded while it is built. Not seen outside of shading/.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "shading/instruction.h"

namespace spc {

using ExprId = int32_t;
inline constexpr ExprId kNoExpr = -1;

struct Expr {
    Op op = Op::constant;
    uint8_t lanes = 1;       // 1 or 3
    uint8_t mode = 0;        // as Instruction::mode
    uint32_t index = 0;      // as Instruction::index; a block by its number, a height by its ExprId
    std::vector<ExprId> in;  // as many as the operation's row says; kNoExpr where one is left out
    std::array<float, 4> value{};  // of a constant; the fourth where it comes from an operation that has it
};

class ExprBuilder {
public:
    ExprId constant(float value);
    ExprId constant(const Vec3& value);

    // Lane by lane; both have the same number of lanes.
    ExprId add(ExprId a, ExprId b);
    ExprId subtract(ExprId a, ExprId b) { return make(Op::subtract, {a, b}); }
    ExprId multiply(ExprId a, ExprId b);
    ExprId divide(ExprId a, ExprId b) { return make(Op::divide, {a, b}); }
    ExprId maximum(ExprId a, ExprId b) { return make(Op::maximum, {a, b}); }
    // Any number of lanes -> the same.
    ExprId one_minus(ExprId a) { return make(Op::one_minus, {a}); }
    ExprId clamp01(ExprId a) { return make(Op::clamp01, {a}); }
    ExprId non_negative(ExprId a) { return make(Op::non_negative, {a}); }
    ExprId square_root(ExprId a) { return make(Op::square_root, {a}); }
    // Three lanes times one.
    ExprId scale(ExprId vector, ExprId scalar);
    // One of three lanes, or the fourth of an operation that has it.
    ExprId lane(ExprId vector, uint8_t number) { return make(Op::lane, {vector}, number); }
    ExprId combine(ExprId x, ExprId y, ExprId z) { return make(Op::combine, {x, y, z}); }
    ExprId luminance(ExprId color) { return make(Op::luminance, {color}); }
    ExprId mean(ExprId vector) { return make(Op::mean, {vector}); }
    ExprId splat(ExprId scalar) { return make(Op::splat, {scalar}); }
    ExprId normalize(ExprId vector) { return make(Op::normalize, {vector}); }
    ExprId affine(ExprId vector, const std::array<float, 12>& rows) {
        return make(Op::affine, {vector}, 0, block({rows.begin(), rows.end()}));
    }

    // The operation of these operands; an equal one if there is one, or its value if all it depends
    // on is constant. `mode` and `index` are those of Expr.
    ExprId make(Op op, std::vector<ExprId> in, uint8_t mode = 0, uint32_t index = 0);
    // Number of a block of constants, for operations that look something up.
    uint32_t block(const std::vector<float>& values);

    const Expr& operator[](ExprId id) const { return exprs_[static_cast<size_t>(id)]; }
    uint8_t lanes(ExprId id) const { return (*this)[id].lanes; }
    bool is_constant(ExprId id) const { return (*this)[id].op == Op::constant; }
    bool is_constant(ExprId id, float value) const;  // in all lanes
    float scalar(ExprId id) const { return (*this)[id].value[0]; }
    Vec3 vector(ExprId id) const {
        return Vec3((*this)[id].value[0], (*this)[id].value[1], (*this)[id].value[2]);
    }
    const std::vector<float>& block_values(uint32_t block) const { return blocks_[block]; }
    // How many derivatives a value has: as many as the operation with the fewest that it depends
    // on.
    int derivatives(ExprId id) const;

    // The bits of ProgramReads that a value depends on.
    uint32_t reads(ExprId id) const;

    // What `id` comes to on average: textures at their means, whatever their coordinates; coats
    // clear; other things that vary over a surface at 0.
    Vec3 mean_value(ExprId id, std::span<const Image> images);

private:
    ExprId insert(Expr expr);
    ExprId fold(const Expr& expr);

    std::vector<Expr> exprs_;
    std::map<std::vector<uint32_t>, ExprId> known_;  // by all that an Expr holds
    std::vector<std::vector<float>> blocks_;
    std::map<std::vector<float>, uint32_t> known_blocks_;
};

}  // namespace spc
