// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "study/local_metres.hpp"
#include "study/report_json.hpp"
#include "study/simulation_outputs.hpp"
#include "thalweg/core/triangle_surface.hpp"

namespace thalweg::study {

/// Throws Error where output keys contradict each other: before a long run, not after it.
void check_terrain_files(const Experiment&);

/// A surface and where its zero lies on the map.
struct PlacedSurface {
    TriangleSurface surface;
    LocalMetres local;
};

/// A terrain's own triangles, made given where the heightfield's zero lies, and the files that they go into: none, or
/// mesh.obj and mesh.ply.
struct OwnMesh {
    std::vector<MeshFile> files;
    std::function<PlacedSurface(const LocalMetres&)> surface;
    double extent_m;  ///< longer side of the terrain
};

/// Writes the heightmap and the meshes that an experiment asks for, and returns their keys of summary.json: `heightmap`
/// and `meshes`, each where it is asked for.
Json write_terrain_files(const Raster& elevation, const OwnMesh&, const Experiment&,
                         const std::filesystem::path& folder);
Json write_terrain_files(const Grid&, const Domain&, const Heightfield&, const Finished&, const Experiment&,
                         const std::filesystem::path& folder);
Json write_terrain_files(const Mesh&, const Domain&, const Heightfield&, const Finished&, const Experiment&,
                         const std::filesystem::path& folder);

}  // namespace thalweg::study
