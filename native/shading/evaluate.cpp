// SPDX-License-Identifier: GPL-3.0-or-later
// The interpreter: value instructions over T, then closures from their results.
#include "bsdf/albedo.h"
#include "bsdf/fresnel.h"
#include "core/uninitialized_array.h"
#include "shading/normal_map.h"
#include "shading/program.h"
#include "shading/spaces.h"

namespace spc {
namespace {

// Cycles takes rough facets below this roughness for none.
constexpr float kSmoothDiffuse = 1e-5f;
// Neither axis of a brushed lobe is a delta.
constexpr float kLeastStretchedAlpha = 2.0f * kDeltaAlpha;

template <class T>
void run_image(const Instruction& i, const Registers<T>& r, std::span<const Image> images) {
    const Vector3<T> at = r.vector(i, 0);
    const Rgba<T> c = lookup<T>(images[i.index], at.x, at.y, mode_interpolation(i.mode),
                                mode_extension(i.mode), mode_straight(i.mode));
    r.store(i.out, Vector3<T>{c.r, c.g, c.b});
    r.store(static_cast<Operand>(i.out + 3), c.a);
}

// A block of pairs: a tile's number, counted from 0 in rows of ten, and its image; before them how
// many there are. Where there is no tile it is magenta.
template <class T>
void run_tiled_image(const Program& program, const Instruction& i, const Registers<T>& r,
                     std::span<const Image> images) {
    const Vector3<T> at = r.vector(i, 0);
    const float column = std::floor(value_of(at.x)), row = std::floor(value_of(at.y));
    const float* block = program.blocks.data() + i.index;
    Rgba<T> c{T(1.0f), T(0.0f), T(1.0f), T(1.0f)};
    for (const float *tile = block + 1, *end = tile + 2 * static_cast<size_t>(*block); tile < end;
         tile += 2) {
        if (column < 0.0f || column >= 10.0f || *tile != 10.0f * row + column) continue;
        c = lookup<T>(images[static_cast<size_t>(tile[1])], at.x - T(column), at.y - T(row),
                      mode_interpolation(i.mode), mode_extension(i.mode), mode_straight(i.mode));
        break;
    }
    r.store(i.out, Vector3<T>{c.r, c.g, c.b});
    r.store(static_cast<Operand>(i.out + 3), c.a);
}

template <class T>
void run_attribute(const Instruction& i, const Registers<T>& r, const ShadingPoint<T>& point) {
    const std::array<T, 4>& value = point.attributes[i.index];
    r.store(i.out, Vector3<T>{value[0], value[1], value[2]});
    r.store(static_cast<Operand>(i.out + 3), value[3]);
}

uint32_t depth_of(const RayState& ray, RayDepth depth) {
    switch (depth) {
        case RayDepth::total: return ray.depth;
        case RayDepth::diffuse: return ray.diffuse_depth;
        case RayDepth::glossy: return ray.glossy_depth;
        case RayDepth::transparent: return ray.transparent_depth;
        case RayDepth::transmission: return ray.transmission_depth;
    }
    return 0;
}

template <class T>
class RegisterFile {
public:
    explicit RegisterFile(const Program& program)
        : registers{storage_.data(), program.constants.data(), program.operands.data(),
                    program.blocks.data()} {}
    const Registers<T> registers;

private:
    UninitializedArray<T, kMaxRegisters> storage_;
};

template <class T>
Vector3<T> run_bump(const Program& program, const Instruction& i, const Registers<T>& r,
                    std::span<const Image> images, const ShadingPoint<T>& point);

template <class T>
Vector3<T> constant(const Vec3& a) {
    return {T(a.x), T(a.y), T(a.z)};
}

Spectrum spectrum(const Vector3<float>& a) { return {a.x, a.y, a.z}; }

Coat coat_of(const Registers<float>& r, Operand layer, Operand tint) {
    const Vector3<float> a = r.vector(layer);
    return {a.x, a.y, a.z, spectrum(r.vector(tint))};
}

// No normal and no height depends on one.
void run_coat(const Instruction& i, const Registers<float>& r, const ShadingPoint<float>& point) {
    const Vector3<float> n = r.operand(i, 0) == kNoOperand ? facing_normal(point) : r.vector(i, 0);
    const Spectrum t =
        coat_transmittance(coat_of(r, r.operand(i, 1), r.operand(i, 2)), value_of(n), point.wo);
    r.store(i.out, Vector3<float>{t.x, t.y, t.z});
}

template <class T>
void run(const Program& program, const Section& section, std::span<const Image> images,
         const ShadingPoint<T>& point, const Registers<T>& r) {
    for (uint32_t k = section.begin; k < section.end; ++k) {
        const Instruction& i = program.instructions[k];
        switch (i.op) {
            case Op::attribute: run_attribute(i, r, point); break;
            case Op::position: r.store(i.out, point.position); break;
            case Op::position_object: r.store(i.out, point.position_object); break;
            case Op::normal_object: {
                const Vector3<T> n =
                    r.operand(i, 0) == kNoOperand ? facing_normal(point) : r.vector(i, 0);
                const Vector3<T> held = i.mode == kHeldStill ? constant<T>(value_of(n)) : n;
                r.store(i.out, safe_normalize(apply_transposed(point.object_to_world->row, held)));
                break;
            }
            case Op::normal: {
                const Vector3<T> n = facing_normal(point);
                r.store(i.out, i.mode == kHeldStill ? constant<T>(value_of(n)) : n);
                break;
            }
            case Op::tangent_object: {
                const bool known = point.tangent_object != nullptr;
                r.store(i.out, known ? constant<T>(value_of(point.tangent_object[i.index]))
                                     : Vector3<T>{});
                r.store(static_cast<Operand>(i.out + 3),
                        T(known ? point.bitangent_sign[i.index] : 1.0f));
                break;
            }
            case Op::direction_to_world:
                r.store(i.out, apply_rows(point.object_to_world->row, r.vector(i, 0)));
                break;
            case Op::true_normal: r.store(i.out, constant<T>(point.ng)); break;
            case Op::incoming: r.store(i.out, constant<T>(point.wo)); break;
            case Op::facing: {
                const Vector3<T> n =
                    r.operand(i, 0) == kNoOperand ? facing_normal(point) : r.vector(i, 0);
                r.store(i.out, T(dot(value_of(n), point.wo)));
                break;
            }
            case Op::backfacing: r.store(i.out, T(point.backfacing ? 1.0f : 0.0f)); break;
            case Op::barycentric:
                r.store(i.out, Vector3<T>{T(1.0f) - point.u - point.v, point.u, T(0.0f)});
                break;
            case Op::transform: r.store(i.out, transformed(i.mode, r.vector(i, 0), point)); break;
            case Op::view_position: r.store(i.out, in_view(point)); break;
            case Op::window: r.store(i.out, in_window(point)); break;
            case Op::mesh_tangent:
                r.store(i.out, apply(*point.object_to_world, point.tangent_object[i.index]));
                break;
            case Op::wireframe:
                r.store(i.out, T(is_near_side(value_of(r.scalar(i, 0)), i.mode != 0, point)));
                break;
            case Op::tiled_image: run_tiled_image(program, i, r, images); break;
            case Op::ray_kind:
                r.store(i.out, T((point.ray.kinds & i.mode) != 0 ? 1.0f : 0.0f));
                break;
            case Op::ray_length: r.store(i.out, T(point.ray.length)); break;
            case Op::ray_depth:
                r.store(i.out,
                        T(static_cast<float>(depth_of(point.ray, static_cast<RayDepth>(i.mode)))));
                break;
            case Op::image: run_image(i, r, images); break;
            case Op::tangent_normal:
                r.store(i.out, map_normal(NormalSpace::tangent, r.scalar(i, 0), r.vector(i, 1),
                                          i.index, point));
                break;
            case Op::space_normal:
                r.store(i.out, map_normal(static_cast<NormalSpace>(i.mode), r.scalar(i, 0),
                                          r.vector(i, 1), 0, point));
                break;
            case Op::bump:  // heights have none
                if constexpr (!std::is_same_v<T, Dual<Dual2>>)
                    r.store(i.out, run_bump(program, i, r, images, point));
                break;
            case Op::shading_normal: {
                const Vector3<T> n = safe_normalize(r.vector(i, 0));
                r.store(i.out, is_zero(n) ? facing_normal(point) : n);
                break;
            }
            case Op::coat:
                if constexpr (std::is_same_v<T, float>) run_coat(i, r, point);
                break;
            default: run_arithmetic(i, r); break;
        }
    }
}

template <class T>
Vector3<T> run_bump(const Program& program, const Instruction& i, const Registers<T>& r,
                    std::span<const Image> images, const ShadingPoint<T>& point) {
    const Vector3<T> n = r.operand(i, 2) == kNoOperand ? facing_normal(point) : r.vector(i, 2);
    if (point.around == nullptr) return n;
    const Section& height = program.heights[i.index];
    const RegisterFile<Dual<T>> file(program);
    run(program, height, images, *point.around, file.registers);
    const T distance = times(r.scalar(i, 1), i.mode != 0 ? -1.0f : 1.0f);
    return bump_normal(n, file.registers.scalar(height.result), r.scalar(i, 0), distance, point);
}

template <class T>
Vector3<T> evaluate_vector(const Program& program, const Section& section,
                           std::span<const Image> images, const ShadingPoint<T>& point) {
    const RegisterFile<T> file(program);
    run(program, section, images, point, file.registers);
    return file.registers.vector(section.result);
}

Spectrum evaluate_spectrum(const Program& program, const Section& section,
                           std::span<const Image> images, const ShadingPoint<float>& point) {
    if (section.result == kNoOperand) return Spectrum(0.0f);
    return spectrum(evaluate_vector(program, section, images, point));
}

// Builds the closures of one point from its registers.
class ClosureBuilder {
public:
    ClosureBuilder(const Registers<float>& registers, const ShadingPoint<float>& point,
                   Operand surface_normal, BumpCorrection bump_correction, ClosureList& list)
        : r_(registers),
          point_(point),
          bump_correction_(bump_correction),
          list_(list),
          surface_normal_(value_of(surface_normal == kNoOperand ? facing_normal(point)
                                                                : registers.vector(surface_normal))) {
        list.terminator = {bump_correction, 1.0f, surface_normal_};
    }

