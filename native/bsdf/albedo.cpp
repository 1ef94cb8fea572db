// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/albedo.h"

#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"

namespace spc {
namespace {

// All tables run over sqrt(alpha), which is Blender's roughness, and sqrt(cos_o), which is dense at
// grazing angles where Fresnel is steep; both in [0, 1].

struct Bracket {
    int index;
    float t;
};
Bracket bracket(float x, int nodes) {
    const float position = clamp01(x) * static_cast<float>(nodes - 1);
    const int index = std::min(static_cast<int>(position), nodes - 2);
    return {index, position - static_cast<float>(index)};
}
float node(int i, int nodes) { return static_cast<float>(i) / static_cast<float>(nodes - 1); }

// Interpolates between rows of entries that support a + (b - a) * t.
template <class At>
auto interpolate(const Bracket& b, const At& at) {
    const auto first = at(b.index);
    return first + (at(b.index + 1) - first) * b.t;
}

// 2 times the integral of f(mu) mu over mu in [0, 1], f given as a function of sqrt(mu).
template <class F>
float cosine_mean(const F& f) {
    constexpr int kSteps = 64;
    float sum = 0.0f;
    for (int i = 0; i < kSteps; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) / kSteps;
        sum += 4.0f * x * x * x * f(x);
    }
    return sum / kSteps;
}

// Calls visit(m_local, wo_local, weight) for visible normals whose weights sum to 1. The lobe is
// symmetric about the plane of wo and n, so half of the azimuths do. The heights crowd at both
// ends, where the normals' angles are square roots of u: midpoints in t of u = t^2 (3 - 2t) then
// converge fast.
template <class Visit>
void visit_visible_normals(MicrofacetModel model, float alpha, float cos_o, int heights,
                           int azimuths, const Visit& visit) {
    const Vec3 wo(safe_sqrt(1.0f - cos_o * cos_o), 0.0f, cos_o);
    // GGX maps u.y to a whole turn, Beckmann to the slope across wo: both mirror at 1/2.
    const float h = static_cast<float>(heights), a = static_cast<float>(azimuths);
    const float scale =
        1.0f / (a * (h + 0.5f / h));  // the midpoint rule makes 1 + 1/(2 h^2) of the integral of du
    for (int i = 0; i < heights; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / h;
        const float weight = 6.0f * t * (1.0f - t) * scale;
        for (int j = 0; j < azimuths; ++j) {
            const Vec2 u(t * t * (3.0f - 2.0f * t), 0.5f * (static_cast<float>(j) + 0.5f) / a);
            visit(sample_visible_normal(model, alpha, wo, u), wo, weight);
        }
    }
}

// Beyond the critical angle some tilted facets still transmit, though no tabulated normal may find
// them: a rough transmission is never reported as black.
constexpr float kLeastTransmission = 1e-4f;
constexpr float kMinTableAlpha = 1e-4f;  // stands for alpha = 0
constexpr float kMinTableCos = 1e-4f;    // stands for cos = 0

// What one reflection at a rough surface amounts to.
struct ReflectionTable {
    struct Entry {
        float energy;  // share reflected by white facets
        float fifth;  // means over what is reflected: (1 - c)^5 and c (1 - c)^6, c = cos(wo, facet)
        float dip;
        Entry operator+(const Entry& b) const {
            return {energy + b.energy, fifth + b.fifth, dip + b.dip};
        }
        Entry operator-(const Entry& b) const {
            return {energy - b.energy, fifth - b.fifth, dip - b.dip};
        }
        Entry operator*(float t) const { return {energy * t, fifth * t, dip * t}; }
    };
    static constexpr int kNodes = 32;
    std::array<std::array<Entry, kNodes>, kNodes> entries;  // [alpha][cos]
    std::array<float, kNodes> mean_energy;                  // cosine-weighted, [alpha]

    explicit ReflectionTable(MicrofacetModel model) {
        for (int a = 0; a < kNodes; ++a) {
            for (int c = 0; c < kNodes; ++c)
                entries[a][c] = integrate(model, std::max(sqr(node(a, kNodes)), kMinTableAlpha),
                                          std::max(sqr(node(c, kNodes)), kMinTableCos));
            mean_energy[a] = cosine_mean([&](float x) {
                return interpolate(bracket(x, kNodes), [&](int c) { return entries[a][c]; }).energy;
            });
        }
    }

