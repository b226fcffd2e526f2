// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "thalweg/evolve/simulate.hpp"
#include "thalweg/study/domain.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/study/tables.hpp"

namespace thalweg::study {

/// What came out of either solver, in one shape.
struct Outcome {
    Index steps = 0;
    double time_yr = std::numeric_limits<double>::quiet_NaN();
    bool converged = false;
    std::string stop_reason;
    double max_rate_m_per_yr = std::numeric_limits<double>::quiet_NaN();
    double mean_rate_m_per_yr = std::numeric_limits<double>::quiet_NaN();
    Index frozen_receivers = 0;
    int largest_sediment_iterations = 0;
    Index unconverged_sediment_steps = 0;
    int largest_hillslope_iterations = 0;
    Index unconverged_hillslope_steps = 0;
    std::optional<evolve::MassBalance> mass;
    std::vector<evolve::StepRecord> history;
};

/// The finished landscape, routed once more, with all that is written about it.
struct Finished {
    RoutedTerrain terrain;
    std::vector<double> law_area_m2;  ///< area and slope as the river's law sees them, divided where flow is
    std::vector<double> law_slope;    ///< NaN without receiver
    std::vector<std::uint8_t> talus_limited;
    Index lakes = 0;
    std::vector<channel::SlopeAreaPoint> river_slopes;
    Statistics statistics;
};

/// Rasters of the result: elevation, drainage area and basin of the nearest node.
struct Heightfield {
    Raster elevation;
    std::vector<double> drainage_area_m2 = {};
    std::vector<Index> basin_of = {};
};

/// A raster mesh is written at its own cells. Throws Error where output.resolution asks for others.
Heightfield heightfield(const Grid&, const Domain&, const Finished&, const Experiment&);
Heightfield heightfield(const Mesh&, const Domain&, const Finished&, const Experiment&);

/// Throws Error where the heightfield that the experiment asks for cannot be: before the simulation, not after it.
void check_heightfield(const Grid&, const Domain&, const Experiment&);
void check_heightfield(const Mesh&, const Domain&, const Experiment&);

/// The elevations alone, interpolated as the experiment asks.
Raster elevation_raster(const Grid&, const Domain&, const std::vector<double>& elevation_m, const Experiment&);
Raster elevation_raster(const Mesh&, const Domain&, const std::vector<double>& elevation_m, const Experiment&);

/// Map coordinates of the nodes; refers to the domain.
PositionOf map_positions(const Domain&);

/// GeoTIFFs, GeoPackage and CSVs of a finished simulation.
void write_results(const Heightfield&, const Finished&, const Outcome&, const PositionOf&, const Experiment&,
                   const std::filesystem::path& folder);

}  // namespace thalweg::study
