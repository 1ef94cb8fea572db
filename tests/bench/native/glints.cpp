// SPDX-License-Identifier: GPL-3.0-or-later
// Glints: the search of a footprint, and beside it walks on the same slopes from random points
// [Zeltner20 Sec. 4.5], biased and unbiased. `relative_variance` is that of one estimate for one
// direction of light, averaged over directions in proportion to what they give, `found` the share of
// it that is found on average, `evaluations` are nodes and points or slopes with derivatives.
#include "support/glints.h"

#include <numeric>
#include "kernels.h"

namespace spc::bench {
namespace {

constexpr uint32_t kDirections = 16;  // of light
constexpr uint32_t kEstimates = kBatch / kDirections;
constexpr float kRoughness = 0.14f;
constexpr float kAlpha = kRoughness * kRoughness;

// A footprint on a floor of Gaussian waves, and directions of light that it may glint in.
struct GlintScene {
    RenderScene world;
    PixelFilter filter{FilterKind::blackman_harris, 1.5f};
    PixelKernel pixel{&filter, Vec2(0.5f), Vec2(0.0f)};
    Surface surface;
    RayDual ray;
    double distance;
    std::vector<Vec3> wi;
};

const GlintScene& scene_of(double texels) {
    const auto make = [](double width) {
        test::GlintFloor floor{
            test::normal_mapped(
                test::single_shader("bsdf_glossy", {{1, "Roughness", {kRoughness, 0, 0, 0}}}),
                {1, 1}),
            test::plane_normals(512, 5.0 / 512, 0.2, 5), width, 0.5f, [](test::SceneMaker&) {}};
        auto made = std::make_unique<GlintScene>();
        made->world = test::finish(floor, GlintsMode::on);
        const Scene& scene = *made->world.scene;
        const Ray ray = scene.camera.ray(0.5f, 0.5f, Vec2(0.5f));
        const Hit hit = *scene.accel->intersect(ray, kVisibleCamera);
        evaluate_surface(scene, hit.surface, ray.direction * -1.0f, made->surface);
        made->ray = camera_differential(scene.camera, made->pixel, Vec2(0.5f), ray.direction);
        made->distance = static_cast<double>(hit.t);
        Pcg pcg(7);
        const Vec3 mirrored(-made->surface.wo.x, -made->surface.wo.y, made->surface.wo.z);
        for (uint32_t i = 0; i < kDirections; ++i)
            made->wi.push_back(normalize(mirrored + Vec3(pcg.one() - 0.5f, pcg.one() - 0.5f, 0.0f)));
        return made;
    };
    static const std::unique_ptr<GlintScene> few = make(5.0), many = make(20.0);
    return texels < 10.0 ? *few : *many;
}

GlintPoint point_of(const GlintScene& scene) {
    return *GlintPoint::at(scene.world.glints, *scene.world.scene, scene.surface, scene.ray,
                           scene.distance, scene.pixel);
}

// An estimator of the mean of what a footprint does with light from wi, up to a factor.
using Estimator = std::function<double(const Vec3& wi, uint64_t seed, uint64_t& evaluations)>;

Estimator search(const GlintScene& scene, float points) {
    return [point = point_of(scene), points](const Vec3& wi, uint64_t seed, uint64_t& evaluations) {
        GlintStats stats;
        const Spectrum f = point.f_cos(wi, points, seed, stats);
        evaluations += stats.nodes + stats.points;
        return static_cast<double>(f.y);
    };
}

// Newton's method for the slope of the half-vector less that of a facet, which is drawn from the
// lobe's whole distribution and kept for the estimate.
class Walker {
public:
    explicit Walker(const GlintScene& scene)
        : filter_(scene.filter), field_(scene.world.glints.fields[0]), wo_(scene.surface.wo) {
        const Scene& s = *scene.world.scene;
        const Footprint f =
            *footprint_at(s, s.material_of(scene.surface.hit).slopes, field_.width(),
                          field_.height(), scene.surface, scene.ray, scene.distance);
        at_ = f.at;
        by_film_ = f.by_film;
        w_ = f.frame.w;
        det_ = by_film_[0].x * by_film_[1].y - by_film_[0].y * by_film_[1].x;
    }

