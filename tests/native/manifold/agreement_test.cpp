// SPDX-License-Identifier: GPL-3.0-or-later
// Chains of up to three triangles with normals of their own: shots and walks against light that was
// traced in double precision, and against the other way to solve for them, Newton's method on all
// vertices at once, whose Jacobian is block-tridiagonal [Jakob12].
#include "manifold/shooting.h"
#include "manifold/walk.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

constexpr double kPrecision = 1e-4;  // of positions relative to the metre that vertices are apart

struct Vec2d {
    double x = 0.0, y = 0.0;
};
// A 2 x 2 matrix by its columns.
struct Block {
    Vec2d a, b;
    double det() const { return a.x * b.y - a.y * b.x; }
};
Vec2d operator*(const Block& m, const Vec2d& v) {
    return {m.a.x * v.x + m.b.x * v.y, m.a.y * v.x + m.b.y * v.y};
}
Block operator*(const Block& m, const Block& n) { return {m * n.a, m * n.b}; }
Vec2d operator-(const Vec2d& a, const Vec2d& b) { return {a.x - b.x, a.y - b.y}; }
Block operator-(const Block& a, const Block& b) { return {a.a - b.a, a.b - b.b}; }
Block inverse(const Block& m) {
    const double d = 1.0 / m.det();
    return {{m.b.y * d, -m.a.y * d}, {-m.b.x * d, m.a.x * d}};
}

// A triangle and the normals at its corners, as single precision keeps them.
struct Facet {
    std::array<Vec3d, 3> p, n;
    Interaction interaction;
    double eta;  // behind over in front, as seen from the receiver

    Vec3d position(const Vec2d& q) const {
        return p[0] + (p[1] - p[0]) * q.x + (p[2] - p[0]) * q.y;
    }
    Vec3d normal(const Vec2d& q) const {
        return normalize(n[0] * (1.0 - q.x - q.y) + n[1] * q.x + n[2] * q.y);
    }
    // Where a ray meets its plane.
    Vec2d meet(const Vec3d& from, const Vec3d& d) const {
        const Vec3d e1 = p[1] - p[0], e2 = p[2] - p[0], to = from - p[0];
        const double det = dot(cross(e1, e2), d);
        return {dot(cross(to, e2), d) / det, dot(cross(e1, to), d) / det};
    }
    std::optional<Vec3d> scatter(const Vec2d& q, const Vec3d& d) const {
        Vec3d m = normal(q);
        if (dot(m, d) > 0.0) m = m * -1.0;
        const double c = -dot(m, d);
        if (interaction == Interaction::reflection) return d + m * (2.0 * c);
        const double cos2 = 1.0 - (1.0 - c * c) / (eta * eta);
        if (cos2 < 0.05) return std::nullopt;
        return d * (1.0 / eta) + m * (c / eta - std::sqrt(cos2));
    }
};

struct Chain3 {
    Vec3d x, y;
    std::vector<Facet> facets;
    std::vector<Vec2d> root;  // one for each facet: where the light came that it was made of
};

