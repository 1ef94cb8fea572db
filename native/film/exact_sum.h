// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of samples that do not depend on how they are grouped: a double and what it has rounded away
// [Knuth97, Sec. 4.2.2]. Together they have 77 bits, or 106 if both are doubles, so that
// single-precision terms add up exactly unless they differ by more than some 2^40.
#pragma once

namespace spc {

// Adds `term` to the sum `high + low`.
template <class Low>
void add_exactly(double& high, Low& low, double term) {
    const double sum = high + term;
    const double taken = sum - high;
    const double error = (high - (sum - taken)) + (term - taken);
    const double rest = static_cast<double>(low) + error;
    high = sum + rest;
    low = static_cast<Low>(rest - (high - sum));
}

}  // namespace spc