    static Entry integrate(MicrofacetModel model, float alpha, float cos_o) {
        // Beckmann's normals cost ten times as much and serve sample weights only.
        const int heights = model == MicrofacetModel::ggx ? 20 : 8,
                  azimuths = model == MicrofacetModel::ggx ? 12 : 6;
        Entry sum{0, 0, 0};
        visit_visible_normals(model, alpha, cos_o, heights, azimuths,
                              [&](const Vec3& m, const Vec3& wo, float share) {
                                  const float c = dot(wo, m);
                                  const float cos_i = facet::mirrored(wo, m, c).z;
                                  if (!(cos_i > 0.0f)) return;
                                  const Masking g = masking(model, alpha, cos_o, cos_i);
                                  const float weight = share * g.g2_by_cos_o / g.g1_by_cos_o;
                                  const float x = 1.0f - std::min(c, 1.0f), x5 = x * x * x * x * x;
                                  sum = sum + Entry{1.0f, x5, c * x5 * x} * weight;
                              });
        const float inv = 1.0f / sum.energy;
        return {sum.energy, sum.fifth * inv, sum.dip * inv};
    }

    Entry operator()(float alpha, float cos_o) const {
        const Bracket c = bracket(std::sqrt(cos_o), kNodes);
        return interpolate(bracket(std::sqrt(alpha), kNodes), [&](int a) {
            return interpolate(c, [&](int i) { return entries[a][i]; });
        });
    }
    float mean(float alpha) const {
        return interpolate(bracket(std::sqrt(alpha), kNodes), [&](int a) { return mean_energy[a]; });
    }
};

// What one reflection or refraction at a rough dielectric amounts to. The third axis is
// sqrt|(eta-1)/(eta+1)|, in one half for eta >= 1 and one for eta <= 1.
struct DielectricTable {
    struct Entry {
        float rise;     // mean Fresnel reflectance over the reflected lobe, as (F - F0) / (1 - F0)
        float energy;   // share reflected or refracted in all
        float through;  // share refracted if facets refract everything but total internal reflection
        Entry operator+(const Entry& b) const {
            return {rise + b.rise, energy + b.energy, through + b.through};
        }
        Entry operator-(const Entry& b) const {
            return {rise - b.rise, energy - b.energy, through - b.through};
        }
        Entry operator*(float t) const { return {rise * t, energy * t, through * t}; }
    };
    static constexpr int kNodes = 16;
    using Cube =
        std::array<std::array<std::array<Entry, kNodes>, kNodes>, kNodes>;     // [alpha][cos][eta]
    std::array<Cube, 2> entries;                                               // [eta < 1]
    std::array<std::array<std::array<float, kNodes>, kNodes>, 2> mean_energy;  // [eta < 1][alpha][eta]

    explicit DielectricTable(MicrofacetModel model) {
        for (int a = 0; a < kNodes; ++a)
            for (int c = 0; c < kNodes; ++c)
                integrate(model, std::max(sqr(node(a, kNodes)), kMinTableAlpha),
                          std::max(sqr(node(c, kNodes)), kMinTableCos), entries[0][a][c],
                          entries[1][a][c]);
        for (int inside = 0; inside < 2; ++inside)
            for (int a = 0; a < kNodes; ++a)
                for (int e = 0; e < kNodes; ++e)
                    mean_energy[inside][a][e] = cosine_mean([&](float x) {
                        return interpolate(bracket(x, kNodes),
                                           [&](int c) { return entries[inside][a][c][e]; })
                            .energy;
                    });
    }

    static float node_eta(int e, bool inside) {
        const float z = std::min(sqr(node(e, kNodes)), 0.999f);
        const float eta = (1.0f + z) / (1.0f - z);
        return inside ? 1.0f / eta : eta;
    }

