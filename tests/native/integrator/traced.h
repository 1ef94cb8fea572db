// SPDX-License-Identifier: GPL-3.0-or-later
// Single paths of light as path tracing comes upon them, and as each other technique describes
// them.
#pragma once

#include "integrator/history.h"
#include "integrator/light_path.h"

#include "light/bench.h"
#include "manifold/found_chains.h"
#include "support/casters.h"
#include "support/lights.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc::test {

// Of lights that are seen in casters alone: what a path finds came by way of one.
inline constexpr uint32_t kInCasters = kVisibleGlossy | kVisibleTransmission | kVisibleShadow;
inline constexpr Vec3 kEye(0.0f, -3.0f, 2.0f);
inline constexpr Vec2 kLens(0.5f);
inline constexpr double kPaths = 0.03;  // of light: so few that all techniques have a share
inline constexpr double kMeanSearchTrials = 3.0;  // sheets take to find what light paths find
inline constexpr double kWalks = 0.25;  // of the receivers to which light paths come have walks

inline constexpr BounceLimits kLimits{16, 3, 16, 16, 16};

// Probability that a dielectric, or what only reflects or refracts, turns unpolarised light so.
inline double lobe_probability(const Scene& scene, const Surface& surface,
                               const ClosureSample& next) {
    const SpecularInterface& interface = scene.material_of(surface.hit).interface();
    if (!(interface.reflects && interface.refracts)) return 1.0;
    const Vec3 front = front_normal(scene, surface.hit.instance, surface.hit.triangle);
    const double ior = double(eta_seen_from(front, surface.wo, interface.ior)),
                 cos_i = std::abs(double(dot(surface.n, surface.wo))),
                 cos2_t = 1.0 - (1.0 - cos_i * cos_i) / (ior * ior);
    if (cos2_t <= 0.0) return 1.0;
    const double cos_t = std::sqrt(cos2_t);
    const double s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t),
                 p = (cos_t - ior * cos_i) / (cos_t + ior * cos_i);
    const double reflected = 0.5 * (s * s + p * p);
    return next.refracted ? 1.0 - reflected : reflected;
}

// Casters between two smooth vertices, or the last one and the light: camera's order.
struct Stretch {
    std::vector<CausticVertex> chain;
    std::vector<Vec3> corners;  // its vertices
};
// A path from the camera through smooth vertices and a chain to a light.
struct Traced : Stretch {
    Ray ray;                       // of the camera
    std::vector<Surface> smooth;   // camera's order
    std::vector<Stretch> between;  // smooth vertices, one less of them
    PathHistory history;
    LightPoint y;
    double share;     // of path tracing, by what it makes of the path itself
    double p_camera;  // of its scattering at the receiver, 1/sr, times the probabilities of its lobes
};

class Bench {
public:
    // With sheets there are some `emission_cells` parts of them: the fewer there are, the more they
    // miss.
    Bench(SceneMaker& maker, ChainFinder finder, uint32_t emission_cells)
        : Bench(maker.finish(), finder, emission_cells) {}
    Bench(RenderScene world, ChainFinder finder, uint32_t emission_cells)
        : world_(std::move(world)),
          guide_(aim_at_casters(*world_.scene, world_.lights, world_.casters, Squares::of_beams)) {
        settings_.limits = kLimits;
        settings_.manifold = unbiased_manifold();
        settings_.manifold.two_stage = false;
        settings_.manifold.finder = finder;
        settings_.manifold.trial_cap = 1;  // else sums of weights are one on average alone
        settings_.light_tracing = {&guide_, kPaths, 1.0, kMeanSearchTrials, 1.0, kWalks};
        if (finder != ChainFinder::sheets) return;
        constexpr uint32_t kSeed = 5;
        sheets_ = build_sheets(*world_.scene, world_.lights, world_.casters, settings_.manifold,
                               kSeed, emission_cells, 1);
    }

