// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>
#include <vector>

#include "thalweg/core/mesh.hpp"
#include "thalweg/core/raster.hpp"
#include "thalweg/evolve/landscape.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// A DEM cut down to one catchment: NaN outside, cropped to its bounding box with a margin of one cell.
struct Catchment {
    Raster raster;
    Index outlet;  ///< node of `raster` where its water leaves
};

/// The largest complete catchment of a DEM. Throws Error if the DEM holds none.
Catchment largest_complete_catchment(const Raster&, const MeasureOptions&);

/// Where a simulation happens: nodes with their geometry, drivers and start, and their place on the earth.
struct Domain {
    std::variant<Grid, Mesh> topology;
    Placement placement;             ///< of the grid; of a mesh only its coordinate system
    double unit_m = 1;               ///< a mesh's x and y (m) divided by this are map coordinates
    std::vector<Point> positions_m;  ///< of every node, on a plane
    double extent_m = 0;             ///< longer side
    double area_m2 = 0;              ///< of the domain, computed apart from the cells where that is possible
    evolve::Setting setting;
    std::vector<std::string> warnings;  ///< of reading a DEM
    evolve::Landscape start;            ///< NaN where a grid's cell lies outside
};

/// The domain that an experiment describes. Throws Error where its parameters contradict each other.
Domain make_domain(const Experiment&, const Messages&);

/// The same on a catchment that has been cut out already.
Domain make_domain(const Experiment&, const Catchment&);

}  // namespace thalweg::study
