// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/camera_chains.h"

#include "core/parallel.h"

namespace spc {

namespace {

// Shots of all estimates of one sample of the picture, for each pixel, and searches.
constexpr double kShots = 1.0 / 32, kSearches = 1.0 / 4;
constexpr double kMostSeeds = 1024.0;  // to one light
constexpr uint32_t kChunk = 256;
constexpr uint32_t kHopeless = 8;  // if this part of the walks found nothing, the others do not go

template <class Index>
Sampler camera_chain_sampler(uint32_t seed, const Index& index) {
    return sampler_beside_pixels(seed, 0x686967686c69ull, index);
}
Sampler search_sampler(uint32_t seed, const SplatIndex& index) {
    return sampler_beside_pixels(seed, 0x736561726368ull, index);
}

Splat splat_of(const CameraChain& chain, const Vec2& film, const IntegratorSettings& settings,
               const Sampler& sampler) {
    const Lobe lobe = chain.first == Interaction::reflection ? Lobe::glossy : Lobe::transmission;
    return {film,
            chain.value,
            only(lobe),
            settings.group_of_light(chain.light),
            chain.count == 1,
            sampler[Domain::splat].two()};
}

// The camera as the beginning of chains, through one point of its lens.
struct CameraEye {
    CameraEye(const Scene& scene, const IntegratorSettings& settings, const Vec2& at, uint64_t& rays)
        : camera(scene.camera), lens(at) {
        const Ray middle = camera.ray(0.5f * static_cast<float>(camera.width),
                                      0.5f * static_cast<float>(camera.height), lens);
        media = media_at(scene, middle.origin + middle.direction * middle.t_near, rays);
        receiver.p = middle.origin;
        receiver.ng = camera.forward();
        receiver.wo = receiver.ng * -1.0f;
        receiver.transparent_left = settings.limits.transparent;
        receiver.media = &media;
        receiver.camera = &camera;
    }
    CameraEye(const CameraEye&) = delete;
    CameraEye& operator=(const CameraEye&) = delete;

    // Where it sees p on the film, if that is near the crop.
    std::optional<Vec2> place(const Vec3& p, float margin) const {
        const std::optional<CameraView> view = camera.view(p, lens);
        if (!view || !camera.is_near_crop(view->film, margin)) return std::nullopt;
        return view->film;
    }

    const Camera& camera;
    Vec2 lens;
    Media media;
    Receiver receiver{};
};

double pixel_count(const Camera& camera) {
    return static_cast<double>(uint64_t{camera.crop[2]} * camera.crop[3]);
}

// The pixels that may show themselves in the picture.
struct FilmWindow {
    FilmWindow(const Camera& camera, float margin) {
        const float around = std::ceil(margin);
        const auto& [x0, y0, crop_width, crop_height] = camera.crop;
        corner = Vec2(static_cast<float>(x0) - around, static_cast<float>(y0) - around);
        width = crop_width + 2 * static_cast<uint32_t>(around);
        height = crop_height + 2 * static_cast<uint32_t>(around);
    }
    double pixels() const { return static_cast<double>(uint64_t{width} * height); }
    Vec2 at(const Vec2& u) const {
        return corner + Vec2(u.x * static_cast<float>(width), u.y * static_cast<float>(height));
    }

    Vec2 corner;
    uint32_t width, height;
};

// Leads to what random rays through the middle of the lens come near.
class ChainSeedSearch {
public:
    ChainSeedSearch(const RenderScene& world, const IntegratorSettings& settings,
                    const CameraEye& eye, uint32_t walks, size_t most_seeds, uint32_t seed)
        : techniques_(techniques_of(world, settings)),
          eye_(eye),
          window_(eye.camera, 0.0f),
          most_seeds_(most_seeds),
          seed_(seed),
          chain_seeds_(world.lights.count()) {
        constexpr double kRadius = 4.0;  // of the distance between walks, but no less pixels
        radius_ = static_cast<float>(kRadius * std::sqrt(std::max(1.0, window_.pixels() / walks)));
    }

