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
    uint8_t lanes = 1;   // 1 or 3
    uint8_t mode = 0;    // as Instruction::mode
    uint32_t index = 0;  // image, UV layer or matrix; of a bump the expression of its height
    std::array<ExprId, 3> in{kNoExpr, kNoExpr, kNoExpr};
    std::array<float, 3> value{};  // of a constant
};

class ExprBuilder {
public:
    ExprId constant(float value);
    ExprId constant(const Vec3& value);

    // Lane by lane; both have the same number of lanes.
    ExprId add(ExprId a, ExprId b);
    ExprId subtract(ExprId a, ExprId b) {
        return make({Op::subtract, lanes(a), 0, 0, {a, b, kNoExpr}, {}});
    }
    ExprId multiply(ExprId a, ExprId b);
    ExprId divide(ExprId a, ExprId b) {
        return make({Op::divide, lanes(a), 0, 0, {a, b, kNoExpr}, {}});
    }
    ExprId maximum(ExprId a, ExprId b) {
        return make({Op::maximum, lanes(a), 0, 0, {a, b, kNoExpr}, {}});
    }
    // Any number of lanes -> the same.
    ExprId one_minus(ExprId a) { return unary(Op::one_minus, lanes(a), a); }
    ExprId clamp01(ExprId a) { return unary(Op::clamp01, lanes(a), a); }
    ExprId non_negative(ExprId a) { return unary(Op::non_negative, lanes(a), a); }
    ExprId square_root(ExprId a) { return unary(Op::square_root, lanes(a), a); }
    // Three lanes times one.
    ExprId scale(ExprId vector, ExprId scalar);
    ExprId combine(ExprId x, ExprId y, ExprId z) {
        return make({Op::combine, 3, 0, 0, {x, y, z}, {}});
    }
    ExprId luminance(ExprId color) { return unary(Op::luminance, 1, color); }
    ExprId mean(ExprId vector) { return unary(Op::mean, 1, vector); }
    ExprId splat(ExprId scalar) { return unary(Op::splat, 3, scalar); }
    ExprId normalize(ExprId vector) { return unary(Op::normalize, 3, vector); }
    ExprId unary(Op op, uint8_t lanes, ExprId a) {
        return make({op, lanes, 0, 0, {a, kNoExpr, kNoExpr}, {}});
    }
    ExprId affine(ExprId vector, const std::array<float, 12>& rows);  // three rows of four

    // Adds `expr` if no equal one exists, or its value if all it reads is constant.
    ExprId make(const Expr& expr);

    const Expr& operator[](ExprId id) const { return exprs_[static_cast<size_t>(id)]; }
    uint8_t lanes(ExprId id) const { return (*this)[id].lanes; }
    bool is_constant(ExprId id) const { return (*this)[id].op == Op::constant; }
    bool is_constant(ExprId id, float value) const;  // in all lanes
    float scalar(ExprId id) const { return (*this)[id].value[0]; }
    Vec3 vector(ExprId id) const {
        return Vec3((*this)[id].value[0], (*this)[id].value[1], (*this)[id].value[2]);
    }
    const std::array<float, 12>& matrix(uint32_t index) const { return matrices_[index]; }
    bool depends_on(ExprId id, Op op) const;

    // What `id` comes to on average: textures at their means, whatever their coordinates; coats
    // clear; other things that vary over a surface at 0.
    Vec3 mean_value(ExprId id, std::span<const Image> images);

private:
    using Key = std::array<uint32_t, 8>;
    ExprId fold(const Expr& expr);

    std::vector<Expr> exprs_;
    std::map<Key, ExprId> known_;
    std::vector<std::array<float, 12>> matrices_;
    std::map<std::array<float, 12>, uint32_t> known_matrices_;
};

// Reads a point and not only its inputs.
bool reads_point(Op op);

}  // namespace spc