    using Row = std::array<Entry, kNodes>;
    static void integrate(MicrofacetModel model, float alpha, float cos_o, Row& outside,
                          Row& inside) {
        const int heights = model == MicrofacetModel::ggx ? 10 : 8,
                  azimuths = model == MicrofacetModel::ggx ? 10 : 6;
        struct Sums {
            float reflected = 0, energy = 0, through = 0;
        };
        std::array<std::array<Sums, kNodes>, 2> sums{};
        float white = 0.0f;
        visit_visible_normals(
            model, alpha, cos_o, heights, azimuths, [&](const Vec3& m, const Vec3& wo, float weight) {
                const float c = dot(wo, m);
                const auto share = [&](float cos_i) {
                    const Masking g = masking(model, alpha, cos_o, cos_i);
                    return weight * g.g2_by_cos_o / g.g1_by_cos_o;
                };
                const float mirrored_z = facet::mirrored(wo, m, c).z;
                const float reflection = mirrored_z > 0.0f ? share(mirrored_z) : 0.0f;
                white += reflection;
                for (int side = 0; side < 2; ++side)
                    for (int e = 0; e < kNodes; ++e) {
                        const float eta = node_eta(e, side == 1);
                        const float f = facet::dielectric(c, eta);
                        const std::optional<Vec3> wi = facet::refracted(wo, m, c, eta);
                        const float refraction = wi && wi->z < 0.0f ? share(-wi->z) : 0.0f;
                        Sums& s = sums[side][e];
                        s.reflected += f * reflection;
                        s.energy += f * reflection + (1.0f - f) * refraction;
                        s.through += refraction;
                    }
            });
        for (int side = 0; side < 2; ++side)
            for (int e = 0; e < kNodes; ++e) {
                const Sums& s = sums[side][e];
                const float f0 = facet::dielectric_f0(node_eta(e, side == 1));
                (side == 0 ? outside : inside)[e] = {(s.reflected / white - f0) / (1.0f - f0),
                                                     s.energy, s.through};
            }
    }

