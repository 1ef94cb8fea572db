// SPDX-License-Identifier: GPL-3.0-or-later
// From a hit to what is there: closures for transport, and the local shape for walks.
#include "kernels.h"
#include "scene/surface.h"
#include "support/casters.h"

namespace spc::bench {
namespace {

struct Looks {
    RenderScene world;
    std::vector<SurfaceHit> hits;
    std::vector<Vec3> wo;  // of each hit
};

// Random points of instance 0, each seen by a ray from one of `receiver`.
Looks look(RenderScene world, const std::function<Vec3(Pcg&)>& receiver) {
    const Scene& scene = *world.scene;
    const size_t triangles = scene.meshes[scene.instances[0].mesh]->triangles.size();
    Looks looks;
    Pcg pcg(3);
    while (looks.hits.size() < kBatch) {
        const Vec3 x = receiver(pcg);
        const auto triangle = static_cast<uint32_t>(pcg.one() * static_cast<float>(triangles));
        const Vec2 b = uniform_triangle(pcg.two());
        const Vec3 d = normalize(surface_position(scene, {0, triangle, b.x, b.y}) - x);
        const std::optional<Hit> hit = scene.accel->intersect({x, d}, kVisibleCamera);
        if (!hit || hit->light != kNone) continue;
        looks.hits.push_back(hit->surface);
        looks.wo.push_back(d * -1.0f);
    }
    looks.world = std::move(world);
    return looks;
}
Looks look(test::CausticScene scene) { return look(std::move(scene.world), scene.receiver); }

const Looks& smooth() {
    static const Looks looks = look(test::smooth_ring());
    return looks;
}
const Looks& mapped() {
    static const Looks looks = look(test::reflective_plane());
    return looks;
}

// Tiles: coordinates, a mapping and an image, whose colour goes to a diffuse part and whose
// brightness to the share of a glossy one.
const Looks& nodes() {
    static const Looks looks = [] {
        test::SceneMaker maker;
        std::vector<uint8_t> texels;
        Pcg pcg(4);
        for (uint32_t i = 0; i < 3 * 512 * 512; ++i)
            texels.push_back(static_cast<uint8_t>(64 + pcg.bits() % 128));
        maker.builder.add_image(
            image_from_bytes("tiles", texels, 512, 512, 3, ColorSpace::srgb, AlphaMode::none));
        Graph graph;
        graph.name = "tiles";
        graph.nodes = {{"Output", "output", kNone},        {"Mix", "mix_shader", kNone},
                       {"Diffuse", "bsdf_diffuse", kNone}, {"Glossy", "bsdf_glossy", kNone},
                       {"Image", "image_texture", 0},      {"Mapping", "mapping", kNone},
                       {"UV", "texture_coordinate", kNone}};
        graph.inputs = {{3, "Roughness", {0.3f, 0, 0, 0}}, {5, "Scale", {6, 6, 1, 0}}};
        graph.links = {{1, "Shader", 0, "Surface"},  {2, "BSDF", 1, "Shader"},
                       {3, "BSDF", 1, "Shader_001"}, {4, "Color", 1, "Fac"},
                       {4, "Color", 2, "Color"},     {5, "Vector", 4, "Vector"},
                       {6, "UV", 5, "Vector"}};
        maker.add(test::square(6.0f), graph);
        return look(maker.finish(),
                    [](Pcg& pcg) { return Vec3(pcg.one(), pcg.one() - 5.3f, 2.0f + pcg.one()); });
    }();
    return looks;
}

constexpr float kVisibleTilt = 1e-3f;  // radians: a normal map leans by more, on average

// Mean angle between the interpolated normal and the one that the first closure has.
float mean_tilt(const Looks& looks) {
    double sum = 0;
    for (size_t i = 0; i < looks.hits.size(); ++i) {
        Surface surface;
        evaluate_surface(*looks.world.scene, looks.hits[i], looks.wo[i], surface);
        const auto* glossy = std::get_if<MicrofacetReflection>(&surface.closures.closures[0].kind);
        if (surface.closures.count == 1 && glossy != nullptr)
            sum += static_cast<double>(length(cross(glossy->n, surface.n)));
    }
    return static_cast<float>(sum / static_cast<double>(looks.hits.size()));
}

bool has_both_closures(const Looks& looks) {
    for (size_t i = 0; i < looks.hits.size(); ++i) {
        Surface surface;
        evaluate_surface(*looks.world.scene, looks.hits[i], looks.wo[i], surface);
        if (surface.closures.count != 2) return false;
    }
    return true;
}

void surface(benchmark::State& state, const Looks& looks) {
    const bool is_mapped = &looks == &mapped();
    if (&looks == &nodes()
            ? !holds(state, has_both_closures(looks), "the nodes do not give two closures")
            : !holds(state, (mean_tilt(looks) > kVisibleTilt) == is_mapped,
                     "the normal is mapped where it should not be, or the other way round"))
        return;
    time_passes(state, "surface", looks.hits.size(), [&] {
        Surface surface;
        for (size_t i = 0; i < looks.hits.size(); ++i) {
            evaluate_surface(*looks.world.scene, looks.hits[i], looks.wo[i], surface);
            benchmark::DoNotOptimize(surface);
        }
    });
}

void geometry(benchmark::State& state, const Looks& looks) {
    const Scene& scene = *looks.world.scene;
    double tilt = 0;
    for (const SurfaceHit& hit : looks.hits)
        tilt += static_cast<double>(length(
            cross(evaluate_caster(scene, hit, false).n, evaluate_caster(scene, hit, true).n)));
    const bool is_mapped = tilt / kBatch > static_cast<double>(kVisibleTilt);
    if (!holds(state, is_mapped == (&looks == &mapped()),
               "the normal is mapped where it should not be, or the other way round"))
        return;
    time_passes(state, "geometry", looks.hits.size(), [&] {
        for (const SurfaceHit& hit : looks.hits) {
            const DifferentialGeometry one = evaluate_caster(scene, hit, false);
            benchmark::DoNotOptimize(one);
        }
    });
}

}  // namespace

void add_surfaces() {
    const auto add = [](const char* name, auto kernel, auto looks) {
        benchmark::RegisterBenchmark(
            name, [kernel, looks](benchmark::State& state) { kernel(state, looks()); });
    };
    add("surface/smooth", surface, smooth);
    add("surface/mapped", surface, mapped);
    add("surface/nodes", surface, nodes);
    add("geometry/smooth", geometry, smooth);
    add("geometry/mapped", geometry, mapped);
}

}  // namespace spc::bench
