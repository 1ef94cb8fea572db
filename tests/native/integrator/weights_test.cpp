// SPDX-License-Identifier: GPL-3.0-or-later
// One path of light as each technique comes to describe it: their weights sum to one.
#include "integrator/history.h"
#include "integrator/light_path.h"

#include "light/bench.h"
#include "support/casters.h"
#include "support/lights.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

#include <map>

namespace spc::test {
namespace {

// Of lights that are seen in casters alone: what a path finds came by way of one.
constexpr uint32_t kInCasters = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;
constexpr Vec3 kEye(0.0f, -3.0f, 2.0f);
constexpr Vec2 kLens(0.5f);
constexpr double kPaths = 0.03;  // of light: so few that all techniques have a share

IntegratorSettings settings_for(const EmissionGuide* guide) {
    IntegratorSettings settings;
    settings.limits = {16, 3, 16, 16, 16};
    if (guide == nullptr) return settings;
    settings.manifold = unbiased_manifold();
    settings.manifold.two_stage = false;
    settings.light_tracing = {guide, kPaths};
    return settings;
}

// A path from the camera through `scatterings` + 1 smooth vertices and a chain to a light.
struct Traced {
    Ray ray;                           // of the camera
    std::vector<Surface> smooth;       // camera's order
    std::vector<CausticVertex> chain;  // receiver's order
    std::vector<Vec3> corners;         // its vertices
    PathHistory history;
    LightPoint y;
    double share;  // of path tracing, by what it makes of the path itself
};

class Bench {
public:
    explicit Bench(SceneMaker& maker)
        : world_(maker.finish()),
          guide_(aim_at_casters(*world_.scene, world_.lights, world_.casters, Squares::of_beams)) {}

    const RenderScene& world() const { return world_; }
    Techniques techniques(const IntegratorSettings& settings) const {
        return techniques_of(world_, settings);
    }
    const EmissionGuide* guide() const { return &guide_; }

    // By the random numbers that the integrator uses.
    std::optional<Traced> trace(uint32_t index) const {
        const Scene& scene = *world_.scene;
        const Sampler sampler(7, index, 0);
        const Vec2 film = sampler[Domain::film].two();
        Traced path;
        path.ray = scene.camera.ray(film.x, film.y, kLens);
        Ray ray = path.ray;
        Vec3 from = ray.origin;
        for (uint32_t vertex = 0;; ++vertex) {
            const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleGlossy);
            if (hit && hit->light == kNone && !shines(*hit)) {
                Surface surface;
                evaluate_surface(scene, hit->surface,
                                 normalize(from - surface_position(scene, hit->surface)), surface);
                const std::optional<ClosureSample> next =
                    sample(surface.closures, surface.ng, surface.wo,
                           sampler.vertex(vertex)[Domain::closure].three());
                if (!next || !append(path, surface, *next)) return std::nullopt;
                from = surface.p;
                ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi,
                       0.0f, kInfinity};
                continue;
            }
            if (path.chain.empty() || !end_at(path, ray, hit)) return std::nullopt;
            break;
        }
        return weigh(path, sampler) ? std::optional(path) : std::nullopt;
    }

private:
    bool shines(const Hit& hit) const {
        return world_.lights.emissive_of_instance[hit.surface.instance] != kNone;
    }

    bool append(Traced& path, const Surface& surface, const ClosureSample& next) const {
        if (!next.delta) {
            if (!path.chain.empty() || path.smooth.size() == 3) return false;
            path.history.set_next(*world_.scene, surface.p);
            CameraApproach approach = path.history.approach_to(surface);
            if (path.smooth.empty()) {
                const std::optional<CameraView> view = world_.scene->camera.view(surface.p, kLens);
                approach.film_per_area = view->film_per_area * std::abs(dot(surface.ng, surface.wo));
            }
            path.history.append_smooth(*world_.scene, surface, next, true, approach, {});
            path.history.keep(surface, approach);
            path.smooth.push_back(surface);
            return true;
        }
        if (path.smooth.empty() || path.chain.size() == 3) return false;
        path.chain.push_back(
            {surface.hit, next.refracted ? Interaction::refraction : Interaction::reflection});
        path.corners.push_back(surface.p);
        return true;
    }

