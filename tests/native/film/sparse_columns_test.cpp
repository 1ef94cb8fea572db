// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/sparse_columns.h"

#include "support/numerics.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

constexpr size_t kPixels = 12, kColumns = 9;

// Rows of which the columns with a bit in `filled` hold a number for some pixels.
std::vector<float> rows_with(uint32_t filled, uint32_t seed) {
    test::Uniforms uniforms(seed);
    std::vector<float> rows(kPixels * kColumns);
    for (size_t i = 0; i < rows.size(); ++i) {
        const bool has = (filled >> (i % kColumns) & 1u) != 0;
        if (has && (uniforms() < 0.4f || i < kColumns)) rows[i] = uniforms() - 0.5f;
    }
    return rows;
}

TEST(SparseColumns, GiveBackWhatWasStored) {
    SparseColumns<float> columns;
    EXPECT_EQ(columns.load(kPixels, kColumns), std::vector<float>(kPixels * kColumns));
    for (uint32_t filled = 0; filled < 1u << kColumns; ++filled) {
        const std::vector<float> rows = rows_with(filled, filled);
        columns.store(rows, kColumns);
        ASSERT_EQ(columns.load(kPixels, kColumns), rows) << filled;
        for (size_t i = 0; i < rows.size(); ++i)
            ASSERT_EQ(columns.at(i / kColumns, i % kColumns), rows[i]) << filled;
    }
}

TEST(SparseColumns, KeepNoColumnOfZeros) {
    SparseColumns<float> columns;
    columns.store(rows_with(0b100101001, 7), kColumns);
    for (size_t c = 0; c < kColumns; ++c)
        EXPECT_EQ(columns.column(c).size(), (0b100101001 >> c & 1) != 0 ? kPixels : 0) << c;
}

TEST(SparseColumns, MayHaveNoColumns) {
    SparseColumns<double> columns;
    columns.store({}, 0);
    EXPECT_TRUE(columns.load(kPixels, 0).empty());
}

}  // namespace
}  // namespace spc
