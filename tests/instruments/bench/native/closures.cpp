// SPDX-License-Identifier: GPL-3.0-or-later
// Sampling and evaluating the closures of common materials, one list for each direction of view.
#include "bsdf/closure.h"
#include "kernels.h"
#include "scene/surface.h"
#include "support/casters.h"

namespace spc::bench {
namespace {

constexpr size_t kViews = 64;
constexpr size_t kDrawsEach = kBatch / kViews;

struct Views {
    std::vector<Surface> surfaces;
    std::vector<Vec3> draws;       // random numbers, kDrawsEach for each view
    std::vector<Vec3> directions;  // likewise: where something may be lit from
};

Views make_views(const Graph& graph) {
    test::SceneMaker maker;
    maker.add(test::square(1.0f), graph);
    const RenderScene world = maker.finish();
    Views views;
    Pcg pcg(5);
    for (size_t i = 0; i < kViews; ++i) {
        Surface& surface = views.surfaces.emplace_back();
        evaluate_surface(*world.scene, {0, 0, 0.3f, 0.3f}, cosine_hemisphere(pcg.two()), surface);
        const bool transmits = has_smooth_transmission(surface.closures);
        for (size_t k = 0; k < kDrawsEach; ++k) {
            const Vec2 u = pcg.two();
            views.draws.emplace_back(u.x, u.y, pcg.one());
            const Vec3 w = uniform_sphere(pcg.two());
            views.directions.push_back(transmits || dot(w, surface.ng) > 0.0f ? w : w * -1.0f);
        }
    }
    return views;
}

// f(surface, index of a draw) for every draw.
template <class F>
void for_each(const Views& views, const F& f) {
    for (size_t i = 0; i < kBatch; ++i) f(views.surfaces[i / kDrawsEach], i);
}

void sampled(benchmark::State& state, const Graph& graph) {
    const Views views = make_views(graph);
    uint64_t found = 0, deltas = 0, wrong = 0;
    for_each(views, [&](const Surface& at, size_t i) {
        const auto s = sample(at.closures, at.ng, at.wo, views.draws[i]);
        if (!s) return;
        ++found;
        if (s->delta) {
            ++deltas;
            return;
        }
        const float pdf = eval(at.closures, at.ng, at.wo, s->wi).pdf_omega;
        wrong += std::abs(pdf - s->pdf_omega) <= 1e-3f * pdf ? 0 : 1;  // 1e-3: rounding of wi
    });
    if (!holds(state, found > kBatch / 2, "most samples are empty") ||
        !holds(state, wrong < kBatch / 100, "samples have another density than eval() says"))
        return;
    state.counters["found"] = share(found, kBatch);
    state.counters["delta"] = share(deltas, kBatch);
    time_passes(state, "sample", kBatch, [&] {
        for_each(views, [&](const Surface& at, size_t i) {
            const auto s = sample(at.closures, at.ng, at.wo, views.draws[i]);
            benchmark::DoNotOptimize(s);
        });
    });
}

void evaluated(benchmark::State& state, const Graph& graph) {
    const Views views = make_views(graph);
    uint64_t lit = 0, wrong = 0;
    for_each(views, [&](const Surface& at, size_t i) {
        const ClosureEval e = eval(at.closures, at.ng, at.wo, views.directions[i]);
        if (is_black(e.f_cos)) return;
        ++lit;
        wrong += e.pdf_omega > 0.0f ? 0 : 1;
    });
    if (!holds(state, lit > kBatch / 4, "most directions are black") ||
        !holds(state, wrong == 0, "light comes from where no sample goes"))
        return;
    state.counters["lit"] = share(lit, kBatch);
    time_passes(state, "evaluation", kBatch, [&] {
        for_each(views, [&](const Surface& at, size_t i) {
            const ClosureEval e = eval(at.closures, at.ng, at.wo, views.directions[i]);
            benchmark::DoNotOptimize(e);
        });
    });
}

}  // namespace

void add_closures() {
    const auto add = [](const std::string& name, auto kernel, const Graph& graph) {
        benchmark::RegisterBenchmark(
            name.c_str(), [kernel, graph](benchmark::State& state) { kernel(state, graph); });
    };
    Graph rough_glass = test::glass(1.5f);
    rough_glass.inputs[1].value[0] = 0.3f;
    const std::pair<const char*, Graph> smooth[] = {
        {"diffuse", test::diffuse(0.8f)},
        {"rough_conductor", test::principled(1.0f, 0.3f)},
        {"rough_glass", rough_glass},
        {"principled_mix", test::principled(0.3f, 0.4f, 0.3f)}};
    for (const auto& [name, graph] : smooth) {
        add(std::string("sample/") + name, sampled, graph);
        add(std::string("eval/") + name, evaluated, graph);
    }
    add("sample/smooth_glass", sampled, test::glass(1.5f));
}

}  // namespace spc::bench