    const RenderScene& world() const { return world_; }
    const IntegratorSettings& settings() const { return settings_; }
    Techniques techniques() const { return techniques_of(world_, settings_); }
    LightSheets sheets() const { return {sheets_}; }

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
        path.history.set_next(*world_.scene, surface.p);
        if (!next.delta) {
            if (path.smooth.size() == 3) return false;
            CameraSubpath camera_subpath =
                path.history.camera_subpath_to(*world_.scene, kLimits, surface);
            if (!path.smooth.empty()) {
                path.between.push_back(path);
                static_cast<Stretch&>(path) = {};
            } else {
                const std::optional<CameraView> view = world_.scene->camera.view(surface.p, kLens);
                camera_subpath.film_density =
                    view->film_density * std::abs(dot(surface.ng, surface.wo));
            }
            path.history.append_smooth(*world_.scene, surface, next, true, camera_subpath, {});
            path.history.keep(surface, camera_subpath);
            path.smooth.push_back(surface);
            path.p_camera = double(next.pdf_omega);
            return true;
        }
        if (path.smooth.empty() || path.chain.size() == 3) return false;
        path.chain.push_back(
            {surface.hit, next.refracted ? Interaction::refraction : Interaction::reflection});
        path.corners.push_back(surface.p);
        path.history.append_delta(surface.hit, next, world_.casters);
        path.p_camera *= lobe_probability(*world_.scene, surface, next);
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
        size_t vertices = path.smooth.size() + path.chain.size();
        for (const Stretch& stretch : path.between) vertices += stretch.chain.size();
        const auto bounces = static_cast<uint32_t>(vertices);
        const RoundState no_estimates{{0.0f, 0.0f, 0.0f}, sheets()};
        const auto radiance = [&](IntegratorSettings settings, uint32_t total) {
            settings.limits.total = total;
            PathStats stats;
            return double(
                path_radiance(world_, settings, no_estimates, path.ray, kLens, sampler, stats)
                    .radiance.y);
        };
        IntegratorSettings alone;
        alone.limits = kLimits;
        const double otherwise = radiance(alone, bounces - 2),
                     whole = radiance(alone, bounces - 1) - otherwise;
        path.share = (radiance(settings_, bounces - 1) - otherwise) / whole;
        return whole > 0.0;  // the roulette let it live, the light shines that way
    }

    RenderScene world_;
    EmissionGuide guide_;
    IntegratorSettings settings_;
    SheetPool sheets_;
};

inline Vec3 leaving(const LightPoint& y, const Vec3& last) {
    return y.distant ? y.direction * -1.0f : normalize(last - y.p);
}

// Whether a walk, or a shot, from where the path meets its casters finds its chain.
inline bool finds(const Bench& bench, const Traced& path) {
    const Scene& scene = *bench.world().scene;
    const ManifoldSettings& settings = bench.settings().manifold;
    const Surface& x = path.smooth.back();
    ManifoldStats stats;
    const auto is_corner = [&](const DifferentialGeometry& geometry, size_t i) {
        return length(geometry.p - path.corners[i]) < 1e-4f;
    };
    if (settings.finder == ChainFinder::walks && path.chain.size() == 1) {
        const uint32_t caster = bench.world().casters.of_instance[path.chain[0].hit.instance];
        const ChainQuery query{x.p, end_of(path.y), &bench.world().casters.casters[caster]};
        const std::optional<Seed> seed = seed_at(scene, settings, query, path.chain[0].hit);
        const std::optional<ChainRoot> root =
            seed ? walk_from(scene, settings, query, *seed, stats) : std::nullopt;
        return root && root->interaction == path.chain[0].interaction &&
               is_corner(root->geometry, 0);
    }
    ChainKind kind;
    for (const CausticVertex& vertex : path.chain)
        kind.append({vertex.hit.instance, vertex.interaction});
    const Vec3 w = normalize(path.corners[0] - x.p);
    const std::optional<ChainSolution> at =
        shoot(scene, settings, {x.p, x.ng, x.p_error}, end_of(path.y), kind, w,
              settings.max_halvings, stats);
    if (!at) return false;
    for (size_t i = 0; i < path.corners.size(); ++i)
        if (!is_corner(at->chain.vertices[i].geometry, i)) return false;
    return true;
}

