// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/conditioning.hpp"

#include <fmt/format.h>

#include <utility>

#include "thalweg/core/error.hpp"
#include "thalweg/terrain/breach.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"
#include "thalweg/terrain/standing_water.hpp"

namespace thalweg::study {

namespace {

std::vector<double> surface_of(const Raster& raster, const std::vector<Boundary>& boundary,
                               const MeasureOptions& options, std::vector<double> filled_m) {
    switch (options.conditioning) {
        case Conditioning::fill:
            if (filled_m.empty()) return terrain::fill(raster.grid, raster.values, boundary);
            return filled_m;
        case Conditioning::breach: {
            const auto cut = terrain::breach(raster.grid, raster.values, boundary, options.breach_limits);
            return terrain::fill(raster.grid, cut, boundary);
        }
        case Conditioning::carve:
        case Conditioning::none:
            break;
    }
    return raster.values;
}

void check_cells(const Raster& raster, const terrain::StandingWaters& found, const std::vector<Index>& cells) {
    for (const Index cell : cells) {
        if (found.of_cell[cell] != none) continue;
        const Point p = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
        throw Error(
            fmt::format("the point of an endorheic basin near ({:.10g}, {:.10g}) lies in no closed depression of "
                        "the DEM",
                        p.x, p.y));
    }
}

void keep_water(const Raster& raster, const Endorheic& wanted, std::vector<Boundary>& boundary, Index& kept) {
    const auto filled = terrain::fill(raster.grid, raster.values, boundary);
    const terrain::StandingWaters found = terrain::standing_waters(raster.grid, raster.values, filled);
    check_cells(raster, found, wanted.cells);
    std::vector<std::uint8_t> keep(found.waters.size(), 0);
    for (const Index cell : wanted.cells) keep[found.of_cell[cell]] = 1;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        const terrain::StandingWater& water = found.waters[i];
        const bool by_size = wanted.depth_m || wanted.area_m2;
        if (by_size && water.depth_m >= wanted.depth_m.value_or(0) && water.area_m2 >= wanted.area_m2.value_or(0)) {
            keep[i] = 1;
        }
        if (keep[i]) boundary[water.lowest] = Boundary::base_level;
        kept += keep[i];
    }
}

}  // namespace

Conditioned conditioned(const Raster& raster, const std::vector<Boundary>& boundary, const MeasureOptions& options,
                        std::vector<double> filled_m) {
    Conditioned c;
    c.surface_m = surface_of(raster, boundary, options, std::move(filled_m));
    c.directions = terrain::route(raster.grid, c.surface_m, boundary);
    c.flat_cells = terrain::resolve_flats(raster.grid, c.surface_m, boundary, c.directions);
    if (options.conditioning == Conditioning::carve) {
        terrain::drain_lakes(raster.grid, c.surface_m, boundary, c.directions);
    }
    return c;
}

std::vector<Boundary> boundary_of(const Raster& raster, const MeasureOptions& options, Index& kept) {
    std::vector<Boundary> boundary;
    if (options.catchment_outlet) {
        boundary.assign(raster.grid.size(), Boundary::interior);
        boundary[*options.catchment_outlet] = Boundary::base_level;
    } else {
        boundary = terrain::data_edge(raster.grid, raster.values);
    }
    if (options.endorheic.wanted()) keep_water(raster, options.endorheic, boundary, kept);
    return boundary;
}

}  // namespace thalweg::study
