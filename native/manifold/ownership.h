// SPDX-License-Identifier: GPL-3.0-or-later
// Ownership: which techniques find a path of light that reaches a receiver through specular
// interactions (path tracing, fold directions, the manifold, light tracing), and how they share it.
//
// A path is described by what it is, not by how it was found. From that, one function computes the
// density of every technique, and all of them use the balance heuristic.
#pragma once

#include "bsdf/closure.h"
#include "manifold/camera_chains.h"
#include "manifold/emission.h"

namespace spc {

class FoldDirections;

// Cycles' limits: a path may scatter this often and is still lit at its last vertex.
struct BounceLimits {
    uint32_t total = 12, diffuse = 4, glossy = 4, transmission = 12, transparent = 8;
};

struct BounceCounts {
    uint32_t total = 0, diffuse = 0, glossy = 0, transmission = 0, transparent = 0;

    void add(BounceKind kind) {
        switch (kind) {
            case BounceKind::diffuse: ++diffuse; break;
            case BounceKind::glossy: ++glossy; break;
            case BounceKind::transmission: ++transmission; break;
            case BounceKind::transparent:
                ++transparent;
                return;  // not counted in the total, as in Cycles
        }
        ++total;
    }
    // Whether the path is past a limit. Its ray then still meets lights, which its last vertex
    // shares with next event estimation, but no more surfaces.
    bool exhausted(const BounceLimits& limits) const {
        return total > limits.total || diffuse > limits.diffuse || glossy > limits.glossy ||
               transmission > limits.transmission;
    }
    // Number of transparent surfaces that the path, and each of its shadow rays, may still pass
    // through.
    uint32_t transparent_left(const BounceLimits& limits) const {
        return limits.transparent - std::min(limits.transparent, transparent);
    }
    // Whether the path may scatter once more, by any smooth closure, and be lit at the next vertex.
    bool leaves_room_for_chain(const BounceLimits& limits) const {
        return total < limits.total && diffuse < limits.diffuse && glossy < limits.glossy &&
               transmission < limits.transmission;
    }
};

// Light tracing as the weights see it.
struct LightTracing {
    const EmissionGuide* guide = nullptr;  // null: there are none
    double paths = 0.0;                    // light paths for each sample of the whole picture
    double goes_on = 1.0;  // probability that a light path may scatter at its receiver
    // Mean number of trials until a search finds a chain that light paths have found, weighted by
    // its light; 1 for chains that a sheet seed finds.
    double mean_search_trials = 1.0;
    double manifold_share = 1.0;  // the manifold's share of that light
    // At receivers that light paths may reach: share of them that make walks, and factor on the
    // walks' confidence.
    double walks = 1.0, walk_confidence = 1.0;
    // From this CameraSubpath::film_density for each light path on, light that glints reflect is
    // left to path tracing, which averages it over a footprint.
    double beside_glints = std::numeric_limits<double>::infinity();
    // Whether the manifold makes no estimates at receivers that light paths may reach.
    bool alone = false;
};

// All that ownership depends on besides the path.
struct Techniques {
    const Scene& scene;
    const LightSet& lights;
    const CasterSet& casters;  // those on which the manifold looks for chains
    const CasterSet& rough_chain_casters;
    const ManifoldSettings& manifold;
    const LightTracing& light_tracing;
    const CameraChains* camera_chains;  // null: path tracing alone finds them
    const BounceLimits& limits;
};

// A vertex of a chain: on a caster's specular interface, or at a facet of a rough one.
struct CausticVertex {
    SurfaceHit hit;
    Interaction interaction;
    // Probability of the delta lobe for a path from the receiver (delta_lobe()); at a rough vertex
    // ClosureEval::pdf_omega, 1/sr.
    float probability = 0.0f;
    // Probability of the delta lobe for a path from the light; 0 if not computed yet.
    float probability_from_light = 0.0f;
    bool rough = false;
    float facet_pdf = 0.0f;  // at a rough vertex: facet_pdf() in manifold/facet.h
};

// Bounces of the camera's path before a surface: smooth scatterings, and interactions with casters
// between them. Passing straight through a transparent surface is not counted.
struct SubpathBounces {
    uint32_t scatterings = 0, reflections = 0, refractions = 0;

