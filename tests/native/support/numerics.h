// SPDX-License-Identifier: GPL-3.0-or-later
// Numerical tools of the tests, in double and independent of the code under test.
#pragma once

#include "math/vec.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

namespace spc::test {

// |a - b| <= relative * max(|a|, |b|); for numbers whose scale is not known beforehand.
inline ::testing::AssertionResult near_relative(const char* a_text, const char* b_text, const char*,
                                                double a, double b, double relative) {
    if (std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)))
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << a_text << " = " << a << " and " << b_text << " = " << b << " differ by "
           << (a - b) / std::max(std::abs(a), std::abs(b)) << " (relative), allowed " << relative;
}
// The angle between two directions, radians; exact for small angles too.
template <class T>
double angle_between(const Imath::Vec3<T>& a, const Imath::Vec3<T>& b) {
    const Vec3d u(a.x, a.y, a.z), v(b.x, b.y, b.z);
    return std::atan2(length(cross(u, v)), dot(u, v));
}
template <class T>
::testing::AssertionResult near_angle(const char* a_text, const char* b_text, const char*,
                                      const Imath::Vec3<T>& a, const Imath::Vec3<T>& b,
                                      double radians) {
    const double angle = angle_between(a, b);
    if (angle <= radians) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << a_text << " = " << a << " and " << b_text << " = " << b
                                         << " are " << angle << " rad apart, allowed " << radians;
}

// Uniform numbers in [0, 1) with a fixed seed.
class Uniforms {
public:
    explicit Uniforms(uint64_t seed) : engine_(seed) {}
    float operator()() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
    Vec2 two() {
        const float x = (*this)();
        return {x, (*this)()};
    }
    Vec3 three() {
        const Vec2 xy = two();
        return {xy.x, xy.y, (*this)()};
    }

private:
    std::mt19937_64 engine_;
};

// Running mean and its standard error.
class MeanEstimate {
public:
    MeanEstimate() = default;
    // As another one of `count` numbers was.
    MeanEstimate(size_t count, double mean, double standard_error)
        : count_(static_cast<int64_t>(count)), mean_(mean) {
        const double n = static_cast<double>(count);
        sum_squares_ = standard_error * standard_error * n * (n - 1);
    }
    void add(double x) {
        ++count_;
        const double delta = x - mean_;
        mean_ += delta / static_cast<double>(count_);
        sum_squares_ += delta * (x - mean_);
    }
    size_t count() const { return static_cast<size_t>(count_); }
    double mean() const { return mean_; }
    double standard_error() const {
        const double n = static_cast<double>(count_);
        return std::sqrt(sum_squares_ / (n * (n - 1)));
    }

private:
    int64_t count_ = 0;
    double mean_ = 0, sum_squares_ = 0;
};

namespace detail {
// Gauss-Legendre, 6 points on [-1, 1].
inline constexpr std::array<double, 6> kGaussNode = {-0.932469514203152028, -0.661209386466264514,
                                                     -0.238619186083196909, 0.238619186083196909,
                                                     0.661209386466264514,  0.932469514203152028};
inline constexpr std::array<double, 6> kGaussWeight = {0.171324492379170345, 0.360761573048138608,
                                                       0.467913934572691047, 0.467913934572691047,
                                                       0.360761573048138608, 0.171324492379170345};

template <class F>
double gauss(const F& f, double x0, double x1) {
    double sum = 0;
    for (size_t i = 0; i < kGaussNode.size(); ++i)
        sum += kGaussWeight[i] * f(0.5 * (x0 + x1) + 0.5 * (x1 - x0) * kGaussNode[i]);
    return 0.5 * (x1 - x0) * sum;
}
template <class F>
double gauss_2d(const F& f, double x0, double x1, double y0, double y1) {
    return gauss([&](double x) { return gauss([&](double y) { return f(x, y); }, y0, y1); }, x0, x1);
}
template <class F>
double refine(const F& f, double x0, double x1, double whole, double tolerance, int depth) {
    const double xm = 0.5 * (x0 + x1);
    const double left = gauss(f, x0, xm), right = gauss(f, xm, x1);
    if (depth <= 0 || std::abs(left + right - whole) <= tolerance) return left + right;
    return refine(f, x0, xm, left, 0.5 * tolerance, depth - 1) +
           refine(f, xm, x1, right, 0.5 * tolerance, depth - 1);
}
template <class F>
double refine_2d(const F& f, double x0, double x1, double y0, double y1, double whole,
                 double tolerance, int depth) {
    const double xm = 0.5 * (x0 + x1), ym = 0.5 * (y0 + y1);
    const std::array<double, 4> part = {gauss_2d(f, x0, xm, y0, ym), gauss_2d(f, xm, x1, y0, ym),
                                        gauss_2d(f, x0, xm, ym, y1), gauss_2d(f, xm, x1, ym, y1)};
    const double sum = part[0] + part[1] + part[2] + part[3];
    if (depth <= 0 || std::abs(sum - whole) <= tolerance) return sum;
    const double t = 0.25 * tolerance;
    return refine_2d(f, x0, xm, y0, ym, part[0], t, depth - 1) +
           refine_2d(f, xm, x1, y0, ym, part[1], t, depth - 1) +
           refine_2d(f, x0, xm, ym, y1, part[2], t, depth - 1) +
           refine_2d(f, xm, x1, ym, y1, part[3], t, depth - 1);
}
}  // namespace detail

