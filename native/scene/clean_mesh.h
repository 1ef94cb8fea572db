// SPDX-License-Identifier: GPL-3.0-or-later
// What the rest of the core takes for granted of a mesh.
#pragma once

#include "scene/description.h"

namespace spc {

// Triangles of zero area go, with all that belongs to them, and are counted in the mesh.
void drop_degenerate_triangles(Mesh& mesh);

// Corner normals become unit; one of zero length becomes the face's. All go where they are those of
// the faces: flat meshes are evaluated faster.
void normalize_corner_normals(Mesh& mesh);

}  // namespace spc