    bool end_at(Traced& path, const Ray& ray, const std::optional<Hit>& hit) const {
        const std::optional<LightPoint> y = light_point_met(world_, ray, hit);
        if (y) path.y = *y;
        return y.has_value();
    }

    // The integrator itself, with all techniques and with none, but for light that comes otherwise:
    // what path tracing is left with.
    bool weigh(Traced& path, const Sampler& sampler) const {
        const auto bounces = static_cast<uint32_t>(path.smooth.size() + path.chain.size());
        const auto radiance = [&](const EmissionGuide* guide, uint32_t total) {
            IntegratorSettings settings = settings_for(guide);
            settings.limits.total = total;
            PathStats stats;
            const PassState none{{0.0f, 0.0f, 0.0f}};
            return double(
                path_radiance(world_, settings, none, path.ray, kLens, sampler, stats).radiance.y);
        };
        const double otherwise = radiance(nullptr, bounces - 2),
                     whole = radiance(nullptr, bounces - 1) - otherwise;
        path.share = (radiance(guide(), bounces - 1) - otherwise) / whole;
        return whole > 0.0;  // the roulette let it live, the light shines that way
    }

    RenderScene world_;
    EmissionGuide guide_;
};

ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }
Vec3 leaving(const LightPoint& y, const Vec3& last) {
    return y.distant ? y.direction * -1.0f : normalize(last - y.p);
}

// What the manifold makes of the path, if a walk from its vertex finds it. Empty where not.
std::optional<CausticDensities> by_manifold(const Bench& bench, const IntegratorSettings& settings,
                                            const Traced& path) {
    const Scene& scene = *bench.world().scene;
    const Surface& x = path.smooth.back();
    const uint32_t caster = bench.world().casters.of_instance[path.chain[0].hit.instance];
    const ChainQuery query{x.p, end_of(path.y), &bench.world().casters.casters[caster]};
    ManifoldStats stats;
    const std::optional<Seed> seed = seed_at(scene, settings.manifold, query, path.chain[0].hit);
    const std::optional<ChainRoot> root =
        seed ? walk_from(scene, settings.manifold, query, *seed, stats) : std::nullopt;
    if (!root || root->interaction != path.chain[0].interaction) return std::nullopt;
    if (length(root->patch.p - path.corners[0]) > 1e-4f) return std::nullopt;
    // As path tracing comes to its receiver.
    PathHistory before;
    BounceCounts bounces{};
    CameraApproach approach{};
    for (const Surface& surface : path.smooth) {
        const bool first = &surface == &path.smooth.front();
        approach = before.approach_to(surface);
        if (first)
            approach.film_per_area = scene.camera.view(surface.p, kLens)->film_per_area *
                                     std::abs(dot(surface.ng, surface.wo));
        if (&surface == &x) break;
        ClosureSample next{};
        next.wi = normalize((&surface + 1)->p - surface.p);
        next.pdf_omega = eval(surface.closures, surface.ng, surface.wo, next.wi).pdf_omega;
        before.append_smooth(scene, surface, next, true, approach, bounces);
        before.keep(surface, approach);
        before.set_direction(scene, next.wi);
        bounces.add(BounceKind::diffuse);
    }
    const Media media{};
    const Receiver receiver{x.p,    x.p_error, x.ng,     x.wo,    &x.closures, 16,
                            &media, x.hit,     approach, bounces, 1.0f,        nullptr};
    const Vec3 wi = normalize(path.corners[0] - x.p);
    CausticPath record = caustic_path(scene, receiver, eval(x.closures, x.ng, x.wo, wi), wi);
    record.append(path.chain[0]);
    if (is_black(chain_throughput(scene, record, end_of(path.y)))) return std::nullopt;
    return caustic_densities(bench.techniques(settings), record,
                             light_end(path.y, leaving(path.y, path.corners[0])));
}