    Vec2 target(const Vec3& wi, Pcg& pcg) const {
        const Vec3 h = normalize(wo_ + wi);
        const float z = dot(h, w_[2]);
        const Vec2 u = pcg.two();
        const float r = kAlpha * std::sqrt(u.x / (1.0f - u.x));  // GGX
        return Vec2(dot(h, w_[0]), dot(h, w_[1])) / z -
               Vec2(std::cos(2.0f * kPi * u.y), std::sin(2.0f * kPi * u.y)) * r;
    }

    struct Root {
        Vec2 at;
        double value;  // filter's density over the determinants
    };
    std::optional<Root> walk(const Vec2& target, Pcg& pcg, uint64_t& evaluations) const {
        constexpr int kMostSteps = 20;
        constexpr float kLongestStep = 2.0f;  // texels
        constexpr float kClose = 1e-4f;       // of slopes
        const Vec2 film = filter_.sample(pcg.two());
        Vec2 p = at_ + by_film_[0] * film.x + by_film_[1] * film.y;
        for (int step = 0; step < kMostSteps; ++step) {
            ++evaluations;
            const auto [slope, ds, dt] = derivative(p);
            const Vec2 c = slope - target;
            const float det = ds.x * dt.y - ds.y * dt.x;
            const float density = density_at(p);
            if (density == 0.0f) return std::nullopt;
            if (c.length() < kClose)
                return Root{
                    p, static_cast<double>(density) / std::abs(static_cast<double>(det_ * det))};
            if (det == 0.0f) return std::nullopt;
            const Vec2 d(-(dt.y * c.x - dt.x * c.y) / det, -(ds.x * c.y - ds.y * c.x) / det);
            p += d * std::min(1.0f, kLongestStep / d.length());
        }
        return std::nullopt;
    }

    // [Zeltner20 Alg. 2].
    double unbiased(const Vec3& wi, uint64_t seed, uint64_t& evaluations) const {
        constexpr int kMostTrials = 10000;
        Pcg pcg(seed);
        const Vec2 t = target(wi, pcg);
        const std::optional<Root> root = walk(t, pcg, evaluations);
        if (!root) return 0.0;
        int trials = 1;
        for (; trials < kMostTrials; ++trials)
            if (const auto again = walk(t, pcg, evaluations); again && same(*again, *root)) break;
        return root->value * trials;
    }

    // [Zeltner20 Alg. 3].
    double biased(const Vec3& wi, int walks, uint64_t seed, uint64_t& evaluations) const {
        Pcg pcg(seed);
        const Vec2 t = target(wi, pcg);
        std::vector<Root> roots;
        for (int i = 0; i < walks; ++i) {
            const std::optional<Root> root = walk(t, pcg, evaluations);
            const auto known = [&](const Root& r) { return same(r, *root); };
            if (root && std::none_of(roots.begin(), roots.end(), known)) roots.push_back(*root);
        }
        double sum = 0.0;
        for (const Root& root : roots) sum += root.value;
        return sum;
    }

private:
    static bool same(const Root& a, const Root& b) { return (a.at - b.at).length() < 0.02f; }

    float density_at(const Vec2& p) const {
        const Vec2 d = p - at_;
        return filter_.weight((by_film_[1].y * d.x - by_film_[1].x * d.y) / det_) *
               filter_.weight((by_film_[0].x * d.y - by_film_[0].y * d.x) / det_);
    }

    // Slope and its derivatives by the two coordinates, within a cell.
    std::array<Vec2, 3> derivative(const Vec2& p) const {
        const auto wrapped = [](float s, int n) {
            return s - std::floor(s / static_cast<float>(n)) * static_cast<float>(n);
        };
        const float x = wrapped(p.x, field_.width()), y = wrapped(p.y, field_.height());
        const int i = std::min(static_cast<int>(x), field_.width() - 1),
                  j = std::min(static_cast<int>(y), field_.height() - 1);
        const SlopePatch cell = field_.cell(i, j);
        const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
        constexpr float kStep = 1.0f / 64;
        return {cell.slope(s, t),
                (cell.slope(s + kStep, t) - cell.slope(s - kStep, t)) / (2.0f * kStep),
                (cell.slope(s, t + kStep) - cell.slope(s, t - kStep)) / (2.0f * kStep)};
    }

