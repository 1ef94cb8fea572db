// SPDX-License-Identifier: GPL-3.0-or-later
// Paths of light by way of rough casters, as each technique comes to describe them: their weights
// sum to one.
#include "integrator/history.h"
#include "integrator/light_path.h"

#include "light/bench.h"
#include "support/casters.h"
#include "support/lights.h"
#include "support/radiance.h"
#include "support/rough.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace spc::test {
namespace {

constexpr Vec3 kEye(0.0f, -3.0f, 2.0f);
constexpr Vec2 kLens(0.5f);
constexpr double kPaths = 0.1;  // of light: so few that all techniques have a share

// Where a path scatters, or turns.
struct Visit {
    Surface at;
    CameraSubpath camera_subpath;
    std::optional<CausticPath> before;  // RoughVisit::before
    Vec3 wi;
    bool rough;
};

// From the camera to a floor, by way of casters to a light.
struct Traced {
    Ray ray;  // of the camera
    std::vector<Visit> visits;
    std::vector<CausticVertex> vertices;  // beyond the floor
    PathHistory history;
    LightPoint y;

    const Visit& receiver() const { return visits.front(); }
    const Visit& last() const { return visits.back(); }
};

ChainEnd end_of(const LightPoint& y) { return {y.distant, y.p, y.direction}; }

class Bench {
public:
    // `wrong` is a factor of the density at x in the manifold's record.
    Bench(SceneMaker& maker, bool light_tracing, float wrong)
        : wrong_(wrong),
          world_(maker.finish()),
          guide_(aim_at_casters(*world_.scene, world_.lights, world_.casters, Squares::of_beams)) {
        settings_.manifold = unbiased_manifold();
        settings_.manifold.finder = ChainFinder::sheets;
        if (light_tracing) settings_.light_tracing = {&guide_, kPaths};
    }

    const Scene& scene() const { return *world_.scene; }
    const RenderScene& world() const { return world_; }
    float wrong() const { return wrong_; }
    Techniques techniques() const { return techniques_of(world_, settings_); }

    // As the integrator does, up to three vertices beyond the floor.
    std::optional<Traced> trace(uint32_t index) const {
        const Sampler sampler(7, index, 0);
        const Vec2 film = sampler[Domain::film].two();
        Traced path;
        path.ray = scene().camera.ray(film.x, film.y, kLens);
        Ray ray = path.ray;
        Vec3 from = ray.origin;
        for (uint32_t i = 0;; ++i) {
            const std::optional<Hit> hit = scene().accel->intersect(ray, kVisibleGlossy);
            if (!hit || hit->light != kNone) {
                if (path.vertices.empty() || !end_at(path, ray, hit)) return std::nullopt;
                return path;
            }
            Visit visit;
            evaluate_surface(scene(), hit->surface,
                             normalize(from - surface_position(scene(), hit->surface)), visit.at);
            const std::optional<ClosureSample> next =
                sample(visit.at.closures, visit.at.ng, visit.at.wo,
                       sampler.vertex(i)[Domain::closure].three());
            const bool on_caster = scene().instances[hit->surface.instance].turns_light();
            if (!next || on_caster == (i == 0) || i == 4 || !append(path, visit, *next))
                return std::nullopt;
            from = visit.at.p;
            ray = {offset_origin({from, visit.at.ng, visit.at.p_error}, next->wi), next->wi, 0.0f,
                   kInfinity};
        }
    }

