// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps that the camera sees in casters, for every caster, light and camera: chains from the camera
// find them beside path tracing. It has to find them often enough, so they are some pixels wide.
#include "agreement/parts.h"

namespace spc::test {
namespace {

// The ball at the origin reflects one lamp to the camera, and refracts the other.
const Vec3 kEye(0.0f, -3.0f, 2.0f), kBefore(0.3f, -1.4f, 2.2f), kBehind(0.1f, 1.5f, -1.1f);

constexpr uint32_t kRounds = 4000;  // of the reference

Part camera(const std::string& name, const std::function<void(Camera&)>& more = {}) {
    constexpr uint32_t kWidth = 32;     // pixels
    constexpr float kHalfView = 0.08f;  // at distance 1: little more than a ball
    return {name, [=](SceneMaker& m) {
                Camera camera;
                camera.to_world = rotation_x(std::atan2(-kEye.y, kEye.z), kEye);
                camera.width = camera.height = kWidth;
                camera.crop = {0, 0, kWidth, kWidth};
                camera.viewplane = {-kHalfView, kHalfView, -kHalfView, kHalfView};
                if (more) more(camera);
                m.builder.set_camera(camera);
            }};
}
void set_lens(Camera& camera) {
    camera.aperture_radius = 0.02f;
    camera.focus_distance = 3.0f;
}
void set_window(Camera& camera) { camera.crop = {12, 10, 17, 20}; }

Part seen(const std::string& name, const Mesh& mesh, const Graph& graph) {
    return {name, [=](SceneMaker& m) { m.add(mesh, graph, {}, CausticsRole::caster); }};
}
void add_small_ball(SceneMaker& m, const Graph& graph, float x, uint32_t visibility = kVisibleAll) {
    m.add(sphere(24, 0.14), graph, translation({x, 0, 0}), CausticsRole::caster, visibility);
}
const Part kMirrorBall = seen("mirror ball", sphere(24, 0.5), mirror()),
           kGlassBall = seen("glass ball", sphere(24, 0.5), glass(1.5f));
const Part kBumpedMirror{"bumped mirror", [](SceneMaker& m) {
                             m.builder.add_image(plane_normals(32, 0.25, 0.05, 4));
                             m.add(square(1.0f), normal_mapped(mirror(), {1, 1}),
                                   rotation_x(kPi / 4), CausticsRole::caster);
                         }};
// Across the view.
Part before_camera(const Part& casters, const std::string& name, const Graph& graph) {
    return {casters.name + " " + name, [=](SceneMaker& m) {
                casters.add(m);
                m.add(square(0.5f), graph, rotation_x(0.98f, kEye * 0.8f));
            }};
}
Part bulb_before(float radius = 0.1f) { return bulb("", kBefore, radius); }

// Where nothing is scattered diffusely.
Row row(const Part& casters, const Part& light = bulb_before(), const Part& camera_of = camera("")) {
    Row row{.casters = casters, .light = light, .camera = camera_of, .few_hits = true};
    row.receiver = {"", [](SceneMaker&) {}};
    row.settings.limits.diffuse = 0;
    return row;
}
Claim claim(ChainFinder finder, CameraChainUse chains, uint32_t rounds) {
    constexpr double kNotices = 0.3;
    Method method{"chains from the camera", true, false, finder};
    method.camera_chains = chains;
    method.emission_cells = 0;  // nothing is lit by way of casters
    return {method, rounds, kNotices};
}

// What the manifold does elsewhere is not to show in their weights.
std::vector<Row> beside_every_finder() {
    std::vector<Row> rows{row(kMirrorBall), row(kGlassBall)};
    for (Row& one : rows)
        for (const ChainFinder finder : {ChainFinder::walks, ChainFinder::mnee})
            one.claims.push_back(claim(finder, CameraChainUse::learned, kRounds / 16));
    return rows;
}

std::vector<Row> every_caster() {
    return {row({"two balls",
                 [](SceneMaker& m) {
                     add_small_ball(m, mirror(), -0.15f);
                     add_small_ball(m, glass(1.5f), 0.15f);
                 }},
                bulb_before(0.2f)),
            row({"a ball beside one that the camera does not see",
                 [](SceneMaker& m) {
                     add_small_ball(m, mirror(), -0.15f);
                     add_small_ball(m, mirror(), 0.15f, kVisibleAll & ~uint32_t{kVisibleCamera});
                 }},
                bulb_before(0.2f)),
            row(kBumpedMirror, bulb_before(0.05f))};
}

std::vector<Row> every_camera() {
    return {row(kMirrorBall, bulb_before(), camera("lens", set_lens)),
            row(kMirrorBall, bulb_before(), camera("window", set_window)),
            row(before_camera(kMirrorBall, "behind a pane", diffuse(0.5f)), bulb_before(),
                camera("clipped nearby", [](Camera& camera) { camera.clip_near = 1.2f; }))};
}

std::vector<Row> every_light() {
    LightDesc sun = lamp(LightType::sun, 2.0f);
    sun.to_world = rotation_x(0.56f);
    sun.sun_angle = 0.1f;
    return {
        row(kGlassBall, light("sun", sun)),
        row(kGlassBall, {"square lamp and a bulb",
                         [](SceneMaker& m) {
                             m.add_area_light(rotation_x(-0.7f, {0.4f, -1.0f, 1.6f}), 0.1f, 5.0f);
                             add_bulb(m, kBefore, 0.1f);
                         }}),
        row(kGlassBall,
            {"glowing mesh", [](SceneMaker& m) { add_glowing(m, sphere(12, 0.1), kBefore); }}),
        row(kMirrorBall,
            {"lamp that shines through everything beside a bulb", [](SceneMaker& m) {
                 add_bulb(m, kBefore, 0.1f);
                 add_bulb(m, {-0.3f, -1.4f, 2.2f}, 0.1f, kNotDirectly & ~uint32_t{kVisibleShadow});
             }})};
}

std::vector<Row> within_limits() {
    const auto within = [](const char* name, const BounceLimits& limits) {
        Row one = row(kGlassBall, {name, [](SceneMaker& m) {
                                       add_bulb(m, kBehind, 0.012f);
                                       add_bulb(m, kBefore, 0.15f);
                                   }});
        one.settings.limits = limits;
        return one;
    };
    return {within("no transmission", {16, 0, 16, 0, 16}),
            within("one transmission", {16, 0, 16, 1, 16}), within("one bounce", {1, 0, 1, 1, 16})};
}

Table learned() {
    Table table;
    for (const auto& rows :
         {beside_every_finder(), every_caster(), every_camera(), every_light(), within_limits()})
        table.rows.insert(table.rows.end(), rows.begin(), rows.end());
    for (Row& one : table.rows) {
        one.reference.rounds = kRounds;
        one.claims.push_back(claim(ChainFinder::sheets, CameraChainUse::learned, kRounds / 16));
    }
    return table;
}

// Where nothing that was learned leads to them.
Table searched() {
    constexpr uint32_t kFewer = kRounds / 2;
    const auto lens_and_window = [](Camera& camera) {
        set_lens(camera);
        set_window(camera);
    };
    Table table{{row(kMirrorBall, bulb_before(), camera("lens and window", lens_and_window)),
                 row(kBumpedMirror, bulb_before(0.05f)),
                 row(before_camera(kMirrorBall, "behind a veil", transparent(0.5f)))}};
    for (Row& one : table.rows) {
        one.reference.rounds = kFewer;
        one.claims = {claim(ChainFinder::sheets, CameraChainUse::searched, kFewer / 16)};
    }
    return table;
}

}  // namespace

SPC_AGREEMENT(CameraChains, learned);
SPC_AGREEMENT(SearchedCameraChains, searched);

}  // namespace spc::test
