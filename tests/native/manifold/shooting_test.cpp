// SPDX-License-Identifier: GPL-3.0-or-later
// Shots and light sheets against chains that closures made: whatever light takes through casters,
// by the closures' own sampling, must be found from the receiver.
#include "manifold/shooting.h"

#include "light/bench.h"
#include "manifold/fold_directions.h"
#include "manifold/found_chains.h"
#include "support/casters.h"

#include <gtest/gtest.h>

namespace spc {
namespace {

using test::SceneMaker;

ManifoldSettings settings() {
    ManifoldSettings s;
    s.enabled = true;
    s.finder = ChainFinder::sheets;
    return s;
}

// A path through casters, as closures scatter it.
struct Traced {
    ChainKind kind;  // in the order of the path
    std::vector<Vec3> vertices;
    Ray ray;  // behind the last
};

// Follows delta closures until a surface that is no caster, or nothing, is met. Empty without one
// interaction, or with too many.
std::optional<Traced> follow(const RenderScene& world, Ray ray, Pcg& pcg) {
    Traced path;
    for (;;) {
        const std::optional<Hit> hit = world.scene->accel->intersect(ray, kVisibleScattered);
        if (hit && hit->light != kNone) {
            ray.t_near = past(hit->t);
            continue;
        }
        path.ray = ray;
        if (!hit || world.casters.of_instance[hit->surface.instance] == kNone) {
            if (hit) path.ray.t_far = hit->t;
            if (path.vertices.empty()) return std::nullopt;
            return path;
        }
        Surface surface;
        evaluate_surface(*world.scene, hit->surface, ray.direction * -1.0f, surface);
        const Vec2 u = pcg.two();
        const std::optional<ClosureSample> next =
            sample(surface.closures, surface.ng, surface.wo, {pcg.one(), u.x, u.y});
        if (!next || path.kind.count == kLongestManifoldChain) return std::nullopt;
        path.kind.append({hit->surface.instance,
                          next->refracted ? Interaction::refraction : Interaction::reflection});
        path.vertices.push_back(surface.p);
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi, 0.0f,
               kInfinity};
    }
}

struct CasterCase {
    const char* name;
    std::function<void(SceneMaker&)> build;
    double missed_by_sheets;  // of the light, at most
};
void add_ball(SceneMaker& maker, const Graph& graph) {
    maker.add(test::sphere(48, 0.5), graph, test::translation({0, 0, 0.8f}), CausticsRole::caster);
}
void add_mirror_beside(SceneMaker& maker, const Graph& graph) {
    maker.add(test::square(0.8f), graph, test::rotation_x(1.3f, {0.0f, 0.9f, 0.8f}),
              CausticsRole::caster);
}
std::vector<CasterCase> cases() {
    return {{"mirror ball", [](SceneMaker& m) { add_ball(m, test::mirror()); }, 0.02},
            {"glass ball", [](SceneMaker& m) { add_ball(m, test::glass(1.5f)); }, 0.003},
            {"two sheets of glass",
             [](SceneMaker& m) {
                 for (const float z : {0.5f, 0.9f})
                     m.add(test::square(0.8f), test::glass(1.3f), test::rotation_x(0.2f, {0, 0, z}),
                           CausticsRole::caster);
             },
             0.0005},
            {"wavy mirror",
             [](SceneMaker& m) {
                 m.builder.add_image(test::plane_normals(128, 0.25, 0.03, 5));
                 add_mirror_beside(m, test::normal_mapped(test::mirror(), Vec2(1.0f, 1.0f)));
             },
             0.003},
            {"bumpy mirror",
             [](SceneMaker& m) {
                 m.builder.add_image(test::plane_heights(128, 128, 0.25, 0.03, 5));
                 add_mirror_beside(m, test::bump_mapped(test::mirror(), Vec2(1.0f, 1.0f), 1.6f));
             },
             0.0005},
            {"two wavy sheets of glass",
             [](SceneMaker& m) {
                 m.builder.add_image(test::plane_normals(128, 0.5, 0.02, 5));
                 for (const float z : {0.5f, 0.9f})
                     m.add(test::square(0.8f),
                           test::normal_mapped(test::glass(1.3f), Vec2(1.0f, 1.0f)),
                           test::rotation_x(0.2f, {0, 0, z}), CausticsRole::caster);
             },
             0.001}};
}
RenderScene make(const CasterCase& c) {
    SceneMaker maker;
    maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    c.build(maker);
    test::add_lamp(maker, {0.3f, -1.2f, 2.6f}, {0.0f, 0.2f, 0.8f}, 0.05f);
    return maker.finish();
}

bool is_chain(const ChainSolution& solution, const ChainKind& kind, const Vec3& first,
              const Vec3& last) {
    const auto near = [](const Vec3& p, const Vec3& q) { return length(p - q) < 1e-3f; };
    return solution.kind == kind && near(solution.chain.vertices[0].geometry.p, first) &&
           near(solution.chain.vertices[kind.count - 1].geometry.p, last);
}

TEST(Shots, StayAtChainsThatExist) {
    for (const CasterCase& c : cases()) {
        const RenderScene world = make(c);
        Pcg pcg(3);
        ManifoldStats stats;
        int chains = 0, missed = 0, returned = 0;
        while (chains < 2000) {
            const Caster& caster = world.casters.casters[pcg.bits() % world.casters.casters.size()];
            const RayStart x{Vec3(2.0f * pcg.one() - 1.0f, 2.0f * pcg.one() - 1.0f, 0.0f),
                             Vec3(0, 0, 1), 1e-6f};
            const Vec3 w = towards_caster(caster, x.p, pcg.two());
            if (w.z < 0.01f) continue;
            const std::optional<Traced> path = follow(world, {x.p, w, 1e-5f, kInfinity}, pcg);
            if (!path) continue;
            ++chains;
            const bool distant = pcg.one() < 0.3f;
            const Vec3 y =
                path->vertices.back() +
                path->ray.direction * (0.05f + std::min(path->ray.t_far, 3.0f) * pcg.one());
            const ChainEnd end{distant, y, path->ray.direction};
            const std::optional<ChainSolution> at = shoot(
                *world.scene, settings(), x, end, path->kind, w, settings().max_halvings, stats);
            if (!at || !is_chain(*at, path->kind, path->vertices[0], path->vertices.back()))
                ++missed;
            const Frame frame = Frame::around(w);
            const Vec3 beside = normalize(w + frame.x * 3e-4f - frame.y * 2e-4f);
            const std::optional<ChainSolution> back =
                shoot(*world.scene, settings(), x, end, path->kind, beside, settings().max_halvings,
                      stats);
            if (back && is_chain(*back, path->kind, path->vertices[0], path->vertices.back()))
                ++returned;
        }
        EXPECT_LE(missed, chains / 200) << c.name;
        EXPECT_GE(returned, chains * 9 / 10) << c.name;
    }
}

// Nothing is in the way of a shot from next to its chain but rounding, most of it on large
// triangles and between sides that are close together. It must not stop there: sheets would miss
// the chain, and only rare walks find it.
void expect_certain_shots(float thickness) {
    SceneMaker maker;
    for (const bool top : {false, true})
        maker.add(test::square(3.0f), test::glass(1.5f),
                  test::rotation_x(top ? 0.0f : kPi, {0, 0, top ? 0.45f + thickness : 0.45f}),
                  CausticsRole::caster);
    const ChainEnd end{false, {0.3f, 0.4f, 2.0f}, Vec3(0.0f)};
    test::add_lamp(maker, end.p, {0.0f, 0.0f, 0.6f}, 0.05f);
    const RenderScene world = maker.finish();
    ChainKind through, reflected;
    for (const auto& [instance, interaction] : {std::pair{0u, Interaction::refraction},
                                                {1u, Interaction::reflection},
                                                {0u, Interaction::reflection},
                                                {1u, Interaction::refraction}}) {
        reflected.append({instance, interaction});
        if (interaction == Interaction::refraction) through.append({instance, interaction});
    }
    Pcg pcg(5);
    ManifoldStats stats;
    for (const ChainKind& kind : {through, reflected}) {
        constexpr int kTries = 20000;
        int chains = 0, lost = 0;
        for (int i = 0; i < kTries; ++i) {
            const Vec2 floor = (pcg.two() - Vec2(0.5f, 0.5f)) * 0.6f;
            const RayStart at{{floor.x, floor.y, 0.0f}, {0, 0, 1}, 1e-6f};
            const auto shot = [&](const Vec3& w, uint32_t halvings) {
                return shoot(*world.scene, settings(), at, end, kind, w, halvings, stats);
            };
            const std::optional<ChainSolution> found =
                shot(normalize(end.p - at.p), settings().max_halvings);
            if (!found) continue;
            ++chains;
            const Vec3 w = normalize(found->chain.vertices[0].geometry.p - at.p);
            const Frame frame = Frame::around(w);
            const Vec2 off = (pcg.two() - Vec2(0.5f, 0.5f)) * 1e-3f;
            if (!shot(normalize(w + frame.x * off.x + frame.y * off.y), settings().seed_halvings))
                ++lost;
        }
        EXPECT_EQ(chains, kTries) << kind.count;
        EXPECT_EQ(lost, 0) << "of chains of " << kind.count;
    }
}
TEST(Shots, NextToAChainOfAWideSlabArriveForCertain) { expect_certain_shots(0.3f); }
TEST(Shots, NextToAChainOfAThinPaneArriveForCertain) { expect_certain_shots(1e-3f); }

// Two small balls magnify a turn at the receiver ten thousand times and more, and rounding with it.
// What a shot comes to lies within what rounding may do, but it must lead to the end, not beside
// it.
TEST(ShotsSlow, LeadToTheirEndHoweverMuchRoundingIsMagnified) {
    constexpr float kRadius = 0.01f, kBeside = 0.02f, kMiss = 2e-3f;  // m, rad, rad
    SceneMaker maker;
    for (const float x : {-0.5f, 0.5f})
        maker.add(test::sphere(64, double{kRadius}), test::mirror(),
                  test::translation({x, 0.0f, 1.0f}), CausticsRole::caster);
    test::add_lamp(maker, {0.0f, 0.0f, 3.0f}, {0.0f, 0.0f, 0.0f}, 0.05f);
    const RenderScene world = maker.finish();
    const RayStart x{{0.3f, -0.2f, 0.0f}, {0, 0, 1}, 1e-6f};
    const Caster& first = world.casters.casters[0];
    Pcg pcg(11);
    ManifoldStats stats;
    int chains = 0, found = 0;
    while (chains < 100) {
        const std::optional<Traced> path =
            follow(world, {x.p, towards_caster(first, x.p, pcg.two()), 1e-5f, kInfinity}, pcg);
        if (!path || path->kind.count != 2) continue;
        ++chains;
        const Vec3 w = normalize(path->vertices[0] - x.p);
        const Frame frame = Frame::around(path->ray.direction);
        const Vec3 beside = normalize(path->ray.direction + frame.x * kBeside);
        const ChainEnd end{false, path->vertices[1] + beside, Vec3(0.0f)};
        const std::optional<ChainSolution> one =
            shoot(*world.scene, settings(), x, end, path->kind, w, settings().max_halvings, stats);
        if (!one) continue;
        ++found;
        const DifferentialGeometry& last = one->chain.vertices[1].geometry;
        const Vec3 d = normalize(last.p - one->chain.vertices[0].geometry.p);
        const Vec3 out = d - last.n * (2.0f * dot(d, last.n));
        EXPECT_LT(length(out - normalize(end.p - last.p)), kMiss);
    }
    EXPECT_GT(found, chains / 20);
}

// Where light of a wavy mirror folds over, two chains of one kind meet: from each a shot across the
// fold comes to the other.
TEST(Shots, AcrossAFoldComeBack) {
    SceneMaker maker;
    maker.builder.add_image(test::plane_normals(1024, 0.5, 0.1, 5));
    add_mirror_beside(maker, test::normal_mapped(test::mirror(), Vec2(1.0f, 1.0f)));
    const ChainEnd end{false, {0.3f, -1.2f, 2.6f}, Vec3(0.0f)};
    test::add_lamp(maker, end.p, {0.0f, 0.2f, 0.8f}, 0.05f);
    const RenderScene world = maker.finish();
    Pcg pcg(9);
    ManifoldStats stats;
    int pairs = 0, back = 0;
    for (int i = 0; i < 60000; ++i) {
        const RayStart x{{1.6f * pcg.one() - 0.8f, 1.6f * pcg.one() - 0.8f, 0.0f}, {0, 0, 1}, 1e-6f};
        const std::optional<ChainSeed> start =
            sample_chain(*world.scene, settings(), x, world.casters, 0, pcg, stats);
        if (!start) continue;
        const std::optional<ChainSolution> one = shoot(
            *world.scene, settings(), x, end, start->kind, start->w, settings().max_halvings, stats);
        if (!one) continue;
        const auto across = [&](const ChainSolution& from, float step) {
            return shoot_across_fold(*world.scene, settings(), x, end, from, step,
                                     settings().max_halvings, stats);
        };
        constexpr float kStep = 1e-2f, kNear = 0.03f;  // rad
        const std::optional<ChainSolution> other = across(*one, kStep);
        if (!other || length(other->w - one->w) > kNear) continue;
        ++pairs;
        EXPECT_EQ(other->kind, one->kind);
        EXPECT_LT(other->determinant * one->determinant, 0.0f);
        EXPECT_FALSE(same_solution(settings(), *one, *other));
        const std::optional<ChainSolution> again = across(*other, kStep);
        if (again && same_solution(settings(), *one, *again)) ++back;
    }
    EXPECT_GT(pairs, 100);
    EXPECT_GE(back, pairs * 9 / 10);
}

// ---- MNEE seeds

// A mirror ball beside a slab of glass of two instances, an opaque square between slab and lamp.
struct MneeSeeds : testing::Test {
    MneeSeeds() {
        SceneMaker maker;
        maker.add(test::sphere(48, 0.5), test::mirror(), test::translation({2.0f, 0, 0.8f}),
                  CausticsRole::caster);
        for (const bool top : {false, true})
            maker.add(test::square(0.8f), test::glass(1.5f),
                      test::rotation_x(top ? 0.0f : kPi, {0, 0, top ? 0.9f : 0.5f}),
                      CausticsRole::caster);
        maker.add(test::square(0.8f), test::diffuse(0.8f), test::translation({0, 0, 1.2f}));
        test::add_lamp(maker, end.p, {0.0f, 0.0f, 0.8f}, 0.05f);
        world = maker.finish();
    }
    std::optional<ChainSeed> straight(const RayStart& from, const ManifoldSettings& limits) const {
        ManifoldStats stats;
        return straight_chain(*world.scene, limits, from, world.casters, end, stats);
    }

