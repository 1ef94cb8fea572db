// SPDX-License-Identifier: GPL-3.0-or-later
// Every operation of the table that folds: its derivatives, and those of its derivatives, are what
// differences say; a graph that varies gives what the folded one does.
#include "shading/arithmetic.h"
#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

constexpr int kLanes = 4, kMostOperands = 8;
constexpr size_t kValues = size_t{kMostOperands} * kLanes;
using Values = std::array<float, kValues>;

// One operation on operands of registers, with a block that serves as a ramp and as a matrix.
template <class T>
std::array<T, kLanes> run_op(const OpTraits& row, uint8_t lanes, const std::array<T, kValues>& in) {
    static const std::vector<float> block{5,    0.1f, 0.3f, 0.2f, 0.9f, 0.4f, 0.8f,
                                          0.1f, 0.7f, 0.9f, 0.2f, 0.6f, 0.5f, 0.7f,
                                          0.4f, 0.3f, 0.2f, 0.2f, 0.6f, 0.8f, 0.6f};
    std::array<T, kValues + kLanes> registers{};
    std::copy(in.begin(), in.end(), registers.begin());
    const std::array<Operand, kMostOperands> operands{0, 4, 8, 12, 16, 20, 24, 28};
    const uint8_t mode = row.interpolates ? static_cast<uint8_t>(Interpolation::cubic) : uint8_t{0};
    const Instruction i{row.op, lanes, mode, static_cast<Operand>(kValues), 0, 0};
    run_arithmetic(i, Registers<T>{registers.data(), nullptr, operands.data(), block.data()});
    std::array<T, kLanes> out;
    std::copy(registers.begin() + kValues, registers.end(), out.begin());
    return out;
}

template <class T>
std::array<T, kValues> along(const Values& at, const Values& direction, const T& t) {
    std::array<T, kValues> in;
    for (size_t k = 0; k < in.size(); ++k) in[k] = T(at[k]) + T(direction[k]) * t;
    return in;
}

// Along random lines through random operands, away from where a value, a slope or a curvature
// jumps.
void compare_derivatives(const OpTraits& row, uint8_t lanes) {
    constexpr float kStep = 4e-3f, kTolerance = 2e-2f, kJump = 0.05f, kBend = 0.1f;
    Uniforms uniforms(40 + static_cast<uint64_t>(row.op));
    int compared = 0;
    for (int trial = 0; trial < 200; ++trial) {
        Values at, direction;
        for (float& value : at) value = 0.15f + 0.7f * uniforms();
        for (float& value : direction) value = uniforms() - 0.5f;
        const auto value = [&](float t) {
            return run_op<float>(row, lanes, along(at, direction, t));
        };
        const auto slope = [&](float t) {
            return run_op<Dual2>(row, lanes, along(at, direction, Dual2(t, 1.0f, 0.0f)));
        };
        const auto both = [&](float t) {
            const Dual<Dual2> twice({t, 1.0f, 0.0f}, Dual2(1.0f), Dual2(0.0f));
            return run_op<Dual<Dual2>>(row, lanes, along(at, direction, twice));
        };
        const auto exact = both(0.0f), exact_before = both(-kStep), exact_after = both(kStep);
        const auto before = value(-kStep), here = value(0.0f), after = value(kStep);
        const auto slope_before = slope(-kStep), slope_here = slope(0.0f),
                   slope_after = slope(kStep);
        for (size_t lane = 0; lane < lanes; ++lane) {
            const float jump = std::abs(after[lane] + before[lane] - 2 * here[lane]) / kStep +
                               std::abs(slope_after[lane].du - slope_before[lane].du);
            const float bend = std::abs(exact_after[lane].du.du - exact_before[lane].du.du);
            if (jump > kJump || bend > kBend) continue;
            EXPECT_NEAR(slope_here[lane].v, here[lane], 1e-5f);
            EXPECT_NEAR(slope_here[lane].du, (after[lane] - before[lane]) / (2 * kStep), kTolerance);
            EXPECT_NEAR(exact[lane].v.du, slope_here[lane].du,
                        1e-5f * (1 + std::abs(slope_here[lane].du)));
            EXPECT_NEAR(exact[lane].du.du,
                        (slope_after[lane].du - slope_before[lane].du) / (2 * kStep),
                        kTolerance * (1 + std::abs(exact[lane].du.du)));
            ++compared;
        }
    }
    EXPECT_GT(compared, 30) << "operation " << static_cast<int>(row.op);
}

TEST(Operations, HaveTheDerivativesThatDifferencesShow) {
    for (const OpTraits& row : kOpTraits) {
        if (row.op == Op::white_noise) continue;  // jumps everywhere
        if (row.varies || row.derivatives < 2 || row.arity == 0 || row.op == Op::image) continue;
        SCOPED_TRACE("operation " + std::to_string(static_cast<int>(row.op)));
        if (row.lanes != 3) compare_derivatives(row, 1);
        if (row.lanes != 1) compare_derivatives(row, 3);
    }
}

}  // namespace
}  // namespace spc::test
