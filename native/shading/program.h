// SPDX-License-Identifier: GPL-3.0-or-later
// A material compiled: constants folded, unused nodes gone, and one small program per output that
// something reads. Evaluation over T = float gives values; over Dual2 also derivatives by the
// surface parameters.
#pragma once

#include "bsdf/closure.h"
#include "core/image.h"
#include "math/dual.h"
#include "shading/attribute_name.h"
#include "shading/graph.h"
#include "shading/ray_state.h"
#include "shading/reads.h"
#include "shading/view_space.h"

#include <memory>

namespace spc {

// What a program may read at a point. Only what the program's `reads` names needs to be set.
template <class T>
struct ShadingPoint {
    Vector3<T> position;  // world
    Vector3<T> position_object;
    Vector3<T> normal;  // interpolated (or face) normal, world, unit, on the front side of the surface
    Vector3<T> normal_object;  // the same in object space, interpolated but not normalised, front side
    // One each of Material::attributes.
    const std::array<T, 4>* attributes;
    const Vector3<T>* tangent_object;  // of UV layers, not normalised
    const float* bitangent_sign;       // likewise
    const Transform* object_to_world;
    const Transform* world_to_object;
    Vec3 ng;  // unit geometric normal, world, on the side of wo
    Vec3 wo;  // unit, towards where the path came from
    RayState ray;
    bool backfacing;  // wo is on the back side: shading normals are turned to the side of wo, eta is inverted
    T u, v;  // barycentrics of the second and third corner
    const ViewSpace* view;
    Vec3 dp_du, dp_dv;  // the triangle's sides, world
    // Where the program reads heights: the point once more, with derivatives by the sides.
    const ShadingPoint<Dual<T>>* around = nullptr;
};

// What the manifold needs to know of a material, decided when it is compiled: closures of one
// normal whose index and roughness are the same everywhere. Others are not part of it (path tracing
// carries them), and `why_not` says so for the log.
struct SpecularInterface {
    bool reflects = false;
    bool refracts = false;
    float alpha = 0.0f;                            // 0: deltas
    MicrofacetModel model = MicrofacetModel::ggx;  // of its microfacets, unless they are
    float ior = 1.0f;                              // of the far side of a front face
    bool mapped_normal = false;                    // the normal is not simply the mesh's
    std::string why;      // e.g. "Glass BSDF, roughness 0, IOR 1.33, mapped normal"
    std::string why_not;  // empty if exists()

