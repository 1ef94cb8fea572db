// SPDX-License-Identifier: GPL-3.0-or-later
// Pearson's goodness-of-fit test of a sampler against the density that it claims, on a grid over a
// domain. Samples that the sampler declines (empty optional) form one more cell, whose expected
// share is 1 - integral of the density: so the test also checks the normalisation and the rate of
// success.
#pragma once

#include "support/numerics.h"

#include <gtest/gtest.h>

#include <numeric>
#include <sstream>
#include <vector>

namespace spc::test {

struct ChiSquare {
    double statistic = 0, p_value = 1;
    int degrees_of_freedom = 0;
    double integral = 0;          // of the density
    double impossible_share = 0;  // samples where the density says there are none
    int64_t samples = 0;

    bool passes(double significance) const {
        return impossible_share < 1e-4 && p_value >= significance;
    }
    std::string text() const {
        std::ostringstream s;
        s << "chi-square " << statistic << " with " << degrees_of_freedom
          << " degrees of freedom, p-value " << p_value << ", integral of the density " << integral
          << ", share of samples at zero density " << impossible_share;
        return s.str();
    }
};

// Compares counts of samples with their expectations. Cells that expect fewer than 5 are pooled.
inline ChiSquare chi_square(const std::vector<int64_t>& observed,
                            const std::vector<double>& expected) {
    constexpr double kLeastExpected = 5;
    std::vector<size_t> order(observed.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return expected[a] < expected[b]; });
    ChiSquare result;
    double pooled_expected = 0, pooled_observed = 0;
    int cells = 0;
    const auto add = [&](double o, double e) {
        result.statistic += (o - e) * (o - e) / e;
        ++cells;
    };
    result.samples = std::accumulate(observed.begin(), observed.end(), int64_t{0});
    for (const size_t i : order) {
        const double e = std::max(expected[i], 0.0), o = static_cast<double>(observed[i]);
        // Quadrature leaves 1e-9 here and there; half a sample in a cell of no probability is a bug
        // all the same.
        if (e < 1e-4 && o > 0) result.impossible_share += o / static_cast<double>(result.samples);
        if (pooled_expected < kLeastExpected) {
            pooled_expected += e;
            pooled_observed += o;
            if (pooled_expected >= kLeastExpected) add(pooled_observed, pooled_expected);
        } else {
            add(o, e);
        }
    }
    result.degrees_of_freedom = cells - 1;
    if (cells > 1)
        result.p_value = gamma_q(0.5 * result.degrees_of_freedom, 0.5 * result.statistic);
    return result;
}

// Cells over the sphere in polar angles about frame.z. Their polar boundaries lie at pi (i /
// rings)^focus: with focus > 1 they crowd around frame.z, which goes on the peak of a narrow
// density.
struct SphereGrid {
    Frame frame;
    int rings = 12, sectors = 16;
    double focus = 1;
};

// `sample()` returns std::optional<Vec3>, unit; `pdf(Vec3)` its density per solid angle.
template <class Sample, class Pdf>
ChiSquare chi_square_sphere(const SphereGrid& grid, int64_t samples, const Sample& sample,
                            const Pdf& pdf) {
    const double pi = std::numbers::pi;
    const size_t cells = static_cast<size_t>(grid.rings) * grid.sectors;
    std::vector<int64_t> observed(cells + 1);
    for (int64_t i = 0; i < samples; ++i) {
        const std::optional<Vec3> w = sample();
        if (!w) {
            ++observed[cells];
            continue;
        }
        const Vec3 local = grid.frame.to_local(*w);
        const double theta = std::atan2(std::hypot(local.x, local.y), local.z);
        const double phi = std::atan2(local.y, local.x) / (2 * pi) + 0.5;
        const int ring = std::min(
            static_cast<int>(std::pow(theta / pi, 1 / grid.focus) * grid.rings), grid.rings - 1);
        const int sector = std::min(static_cast<int>(phi * grid.sectors), grid.sectors - 1);
        ++observed[static_cast<size_t>(ring) * grid.sectors + sector];
    }
    const double n = static_cast<double>(samples);
    std::vector<double> expected(cells + 1);
    double integral = 0;
    const auto integrand = [&](double theta, double phi) {
        return static_cast<double>(pdf(to_float(direction(grid.frame, theta, phi)))) *
               std::sin(theta);
    };
    for (int i = 0; i < grid.rings; ++i)
        for (int j = 0; j < grid.sectors; ++j) {
            const double theta0 = pi * std::pow(i / double(grid.rings), grid.focus);
            const double theta1 = pi * std::pow((i + 1) / double(grid.rings), grid.focus);
            const double cell =
                integrate_2d(integrand, theta0, theta1, 2 * pi * j / grid.sectors - pi,
                             2 * pi * (j + 1) / grid.sectors - pi, 1e-7, 6);
            expected[static_cast<size_t>(i) * grid.sectors + j] = n * cell;
            integral += cell;
        }
    expected[cells] = n * std::max(1 - integral, 0.0);
    ChiSquare result = chi_square(observed, expected);
    result.integral = integral;
    return result;
}

}  // namespace spc::test
