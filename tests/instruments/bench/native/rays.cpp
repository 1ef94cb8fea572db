// SPDX-License-Identifier: GPL-3.0-or-later
// Ray casts through Embree, on one bumpy sheet of more and more triangles.
#include "kernels.h"
#include "scene/surface.h"
#include "support/scenes.h"

namespace spc::bench {
namespace {

constexpr uint32_t kSide = 256;  // of the picture whose rays are coherent
constexpr uint32_t kRays = kSide * kSide;

double height(double x, double y) {
    return 0.06 * std::sin(9.0 * x + 1.0) * std::cos(7.0 * y) + 0.02 * std::sin(31.0 * x + 23.0 * y);
}

// Over [0, 1]^2, 2 n^2 triangles.
const Scene& sheet(uint32_t n) {
    static std::vector<std::pair<uint32_t, RenderScene>> scenes;
    for (const auto& [cells, world] : scenes)
        if (cells == n) return *world.scene;
    Mesh mesh = test::grid(
        n, [](double u, double v) { return Vec3d(u, v, height(u, v)); },
        [](double, double) { return Vec3d(0, 0, 1); });
    mesh.normals.clear();
    test::SceneMaker maker;
    maker.add(mesh, test::diffuse(0.8f));
    return *scenes.emplace_back(n, maker.finish()).second.scene;
}

Vec3 point_above(Pcg& pcg) { return Vec3(pcg.one(), pcg.one(), lerp(0.1f, 0.5f, pcg.one())); }

// Coherent: a picture seen from above, row by row; the shadow rays of its points to one lamp.
// Incoherent: from anywhere above the sheet to anywhere on it; between any two points, every other
// of them below it.
std::vector<Ray> make_rays(bool coherent, bool segments) {
    std::vector<Ray> rays;
    Pcg pcg(6);
    const Vec3 eye(0.5f, -0.4f, 0.9f), lamp(0.3f, 1.2f, 0.2f);
    for (uint32_t i = 0; i < kRays; ++i) {
        const uint32_t row = i / kSide, column = i % kSide;
        const Vec3 at((static_cast<float>(column) + 0.5f) / kSide,
                      (static_cast<float>(row) + 0.5f) / kSide, 0.0f);
        Vec3 from = eye, to = at;
        if (!coherent) {
            from = point_above(pcg);
            to = point_above(pcg);
            if (!segments) to.z = 0.0f;
            if (segments && i % 2 == 0) to.z -= 0.6f;
        } else if (segments) {
            from = at + Vec3(0.0f, 0.0f, 0.005f + static_cast<float>(height(at.x, at.y)));
            to = lamp;
        }
        const float distance = length(to - from);
        rays.push_back({from, (to - from) / distance, 0.0f, segments ? distance : kInfinity});
    }
    return rays;
}

void closest(benchmark::State& state, uint32_t n, bool coherent) {
    constexpr float kTolerance = 1e-5f;  // m, on a sheet of 1 m
    const Scene& scene = sheet(n);
    const std::vector<Ray> rays = make_rays(coherent, false);
    uint64_t hits = 0, astray = 0;
    for (const Ray& ray : rays) {
        const std::optional<Hit> hit = scene.accel->intersect(ray, kVisibleCamera);
        if (!hit) continue;
        ++hits;
        const Vec3 p = surface_position(scene, hit->surface);
        astray += length(p - (ray.origin + ray.direction * hit->t)) < kTolerance ? 0 : 1;
    }
    if (!holds(state, hits > kRays / 2, "most rays miss") ||
        !holds(state, astray < kRays / 1000, "hits lie beside their rays"))
        return;
    state.counters["hit"] = share(hits, kRays);
    time_passes(state, "ray", kRays, [&] {
        for (const Ray& ray : rays) {
            const auto hit = scene.accel->intersect(ray, kVisibleCamera);
            benchmark::DoNotOptimize(hit);
        }
    });
}

void occluded(benchmark::State& state, uint32_t n, bool coherent) {
    const Scene& scene = sheet(n);
    const std::vector<Ray> rays = make_rays(coherent, true);
    uint64_t hits = 0, wrong = 0;
    for (const Ray& ray : rays) {
        const bool hit = scene.accel->occluded(ray, kVisibleShadow);
        hits += hit ? 1 : 0;
        wrong += hit == scene.accel->intersect(ray, kVisibleShadow).has_value() ? 0 : 1;
    }
    if (!holds(state, hits > kRays / 20 && hits < kRays - kRays / 20, "all rays do the same") ||
        !holds(state, wrong < kRays / 1000, "occlusion contradicts the closest hit"))
        return;
    state.counters["hit"] = share(hits, kRays);
    time_passes(state, "ray", kRays, [&] {
        for (const Ray& ray : rays) {
            const bool hit = scene.accel->occluded(ray, kVisibleShadow);
            benchmark::DoNotOptimize(hit);
        }
    });
}

}  // namespace

void add_rays() {
    const std::pair<const char*, void (*)(benchmark::State&, uint32_t, bool)> kernels[] = {
        {"closest", closest}, {"occluded", occluded}};
    const std::pair<const char*, uint32_t> sizes[] = {{"1e2", 7}, {"1e4", 71}, {"1e6", 707}};
    for (const auto& [what, kernel] : kernels)
        for (const bool coherent : {true, false})
            for (const auto& [triangles, cells] : sizes) {
                const std::string name =
                    std::string(what) + (coherent ? "/coherent/" : "/incoherent/") + triangles;
                benchmark::RegisterBenchmark(
                    name.c_str(), [kernel = kernel, cells = cells, coherent](auto& state) {
                        kernel(state, cells, coherent);
                    });
            }
}

}  // namespace spc::bench