// What a light path makes of it that leaves the light for its last vertex. Its rays meet the path's
// vertices but for rounding, which is not to be told from a wrong record next to folds: the record is
// of the path's own. Empty where rounding leads it elsewhere.
std::optional<CausticDensities> by_light(const Bench& bench, const IntegratorSettings& settings,
                                         const Traced& path, float wrong) {
    const Scene& scene = *bench.world().scene;
    const Vec3 away = leaving(path.y, path.corners.back());
    Ray ray{path.y.distant ? path.corners.back() - away * 10.0f : path.y.p, away, 0.0f, kInfinity};
    if (path.y.surface.instance != kNone)
        ray.origin =
            offset_origin({path.y.p, path.y.n,
                           position_error(scene, path.y.surface.instance, path.y.surface.triangle)},
                          away);
    const LightEnd end = light_end(path.y, away);
    LightHistory history;
    Pcg pcg(3);
    Surface surface;
    Vec3 from = end.end.p;
    // Whether it comes there, where it then is.
    const auto comes_to = [&](const Vec3& p, const SurfaceHit& there, float accuracy) {
        std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleGlossy);
        for (; hit && hit->light != kNone; hit = scene.accel->intersect(ray, kVisibleGlossy))
            ray.t_near = past(hit->t);
        if (!hit || length(surface_position(scene, hit->surface) - p) > accuracy) return false;
        const bool from_afar = end.end.distant && &there == &path.chain.back().hit;
        evaluate_surface(scene, there, from_afar ? ray.direction * -1.0f : normalize(from - p),
                         surface);
        from = p;
        return true;
    };
    for (size_t k = path.chain.size(); k-- > 0;) {
        if (!comes_to(path.corners[k], path.chain[k].hit, 1e-4f)) return std::nullopt;
        const bool refracted = path.chain[k].interaction == Interaction::refraction;
        std::optional<ClosureSample> next;
        for (int tries = 0; tries < 1000 && !(next && next->refracted == refracted); ++tries)
            next = sample(surface.closures, surface.ng, surface.wo, {pcg.one(), 0.5f, 0.5f});
        if (!next || !history.append_delta(surface, *next, bench.world().casters))
            return std::nullopt;
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi, 0.0f,
               kInfinity};
    }
    for (size_t i = path.smooth.size(); i-- > 0;) {
        if (!comes_to(path.smooth[i].p, path.smooth[i].hit, 1e-3f)) return std::nullopt;
        const Vec3 target = i > 0 ? path.smooth[i - 1].p : path.ray.origin;
        const Vec3 towards = normalize(target - surface.p);
        Surface from_camera;
        evaluate_surface(scene, surface.hit, towards, from_camera);
        std::optional<LightHistory::Arrival> arrival =
            history.arrive(scene, end.end, kVisibleAll, from_camera);
        if (!arrival) return std::nullopt;
        if (i == 0) {
            arrival->path.film_per_area *= wrong *
                                           scene.camera.view(surface.p, kLens)->film_per_area *
                                           std::abs(dot(surface.ng, towards));
            return caustic_densities(bench.techniques(settings), arrival->path, end);
        }
        const float pdf = eval(surface.closures, surface.ng, surface.wo, towards).pdf_omega;
        history.append_smooth(from_camera, *arrival, pdf);
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, towards), towards, 0.0f,
               kInfinity};
    }
    return std::nullopt;
}

double sum_of(const CausticDensities& p) { return p.path_tracing + p.manifold + p.light_tracing; }

