// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/mesh_file.hpp"

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <locale>

#include "thalweg/core/error.hpp"

namespace thalweg::mesh {
namespace {

using Vertex = CGAL::Simple_cartesian<double>::Point_3;

std::vector<Vertex> vertices_of(const TriangleSurface& surface, const std::filesystem::path& path) {
    constexpr Index most = std::numeric_limits<std::int32_t>::max();  // PLY's indices are signed
    if (surface.triangles.empty()) throw Error(fmt::format("{} would hold no triangle", path.string()));
    if (surface.size() > most) throw Error(fmt::format("{} cannot hold more than 2^31 vertices", path.string()));
    std::vector<Vertex> vertices;
    vertices.reserve(surface.size());
    for (Index v = 0; v < surface.size(); ++v) {
        const double x = surface.x[v], y = surface.y[v], z = surface.z[v];
        if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
            throw Error(fmt::format("vertex {} of {} has no finite coordinates", v, path.string()));
        }
        vertices.emplace_back(x, y, z);
    }
    return vertices;
}

void write_file(std::ofstream& file, const TriangleSurface& surface, const std::vector<Vertex>& vertices,
                MeshFormat format, const std::string& comment) {
    if (format == MeshFormat::ply) {
        CGAL::IO::set_binary_mode(file);
        CGAL::IO::write_PLY(file, vertices, surface.triangles);
        return;
    }
    if (!comment.empty()) file << "# " << comment << '\n';
    file.precision(7);  // as many as importers keep; every further digit makes the file a tenth larger
    CGAL::IO::write_OBJ(file, vertices, surface.triangles);
}

}  // namespace

std::string to_string(MeshFormat format) { return format == MeshFormat::obj ? "obj" : "ply"; }

void write_mesh(const std::filesystem::path& path, const TriangleSurface& surface, MeshFormat format,
                const std::string& comment) {
    const std::vector<Vertex> vertices = vertices_of(surface, path);
    std::ofstream file(path, std::ios::binary);
    if (!file) throw Error(fmt::format("{} cannot be created", path.string()));
    file.imbue(std::locale::classic());
    write_file(file, surface, vertices, format, comment);
    file.close();
    if (file) return;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    throw Error(fmt::format("{} could not be written whole: is the disk full?", path.string()));
}

}  // namespace thalweg::mesh