    const PixelFilter& filter_;
    const SlopeField& field_;
    Vec3 wo_;
    Vec2 at_;
    std::array<Vec2, 2> by_film_;
    std::array<Vec3, 3> w_;
    float det_;
};

// Moments of an estimator for each direction.
struct Moments {
    std::vector<double> mean, variance;
    uint64_t evaluations = 0;
};
Moments moments_of(const GlintScene& scene, const Estimator& estimator) {
    Moments m;
    for (uint32_t d = 0; d < kDirections; ++d) {
        double sum = 0.0, squares = 0.0;
        for (uint32_t i = 0; i < kEstimates; ++i) {
            const double x = estimator(scene.wi[d], mix_bits(d * kEstimates + i + 1), m.evaluations);
            sum += x;
            squares += x * x;
        }
        m.mean.push_back(sum / kEstimates);
        m.variance.push_back(squares / kEstimates - m.mean.back() * m.mean.back());
    }
    return m;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// `complete`: an estimator of the same, with the same factor, that misses nothing.
void estimate(benchmark::State& state, const GlintScene& scene, const Estimator& estimator,
              const Estimator& complete) {
    // Search and walks are equal up to a factor that hardly depends on the direction.
    const Moments m = moments_of(scene, estimator), exact = moments_of(scene, search(scene, 64.0f)),
                  whole = moments_of(scene, complete);
    if (!holds(state,
               product(m.mean, exact.mean) >
                   0.9 * std::sqrt(product(m.mean, m.mean) * product(exact.mean, exact.mean)),
               "it estimates something else"))
        return;
    state.counters["found"] = product(m.mean, exact.mean) / product(whole.mean, exact.mean);
    state.counters["relative_variance"] =
        std::accumulate(m.variance.begin(), m.variance.end(), 0.0) / product(whole.mean, whole.mean);
    state.counters["evaluations"] = share(m.evaluations, kBatch);
    time_passes(state, "estimate", kBatch, [&] {
        uint64_t evaluations = 0;
        for (uint32_t i = 0; i < kBatch; ++i)
            benchmark::DoNotOptimize(
                estimator(scene.wi[i % kDirections], mix_bits(i + 1), evaluations));
    });
}

}  // namespace

void add_glints() {
    using Make = std::function<Estimator(const GlintScene&)>;
    const auto searching = [](float points) {
        return Make([points](const GlintScene& scene) { return search(scene, points); });
    };
    const Make unbiased = [](const GlintScene& scene) -> Estimator {
        return [walker = Walker(scene)](const Vec3& wi, uint64_t seed, uint64_t& n) {
            return walker.unbiased(wi, seed, n);
        };
    };
    const auto biased = [](int walks) {
        return Make([walks](const GlintScene& scene) -> Estimator {
            return [walker = Walker(scene), walks](const Vec3& wi, uint64_t seed, uint64_t& n) {
                return walker.biased(wi, walks, seed, n);
            };
        });
    };
    struct Row {
        const char* name;
        Make make, complete;
    };
    const std::vector<Row> rows{{"search_2", searching(2.0f), searching(8.0f)},
                                {"search_8", searching(8.0f), searching(8.0f)},
                                {"walks_unbiased", unbiased, unbiased},
                                {"walks_biased_8", biased(8), unbiased},
                                {"walks_biased_32", biased(32), unbiased}};
    for (const Row& row : rows)
        for (const auto& [size, texels] : {std::pair("5_texels", 5.0), std::pair("20_texels", 20.0)})
            benchmark::RegisterBenchmark((std::string("glints/") + row.name + "/" + size).c_str(),
                                         [row, texels = texels](benchmark::State& state) {
                                             const GlintScene& scene = scene_of(texels);
                                             estimate(state, scene, row.make(scene),
                                                      row.complete(scene));
                                         });
}

}  // namespace spc::bench
