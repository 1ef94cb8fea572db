// SPDX-License-Identifier: GPL-3.0-or-later
// A glinting floor under a camera that looks at one pixel of it, far enough that directions hardly
// change over that pixel.
#pragma once

#include "support/casters.h"
#include "support/radiance.h"
#include "support/truths.h"

namespace spc::test {

struct GlintFloor {
    Graph material;  // image 0 is its normal map
    Image map;
    double pixel_texels = 12.0;  // width of a pixel at the floor
    float view_angle = 0.6f;     // from the floor's normal, rad
    std::function<void(SceneMaker&)> light;
    Projection projection = Projection::perspective;
    float aperture_radius = 0.0f;  // m, focused half-way to the floor
};

inline LightDesc sun_towards(const Vec3& wi, float angle, float irradiance) {
    LightDesc sun;
    sun.name = "sun";
    sun.type = LightType::sun;
    const Frame frame = Frame::around(normalize(wi));
    for (int i = 0; i < 3; ++i)
        sun.to_world.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
    sun.power = Spectrum(irradiance);
    sun.sun_angle = angle;
    return sun;
}

// Of one pixel, of the given width at `target`, from `distance` away in the direction `from`.
inline Camera look_at(const Vec3& target, const Vec3& from, float distance, float width) {
    Camera camera;
    const Frame frame = Frame::around(normalize(from));
    camera.to_world = translation(target + frame.z * distance);
    for (int i = 0; i < 3; ++i)
        camera.to_world.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
    camera.width = camera.height = 1;
    const float half = 0.5f * width / distance;
    camera.viewplane = {-half, half, -half, half};
    camera.clip_far = kInfinity;
    return camera;
}

// The same as the floor wants it.
inline Camera look_at(const Vec3& target, const Vec3& from, float distance, const GlintFloor& floor) {
    const auto width = static_cast<float>(2.0 * floor.pixel_texels / floor.map.width);
    Camera camera = look_at(target, from, distance, width);
    camera.projection = floor.projection;
    if (floor.projection == Projection::orthographic)
        camera.viewplane = {-0.5f * width, 0.5f * width, -0.5f * width, 0.5f * width};
    camera.aperture_radius = floor.aperture_radius;
    camera.focus_distance = 0.5f * distance;
    return camera;
}

// A floor of 2 x 2 m with the map over it once, seen from 1 km, in a picture of one pixel.
// `mirrored`: by way of a mirror.
inline RenderScene finish(const GlintFloor& floor, GlintsMode mode, bool mirrored = false) {
    constexpr float kDistance = 1000.0f;
    SceneMaker maker;
    Graph graph = floor.material;
    graph.glints = mode;
    maker.builder.add_image(floor.map);
    maker.add(square(1.0f), graph);
    const Vec3 from(0.0f, -std::sin(floor.view_angle), std::cos(floor.view_angle));
    if (mirrored) {
        const Vec3 at = from * 5.0f, to_camera = normalize(Vec3(0.5f, -1.0f, 0.3f));
        const Frame frame = Frame::around(normalize(from * -1.0f + to_camera));
        Transform m = translation(at);
        for (int i = 0; i < 3; ++i)
            m.row[static_cast<size_t>(i)] = Vec3(frame.x[i], frame.y[i], frame.z[i]);
        maker.add(square(1.0f), mirror(), m);
        maker.builder.set_camera(look_at(at, to_camera, kDistance, floor));
    } else {
        maker.builder.set_camera(look_at(Vec3(0.0f), from, kDistance, floor));
    }
    floor.light(maker);
    return maker.finish();
}

// Samples of the pixel, with glints through the filter or as plain path tracing.
struct PixelEstimate {
    MeanEstimate radiance;  // of the channels
    std::array<MeanEstimate, 3> channels;
    PathStats stats;
};
inline PixelEstimate estimate_pixel(const RenderScene& world, const IntegratorSettings& settings,
                                    uint32_t samples, uint32_t seed,
                                    FilterKind kind = FilterKind::blackman_harris,
                                    const GlintSampling& sampling = {}) {
    const PixelFilter filter(kind, 1.5f);
    const Camera& camera = world.scene->camera;
    const RoundState state{kAlways, {}, sampling};
    PixelEstimate result;
    for (uint32_t i = 0; i < samples; ++i) {
        const Sampler sampler(seed, i, 0);
        const Vec2 offset = filter.sample(sampler[Domain::film].two());
        const Vec2 film = offset + Vec2(0.5f), lens = sampler[Domain::lens].two();
        const PixelKernel pixel{&filter, film, offset};
        const PathSample sample =
            path_radiance(world, settings, state, camera.ray(film.x, film.y, lens), lens, sampler,
                          result.stats, &pixel);
        EXPECT_TRUE(is_finite(sample.radiance));
        result.radiance.add(
            (double(sample.radiance.x) + double(sample.radiance.y) + double(sample.radiance.z)) /
            3.0);
        for (size_t k = 0; k < 3; ++k)
            result.channels[k].add(double(sample.radiance[static_cast<int>(k)]));
    }
    return result;
}

// As path tracing finds it: the radiance and its channels.
inline PixelEstimate path_traced_pixel(const std::string& name, const RenderScene& world,
                                       uint32_t samples, uint32_t seed,
                                       FilterKind kind = FilterKind::blackman_harris) {
    PixelEstimate result;
    const Estimates means = truth(name, samples, [&](uint32_t count) {
        const PixelEstimate found = estimate_pixel(world, unlimited(), count, seed, kind);
        result.stats = found.stats;
        Estimates all(found.channels.begin(), found.channels.end());
        all.push_back(found.radiance);
        return all;
    });
    std::copy_n(means.begin(), 3, result.channels.begin());
    result.radiance = means[3];
    return result;
}

}  // namespace spc::test