    const ChainEnd end{false, {0.3f, -0.2f, 2.6f}, Vec3(0.0f)};
    const RayStart x{{0.1f, 0.2f, 0.0f}, {0, 0, 1}, 1e-6f};
    RenderScene world;
};

TEST_F(MneeSeeds, RefractWhereTheStraightLineCrossesCasters) {
    const std::optional<ChainSeed> start = straight(x, settings());
    ASSERT_TRUE(start);
    ChainKind expected;
    expected.append({1, Interaction::refraction});
    expected.append({2, Interaction::refraction});
    EXPECT_EQ(start->kind, expected);
    EXPECT_LT(length(start->w - normalize(end.p - x.p)), 1e-6f);
    // From within the slab, beside it, and where a chain would be too long.
    const std::optional<ChainSeed> within =
        straight({{0.1f, 0.2f, 0.7f}, {0, 0, 1}, 1e-6f}, settings());
    ASSERT_TRUE(within);
    EXPECT_EQ(within->kind, expected.reversed().first(1));
    EXPECT_FALSE(straight({{2.0f, 2.0f, 0.0f}, {0, 0, 1}, 1e-6f}, settings()));
    ManifoldSettings single = settings();
    single.longest_chain = 1;
    EXPECT_FALSE(straight(x, single));
}

TEST_F(MneeSeeds, AreNotWhereOnlyMirrorsAreCrossed) {
    const Vec3 p = Vec3(2.0f, 0, 0.8f) * 2.0f - end.p;
    EXPECT_FALSE(straight({p, {0, 0, 1}, 1e-6f}, settings()));
}

// Snell's law in a slab: the ray leaves it as it came, shifted.
TEST_F(MneeSeeds, LeadToTheOneChainOfASlab) {
    const std::optional<ChainSeed> start = straight(x, settings());
    ASSERT_TRUE(start);
    ManifoldStats stats;
    const std::optional<ChainSolution> found = shoot(*world.scene, settings(), x, end, start->kind,
                                                     start->w, settings().max_halvings, stats);
    ASSERT_TRUE(found);
    const Vec3 below = normalize(found->chain.vertices[0].geometry.p - x.p),
               above = normalize(end.p - found->chain.vertices[1].geometry.p),
               inside = normalize(found->chain.vertices[1].geometry.p -
                                  found->chain.vertices[0].geometry.p);
    EXPECT_LT(length(below - above), 1e-4f);
    EXPECT_NEAR(std::hypot(below.x, below.y), 1.5f * std::hypot(inside.x, inside.y), 1e-4f);
}

TEST_F(MneeSeeds, ReflectFromTheMiddleOfABall) {
    const Caster& ball = world.casters.casters[0];
    const std::optional<ChainSeed> start = central_reflection(x, ball);
    ASSERT_TRUE(start);
    ManifoldStats stats;
    const std::optional<ChainSolution> found = shoot(*world.scene, settings(), x, end, start->kind,
                                                     start->w, settings().max_halvings, stats);
    ASSERT_TRUE(found);
    const DifferentialGeometry& at = found->chain.vertices[0].geometry;
    EXPECT_EQ(found->chain.vertices[0].interaction, Interaction::reflection);
    const Vec3 half = normalize(normalize(x.p - at.p) + normalize(end.p - at.p));
    EXPECT_LT(length(half - at.n), 1e-3f);
    EXPECT_FALSE(central_reflection({ball.center, {0, 0, 1}, 1e-6f}, ball));
}

// A path from the light to x, as a shot finds it that starts next to it.
std::optional<ChainSolution> shoot_back(const RenderScene& world, const RayStart& x,
                                        const ChainEnd& light, const Traced& path) {
    ManifoldStats stats;
    const std::optional<ChainSolution> found =
        shoot(*world.scene, settings(), x, light, path.kind.reversed(),
              normalize(path.vertices.back() - x.p), settings().max_halvings, stats);
    if (!found || !is_chain(*found, path.kind.reversed(), path.vertices.back(), path.vertices[0]))
        return std::nullopt;
    return found;
}

// Rays that leave the light evenly carry even shares of its light: those whose chain no chain seed
// finds from where they land are light that walks would have to find.
TEST(SheetsSlow, LeadToNearlyAllLight) {
    for (const CasterCase& c : cases()) {
        const RenderScene world = make(c);
        const EmissionGuide guide =
            aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_casters);
        const Budget budget;
        const SheetWorld parts{
            *world.scene, world.lights, world.casters, guide, kLongestManifoldChain, 1, budget};
        const std::optional<LightPoint> y =
            sample_light_point(world.lights, *world.scene, {0.5f, 0.5f, 0.5f});
        ASSERT_TRUE(y);
        constexpr uint32_t kEmissionCells = 128;
        constexpr float kProbabilityPerDensity = 1.0f;
        const LightSheet sheet(parts, *y, kEmissionCells, 0.0f);
        Pcg pcg(7);
        ManifoldStats stats;
        int chains = 0, missed = 0;
        double with_probability = 0.0;
        for (int i = 0; i < 40000 && chains < 4000; ++i) {
            const std::optional<Traced> path = follow(world, ray_at(guide, *y, pcg.two()), pcg);
            if (!path || std::isinf(path->ray.t_far)) continue;
            const RayStart x{path->ray.origin + path->ray.direction * path->ray.t_far,
                             Vec3(0, 0, 1), 1e-5f};
            if (std::abs(x.p.z) > 1e-4f) continue;
            ++chains;
            const std::optional<ChainSolution> own = shoot_back(world, x, {false, y->p, {}}, *path);
            const auto best_probability = [&](float u) {
                FoundChains found;
                shoot_seeds(*world.scene, settings(), sheet, x, *y, kProbabilityPerDensity, u,
                            found, stats);
                const FoundChain* one = own ? find_chain(settings(), found, *own) : nullptr;
                return one != nullptr ? one->probability : 0.0f;
            };
            const float probability = best_probability(0.0f);
            if (probability == 0.0f) {
                ++missed;
                continue;
            }
            // A uniform u finds it with that chance, and it says so.
            EXPECT_EQ(best_probability(0.99f * probability), probability);
            EXPECT_EQ(best_probability(probability), 0.0f);
            with_probability += probability < 1.0f ? 1.0 : 0.0;
        }
        std::cout << c.name << ": " << chains << " chains, missed " << missed << ", weak "
                  << with_probability << std::endl;
        EXPECT_GT(chains, 500) << c.name;
        EXPECT_LE(missed, c.missed_by_sheets * chains) << c.name;
    }
}