    bool exists() const { return reflects || refracts; }
    bool is_rough() const { return alpha > 0.0f; }
};

// What a SlopeMap's image holds: normals in tangent space for a Normal Map node, see map_normal(),
// or heights for a Bump node, see bump_normal().
enum class Relief : uint8_t { normals, heights };

// The map of a material whose narrow lobes may glint: a node that turns their normal, fed by an
// image that a UV layer addresses by an affine map. Lobes with another normal are not part of it.
struct SlopeMap {
    Relief relief = Relief::normals;
    uint32_t image = kNone;  // kNone: there is none
    uint32_t uv_layer = 0,
             tangent_layer = 0;  // of Material::attributes; of heights one and the same
    float strength = 1.0f;
    float distance = 1.0f;  // of heights: m, negative where they are inverted
    std::array<Vec2, 2> to_image{Vec2(1, 0),
                                 Vec2(0, 1)};  // rows from (u, v) of the layer to the image's
    Vec2 offset{0, 0};                         // likewise
    std::string why;                           // e.g. "Glossy BSDF, roughness 0.2"
    std::string why_not;                       // why there is none, empty where nobody asked
};

// The most attributes that one material reads.
inline constexpr size_t kMaxAttributes = 16;

struct Program;  // shading/instruction.h
struct ProgramDeleter {
    void operator()(Program*) const;
};

struct Material {
    std::string name;
    uint32_t pass_index = 0;  // what its pass shows
    float crypto = 0.0f;      // identifier, 0: none
    std::unique_ptr<Program, ProgramDeleter> program;
    std::vector<AttributeName> attributes;  // that are read; ShadingPoint's are in this order
    uint32_t reads = 0;                     // of ProgramReads, whole material
    uint32_t normal_reads = 0;              // of ProgramReads, caster normal alone
    uint32_t height_reads = 0;              // of ProgramReads, heights of bumps alone
    uint32_t displacement_reads = 0;        // of ProgramReads, displacement of vertices alone
    bool emits = false;
    Spectrum mean_emission{
        0.0f};  // for light selection: constant emission, or with the textures' means
    Spectrum absorption{0.0f};        // 1/m, of the homogeneous medium behind front faces
    bool may_be_transparent = false;  // some Transparent closure or alpha < 1 may exist
    bool has_subsurface = false;      // light may go on below it
    bool moves_vertices = false;      // evaluate_displacement() has something to say
    DisplacementMode displacement = DisplacementMode::bump;
    bool has_smooth = false;  // some closure that is not a delta may exist (a possible receiver)
    // Why it throws blurred caustics: a strong lobe that is narrow without being a delta. Empty if
    // it has none.
    std::string narrow_lobe;
    bool depends_on_ray = false;  // the surface, beyond its emission, reads a RayState
    BumpCorrection bump_correction = BumpCorrection::none;
    bool is_background = false;   // surface is a Background shader
    uint32_t emission_reads = 0;  // of ProgramReads, emission alone
    bool constant_emission =
        true;  // the same everywhere and in every direction, by the graph itself
    std::vector<uint32_t> images;  // that some part of it reads, by index into the scene's
    SpecularInterface specular;    // of deltas
    SpecularInterface rough;       // of a narrow lobe, where there are no deltas
    // Where chains with rough vertices may turn.
    const SpecularInterface& interface() const { return specular.exists() ? specular : rough; }
    SlopeMap slopes;
    bool may_glint() const { return slopes.image != kNone; }
    std::vector<std::string> aovs;  // names of the AOVs that its nodes write; one may be there twice
    std::vector<std::string> warnings;  // what falls back, naming material and node
};

// Compiles a graph. `images` are the scene's, needed for their means. Throws Error
// (invalid_argument) naming material, node and socket: unknown kind, socket or option, missing
// image, cycle, no or two outputs, too many closures.
Material compile(const Graph& graph, std::span<const Image> images);

// All closures, emission and transparency at a point.
void evaluate_closures(const Material& material, std::span<const Image> images,
                       const ShadingPoint<float>& point, ClosureList& closures);
// Emission alone, towards wo.
Spectrum evaluate_emission(const Material& material, std::span<const Image> images,
                           const ShadingPoint<float>& point);
// Weight of straight-through transparency alone (shadow rays).
Spectrum evaluate_transparency(const Material& material, std::span<const Image> images,
                               const ShadingPoint<float>& point);
// By how much a vertex is moved, m, world. Only where material.moves_vertices.
Vec3 evaluate_displacement(const Material& material, std::span<const Image> images,
                           const ShadingPoint<float>& point);
// The normal of the specular interface, world, unit, on the side of wo (flipped on back faces).
template <class T>
Vector3<T> evaluate_caster_normal(const Material& material, std::span<const Image> images,
                                  const ShadingPoint<T>& point);
// What node `index` of Material::aovs writes to an AOV of colours or of values.
Vec3 evaluate_color_aov(const Material& material, std::span<const Image> images,
                        const ShadingPoint<float>& point, uint32_t index);
float evaluate_value_aov(const Material& material, std::span<const Image> images,
                         const ShadingPoint<float>& point, uint32_t index);
// Radiance of a background from a direction (unit, world, pointing away from the scene).
Spectrum evaluate_background(const Material& material, std::span<const Image> images,
                             const Vec3& direction, const RayState& ray = {},
                             const ViewSpace& view = {});
// The point at which a world is evaluated, seen along `direction`. `turned` is storage that it
// points to.
ShadingPoint<float> background_point(const Material& material, const Vec3& direction,
                                     const RayState& ray, const ViewSpace& view, ViewSpace& turned);

extern template Vector3<float> evaluate_caster_normal(const Material&, std::span<const Image>,
                                                      const ShadingPoint<float>&);
extern template Vector3<Dual2> evaluate_caster_normal(const Material&, std::span<const Image>,
                                                      const ShadingPoint<Dual2>&);

}  // namespace spc
