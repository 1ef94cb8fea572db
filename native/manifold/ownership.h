// SPDX-License-Identifier: GPL-3.0-or-later
// Who estimates a path of light that reaches a receiver through specular interactions: path
// tracing, directions next to folds, the manifold, light tracing, or several of them.
//
// A path is described by what it is, not by how it was found; from that one function computes the
// densities with which each technique finds it, and all of them weigh it by the balance heuristic.
#pragma once

#include "bsdf/closure.h"
#include "manifold/camera_chains.h"
#include "manifold/emission.h"

namespace spc {

class FoldDirections;

// Cycles' limits: a path may scatter this often and still be lit at its last vertex.
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
    // Past a limit a path still sees lights, but no more surfaces: its last vertex had its direct
    // light already.
    bool exhausted(const BounceLimits& limits) const {
        return total > limits.total || diffuse > limits.diffuse || glossy > limits.glossy ||
               transmission > limits.transmission;
    }
    // Surfaces that the path may still look through, and every shadow ray that it casts.
    uint32_t transparent_left(const BounceLimits& limits) const {
        return limits.transparent - std::min(limits.transparent, transparent);
    }
    // Whether a vertex here may scatter once more, by whichever smooth closure, and be lit at the
    // next vertex.
    bool leaves_room_for_chain(const BounceLimits& limits) const {
        return total < limits.total && diffuse < limits.diffuse && glossy < limits.glossy &&
               transmission < limits.transmission;
    }
};

// Light paths beside the camera's.
struct LightTracing {
    const EmissionGuide* guide = nullptr;  // null: there are none
    double paths = 0.0;                    // for each sample of the whole picture
    double goes_on = 1.0;                  // share of them that may scatter at the receiver
    // Of the chains that light paths find, trials to come to one, 1 where a sheet leads to it: mean
    // over the light that they carry.
    double mean_search_trials = 1.0;
    double manifold_share = 1.0;  // of that light
    // Of receivers to which they may come, so many have the manifold's walks, which are worth so much
    // of what they are elsewhere.
    double walks = 1.0, walk_confidence = 1.0;
    // CameraSubpath::film_density, for each light path, from which on they leave to path tracing what
    // glints throw on, of which that has the mean over a footprint.
    double beside_glints = std::numeric_limits<double>::infinity();
    // Whether the manifold leaves to them, and to path tracing, all that comes to receivers to which the
    // camera comes as they do.
    bool alone = false;
};

// All on which ownership depends besides the path.
struct Techniques {
    const Scene& scene;
    const LightSet& lights;
    const CasterSet& casters;  // where the manifold looks for chains: some of the scene's, or all
    const CasterSet& rough_chain_casters;
    const ManifoldSettings& manifold;
    const LightTracing& light_tracing;
    const CameraChains* camera_chains;  // null: there are none
    const BounceLimits& limits;
};

// One interaction by a caster's specular interface, or at a facet of a rough one.
struct CausticVertex {
    SurfaceHit hit;
    Interaction interaction;
    // Of a delta lobe for a path from the receiver, as delta_lobe() states it; at a rough vertex
    // ClosureEval::pdf_omega, 1/sr.
    float probability = 0.0f;
    // Of a delta lobe for a path from the light, likewise, where that is known already; else 0.
    float probability_from_light = 0.0f;
    bool rough = false;
    float facet_pdf = 0.0f;  // of a rough vertex, see there
};

// Smooth scatterings of the camera's path before a surface, and its turns at casters between them.
// Straight through transparent surfaces counts as nothing.
struct SubpathBounces {
    uint32_t scatterings = 0, reflections = 0, refractions = 0;

    void add_turn(Interaction interaction) {
        ++(interaction == Interaction::reflection ? reflections : refractions);
    }
};
// How the camera's path comes to a surface: directly, or from a surface that it sees directly, by
// smooth scatterings and by way of casters between them.
struct CameraSubpath {
    // CausticPath::film_density but for the light path's density of leaving this surface; 0: any other way.
    float film_density = 0.0f;
    SubpathBounces bounces{};
};