// Of the light that comes through a pane from all points of a lamp, past the edge of a board, the
// share whose chains no chain seed of its sheets finds.
double missed_beside_a_board(float lamp_radius) {
    SceneMaker maker;
    maker.add(test::square(3.0f), test::diffuse(0.8f));
    for (const bool top : {false, true})
        maker.add(test::square(1.0f), test::glass(1.5f),
                  test::rotation_x(top ? 0.0f : kPi, {0, 0, top ? 0.5f : 0.45f}),
                  CausticsRole::caster);
    maker.add(test::square(1.0f), test::diffuse(0.8f), test::translation({1.0f, 0, 1.0f}));
    LightDesc lamp;
    lamp.name = "lamp";
    lamp.type = LightType::point;
    lamp.to_world = test::translation({0, 0, 2.0f});
    lamp.power = Spectrum(100.0f);
    lamp.radius = lamp_radius;
    maker.builder.add_light(lamp);
    const RenderScene world = maker.finish();
    const EmissionGuide guide =
        aim_at_casters(*world.scene, world.lights, world.casters, Squares::of_casters);
    const SheetPool pool =
        build_sheets(*world.scene, world.lights, world.casters, settings(), 3, 128, 1);
    Pcg pcg(7);
    ManifoldStats stats;
    int chains = 0, missed = 0;
    while (chains < 4000) {
        const Vec2 u = pcg.two();
        const std::optional<LightPoint> y =
            sample_light_point(world.lights, *world.scene, {u.x, u.y, pcg.one()});
        const std::optional<Traced> path = follow(world, ray_at(guide, *y, pcg.two()), pcg);
        if (!path || path->vertices.empty() || std::isinf(path->ray.t_far)) continue;
        const RayStart x{path->ray.origin + path->ray.direction * path->ray.t_far, Vec3(0, 0, 1),
                         1e-5f};
        // Not by way of the pane's rim, where sheets end.
        if (std::abs(x.p.z) > 1e-4f || std::max(std::abs(x.p.x), std::abs(x.p.y)) > 0.8f) continue;
        ++chains;
        const LightSheet* sheet = nearest_sheet({pool}, *y);
        FoundChains found;
        shoot_seeds(*world.scene, settings(), *sheet, x, *y, 1.0f, 0.0f, found, stats);
        const std::optional<ChainSolution> own = shoot_back(world, x, {false, y->p, {}}, *path);
        if (!own || find_chain(settings(), found, *own) == nullptr) ++missed;
    }
    return static_cast<double>(missed) / chains;
}

