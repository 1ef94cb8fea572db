// SPDX-License-Identifier: GPL-3.0-or-later
// The same scene in every size: there is no length of which light knows.
#include "support/casters.h"
#include "support/radiance.h"

#include <gtest/gtest.h>

namespace spc::test {
namespace {

RenderScene table(float scale) {
    const auto place = [&](const Vec3& p) {
        Transform t = translation(p * scale);
        for (size_t i = 0; i < 3; ++i) t.row[i] = t.row[i] * scale;
        return t;
    };
    SceneMaker maker;
    maker.add(square(2.0f), diffuse(0.8f), place(Vec3(0.0f)));
    maker.add(sphere(24, 0.5), glass(1.45f), place({0.0f, 0.0f, 0.8f}));
    maker.add(sphere(24, 0.3), mirror(), place({-1.0f, 0.2f, 0.3f}));
    maker.add(square(0.2f), emission(5.0f), place({0.8f, 0.9f, 1.2f}));
    Transform lamp = rotation_x(0.2f, Vec3(0.5f, 0.6f, 3.0f) * scale);
    maker.add_area_light(lamp, 0.5f * scale, 100.0f * scale * scale);
    return maker.finish();
}

// The same random numbers lead along the same paths, but for rounding.
TEST(Scale, LeavesThePictureAsItIs) {
    constexpr uint32_t kSamples = 2000;
    const auto radiance = [](float scale, bool manifold) {
        IntegratorSettings settings;
        settings.limits = {4, 2, 4, 4, 4};
        if (manifold) settings.manifold = unbiased_manifold();
        Uniforms uniforms(5);
        return estimate(table(scale), settings, kSamples,
                        [&](uint32_t) {
                            const Vec2 u = uniforms.two();
                            return ray_to(Vec3(0.0f, -4.2f, 3.0f) * scale,
                                          Vec3(2.4f * u.x - 1.2f, 2.4f * u.y - 1.2f, 0.2f) * scale);
                        })
            .radiance;
    };
    for (const bool manifold : {false, true}) {
        const MeanEstimate metres = radiance(1.0f, manifold);
        EXPECT_GT(metres.mean(), 0.1);
        // Powers of two are exact: no path goes another way.
        for (const float scale : {0x1p-23f, 0x1p-17f, 0x1p20f})
            EXPECT_NEAR(radiance(scale, manifold).mean(), metres.mean(), 1e-4 * metres.mean())
                << scale << (manifold ? ", manifold" : ", path tracing");
        for (const float scale : {1e-7f, 1e-5f, 1e-3f, 1e6f})
            EXPECT_NEAR(radiance(scale, manifold).mean(), metres.mean(),
                        manifold ? 0.05 * metres.mean() : 0.005 * metres.mean())
                << scale << (manifold ? ", manifold" : ", path tracing");
    }
}

}  // namespace
}  // namespace spc::test
