// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "thalweg/core/triangle_surface.hpp"

namespace thalweg::mesh {

enum class MeshFormat {
    obj,  ///< Wavefront, text, seven digits
    ply   ///< Polygon file format, binary little-endian, vertices as doubles
};

/// "obj" or "ply".
std::string to_string(MeshFormat);

/// Writes the triangles (CGAL's writers), z up, in metres; bytes a function of the surface alone. `comment`, one line,
/// stands at the head of an OBJ file. Importers mostly hold vertices as floats of 7 digits: large map coordinates
/// should be taken relative to an origin before.
/// Throws Error for a surface without triangles or with coordinates that are not finite, or if the file cannot be
/// written whole.
void write_mesh(const std::filesystem::path&, const TriangleSurface&, MeshFormat, const std::string& comment = {});

}  // namespace thalweg::mesh