// Facets are placed along a path of light, each turned so that it scatters as it should.
std::optional<Chain3> random_chain(size_t count, Pcg& pcg) {
    const auto uniform = [&](double a, double b) { return a + (b - a) * double(pcg.one()); };
    const auto random_vector = [&](double size) {
        return Vec3d(uniform(-size, size), uniform(-size, size), uniform(-size, size));
    };
    const auto rounded = [](const Vec3d& v) { return Vec3d(Vec3(v)); };
    Chain3 chain;
    chain.x = rounded(random_vector(0.3));
    Vec3d from = chain.x, d = normalize(Vec3d(0, 0, 1) + random_vector(0.3));
    for (size_t i = 0; i < count; ++i) {
        const Vec3d middle = from + d * uniform(0.7, 1.5);
        const Vec3d ng = normalize(d * -1.0 + random_vector(0.5));
        const double side = pcg.one() < 0.5f ? 1.0 : -1.0;  // whether the front is seen
        const Frame frame = Frame::around(Vec3(ng * side));
        Facet facet;
        for (size_t k = 0; k < 3; ++k) {
            const double turn = 2.0 * std::numbers::pi * (double(k) / 3.0 + uniform(-0.05, 0.05));
            facet.p[k] = rounded(middle + Vec3d(frame.x) * (1.5 * std::cos(turn)) +
                                 Vec3d(frame.y) * (1.5 * std::sin(turn)));
            facet.n[k] = rounded(normalize(ng * side + random_vector(0.2)));
        }
        facet.interaction = pcg.one() < 0.5f ? Interaction::reflection : Interaction::refraction;
        const double ior = double(float(uniform(1.2, 1.7)));
        facet.eta = side > 0.0 ? ior : 1.0 / ior;
        const Vec2d q = facet.meet(from, d);
        const std::optional<Vec3d> out = facet.scatter(q, d);
        if (!out) return std::nullopt;
        // Seen well, and left on the right side by geometry and by normal.
        const double along = facet.interaction == Interaction::reflection ? -1.0 : 1.0;
        for (const Vec3d& m : {ng, facet.normal(q) * side})
            if (-dot(m, d) < 0.3 || along * -dot(m, *out) < 0.3) return std::nullopt;
        chain.facets.push_back(facet);
        chain.root.push_back(q);
        from = facet.position(q);
        d = *out;
    }
    chain.y = rounded(from + d * uniform(0.7, 1.5));
    return chain;
}

// The half-vector constraint of each vertex, as a function of its own and its neighbours' places.
class TridiagonalSolver {
public:
    explicit TridiagonalSolver(const Chain3& chain) : chain_(chain) {}

    // Newton's method on all vertices at once; empty where it diverges.
    std::optional<std::vector<Vec2d>> solve(std::vector<Vec2d> q) const {
        for (int step = 0; step < 30; ++step) {
            std::vector<Vec2d> c;
            double size = 0.0;
            for (size_t i = 0; i < q.size(); ++i) {
                c.push_back(constraint(i, q, chain_.y));
                size = std::max(size, std::hypot(c[i].x, c[i].y));
            }
            if (!std::isfinite(size)) return std::nullopt;
            if (size < 1e-13) return q;
            const std::vector<Vec2d> change = eliminate(q, c);
            for (size_t i = 0; i < q.size(); ++i) q[i] = q[i] - change[i];
        }
        return std::nullopt;
    }

    // |d solid angle at x / d area at y|: what the first vertex does when y moves and all
    // constraints stay zero.
    double geometry(const std::vector<Vec2d>& q) const {
        const Vec3d last = chain_.facets.back().position(q.back()),
                    first = chain_.facets.front().position(q.front());
        const Frame at_y = Frame::around(Vec3(normalize(chain_.y - last))),
                    at_x = Frame::around(Vec3(normalize(first - chain_.x)));
        const Facet& facet = chain_.facets.front();
        const auto turn = [&](const Vec3& along) {
            const size_t k = q.size() - 1;
            const Vec2d by_y =
                difference([&](double h) { return constraint(k, q, chain_.y + Vec3d(along) * h); });
            std::vector<Vec2d> right(q.size());
            right[k] = by_y;
            const Vec2d dq = eliminate(q, right)[0];
            const Vec3d dp = (facet.p[1] - facet.p[0]) * dq.x + (facet.p[2] - facet.p[0]) * dq.y;
            return Vec2d{dot(dp, Vec3d(at_x.x)), dot(dp, Vec3d(at_x.y))};
        };
        const Vec3d to_first = first - chain_.x;
        return std::abs(Block{turn(at_y.x), turn(at_y.y)}.det()) / dot(to_first, to_first);
    }

private:
    Vec2d constraint(size_t i, const std::vector<Vec2d>& q, const Vec3d& y) const {
        const Facet& facet = chain_.facets[i];
        const Vec3d p = facet.position(q[i]), n = facet.normal(q[i]);
        const Vec3d before = i == 0 ? chain_.x : chain_.facets[i - 1].position(q[i - 1]);
        const Vec3d behind = i + 1 == q.size() ? y : chain_.facets[i + 1].position(q[i + 1]);
        const double eta = facet.interaction == Interaction::reflection ? 1.0 : facet.eta;
        const Vec3d h = normalize(normalize(before - p) + normalize(behind - p) * eta);
        const Vec3d along = facet.p[1] - facet.p[0], s = normalize(along - n * dot(n, along));
        return {dot(h, s), dot(h, cross(n, s))};
    }