    Receiver receiver(const Visit& visit, const Media& media) const {
        const Surface& at = visit.at;
        return {at.p,   at.p_error,   at.ng,
                at.wo,  &at.closures, 16,
                &media, at.hit,       visit.camera_subpath,
                {},     1.0f,         visit.before ? &*visit.before : nullptr};
    }

private:
    bool append(Traced& path, Visit& visit, const ClosureSample& next) const {
        const Surface& at = visit.at;
        PathHistory& history = path.history;
        history.set_next(scene(), at.p);
        visit.camera_subpath = history.camera_subpath_to(scene(), settings_.limits, at);
        if (path.visits.empty())
            visit.camera_subpath.film_density =
                scene().camera.view(at.p, kLens)->film_density * std::abs(dot(at.ng, at.wo));
        if (const CausticPath* before = history.chain_so_far()) visit.before = *before;
        visit.wi = next.wi;
        visit.rough = !next.delta;
        const Interaction turn =
            dot(at.ng, next.wi) > 0.0f ? Interaction::reflection : Interaction::refraction;
        if (!path.visits.empty())
            path.vertices.push_back({.hit = at.hit, .interaction = turn, .rough = visit.rough});
        path.visits.push_back(visit);
        if (next.delta) {
            history.append_delta(at.hit, next, world_.casters);
            return true;
        }
        std::optional<CausticVertex> vertex;
        if (path.visits.size() > 1) {
            vertex = rough_vertex(techniques(), at.hit, at.ng, next.wi);
            if (!vertex) return false;
        }
        history.append_rough(vertex);
        history.append_smooth(scene(), at, next, true, visit.camera_subpath, {});
        history.keep(at, visit.camera_subpath);
        return true;
    }

    bool end_at(Traced& path, const Ray& ray, const std::optional<Hit>& hit) const {
        const std::optional<LightPoint> y = light_point_met(world_, ray, hit);
        if (!y) return false;
        path.y = *y;
        float unused;
        path.visits.back().wi = end_of(path.y).from(path.last().at.p, unused);
        path.history.set_direction(scene(), path.last().wi);
        return true;
    }

