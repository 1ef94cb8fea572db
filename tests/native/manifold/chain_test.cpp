// SPDX-License-Identifier: GPL-3.0-or-later
// One interaction against closed forms: plane and sphere, reflection and refraction; derivatives
// against differences.
#include "manifold/chain.h"

#include "manifold/walk.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kRelative = 1e-4;

void expect_relative(double actual, double expected, const char* what) {
    EXPECT_NEAR(actual, expected, kRelative * std::abs(expected)) << what;
}

ManifoldSettings settings_with(Constraint constraint, bool two_stage = false) {
    ManifoldSettings settings;
    settings.enabled = true;
    settings.constraint = constraint;
    settings.two_stage = two_stage;
    settings.seeds_by_area = 1.0f;  // none of these seeds miss the caster
    return settings;
}

// Of one interaction.
double geometry_of(Interaction interaction, float eta, const Vec3& x,
                   const DifferentialGeometry& geometry, const ChainEnd& end) {
    const ChainVertex vertex{interaction, eta, geometry};
    return chain_derivative(x, {&vertex, 1}, end).value().geometry;
}

// The first root of many walks, and whether all that converged agree on it.
struct Found {
    std::optional<ChainRoot> root;
    int converged = 0, others = 0;
};
Found find_root(const RenderScene& world, const ManifoldSettings& settings, const Vec3& x,
                const ChainEnd& end) {
    Found found;
    Pcg pcg(7);
    ManifoldStats stats;
    const ChainQuery query{x, end, &world.casters.casters[0]};
    for (int i = 0; i < 64; ++i) {
        const std::optional<ChainRoot> root = random_walk(*world.scene, settings, query, pcg, stats);
        if (!root) continue;
        ++found.converged;
        if (!found.root)
            found.root = root;
        else if (!same_root(settings, *found.root, *root))
            ++found.others;
    }
    return found;
}

class BothConstraints : public ::testing::TestWithParam<Constraint> {};
INSTANTIATE_TEST_SUITE_P(Constraints, BothConstraints,
                         ::testing::Values(Constraint::half_vector, Constraint::angle_difference));

TEST_P(BothConstraints, PlaneMirrorIsItsMirrorImage) {
    SceneMaker maker;
    maker.add(test::square(5.0f), test::mirror());
    const RenderScene world = maker.finish();
    const Vec3 x(-1.0f, 0.3f, 1.0f), y(1.5f, -0.7f, 2.0f);
    const ChainEnd end{false, y, {}};
    const Found found = find_root(world, settings_with(GetParam()), x, end);
    ASSERT_TRUE(found.root);
    EXPECT_EQ(found.others, 0);
    EXPECT_GT(found.converged, 60);
    const Vec3d image(y.x, y.y, -y.z), along = image - Vec3d(x);
    const Vec3d expected = Vec3d(x) + along * (1.0 / 3.0);
    EXPECT_LT(length(Vec3d(found.root->geometry.p) - expected), kRelative * length(along));
    expect_relative(geometry_of(Interaction::reflection, 1.0f, x, found.root->geometry, end),
                    1.0 / dot(along, along), "G");
    // A sun: the angle at x is the angle at the light.
    const ChainEnd sun{true, {}, normalize(Vec3(1, 0, 2))};
    const Found sunlit = find_root(world, settings_with(GetParam()), x, sun);
    ASSERT_TRUE(sunlit.root);
    EXPECT_LT(length(sunlit.root->geometry.p - Vec3(-0.5f, 0.3f, 0.0f)), 1e-4f);
    expect_relative(geometry_of(Interaction::reflection, 1.0f, x, sunlit.root->geometry, sun), 1.0,
                    "G of a sun");
}

// A cap of the unit sphere around a direction, finer than single precision can tell from a sphere.
Mesh sphere_cap(const Vec3d& axis, double half_angle) {
    const Frame frame = Frame::around(Vec3(axis));
    const auto point = [=](double u, double v) {
        return normalize(axis + Vec3d(frame.x) * (half_angle * (2 * u - 1)) +
                         Vec3d(frame.y) * (half_angle * (2 * v - 1)));
    };
    return test::grid(400, point, point);
}

