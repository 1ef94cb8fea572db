// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/expression.h"

#include <bit>

#include "core/error.h"
#include "shading/arithmetic.h"

namespace spc {

bool reads_point(Op op) { return op >= Op::uv; }

ExprId ExprBuilder::constant(float value) {
    return make({Op::constant, 1, 0, 0, {kNoExpr, kNoExpr, kNoExpr}, {value, 0.0f, 0.0f}});
}
ExprId ExprBuilder::constant(const Vec3& value) {
    return make({Op::constant, 3, 0, 0, {kNoExpr, kNoExpr, kNoExpr}, {value.x, value.y, value.z}});
}

bool ExprBuilder::is_constant(ExprId id, float value) const {
    const Expr& e = (*this)[id];
    return e.op == Op::constant && e.value[0] == value &&
           (e.lanes == 1 || (e.value[1] == value && e.value[2] == value));
}

ExprId ExprBuilder::add(ExprId a, ExprId b) {
    if (is_constant(a, 0.0f)) return b;
    if (is_constant(b, 0.0f)) return a;
    return make({Op::add, lanes(a), 0, 0, {a, b, kNoExpr}, {}});
}

ExprId ExprBuilder::multiply(ExprId a, ExprId b) {
    if (is_constant(a, 0.0f) || is_constant(b, 1.0f)) return a;
    if (is_constant(b, 0.0f) || is_constant(a, 1.0f)) return b;
    return make({Op::multiply, lanes(a), 0, 0, {a, b, kNoExpr}, {}});
}

ExprId ExprBuilder::scale(ExprId vector, ExprId scalar) {
    if (is_constant(scalar, 1.0f) || is_constant(vector, 0.0f)) return vector;
    if (is_constant(scalar, 0.0f)) return constant(Vec3(0.0f));
    return make({Op::scale, 3, 0, 0, {vector, scalar, kNoExpr}, {}});
}

ExprId ExprBuilder::affine(ExprId vector, const std::array<float, 12>& rows) {
    const auto [known, added] =
        known_matrices_.try_emplace(rows, static_cast<uint32_t>(matrices_.size()));
    if (added) matrices_.push_back(rows);
    return make({Op::affine, 3, 0, known->second, {vector, kNoExpr, kNoExpr}, {}});
}

ExprId ExprBuilder::make(const Expr& e) {
    bool foldable = e.op != Op::constant && !reads_point(e.op);
    for (ExprId in : e.in) foldable = foldable && (in == kNoExpr || is_constant(in));
    if (foldable) return fold(e);

    const Key key{static_cast<uint32_t>(e.op) | uint32_t{e.lanes} << 8 | uint32_t{e.mode} << 16,
                  e.index,
                  static_cast<uint32_t>(e.in[0]),
                  static_cast<uint32_t>(e.in[1]),
                  static_cast<uint32_t>(e.in[2]),
                  std::bit_cast<uint32_t>(e.value[0]),
                  std::bit_cast<uint32_t>(e.value[1]),
                  std::bit_cast<uint32_t>(e.value[2])};
    const auto [known, added] = known_.try_emplace(key, static_cast<ExprId>(exprs_.size()));
    if (added) exprs_.push_back(e);
    return known->second;
}

ExprId ExprBuilder::fold(const Expr& e) {
    std::vector<float> constants;
    Instruction i{e.op, e.lanes, e.mode, 0, {kNoOperand, kNoOperand, kNoOperand}, e.index};
    for (size_t k = 0; k < 3; ++k) {
        if (e.in[k] == kNoExpr) continue;
        i.in[k] = static_cast<Operand>(~static_cast<int>(constants.size()));
        const std::array<float, 3>& value = (*this)[e.in[k]].value;
        constants.insert(constants.end(), value.begin(), value.end());
    }
    if (e.op == Op::affine) {
        i.index = static_cast<uint32_t>(constants.size());
        const std::array<float, 12>& rows = matrices_[e.index];
        constants.insert(constants.end(), rows.begin(), rows.end());
    }
    float out[3] = {};
    run_arithmetic(i, Registers<float>{out, constants.data()});
    return e.lanes == 1 ? constant(out[0]) : constant(Vec3(out[0], out[1], out[2]));
}

// What is marked in ascending order of ids comes after what it reads.
bool ExprBuilder::depends_on(ExprId id, Op op) const {
    std::vector<bool> found(static_cast<size_t>(id) + 1);
    for (size_t i = 0; i < found.size(); ++i) {
        found[i] = exprs_[i].op == op;
        for (ExprId in : exprs_[i].in)
            if (in != kNoExpr && found[static_cast<size_t>(in)]) found[i] = true;
    }
    return found.back();
}

Vec3 ExprBuilder::mean_value(ExprId id, std::span<const Image> images) {
    // Inputs come before what they feed, so descending ids find what is needed and ascending ids
    // evaluate it.
    std::vector<bool> needed(static_cast<size_t>(id) + 1);
    needed.back() = true;
    for (size_t i = needed.size(); i-- > 0;)
        for (ExprId in : exprs_[i].in)
            if (needed[i] && in != kNoExpr) needed[static_cast<size_t>(in)] = true;
    std::vector<ExprId> at_mean(needed.size(), kNoExpr);
    for (size_t i = 0; i < needed.size(); ++i) {
        if (!needed[i]) continue;
        Expr e = exprs_[i];
        if (e.op == Op::image) {
            const Rgba<float> c = spc::mean(images[e.index], mode_straight(e.mode));
            at_mean[i] = constant(Vec3(c.r, c.g, c.b));
        } else if (e.op == Op::image_alpha) {
            at_mean[i] = constant(spc::mean(images[(*this)[e.in[0]].index]).a);
        } else if (e.op == Op::coat) {
            at_mean[i] = constant(Vec3(1.0f));
        } else if (reads_point(e.op)) {
            at_mean[i] = e.lanes == 1 ? constant(0.0f) : constant(Vec3(0.0f));
        } else {
            for (ExprId& in : e.in)
                if (in != kNoExpr) in = at_mean[static_cast<size_t>(in)];
            at_mean[i] = make(e);
        }
    }
    const ExprId result = at_mean[static_cast<size_t>(id)];
    SPC_ASSERT(is_constant(result));
    return lanes(result) == 1 ? Vec3(scalar(result)) : vector(result);
}

}  // namespace spc