LightDesc seen_in_casters(LightDesc light) {
    light.visibility = kInCasters;
    return light;
}
struct LightCase {
    const char* name;
    std::function<void(SceneMaker&)> add;
};
std::vector<LightCase> lights() {
    const Vec3 above(0.5f, -0.6f, 1.9f);
    const auto lamp = [](const char* name, const LightDesc& light) {
        return LightCase{
            name, [light = seen_in_casters(light)](SceneMaker& m) { m.builder.add_light(light); }};
    };
    return {lamp("sphere", point_lamp(10.0f, 0.3f, above)),
            lamp("rectangle", area_lamp(10.0f, AreaShape::rectangle, {0.9f, 0.6f}, above,
                                        normalize(Vec3(-0.4f, 0.5f, -1.0f)))),
            lamp("sun", sun_lamp(1.0f, 0.4f, normalize(Vec3(-0.3f, 0.4f, -1.0f))))};
}

struct CasterCase {
    const char* name;
    std::function<void(SceneMaker&)> add;
};
std::vector<CasterCase> casters() {
    const auto add = [](SceneMaker& m, const Mesh& mesh, const Graph& graph, const Transform& t) {
        m.add(mesh, graph, t, CausticsRole::caster);
    };
    return {
        {"mirrors",
         [add](SceneMaker& m) {
             add(m, sphere(24, 0.4), mirror(), translation({-0.5f, 0.1f, 0.7f}));
             add(m, square(0.7f), mirror(), rotation_x(1.3f, {0.2f, 0.9f, 0.6f}));
         }},
        {"glass",
         [add](SceneMaker& m) {
             add(m, sphere(24, 0.4), glass(1.5f), translation({-0.2f, 0.0f, 0.8f}));
             add(m, square(0.5f), refraction(1.3f), rotation_x(0.2f, {0.5f, 0.3f, 0.5f}));
         }},
        {"mapped mirror and glass", [add](SceneMaker& m) {
             m.builder.add_image(plane_normals(64, 0.4, 0.03, 5));
             const Mesh panel = with_uvs(
                 grid(
                     1, [](double u, double v) { return Vec3d(1.4 * u - 0.7, 1.4 * v - 0.7, 0); },
                     [](double, double) { return Vec3d(0, 0, 1); }),
                 1);
             add(m, panel, normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
                 rotation_x(1.3f, {0.0f, 0.9f, 0.6f}));
             add(m, panel, normal_mapped(glass(1.4f), Vec2(1.0f, 1.0f)),
                 rotation_x(0.2f, {0.0f, 0.0f, 0.7f}));
         }}};
}

// A floor and a wall, both partly glossy: the densities there and back differ.
void add_receivers(SceneMaker& maker) {
    const Graph satin = combined(diffuse(0.8f),
                                 single_shader("bsdf_glossy", {{1, "Color", {0.8f, 0.8f, 0.8f, 1}},
                                                               {1, "Roughness", {0.5f, 0, 0, 0}}}),
                                 0.4f);
    maker.add(square(4.0f), satin, {}, CausticsRole::receiver);
    maker.add(square(4.0f), satin, rotation_x(0.5f * kPi, {0.0f, 1.6f, 0.0f}),
              CausticsRole::receiver);
    Camera camera;
    camera.to_world = rotation_x(std::atan2(-kEye.y, kEye.z), kEye);
    camera.viewplane = {-0.3f, 0.3f, -0.3f, 0.3f};
    maker.builder.set_camera(camera);
}

