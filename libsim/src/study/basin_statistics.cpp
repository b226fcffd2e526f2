// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/basin_statistics.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "thalweg/core/error.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void add_relief(const RoutedTerrain& terrain, std::span<const double> ground_m, const terrain::BasinNodes& rows,
                std::vector<BasinStatistics>& basins) {
    auto curves = terrain::hypsometries(ground_m, terrain.cell_area_m2, rows.offset, rows.node);
    for (std::size_t b = 0; b < basins.size(); ++b) {
        basins[b].relief_m = curves[b].maximum_m - curves[b].minimum_m;
        basins[b].hypsometry = std::move(curves[b]);
    }
}

void add_form(const RoutedTerrain& terrain, const Statistics& s, std::span<const terrain::Basin> found,
              const terrain::BasinNodes& rows, std::vector<BasinStatistics>& basins) {
    for (BasinStatistics& basin : basins) basin.length_m = basin.asymmetry_percent = nan;
    if (terrain.offset_m) {
        const auto length = channel::basin_lengths(rows, found, terrain.offset_m);
        const auto sides = channel::trunk_sides(terrain.graph, terrain.drainage_area_m2, s.network,
                                                s.network_laws.main_streams, found, terrain.offset_m);
        for (std::size_t b = 0; b < basins.size(); ++b) {
            basins[b].length_m = length[b];
            basins[b].asymmetry_percent = sides[b].asymmetry_percent();
        }
    }
    for (BasinStatistics& b : basins) {
        b.perimeter_m = nan;
        b.shape = channel::basin_shape(b.basin.area_m2, b.length_m, nan, b.relief_m);
    }
}

void add_channels(const Statistics& s, std::vector<BasinStatistics>& basins) {
    for (Index link = 0; link < s.network.size(); ++link) {
        const Index basin = s.basin_of[s.network.nodes_of(link).front()];
        if (basin == none) continue;
        basins[basin].channel_length_m += s.network.length_m[link];
        basins[basin].sources += s.network.shreve[link] == 1;
    }
    for (BasinStatistics& b : basins) {
        b.drainage_density_per_m = b.channel_length_m / b.basin.area_m2;
    }
}

void add_slope_area(const Statistics& s, std::vector<BasinStatistics>& basins) {
    std::vector<std::vector<channel::SlopeAreaPoint>> points(basins.size());
    for (const channel::SlopeAreaPoint& point : s.slope_area_points) {
        const Index basin = point.node == none ? none : s.basin_of[point.node];
        if (basin != none) points[basin].push_back(point);
    }
    for (std::size_t b = 0; b < basins.size(); ++b) {
        basins[b].slope_area = channel::fit_slope_area(channel::slope_area_bins(points[b]));
    }
}

void add_steepness(const Statistics& s, std::vector<BasinStatistics>& basins) {
    std::vector<std::vector<double>> ksn(basins.size());
    for (Index row = 0; row < s.chi.profile.size(); ++row) {
        const Index basin = s.basin_of[s.chi.profile.node[row]];
        if (basin != none && !std::isnan(s.chi.ksn[row])) ksn[basin].push_back(s.chi.ksn[row]);
    }
    for (std::size_t b = 0; b < basins.size(); ++b) {
        for (std::size_t quarter = 0; quarter < 3; ++quarter) {
            basins[b].ksn_quartiles[quarter] = quantile(ksn[b], 0.25 * static_cast<double>(quarter + 1));
        }
    }
}

}  // namespace

std::vector<BasinStatistics> basin_statistics(const RoutedTerrain& terrain, std::span<const double> ground_m,
                                              std::span<const terrain::Basin> found, const Statistics& s) {
    std::vector<BasinStatistics> basins;
    for (const terrain::Basin& basin : found) basins.push_back({.basin = basin});
    const terrain::BasinNodes rows = terrain::nodes_of_basins(s.basin_of, static_cast<Index>(found.size()));
    add_relief(terrain, ground_m, rows, basins);
    add_form(terrain, s, found, rows, basins);
    add_channels(s, basins);
    add_slope_area(s, basins);
    add_steepness(s, basins);
    return basins;
}

void add_perimeters(std::span<const double> perimeter_m, Statistics& s) {
    if (perimeter_m.size() != s.basins.size()) throw Error("there must be one perimeter per basin");
    for (std::size_t b = 0; b < s.basins.size(); ++b) {
        BasinStatistics& basin = s.basins[b];
        basin.perimeter_m = perimeter_m[b];
        basin.shape = channel::basin_shape(basin.basin.area_m2, basin.length_m, basin.perimeter_m, basin.relief_m);
    }
}

}  // namespace thalweg::study