    void add_turn(Interaction interaction) {
        ++(interaction == Interaction::reflection ? reflections : refractions);
    }
};
// The camera's path up to a surface, if light tracing could make it: from a surface that the camera
// sees directly, by smooth scatterings and chains between them.
struct CameraSubpath {
    // CausticPath::film_density without the division by the light path's density of leaving this
    // surface. 0 if light tracing could not make the subpath.
    float film_density = 0.0f;
    SubpathBounces bounces{};
};

// A path from a smooth scattering at the receiver x through a chain, without the endpoint at the
// light. A path without vertices stands for light that shines directly on a rough caster at x.
struct CausticPath {
    Vec3 x{0.0f};
    float p_error = 0.0f;   // of x, see RayStart
    ReceiverSides sides{};  // by the side of the path that arrived
    // Density of the scattering at x towards the chain, 1/sr. If x is the camera: pixels^2 of the
    // film per sr, since path tracing takes one sample for each pixel.
    float pdf_omega = 0.0f;
    bool receiver = false;      // x has the role of a receiver, a smooth closure and bounces left
    bool from_camera = false;   // x is a point of the camera's lens: a camera chain
    bool rough_caster = false;  // x lies on a rough caster
    // Whether a rough chain may begin at x. False on a rough caster that was reached by a
    // scattering: there the rough chain from the previous receiver continues.
    bool begins_rough = true;
    // The path goes straight through a transparent part of a caster, between x and the first vertex
    // or between vertices.
    bool through_caster = false;
    // Bounces of the camera's path when it arrived at x. Empty in a light path's record, which does
    // not know their kinds.
    BounceCounts before{};
    SubpathBounces camera_subpath{};  // of the camera's path to x
    // Pixels^2 of the film per m^2 at x, if the camera sees x. If it sees the last of several
    // smoothly scattering surfaces z_1 = x, z_2, ...: pixels^2 per m^2 there, times the ratio of
    // the camera path's densities between them to the light path's,
    //   prod p(z_i+1 -> z_i) cos_i / (p(z_i -> z_i+1) cos_i+1),
    // and times SpecularTransfer::density of the chains between. 0 if light tracing could not make
    // the camera's path to x.
    float film_density = 0.0f;
    // If x may glint and the camera sees it by way of other surfaces: density with which a light
    // path leaves x towards them, 1/sr; film_density times this is CameraSubpath::film_density.
    // Else 0.
    float glint_exit_pdf = 0.0f;
    const FoldDirections* folds = nullptr;  // those that x draws one of; null: none
    uint32_t count = 0;
    std::array<CausticVertex, kLongestChain> vertices;  // from the receiver on; `count` are valid