    // Makes the walks from `first` to `end` - 1. Returns whether there are any chain seeds by now.
    bool walk(uint32_t first, uint32_t end, uint32_t threads, const Budget& budget,
              PathStats& stats) {
        const uint32_t chunks = (end - first + kChunk - 1) / kChunk;
        std::vector<std::vector<RandomCameraChain>> found(chunks);
        std::vector<ManifoldStats> counted(chunks);
        parallel_for(threads, chunks, [&](uint32_t c) {
            const uint32_t begin = first + c * kChunk;
            for (uint32_t i = begin; i < std::min(begin + kChunk, end) && !budget.must_end(); ++i)
                walk(i, found[c], counted[c]);
        });
        for (uint32_t c = 0; c < chunks; ++c) {
            stats.manifold.add(counted[c]);
            for (const RandomCameraChain& one : found[c])
                if (!budget.must_end()) add_seed(one, stats.manifold);
        }
        return std::any_of(chain_seeds_.begin(), chain_seeds_.end(),
                           [](const std::vector<ChainSeed>& some) { return !some.empty(); });
    }

    std::vector<std::vector<ChainSeed>> take() { return std::move(chain_seeds_); }

private:
    // Appends the camera chains of walk `i` that the picture shows and that no seed of earlier
    // rounds finds.
    void walk(uint32_t i, std::vector<RandomCameraChain>& found, ManifoldStats& stats) const {
        const Sampler sampler = camera_chain_sampler(~seed_, uint64_t{i});
        std::vector<RandomCameraChain> near;
        add_random_camera_chains(techniques_, eye_.receiver, window_.at(sampler[Domain::film].two()),
                                 radius_, sampler, near, stats);
        for (const RandomCameraChain& one : near)
            if (eye_.place(one.solution.chain.vertices[0].geometry.p, 0.0f) && !is_known(one, stats))
                found.push_back(one);
    }

    // Whether one of the nearest chain seeds finds it, or its light has enough seeds.
    bool is_known(const RandomCameraChain& camera_chain, ManifoldStats& stats) const {
        constexpr size_t kNearest = 4;
        const std::vector<ChainSeed>& chain_seeds = chain_seeds_[camera_chain.y.light];
        if (chain_seeds.size() >= most_seeds_) return true;
        const ChainSolution& solution = camera_chain.solution;
        std::vector<const ChainSeed*> alike;
        for (const ChainSeed& chain_seed : chain_seeds)
            if (chain_seed.kind == solution.kind) alike.push_back(&chain_seed);
        const auto count = static_cast<ptrdiff_t>(std::min(kNearest, alike.size()));
        std::partial_sort(alike.begin(), alike.begin() + count, alike.end(),
                          [&](const ChainSeed* a, const ChainSeed* b) {
                              return dot(a->w, solution.w) > dot(b->w, solution.w);
                          });
        return std::any_of(alike.begin(), alike.begin() + count, [&](const ChainSeed* chain_seed) {
            return seed_finds(techniques_, eye_.receiver, *chain_seed, camera_chain, stats);
        });
    }

    void add_seed(const RandomCameraChain& camera_chain, ManifoldStats& stats) {
        if (is_known(camera_chain, stats)) return;
        chain_seeds_[camera_chain.y.light].push_back(
            {camera_chain.solution.kind, camera_chain.solution.w});
    }