    float wrong_;
    RenderScene world_;
    EmissionGuide guide_;
    IntegratorSettings settings_;
};

LightEnd light_end_of(const Bench& bench, const Traced& path) {
    LightEnd end = light_end(path.y, path.last().wi * -1.0f);
    end.pdf_direct = pdf_direct(bench.world().lights, bench.scene(), path.last().at.p, path.y);
    return end;
}

// By the manifold's own record of the chain with `vertices` from there.
std::optional<CausticDensities> by_manifold(const Bench& bench, const Visit& x,
                                            std::span<const CausticVertex> vertices,
                                            const LightEnd& end, bool rough_caster = false) {
    const Media media{};
    const Vec3 wi = vertices.empty()
                        ? x.wi
                        : normalize(surface_position(bench.scene(), vertices[0].hit) - x.at.p);
    CausticPath path = caustic_path(bench.scene(), bench.receiver(x, media),
                                    eval(x.at.closures, x.at.ng, x.at.wo, wi), wi);
    path.rough_caster = rough_caster;
    path.pdf_omega *= bench.wrong();
    for (const CausticVertex& vertex : vertices) path.append(vertex);
    if (is_black(chain_throughput(bench.scene(), path, end.end))) return std::nullopt;
    return caustic_densities(bench.techniques(), path, end);
}

// What rough chains leave of the light that comes to a visit by way of the vertices `behind`.
double left_at(const Bench& bench, const Visit& at, std::span<const CausticVertex> behind,
               const LightEnd& end) {
    if (!at.before) return 1.0;
    const RoughVisit visit{&*at.before, at.at.hit, at.at.closures, at.at.ng, at.at.wo};
    const Spectrum all = eval(at.at.closures, at.at.ng, at.at.wo, at.wi).f_cos,
                   left = left_by_rough_chains(bench.techniques(), visit, at.wi, kAllKinds, behind,
                                               end);
    return double(left.y / all.y);
}

// ---- chains with rough vertices: path tracing, the manifold, next event estimation

double sum_of_rough_chain(const Bench& bench, const Traced& path) {
    const Techniques techniques = bench.techniques();
    const LightEnd end = light_end_of(bench, path);
    const std::span vertices(path.vertices);
    const std::optional<CausticDensities> chain = by_manifold(bench, path.receiver(), vertices, end);
    const double by_chain = chain ? chain->manifold / chain->sum() : 0.0;
    const double left = 1.0 - double(rough_chain_share(techniques, path.history.rough_chain, end));
    // From the last rough vertex on the path is one of its own.
    size_t i = path.visits.size() - 1;
    while (!path.visits[i].rough) --i;
    const Visit& last = path.visits[i];
    const auto behind = vertices.subspan(i);
    const double left_there = left_at(bench, last, behind, end);
    if (behind.empty()) {
        const double pdf = double(eval(last.at.closures, last.at.ng, last.at.wo, last.wi).pdf_omega),
                     own = double(path.history.pdf_direct), direct = double(end.pdf_direct);
        return by_chain + left * own / (own + direct) + left_there * direct / (direct + pdf);
    }
    CausticPath record = path.history.caustic;
    chain_throughput(bench.scene(), record, end.end);
    const auto by_path = caustic_densities(techniques, record, end),
               by_walks = by_manifold(bench, last, behind, end);
    return by_chain + left * by_path->path_tracing / by_path->sum() +
           left_there * by_walks->manifold / by_walks->sum();
}

// ---- light that comes straight to a rough caster, and by way of deltas from there to the floor:
// path tracing, next event estimation, light paths

std::optional<double> sum_of_thrown_on(const Bench& bench, const Traced& path) {
    const Scene& scene = bench.scene();
    const LightEnd end = light_end_of(bench, path);
    const Visit &x = path.last(), &z = path.receiver();
    const std::optional<CausticDensities> by_path = caustic_densities(bench.techniques(),
                                                                      path.history.caustic, end),
                                          by_connection = by_manifold(bench, x, {}, end, true);
    LightHistory history;
    size_t i = path.visits.size() - 1;
    const Vec3 towards = normalize(path.visits[i - 1].at.p - x.at.p),
               eye = normalize(path.ray.origin - z.at.p);
    Surface from_light, from_floor, seen;
    evaluate_surface(scene, x.at.hit, x.wi, from_light);
    evaluate_surface(scene, x.at.hit, towards, from_floor);
    evaluate_surface(scene, z.at.hit, eye, seen);
    const auto first = history.arrive(scene, end.end, kVisibleAll, from_floor);
    if (!first) return std::nullopt;
    history.append_smooth(
        from_floor, *first,
        eval(from_light.closures, from_light.ng, from_light.wo, towards).pdf_omega);
    while (--i > 0) {
        ClosureSample turn{};
        turn.delta = turn.on_caster_normal = true;
        turn.refracted = path.vertices[i - 1].interaction == Interaction::refraction;
        if (!history.append_delta(path.visits[i].at, turn, bench.world().casters))
            return std::nullopt;
    }
    auto arrival = history.arrive(scene, end.end, kVisibleAll, seen);
    if (!arrival) return std::nullopt;
    arrival->path.film_density *=
        scene.camera.view(z.at.p, kLens)->film_density * std::abs(dot(seen.ng, eye));
    const auto by_light = caustic_densities(bench.techniques(), arrival->path, end);
    return by_path->path_tracing / by_path->sum() + by_connection->direct / by_connection->sum() +
           by_light->light_tracing / by_light->sum();
}

// ---- scenes

using Add = std::function<void(SceneMaker&)>;
std::vector<std::pair<const char*, Add>> lights() {
    const Vec3 above(0.5f, -0.6f, 1.9f);
    const auto lamp = [](LightDesc light) {
        light.visibility = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;
        return [light](SceneMaker& m) { m.builder.add_light(light); };
    };
    return {{"sphere", lamp(point_lamp(10.0f, 0.3f, above))},
            {"rectangle", lamp(area_lamp(10.0f, AreaShape::rectangle, {0.9f, 0.6f}, above,
                                         normalize(Vec3(-0.4f, 0.5f, -1.0f))))},
            {"sun", lamp(sun_lamp(1.0f, 0.4f, normalize(Vec3(-0.3f, 0.4f, -1.0f))))}};
}
std::vector<std::pair<const char*, Add>> casters() {
    const auto add = [](SceneMaker& m, const Mesh& mesh, const Graph& graph, const Transform& t) {
        m.add(mesh, graph, t, CausticsRole::caster);
    };
    return {{"metal",
             [add](SceneMaker& m) {
                 add(m, square(0.7f), metal(0.15f), rotation_x(1.3f, {0.2f, 0.9f, 0.6f}));
                 add(m, sphere(24, 0.4), metal(0.25f), translation({-0.5f, 0.1f, 0.7f}));
             }},
            {"frosted glass",
             [add](SceneMaker& m) {
                 add(m, sphere(24, 0.4), frosted_glass(0.2f), translation({-0.2f, 0.0f, 0.8f}));
             }},
            {"metal beside mirror and glass",
             [add](SceneMaker& m) {
                 add(m, square(0.7f), metal(0.12f), rotation_x(1.3f, {0.2f, 0.9f, 0.6f}));
                 add(m, square(0.5f), mirror(), rotation_x(-1.2f, {0.0f, -0.9f, 0.8f}));
                 add(m, square(0.5f), refraction(1.3f), rotation_x(0.2f, {0.3f, 0.1f, 0.9f}));
             }},
            {"frosted pane over a clear one", [add](SceneMaker& m) {
                 add(m, square(0.5f), refraction(1.3f), translation({0.2f, 0.2f, 0.6f}));
                 add(m, square(0.5f), refraction(1.3f, 0.15f), translation({0.3f, 0.0f, 0.8f}));
             }}};
}

void add_floor(SceneMaker& maker) {
    const Graph satin = combined(diffuse(0.8f), metal(0.5f), 0.4f);
    maker.add(square(4.0f), satin, {}, CausticsRole::receiver);
    Camera camera;
    camera.to_world = rotation_x(std::atan2(-kEye.y, kEye.z), kEye);
    camera.viewplane = {-0.3f, 0.3f, -0.3f, 0.3f};
    maker.builder.set_camera(camera);
}

// ---- tests

// Letters, from the floor on: a rough vertex, a delta.
std::string kind_of(const Traced& path) {
    std::string kind;
    for (const CausticVertex& vertex : path.vertices) kind += vertex.rough ? 'r' : 'd';
    return kind;
}

// How far the sum is from one.
using Deviations = std::map<std::string, std::vector<double>>;
template <class Sum>
Deviations deviations(bool light_tracing, float wrong, const Sum& sum_of) {
    constexpr uint32_t kTries = 200000;
    Deviations result;
    for (const auto& [caster, add_caster] : casters())
        for (const auto& [light, add_light] : lights()) {
            SceneMaker maker;
            add_floor(maker);
            add_caster(maker);
            add_light(maker);
            const Bench bench(maker, light_tracing, wrong);
            for (uint32_t i = 0; i < kTries; ++i)
                if (const std::optional<Traced> path = bench.trace(i))
                    if (const std::optional<double> sum = sum_of(bench, *path))
                        result[kind_of(*path)].push_back(std::abs(*sum - 1.0));
        }
    return result;
}

std::optional<double> sum_if_rough(const Bench& bench, const Traced& path) {
    if (kind_of(path).find('r') == std::string::npos) return std::nullopt;
    return sum_of_rough_chain(bench, path);
}
std::optional<double> sum_if_thrown_on(const Bench& bench, const Traced& path) {
    const std::string kind = kind_of(path);
    if (kind != "r" && kind != "dr") return std::nullopt;
    return sum_of_thrown_on(bench, path);
}

constexpr double kRounding = 1e-5;
const std::set<std::string> kChains{"r", "rr", "rd", "dr"};

double largest(const Deviations& all, const std::string& kind) {
    const auto found = all.find(kind);
    if (found == all.end() || found->second.size() < 20) {
        ADD_FAILURE() << "too few paths of kind " << kind;
        return 0.0;
    }
    return *std::max_element(found->second.begin(), found->second.end());
}

TEST(RoughCausticWeightsSlow, OfRoughChainsSumToOne) {
    const Deviations all = deviations(false, 1.0f, sum_if_rough);
    for (const std::string& kind : kChains) EXPECT_LE(largest(all, kind), kRounding) << kind;
}
TEST(RoughCausticWeightsSlow, OfLightThatRoughCastersThrowOnSumToOne) {
    const Deviations all = deviations(true, 1.0f, sum_if_thrown_on);
    for (const char* kind : {"r", "dr"}) EXPECT_LE(largest(all, kind), kRounding) << kind;
}

// A record that differs by a hundredth shows.
TEST(RoughCausticWeightsSlow, ComparisonNoticesAWrongRecord) {
    const Deviations chains = deviations(false, 1.01f, sum_if_rough),
                     thrown_on = deviations(true, 1.01f, sum_if_thrown_on);
    for (const std::string& kind : kChains)
        EXPECT_GT(largest(chains, kind), 100.0 * kRounding) << kind;
    EXPECT_GT(largest(thrown_on, "r"), 100.0 * kRounding);
}

}  // namespace
}  // namespace spc::test