    static Bracket eta_bracket(float eta) {
        return bracket(std::sqrt(std::abs((eta - 1.0f) / (eta + 1.0f))), kNodes);
    }
    Entry operator()(float alpha, float cos_o, float eta) const {
        const Cube& cube = entries[eta < 1.0f];
        const Bracket c = bracket(std::sqrt(cos_o), kNodes), e = eta_bracket(eta);
        return interpolate(bracket(std::sqrt(alpha), kNodes), [&](int ai) {
            return interpolate(
                c, [&](int ci) { return interpolate(e, [&](int ei) { return cube[ai][ci][ei]; }); });
        });
    }
    float mean(float alpha, float eta) const {
        const auto& square = mean_energy[eta < 1.0f];
        const Bracket e = eta_bracket(eta);
        return interpolate(bracket(std::sqrt(alpha), kNodes), [&](int ai) {
            return interpolate(e, [&](int ei) { return square[ai][ei]; });
        });
    }
};

const ReflectionTable& reflection_table(MicrofacetModel model) {
    if (model == MicrofacetModel::ggx) {
        static const ReflectionTable table(MicrofacetModel::ggx);
        return table;
    }
    static const ReflectionTable table(MicrofacetModel::beckmann);
    return table;
}
const DielectricTable& dielectric_table(MicrofacetModel model) {
    if (model == MicrofacetModel::ggx) {
        static const DielectricTable table(MicrofacetModel::ggx);
        return table;
    }
    static const DielectricTable table(MicrofacetModel::beckmann);
    return table;
}

Spectrum schlick(const Spectrum& f0, float rise) { return f0 + (Spectrum(1.0f) - f0) * rise; }

// A conductor as the f82 curve that agrees with it at normal incidence and at 82 degrees, which
// integrates in closed form; other kinds as they are.
Fresnel as_f82(const Fresnel& conductor) {
    const Fresnel bare{conductor.kind, conductor.eta, conductor.f0, conductor.f82};
    const Spectrum f0 = fresnel(bare, 1.0f), edge = fresnel(bare, 1.0f / 7.0f);
    return {Fresnel::Kind::f82, 1.0f, f0, facet::f82_tint(f0, edge)};
}

// Mean reflectance over the lobe seen from an angle; under a film about that of a mirror.
Spectrum lobe_mean(const Fresnel& f, MicrofacetModel model, float alpha, float cos_o,
                   const ReflectionTable::Entry& entry) {
    if (f.film.exists()) return fresnel(f, cos_o);
    switch (f.kind) {
        case Fresnel::Kind::none: return f.f0;
        case Fresnel::Kind::dielectric:
        case Fresnel::Kind::dielectric_f0: {
            if (f.eta == 1.0f) return fresnel(f, cos_o);
            const float rise = dielectric_table(model)(alpha, cos_o, f.eta).rise;
            if (f.kind == Fresnel::Kind::dielectric_f0) return schlick(f.f0, clamp01(rise));
            return f.f0 * clamp01(lerp(facet::dielectric_f0(f.eta), 1.0f, rise));
        }
        case Fresnel::Kind::conductor: return lobe_mean(as_f82(f), model, alpha, cos_o, entry);
        case Fresnel::Kind::f82:
            return facet::saturate(schlick(f.f0, entry.fifth) -
                                   facet::f82_dip(f.f0, f.f82) * entry.dip);
    }
    return Spectrum(0.0f);
}

// Cosine-weighted mean over the hemisphere of a dielectric's reflectance, fitted by [Kulla17].
float dielectric_mean(float eta) {
    if (eta < 1.0f) return 0.997118f + eta * (0.1014f - eta * (0.965241f + eta * 0.130607f));
    return (eta - 1.0f) / (4.08567f + 1.00071f * eta);
}

// The same for any Fresnel term, without its film. Schlick's curve and its dip have closed forms,
// 1/21 and 1/126.
Spectrum hemisphere_mean(const Fresnel& f) {
    switch (f.kind) {
        case Fresnel::Kind::none: return f.f0;
        case Fresnel::Kind::dielectric: return f.f0 * dielectric_mean(f.eta);
        case Fresnel::Kind::dielectric_f0: {
            const float f0 = facet::dielectric_f0(f.eta);
            return schlick(f.f0, clamp01((dielectric_mean(f.eta) - f0) / (1.0f - f0)));
        }
        case Fresnel::Kind::conductor: return hemisphere_mean(as_f82(f));
        case Fresnel::Kind::f82:
            return facet::saturate(schlick(f.f0, 1.0f / 21.0f) -
                                   facet::f82_dip(f.f0, f.f82) * (1.0f / 126.0f));
    }
    return Spectrum(0.0f);
}

// 1 + F_ms (1 - E) / E, see the header.
Spectrum compensation(const Spectrum& reflectance, float energy, float mean_energy) {
    const Spectrum f = facet::saturate(reflectance);
    const Spectrum multiple = f * mean_energy / (Spectrum(1.0f) - f * (1.0f - mean_energy));
    return Spectrum(1.0f) + multiple * (std::max(1.0f - energy, 0.0f) / energy);
}

bool compensated(const MicrofacetReflection& c) {
    return c.energy_compensated && c.model == MicrofacetModel::ggx && c.alpha > kDeltaAlpha;
}
bool compensated(const MicrofacetDielectric& c) {
    return c.energy_compensated && c.model == MicrofacetModel::ggx && c.fresnel_weighted &&
           !is_delta(c);
}

Spectrum albedo_of(const Lambert&, const Vec3&) { return Spectrum(1.0f); }
Spectrum albedo_of(const Translucent&, const Vec3&) { return Spectrum(1.0f); }
Spectrum albedo_of(const Transparent&, const Vec3&) { return Spectrum(1.0f); }

// `lossless`: an uncompensated lobe counts as if no light were lost between facets.
Spectrum reflection_albedo(const MicrofacetReflection& c, const Vec3& wo, bool lossless) {
    const float cos_o = std::min(dot(c.n, wo), 1.0f);
    if (!(cos_o > 0.0f)) return Spectrum(0.0f);
    if (c.alpha <= kDeltaAlpha) return fresnel(c.fresnel, cos_o);
    const ReflectionTable& table = reflection_table(c.model);
    const ReflectionTable::Entry entry = table(c.mean_alpha(), cos_o);
    const Spectrum mean = lobe_mean(c.fresnel, c.model, c.mean_alpha(), cos_o, entry);
    if (!compensated(c)) return lossless ? mean : mean * entry.energy;
    return mean * entry.energy *
           compensation(hemisphere_mean(c.fresnel), entry.energy, table.mean(c.mean_alpha()));
}

Spectrum albedo_of(const MicrofacetReflection& c, const Vec3& wo) {
    return reflection_albedo(c, wo, false);
}

Spectrum albedo_of(const MicrofacetDielectric& c, const Vec3& wo) {
    const float cos_o = std::min(dot(c.n, wo), 1.0f);
    if (!(cos_o > 0.0f)) return Spectrum(0.0f);
    const Spectrum reflection = c.reflects ? c.reflection_tint : Spectrum(0.0f);
    const Spectrum transmission = c.refracts ? c.transmission_tint : Spectrum(0.0f);
    if (is_delta(c)) {
        const Spectrum f = facet::reflectance(c, cos_o);
        if (c.fresnel_weighted) return reflection * f + transmission * (Spectrum(1.0f) - f);
        const bool passes = facet::refracted_cos_squared(cos_o, c.eta) > 0.0f;
        return reflection + transmission * (passes ? 1.0f : 0.0f);
    }
    const float white = reflection_table(c.model)(c.alpha, cos_o).energy;
    const DielectricTable& table = dielectric_table(c.model);
    const DielectricTable::Entry entry = table(c.alpha, cos_o, c.eta);
    if (!c.fresnel_weighted)
        return reflection * white + transmission * std::max(entry.through, kLeastTransmission);
    const Spectrum f0 = facet::saturate(c.normal_tint * facet::dielectric_f0(c.eta));
    const Spectrum bare = facet::saturate(schlick(f0, entry.rise));
    const Spectrum facets = c.film.exists() ? facet::reflectance(c, cos_o) : bare;
    const auto least = [](const Spectrum& a, float b) {
        return Spectrum(std::min(a.x, b), std::min(a.y, b), std::min(a.z, b));
    };
    const Spectrum reflected = least(facets * white, entry.energy);
    const Spectrum rest = least(reflected, entry.energy - kLeastTransmission);
    const Spectrum once = reflection * reflected + transmission * (Spectrum(entry.energy) - rest);
    if (!compensated(c)) return once;
    return once * compensation(c.transmission_tint, entry.energy, table.mean(c.alpha, c.eta));
}

template <class C>
Spectrum compensation_of(const C&, const Vec3&) {
    return Spectrum(1.0f);
}

Spectrum compensation_of(const MicrofacetReflection& c, const Vec3& wo) {
    const float cos_o = std::min(dot(c.n, wo), 1.0f);
    if (!compensated(c) || !(cos_o > 0.0f)) return Spectrum(1.0f);
    const ReflectionTable& table = reflection_table(c.model);
    return compensation(hemisphere_mean(c.fresnel), table(c.mean_alpha(), cos_o).energy,
                        table.mean(c.mean_alpha()));
}

Spectrum compensation_of(const MicrofacetDielectric& c, const Vec3& wo) {
    const float cos_o = std::min(dot(c.n, wo), 1.0f);
    if (!compensated(c) || !(cos_o > 0.0f)) return Spectrum(1.0f);
    const DielectricTable& table = dielectric_table(c.model);
    return compensation(c.transmission_tint, table(c.alpha, cos_o, c.eta).energy,
                        table.mean(c.alpha, c.eta));
}

}  // namespace

Spectrum energy_compensation(const ClosureKind& kind, const Vec3& wo) {
    return std::visit([&](const auto& c) { return compensation_of(c, wo); }, kind);
}

Spectrum kept_from_below(const MicrofacetReflection& layer, const Vec3& wo) {
    return reflection_albedo(layer, wo, true);
}

Spectrum albedo(const ClosureKind& kind, const Vec3& wo) {
    return std::visit([&](const auto& c) { return albedo_of(c, wo); }, kind);
}

}  // namespace spc
