// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/terrain_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "study/local_metres.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/heightmap.hpp"
#include "thalweg/mesh/mesh_file.hpp"
#include "thalweg/surface/solid.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

mesh::MeshFormat format_of(MeshFile file) {
    return file == MeshFile::obj ? mesh::MeshFormat::obj : mesh::MeshFormat::ply;
}

std::vector<MeshFile> files_of(const Experiment& e) {
    return e.output.mesh_file ? std::vector{*e.output.mesh_file} : std::vector<MeshFile>{};
}

double base_of(const TriangleSurface& surface, const Experiment& e, double extent_m) {
    return *std::min_element(surface.z.begin(), surface.z.end()) - e.output.base_depth_m.value_or(extent_m / 20);
}

Json write_surface(const fs::path& folder, const char* name, MeshFile file, TriangleSurface surface,
                   const LocalMetres& local, const Experiment& e, double extent_m) {
    const mesh::MeshFormat format = format_of(file);
    const std::string filename = fmt::format("{}.{}", name, mesh::to_string(format));
    if (surface.triangles.empty()) throw Error(fmt::format("{} would hold no triangle: use more nodes", filename));
    Json described{{"file", filename}};
    if (e.output.solid) {
        const double base = base_of(surface, e, extent_m);
        surface = surface::closed_solid(surface, base);
        described["base_m"] = base;
        described["volume_m3"] = surface::enclosed_volume(surface);
    }
    described["vertices"] = surface.size();
    described["triangles"] = surface.triangles.size();
    described["closed"] = e.output.solid;
    described["origin_x"] = local.origin.x;
    described["origin_y"] = local.origin.y;
    mesh::write_mesh(
        folder / filename, surface, format,
        fmt::format("metres, z up; x and y from the map position ({}, {})", local.origin.x, local.origin.y));
    return described;
}

}  // namespace

void check_terrain_files(const Experiment& e) {
    if (e.output.sigma_cells && e.output.interpolation != Interpolation::gaussian) {
        throw Error("output.sigma_cells belongs to output.interpolation = \"gaussian\": set that, or leave it out");
    }
    if (e.output.solid && !e.output.mesh_file && !e.output.heightfield_mesh_file) {
        throw Error("output.solid closes meshes: ask for output.mesh_file or output.heightfield_mesh_file");
    }
    if (e.output.base_depth_m && !e.output.solid) {
        throw Error("output.base_depth_m is the depth of a solid's base: set output.solid = true, or leave it out");
    }
}

Json write_terrain_files(const Raster& elevation, const OwnMesh& own, const Experiment& e, const fs::path& folder) {
    Json keys = Json::object();
    if (e.output.heightmap) {
        const io::HeightmapScale scale = io::write_heightmap(folder / "elevation.png", elevation);
        keys["heightmap"] = {{"file", "elevation.png"},
                             {"metres_per_count", scale.metres_per_count},
                             {"offset_m", scale.offset_m},
                             {"nodata_count", 0}};
    }
    if (own.files.empty() && !e.output.heightfield_mesh_file) return keys;
    const LocalMetres local = local_metres(elevation);
    keys["meshes"] = Json::array();
    if (!own.files.empty()) {
        const PlacedSurface nodes = own.surface(local);
        for (const MeshFile file : own.files) {
            keys["meshes"].push_back(write_surface(folder, "mesh", file, nodes.surface, nodes.local, e, own.extent_m));
        }
    }
    if (e.output.heightfield_mesh_file) {
        TriangleSurface cells = surface::triangle_surface(elevation.grid, local.centers, elevation.values);
        keys["meshes"].push_back(write_surface(folder, "heightfield", *e.output.heightfield_mesh_file, std::move(cells),
                                               local, e, own.extent_m));
    }
    return keys;
}

Json write_terrain_files(const Grid& grid, const Domain& domain, const Heightfield& h, const Finished& f,
                         const Experiment& e, const fs::path& folder) {
    const auto own = [&](const LocalMetres&) {
        // Its own cells, which the heightfield's need not be (output.resolution).
        LocalMetres local = local_metres(Raster{grid, domain.placement, f.terrain.elevation_m});
        return PlacedSurface{surface::triangle_surface(grid, local.centers, f.terrain.elevation_m), local};
    };
    return write_terrain_files(h.elevation, {.files = files_of(e), .surface = own, .extent_m = domain.extent_m}, e,
                               folder);
}

Json write_terrain_files(const Mesh& mesh, const Domain& domain, const Heightfield& h, const Finished& f,
                         const Experiment& e, const fs::path& folder) {
    const auto own = [&](const LocalMetres& local) {
        TriangleSurface surface = surface::triangle_surface(mesh, f.terrain.elevation_m);
        for (double& x : surface.x) x -= local.origin.x * domain.unit_m;
        for (double& y : surface.y) y -= local.origin.y * domain.unit_m;
        return PlacedSurface{surface, local};
    };
    return write_terrain_files(h.elevation, {.files = files_of(e), .surface = own, .extent_m = domain.extent_m}, e,
                               folder);
}

}  // namespace thalweg::study
