// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/clean_mesh.h"

#include "math/triangle.h"

namespace spc {
namespace {

// Twice the area, relative to the longest edge squared, below which a triangle has no direction in
// single precision.
constexpr double kRelativeZeroArea = 1e-12;

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3d e1 = Vec3d(b) - Vec3d(a), e2 = Vec3d(c) - Vec3d(a), e3 = e2 - e1;
    const double longest = std::max({length_squared(e1), length_squared(e2), length_squared(e3)});
    if (!(length(cross(e1, e2)) > kRelativeZeroArea * longest && longest > 0.0)) return false;
    // Its normal must exist in single precision, without denormals.
    const float n2 = length_squared(cross(b - a, c - a));
    return n2 >= std::numeric_limits<float>::min() && n2 < kInfinity;
}

// Keeps the entries whose triangle survives, `per` values a triangle.
template <class T>
void keep(std::vector<T>& values, const std::vector<char>& survives, size_t per) {
    if (values.empty()) return;
    size_t out = 0;
    for (size_t t = 0; t < survives.size(); ++t)
        if (survives[t])
            for (size_t k = 0; k < per; ++k) values[out++] = values[t * per + k];
    values.resize(out);
}

}  // namespace

void drop_degenerate_triangles(Mesh& mesh) {
    std::vector<char> survives(mesh.triangles.size());
    size_t count = 0;
    for (size_t t = 0; t < survives.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        survives[t] = has_area(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
        count += survives[t] ? 1 : 0;
    }
    if (count == survives.size()) return;
    mesh.dropped_triangles += static_cast<uint32_t>(survives.size() - count);
    keep(mesh.triangles, survives, 1);
    keep(mesh.normals, survives, 3);
    keep(mesh.flat_faces, survives, 1);
    keep(mesh.slots, survives, 1);
    for (Attribute& attribute : mesh.attributes) {
        if (attribute.domain == AttributeDomain::corner)
            keep(attribute.values, survives, 3 * attribute.components);
        if (attribute.domain == AttributeDomain::triangle)
            keep(attribute.values, survives, attribute.components);
        keep(attribute.tangents, survives, 3);
        keep(attribute.tangent_signs, survives, 3);
    }
}

void normalize_corner_normals(Mesh& mesh) {
    constexpr float kRounding = 1e-6f;
    bool flat = true;
    for (size_t t = 0; t < mesh.triangles.size() && !mesh.normals.empty(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 face = unit_normal(mesh.positions[b] - mesh.positions[a],
                                      mesh.positions[c] - mesh.positions[a]);
        for (size_t k = 0; k < 3; ++k) {
            Vec3& normal = mesh.normals[3 * t + k];
            normal = safe_normalize(normal, face);
            flat = flat && length(normal - face) <= kRounding;
        }
    }
    if (flat) mesh.normals.clear();
}

}  // namespace spc