// Point of the unit circle in the xz plane where light from x reaches y by reflection (Alhazen's
// problem), by bisection.
double alhazen_angle(const Vec3d& x, const Vec3d& y, double low, double high) {
    const auto imbalance = [&](double a) {
        const Vec3d n(std::sin(a), 0, std::cos(a)), t(std::cos(a), 0, -std::sin(a));
        return dot(t, normalize(x - n)) + dot(t, normalize(y - n));
    };
    for (int i = 0; i < 100; ++i) {
        const double mid = 0.5 * (low + high);
        (imbalance(mid) * imbalance(low) > 0.0 ? low : high) = mid;
    }
    return 0.5 * (low + high);
}

TEST_P(BothConstraints, MirrorSphereIsAlhazensPointWithCoddingtonsTerm) {
    const Vec3d x(-1.5, 0, 2.0), y(2.5, 0, 1.2);
    const double angle = alhazen_angle(x, y, std::atan2(x.x, x.z), std::atan2(y.x, y.z));
    const Vec3d p(std::sin(angle), 0, std::cos(angle));
    SceneMaker maker;
    maker.add(sphere_cap(p, 0.01), test::mirror());
    const RenderScene world = maker.finish();
    const ChainEnd end{false, Vec3(y), {}};
    const Found found = find_root(world, settings_with(GetParam()), Vec3(x), end);
    ASSERT_TRUE(found.root);
    EXPECT_EQ(found.others, 0);
    EXPECT_LT(length(Vec3d(found.root->geometry.p) - p), kRelative);
    const double d1 = length(x - p), d2 = length(y - p), cosine = dot(normalize(x - p), p);
    const double tangential = d1 + d2 + 2 * d1 * d2 / cosine,
                 sagittal = d1 + d2 + 2 * d1 * d2 * cosine;
    // The term needs the sphere itself: corner normals 5e-5 apart hold its curvature to some 1e-3
    // in single precision.
    const Frame frame = Frame::around(Vec3(p));
    const DifferentialGeometry exact{Vec3(p), frame.x, frame.y, Vec3(p), frame.x, frame.y, Vec3(p)};
    expect_relative(geometry_of(Interaction::reflection, 1.0f, Vec3(x), exact, end),
                    1.0 / (tangential * sagittal), "G");
    EXPECT_NEAR(geometry_of(Interaction::reflection, 1.0f, Vec3(x), found.root->geometry, end) *
                    tangential * sagittal,
                1.0, 1e-2);
}

TEST_P(BothConstraints, FlatRefractionIsSnellsPoint) {
    constexpr double ior = 1.33, depth = 1.0, height = 2.0, across = 1.5;
    SceneMaker maker;
    maker.add(test::square(5.0f), test::refraction(float(ior)));
    const RenderScene world = maker.finish();
    const Vec3 x(0, 0, -depth), y(across, 0, height);
    double low = 0.0, high = across;  // sin(theta in water) ior = sin(theta in air)
    for (int i = 0; i < 100; ++i) {
        const double s = 0.5 * (low + high);
        const double inside = s / std::hypot(s, depth),
                     outside = (across - s) / std::hypot(across - s, height);
        (inside * ior < outside ? low : high) = s;
    }
    const ChainEnd end{false, y, {}};
    const Found found = find_root(world, settings_with(GetParam()), x, end);
    ASSERT_TRUE(found.root);
    EXPECT_EQ(found.others, 0);
    EXPECT_LT(length(found.root->geometry.p - Vec3(float(low), 0, 0)), 1e-4f);
    EXPECT_EQ(found.root->interaction, Interaction::refraction);
    EXPECT_FLOAT_EQ(found.root->eta, 1.0f / float(ior));
    const double sin1 = low / std::hypot(low, depth), cos1 = std::sqrt(1 - sin1 * sin1);
    const double sin2 = ior * sin1, cos2 = std::sqrt(1 - sin2 * sin2);
    const double dx_dtheta = depth / (cos1 * cos1) + height / (cos2 * cos2) * (ior * cos1 / cos2);
    expect_relative(
        geometry_of(Interaction::refraction, found.root->eta, x, found.root->geometry, end),
        1.0 / (across / sin1 * cos2 * dx_dtheta), "G");
}

