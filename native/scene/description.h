// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a scene as plain data: what the builder collects and the frozen Scene keeps.
#pragma once

#include "core/shared.h"
#include "math/bounds.h"
#include "shading/program.h"

#include <string>
#include <vector>

namespace spc {

// Bits of ray visibility. A ray has the bit of its kind, an object those of the rays that see it.
enum Visibility : uint32_t {
    kVisibleCamera = 1,
    kVisibleDiffuse = 2,
    kVisibleGlossy = 4,
    kVisibleTransmission = 8,
    kVisibleShadow = 16,
    kVisibleAll = 31,
    // Rays after a bounce.
    kVisibleScattered = kVisibleDiffuse | kVisibleGlossy | kVisibleTransmission
};

enum class CausticsRole : uint8_t { automatic, off, caster, receiver, both };

struct UvLayer {
    std::string name;
    std::vector<Vec2> uv;              // 3 a triangle
    std::vector<Vec3> tangents;        // 3 a triangle, object space, or empty
    std::vector<float> tangent_signs;  // 3 a triangle, or empty
};

struct Mesh {
    std::string name;
    std::vector<Vec3> positions;  // object space
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<Vec3> normals;    // 3 a triangle, unit, object space; empty = flat
    std::vector<uint32_t> slots;  // material slot of each triangle; empty = all 0
    uint32_t slot_count = 1;
    std::vector<UvLayer> uv_layers;
    uint32_t active_uv_layer = 0;
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
    float terminator_stretch = 1.0f;                  // Terminator::stretch
    uint32_t pass_index = 0;                          // what its pass shows
    float crypto_object = 0.0f, crypto_asset = 0.0f;  // identifiers, 0: none
    // Set when the scene is frozen.
    std::vector<std::vector<uint32_t>>
        uv_layers;  // [slot][layer of the material] -> layer of the mesh, or kNone
    // Of every vertex if the mesh has this instance alone, else empty.
    SharedArray<Vec3> world_positions;
    bool caster = false, receiver = false;
    bool rough_caster = false;  // throws blurred caustics; see docs/glossary.md
    bool emits = false;
    bool has_subsurface = false;  // light may walk below its surface
    bool absorbs = false;         // a material has an absorbing medium behind it
    bool turns_light() const { return caster || rough_caster; }
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

// Where a ray meets a light's surface. A sphere is hit from outside or, if the ray starts inside, from
// within. With soft falloff it is a disk around its centre that faces the ray's origin. An area light is hit
// on its shining side alone.
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

enum class Projection : uint8_t { perspective, orthographic };

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
    // Left, right, bottom, top: at distance 1, of an orthographic camera in m.
    std::array<float, 4> viewplane{-1, 1, -1, 1};
    float clip_near = 0.0f, clip_far = kInfinity;
    float aperture_radius = 0.0f;  // m; 0: a pinhole, or parallel rays
    // Of an aperture alone:
    float focus_distance = 1.0f;     // along the viewing axis, m
    uint32_t aperture_blades = 0;    // sides of a regular polygon, 0: a disc
    float aperture_rotation = 0.0f;  // of the polygon, rad; 0: a side's middle lies towards +x
    float aperture_ratio = 1.0f;     // height by width

    // Ray through a point of the full frame, in pixels from the bottom left corner. `lens` in [0, 1)^2 maps
    // to a point of the lens, uniform over its area. t_near and t_far hold the clips.
    Ray ray(float x, float y, const Vec2& lens) const;
    // Derivatives of that ray by x and y, per pixel.
    RayChange ray_change(float x, float y, const Vec2& lens) const;
    // The inverse of ray(): the ray through view(p, lens)->film and the same `lens` leads to p. Empty if p
    // is clipped or not in front of the camera.
    std::optional<CameraView> view(const Vec3& p, const Vec2& lens) const;
    // For a perspective camera and a point `x` of its lens: the ray through a point of the film, the film
    // position of the direction `w`, and the pixels^2 per sr around it.
    Ray ray_from(const Vec3& x, const Vec2& film) const;
    Vec2 film_towards(const Vec3& x, const Vec3& w) const;
    float film_density_omega(const Vec3& w) const;
    // Whether a film position lies in the crop or less than `margin` pixels beside it.
    bool is_near_crop(const Vec2& film, float margin) const;
    Vec3 forward() const { return to_world.column(2) * -1.0f; }  // along the viewing axis
    float depth(const Vec3& p) const;                            // along the viewing axis, m
};

struct Environment {
    uint32_t material = kNone;
    uint32_t visibility = kVisibleAll;
    bool feeds_caustics = true;
};

}  // namespace spc
