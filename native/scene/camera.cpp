// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/warp.h"
#include "scene/panorama.h"

namespace spc {

namespace {

// A thin lens: all rays from one point of the viewplane meet where the focal plane is.
struct LensPoint {
    Vec2 at{0.0f, 0.0f};    // camera space, m
    Vec2 tilt{0.0f, 0.0f};  // what a ray through it moves towards the axis, per m along the axis
};

LensPoint tilted(const Camera& camera, const Vec2& at) { return {at, at / camera.focus_distance}; }

LensPoint lens_point(const Camera& camera, const Vec2& lens) {
    if (camera.aperture_radius == 0.0f) return {};
    Vec2 p;
    if (camera.aperture_blades == 0) {
        p = concentric_disk(lens);
    } else {  // one of the triangles between a side and the middle
        const auto sides = static_cast<float>(camera.aperture_blades);
        const float side = std::min(std::floor(lens.x * sides), sides - 1.0f);
        const Vec2 b = uniform_triangle({lens.x * sides - side, lens.y});
        const float half_angle = kPi / sides;
        const Vec2 upright((b.x + b.y) * std::cos(half_angle), (b.x - b.y) * std::sin(half_angle));
        const float angle = camera.aperture_rotation + 2.0f * half_angle * side;
        const float c = std::cos(angle), s = std::sin(angle);
        p = {c * upright.x - s * upright.y, s * upright.x + c * upright.y};
    }
    const Vec2 at(p.x * camera.aperture_radius / camera.aperture_ratio,
                  p.y * camera.aperture_radius);
    return tilted(camera, at);
}

// Pixels per unit of the viewplane.
Vec2 pixel_scale(const Camera& camera) {
    const auto& [left, right, bottom, top] = camera.viewplane;
    return {static_cast<float>(camera.width) / (right - left),
            static_cast<float>(camera.height) / (top - bottom)};
}

Vec2 on_viewplane(const Camera& camera, const Vec2& pixels) {
    const auto& [left, right, bottom, top] = camera.viewplane;
    return {lerp(left, right, pixels.x / static_cast<float>(camera.width)),
            lerp(bottom, top, pixels.y / static_cast<float>(camera.height))};
}

// The ray of a point of the viewplane, in camera space.
struct LocalRay {
    Vec2 origin;    // on the plane z = 0
    Vec2 slope;     // in x and y, per distance along the axis
    float stretch;  // distance along the ray per distance along the axis
};

LocalRay local_ray(Projection projection, const Vec2& film, const LensPoint& lens) {
    const bool perspective = projection == Projection::perspective;
    const Vec2 origin = perspective ? lens.at : film + lens.at;
    const Vec2 slope = perspective ? film - lens.tilt : -lens.tilt;
    return {origin, slope, length(Vec3(slope.x, slope.y, -1.0f))};
}

// The lens of a panoramic camera turns to face each ray; all rays of a point of the film meet on
// it.
Ray panoramic_ray(const Camera& camera, const Vec2& pixels, const Vec2& lens) {
    const Vec3 ahead =
        panoramic_direction(camera, on_viewplane(camera, pixels)).value_or(Vec3(0, 0, -1));
    const Vec2 at = lens_point(camera, lens).at;
    const Vec3 along = safe_normalize(Vec3(0, 0, -1) + ahead * ahead.z, Vec3(1, 0, 0));
    const Vec3 origin = along * at.x + cross(ahead, along) * at.y;
    const Vec3 d =
        camera.aperture_radius > 0.0f ? normalize(ahead * camera.focus_distance - origin) : ahead;
    return {camera.to_world.point(origin), camera.to_world.vector(d), camera.clip_near,
            camera.clip_far};
}

// By differences across a pixel.
RayChange panoramic_change(const Camera& camera, const Vec2& pixels, const Vec2& lens) {
    RayChange change{{Vec3(0.0f), Vec3(0.0f)}, {Vec3(0.0f), Vec3(0.0f)}};
    for (int i = 0; i < 2; ++i) {
        Vec2 half(0.0f, 0.0f);
        half[i] = 0.5f;
        if (!camera.sees(pixels + half) || !camera.sees(pixels - half)) continue;
        const Ray after = panoramic_ray(camera, pixels + half, lens),
                  before = panoramic_ray(camera, pixels - half, lens);
        change.origin[static_cast<size_t>(i)] = after.origin - before.origin;
        change.direction[static_cast<size_t>(i)] = after.direction - before.direction;
    }
    return change;
}

Ray ray_through(const Camera& camera, const Vec2& pixels, const LensPoint& lens) {
    const Vec2 film = on_viewplane(camera, pixels);
    const auto [origin, slope, stretch] = local_ray(camera.projection, film, lens);
    return {camera.to_world.point(Vec3(origin.x, origin.y, 0.0f)),
            camera.to_world.vector(Vec3(slope.x, slope.y, -1.0f) * (1.0f / stretch)),
            camera.clip_near * stretch, camera.clip_far * stretch};
}

LensPoint point_of_lens(const Camera& camera, const Vec3& x) {
    if (camera.aperture_radius == 0.0f) return {};
    const Vec3 local = camera.to_world.transposed(x - camera.to_world.translation);
    return tilted(camera, {local.x, local.y});
}

}  // namespace

ViewSpace view_space(const Camera& camera, const Vec3& origin) {
    ViewSpace view;
    view.to_world = camera.to_world;
    view.to_world.translation += origin;
    for (Vec3& row : view.to_world.row) row.z *= -1.0f;
    view.from_world = view.to_world.inverse();
    view.perspective = camera.projection == Projection::perspective;
    view.viewplane = camera.viewplane;
    view.pixel = (camera.viewplane[1] - camera.viewplane[0]) / static_cast<float>(camera.width);
    view.origin = origin;
    return view;
}

bool Camera::sees(const Vec2& film) const {
    return !is_panoramic() || panoramic_direction(*this, on_viewplane(*this, film)).has_value();
}

Ray Camera::ray(float x, float y, const Vec2& lens) const {
    if (is_panoramic()) return panoramic_ray(*this, {x, y}, lens);
    return ray_through(*this, {x, y}, lens_point(*this, lens));
}

Ray Camera::ray_from(const Vec3& x, const Vec2& film) const {
    return ray_through(*this, film, point_of_lens(*this, x));
}

Vec2 Camera::film_towards(const Vec3& x, const Vec3& w) const {
    const Vec3 local = to_world.transposed(w);
    const Vec2 corner(viewplane[0], viewplane[2]);
    return (Vec2(local.x, local.y) / -local.z + point_of_lens(*this, x).tilt - corner) *
           pixel_scale(*this);
}

RayChange Camera::ray_change(float x, float y, const Vec2& lens) const {
    if (is_panoramic()) return panoramic_change(*this, {x, y}, lens);
    const auto& [left, right, bottom, top] = viewplane;
    const std::array<Vec3, 2> across{Vec3((right - left) / static_cast<float>(width), 0.0f, 0.0f),
                                     Vec3(0.0f, (top - bottom) / static_cast<float>(height), 0.0f)};
    RayChange change{{Vec3(0.0f), Vec3(0.0f)}, {Vec3(0.0f), Vec3(0.0f)}};
    if (projection == Projection::orthographic) {
        for (size_t i = 0; i < 2; ++i) change.origin[i] = to_world.vector(across[i]);
        return change;
    }
    const LocalRay local =
        local_ray(projection, on_viewplane(*this, {x, y}), lens_point(*this, lens));
    const Vec3 d = Vec3(local.slope.x, local.slope.y, -1.0f) * (1.0f / local.stretch);
    for (size_t i = 0; i < 2; ++i)
        change.direction[i] =
            to_world.vector((across[i] - d * dot(d, across[i])) * (1.0f / local.stretch));
    return change;
}

std::optional<CameraView> Camera::view(const Vec3& p, const Vec2& lens) const {
    if (is_panoramic()) return std::nullopt;
    const Vec3 local = to_world.transposed(p - to_world.translation);
    const float distance = -local.z;  // along the axis
    if (!(distance > 0.0f && distance >= clip_near && distance <= clip_far)) return std::nullopt;
    const LensPoint through = lens_point(*this, lens);
    const Vec2 from_lens = Vec2(local.x, local.y) - through.at;
    const bool perspective = projection == Projection::perspective;
    const Vec2 film =
        perspective ? from_lens / distance + through.tilt : from_lens + through.tilt * distance;
    const auto [origin, slope, stretch] = local_ray(projection, film, through);
    const Vec2 corner(viewplane[0], viewplane[2]), scale = pixel_scale(*this);
    // A surface that faces the ray covers `stretch` times its area of a plane across the axis.
    const float viewplane_per_area = stretch / (perspective ? sqr(distance) : 1.0f);
    return CameraView{to_world.point(Vec3(origin.x, origin.y, 0.0f)), clip_near * stretch,
                      clip_far * stretch, (film - corner) * scale,
                      std::abs(scale.x * scale.y) * viewplane_per_area};
}

float Camera::film_density_omega(const Vec3& w) const {
    const Vec2 scale = pixel_scale(*this);
    const float cosine = dot(forward(), w);
    return std::abs(scale.x * scale.y) / (cosine * cosine * cosine);
}

bool Camera::is_near_crop(const Vec2& film, float margin) const {
    const auto& [x0, y0, width_of_crop, height_of_crop] = crop;
    const auto inside = [margin](float at, uint32_t begin, uint32_t size) {
        return at >= static_cast<float>(begin) - margin &&
               at < static_cast<float>(begin + size) + margin;
    };
    return inside(film.x, x0, width_of_crop) && inside(film.y, y0, height_of_crop);
}

float Camera::depth(const Vec3& p) const {
    if (is_panoramic()) return length(p - to_world.translation);
    return -dot(p - to_world.translation, to_world.column(2));
}

}  // namespace spc
