// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/highlights.h"

#include "core/parallel.h"

namespace spc {

namespace {

// Shots of all estimates of one sample of the picture, for each pixel, and searches.
constexpr double kShots = 1.0 / 32, kSearches = 1.0 / 8;
constexpr double kMostLeads = 1024.0;  // to one light
constexpr uint32_t kChunk = 256;

Sampler highlight_sampler(uint32_t seed, uint64_t index) {
    return sampler_beside_pixels(seed, 0x686967686c69ull, index);
}
Sampler search_sampler(uint32_t seed, uint64_t index) {
    return sampler_beside_pixels(seed, 0x736561726368ull, index);
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

// Through the middle of the lens.
std::vector<RandomHighlight> pilot(const RenderScene& world, const IntegratorSettings& settings,
                                   const CameraEye& eye, uint32_t walks, uint32_t seed,
                                   uint32_t threads, const std::atomic<bool>& cancelled,
                                   PathStats& stats) {
    const uint32_t chunks = (walks + kChunk - 1) / kChunk;
    std::vector<std::vector<RandomHighlight>> found(chunks);
    std::vector<ManifoldStats> counted(chunks);
    parallel_for(threads, chunks, [&](uint32_t c) {
        for (uint32_t i = 0; i < kChunk && !cancelled.load(); ++i) {
            const std::optional<RandomHighlight> one =
                random_highlight(techniques_of(world, settings), eye.receiver,
                                 highlight_sampler(~seed, uint64_t{c} * kChunk + i), counted[c]);
            if (one && eye.place(one->solution.chain.vertices[0].patch.p, 0.0f))
                found[c].push_back(*one);
        }
    });
    std::vector<RandomHighlight> all;
    for (uint32_t c = 0; c < chunks; ++c) {
        all.insert(all.end(), found[c].begin(), found[c].end());
        stats.manifold.add(counted[c]);
    }
    return all;
}

// A lead to it unless one of those that begin nearest comes to it already.
void add_lead(const Techniques& techniques, const CameraEye& eye, const RandomHighlight& highlight,
              std::vector<HighlightLead>& leads, PathStats& stats) {
    constexpr size_t kNearest = 4;
    const ChainSolution& solution = highlight.solution;
    const Vec3 w = normalize(solution.chain.vertices[0].patch.p - eye.receiver.p);
    std::vector<const HighlightLead*> alike;
    for (const HighlightLead& lead : leads)
        if (lead.kind == solution.kind) alike.push_back(&lead);
    const size_t count = std::min(kNearest, alike.size());
    std::partial_sort(
        alike.begin(), alike.begin() + static_cast<ptrdiff_t>(count), alike.end(),
        [&](const HighlightLead* a, const HighlightLead* b) { return dot(a->w, w) > dot(b->w, w); });
    alike.resize(count);
    const auto comes_to_it = [&](const HighlightLead* lead) {
        return leads_to(techniques, eye.receiver, *lead, highlight, stats.manifold);
    };
    if (std::none_of(alike.begin(), alike.end(), comes_to_it)) leads.push_back({solution.kind, w});
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

    Vec2 corner;
    uint32_t width, height;
};

}  // namespace

std::unique_ptr<const Highlights> learn_highlights(const RenderScene& world,
                                                   IntegratorSettings settings, uint32_t walks,
                                                   uint32_t seed, uint32_t threads,
                                                   const std::atomic<bool>& cancelled,
                                                   PathStats& stats) {
    const Scene& scene = *world.scene;
    if (world.casters.empty() || world.lights.caustic_selection.empty() ||
        scene.camera.projection != Projection::perspective)
        return nullptr;
    const double shots = std::max(1.0, kShots * pixel_count(scene.camera));
    const size_t lights = world.lights.count();
    // As if one lead led to each light: what is not worth an estimate then never is.
    const Highlights most{std::vector(lights, std::vector(1, HighlightLead{})), shots};
    settings.highlights = &most;
    settings.manifold.longest_chain = kLongestChain;
    const Vec2 middle(0.5f, 0.5f);
    const CameraEye eye(scene, settings, middle, stats.rays);
    const std::vector<RandomHighlight> found =
        pilot(world, settings, eye, walks, seed, threads, cancelled, stats);
    const auto most_leads = static_cast<size_t>(std::min(kMostLeads, shots));
    auto result = std::make_unique<Highlights>();
    result->leads.resize(lights);
    const Techniques techniques = techniques_of(world, settings);
    for (const RandomHighlight& one : found) {
        if (cancelled.load()) return nullptr;
        std::vector<HighlightLead>& leads = result->leads[one.y.light];
        if (leads.size() < most_leads) add_lead(techniques, eye, one, leads, stats);
    }
    double leads = 0.0;  // that an estimate shoots on average
    for (uint32_t light = 0; light < lights; ++light)
        leads += static_cast<double>(world.lights.caustic_selection.probability(light)) *
                 static_cast<double>(result->leads[light].size());
    if (leads == 0.0) return nullptr;
    result->estimates = std::ceil(std::min(shots / leads, pixel_count(scene.camera)));
    result->searches = kSearches;
    return result;
}

void estimate_highlights(const RenderScene& world, const IntegratorSettings& settings, float margin,
                         uint32_t seed, uint64_t index, std::vector<Splat>& splats,
                         PathStats& stats) {
    const Sampler sampler = highlight_sampler(seed, index);
    const CameraEye eye(*world.scene, settings, sampler[Domain::lens].two(), stats.rays);
    std::vector<Highlight> found;
    find_highlights(techniques_of(world, settings), eye.receiver, sampler, found, stats.manifold);
    for (const Highlight& one : found)
        if (const std::optional<Vec2> film = eye.place(one.p, margin))
            splats.push_back({*film, one.value});
}

uint64_t highlight_searches(const Camera& camera, const Highlights& highlights, float margin) {
    return static_cast<uint64_t>(
        std::ceil(highlights.searches * FilmWindow(camera, margin).pixels()));
}

void search_highlights(const RenderScene& world, const IntegratorSettings& settings, float margin,
                       uint32_t seed, uint64_t index, std::vector<Splat>& splats, PathStats& stats) {
    const Camera& camera = world.scene->camera;
    const FilmWindow window(camera, margin);
    const Sampler sampler = search_sampler(seed, index);
    const Vec2 u = sampler[Domain::film].two();
    const Vec2 pixel = window.corner + Vec2(std::floor(u.x * static_cast<float>(window.width)),
                                            std::floor(u.y * static_cast<float>(window.height)));
    const CameraEye eye(*world.scene, settings, sampler[Domain::lens].two(), stats.rays);
    const std::optional<Highlight> one = search_highlight(
        techniques_of(world, settings), eye.receiver, pixel, sampler, stats.manifold);
    if (!one) return;
    const auto searches =
        static_cast<double>(highlight_searches(camera, *settings.highlights, margin));
    if (const std::optional<Vec2> film = eye.place(one->p, margin))
        splats.push_back({*film, one->value * static_cast<float>(window.pixels() / searches)});
}

}  // namespace spc