// Without a change of index light goes straight on, and wi + eta wo has no direction.
TEST_P(BothConstraints, FindsTheStraightLineAtAnIndexOfOne) {
    for (const float ior : {1.0f, 1.0005f}) {
        SceneMaker maker;
        maker.add(test::square(5.0f), test::refraction(ior));
        const RenderScene world = maker.finish();
        const ChainEnd end{false, Vec3(1.5f, 0.0f, 2.0f), {}};
        const Found found =
            find_root(world, settings_with(GetParam()), Vec3(0.0f, 0.0f, -1.0f), end);
        ASSERT_TRUE(found.root) << ior;
        EXPECT_EQ(found.others, 0);
        EXPECT_LT(length(found.root->geometry.p - Vec3(0.5f, 0.0f, 0.0f)), 1e-3f) << ior;
    }
}

TEST_P(BothConstraints, NoChainWhereTotalReflectionForbidsIt) {
    SceneMaker maker;
    maker.add(test::square(50.0f), test::refraction(1.5f));
    const RenderScene world = maker.finish();
    // A sun below the critical angle, looked for from outside towards inside.
    const ChainEnd grazing{true, {}, normalize(Vec3(5.0f, 0.0f, -1.0f))};
    const Found found = find_root(world, settings_with(GetParam()), Vec3(0, 0, 1), grazing);
    EXPECT_FALSE(found.root);
}

// A smooth analytic surface around (u, v) = (0, 0), for derivatives.
DifferentialGeometry curved_geometry(double u, double v, const std::array<double, 12>& k) {
    DifferentialGeometry geometry;
    const Vec3d p(u + k[0] * v * v, v + k[1] * u * v, k[2] * u + k[3] * v + k[4] * u * u);
    const Vec3d raw(k[5] * u + k[6] * v * v, k[7] * v + k[8] * u, 1.0 + k[9] * u * v);
    const Vec3d raw_u(k[5], k[8], k[9] * v), raw_v(2 * k[6] * v, k[7], k[9] * u);
    const Vec3d n = normalize(raw);
    const auto derivative = [&](const Vec3d& d) { return Vec3((d - n * dot(n, d)) / length(raw)); };
    geometry.p = Vec3(p);
    geometry.dp_du = Vec3(1, float(k[1] * v), float(k[2] + 2 * k[4] * u));
    geometry.dp_dv = Vec3(float(2 * k[0] * v), float(1 + k[1] * u), float(k[3]));
    geometry.n = Vec3(n);
    geometry.dn_du = derivative(raw_u);
    geometry.dn_dv = derivative(raw_v);
    geometry.ng = normalize(cross(geometry.dp_du, geometry.dp_dv));
    return geometry;
}

// A chain in double, traced through the patches' first-order models: planes whose normals turn
// linearly. Its own code, not chain_derivative()'s.
struct TracedChain {
    std::vector<ChainVertex> vertices;  // from x on
    Vec3d x, y;

