// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/conditioning.hpp"

#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {

Conditioned conditioned(const Raster& raster, const std::vector<Boundary>& boundary, Conditioning conditioning) {
    Conditioned c;
    c.surface_m =
        conditioning == Conditioning::fill ? terrain::fill(raster.grid, raster.values, boundary) : raster.values;
    c.directions = terrain::route(raster.grid, c.surface_m, boundary);
    c.flat_cells = terrain::resolve_flats(raster.grid, c.surface_m, boundary, c.directions);
    if (conditioning == Conditioning::carve) {
        terrain::drain_lakes(raster.grid, c.surface_m, boundary, c.directions);
    }
    return c;
}

std::vector<Boundary> boundary_of(const Raster& raster, const MeasureOptions& options) {
    if (!options.catchment_outlet) return terrain::data_edge(raster.grid, raster.values);
    std::vector<Boundary> boundary(raster.grid.size(), Boundary::interior);
    boundary[*options.catchment_outlet] = Boundary::base_level;
    return boundary;
}

}  // namespace thalweg::study
