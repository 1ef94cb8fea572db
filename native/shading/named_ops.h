// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes whose option chooses an operation: Blender's names for them, one row each. An operation
// that such a node is to have is a row here, one in operation.h and a case in run_arithmetic().
#pragma once

#include <string_view>

#include "shading/operation.h"

namespace spc {

struct NamedOp {
    std::string_view name;
    Op op;
    bool scaled = false;  // of Vector Math: its last operand is Scale
};

inline constexpr NamedOp kMathOps[] = {
    {"ADD", Op::add},
    {"SUBTRACT", Op::subtract},
    {"MULTIPLY", Op::multiply},
    {"DIVIDE", Op::divide},
    {"MULTIPLY_ADD", Op::multiply_add},
    {"POWER", Op::power},
    {"LOGARITHM", Op::logarithm},
    {"SQRT", Op::square_root},
    {"INVERSE_SQRT", Op::inverse_root},
    {"ABSOLUTE", Op::absolute},
    {"EXPONENT", Op::exponent},
    {"MINIMUM", Op::minimum},
    {"MAXIMUM", Op::maximum},
    {"LESS_THAN", Op::less},
    {"GREATER_THAN", Op::greater},
    {"SIGN", Op::sign},
    {"COMPARE", Op::compare},
    {"SMOOTH_MIN", Op::smooth_min},
    {"SMOOTH_MAX", Op::smooth_max},
    {"ROUND", Op::round},
    {"FLOOR", Op::floor},
    {"CEIL", Op::ceil},
    {"TRUNC", Op::truncate},
    {"FRACT", Op::fraction},
    {"MODULO", Op::modulo},
    {"FLOORED_MODULO", Op::floored_modulo},
    {"WRAP", Op::wrap},
    {"SNAP", Op::snap},
    {"PINGPONG", Op::ping_pong},
    {"SINE", Op::sine},
    {"COSINE", Op::cosine},
    {"TANGENT", Op::tangent},
    {"ARCSINE", Op::arcsine},
    {"ARCCOSINE", Op::arccosine},
    {"ARCTANGENT", Op::arctangent},
    {"ARCTAN2", Op::arctan2},
    {"SINH", Op::sinh},
    {"COSH", Op::cosh},
    {"TANH", Op::tanh},
    {"RADIANS", Op::radians},
    {"DEGREES", Op::degrees},
};

inline constexpr NamedOp kVectorMathOps[] = {
    {"ADD", Op::add},
    {"SUBTRACT", Op::subtract},
    {"MULTIPLY", Op::multiply},
    {"DIVIDE", Op::divide},
    {"MULTIPLY_ADD", Op::multiply_add},
    {"CROSS_PRODUCT", Op::cross},
    {"PROJECT", Op::project},
    {"REFLECT", Op::reflect},
    {"REFRACT", Op::refract, true},
    {"FACEFORWARD", Op::face_forward},
    {"DOT_PRODUCT", Op::dot},
    {"DISTANCE", Op::distance},
    {"LENGTH", Op::length},
    {"SCALE", Op::scale, true},
    {"NORMALIZE", Op::normalize},
    {"ABSOLUTE", Op::absolute},
    {"POWER", Op::power},
    {"SIGN", Op::sign},
    {"MINIMUM", Op::minimum},
    {"MAXIMUM", Op::maximum},
    {"FLOOR", Op::floor},
    {"CEIL", Op::ceil},
    {"FRACTION", Op::fraction},
    {"MODULO", Op::modulo},
    {"WRAP", Op::wrap},
    {"SNAP", Op::snap},
    {"SINE", Op::sine},
    {"COSINE", Op::cosine},
    {"TANGENT", Op::tangent},
};

// Their names as the values of an option, "ADD|SUBTRACT|...".
template <const auto& kOps>
inline constexpr auto kJoinedNames = [] {
    constexpr size_t kSize = [] {
        size_t size = 0;
        for (const NamedOp& op : kOps) size += op.name.size() + 1;
        return size;
    }();
    std::array<char, kSize> text{};
    size_t at = 0;
    for (const NamedOp& op : kOps) {
        if (at > 0) text[at++] = '|';
        for (const char letter : op.name) text[at++] = letter;
    }
    return text;  // the last one is its end
}();

}  // namespace spc