    void add(const ClosureInstruction& c) {
        const float scale = r_.scalar(operand(c, kWeightOperand));
        if (scale == 0.0f) return;
        Spectrum weight(scale);
        if (c.through != kNoOperand) weight *= spectrum(r_.vector(c.through));
        switch (c.op) {
            case ClosureOp::lambert:
                return add(c, color(c, 2) * weight, Lambert{diffuse_normal(c)});
            case ClosureOp::rough_diffuse: return add_rough_diffuse(c, weight);
            case ClosureOp::translucent:
                return add(c, color(c, 2) * weight, Translucent{glossy_normal(c)});
            case ClosureOp::sheen: {
                const float roughness = std::clamp(scalar(c, 3), kLeastSheenRoughness, 1.0f);
                return add(c, color(c, 2) * weight, Sheen{diffuse_normal(c), roughness});
            }
            case ClosureOp::velvet: {
                const float sigma = std::clamp(scalar(c, 3), 0.01f, 1.0f);  // Cycles' bounds
                return add(c, color(c, 2) * weight, Velvet{diffuse_normal(c), sigma});
            }
            case ClosureOp::burley_diffuse:
                return add(c, color(c, 2) * weight,
                           BurleyDiffuse{diffuse_normal(c), clamp01(scalar(c, 3))});
            case ClosureOp::schlick_sheen:
                return add(c, color(c, 2) * weight, SchlickSheen{diffuse_normal(c)});
            case ClosureOp::diffuse_toon: return add_toon<BounceKind::diffuse>(c, weight);
            case ClosureOp::glossy_toon: return add_toon<BounceKind::glossy>(c, weight);
            case ClosureOp::transparent: return add(c, color(c, 2) * weight, Transparent{});
            case ClosureOp::holdout: list_.holdout += weight; return;
            case ClosureOp::glossy: return add_glossy(c, weight);
            case ClosureOp::ashikhmin_shirley: {
                if (alpha(c) <= kDeltaAlpha) return add_glossy(c, weight);
                AshikhminShirley lobe{glossy_normal(c), alpha(c)};
                stretch(c, lobe);
                return add(c, color(c, 3) * weight, lobe);
            }
            case ClosureOp::metal: {
                Fresnel fresnel;
                fresnel.kind = Fresnel::Kind::f82;
                fresnel.f0 = color(c, 3);
                fresnel.f82 = color(c, 4);
                fresnel.film = film(c);
                return add_reflection(c, weight, fresnel);
            }
            case ClosureOp::conductor: {
                Fresnel fresnel;
                fresnel.kind = Fresnel::Kind::conductor;
                fresnel.f0 = color(c, 3);
                fresnel.f82 = color(c, 4);
                fresnel.film = film(c);
                return add_reflection(c, weight, fresnel);
            }
            case ClosureOp::dielectric: return add_dielectric(c, weight);
            case ClosureOp::coated: return add_coated(c, weight);
            case ClosureOp::hair_fibre: return add_fibre(c, weight);
            case ClosureOp::hair_reflection: return add_hair_lobe(c, weight, false);
            case ClosureOp::hair_transmission: return add_hair_lobe(c, weight, true);
            case ClosureOp::coat: return add_reflection(c, weight, coat_fresnel(ior(c)));
            case ClosureOp::count: return;
        }
    }

private:
    Operand operand(const ClosureInstruction& c, int k) const {
        return r_.operands[c.operands + static_cast<uint32_t>(k)];
    }
    float alpha(const ClosureInstruction& c) const {
        return r_.scalar(operand(c, traits(c.op).alpha));
    }
    float ior(const ClosureInstruction& c) const { return r_.scalar(operand(c, traits(c.op).ior)); }
    float scalar(const ClosureInstruction& c, int k) const { return r_.scalar(operand(c, k)); }
    Spectrum color(const ClosureInstruction& c, int k) const {
        return spectrum(r_.vector(operand(c, k)));
    }
    Vec3 normal(const ClosureInstruction& c) const {
        const Operand n = operand(c, kNormalOperand);
        return n == kNoOperand ? surface_normal_ : value_of(r_.vector(n));
    }
    // Of closures that mirror or refract. Those that glint have the normals of their map.
    Vec3 glossy_normal(const ClosureInstruction& c) const {
        const Vec3 n = normal(c);
        const bool bends = bump_correction_ != BumpCorrection::none && !c.on_slope_map;
        return bends && n != point_.ng ? bent_normal(point_.ng, point_.wo, n) : n;
    }
    Vec3 diffuse_normal(const ClosureInstruction& c) const {
        return bump_correction_ == BumpCorrection::smoothed ? glossy_normal(c) : normal(c);
    }
    ThinFilm film(const ClosureInstruction& c) const {
        if (c.film_thickness == kNoOperand) return {};
        return {r_.scalar(c.film_thickness), std::max(r_.scalar(c.film_ior), 1e-5f)};
    }
    MicrofacetReflection reflection(const ClosureInstruction& c, const Fresnel& fresnel) const {
        MicrofacetReflection lobe{glossy_normal(c), alpha(c), c.modes.model, fresnel,
                                  c.modes.energy_compensated};
        lobe.alpha_y = lobe.alpha;
        stretch(c, lobe);
        return lobe;
    }
    // Along the grain, if there is one that the normal does not follow.
    template <class Lobe>
    void stretch(const ClosureInstruction& c, Lobe& lobe) const {
        if (c.stretch == kNoOperand || lobe.alpha <= kDeltaAlpha) return;
        const Vec3 along = value_of(r_.vector(c.tangent));
        const Vec3 tangent = along - lobe.n * dot(lobe.n, along);
        const float factor = r_.scalar(c.stretch);
        if (!(length_squared(tangent) > 0.0f) || factor == 1.0f) return;
        lobe.tangent = normalize(tangent);
        const float alpha = lobe.alpha;
        lobe.alpha = std::clamp(alpha * factor, kLeastStretchedAlpha, 1.0f);
        lobe.alpha_y = std::clamp(alpha / factor, kLeastStretchedAlpha, 1.0f);
    }
    void add(const ClosureInstruction& c, const Spectrum& weight, const ClosureKind& kind) {
        list_.add(weight, kind, point_.wo, stays_on_caster_normal(c));
    }
    // Chains turn at the caster's normal, not at one that was bent for wo: such light is left to
    // path tracing.
    bool stays_on_caster_normal(const ClosureInstruction& c) const {
        return c.on_caster_normal && glossy_normal(c) == normal(c);
    }
    void add_glossy(const ClosureInstruction& c, const Spectrum& weight) {
        Fresnel fresnel;
        fresnel.f0 = color(c, 3);
        add_reflection(c, weight, fresnel);
    }
    void add_rough_diffuse(const ClosureInstruction& c, const Spectrum& weight) {
        const Spectrum albedo = color(c, traits(c.op).diffuse);
        if (c.below_share != kNoOperand) {
            const float share = clamp01(r_.scalar(c.below_share));
            if (share > 0.0f) add_below(c, facet::saturate(albedo), weight * share);
            if (share == 1.0f) return;
            return add_diffuse(c, albedo, weight * (1.0f - share));
        }
        add_diffuse(c, albedo, weight);
    }
    void add_below(const ClosureInstruction& c, const Spectrum& albedo, const Spectrum& weight) {
        const Vector3<float> radius = r_.vector(c.below_radius), entry = r_.vector(c.below_entry);
        const Spectrum reach(std::max(radius.x, 0.0f), std::max(radius.y, 0.0f),
                             std::max(radius.z, 0.0f));
        if (is_black(reach)) return add_diffuse(c, albedo, weight);
        list_.add(albedo * weight,
                  Subsurface{glossy_normal(c), albedo, reach, std::clamp(entry.x, 0.0f, 0.9f),
                             clamp01(entry.y), std::clamp(entry.z, 1.01f, 3.8f), c.modes.entry,
                             c.modes.dipole_radius},
                  point_.wo, false);
    }
    void add_diffuse(const ClosureInstruction& c, const Spectrum& albedo, const Spectrum& weight) {
        const float roughness = clamp01(scalar(c, traits(c.op).diffuse_roughness));
        if (roughness < kSmoothDiffuse)
            return list_.add(albedo * weight, Lambert{diffuse_normal(c)}, point_.wo, false);
        OrenNayar rough{diffuse_normal(c), roughness};
        if (c.modes.exchanges) rough.exchanged = facet::saturate(albedo);
        list_.add(albedo * weight, rough, point_.wo, false);
    }
    template <BounceKind kind>
    void add_toon(const ClosureInstruction& c, const Spectrum& weight) {
        constexpr float kQuarter = 0.5f * kPi;
        add(c, color(c, 2) * weight,
            Toon<kind>{kind == BounceKind::glossy ? normal(c) : diffuse_normal(c),
                       clamp01(scalar(c, 3)) * kQuarter, clamp01(scalar(c, 4)) * kQuarter});
    }
    void add_reflection(const ClosureInstruction& c, const Spectrum& weight, const Fresnel& fresnel) {
        const MicrofacetReflection lobe = reflection(c, fresnel);
        if (!c.on_slope_map) return add(c, weight, lobe);
        GlintLobe glint{weight, lobe};
        if (c.coat != kNoOperand)
            glint = {Spectrum(r_.scalar(operand(c, kWeightOperand))), lobe,
                     coat_of(r_, c.coat, c.coat_tint)};
        list_.add_glints(weight, glint, point_.wo, stays_on_caster_normal(c));
    }