    void append(const CausticVertex& vertex) { vertices[count++] = vertex; }
    bool is_rough() const {
        return std::any_of(vertices.begin(), vertices.begin() + count,
                           [](const CausticVertex& vertex) { return vertex.rough; });
    }
};

// Where a path ends at a light.
struct LightEnd {
    ChainEnd end;
    uint32_t light;
    bool delta;
    float cosine;  // at y; 1 for distant lights and points
    float pdf;     // LightPoint::pdf, the choice of the light included
    // Density of next event estimation (DirectSample::density) at the last vertex if that is rough,
    // or at x if there is none.
    float pdf_direct = 0.0f;
    // emission_pdf() towards the last vertex, or x; empty if not computed yet.
    std::optional<float> pdf_emitted{};
};
LightEnd light_end(const LightPoint& y, const Vec3& away);

// Sets CausticPath::film_density and glint_exit_pdf for light that arrives at the surface x from wi
// and leaves it towards wo, where the camera's path comes from. Both directions point away from x.
void set_film_density(const Scene& scene, const CameraSubpath& camera_subpath,
                      const SurfaceHit& hit, const Vec3& wo, const Vec3& wi, CausticPath& path);

// How often the camera's path may scatter before a receiver that light tracing owns.
uint32_t most_scatterings(const BounceLimits& limits);

// The path that begins with the camera's ray from x along w.
CausticPath camera_path(const Camera& camera, const Vec3& x, const Vec3& w);

// Whether a technique other than path tracing can find the path. What neither owns is path
// tracing's alone.
bool manifold_owns(const Techniques& techniques, const CausticPath& path);
bool light_tracing_owns(const Techniques& techniques, const CausticPath& path);
// The same for a light path that has not reached the camera yet: false only if it never can own it.
bool light_tracing_may_own(const Techniques& techniques, const CausticPath& path);

// Probability that a receiver makes an estimate by walks, beside RoundState::activation.
inline double walk_probability(const Techniques& techniques, float film_density) {
    const bool shares = techniques.manifold.finder == ChainFinder::walks && film_density > 0.0f;
    return shares ? techniques.light_tracing.walks : 1.0;
}

// Confidence in a manifold estimate: factor on its density in the balance heuristic, which would
// take all estimates of equal density for equally good. Less than 1 because:
// - Walks choose one of many solutions and count trials, more of them for several interactions.
// - Sheets cost more than a light path and miss some chains; the mean search trials, which the
//   pilot
//   measures, tell how hard those are to find.
// - Searches for rough chains are noisier still: in the focus of a ball of rough glass a chain is
//   found
//   again after a thousand trials, while path tracing is dense there.
// - MNEE and camera chains draw y alone. But beside light paths, what MNEE's density takes of the
//   chains
//   that its seeds miss falls to path tracing.
// Light paths find chains of several interactions as easily as others.
inline double manifold_confidence(const Techniques& techniques, const CausticPath& path) {
    if (path.from_camera) return 1.0;
    if (path.is_rough()) return path.count == 1 ? 1.0 / 2 : 1.0 / 32;
    switch (techniques.manifold.finder) {
        case ChainFinder::walks:
            if (path.film_density > 0.0f)
                return techniques.light_tracing.walk_confidence *
                       (path.count == 1 ? 1.0 / 32 : 1.0 / 512);
            return path.count == 1 ? 1.0 / 32 : 1.0 / 128;
        case ChainFinder::sheets:
            return 1.0 / (8 * (path.film_density > 0.0f ? techniques.light_tracing.mean_search_trials
                                                        : 1.0));
        case ChainFinder::mnee: return techniques.light_tracing.guide != nullptr ? 1.0 / 32 : 1.0;
    }
    return 1.0;
}

// Densities of a path by technique, per area at y (distant lights: solid angle at the light) and
// area at x, for one sample of the whole picture. All are divided by film_density, if that is
// positive.
struct CausticDensities {
    double geometry = 0.0;  // |dw_x/dA_y|, the cosine at y included
    double path_tracing =
        0.0;  // p_bsdf(w) |dw_x/dA_y| times the probabilities of all lobes; 0 for delta lights
    double folds = 0.0;   // the same for fold directions, times their confidence
    double direct = 0.0;  // next event estimation
    // p_L(y) times the probability of the caster and manifold_confidence(). For camera chains:
    // p_L(y) times CameraChains::estimates.
    double manifold = 0.0;
    double light_tracing =
        0.0;  // paths p_L(y) p_e(w_y) |dw_y/dA_x| times the probabilities of all lobes
    // For finders that use seeds: density of random searches for chains that the seeds miss, if
    // such a chain is shared between searches and directions. It is p_L(y) times the probability of
    // a search from the chain's first caster, or its pixel, times a confidence of 1/2 for the noise
    // of the trial count. The density of finding the chain is smaller by the number of trials. 0
    // for MNEE, which does not search.
    std::optional<double> missed;

    // geometry / sum: weight over density, times the geometry term; finite on a fold. A light
    // path's light is multiplied by it. A manifold estimate is multiplied by this times
    // manifold_confidence(), which is part of its density here but not of its sampling.
    double scale() const { return geometry / sum(); }
    double sum() const { return by_directions() + direct + manifold + light_tracing; }
    // Density of the techniques that draw a direction at x and follow it.
    double by_directions() const { return path_tracing + folds; }

