// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"
#include "integrator/path_tracer.h"

namespace spc {

namespace {

float part_of(float part, float whole) { return whole > 0.0f ? clamp01(part / whole) : 0.0f; }

// Colour of one of the two sides of an interface, or of all that another closure scatters.
using LobeColors = std::array<Spectrum, kLobes>;
void add_color(const Closure& closure, const Vec3& wo, LobeColors& to) {
    const ClosureTraits& kind = traits(closure.kind);
    if (kind.straight) return;
    const auto add = [&](BounceKind scattered, const ClosureKind& part) {
        to[static_cast<size_t>(lobe_of(scattered))] += closure.weight * albedo(part, wo);
    };
    // The stored weight has the energy compensation already.
    if (const auto* reflector = std::get_if<MicrofacetReflection>(&closure.kind)) {
        MicrofacetReflection once = *reflector;
        once.energy_compensated = false;
        MicrofacetReflection white = once;
        white.fresnel = {};
        const float energy =
            albedo(white, wo).x;  // light lost between facets is no matter of colour
        if (energy > 0.0f)
            to[static_cast<size_t>(lobe_of(kind.reflected))] +=
                closure.weight * albedo(once, wo) * (1.0f / energy);
        return;
    }
    const auto* dielectric = std::get_if<MicrofacetDielectric>(&closure.kind);
    if (dielectric == nullptr) return add(kind.reflected, closure.kind);
    MicrofacetDielectric reflects = *dielectric, refracts = *dielectric;
    reflects.energy_compensated = refracts.energy_compensated = false;
    reflects.transmission_tint = refracts.reflection_tint = Spectrum(0.0f);
    if (dielectric->reflects) add(kind.reflected, reflects);
    if (dielectric->refracts) add(kind.transmitted, refracts);
}

LobeColors colors_of(const Surface& surface) {
    LobeColors colors{Spectrum(0.0f), Spectrum(0.0f), Spectrum(0.0f)};
    for (int i = 0; i < surface.closures.count; ++i)
        add_color(surface.closures.closures[static_cast<size_t>(i)], surface.wo, colors);
    return colors;
}

// Facets narrower than this show an image of the scene rather than their own surface, as in Cycles.
constexpr float kSharpAlpha = 0.075f;
bool shows_reflections(const ClosureKind& kind) {
    return std::visit(
        [](const auto& c) {
            if constexpr (requires { c.alpha; })
                return c.alpha <= kSharpAlpha;
            else
                return false;
        },
        kind);
}

Vec3 normal_of(const ClosureKind& kind, const Vec3& otherwise) {
    return std::visit(
        [&](const auto& c) {
            if constexpr (requires { c.n; })
                return c.n;
            else
                return otherwise;
        },
        kind);
}

}  // namespace

LobeShares lobe_shares(const Surface& surface, const Vec3& wi) {
    const auto of = [&](uint32_t kinds) {
        return eval(surface.closures, surface.ng, surface.wo, wi, kinds).f_cos;
    };
    const Spectrum all = of(kAllKinds), diffuse = of(kind_bit(BounceKind::diffuse)),
                   transmitted = of(kind_bit(BounceKind::transmission));
    LobeShares shares = only(Lobe::glossy);
    for (int c = 0; c < 3; ++c) {
        const float d = part_of(diffuse[c], all[c]), t = part_of(transmitted[c], all[c]);
        shares[0][c] = d;
        shares[1][c] = std::max(1.0f - d - t, 0.0f);
        shares[2][c] = t;
    }
    return shares;
}

void PathTracer::add_met(const Spectrum& emitted, Pass if_seen, uint32_t light_group,
                         PathLight& light) const {
    light.total += emitted;
    if (light.values == nullptr) return;
    const Spectrum value = emitted * light.scale;
    light.values->add_to_group(light_group, value);
    if (scatterings() == 0)
        (*light.values)[if_seen] += value;
    else
        light.values->add_scattered(value, lobes, scatterings() == 1);
}

void PathTracer::add_scattered(const Spectrum& value, const Surface& surface, const Vec3& wi,
                               uint32_t of_light, PathLight& light, bool direct) const {
    light.total += value;
    if (light.values != nullptr)
        tell_scattered(value, surface, wi, of_light, *light.values, direct);
}

void PathTracer::tell_scattered(const Spectrum& value, const Surface& surface, const Vec3& wi,
                                uint32_t of_light, PassValues& values, bool direct) const {
    if (is_black(value)) return;
    values.add_to_group(settings.group_of_light(of_light), value);
    if (!values.asked().tell_lobes()) return;
    values.add_scattered(value, bounces.total == 0 ? lobe_shares(surface, wi) : lobes, direct);
}

void PathTracer::tell_surface(const Surface& surface, PassValues& values) const {
    if (values.wants_coverage()) {
        const Instance& instance = scene().instances[surface.hit.instance];
        const float opacity = 1.0f - std::min(mean(surface.closures.transparency), 1.0f);
        values.coverage.add(
            {instance.crypto_object, scene().material_of(surface.hit).crypto, instance.crypto_asset},
            mean(throughput) * opacity);
    }
    if (!values.asked().tell_colors()) return;
    const LobeColors colors = colors_of(surface);
    for (size_t i = 0; i < kLobes; ++i)
        values[pass_of(Pass::diffuse_color, static_cast<Lobe>(i))] += throughput * colors[i];
}

namespace {

// What nodes of a material write, each by `color(node)` or `value(node)`; nothing where that is no
// number.
template <class Color, class Value>
void add_aovs(const std::vector<PassSources::Aov>& aovs, const Color& color, const Value& value,
              PassValues& values) {
    for (const PassSources::Aov& aov : aovs) {
        const bool is_color = aov.pass < first_of(CustomKind::value_aov);
        const Vec3 written = is_color ? color(aov.node) : Vec3(value(aov.node), 0.0f, 0.0f);
        if (!can_be_held(written)) continue;
        values[aov.pass] += written;
        values.value(aov.pass).alpha += 1.0f;
    }
}

}  // namespace

void PathTracer::tell_aovs(const Surface& surface, float length, PassValues& values) {
    const SurfaceHit& hit = surface.hit;
    const RayState state = seen_by(length);
    add_aovs(
        settings.pass_sources->aovs[scene().material_index(hit.instance, hit.triangle)],
        [&](uint32_t node) { return surface_color_aov(scene(), hit, surface.wo, state, node); },
        [&](uint32_t node) { return surface_value_aov(scene(), hit, surface.wo, state, node); },
        values);
    writes_aovs = 1.0f - mean(surface.closures.transparency) < settings.pass_alpha_threshold;
}

void PathTracer::tell_aovs_of_world(PassValues& values) const {
    const Environment& environment = scene().environment;
    if (environment.material == kNone || (environment.visibility & ray_kind) == 0) return;
    const Material& material = scene().materials[environment.material];
    ViewSpace turned;
    const ShadingPoint<float> point =
        background_point(material, ray.direction, seen_by(0.0f), scene().view, turned);
    const std::vector<Image>& images = scene().images;
    add_aovs(
        settings.pass_sources->aovs[environment.material],
        [&](uint32_t node) { return evaluate_color_aov(material, images, point, node); },
        [&](uint32_t node) { return evaluate_value_aov(material, images, point, node); }, values);
}

namespace {

Spectrum at_most_one(const Spectrum& s) {
    return {std::min(s.x, 1.0f), std::min(s.y, 1.0f), std::min(s.z, 1.0f)};
}

}  // namespace

void Features::look_at_world(const Spectrum& radiance, PassValues& values) const {
    // Where the film is transparent nobody has asked yet whether a world has a number there.
    if (is_finite(radiance)) values[Pass::denoising_albedo] += throughput_ * at_most_one(radiance);
}

bool Features::look(const Scene& scene, const Surface& surface, float length, PassValues& values) {
    values[Pass::denoising_depth].x += length * mean(throughput_);
    float all = 0.0f, own = 0.0f;
    Vec3 normal(0.0f);
    Spectrum color(0.0f);
    for (int i = 0; i < surface.closures.count; ++i) {
        const Closure& closure = surface.closures.closures[static_cast<size_t>(i)];
        if (traits(closure.kind).straight) continue;
        all += closure.sample_weight;
        normal += normal_of(closure.kind, surface.n) * closure.sample_weight;
        if (shows_reflections(closure.kind)) continue;
        own += closure.sample_weight;
        LobeColors colors{Spectrum(0.0f), Spectrum(0.0f), Spectrum(0.0f)};
        add_color(closure, surface.wo, colors);
        color += colors[0] + colors[1] + colors[2];
    }
    constexpr float kLeastOwn = 1.0f / 4;
    if (all > 0.0f && !(own > kLeastOwn * all)) return false;
    const Vec3 n = all > 0.0f ? safe_normalize(normal, surface.n) : surface.n;
    const Transform& camera = scene.camera.to_world;
    // Cycles' camera looks along +z.
    values[Pass::denoising_normal] +=
        Vec3(dot(n, camera.column(0)), dot(n, camera.column(1)), -dot(n, camera.column(2))) *
        mean(throughput_);
    values[Pass::denoising_albedo] += throughput_ * (color + at_most_one(surface.closures.emission));
    return true;
}

}  // namespace spc