    void add_dielectric(const ClosureInstruction& c, const Spectrum& weight) {
        MicrofacetDielectric d{};
        d.n = glossy_normal(c);
        d.alpha = alpha(c);
        d.model = c.modes.model;
        d.eta = point_.backfacing ? 1.0f / ior(c) : ior(c);
        d.reflects = c.modes.reflects;
        d.refracts = c.modes.refracts;
        d.fresnel_weighted = c.modes.fresnel_weighted;
        d.reflection_tint = color(c, 4);
        d.transmission_tint = color(c, 5);
        d.normal_tint = color(c, 6);
        d.energy_compensated = c.modes.energy_compensated;
        const float index_of_wo = point_.backfacing ? ior(c) : 1.0f;
        d.film = film(c);
        d.film.thickness *= index_of_wo;
        d.film.ior /= index_of_wo;
        add(c, weight, d);
    }

    // On what is no strand it lies along a side of the triangle, as in Cycles.
    void add_fibre(const ClosureInstruction& c, const Spectrum& weight) {
        const Vec3 along = value_of(r_.vector(operand(c, 2)));
        const bool strand = length_squared(along) > 0.0f;
        const Vec3 tangent = normalize(strand ? along : point_.dp_du);
        const float h = strand ? across_tube(tangent, surface_normal_, point_.ng, point_.wo)
                               : across_fibre(tangent, point_.ng, point_.wo);
        add(c, weight,
            hair_fibre(tangent, h, color(c, 3), scalar(c, 4), scalar(c, 5), scalar(c, 6),
                       scalar(c, 7), scalar(c, 8)));
    }
    void add_hair_lobe(const ClosureInstruction& c, const Spectrum& weight, bool transmits) {
        const auto width = [](float roughness) { return std::clamp(roughness, 0.001f, 1.0f); };
        const Vec3 along = value_of(r_.vector(operand(c, 3)));
        const bool strand = length_squared(along) > 0.0f;
        add(c, color(c, 2) * weight,
            HairLobe{strand ? surface_normal_ : point_.ng, normalize(strand ? along : point_.dp_dv),
                     width(scalar(c, 4)), width(scalar(c, 5)), strand ? -scalar(c, 6) : 0.0f,
                     transmits});
    }