// Adaptive quadrature to an absolute tolerance.
template <class F>
double integrate(const F& f, double x0, double x1, double tolerance, int max_depth = 24) {
    return detail::refine(f, x0, x1, detail::gauss(f, x0, x1), tolerance, max_depth);
}
template <class F>
double integrate_2d(const F& f, double x0, double x1, double y0, double y1, double tolerance,
                    int max_depth = 7) {
    return detail::refine_2d(f, x0, x1, y0, y1, detail::gauss_2d(f, x0, x1, y0, y1), tolerance,
                             max_depth);
}

// A direction from polar angles about a frame's z axis.
inline Vec3d direction(const Frame& frame, double theta, double phi) {
    const double s = std::sin(theta);
    const auto axis = [](const Vec3& v) { return Vec3d(v.x, v.y, v.z); };
    return axis(frame.x) * (s * std::cos(phi)) + axis(frame.y) * (s * std::sin(phi)) +
           axis(frame.z) * std::cos(theta);
}
inline Vec3 to_float(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Integral over solid angle of f(Vec3 direction); put the frame's z axis on the peak, if there is
// one. The polar angle is warped as x^3, so that narrow peaks there are resolved.
template <class F>
double integrate_sphere(const Frame& frame, const F& f, double tolerance, int max_depth = 7) {
    const double pi = std::numbers::pi;
    const auto integrand = [&](double x, double phi) {
        const double theta = pi * x * x * x;
        return static_cast<double>(f(to_float(direction(frame, theta, phi)))) * std::sin(theta) *
               3 * pi * x * x;
    };
    double sum = 0;
    constexpr int kCells = 4;
    for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j)
            sum += integrate_2d(integrand, i / double(kCells), (i + 1) / double(kCells),
                                2 * pi * j / kCells - pi, 2 * pi * (j + 1) / kCells - pi,
                                tolerance / (kCells * kCells), max_depth);
    return sum;
}

// Upper regularised incomplete gamma function Q(a, x): series below, continued fraction (Lentz)
// above the mean.
inline double gamma_q(double a, double x) {
    if (x <= 0) return 1;
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000 && term > sum * 1e-16; ++n) sum += term *= x / (a + n);
        return 1 - scale * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return scale * h;
}

// Significance of one test of `count` so that all of them together fail by chance with probability
// `family` [Sidak67].
inline double sidak(double family, int count) { return -std::expm1(std::log1p(-family) / count); }

// Whether two independent estimates have one mean, two-sided at the given significance.
inline ::testing::AssertionResult same_mean(const MeanEstimate& a, const MeanEstimate& b,
                                            double significance) {
    const double deviation = std::hypot(a.standard_error(), b.standard_error());
    const double difference = std::abs(a.mean() - b.mean());
    const double p = std::erfc(difference / deviation / std::numbers::sqrt2);
    if (p > significance) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << "means " << a.mean() << " and " << b.mean() << " differ by " << difference / deviation
           << " standard deviations, p = " << p;
}

// Probability that Student's t of so many degrees of freedom is beyond +-t, [Abramowitz64, 26.7.3
// and 26.7.4].
inline double students_p(double t, size_t degrees) {
    constexpr size_t kNormal = 1000;  // from here on it is one
    if (degrees >= kNormal) return std::erfc(std::abs(t) / std::numbers::sqrt2);
    const double theta = std::atan(std::abs(t) / std::sqrt(double(degrees)));
    const double cosine = std::cos(theta);
    const bool odd = degrees % 2 == 1;
    double term = odd ? cosine : 1, sum = 0;
    for (size_t n = odd ? 3 : 2; n <= degrees; n += 2) {
        sum += term;
        term *= cosine * cosine * double(n - 1) / double(n);
    }
    sum *= std::sin(theta);
    return 1 - (odd ? (theta + sum) * 2 / std::numbers::pi : sum);
}

// Whether a mean differs from what it should be by chance only: two-sided t-test.
inline ::testing::AssertionResult is_mean(const MeanEstimate& estimate, double expected,
                                          double significance, double numerical_error = 0) {
    const double excess = std::max(std::abs(estimate.mean() - expected) - numerical_error, 0.0);
    const double p =
        excess == 0 ? 1.0 : students_p(excess / estimate.standard_error(), estimate.count() - 1);
    if (p >= significance) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << "mean " << estimate.mean() << " +- " << estimate.standard_error() << ", expected "
           << expected << ", p-value " << p << " < " << significance;
}

}  // namespace spc::test

#define EXPECT_NEAR_REL(a, b, relative) \
    EXPECT_PRED_FORMAT3(::spc::test::near_relative, a, b, relative)
#define EXPECT_NEAR_ANGLE(a, b, radians) \
    EXPECT_PRED_FORMAT3(::spc::test::near_angle<float>, a, b, radians)