    const Techniques techniques_;
    const CameraEye& eye_;
    const FilmWindow window_;
    const size_t most_seeds_;
    const uint32_t seed_;
    float radius_;                                     // pixels
    std::vector<std::vector<ChainSeed>> chain_seeds_;  // of each light
};

}  // namespace

std::unique_ptr<const CameraChains> learn_camera_chains(const RenderScene& world,
                                                        IntegratorSettings settings, uint32_t walks,
                                                        uint32_t seed, uint32_t threads,
                                                        const Budget& budget, PathStats& stats) {
    const Scene& scene = *world.scene;
    if (settings.casters_of(world).empty() || world.lights.caustic_selection.empty() ||
        scene.camera.projection != Projection::perspective)
        return nullptr;
    const double shots = std::max(1.0, kShots * pixel_count(scene.camera));
    const size_t lights = world.lights.count();
    // Weights as if each light had a single chain seed: chains that get no share then never do.
    const CameraChains most{std::vector(lights, std::vector(1, ChainSeed{{}, Vec3(0.0f)})), shots};
    settings.camera_chains = &most;
    settings.manifold.longest_chain = kLongestChain;
    const Vec2 middle(0.5f, 0.5f);
    const CameraEye eye(scene, settings, middle, stats.rays);
    ChainSeedSearch search(world, settings, eye, walks,
                           static_cast<size_t>(std::min(kMostSeeds, shots)), seed);
    // Each round has as many walks as all before, which spare it what they have found.
    uint32_t end = 0;
    const uint64_t work_before = stats.manifold.work();
    for (uint32_t round = kChunk; end < walks; round *= 2) {
        const uint32_t first = end;
        end = std::min(walks, round);
        if (!search.walk(first, end, threads, budget, stats) && end >= walks / kHopeless) break;
        if (budget.is_spent(stats.manifold.work() - work_before)) break;
    }
    if (budget.is_cancelled()) return nullptr;
    auto result = std::make_unique<CameraChains>();
    result->chain_seeds = search.take();
    double chain_seeds = 0.0;  // that an estimate shoots on average
    for (uint32_t light = 0; light < lights; ++light)
        chain_seeds += static_cast<double>(world.lights.caustic_selection.probability(light)) *
                       static_cast<double>(result->chain_seeds[light].size());
    if (chain_seeds == 0.0) return nullptr;
    result->estimates = std::ceil(std::min(shots / chain_seeds, pixel_count(scene.camera)));
    result->searches = kSearches;
    return result;
}

void estimate_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                            float margin, uint32_t seed, const SplatIndex& index,
                            std::vector<Splat>& splats, PathStats& stats) {
    const Sampler sampler = camera_chain_sampler(seed, index);
    const CameraEye eye(*world.scene, settings, sampler[Domain::lens].two(), stats.rays);
    std::vector<CameraChain> found;
    find_camera_chains(techniques_of(world, settings), eye.receiver, sampler, found, stats.manifold);
    for (const CameraChain& one : found)
        if (const std::optional<Vec2> film = eye.place(one.p, margin))
            splats.push_back(splat_of(one, *film, settings, sampler));
}

uint64_t camera_chain_searches(const Camera& camera, const CameraChains& camera_chains,
                               float margin) {
    return static_cast<uint64_t>(
        std::ceil(camera_chains.searches * FilmWindow(camera, margin).pixels()));
}

void search_camera_chains(const RenderScene& world, const IntegratorSettings& settings,
                          float margin, uint32_t seed, const SplatIndex& index,
                          std::vector<Splat>& splats, PathStats& stats) {
    const Camera& camera = world.scene->camera;
    const FilmWindow window(camera, margin);
    const Sampler sampler = search_sampler(seed, index);
    const Vec2 film = window.at(sampler[Domain::film].two());
    const Vec2 pixel(std::floor(film.x), std::floor(film.y));
    const CameraEye eye(*world.scene, settings, sampler[Domain::lens].two(), stats.rays);
    const std::optional<CameraChain> one = search_camera_chain(
        techniques_of(world, settings), eye.receiver, pixel, sampler, stats.manifold);
    if (!one) return;
    const auto searches =
        static_cast<double>(camera_chain_searches(camera, *settings.camera_chains, margin));
    if (const std::optional<Vec2> place = eye.place(one->p, margin)) {
        splats.push_back(splat_of(*one, *place, settings, sampler));
        splats.back().value *= static_cast<float>(window.pixels() / searches);
    }
}

}  // namespace spc
