// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/displace.h"

#include "core/cancellation.h"
#include "core/limits.h"
#include "core/parallel.h"
#include "math/triangle.h"
#include "scene/clean_mesh.h"
#include "scene/surface.h"

#include <fmt/format.h>

namespace spc {
namespace {

// The corner at which a vertex is looked at: that of the first triangle whose material moves it.
struct MovedVertex {
    uint32_t vertex;
    SurfaceHit corner;
};

std::vector<MovedVertex> moved_vertices(const Scene& scene, uint32_t instance) {
    const Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    std::vector<MovedVertex> moved;
    std::vector<char> known(mesh.positions.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Material& material = scene.materials[scene.material_index(instance, t)];
        for (uint32_t k = 0; k < 3 && material.moves_vertices; ++k) {
            const uint32_t vertex = mesh.triangles[t][k];
            if (known[vertex]) continue;
            known[vertex] = 1;
            moved.push_back({vertex, {instance, t, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f}});
        }
    }
    return moved;
}

bool stays_in_bounds(const Vec3& p) {
    return is_finite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kFarthest;
}

// Where the vertices of the instance's mesh go. Returns how many would go beyond all bounds; they
// stay.
uint32_t move_vertices(const Scene& scene, uint32_t instance, uint32_t threads,
                       std::vector<Vec3>& positions) {
    const Instance& owner = scene.instances[instance];
    const std::vector<MovedVertex> moved = moved_vertices(scene, instance);
    constexpr size_t kBatch = 4096;
    std::atomic<uint32_t> refused{0};
    parallel_for(
        threads, static_cast<uint32_t>((moved.size() + kBatch - 1) / kBatch), [&](uint32_t b) {
            for (size_t i = b * kBatch; i < std::min(moved.size(), (b + 1) * kBatch); ++i) {
                const Vec3 offset = surface_displacement(scene, moved[i].corner);
                Vec3& p = positions[moved[i].vertex];
                const Vec3 there = p + owner.world_to_object.vector(offset);
                if (stays_in_bounds(there) && stays_in_bounds(owner.object_to_world.point(there)))
                    p = there;
                else
                    ++refused;
            }
        });
    return refused;
}

std::vector<Vec3> face_normals(const Mesh& mesh, const std::vector<Vec3>& positions) {
    std::vector<Vec3> normals;
    normals.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles)
        normals.push_back(unit_normal(positions[b] - positions[a], positions[c] - positions[a]));
    return normals;
}

// Means of the normals of the faces around each vertex, by their angles there.
std::vector<Vec3> vertex_normals(const Mesh& mesh, const std::vector<Vec3>& positions,
                                 const std::vector<Vec3>& of_faces) {
    std::vector<Vec3> normals(positions.size(), Vec3(0.0f));
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& corner = positions[mesh.triangles[t][k]];
            const Vec3 to_next = positions[mesh.triangles[t][(k + 1) % 3]] - corner,
                       to_last = positions[mesh.triangles[t][(k + 2) % 3]] - corner;
            const float angle = std::atan2(length(cross(to_next, to_last)), dot(to_next, to_last));
            normals[mesh.triangles[t][k]] += of_faces[t] * angle;
        }
    for (Vec3& n : normals) n = safe_normalize(n, Vec3(0.0f));
    return normals;
}

// Smooth corners turn as the normals of their vertices do, so that sharp edges stay; flat faces
// have those of their own. A bump beside the displacement turns the vertices' normals before it, as
// in Cycles on flat faces too.
void turn_normals(const Scene& scene, const Instance& instance, const Mesh& before, Mesh& mesh) {
    const auto is_both = [&](uint32_t material) {
        return scene.materials[material]->displacement == DisplacementMode::both;
    };
    if (!mesh.shaded_smooth &&
        std::none_of(instance.materials.begin(), instance.materials.end(), is_both))
        return;
    const std::vector<Vec3> faces_before = face_normals(mesh, before.positions),
                            faces = face_normals(mesh, mesh.positions);
    const std::vector<Vec3> vertices_before = vertex_normals(mesh, before.positions, faces_before),
                            vertices = vertex_normals(mesh, mesh.positions, faces);
    mesh.normals.resize(3 * mesh.triangles.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const bool both = is_both(instance.materials[mesh.slot_of(static_cast<uint32_t>(t))]);
        const bool flat =
            !mesh.shaded_smooth || (!mesh.flat_faces.empty() && mesh.flat_faces[t] != 0);
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t vertex = mesh.triangles[t][k];
            const Vec3 corner = before.normals.empty() ? faces_before[t] : before.normals[3 * t + k];
            const Vec3 n = both   ? vertices_before[vertex]
                           : flat ? faces[t]
                                  : corner + vertices[vertex] - vertices_before[vertex];
            mesh.normals[3 * t + k] = safe_normalize(n, faces[t]);
        }
    }
}

// Into the planes of the new normals.
void turn_tangents(Mesh& mesh) {
    if (mesh.normals.empty()) return;
    for (Attribute& attribute : mesh.attributes)
        for (size_t i = 0; i < attribute.tangents.size(); ++i) {
            Vec3& tangent = attribute.tangents[i];
            tangent =
                safe_normalize(tangent - mesh.normals[i] * dot(mesh.normals[i], tangent), tangent);
        }
}

Mesh displaced(Scene& scene, uint32_t index, uint32_t threads) {
    const Instance& instance = scene.instances[index];
    const Mesh& before = scene.meshes[instance.mesh];
    Mesh mesh = before;
    mesh.positions.reserve(before.positions.size() + 1);  // Embree reads 16 bytes at the last vertex
    const uint32_t refused = move_vertices(scene, index, threads, mesh.positions);
    if (refused > 0)
        scene.report.push_back(
            fmt::format("{}: {} vertices would be displaced beyond all bounds, they stay",
                        instance.name, refused));
    turn_normals(scene, instance, before, mesh);
    for (const uint32_t material : instance.materials)
        if (scene.materials[material]->displacement == DisplacementMode::both)
            mesh.rest_positions = before.positions;
    drop_degenerate_triangles(mesh);
    normalize_corner_normals(mesh);
    turn_tangents(mesh);
    mesh.bounds = {};
    for (const Vec3& p : mesh.positions) mesh.bounds.extend(p);
    return mesh;
}

}  // namespace

void displace(Scene& scene, uint32_t threads) {
    std::map<std::pair<uint32_t, std::vector<uint32_t>>, uint32_t> known;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        Cancellable::check();
        Instance& instance = scene.instances[i];
        const auto moves = [&](uint32_t material) {
            return scene.materials[material]->moves_vertices;
        };
        if (std::none_of(instance.materials.begin(), instance.materials.end(), moves)) continue;
        const auto [mesh, is_new] = known.try_emplace({instance.mesh, instance.materials},
                                                      static_cast<uint32_t>(scene.meshes.size()));
        if (is_new) scene.meshes.push_back(displaced(scene, i, threads));
        instance.mesh = mesh->second;
    }
}

}  // namespace spc
