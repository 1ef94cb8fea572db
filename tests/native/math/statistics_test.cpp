// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics that other tests rest on.
#include "support/numerics.h"

namespace spc::test {
namespace {

TEST(StudentsT, HasTheProbabilitiesOfItsTables) {
    struct Row {
        size_t degrees;
        double t, p;
    };
    for (const Row& row :
         {Row{1, 12.7062, 0.05}, Row{2, 4.30265, 0.05}, Row{3, 5.84091, 0.01},
          Row{4, 8.6103, 0.001}, Row{11, 2.20099, 0.05}, Row{11, 4.4370, 0.001},
          Row{30, 3.6460, 0.001}, Row{999, 1.95996, 0.05028}, Row{1000, 1.95996, 0.05}}) {
        EXPECT_NEAR(students_p(row.t, row.degrees) / row.p, 1.0, 1e-3) << row.degrees;
        EXPECT_DOUBLE_EQ(students_p(-row.t, row.degrees), students_p(row.t, row.degrees));
    }
    EXPECT_DOUBLE_EQ(students_p(0.0, 11), 1.0);
}

}  // namespace
}  // namespace spc::test