// How far the weights' sum is from one, by the number of smooth vertices and of interactions.
// `wrong` is a factor of film_per_area in the light path's record.
using Deviations = std::map<std::array<size_t, 2>, std::vector<double>>;
Deviations deviations(uint32_t tries, float wrong = 1.0f) {
    Deviations result;
    for (const CasterCase& caster : casters())
        for (const LightCase& light : lights()) {
            SceneMaker maker;
            add_receivers(maker);
            caster.add(maker);
            light.add(maker);
            const Bench bench(maker);
            const IntegratorSettings settings = settings_for(bench.guide());
            int found = 0, missed = 0;
            for (uint32_t i = 0; i < tries; ++i) {
                const std::optional<Traced> path = bench.trace(i);
                if (!path) continue;
                ++found;
                const bool walks = path->chain.size() == 1;
                const std::optional<CausticDensities> by_lt =
                                                          by_light(bench, settings, *path, wrong),
                                                      by_walk = walks ? by_manifold(bench, settings,
                                                                                    *path)
                                                                      : CausticDensities{};
                if (!by_lt || !by_walk) {
                    ++missed;
                    continue;
                }
                const double sum = path->share + by_lt->light_tracing / sum_of(*by_lt) +
                                   (walks ? by_walk->manifold / sum_of(*by_walk) : 0.0);
                result[{path->smooth.size(), path->chain.size()}].push_back(std::abs(sum - 1.0));
            }
            EXPECT_GT(found, 0) << caster.name << " under " << light.name;
            EXPECT_LE(missed, found / 10) << caster.name << " under " << light.name;
        }
    return result;
}

double largest(const std::vector<double>& deviations) {
    return *std::max_element(deviations.begin(), deviations.end());
}

constexpr double kRounding = 1e-5;

TEST(CausticWeightsSlow, SumToOneOverTheirOwnRecords) {
    const Deviations all = deviations(600000);
    EXPECT_GE(all.size(), 7u);  // one to three of both, few of which have three twice
    for (const auto& [kind, found] : all) {
        const std::string what = std::to_string(kind[0]) + " smooth vertices, " +
                                 std::to_string(kind[1]) + " interactions, " +
                                 std::to_string(found.size()) + " paths";
        EXPECT_GE(found.size(), 20u) << what;
        EXPECT_LE(largest(found), kRounding) << what;
    }
}

// What path tracing, walks and light paths have of a chain that sheets miss.
TEST(CausticWeightsSlow, OfMissedChainsSumToOne) {
    constexpr double kPointPdf = 3.0;  // of the light point
    CausticDensities p;
    p.geometry = 0.7;
    p.path_tracing = 0.01;
    p.manifold = 0.4;
    p.light_tracing = 0.2;
    p.missed = CausticDensities::kMissedWorth * kPointPdf;
    ASSERT_TRUE(p.missed_are_apart());
    const double walks = p.missed_scale() / p.geometry * kPointPdf;
    EXPECT_NEAR(p.path_tracing_weight(true) + walks + p.light_tracing / sum_of(p), 1.0, 1e-12);
    EXPECT_GT(p.path_tracing_weight(true), p.path_tracing_weight(false));
    EXPECT_GT(walks, 0.0);
}

// What fixed starts miss is path tracing's alone, but for the share of light paths.
TEST(CausticWeightsSlow, OfChainsThatFixedStartsMissSumToOne) {
    CausticDensities p;
    p.geometry = 0.7;
    p.light_tracing = 0.2;
    p.missed = 0.0;
    for (const double path_tracing : {0.0, 0.01, 4.0}) {  // of a lamp without shadow; usual ones
        p.path_tracing = path_tracing;
        p.manifold = 0.4;
        ASSERT_TRUE(p.missed_are_apart());
        EXPECT_NEAR(p.path_tracing_weight(true) + p.light_tracing / sum_of(p), 1.0, 1e-12);
        EXPECT_NEAR(p.path_tracing_weight(false) + (p.manifold + p.light_tracing) / sum_of(p), 1.0,
                    1e-12);
    }
}

// A record that differs by a hundredth shows.
TEST(CausticWeightsSlow, ComparisonNoticesAWrongRecord) {
    for (const auto& [kind, found] : deviations(200000, 1.01f))
        EXPECT_GT(largest(found), 100.0 * kRounding);
}

}  // namespace
}  // namespace spc::test