// From a smooth scattering at the receiver x through the chain: without the light's end. With no
// vertices it is light that comes straight to x, which a rough caster throws on.
struct CausticPath {
    Vec3 x{0.0f};
    float p_error = 0.0f;   // of x, see RayStart
    ReceiverSides sides{};  // by the side of the path that arrived
    // Of the scattering at x towards the chain, 1/sr; where x is the camera, pixels^2 of the film
    // per sr, of which path tracing takes a sample each.
    float pdf_omega = 0.0f;
    bool receiver = false;      // x has the role, the closure and the bounces left
    bool from_camera = false;   // x is a point of the camera's lens: a camera chain
    bool rough_caster = false;  // x lies on one
    // Whether a chain with rough vertices may begin at x. Not on a rough surface that is reached by
    // a scattering: there a chain that has begun before goes on.
    bool begins_rough = true;
    // Straight through a transparent part of any caster, between x and the first vertex or between
    // vertices.
    bool through_caster = false;
    // Bounces of the camera's path when it came to x; none in a light path's record, which does not
    // know of which kinds they would be.
    BounceCounts before{};
    SubpathBounces camera_subpath{};  // of the camera's path to x
    // Pixels^2 of the film per m^2 at x where the camera sees x. Where it sees the last of several
    // surfaces z_1 = x, z_2, ... that scatter smoothly: pixels^2 per m^2 there, times what the
    // densities of the camera's path between them are in those of the light path,
    //   prod p(z_i+1 -> z_i) cos_i / (p(z_i -> z_i+1) cos_i+1),
    // and SpecularTransfer::density of the casters on the way.
    // 0 if the camera's path came any other way.
    float film_density = 0.0f;
    // Where x may glint and the camera sees it by way of others: with what density a light path leaves
    // x as this one does, 1/sr. Times film_density that is CameraSubpath::film_density. Else 0.
    float glint_exit_pdf = 0.0f;
    const FoldDirections* folds = nullptr;  // of which x draws one; null: it does not
    uint32_t count = 0;
    std::array<CausticVertex, kLongestChain> vertices;  // from the receiver on; `count` are valid

    void append(const CausticVertex& vertex) { vertices[count++] = vertex; }
    bool is_rough() const {
        return std::any_of(vertices.begin(), vertices.begin() + count,
                           [](const CausticVertex& vertex) { return vertex.rough; });
    }
};

// Where the path ends.
struct LightEnd {
    ChainEnd end;
    uint32_t light;
    bool delta;
    float cosine;  // at y; 1 for distant lights and points
    float pdf;     // LightPoint::pdf, the choice of the light included
    // Where the last vertex is rough, or there is none: of next event estimation there, or at x, as
    // DirectSample::density has it.
    float pdf_direct = 0.0f;
    // emission_pdf() towards the last vertex, or x, where that is known already.
    std::optional<float> pdf_emitted{};
};
LightEnd light_end(const LightPoint& y, const Vec3& away);

// CausticPath::film_density and glint_exit_pdf for light that arrives at the surface x along `wi`
// (from the surface) and leaves it for the camera's path along `wo`.
void set_film_density(const Scene& scene, const CameraSubpath& camera_subpath,
                      const SurfaceHit& hit, const Vec3& wo, const Vec3& wi, CausticPath& path);

// So often may the camera's path scatter before a receiver of light tracing's, at most.
uint32_t most_scatterings(const BounceLimits& limits);

// The path of which the camera's ray is the beginning.
CausticPath camera_path(const Camera& camera, const Vec3& x, const Vec3& w);

// What a technique other than path tracing can find. Whatever neither owns is path tracing's alone.
bool manifold_owns(const Techniques& techniques, const CausticPath& path);
bool light_tracing_owns(const Techniques& techniques, const CausticPath& path);
// As far as a path is known that has not come to the camera yet.
bool light_tracing_may_own(const Techniques& techniques, const CausticPath& path);

// The probability that a receiver has the manifold's estimate by walks at all, beside that of the round.
inline double walk_probability(const Techniques& techniques, float film_density) {
    const bool shares = techniques.manifold.finder == ChainFinder::walks && film_density > 0.0f;
    return shares ? techniques.light_tracing.walks : 1.0;
}

// The balance heuristic takes estimates of equal density for equally good. The manifold's have this
// much of the confidence of a sample that was drawn with the same density: walks choose one of many
// solutions and count trials, the more for chains of several interactions; sheets cost more than a
// light path and miss some chains. Where MNEE seeds find a chain, nothing but y is left to chance;
// but what they take from light paths of the chains that they miss is left to path tracing. So it is
// with the chain seeds of camera chains. Chains with rough vertices are left to chance alone, the more so with
// several: in the focus of a ball of rough glass one is met again after a thousand trials, and path
// tracing is dense. What walks are worth beside light paths, and how much light sheets miss there, and
// how hard that is to find, is measured; light paths find chains of several interactions as easily.
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

// By area at y (distant light: solid angle at the light) and area at x; of the camera's paths for
// one sample of the whole picture; all divided by film_density, if that is positive.
struct CausticDensities {
    double geometry = 0.0;  // |dw_x/dA_y|, the cosine at y included
    double path_tracing =
        0.0;  // p_bsdf(w) |dw_x/dA_y| times the probabilities of all lobes; 0 for delta lights
    double folds = 0.0;   // the same of directions next to folds, times their confidence
    double direct = 0.0;  // of next event estimation
    // p_L(y) times the probability of the caster and manifold_confidence(); of camera chains times their estimates.
    double manifold = 0.0;
    double light_tracing =
        0.0;  // paths p_L(y) p_e(w_y) |dw_y/dA_x| times the probabilities of all lobes
    // Of random searches for chains that the manifold's definite search misses, where others take its
    // share of them: p_L(y) times the probability of a search that begins at the chain's caster, or in the
    // pixel that shows it, half of it for the noise of its count. One in so many trials comes to the
    // chain. 0: there are none, beside MNEE seeds.
    std::optional<double> missed;

