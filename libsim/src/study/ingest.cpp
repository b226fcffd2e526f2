// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/ingest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/statistics.hpp"

namespace thalweg::study {
namespace {

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

/// Drainage trees of at least the channel threshold that reach beyond the data; the smallest source where there is
/// none.
std::size_t cut_basins(const RasterMeasurement& m) {
    const ChannelStatistics& c = m.statistics.channels;
    const double from_m2 = std::isnan(c.threshold_area_m2) ? c.source_area_m2[0] : c.threshold_area_m2;
    if (std::isnan(from_m2)) return 0;
    std::size_t cut = 0;
    for (std::size_t node = 0; node < m.terrain.graph.size(); ++node) {
        const double area_m2 = m.terrain.drainage_area_m2[node];  // 0 without data
        cut += m.terrain.graph.receiver[node] == none && area_m2 > 0 && area_m2 >= from_m2 && !m.terrain.complete[node];
    }
    return cut;
}

}  // namespace

TerrainInput input_of(const NamedRaster& dem, const RasterMeasurement& m) {
    const Grid& grid = dem.raster.grid;
    return {.file = dem.file,
            .sha256 = dem.sha256,
            .crs = dem.crs_name,
            .geographic = dem.raster.placement.geographic,
            .rows = grid.rows,
            .cols = grid.cols,
            .dx_m = mean(grid.east_west),
            .dy_m = mean(grid.north_south),
            .valid_cells = m.valid_cells,
            .nodata_cells = grid.size() - m.valid_cells,
            .area_m2 = m.area_m2,
            .origin = dem.origin};
}

Json ingest_json(const NamedRaster& dem, const RasterMeasurement& m, const HeightSurvey& s,
                 const std::vector<std::string>& hints) {
    const Grid& grid = dem.raster.grid;
    const Placement& p = dem.raster.placement;
    return {{"vertical_unit_m", dem.vertical_unit_m},
            {"cell_width", p.cell_width},
            {"cell_height", p.cell_height},
            {"cell_anisotropy", mean(grid.east_west) / mean(grid.north_south)},
            {"nodata_share", share(grid.size() - m.valid_cells, grid.size())},
            {"void_cells", dem.void_cells},
            {"pits", m.conditioning.pits},
            {"flat_share", share(m.conditioning.flat_cells, m.valid_cells)},
            {"cut_basins", cut_basins(m)},
            {"vertical_quantum_m", m.vertical_quantum_m},
            {"median_step_m", number(s.median_step_m)},
            {"level_share", number(s.level_share)},
            {"most_frequent_m", number(s.most_frequent_m)},
            {"most_frequent_share", number(s.most_frequent_share)},
            {"zero_share", number(s.zero_share)},
            {"row_roughness_m", number(s.row_roughness_m)},
            {"column_roughness_m", number(s.column_roughness_m)},
            {"row_striping", number(s.row_striping)},
            {"column_striping", number(s.column_striping)},
            {"repeated_rows", number(s.repeated_rows)},
            {"repeated_columns", number(s.repeated_columns)},
            {"hints", hints}};
}

std::string ingest_line(const NamedRaster& dem, const RasterMeasurement& m) {
    const Grid& grid = dem.raster.grid;
    const terrain::Hypsometry& h = m.statistics.hypsometry;
    const std::string steps =
        m.vertical_quantum_m > 0 ? fmt::format(" in steps of {:.3g} m", m.vertical_quantum_m) : "";
    return fmt::format(
        "{}: {}, {} rows x {} columns of cells of {:.4g} m north-south x {:.4g} m east-west, heights from {:.1f} to "
        "{:.1f} m{}; no data {:.2g} %, {} pits, flat {:.2g} %, {:.0f} % of the channel cells in complete catchments",
        dem.file, dem.crs_name.empty() ? "no coordinate system" : dem.crs_name, grid.rows, grid.cols,
        mean(grid.north_south), mean(grid.east_west), h.minimum_m, h.maximum_m, steps,
        100 * share(grid.size() - m.valid_cells, grid.size()), m.conditioning.pits,
        100 * share(m.conditioning.flat_cells, m.valid_cells),
        std::isnan(m.statistics.channels.share_used) ? 0 : 100 * m.statistics.channels.share_used);
}

}  // namespace thalweg::study