    // Position and direction behind all vertices of a ray from `from`; eta of a vertex is that for
    // rays from its first side, where the ray must come from.
    std::pair<Vec3d, Vec3d> trace(Vec3d from, Vec3d d) const {
        for (const ChainVertex& vertex : vertices) {
            const DifferentialGeometry& geometry = vertex.geometry;
            const Vec3d p0(geometry.p), pu(geometry.dp_du), pv(geometry.dp_dv),
                ng = normalize(cross(pu, pv));
            from += d * (dot(p0 - from, ng) / dot(d, ng));
            const Vec3d r = from - p0;
            const double uu = dot(pu, pu), uv = dot(pu, pv), vv = dot(pv, pv),
                         det = uu * vv - uv * uv;
            const double du = (dot(r, pu) * vv - dot(r, pv) * uv) / det,
                         dv = (dot(r, pv) * uu - dot(r, pu) * uv) / det;
            Vec3d n = normalize(Vec3d(geometry.n) + Vec3d(geometry.dn_du) * du +
                                Vec3d(geometry.dn_dv) * dv);
            if (dot(d, n) > 0.0) n = n * -1.0;
            const double c = -dot(d, n), ratio = 1.0 / double(vertex.eta);
            d = vertex.interaction == Interaction::refraction
                    ? d * ratio + n * (c * ratio - std::sqrt(1 - (1 - c * c) * ratio * ratio))
                    : d + n * (2 * c);
        }
        return {from, d};
    }
    TracedChain reversed() const {
        TracedChain other{{vertices.rbegin(), vertices.rend()}, y, x};
        for (ChainVertex& vertex : other.vertices)
            if (vertex.interaction == Interaction::refraction) vertex.eta = 1.0f / vertex.eta;
        return other;
    }
    Vec3d leaving_x() const { return normalize(Vec3d(vertices.front().geometry.p) - x); }
    Vec3d to_light() const { return normalize(y - Vec3d(vertices.back().geometry.p)); }

    // |d solid angle at x / d area at y| across the ray, or by solid angle at a distant light.
    double geometry(bool distant = false) const {
        const Vec3d d0 = leaving_x(), out = to_light();
        return 1.0 / stretch(d0, out, [&](const Vec3d& turn) {
                   const auto [from, w] = trace(x, normalize(d0 + turn));
                   return distant ? w : from + w * (dot(y - from, out) / dot(w, out));
               });
    }
    // |d area across the light / d area across the ray at x| of parallel light from a distant one.
    double concentration() const {
        const Vec3d d0 = leaving_x(), out = to_light();
        const TracedChain back = reversed();
        return 1.0 / stretch(out, d0, [&](const Vec3d& shift) {
                   const auto [from, w] = back.trace(y + shift, out * -1.0);
                   return from + w * (dot(x - from, d0) / dot(w, d0));
               });
    }

private:
    // By how much areas grow from across one direction to across another, by differences.
    template <class Map>
    static double stretch(const Vec3d& across, const Vec3d& then, const Map& map) {
        const Frame from = Frame::around(Vec3(across)), to = Frame::around(Vec3(then));
        constexpr double h = 1e-5;
        const auto slope = [&](const Vec3& axis) {
            const Vec3d change = (map(Vec3d(axis) * h) - map(Vec3d(axis) * -h)) / (2 * h);
            return std::array{dot(change, Vec3d(to.x)), dot(change, Vec3d(to.y))};
        };
        const auto a = slope(from.x), b = slope(from.y);
        return std::abs(a[0] * b[1] - a[1] * b[0]);
    }
};