    static Vec2d difference(const std::function<Vec2d(double)>& f) {
        constexpr double kStep = 1e-5;
        const Vec2d d = f(kStep) - f(-kStep);
        return {d.x / (2.0 * kStep), d.y / (2.0 * kStep)};
    }
    // How the constraint of vertex i changes with the place of vertex j.
    Block derivative(size_t i, size_t j, const std::vector<Vec2d>& q) const {
        const auto by = [&](double u, double v) {
            return difference([&](double h) {
                std::vector<Vec2d> moved = q;
                moved[j] = {q[j].x + u * h, q[j].y + v * h};
                return constraint(i, moved, chain_.y);
            });
        };
        return {by(1, 0), by(0, 1)};
    }
    // Gaussian elimination by blocks.
    std::vector<Vec2d> eliminate(const std::vector<Vec2d>& q, std::vector<Vec2d> right) const {
        const size_t k = q.size();
        std::vector<Block> diagonal;
        for (size_t i = 0; i < k; ++i) diagonal.push_back(derivative(i, i, q));
        for (size_t i = 1; i < k; ++i) {
            const Block factor = derivative(i, i - 1, q) * inverse(diagonal[i - 1]);
            diagonal[i] = diagonal[i] - factor * derivative(i - 1, i, q);
            right[i] = right[i] - factor * right[i - 1];
        }
        for (size_t i = k; i-- > 0;) {
            if (i + 1 < k) right[i] = right[i] - derivative(i, i + 1, q) * right[i + 1];
            right[i] = inverse(diagonal[i]) * right[i];
        }
        return right;
    }

    const Chain3& chain_;
};

RenderScene make(const Chain3& chain) {
    SceneMaker maker;
    for (const Facet& facet : chain.facets) {
        Mesh mesh;
        mesh.name = "facet";
        for (const Vec3d& p : facet.p) mesh.positions.push_back(Vec3(p));
        for (const Vec3d& n : facet.n) mesh.normals.push_back(Vec3(n));
        mesh.triangles = {{0, 1, 2}};
        const auto ior = static_cast<float>(std::max(facet.eta, 1.0 / facet.eta));
        maker.add(
            mesh,
            facet.interaction == Interaction::reflection ? test::mirror() : test::refraction(ior),
            {}, CausticsRole::caster);
    }
    return maker.finish();
}

ManifoldSettings settings() {
    ManifoldSettings s;
    s.enabled = true;
    s.seeds_by_area = 1.0f;
    return s;
}

// Of all chains there are `count` of each length. Near a fold everything is magnified, so those of
// a large term are left out.
void for_random_chains(size_t count, const std::function<void(const Chain3&, double)>& body) {
    for (size_t length = 1; length <= 3; ++length) {
        Pcg pcg{uint64_t(length)};
        size_t done = 0;
        for (int trial = 0; trial < 5000 && done < count; ++trial) {
            const std::optional<Chain3> chain = random_chain(length, pcg);
            if (!chain) continue;
            const double g = TridiagonalSolver(*chain).geometry(chain->root);
            if (!(g > 1e-3 && g < 3.0)) continue;
            body(*chain, g);
            ++done;
        }
        EXPECT_EQ(done, count) << length;
    }
}

void expect_vertex(const DifferentialGeometry& geometry, const Facet& facet, const Vec2d& root) {
    EXPECT_LT(length(Vec3d(geometry.p) - facet.position(root)), kPrecision);
}