// What the manifold makes of the path. Empty where it does not find it.
struct ByManifold {
    CausticDensities p;
    uint32_t trials;  // where sheets miss it; else 0
    // Of the path's light.
    double share() const {
        return trials > 0 && p.missed_are_apart() ? p.share_of_searches(trials)
                                                  : p.manifold / p.sum();
    }
};
inline std::optional<ByManifold> by_manifold(const Bench& bench, const Traced& path) {
    if (!finds(bench, path)) return std::nullopt;
    const Scene& scene = *bench.world().scene;
    const Surface& x = path.smooth.back();
    // As path tracing comes to its receiver.
    PathHistory before;
    BounceCounts bounces{};
    CameraSubpath camera_subpath{};
    for (size_t i = 0; i < path.smooth.size(); ++i) {
        const Surface& surface = path.smooth[i];
        camera_subpath = before.camera_subpath_to(scene, kLimits, surface);
        if (i == 0)
            camera_subpath.film_density = scene.camera.view(surface.p, kLens)->film_density *
                                          std::abs(dot(surface.ng, surface.wo));
        if (&surface == &x) break;
        const Stretch& stretch = path.between[i];
        ClosureSample next{};
        next.wi = normalize((stretch.corners.empty() ? path.smooth[i + 1].p : stretch.corners[0]) -
                            surface.p);
        next.pdf_omega = eval(surface.closures, surface.ng, surface.wo, next.wi).pdf_omega;
        before.append_smooth(scene, surface, next, true, camera_subpath, bounces);
        before.keep(surface, camera_subpath);
        before.set_direction(scene, next.wi);
        bounces.add(BounceKind::diffuse);
        for (const CausticVertex& vertex : stretch.chain) {
            ClosureSample turn{};
            turn.delta = turn.on_caster_normal = true;
            turn.refracted = vertex.interaction == Interaction::refraction;
            before.append_delta(vertex.hit, turn, bench.world().casters);
            bounces.add(turn.refracted ? BounceKind::transmission : BounceKind::glossy);
        }
    }
    const Media media{};
    const Receiver receiver{x.p,    x.p_error, x.ng,           x.wo,    &x.closures, 16,
                            &media, x.hit,     camera_subpath, bounces, 1.0f,        nullptr};
    const Vec3 wi = normalize(path.corners[0] - x.p);
    CausticPath record = caustic_path(scene, receiver, eval(x.closures, x.ng, x.wo, wi), wi);
    for (const CausticVertex& vertex : path.chain) record.append(vertex);
    if (is_black(chain_throughput(scene, record, end_of(path.y)))) return std::nullopt;
    const LightEnd end = light_end(path.y, leaving(path.y, path.corners.back()));
    const std::optional<CausticDensities> p = caustic_densities(bench.techniques(), record, end);
    if (!p) return std::nullopt;
    const ManifoldSettings& settings = bench.settings().manifold;
    if (settings.finder != ChainFinder::sheets) return ByManifold{*p, 0};
    ManifoldStats stats;
    Pcg pcg(11);
    return ByManifold{*p, trials_if_missed(bench.techniques(), bench.sheets(), record, end,
                                           settings.trial_cap, pcg, stats)};
}