// Patches are placed along a random walk of light, each turned so that it scatters as it should:
// the chain is admissible by construction. With `mapped`, normals lean away from the geometry.
std::optional<TracedChain> random_chain(int count, bool mapped, Pcg& pcg) {
    const auto uniform = [&](double a, double b) { return a + (b - a) * double(pcg.one()); };
    const auto random_vector = [&](double size) {
        return Vec3d(uniform(-size, size), uniform(-size, size), uniform(-size, size));
    };
    TracedChain chain;
    chain.x = random_vector(0.3);
    Vec3d p = chain.x, d = normalize(Vec3d(0, 0, 1) + random_vector(0.2));
    for (int i = 0; i < count; ++i) {
        p = p + d * uniform(0.6, 1.5);
        ChainVertex vertex;
        vertex.interaction = pcg.one() < 0.5f ? Interaction::reflection : Interaction::refraction;
        const bool enters = pcg.one() < 0.5f;
        const double ior = uniform(1.1, 1.7), eta = enters ? ior : 1.0 / ior;
        vertex.eta = float(eta);
        DifferentialGeometry& geometry = vertex.geometry;
        const Vec3d n = normalize(d * -1.0 + random_vector(0.5));  // towards where light comes from
        const Vec3d ng = normalize(n + random_vector(mapped ? 0.15 : 0.0));
        const Frame frame = Frame::around(Vec3(ng));
        const double front = pcg.one() < 0.5f ? 1.0 : -1.0;  // whether it sees the front
        geometry.p = Vec3(p);
        geometry.dp_du = frame.x * float(uniform(0.5, 2)) + frame.y * float(uniform(-0.4, 0.4));
        geometry.dp_dv = frame.y * float(uniform(0.5, 2));
        geometry.n = Vec3(n * front);
        geometry.ng = Vec3(ng * front);
        const auto lean = [&] {
            const Vec3d change = random_vector(0.4);
            return Vec3(change - n * dot(change, n));
        };
        geometry.dn_du = lean();
        geometry.dn_dv = lean();
        const double c = -dot(d, Vec3d(geometry.n) * front), inv = 1.0 / double(vertex.eta);
        const Vec3d normal = Vec3d(geometry.n) * front;
        if (vertex.interaction == Interaction::refraction) {
            const double cos2 = 1 - (1 - c * c) * inv * inv;
            if (cos2 < 0.05) return std::nullopt;
            d = d * inv + normal * (c * inv - std::sqrt(cos2));
        } else {
            d = d + normal * (2 * c);
        }
        if (std::abs(dot(d, ng)) < 0.1) return std::nullopt;
        chain.vertices.push_back(vertex);
    }
    chain.y = p + d * uniform(0.6, 1.5);
    return chain;
}

void for_random_chains(bool mapped, bool distant,
                       const std::function<void(const TracedChain&)>& body) {
    for (int count = 1; count <= 4; ++count) {
        Pcg pcg{uint64_t(count)};
        int done = 0;
        for (int trial = 0; trial < 4000 && done < 300; ++trial)
            if (const std::optional<TracedChain> chain = random_chain(count, mapped, pcg)) {
                // Near a fold differences see its curvature.
                const double g = chain->geometry(distant);
                if (!(g > 1e-4 && g < 1e2)) continue;
                body(*chain);
                ++done;
            }
        EXPECT_EQ(done, 300) << count;
    }
}

// Vertices keep single precision.
constexpr double kChainPrecision = 1e-4;

ChainEnd end_of(const TracedChain& chain, bool distant) {
    return {distant, Vec3(chain.y), Vec3(chain.to_light())};
}

void expect_differences(bool distant) {
    for (const bool mapped : {false, true})
        for_random_chains(mapped, distant, [&](const TracedChain& chain) {
            const auto derivative =
                chain_derivative(Vec3(chain.x), chain.vertices, end_of(chain, distant));
            ASSERT_TRUE(derivative);
            const double g = chain.geometry(distant);
            // A sharp focus magnifies what rounding leaves of the vertices' places.
            EXPECT_NEAR(derivative->geometry / g, 1.0, kChainPrecision * std::max(1.0, g));
        });
}
TEST(ChainDerivative, MatchesDifferencesThroughManyVertices) { expect_differences(false); }
TEST(ChainDerivative, MatchesDifferencesThroughManyVerticesToASun) { expect_differences(true); }

// Without maps the indices at both ends are all that there is to it.
double etendue_of_indices(const TracedChain& chain) {
    double indices = 1.0;
    for (const ChainVertex& vertex : chain.vertices)
        if (vertex.interaction == Interaction::refraction)
            indices /= double(vertex.eta) * double(vertex.eta);
    return indices;
}
void expect_etendue_of_indices(bool mapped, double largest_deviation) {
    if (mapped)
        EXPECT_GT(largest_deviation, 0.2);
    else
        EXPECT_LT(largest_deviation, kChainPrecision);
}