// Where nothing folds over, a chain has the determinant whose sign its beam tells, whatever the
// light.
TEST(SheetsSlow, TellTheSignOfDeterminants) {
    const Vec3 above(0.3f, -0.4f, 3.0f), down = normalize(above) * -1.0f;
    const auto lamp = [](const LightDesc& light) {
        return [light](SceneMaker& maker) { maker.builder.add_light(light); };
    };
    const std::pair<const char*, std::function<void(SceneMaker&)>> lights[] = {
        {"point", lamp(test::point_lamp(10.0f, 0.0f, above))},
        {"sphere", lamp(test::point_lamp(10.0f, 0.05f, above))},
        {"rectangle", lamp(test::area_lamp(10.0f, AreaShape::rectangle, {0.1f, 0.1f}, above, down))},
        {"narrow beam",
         lamp(test::beam(test::area_lamp(10.0f, AreaShape::rectangle, {0.3f, 0.3f}, above, down),
                         0.1f))},
        {"parallel sun", lamp(test::sun_lamp(1.0f, 0.0f, down))},
        {"sun with a disc", lamp(test::sun_lamp(1.0f, 0.02f, down))},
        {"emissive mesh", [&](SceneMaker& maker) {
             maker.add(test::sphere(8, 0.05), test::emission(1, 1, 1, 5), test::translation(above));
         }}};
    for (const auto& [name, add] : lights) {
        SceneMaker maker;
        maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
        add_ball(maker, test::mirror());
        maker.add(test::square(0.8f), test::glass(1.3f), test::rotation_x(0.2f, {0, 0, 1.5f}),
                  CausticsRole::caster);
        add(maker);
        const RenderScene world = maker.finish();
        const SheetPool pool =
            build_sheets(*world.scene, world.lights, world.casters, settings(), 3, 128, 1);
        Pcg pcg(7);
        ManifoldStats stats;
        int right = 0, wrong = 0;
        for (int i = 0; i < 4000; ++i) {
            const RayStart x{
                {4.0f * pcg.one() - 2.0f, 4.0f * pcg.one() - 2.0f, 0.0f}, {0, 0, 1}, 1e-6f};
            const Vec2 u = pcg.two();
            const std::optional<LightPoint> y =
                sample_light_point(world.lights, *world.scene, {u.x, u.y, pcg.one()});
            const LightSheet* sheet = nearest_sheet({pool}, *y);
            std::vector<SheetSeed> chain_seeds;
            sheet->find_seeds(x.p, shift_between(sheet->light_point(), *y), 1.0f, 0.0f, chain_seeds);
            for (const SheetSeed& chain_seed : chain_seeds) {
                const std::optional<ChainSolution> found =
                    shoot(*world.scene, settings(), x, end_of(*y), *chain_seed.kind, chain_seed.w,
                          settings().max_halvings, stats);
                if (found && chain_seed.inside)
                    ++((found->determinant > 0.0f) == chain_seed.positive ? right : wrong);
            }
        }
        EXPECT_GT(right, 1000) << name;
        EXPECT_LT(wrong, right / 100) << name;
    }
}

