// SPDX-License-Identifier: GPL-3.0-or-later
// Private: what is written about a grown terrain.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "study/report_json.hpp"
#include "thalweg/core/triangle_surface.hpp"
#include "thalweg/study/grow.hpp"

namespace thalweg::study {

/// The surface's triangles as far as interpolation needs them.
Mesh plane_mesh(const grow::SurfaceMesh&);

/// Per vertex: 0 on channels, 1 elsewhere. Interpolated it tells how far up a valley side a place is.
std::vector<double> ridge_share(const grow::SurfaceMesh&);

/// What `growth.roughness_m` adds at places of the plane (relative to the network's origin), m: five octaves of noise
/// from half the constant of channel maintenance down, none on channels, so that they stay the lowest lines.
std::vector<double> roughness(const Experiment&, const grow::Dials&, std::span<const Point> places,
                              std::span<const double> ridge_share);

/// What a grown terrain's raster has of it, at any places of that plane: by octaves of noise or by subdivision; 0
/// without roughness, NaN outside the basin.
std::vector<double> roughness_at(const Experiment&, const GrownTerrain&, std::span<const Point> places);

/// Upper vertices of exterior links, by link.
std::vector<Index> source_vertices(const grow::Network&);

/// Map coordinates of a network's vertices.
std::vector<Point> map_places(const GrowthSite&, const grow::Network&, std::span<const Index> vertices);

/// Width of a link's channel, m: `growth.channel_width_m` times magnitude to `growth.channel_width_exponent`.
double channel_width_m(const Experiment&, Index magnitude);

/// The surface as triangles with channels and divides as edges: the vertices under tension, one more on every edge
/// across a valley side, and along both banks of every channel where channels have a width, all as rough as the raster
/// is there. In the coordinates of the plane, relative to the network's origin.
TriangleSurface triangles_of(const Experiment&, const GrownTerrain&);

/// Places on the banks, and how many of them lie beyond their valley side and are left out of the triangles.
struct Banks {
    std::vector<Point> places;
    std::size_t all = 0;
    std::size_t beyond = 0;
};
Banks banks_of(const Experiment&, const GrownTerrain&);

/// Layers `links`, `polygons`, `divides`, `junctions` and `sources` of network.gpkg.
std::vector<Table> grown_layers(const Experiment&, const GrownTerrain&);

}  // namespace thalweg::study