// The etendue against the other way round: traced, and by the function itself.
TEST(ChainDerivative, IsReciprocal) {
    for (const bool mapped : {false, true}) {
        double largest = 0.0;
        for_random_chains(mapped, false, [&](const TracedChain& chain) {
            const auto there = chain_derivative(Vec3(chain.x), chain.vertices, end_of(chain, false));
            const TracedChain back = chain.reversed();
            const auto returned = chain_derivative(Vec3(back.x), back.vertices, end_of(back, false));
            ASSERT_TRUE(there && returned);
            const double expected = back.geometry();
            const double tolerance = kChainPrecision * std::max(1.0, expected);
            EXPECT_NEAR(there->geometry * there->etendue / expected, 1.0, tolerance);
            EXPECT_NEAR(returned->geometry / expected, 1.0, tolerance);
            EXPECT_NEAR(there->etendue * returned->etendue, 1.0, kChainPrecision);
            largest = std::max(largest, std::abs(there->etendue / etendue_of_indices(chain) - 1.0));
        });
        expect_etendue_of_indices(mapped, largest);
    }
}

// The other way round light is parallel: the etendue tells how its beam narrows on the way to x.
TEST(ChainDerivative, OfADistantEndTellsHowParallelLightIsConcentrated) {
    for (const bool mapped : {false, true}) {
        double largest = 0.0;
        for_random_chains(mapped, true, [&](const TracedChain& chain) {
            const auto there = chain_derivative(Vec3(chain.x), chain.vertices, end_of(chain, true));
            ASSERT_TRUE(there);
            const double expected = chain.concentration();
            EXPECT_NEAR(there->geometry * there->etendue / expected, 1.0,
                        kChainPrecision * std::max(1.0, expected));
            largest = std::max(largest, std::abs(there->etendue / etendue_of_indices(chain) - 1.0));
        });
        expect_etendue_of_indices(mapped, largest);
    }
}

// The constraints' Jacobian is that of Newton's local equation: exact up to terms that vanish with
// C, so it is checked at a root: x, u and v random, the light placed where the scattered ray goes.
TEST_P(BothConstraints, DerivativesMatchCentralDifferencesAtRoots) {
    Pcg pcg(3);
    const auto uniform = [&](double a, double b) { return a + (b - a) * double(pcg.one()); };
    for (int trial = 0; trial < 200; ++trial) {
        std::array<double, 12> k;
        for (double& value : k) value = uniform(-0.5, 0.5);
        const bool refracts = trial % 2 == 1;
        const double u = uniform(-0.2, 0.2), v = uniform(-0.2, 0.2), ior = uniform(1.1, 1.8);
        const DifferentialGeometry geometry = curved_geometry(u, v, k);
        const Vec3d n(geometry.n), p(geometry.p);
        const Vec3d wi = normalize(n + Vec3d(uniform(-0.6, 0.6), uniform(-0.6, 0.6), 0.0));
        const double c = dot(wi, n);
        const Vec3d wo =
            refracts ? wi * (-1 / ior) + n * (c / ior - std::sqrt(1 - (1 - c * c) / (ior * ior)))
                     : n * (2 * c) - wi;
        const Vec3 x(p + wi * uniform(1, 3));
        const bool distant = trial % 3 == 0;
        const ChainEnd end{distant, Vec3(p + wo * uniform(1, 3)), Vec3(wo)};
        const auto at = [&](double du, double dv) {
            return evaluate_constraint(GetParam(),
                                       refracts ? Interaction::refraction : Interaction::reflection,
                                       float(ior), x, curved_geometry(u + du, v + dv, k), end);
        };
        const auto value = at(0, 0);
        ASSERT_TRUE(value);
        EXPECT_LT(value->size(), 1e-5f);
        constexpr double h = 2e-3;
        const auto pu = at(h, 0), mu = at(-h, 0), pv = at(0, h), mv = at(0, -h);
        ASSERT_TRUE(pu && mu && pv && mv);
        // The half-vector's frame and the angle's equator move with the point, by rotations that
        // only second order sees.
        const auto sized = [](const Vec2& a) { return std::hypot(a.x, a.y); };
        const double scale = std::max({1.0f, sized(value->dc_du), sized(value->dc_dv)});
        const auto quotient = [&](const Vec2& a, const Vec2& b) { return (a - b) * float(0.5 / h); };
        EXPECT_NEAR(sized(quotient(pu->c, mu->c)), sized(value->dc_du), 5e-3 * scale);
        EXPECT_NEAR(sized(quotient(pv->c, mv->c)), sized(value->dc_dv), 5e-3 * scale);
        // Their determinant is what Newton needs besides; it does not see the rotations either.
        const Vec2 du = quotient(pu->c, mu->c), dv = quotient(pv->c, mv->c);
        EXPECT_NEAR(du.x * dv.y - du.y * dv.x,
                    value->dc_du.x * value->dc_dv.y - value->dc_du.y * value->dc_dv.x,
                    1e-2 * scale * scale);
    }
}