    // Whether chains that seeds miss have weights of their own. A search may find such a chain
    // after a few trials, or after thousands; so whoever weighs it counts trials anew and shares by
    // that count. The count is random, but independent of how the chain was found, so the weights
    // sum to one on average. Looking whether seeds miss a chain costs shots, so it is done only
    // where directions are not dense. What MNEE seeds miss is path tracing's alone.
    bool missed_are_apart() const {
        constexpr double kDense = 4096.0;
        return missed && (*missed == 0.0 || kDense * manifold > by_directions());
    }
    // Weights of searches and of directions for a missed chain that takes so many trials to find.
    double share_of_searches(double trials) const {
        return shared_by_camera() * *missed / (trials * by_directions() + *missed);
    }
    double share_of_directions(double trials) const {
        if (*missed == 0.0) return shared_by_camera();
        return shared_by_camera() * trials * by_directions() / (trials * by_directions() + *missed);
    }
    // Number of trials after which counting may end, because next to nothing would be left to
    // searches. 1 if directions had next to nothing even after `most` trials.
    uint32_t telling_trials(uint32_t most) const {
        constexpr double kNextToNothing = 1.0 / 16;
        const double even = *missed / by_directions();  // that give both the same
        if (!(even < most / kNextToNothing)) return 1;
        return static_cast<uint32_t>(
            std::clamp(std::ceil(even / kNextToNothing), 1.0, static_cast<double>(most)));
    }
    // Share of fold directions in the weight of all directions.
    double share_of_folds() const { return folds > 0.0 ? folds / by_directions() : 0.0; }
    // Weight of directions and the manifold together.
    double shared_by_camera() const { return (by_directions() + manifold) / sum(); }
};
// Throughput of the chain's vertices along the camera's path (f |cos| at rough ones). Also fills in
// the probabilities of their lobes. It uses the positions of the vertices alone, so that all
// techniques get the same values.
Spectrum chain_throughput(const Scene& scene, CausticPath& path, const ChainEnd& end);
// What a chain between two smooth scatterings does to the camera's path.
struct SpecularTransfer {
    Spectrum weight;  // throughput over the probabilities of the lobes
    float density;  // ratio of the camera path's density to the light path's, without p and cos at the ends
};
// `path`: from the scattering at x on, its vertices' lobes are filled in; z is the next one. Empty
// where the chain cannot be, by the accuracy that there is.
std::optional<SpecularTransfer> specular_transfer(const Scene& scene, CausticPath& path,
                                                  const Vec3& z);
// Empty where the chain cannot be, by the accuracy that there is.
std::optional<CausticDensities> caustic_densities(const Techniques& techniques,
                                                  const CausticPath& path, const LightEnd& end);

// A path with a rough chain may also be seen as a shorter path that starts at the last rough
// vertex, which the other techniques share as usual. The rough chain's share is taken first; they
// share the rest.

// A rough vertex of a chain, without what chain_throughput() fills in. The camera's path arrives on
// the side of ng and leaves along wi. Empty if the surface is not rough in this sense.
std::optional<CausticVertex> rough_vertex(const Techniques& techniques, const SurfaceHit& hit,
                                          const Vec3& ng, const Vec3& wi);
// The manifold's weight in light that arrives by a path with rough vertices. `path` comes without
// the probabilities of its lobes.
float rough_chain_share(const Techniques& techniques, CausticPath path, const LightEnd& end);

// A surface where a rough chain that began at an earlier x may continue.
struct RoughVisit {
    const CausticPath* before;  // the chain so far; null: none, so nothing is shared
    const SurfaceHit& hit;
    const ClosureList& closures;
    const Vec3 &ng, &wo;
};
// f |cos| of the closures of `kinds` for light from wi, without the manifold's share. `behind`:
// vertices between the surface and the light.
Spectrum left_by_rough_chains(const Techniques& techniques, const RoughVisit& visit, const Vec3& wi,
                              uint32_t kinds, std::span<const CausticVertex> behind,
                              const LightEnd& end);

}  // namespace spc