    // What light tracing multiplies the path's light with: its geometry over the densities, of which
    // the estimator's own one divides it and the sum weighs. Finite on a fold. The manifold takes
    // manifold_confidence() of it, which it has not been divided by.
    double scale() const { return geometry / sum(); }
    double sum() const { return by_directions() + direct + manifold + light_tracing; }
    // Of those who draw a direction at x and follow it.
    double by_directions() const { return path_tracing + folds; }

    // A chain that sheets miss is found by searches, of which a few may do, or thousands. Who weighs it
    // counts trials anew, by which both have their share of what they are left with: the count is
    // random, but since it is independent of how the chain was found, the weights sum to one on
    // average. It costs a look whether sheets miss the chain, so that is only done where directions
    // are not dense. What MNEE seeds miss is path tracing's alone.
    bool missed_are_apart() const {
        constexpr double kDense = 4096.0;
        return missed && (*missed == 0.0 || kDense * manifold > by_directions());
    }
    // Shares of a missed chain, by so many trials to find it.
    double share_of_searches(double trials) const {
        return shared_by_camera() * *missed / (trials * by_directions() + *missed);
    }
    double share_of_directions(double trials) const {
        if (*missed == 0.0) return shared_by_camera();
        return shared_by_camera() * trials * by_directions() / (trials * by_directions() + *missed);
    }
    // How many trials to count before the shares are known well enough: beyond, next to nothing is left
    // to searches. One where directions have next to nothing, were it `most`.
    uint32_t telling_trials(uint32_t most) const {
        constexpr double kNextToNothing = 1.0 / 16;
        const double even = *missed / by_directions();  // that give both the same
        if (!(even < most / kNextToNothing)) return 1;
        return static_cast<uint32_t>(
            std::clamp(std::ceil(even / kNextToNothing), 1.0, static_cast<double>(most)));
    }
    // Of what directions have.
    double share_of_folds() const { return folds > 0.0 ? folds / by_directions() : 0.0; }
    double shared_by_camera() const { return (by_directions() + manifold) / sum(); }
};
// Throughput of the chain's vertices as the camera's path comes to them, f |cos| of rough ones;
// fills in the probabilities of their lobes. By the places of the vertices alone, so that all techniques
// have the same.
Spectrum chain_throughput(const Scene& scene, CausticPath& path, const ChainEnd& end);
// What turns at casters make of the camera's path from one smooth scattering to the next.
struct SpecularTransfer {
    Spectrum weight;  // throughput over the probabilities of their lobes
    float density;    // of the camera's path, in the light path's, but for p and cos at both ends
};
// `path`: from the scattering at x on, its vertices' lobes are filled in; z is the next one. Empty
// where the chain cannot be, by the accuracy that there is.
std::optional<SpecularTransfer> specular_transfer(const Scene& scene, CausticPath& path,
                                                  const Vec3& z);
// Empty where the chain cannot be, by the accuracy that there is.
std::optional<CausticDensities> caustic_densities(const Techniques& techniques,
                                                  const CausticPath& path, const LightEnd& end);

// A chain with rough vertices is one of several ways to see the path: from its last rough vertex on
// it is a path of its own, which those who find it share as ever. What the rough chain takes of the
// path comes first; they have the rest.

// A rough vertex as part of a chain, but for what chain_throughput() fills in: where the camera's
// path goes on along wi, ng being on the side that it comes from. Empty where the surface is none.
std::optional<CausticVertex> rough_vertex(const Techniques& techniques, const SurfaceHit& hit,
                                          const Vec3& ng, const Vec3& wi);
// The share that the manifold has of light which arrives by a path with rough vertices, without the
// probabilities of their lobes.
float rough_chain_share(const Techniques& techniques, CausticPath path, const LightEnd& end);

// Where a chain that began at an earlier x may go on.
struct RoughVisit {
    const CausticPath* before;  // the chain so far; null: there is none, nothing to share
    const SurfaceHit& hit;
    const ClosureList& closures;
    const Vec3 &ng, &wo;
};
// f |cos| of closures of `kinds` for light from wi, less what the manifold takes of it: light that
// arrives by way of the vertices `behind`.
Spectrum left_by_rough_chains(const Techniques& techniques, const RoughVisit& visit, const Vec3& wi,
                              uint32_t kinds, std::span<const CausticVertex> behind,
                              const LightEnd& end);

}  // namespace spc