// What a light path makes of it that leaves the light for its last vertex. Its rays meet the path's
// vertices but for rounding, which is not to be told from a wrong record next to folds: the record
// is of the path's own. Empty where rounding leads it elsewhere.
inline std::optional<CausticDensities> by_light(const Bench& bench, const Traced& path, float wrong) {
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
    const auto turns = [&](const Stretch& stretch, float accuracy) {
        for (size_t k = stretch.chain.size(); k-- > 0;) {
            if (!comes_to(stretch.corners[k], stretch.chain[k].hit, accuracy)) return false;
            const bool refracted = stretch.chain[k].interaction == Interaction::refraction;
            std::optional<ClosureSample> next;
            for (int tries = 0; tries < 1000 && !(next && next->refracted == refracted); ++tries)
                next = sample(surface.closures, surface.ng, surface.wo, {pcg.one(), 0.5f, 0.5f});
            if (!next || !history.append_delta(surface, *next, bench.world().casters)) return false;
            ray = {offset_origin({surface.p, surface.ng, surface.p_error}, next->wi), next->wi,
                   0.0f, kInfinity};
        }
        return true;
    };
    if (!turns(path, 1e-4f)) return std::nullopt;
    for (size_t i = path.smooth.size(); i-- > 0;) {
        if (!comes_to(path.smooth[i].p, path.smooth[i].hit, 1e-3f)) return std::nullopt;
        const Vec3 target = i == 0 ? path.ray.origin
                            : path.between[i - 1].corners.empty()
                                ? path.smooth[i - 1].p
                                : path.between[i - 1].corners.back();
        const Vec3 towards = normalize(target - surface.p);
        Surface from_camera;
        evaluate_surface(scene, surface.hit, towards, from_camera);
        std::optional<LightHistory::Arrival> arrival =
            history.arrive(scene, end.end, kVisibleAll, from_camera);
        if (!arrival) return std::nullopt;
        if (i == 0) {
            arrival->path.film_density *= wrong * scene.camera.view(surface.p, kLens)->film_density *
                                          std::abs(dot(surface.ng, towards));
            return caustic_densities(bench.techniques(), arrival->path, end);
        }
        const float pdf = eval(surface.closures, surface.ng, surface.wo, towards).pdf_omega;
        history.append_smooth(from_camera, *arrival, pdf);
        ray = {offset_origin({surface.p, surface.ng, surface.p_error}, towards), towards, 0.0f,
               kInfinity};
        if (!turns(path.between[i - 1], 1e-3f)) return std::nullopt;
    }
    return std::nullopt;
}

struct LightCase {
    const char* name;
    std::function<void(SceneMaker&)> add;
};
// A world of a small bright part, high up, and a dim rest.
inline void add_panorama(SceneMaker& maker) {
    constexpr uint32_t kWidth = 32, kHeight = 16;
    std::vector<float> texels;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const bool bright = y >= 11 && y < 14 && x >= 6 && x < 11;
            for (int c = 0; c < 3; ++c) texels.push_back(bright ? 20.0f : 0.2f);
        }
    set_world(maker, texels, kWidth, kHeight, kInCasters);
}
inline std::vector<LightCase> lights() {
    const Vec3 above(0.5f, -0.6f, 1.9f), down = normalize(Vec3(-0.4f, 0.5f, -1.0f));
    const auto lamp = [](const char* name, LightDesc light) {
        light.visibility = kInCasters;
        return LightCase{name, [light](SceneMaker& m) { m.builder.add_light(light); }};
    };
    LightDesc spot = spot_lamp(10.0f, 0.3f, 1.5f, 0.4f, down);
    spot.to_world.translation = above;
    return {lamp("sphere", point_lamp(10.0f, 0.3f, above)),
            lamp("spot", spot),
            lamp("rectangle", area_lamp(10.0f, AreaShape::rectangle, {0.9f, 0.6f}, above, down)),
            lamp("sun", sun_lamp(1.0f, 0.4f, normalize(Vec3(-0.3f, 0.4f, -1.0f)))),
            {"mesh",
             [=](SceneMaker& m) {
                 m.add(square(0.35f), emission(20.0f), facing(above, down), CausticsRole::off);
             }},
            {"panorama", add_panorama}};
}

struct CasterCase {
    const char* name;
    std::function<void(SceneMaker&)> add;
};
inline std::vector<CasterCase> casters() {
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
inline void add_receivers(SceneMaker& maker) {
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

}  // namespace spc::test
