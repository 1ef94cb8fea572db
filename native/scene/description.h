// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a scene as plain data: what the builder collects and the frozen Scene keeps.
#pragma once

#include "core/shared.h"
#include "math/bounds.h"
#include "scene/linking.h"
#include "shading/program.h"
#include "shading/ray_state.h"

#include <string>
#include <vector>

namespace spc {

enum class CausticsRole : uint8_t { automatic, off, caster, receiver, both };

enum class AttributeDomain : uint8_t { corner, vertex, triangle, object };

// Numbers that materials read: of a mesh one each for its corners (3 a triangle), vertices or
// triangles, of an object one for all.
struct Attribute {
    AttributeName called;
    AttributeDomain domain = AttributeDomain::corner;
    uint32_t components = 2;
    std::vector<float> values;         // `components` each
    std::vector<Vec3> tangents;        // of a UV layer: 3 a triangle, object space, or empty
    std::vector<float> tangent_signs;  // likewise

    size_t size() const { return values.size() / components; }
    const float* at(size_t element) const { return values.data() + components * element; }
    // As x, y, z and a fourth: a scalar stands for all of the first three; what is missing is 0,
    // the fourth 1.
    std::array<float, 4> value(size_t element) const {
        const float* v = at(element);
        switch (components) {
            case 1: return {v[0], v[0], v[0], 1.0f};
            case 2: return {v[0], v[1], 0.0f, 1.0f};
            case 3: return {v[0], v[1], v[2], 1.0f};
            default: return {v[0], v[1], v[2], v[3]};
        }
    }
    // Coordinates in the plane of an image, one pair for each corner.
    bool is_uv_layer() const { return domain == AttributeDomain::corner && components == 2; }
    Vec2 uv(size_t corner) const { return {values[2 * corner], values[2 * corner + 1]}; }
};

struct Mesh {
    std::string name;
    std::vector<Vec3> positions;  // object space
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<Vec3> normals;   // 3 a triangle, unit, object space; empty = flat
    bool shaded_smooth = false;  // displaced, it has normals of its vertices, but for these faces:
    std::vector<uint32_t> flat_faces;  // not 0 for each that stays flat; empty: none
    std::vector<Vec3> rest_positions;  // before vertices were displaced; empty where nothing reads them
    std::vector<uint32_t> slots;       // material slot of each triangle; empty = all 0
    uint32_t slot_count = 1;
    std::vector<Attribute> attributes;
    uint32_t dropped_triangles = 0;
    Bounds bounds;  // of all positions

    uint32_t slot_of(uint32_t triangle) const { return slots.empty() ? 0 : slots[triangle]; }
};

struct Instance {
    std::string name;
    uint32_t mesh = 0;
    Transform object_to_world, world_to_object;
    bool mirrored = false;            // the transform has a negative determinant
    std::vector<uint32_t> materials;  // index into Scene::materials for each slot
    uint32_t visibility = kVisibleAll;
    CausticsRole role = CausticsRole::automatic;
    bool holdout = false;                             // a hole in what the camera sees
    float terminator_stretch = 1.0f;                  // Terminator::stretch
    uint32_t pass_index = 0;                          // what its pass shows
    float crypto_object = 0.0f, crypto_asset = 0.0f;  // identifiers, 0: none
    std::string light_group;                          // of what it emits; "": none
    LightLinks links;                                 // likewise
    LinkSets sets;
    std::vector<Attribute> attributes;  // of the object
    // Set when the scene is frozen.
    // [slot][attribute of the material] -> that of the mesh or, counted on from there, of the
    // object; or kNone.
    std::vector<std::vector<uint32_t>> attribute_indices;
    // Of every vertex if the mesh has this instance alone, else empty.
    SharedArray<Vec3> world_positions;
    bool caster = false, receiver = false;
    bool rough_caster = false;  // throws blurred caustics; see docs/glossary.md
    bool emits = false;
    bool has_subsurface = false;  // light may walk below its surface
    bool absorbs = false;         // a material has an absorbing medium behind it
    bool turns_light() const { return caster || rough_caster; }
    // Whether not everything stands in the way of its own light.
    bool is_shadow_linked() const { return emits && links.blockers != 0; }
    const Attribute* attribute(const Mesh& on, uint32_t index) const {
        if (index == kNone) return nullptr;
        const size_t of_mesh = on.attributes.size();
        return index < of_mesh ? &on.attributes[index] : &attributes[index - of_mesh];
    }
};

enum class LightType : uint8_t { point, spot, sun, area };
enum class AreaShape : uint8_t { rectangle, ellipse };

// A lamp. Units as Blender states them (specula.h): power in W, irradiance for a sun.
struct LightDesc {
    std::string name;
    LightType type = LightType::point;
    Transform to_world;
    Spectrum power{1.0f};
    float radius = 0.0f;
    bool soft_falloff = false;  // point, spot: a disk that faces what it lights, not a sphere
    float spot_angle = 0.0f, spot_blend = 0.0f;
    float sun_angle = 0.0f;
    AreaShape shape = AreaShape::rectangle;
    Vec2 size{1.0f, 1.0f};
    float spread = kPi;  // area: full angle of the beam, rad
    uint32_t visibility = kVisibleAll;
    bool feeds_caustics = true;
    std::string light_group;    // "": none
    uint32_t material = kNone;  // whose emission is a factor of the light; kNone: 1
    LightLinks links;
    uint32_t max_bounces = 1024;  // of a path that next event estimation connects to it

