// SPDX-License-Identifier: GPL-3.0-or-later
// MNEE seeds [Hanika15] and brute force, for casters of which they find all chains, some, or few.
#include "agreement/parts.h"

namespace spc::test {
namespace {

// From just above the floor: casters stand in nobody's way.
const Part kAboveFloor{"", [](SceneMaker& maker) {
                           Camera camera;
                           camera.projection = Projection::orthographic;
                           camera.to_world = translation({0, 0.05f, 0.01f});
                           camera.width = camera.height = kSide;
                           camera.crop = {0, 0, kSide, kSide};
                           camera.viewplane = {-0.5f, 0.5f, -0.25f, 0.25f};
                           maker.builder.set_camera(camera);
                       }};

Row row(const std::string& name, const std::function<void(SceneMaker&)>& add_casters,
        const std::array<double, 2>& loses, double notices) {
    constexpr uint32_t kRounds = 150000 / (kSide * kSide);
    Method biased = kMnee;
    biased.name = "mnee alone";
    biased.biased = true;
    return {.casters = {name, add_casters},
            .light = bulb("", {0.2f, -0.7f, 2.2f}, 0.5f),
            .camera = kAboveFloor,
            .reference = {10 * kRounds},
            .claims = {{kMnee, kRounds, notices, 0.0}, {biased, kRounds, 0.0, 0.0, loses}}};
}

Table table() {
    return {{row(
                 "flat slab",
                 [](SceneMaker& m) {
                     const Mesh face = flat(square(4.0f));
                     add_caster(m, face, refraction(1.5f), translation({0, 0, 0.9f}));
                     add_caster(m, face, refraction(1.5f), rotation_x(kPi, {0, 0, 0.6f}));
                 },
                 {0.0, 0.0}, 0.05),
             row(
                 "glass ball",
                 [](SceneMaker& m) {
                     add_caster(m, sphere(24, 0.4), refraction(1.5f), translation({0, 0.1f, 0.9f}));
                 },
                 {0.02, 0.5}, 0.3),
             row(
                 "mirror ball",
                 [](SceneMaker& m) {
                     add_caster(m, sphere(24, 0.4), mirror(), translation({0, 1.2f, 0.5f}));
                 },
                 {0.0, 0.0}, 0.2),
             row(
                 "normal-mapped mirror",
                 [](SceneMaker& m) {
                     m.builder.add_image(plane_normals(128, 0.25, 0.1, 5));
                     add_caster(m, panel_with_uvs(1.6), normal_mapped(mirror(), Vec2(1.0f, 1.0f)),
                                rotation_x(1.3f, {0.0f, 0.9f, 0.8f}));
                 },
                 {0.5, 1.0}, 0.8)}};
}

}  // namespace

SPC_AGREEMENT(Mnee, table);

}  // namespace spc::test