// The derivative against differences of the traced map itself: from a direction at x through the
// patch to the light.
TEST(ChainDerivative, MatchesDifferencesOfTheTracedMap) {
    constexpr double ior = 1.45;
    const std::array<double, 12> k{0.1, -0.2, 0.3, 0.1, 0.0, 0.2, 0.1, -0.3, 0.15, 0.1, 0, 0};
    for (const bool refracts : {false, true}) {
        const DifferentialGeometry geometry = curved_geometry(0.0, 0.0, k);
        const Vec3d x(0.4, -0.3, 1.5);
        // Only first order counts: the plane of the patch, with the normal's linear model.
        const Vec3d p0(geometry.p), pu(geometry.dp_du), pv(geometry.dp_dv),
            ng = normalize(cross(pu, pv));
        const auto scatter = [&](const Vec3d& d, Vec3d& hit) {
            hit = x + d * (dot(p0 - x, ng) / dot(d, ng));
            const Vec3d r = hit - p0;
            const double uu = dot(pu, pu), uv = dot(pu, pv), vv = dot(pv, pv),
                         det = uu * vv - uv * uv;
            const double du = (dot(r, pu) * vv - dot(r, pv) * uv) / det,
                         dv = (dot(r, pv) * uu - dot(r, pu) * uv) / det;
            const Vec3d n = normalize(Vec3d(geometry.n) + Vec3d(geometry.dn_du) * du +
                                      Vec3d(geometry.dn_dv) * dv);
            const double c = -dot(d, n);
            return refracts ? d / ior + n * (c / ior - std::sqrt(1 - (1 - c * c) / (ior * ior)))
                            : d + n * (2 * c);
        };
        const Vec3d d0 = normalize(p0 - x);
        Vec3d hit;
        const Vec3d out = scatter(d0, hit);
        const Vec3d y = hit + out * 1.7;
        const Frame frame = Frame::around(Vec3(d0)), plane = Frame::around(Vec3(out));
        const auto landing = [&](const Vec3d& turn) {
            Vec3d from;
            const Vec3d w = scatter(normalize(d0 + turn), from);
            const Vec3d q = from + w * (dot(y - from, out) / dot(w, out)) - y;
            return Vec2(float(dot(q, Vec3d(plane.x))), float(dot(q, Vec3d(plane.y))));
        };
        constexpr double h = 1e-3;
        const Vec2 a = (landing(Vec3d(frame.x) * h) - landing(Vec3d(frame.x) * -h)) * float(0.5 / h);
        const Vec2 b = (landing(Vec3d(frame.y) * h) - landing(Vec3d(frame.y) * -h)) * float(0.5 / h);
        const double g = geometry_of(refracts ? Interaction::refraction : Interaction::reflection,
                                     float(ior), Vec3(x), geometry, {false, Vec3(y), {}});
        EXPECT_NEAR(g * std::abs(double(a.x * b.y - a.y * b.x)), 1.0, 2e-4);
    }
}

}  // namespace
}  // namespace spc