    Vec3 position() const { return to_world.translation; }
    // Unit axis along which spot, sun and area lights shine.
    Vec3 axis() const { return normalize(to_world.column(2)) * -1.0f; }
    // Half extents of an area light in world space; not necessarily of equal length.
    Vec3 half_x() const { return to_world.column(0) * (0.5f * size.x); }
    Vec3 half_y() const { return to_world.column(1) * (0.5f * size.y); }
    // A surface that a ray can hit.
    bool has_surface() const {
        return type == LightType::area || (type != LightType::sun && radius > 0.0f);
    }
};

// Where a ray meets a light's surface. A sphere is hit from outside or, if the ray starts inside,
// from within. With soft falloff it is a disk around its centre that faces the ray's origin. An
// area light is hit on its shining side alone.
struct LightSurfaceHit {
    float t;
    Vec3 p;
    Vec3 n;  // unit, towards the ray's origin
};
std::optional<LightSurfaceHit> intersect_light(const LightDesc& light, const Ray& ray);

// Derivatives of a ray by the two coordinates of the film, per pixel.
struct RayChange {
    std::array<Vec3, 2> origin;     // m
    std::array<Vec3, 2> direction;  // across the direction
};

// Of the panoramic ones specula.h says what Camera::panorama holds.
enum class Projection : uint8_t {
    perspective,
    orthographic,
    equirectangular,
    fisheye_equidistant,
    fisheye_equisolid,
    fisheye_polynomial,
    mirror_ball,
    equiangular_cubemap_face,
    central_cylindrical
};

// A point of the scene as the camera sees it through one point of its lens.
struct CameraView {
    Vec3 origin;          // where the ray to the point starts
    float t_near, t_far;  // clips along that ray
    Vec2 film;            // pixels of the full frame; may lie outside of it
    float film_density;   // pixels^2 per m^2 of a surface at the point that faces the ray
};

struct Camera {
    Projection projection = Projection::perspective;
    Transform to_world;  // orthonormal
    uint32_t width = 1, height = 1;
    std::array<uint32_t, 4> crop{0, 0, 1, 1};  // x0, y0, width, height
    // Left, right, bottom, top: at distance 1, of an orthographic camera in m, of a panoramic one
    // in shares of the whole panorama.
    std::array<float, 4> viewplane{-1, 1, -1, 1};
    std::array<float, 8> panorama{};
    float clip_near = 0.0f, clip_far = kInfinity;
    float aperture_radius = 0.0f;  // m; 0: a pinhole, or parallel rays
    // Of an aperture alone:
    float focus_distance = 1.0f;     // along the viewing axis, or the ray of a panoramic camera, m
    uint32_t aperture_blades = 0;    // sides of a regular polygon, 0: a disc
    float aperture_rotation = 0.0f;  // of the polygon, rad; 0: a side's middle lies towards +x
    float aperture_ratio = 1.0f;     // height by width

    bool is_panoramic() const { return projection > Projection::orthographic; }
    // Whether a point of the full frame shows anything, which the corners of a fisheye do not. The
    // others need that.
    bool sees(const Vec2& film) const;
    // Ray through a point of the full frame, in pixels from the bottom left corner. `lens` in [0,
    // 1)^2 maps to a point of the lens, uniform over its area. t_near and t_far hold the clips.
    Ray ray(float x, float y, const Vec2& lens) const;
    // Derivatives of that ray by x and y, per pixel.
    RayChange ray_change(float x, float y, const Vec2& lens) const;
    // The inverse of ray(): the ray through view(p, lens)->film and the same `lens` leads to p.
    // Empty if p is clipped or not in front of the camera, and for panoramic cameras, to which
    // nothing connects.
    std::optional<CameraView> view(const Vec3& p, const Vec2& lens) const;
    // For a perspective camera and a point `x` of its lens: the ray through a point of the film,
    // the film position of the direction `w`, and the pixels^2 per sr around it.
    Ray ray_from(const Vec3& x, const Vec2& film) const;
    Vec2 film_towards(const Vec3& x, const Vec3& w) const;
    float film_density_omega(const Vec3& w) const;
    // Whether a film position lies in the crop or less than `margin` pixels beside it.
    bool is_near_crop(const Vec2& film, float margin) const;
    Vec3 forward() const { return to_world.column(2) * -1.0f; }  // along the viewing axis
    // Along the viewing axis, of a panoramic camera along the ray, m.
    float depth(const Vec3& p) const;
};

// What graphs are told of a camera; `origin` is that of its world coordinates.
ViewSpace view_space(const Camera& camera, const Vec3& origin);

struct Environment {
    uint32_t material = kNone;
    uint32_t visibility = kVisibleAll;
    bool feeds_caustics = true;
    std::string light_group{};  // "": none
};

}  // namespace spc
