// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/expression.h"

#include <bit>

#include "core/error.h"
#include "shading/arithmetic.h"

namespace spc {

ExprId ExprBuilder::constant(float value) {
    return insert({.op = Op::constant, .lanes = 1, .in = {}, .value = {value}});
}
ExprId ExprBuilder::constant(const Vec3& value) {
    return insert({.op = Op::constant, .lanes = 3, .in = {}, .value = {value.x, value.y, value.z}});
}

bool ExprBuilder::is_constant(ExprId id, float value) const {
    const Expr& e = (*this)[id];
    return e.op == Op::constant && e.value[0] == value &&
           (e.lanes == 1 || (e.value[1] == value && e.value[2] == value));
}

ExprId ExprBuilder::add(ExprId a, ExprId b) {
    if (is_constant(a, 0.0f)) return b;
    if (is_constant(b, 0.0f)) return a;
    return make(Op::add, {a, b});
}

ExprId ExprBuilder::multiply(ExprId a, ExprId b) {
    if (is_constant(a, 0.0f) || is_constant(b, 1.0f)) return a;
    if (is_constant(b, 0.0f) || is_constant(a, 1.0f)) return b;
    return make(Op::multiply, {a, b});
}

ExprId ExprBuilder::scale(ExprId vector, ExprId scalar) {
    if (is_constant(scalar, 1.0f) || is_constant(vector, 0.0f)) return vector;
    if (is_constant(scalar, 0.0f)) return constant(Vec3(0.0f));
    return make(Op::scale, {vector, scalar});
}

uint32_t ExprBuilder::block(const std::vector<float>& values) {
    const auto [known, added] =
        known_blocks_.try_emplace(values, static_cast<uint32_t>(blocks_.size()));
    if (added) blocks_.push_back(values);
    return known->second;
}

ExprId ExprBuilder::make(Op op, std::vector<ExprId> in, uint8_t mode, uint32_t index) {
    const OpTraits& row = traits(op);
    SPC_ASSERT(in.size() == row.arity);
    bool foldable = !row.varies;
    for (ExprId id : in) foldable = foldable && (id == kNoExpr || is_constant(id));
    const uint8_t own_lanes = row.lanes != 0 ? row.lanes : lanes(in[0]);
    const Expr e{op, own_lanes, mode, index, std::move(in), {}};
    return foldable ? fold(e) : insert(e);
}

ExprId ExprBuilder::insert(Expr e) {
    std::vector<uint32_t> key{
        static_cast<uint32_t>(e.op) | uint32_t{e.lanes} << 8 | uint32_t{e.mode} << 16, e.index};
    for (ExprId id : e.in) key.push_back(static_cast<uint32_t>(id));
    for (float value : e.value) key.push_back(std::bit_cast<uint32_t>(value));
    const auto [known, added] =
        known_.try_emplace(std::move(key), static_cast<ExprId>(exprs_.size()));
    if (added) exprs_.push_back(std::move(e));
    return known->second;
}

// As a program of one instruction.
ExprId ExprBuilder::fold(const Expr& e) {
    std::vector<float> constants;
    std::vector<Operand> operands;
    for (ExprId id : e.in) {
        operands.push_back(
            id == kNoExpr ? kNoOperand : static_cast<Operand>(~static_cast<int>(constants.size())));
        if (id == kNoExpr) continue;
        const std::array<float, 4>& value = (*this)[id].value;
        constants.insert(constants.end(), value.begin(), value.end());
    }
    const bool in_block = traits(e.op).index == IndexOf::block;
    const float* block = in_block ? blocks_[e.index].data() : nullptr;
    const Instruction i{e.op, e.lanes, e.mode, 0, 0, in_block ? 0 : e.index};
    Expr folded{.op = Op::constant, .lanes = e.lanes, .in = {}};
    run_arithmetic(i,
                   Registers<float>{folded.value.data(), constants.data(), operands.data(), block});
    return insert(std::move(folded));
}

// What is marked in ascending order of ids comes after what it reads.
int ExprBuilder::derivatives(ExprId id) const {
    std::vector<int> least(static_cast<size_t>(id) + 1);
    for (size_t i = 0; i < least.size(); ++i) {
        least[i] = traits(exprs_[i].op).derivatives;
        for (ExprId in : exprs_[i].in)
            if (in != kNoExpr) least[i] = std::min(least[i], least[static_cast<size_t>(in)]);
    }
    return least.back();
}

uint32_t ExprBuilder::reads(ExprId id) const {
    std::vector<uint32_t> bits(static_cast<size_t>(id) + 1);
    for (size_t i = 0; i < bits.size(); ++i) {
        const Expr& e = exprs_[i];
        bits[i] = traits(e.op).reads;
        for (ExprId in : e.in)
            if (in != kNoExpr) bits[i] |= bits[static_cast<size_t>(in)];
        if (traits(e.op).index == IndexOf::height) bits[i] |= bits[e.index];
    }
    return bits.back();
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
        Expr mean{.op = Op::constant, .lanes = e.lanes, .in = {}};
        switch (traits(e.op).mean) {
            case MeanOf::operands:
                for (ExprId& in : e.in)
                    if (in != kNoExpr) in = at_mean[static_cast<size_t>(in)];
                at_mean[i] = e.op == Op::constant ? static_cast<ExprId>(i)
                                                  : make(e.op, std::move(e.in), e.mode, e.index);
                continue;
            case MeanOf::image: {
                const Rgba<float> c = spc::mean(images[e.index], mode_straight(e.mode));
                mean.value = {c.r, c.g, c.b, c.a};
                break;
            }
            case MeanOf::zero: break;
            case MeanOf::half: mean.value = {0.5f, 0.5f, 0.5f, 0.5f}; break;
            case MeanOf::one: mean.value = {1.0f, 1.0f, 1.0f, 1.0f}; break;
        }
        at_mean[i] = insert(std::move(mean));
    }
    const ExprId result = at_mean[static_cast<size_t>(id)];
    SPC_ASSERT(is_constant(result));
    return lanes(result) == 1 ? Vec3(scalar(result)) : vector(result);
}

}  // namespace spc
