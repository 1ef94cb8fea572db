// SPDX-License-Identifier: GPL-3.0-or-later
// A random scene of casters, receivers and lights, as plain data whose parts can be left out.
#pragma once

#include "dice.h"
#include "scene/description.h"

#include <functional>
#include <string>
#include <vector>

namespace spc::fuzz {

enum class Form : uint8_t { ball, faceted_ball, bowl, pane, slab, block, waves };
enum class Finish : uint8_t { mirror, metal, glass, refraction };
enum class Detail : uint8_t { none, normal_map, bump };

struct Caster {
    std::string name;
    Form form = Form::ball;
    Finish finish = Finish::mirror;
    float roughness = 0.0f, ior = 1.5f;
    Detail detail = Detail::none;
    uint32_t texels = 64;             // along each side of the map
    float wavelength = 0.2f;          // of its waves, in parts of the map
    float slope = 0.1f;               // of its waves, root mean square
    float absorption = 0.0f;          // of the medium inside, 1/m
    float coat = 0.0f;                // share of a diffuse surface that covers it
    Vec3 position{0.0f}, turn{0.0f};  // m, rad
    Vec3 scale{1.0f};                 // of a form with a radius of 1 m
    bool flipped = false;             // inside out, by a negative scale
    bool filled = false;              // with a smaller one of its kind
    uint32_t copies = 1;              // of one mesh, side by side
    uint32_t visibility = kVisibleAll;
    CausticsRole role = CausticsRole::automatic;
};

struct Receiver {
    std::string name;
    float albedo = 0.8f, gloss = 0.0f;  // gloss: share of a lobe of roughness 0.5
    bool wall = false;                  // else the floor
    uint32_t visibility = kVisibleAll;
};

enum class LampKind : uint8_t { point, spot, rectangle, ellipse, sun, mesh };
struct Lamp {
    std::string name;
    LampKind kind = LampKind::point;
    Vec3 position{0.0f, 0.0f, 2.0f}, target{0.0f};
    float extent =
        0.3f;  // radius or side, m; of a sun its angle, rad; 0: a point, or parallel light
    float stretch = 1.0f;  // of an area: height by width
    float beam = kPi;      // full angle of a spot's cone or an area's light, rad
    float blend = 0.3f;
    bool soft = false;
    float power = 20.0f;  // W; of a sun W/m^2
    uint32_t visibility = kVisibleAll;
    bool feeds_caustics = true;
};

enum class Sky : uint8_t { none, even, peaked };

struct Plan {
    std::vector<Caster> casters;
    std::vector<Receiver> receivers;
    std::vector<Lamp> lamps;
    Sky sky = Sky::none;
    bool orthographic = false;
    float aperture = 0.0f;  // m
    Vec3 eye{0.0f, -3.0f, 2.0f};
    float half_view =
        0.45f;  // of the viewplane at distance 1; orthographic: in parts of the distance
    uint32_t bounces = 8, diffuse_bounces = 2;
    bool reflective = true, refractive = true;  // caustics

    // Whether rays find every light that there is, so that path tracing has all of the picture.
    bool is_found_by_rays() const;
    std::string text() const;
};

Plan random_plan(uint64_t seed);

// What may be left out of a plan, and how. Names stay valid: a plan without some of its parts has
// no names that the whole plan lacks.
struct Part {
    std::string name;
    std::function<void(Plan&)> leave_out;
};
std::vector<Part> parts_of(const Plan& plan);
void leave_out(Plan& plan, const std::string& part);

}  // namespace spc::fuzz
