// SPDX-License-Identifier: GPL-3.0-or-later
// Every chain that path tracing can find, the manifold must find too: rays are traced from
// receivers to a caster and on to a light point placed where they arrive, and a walk from the hit
// itself must end at it. A miss is lost energy.
#include "manifold/walk.h"

#include "support/casters.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

struct Coverage {
    int chains = 0, missed = 0, elsewhere = 0;
};

// Chains from points drawn by `receiver` to points of the caster, over a light at 0.3 .. 3 caster
// radii.
template <class Receiver>
Coverage measure(const RenderScene& world, const ManifoldSettings& settings, Receiver&& receiver,
                 int count) {
    Coverage coverage;
    Pcg pcg(11);
    ManifoldStats stats;
    const Caster& caster = world.casters.casters[0];
    while (coverage.chains < count) {
        const Vec3 x = receiver(pcg);
        const float root = std::sqrt(pcg.one()), v = pcg.one();
        const SurfaceHit aim{caster.instance, caster.triangles.sample(pcg.one()).index,
                             root * (1.0f - v), root * v};
        const Vec3 d = normalize(surface_position(*world.scene, aim) - x);
        const std::optional<Hit> hit =
            world.scene->accel->intersect_alone(caster.instance, {x, d, 1e-4f, kInfinity});
        if (!hit) continue;
        const DifferentialGeometry geometry = evaluate_caster(*world.scene, hit->surface, false);
        const SpecularInterface& specular = world.scene->material_of(hit->surface).specular;
        const Vec3 n = dot(geometry.n, d) < 0.0f ? geometry.n : geometry.n * -1.0f;
        const Vec3 ng = dot(geometry.ng, d) < 0.0f ? geometry.ng : geometry.ng * -1.0f;
        if (dot(n, ng) <= 0.0f) continue;
        const float c = -dot(n, d), eta = eta_seen_from(geometry.ng, d * -1.0f, specular.ior);
        const bool refracts = specular.refracts && (!specular.reflects || pcg.one() < 0.5f);
        Vec3 out = d + n * (2.0f * c);
        if (refracts) {
            const float cos2 = 1.0f - (1.0f - c * c) / sqr(eta);
            if (cos2 < 1e-4f) continue;
            out = d * (1.0f / eta) + n * (c / eta - std::sqrt(cos2));
        }
        if ((dot(out, ng) < 0.0f) != refracts) continue;
        const bool distant = pcg.one() < 0.2f;
        const ChainEnd end{distant,
                           geometry.p + out * (caster.radius * lerp(0.3f, 3.0f, pcg.one())), out};
        ++coverage.chains;
        const ChainQuery query{x, end, &caster};
        const std::optional<Seed> seed = seed_at(*world.scene, settings, query, hit->surface);
        const std::optional<ChainRoot> found =
            seed ? walk_from(*world.scene, settings, query, *seed, stats) : std::nullopt;
        if (!found)
            ++coverage.missed;
        else if (length(found->geometry.p - geometry.p) > 1e-3f * caster.radius)
            ++coverage.elsewhere;
    }
    return coverage;
}

class Walks : public ::testing::TestWithParam<Constraint> {
protected:
    ManifoldSettings settings() const {
        ManifoldSettings s;
        s.enabled = true;
        s.constraint = GetParam();
        return s;
    }
    static void expect_covered(const Coverage& coverage) {
        EXPECT_LE(coverage.missed, coverage.chains / 1000) << "of " << coverage.chains;
        EXPECT_LE(coverage.elsewhere, coverage.chains / 1000) << "of " << coverage.chains;
    }
};
INSTANTIATE_TEST_SUITE_P(Constraints, Walks,
                         ::testing::Values(Constraint::half_vector, Constraint::angle_difference));

TEST_P(Walks, CoverAMirrorSphere) {
    SceneMaker maker;
    maker.add(test::sphere(64, 0.1), test::mirror());
    const RenderScene world = maker.finish();
    expect_covered(measure(
        world, settings(), [](Pcg& pcg) { return Vec3(pcg.one() - 0.5f, pcg.one() - 0.5f, -0.1f); },
        20000));
}

// The inside of a small ring far from the origin, receivers on the plane that it stands on.
TEST_P(Walks, CoverTheInsideOfARing) {
    SceneMaker maker;
    const auto radial = [](double u) {
        return Vec3d(std::cos(2 * std::numbers::pi * u), std::sin(2 * std::numbers::pi * u), 0);
    };
    maker.add(
        test::grid(
            256, [&](double u, double v) { return radial(u) * 0.03 + Vec3d(1.0, 2.0, 0.01 * v); },
            [&](double u, double) { return radial(u) * -1.0; }),
        test::mirror());
    const RenderScene world = maker.finish();
    expect_covered(measure(
        world, settings(),
        [](Pcg& pcg) {
            const float r = 0.03f * std::sqrt(pcg.one()), a = 2 * kPi * pcg.one();
            return Vec3(1.0f + r * std::cos(a), 2.0f + r * std::sin(a), 0.0f);
        },
        20000));
}

TEST_P(Walks, CoverAGlassSphereFromInsideAndOutside) {
    SceneMaker maker;
    maker.add(test::sphere(64, 1.0), test::glass(1.5f));
    const RenderScene world = maker.finish();
    expect_covered(measure(
        world, settings(),
        [](Pcg& pcg) { return Vec3(3.0f * (pcg.one() - 0.5f), 3.0f * (pcg.one() - 0.5f), 0.0f); },
        20000));
}

TEST_P(Walks, CoverANormalMappedPanel) {
    const test::CausticScene scene = test::reflective_plane();
    expect_covered(measure(scene.world, settings(), scene.receiver, 20000));
}

TEST_P(Walks, CoverANormalMappedGlassSphereFromInside) {
    const test::CausticScene scene = test::refractive_sphere();
    expect_covered(measure(scene.world, settings(), scene.receiver, 20000));
}

}  // namespace
}  // namespace spc