    void add_coated(const ClosureInstruction& c, const Spectrum& weight) {
        Fresnel fresnel;
        fresnel.kind = Fresnel::Kind::dielectric_f0;
        fresnel.eta = ior(c);
        fresnel.f0 = color(c, 4);
        fresnel.film = film(c);
        Spectrum below = weight;
        if (fresnel.eta != 1.0f || fresnel.film.exists()) {
            const MicrofacetReflection layer = reflection(c, fresnel);
            add_reflection(c, weight, fresnel);
            below *= clamp01(1.0f - max_component(kept_from_below(layer, point_.wo)));
        }
        add_rough_diffuse(c, below);
    }

    const Registers<float>& r_;
    const ShadingPoint<float>& point_;
    const BumpCorrection bump_correction_;
    ClosureList& list_;
    Vec3 surface_normal_;  // where a closure has none of its own
};

}  // namespace

void evaluate_closures(const Material& material, std::span<const Image> images,
                       const ShadingPoint<float>& point, ClosureList& closures) {
    const Program& program = *material.program;
    closures.clear();
    const RegisterFile<float> file(program);
    run(program, program.surface, images, point, file.registers);
    ClosureBuilder builder(file.registers, point, program.surface_normal, material.bump_correction,
                           closures);
    for (const ClosureInstruction& closure : program.closures) builder.add(closure);
    if (program.surface.result != kNoOperand)
        closures.emission = spectrum(file.registers.vector(program.surface.result));
}

Spectrum evaluate_emission(const Material& material, std::span<const Image> images,
                           const ShadingPoint<float>& point) {
    return evaluate_spectrum(*material.program, material.program->emission, images, point);
}

Spectrum evaluate_transparency(const Material& material, std::span<const Image> images,
                               const ShadingPoint<float>& point) {
    return evaluate_spectrum(*material.program, material.program->transparency, images, point);
}

Vec3 evaluate_displacement(const Material& material, std::span<const Image> images,
                           const ShadingPoint<float>& point) {
    return value_of(
        evaluate_vector(*material.program, material.program->displacement, images, point));
}

Vec3 evaluate_color_aov(const Material& material, std::span<const Image> images,
                        const ShadingPoint<float>& point, uint32_t index) {
    return value_of(
        evaluate_vector(*material.program, material.program->aovs[index].color, images, point));
}

float evaluate_value_aov(const Material& material, std::span<const Image> images,
                         const ShadingPoint<float>& point, uint32_t index) {
    const Section& section = material.program->aovs[index].value;
    const RegisterFile<float> file(*material.program);
    run(*material.program, section, images, point, file.registers);
    return file.registers.scalar(section.result);
}

ShadingPoint<float> background_point(const Material& material, const Vec3& direction,
                                     const RayState& ray, const ViewSpace& view, ViewSpace& turned) {
    ShadingPoint<float> point{};
    point.position = to_vector(direction);
    point.ray = ray;
    // Seen from the camera, wherever it stands.
    if ((material.reads & kReadsView) != 0) {
        turned = view;
        turned.from_world.translation = turned.to_world.translation = Vec3(0.0f);
    }
    point.view = &turned;
    return point;
}

Spectrum evaluate_background(const Material& material, std::span<const Image> images,
                             const Vec3& direction, const RayState& ray, const ViewSpace& view) {
    const Section& section = material.program->background;
    if (section.begin == section.end && section.result == kNoOperand) return Spectrum(0.0f);
    ViewSpace turned;
    return evaluate_spectrum(*material.program, section, images,
                             background_point(material, direction, ray, view, turned));
}

template <class T>
Vector3<T> evaluate_caster_normal(const Material& material, std::span<const Image> images,
                                  const ShadingPoint<T>& point) {
    const Section& section = material.program->caster_normal;
    if (section.result == kNoOperand) return facing_normal(point);
    return evaluate_vector(*material.program, section, images, point);
}

template Vector3<float> evaluate_caster_normal(const Material&, std::span<const Image>,
                                               const ShadingPoint<float>&);
template Vector3<Dual2> evaluate_caster_normal(const Material&, std::span<const Image>,
                                               const ShadingPoint<Dual2>&);

}  // namespace spc
