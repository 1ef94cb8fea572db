// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/hair.h"

#include "bsdf/fresnel.h"
#include "math/warp.h"

namespace spc {
namespace {

constexpr float kQuarter = 0.5f * kPi;
constexpr int kLobes = 4;  // reflected, through, back after one reflection, the rest

// wo and wi as angles along the fibre, and that around it between them.
struct FibreFrame {
    Vec3 x, y, z;  // the tangent; towards wo across it; their cross product

    FibreFrame(const Vec3& tangent, const Vec3& wo) : x(tangent) {
        const Vec3 across = wo - x * dot(x, wo);
        y = length_squared(across) > 0.0f ? normalize(across) : Frame::around(x).x;
        z = cross(x, y);
    }
    float theta(const Vec3& w) const { return std::asin(std::clamp(dot(x, w), -1.0f, 1.0f)); }
    float phi(const Vec3& w) const { return std::atan2(dot(z, w), dot(y, w)); }
    Vec3 direction(float theta, float phi) const {
        const float c = std::cos(theta);
        return x * std::sin(theta) + y * (c * std::cos(phi)) + z * (c * std::sin(phi));
    }
};

float square_of(float x) { return x * x; }
float power(float x, int n) {
    return n == 0 ? 1.0f : square_of(power(x, n / 2)) * (n % 2 ? x : 1.0f);
}

// The modified Bessel function of order 0 times exp(-x), x >= 0 [Abramowitz64 9.8.1, 9.8.2].
float scaled_bessel(float x) {
    if (x < 3.75f) {
        const float t = square_of(x / 3.75f);
        const float i0 =
            1.0f +
            t * (3.5156229f +
                 t * (3.0899424f +
                      t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
        return i0 * std::exp(-x);
    }
    const float t = 3.75f / x;
    float sum = 0.00392377f;
    for (const float k : {-0.01647633f, 0.02635537f, -0.02057706f, 0.00916281f, -0.00157565f,
                          0.00225319f, 0.01328592f, 0.39894228f})
        sum = sum * t + k;
    return sum / std::sqrt(x);
}

// Density of the sine of theta_i of light that is mirrored at the fibre, -theta_o, blurred by a
// variance [dEon11]. Written without what overflows where that is small.
float along_fibre(float theta_i, float theta_o, float variance) {
    const float cosines = std::abs(std::cos(theta_i) * std::cos(theta_o));
    const float away = square_of(std::sin(0.5f * (theta_i + theta_o)));
    return scaled_bessel(cosines / variance) * std::exp(-2.0f * away / variance) /
           (variance * (1.0f - std::exp(-2.0f / variance)));
}

// Logistic within (-pi, pi).
float logistic_cdf(float x, float scale) { return 1.0f / (1.0f + std::exp(-x / scale)); }
float logistic(float x, float scale) {
    const float e = std::exp(-std::abs(x) / scale);
    return e / (scale * square_of(1.0f + e)) / (1.0f - 2.0f * logistic_cdf(-kPi, scale));
}
float sample_logistic(float u, float scale) {
    const float least = logistic_cdf(-kPi, scale);
    const float x = -scale * std::log(1.0f / (u * (1.0f - 2.0f * least) + least) - 1.0f);
    return std::clamp(x, -kPi, kPi);
}

// Within (-pi, pi].
float wrapped(float angle) { return angle - 2.0f * kPi * std::round(angle / (2.0f * kPi)); }

// What becomes of light on its ways through the fibre, seen from wo.
struct Ways {
    std::array<Spectrum, kLobes> share;
    std::array<float, kLobes> probability;
    std::array<float, kLobes - 1> turn;  // around the fibre; the rest goes anywhere
};
Ways ways_of(const HairFibre& c, const Vec3& wo) {
    const float sin_o = std::clamp(dot(c.tangent, wo), -1.0f, 1.0f);
    const float cos_o = safe_sqrt(1.0f - sin_o * sin_o);
    const float cos_t = safe_sqrt(1.0f - square_of(sin_o / c.eta));
    // Across the fibre it refracts as if its index were larger [Marschner03].
    const float sin_gamma_t = std::clamp(
        c.h * cos_o / std::max(safe_sqrt(c.eta * c.eta - sin_o * sin_o), 1e-6f), -1.0f, 1.0f);
    const float gamma = std::asin(c.h), gamma_t = std::asin(sin_gamma_t);
    const float f = facet::dielectric(cos_o * safe_sqrt(1.0f - c.h * c.h), c.eta);
    const float length = 2.0f * safe_sqrt(1.0f - sin_gamma_t * sin_gamma_t) / std::max(cos_t, 1e-6f);
    const Spectrum passed(std::exp(-c.absorption.x * length), std::exp(-c.absorption.y * length),
                          std::exp(-c.absorption.z * length));
    Ways ways;
    ways.share[0] = Spectrum(f);
    ways.share[1] = passed * square_of(1.0f - f);
    ways.share[2] = ways.share[1] * passed * f;
    const Spectrum again = passed * f;
    for (int k = 0; k < 3; ++k)
        ways.share[3][k] = again[k] < 1.0f ? ways.share[2][k] * again[k] / (1.0f - again[k]) : 0.0f;
    float sum = 0.0f;
    for (const Spectrum& share : ways.share) sum += luminance(share);
    for (size_t p = 0; p < kLobes; ++p)
        ways.probability[p] = sum > 0.0f ? luminance(ways.share[p]) / sum : 1.0f / kLobes;
    for (size_t p = 0; p + 1 < kLobes; ++p) {
        const auto order = static_cast<float>(p);
        ways.turn[p] = 2.0f * order * gamma_t - 2.0f * gamma + order * kPi;
    }
    return ways;
}

float variance_of(const HairFibre& c, size_t p) {
    return p == 0 ? c.first_variance : p == 1 ? 0.25f * c.variance : 4.0f * c.variance;
}
// By how much the scales shift the angle of a lobe.
float shift_of(const HairFibre& c, size_t p) {
    constexpr std::array<float, kLobes> kTilts{2.0f, -1.0f, -4.0f, 0.0f};
    return kTilts[p] * c.tilt;
}
// Back into (-pi/2, pi/2) over the end of the fibre.
float folded(float theta) {
    return theta > kQuarter ? kPi - theta : theta < -kQuarter ? -kPi - theta : theta;
}

// The same of a lobe that the scales shift: of the angles that this takes to theta_i, one directly
// and one over the end of the fibre. It keeps the lobe's light, where to evaluate the lobe itself
// at a shifted angle does not.
float tilted_along(float theta_i, float theta_o, float variance, float shift) {
    const float cos_i = std::max(std::cos(theta_i), 1e-6f);
    float sum = 0.0f;
    for (const float theta : {theta_i + shift, (shift > 0.0f ? -kPi : kPi) - theta_i + shift})
        if (std::abs(theta) <= kQuarter)
            sum += along_fibre(theta, theta_o, variance) * std::cos(theta) / cos_i;
    return sum;
}

}  // namespace

// Fits to what artists expect of a roughness [Chiang16 Eq. 7, Eq. 8].
HairFibre hair_fibre(const Vec3& tangent, float h, const Spectrum& absorption, float roughness,
                     float radial_roughness, float coat, float eta, float tilt) {
    const auto bounded = [](float x) { return std::clamp(x, 0.001f, 1.0f); };
    const auto variance = [](float x) {
        return square_of(0.726f * x + 0.812f * x * x + 3.7f * power(x, 20));
    };
    const float along = bounded(roughness), around = bounded(radial_roughness);
    const float scale = 0.265f * around + 1.194f * around * around + 5.372f * power(around, 22);
    return {
        tangent,
        std::clamp(h, -1.0f, 1.0f),
        {std::max(absorption.x, 0.0f), std::max(absorption.y, 0.0f), std::max(absorption.z, 0.0f)},
        eta,
        tilt,
        variance(along),
        variance(bounded((1.0f - clamp01(coat)) * along)),
        std::sqrt(kPi / 8.0f) * scale};
}

LobeEval eval_lobe(const HairFibre& c, const Vec3& wo, const Vec3& wi, bool) {
    const FibreFrame frame(c.tangent, wo);
    const Ways ways = ways_of(c, wo);
    const float theta_o = frame.theta(wo), theta_i = frame.theta(wi), phi = frame.phi(wi);
    LobeEval result;
    for (size_t p = 0; p < kLobes; ++p) {
        const float around =
            p < ways.turn.size() ? logistic(wrapped(phi - ways.turn[p]), c.scale) : 0.5f * kInvPi;
        const float density =
            around * tilted_along(theta_i, theta_o, variance_of(c, p), shift_of(c, p));
        result.f_cos += ways.share[p] * density;
        result.pdf_omega += ways.probability[p] * density;
    }
    return result;
}

std::optional<LobeSample> sample_lobe(const HairFibre& c, const Vec3& wo, float u_lobe,
                                      const Vec2& u) {
    const FibreFrame frame(c.tangent, wo);
    const Ways ways = ways_of(c, wo);
    size_t p = 0;
    while (p + 1 < kLobes && u_lobe >= ways.probability[p]) u_lobe -= ways.probability[p++];
    const float u_around = std::min(u_lobe / ways.probability[p], kBelowOne);
    // [dEon13 Eq. 6, Eq. 7]
    const float variance = variance_of(c, p), theta_o = frame.theta(wo);
    const float u_along = std::max(u.x, 1e-7f);
    const float mirrored =
        1.0f + variance * std::log(u_along + (1.0f - u_along) * std::exp(-2.0f / variance));
    const float sine = -mirrored * std::sin(theta_o) + safe_sqrt(1.0f - mirrored * mirrored) *
                                                           std::cos(2.0f * kPi * u.y) *
                                                           std::cos(theta_o);
    const float theta = folded(std::asin(std::clamp(sine, -1.0f, 1.0f)) - shift_of(c, p));
    const float phi = p < ways.turn.size() ? ways.turn[p] + sample_logistic(u_around, c.scale)
                                           : 2.0f * kPi * u_around;
    return LobeSample{frame.direction(theta, phi), BounceKind::glossy};
}

Spectrum albedo_of(const HairFibre& c, const Vec3& wo) {
    Spectrum sum(0.0f);
    for (const Spectrum& share : ways_of(c, wo).share) sum += share;
    return sum;
}

namespace {

// Angles along the fibre at which the Cauchy distribution ends, in units of its width, as arc
// tangents.
struct CauchyRange {
    float low, high;
};
CauchyRange range_of(const HairLobe& c, float theta_o) {
    return {std::atan((0.5f * (theta_o - kQuarter) - c.offset) / c.along),
            std::atan((0.5f * (theta_o + kQuarter) - c.offset) / c.along)};
}

}  // namespace

LobeEval eval_lobe(const HairLobe& c, const Vec3& wo, const Vec3& wi, bool) {
    constexpr float kLeastToTheEnd = 0.001f;  // rad; Cycles' bound
    if ((dot(c.n, wi) < 0.0f) != c.transmits) return {};
    const FibreFrame frame(c.tangent, wo);
    const float theta_o = frame.theta(wo), theta_i = frame.theta(wi);
    const float phi = std::abs(frame.phi(wi));
    if ((phi > kQuarter) != c.transmits || kQuarter - std::abs(theta_i) < kLeastToTheEnd) return {};
    const CauchyRange range = range_of(c, theta_o);
    const float t = 0.5f * (theta_i + theta_o) - c.offset;
    const float along = c.along / (2.0f * (t * t + c.along * c.along) * (range.high - range.low) *
                                   std::cos(theta_i));
    float around;
    if (c.transmits)
        around = c.around / (2.0f * std::atan(kQuarter / c.around) *
                             (square_of(kPi - phi) + c.around * c.around));
    else
        around = 0.25f / c.around * std::cos(0.5f * std::min(phi / c.around, kPi));
    return {Spectrum(along * around), along * around};
}

std::optional<LobeSample> sample_lobe(const HairLobe& c, const Vec3& wo, float, const Vec2& u) {
    const FibreFrame frame(c.tangent, wo);
    const float theta_o = frame.theta(wo);
    const CauchyRange range = range_of(c, theta_o);
    const float t = c.along * std::tan(lerp(range.low, range.high, u.x));
    const float theta = std::clamp(2.0f * (t + c.offset) - theta_o, -kQuarter, kQuarter);
    if (c.transmits) {
        const float end = std::atan(kQuarter / c.around);
        const float phi = kPi + c.around * std::tan(end * (2.0f * u.y - 1.0f));
        return LobeSample{frame.direction(theta, phi), BounceKind::transmission};
    }
    const float phi = 2.0f * c.around * std::asin(1.0f - 2.0f * u.y);
    if (std::abs(phi) > kQuarter) return std::nullopt;
    return LobeSample{frame.direction(theta, phi), BounceKind::glossy};
}

Spectrum albedo_of(const HairLobe&, const Vec3&) { return Spectrum(1.0f); }

float across_fibre(const Vec3& tangent, const Vec3& n, const Vec3& wo) {
    return std::clamp(-dot(n, FibreFrame(tangent, wo).z), -1.0f, 1.0f);
}

float across_tube(const Vec3& tangent, const Vec3& n, const Vec3& ng, const Vec3& wo) {
    const FibreFrame frame(tangent, wo);
    const Vec3 side = ng - tangent * dot(tangent, ng), out = n - tangent * dot(tangent, n);
    const float both = dot(side, out);
    if (!(both > 0.0f)) return across_fibre(tangent, n, wo);
    // In a cross-section whose sides are 1 from the middle: the place, and the corner that stands
    // out most, which is the one nearest to a right angle from wo.
    constexpr float kHalfSide = kPi / kTubeSides;
    const Vec3 place = out * (std::sqrt(length_squared(side)) / both);
    const float corner = std::atan2(dot(side, frame.z), dot(side, frame.y)) + kHalfSide;
    const float aside = std::remainder(corner - kQuarter, 2.0f * kHalfSide);
    const float widest = std::cos(aside) / std::cos(kHalfSide);
    return std::clamp(-dot(place, frame.z) / widest, -1.0f, 1.0f);
}

}  // namespace spc