// In narrow cones around some of them, as many fall as their density has there.
TEST(Folds, DirectionsHaveTheDensityOfTheirSamples) {
    SceneMaker maker;
    maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
    maker.builder.add_image(test::plane_normals(128, 0.25, 0.1, 5));
    add_mirror_beside(maker, test::normal_mapped(test::mirror(), Vec2(1.0f, 1.0f)));
    test::add_lamp(maker, {0.3f, -1.2f, 2.6f}, {0.0f, 0.2f, 0.8f}, 0.05f);
    const RenderScene world = maker.finish();
    const SheetPool pool =
        build_sheets(*world.scene, world.lights, world.casters, settings(), 3, 64, 1);
    constexpr float kCone = 2e-4f;  // 1 - cos, 0.02 rad
    constexpr int kDraws = 64;
    Pcg pcg(11);
    const auto draw = [&](const FoldDirections& folds) {
        const Vec2 u = pcg.two();
        return folds.sample({u.x, u.y, pcg.one()});
    };
    int next_to_folds = 0, beside = 0;
    double sum = 0.0, squares = 0.0;  // of differences
    double inside = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 x(1.6f * pcg.one() - 0.8f, 1.6f * pcg.one() - 0.8f, 0.0f);
        const FoldDirections folds({pool}, x);
        if (folds.empty()) continue;
        ++next_to_folds;
        const std::optional<Vec3> axis = draw(folds);
        ASSERT_TRUE(axis);
        EXPECT_NEAR(length(*axis), 1.0f, 1e-5f);
        beside += folds.pdf(*axis) > 0.0f ? 0 : 1;
        const Frame frame = Frame::around(*axis);
        double counted = 0.0, integral = 0.0;
        for (int k = 0; k < kDraws; ++k) {
            if (dot(*draw(folds), *axis) > 1.0f - kCone) counted += 1.0 / kDraws;
            const Vec3 w = frame.to_world(uniform_cone(pcg.two(), kCone));
            integral += static_cast<double>(folds.pdf(w) / uniform_cone_pdf(kCone)) / kDraws;
        }
        inside += counted;
        sum += integral - counted;
        squares += (integral - counted) * (integral - counted);
    }
    EXPECT_GT(next_to_folds, 1000);
    EXPECT_LE(
        beside,
        next_to_folds / 1000);  // of the parallelogram drawn, by rounding: no light is taken there
    EXPECT_GT(inside, 0.1 * next_to_folds);
    EXPECT_LT(inside, 0.95 * next_to_folds);
    EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(squares));
    std::cout << next_to_folds << " places, in the cones " << inside / next_to_folds
              << " of the directions, by their density " << (inside + sum) / next_to_folds << " +- "
              << std::sqrt(squares) / next_to_folds << std::endl;
}

// Lights that rays do not run into, without extent, have none.
TEST(Folds, AreOfLightsThatRaysFind) {
    const auto with_folds = [](float radius) {
        SceneMaker maker;
        maker.add(test::square(8.0f), test::diffuse(0.8f), {}, CausticsRole::receiver);
        add_ball(maker, test::glass(1.5f));
        maker.builder.add_light(test::point_lamp(10.0f, radius, {0.3f, -1.2f, 2.6f}));
        const RenderScene world = maker.finish();
        const SheetPool pool =
            build_sheets(*world.scene, world.lights, world.casters, settings(), 3, 64, 1);
        Pcg pcg(12);
        int count = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 x(1.6f * pcg.one() - 0.8f, 1.6f * pcg.one() - 0.8f, 0.0f);
            count += FoldDirections({pool}, x).empty() ? 0 : 1;
        }
        return count;
    };
    EXPECT_GT(with_folds(0.05f), 100);
    EXPECT_EQ(with_folds(0.0f), 0);
}

TEST(Sheets, LeadToLightOfPenumbras) {
    for (const float radius : {1e-4f, 0.1f})
        EXPECT_LT(missed_beside_a_board(radius), 0.001) << radius;
}

}  // namespace
}  // namespace spc