TEST(Solvers, BlockTridiagonalStaysAtTracedLight) {
    for_random_chains(200, [](const Chain3& chain, double) {
        std::vector<Vec2d> start = chain.root;
        for (Vec2d& q : start) q = {q.x + 1e-3, q.y - 5e-4};
        const auto found = TridiagonalSolver(chain).solve(start);
        ASSERT_TRUE(found);
        // The far end was rounded to single precision.
        for (size_t i = 0; i < start.size(); ++i)
            EXPECT_LT(std::hypot((*found)[i].x - chain.root[i].x, (*found)[i].y - chain.root[i].y),
                      1e-5);
    });
}

TEST(Solvers, ShotsFindTheRootsOfTheBlockTridiagonalSystem) {
    int found = 0;
    for_random_chains(200, [&](const Chain3& chain, double g) {
        const RenderScene world = make(chain);
        ChainKind kind;
        for (uint32_t i = 0; i < chain.facets.size(); ++i)
            kind.append({i, chain.facets[i].interaction});
        const RayStart x{Vec3(chain.x), Vec3(0, 0, 1), 1e-6f};
        const ChainEnd end{false, Vec3(chain.y), Vec3(0.0f)};
        const Vec3 w(normalize(chain.facets[0].position(chain.root[0]) - chain.x));
        const Frame frame = Frame::around(w);
        const Vec3 beside = normalize(w + frame.x * 2e-3f - frame.y * 1e-3f);
        ManifoldStats stats;
        const std::optional<ChainSolution> at =
            shoot(*world.scene, settings(), x, end, kind, beside, settings().max_halvings, stats);
        if (!at) return;
        ++found;
        ASSERT_EQ(at->chain.count, chain.facets.size());
        for (uint32_t i = 0; i < at->chain.count; ++i)
            expect_vertex(at->chain.vertices[i].geometry, chain.facets[i], chain.root[i]);
        const auto derivative =
            chain_derivative(x.p, {at->chain.vertices.data(), at->chain.count}, end);
        ASSERT_TRUE(derivative);
        EXPECT_NEAR(derivative->geometry / g, 1.0, kPrecision * std::max(1.0, g));
    });
    EXPECT_GT(found, 590);
}

TEST(Solvers, WalksFindTheSameRoots) {
    for (const Constraint constraint : {Constraint::half_vector, Constraint::angle_difference}) {
        int roots = 0, same = 0;
        for_random_chains(50, [&](const Chain3& chain, double g) {
            if (chain.facets.size() > 1) return;
            const RenderScene world = make(chain);
            const ChainEnd end{false, Vec3(chain.y), Vec3(0.0f)};
            const ChainQuery query{Vec3(chain.x), end, &world.casters.casters[0]};
            ManifoldSettings with = settings();
            with.constraint = constraint;
            Pcg pcg(7);
            ManifoldStats stats;
            bool is_found = false;
            for (int i = 0; i < 32; ++i) {
                const std::optional<ChainRoot> root =
                    random_walk(*world.scene, with, query, pcg, stats);
                if (!root) continue;
                // There may be others on the same facet.
                const Facet& facet = chain.facets[0];
                if (!(length(Vec3d(root->geometry.p) - facet.position(chain.root[0])) < kPrecision))
                    continue;
                is_found = true;
                const ChainVertex vertex{root->interaction, root->eta, root->geometry};
                EXPECT_EQ(root->interaction, facet.interaction);
                if (facet.interaction == Interaction::refraction) {
                    EXPECT_NEAR(root->eta, static_cast<float>(facet.eta), 1e-6f);
                }
                EXPECT_NEAR(chain_derivative(query.x, {&vertex, 1}, end)->geometry / g, 1.0,
                            kPrecision * std::max(1.0, g));
            }
            ++roots;
            same += is_found ? 1 : 0;
        });
        EXPECT_EQ(roots, 50);
        EXPECT_GE(same, 48);
    }
}

}  // namespace
}  // namespace spc
