// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrator/subsurface.h"

namespace spc {
namespace {

constexpr int kMostScatterings = 256;  // as in Cycles; what is left then is lost
constexpr int kSureScatterings = 16;

Spectrum transmitted(const Spectrum& extinction, float t) {
    return {std::exp(-extinction.x * t), std::exp(-extinction.y * t), std::exp(-extinction.z * t)};
}

// A channel whose free path is drawn, by how much of the light is its own.
struct ChannelChoice {
    Spectrum probability;
    int channel;
};
ChannelChoice choose_channel(const Spectrum& weight, const Spectrum& single_scattering, float u) {
    const Spectrum share = weight * single_scattering;
    const float sum = share.x + share.y + share.z;
    if (!(sum > 0.0f)) return {Spectrum(1.0f / 3.0f), std::min(static_cast<int>(u * 3.0f), 2)};
    const Spectrum p = share * (1.0f / sum);
    return {p, u < p.x ? 0 : u < p.x + p.y ? 1 : 2};
}

// The surface at the end of a walk that came along `direction`, as if seen from beyond it.
Surface exit_surface(const Scene& scene, const SurfaceHit& hit, const Vec3& direction) {
    Surface surface;
    evaluate_surface(scene, hit, direction, surface);
    Vec3 n = surface.n;
    for (int i = 0; i < surface.closures.count; ++i)
        if (const auto* s = std::get_if<Subsurface>(&surface.closures.closures[i].kind)) n = s->n;
    const Terminator terminator = surface.closures.terminator;
    surface.closures.clear();
    surface.closures.terminator = terminator;
    surface.closures.add(Spectrum(1.0f), Lambert{n}, direction, false);
    return surface;
}

}  // namespace

// Free paths are drawn for one channel at a time; by the balance heuristic each channel counts them
// over the mean of all channels' densities.
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const Surface& surface,
                                         const Subsurface& closure, Pcg& pcg, uint64_t& rays) {
    const SubsurfaceMedium medium = medium_of(closure);
    const float u_entry = pcg.one();
    const std::optional<Vec3> entered = enter(closure, surface.ng, surface.wo, u_entry, pcg.two());
    if (!entered) return std::nullopt;
    Vec3 direction = *entered;
    Ray ray{offset_origin({surface.p, surface.ng, surface.p_error}, direction), direction};
    Spectrum weight(1.0f / std::max(closure.albedo.x, 1e-6f),
                    1.0f / std::max(closure.albedo.y, 1e-6f),
                    1.0f / std::max(closure.albedo.z, 1e-6f));
    Spectrum carried = weight * closure.albedo;  // for the choices alone
    for (int i = 0; i < kMostScatterings; ++i) {
        const ChannelChoice choice = choose_channel(carried, medium.single_scattering, pcg.one());
        const float t = -std::log(1.0f - pcg.one()) / medium.extinction[choice.channel];
        ray.t_far = t;
        ++rays;
        const std::optional<Hit> hit = scene.accel->intersect_alone(surface.hit.instance, ray);
        const Spectrum left = transmitted(medium.extinction, hit ? hit->t : t);
        const Spectrum density = hit ? left : medium.extinction * left;
        const float pdf = dot(choice.probability, density);
        if (!(pdf > 0.0f)) return std::nullopt;
        const Spectrum factor =
            (hit ? left : medium.extinction * medium.single_scattering * left) * (1.0f / pdf);
        weight *= factor;
        carried *= factor;
        if (hit) return SubsurfaceExit{exit_surface(scene, hit->surface, direction), weight};
        if (i >= kSureScatterings) {
            const float q = std::min(1.0f, max_component(carried));
            if (pcg.one() >= q) return std::nullopt;
            weight *= 1.0f / q;
            carried *= 1.0f / q;
        }
        ray.origin = ray.origin + direction * t;
        direction = ray.direction = sample_phase(direction, medium.anisotropy, pcg.two());
    }
    return std::nullopt;
}

}  // namespace spc
