// SPDX-License-Identifier: GPL-3.0-or-later
// Means that brute force finds. They take most of the time and stay the same, so
// tests/native/truths/ keeps them, a file for each test.
#pragma once

#include "support/numerics.h"

#include <functional>
#include <string>
#include <vector>

namespace spc::test {

// Whether truths are found to be kept, whatever was before.
bool writes_truths();

using Estimates = std::vector<MeanEstimate>;

// Of `samples` each, by brute force: as kept, after a share of the samples has agreed with it.
// Nightly runs take all of the samples anew and compare these; `./dev test native --write-truths`
// keeps them. `name` is the test's own for this truth.
Estimates truth(const std::string& name, uint32_t samples,
                const std::function<Estimates(uint32_t samples)>& by_brute_force);

}  // namespace spc::test
