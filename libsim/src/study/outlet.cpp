// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/outlet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "study/conditioning.hpp"
#include "study/cut_out.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/study/analyze.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

/// Where a point lies within the grid, in cells from the north-western corner.
struct GridPlace {
    double row, col;
};

GridPlace place_of(const Raster& raster, Index cell, Point point) {
    const Placement& p = raster.placement;
    const Point middle = p.center(raster.grid.row(cell), raster.grid.col(cell));
    double east = (point.x - middle.x) / p.cell_width;
    if (p.geographic) east -= std::round((point.x - middle.x) / 360) * 360 / p.cell_width;
    return {raster.grid.row(cell) + (middle.y - point.y) / p.cell_height, raster.grid.col(cell) + east};
}

/// Distance from a place near the middle of `from` to the middle of `to`, by the measures of the rows at hand.
double distance_m(const Grid& grid, Index from, GridPlace place, Index to) {
    const Index row = grid.row(to);
    const double gap = grid.north_south[std::min(grid.row(from), grid.rows - 2)];
    const double width = 0.5 * (grid.east_west[grid.row(from)] + grid.east_west[row]);
    return std::hypot((place.row - row) * gap, (place.col - grid.col(to)) * width);
}

/// Calls visit(cell, distance) for every cell with data whose middle lies within the radius.
template <class Visit>
void cells_within(const Raster& raster, Index cell, Point point, double radius_m, Visit visit) {
    const Grid& grid = raster.grid;
    const GridPlace place = place_of(raster, cell, point);
    const double gap = *std::ranges::min_element(grid.north_south), width = *std::ranges::min_element(grid.east_west);
    const auto range = [](double middle, double reach, Index count) {
        const double last = count - 1.0;
        return std::pair{static_cast<Index>(std::clamp(std::floor(middle - reach), 0.0, last)),
                         static_cast<Index>(std::clamp(std::ceil(middle + reach), 0.0, last))};
    };
    const auto [top, bottom] = range(place.row, radius_m / gap, grid.rows);
    const auto [left, right] = range(place.col, radius_m / width, grid.cols);
    for (Index row = top; row <= bottom; ++row) {
        for (Index col = left; col <= right; ++col) {
            const Index other = row * grid.cols + col;
            const double distance = distance_m(grid, cell, place, other);
            const bool within = distance <= radius_m || other == cell;
            if (within && !std::isnan(raster.values[other])) visit(other, distance);
        }
    }
}

Index cell_of(const Raster& raster, Point point) {
    const Index cell = cell_at(raster, point);
    const Placement& p = raster.placement;
    if (cell == none) {
        throw Error(
            fmt::format("the outlet ({:.10g}, {:.10g}) lies beside the DEM, which reaches from {:.10g} to {:.10g} "
                        "and from {:.10g} to {:.10g}: give it in the DEM's coordinates",
                        point.x, point.y, p.west, p.west + raster.grid.cols * p.cell_width,
                        p.north - raster.grid.rows * p.cell_height, p.north));
    }
    if (std::isnan(raster.values[cell])) {
        throw Error(fmt::format("the outlet ({:.10g}, {:.10g}) lies where the DEM has no data", point.x, point.y));
    }
    return cell;
}

struct Routed {
    terrain::FlowGraph graph;
    std::vector<double> area_m2;
    std::vector<std::uint8_t> complete;
};

Routed routed(const Raster& raster, const MeasureOptions& options) {
    Index kept = 0;
    const auto boundary = boundary_of(raster, options, kept);
    Conditioned c = conditioned(raster, boundary, options);
    auto [graph, area] = terrain::graph_and_area(raster.grid, c.surface_m, std::move(c.directions));
    const auto complete = terrain::complete_catchments(raster.grid, graph, boundary);
    return {std::move(graph), std::move(area), complete};
}

}  // namespace

Index snapped_outlet(const Raster& raster, Point point, double radius_m, std::span<const double> drainage_area_m2) {
    const Index cell = cell_of(raster, point);
    double largest = 0;
    cells_within(raster, cell, point, radius_m,
                 [&](Index other, double) { largest = std::max(largest, drainage_area_m2[other]); });
    auto best = std::tuple(std::numeric_limits<double>::infinity(), 0.0, none);
    cells_within(raster, cell, point, radius_m, [&](Index other, double distance) {
        if (drainage_area_m2[other] < 0.5 * largest) return;
        best = std::min(best, std::tuple(distance, -drainage_area_m2[other], other));
    });
    return std::get<2>(best);
}

ChannelHeads snapped_heads(const Raster& raster, const ChannelHeads& heads, double radius_m,
                           const MeasureOptions& options) {
    if (!(radius_m > 0))
        throw Error(fmt::format("heads cannot be moved by up to {} m: give a positive radius", radius_m));
    const Grid& grid = raster.grid;
    const Routed r = routed(raster, options);
    ChannelHeads snapped = heads;
    snapped.snap_m = radius_m;
    std::vector<double> distances;
    for (Index& cell : snapped.cells) {
        const Index from = cell;
        const Point middle = raster.placement.center(grid.row(from), grid.col(from));
        cell = snapped_outlet(raster, middle, radius_m, r.area_m2);
        snapped.moved += cell != from;
        distances.push_back(distance_m(grid, from, place_of(raster, from, middle), cell));
    }
    if (!distances.empty()) {
        snapped.mean_moved_m = mean(distances);
        snapped.largest_moved_m = std::ranges::max(distances);
    }
    std::ranges::sort(snapped.cells);
    const auto repeated = std::ranges::unique(snapped.cells);
    snapped.merged += static_cast<Index>(repeated.size());
    snapped.cells.erase(repeated.begin(), repeated.end());
    return snapped;
}

OutletCatchment catchment_above(const Raster& raster, const OutletRequest& request, const MeasureOptions& options) {
    const Index cell = cell_of(raster, request.at);
    const Grid& grid = raster.grid;
    const double snap_m = request.snap_m.value_or(5 * std::max(grid.east_west[grid.row(cell)], mean(grid.north_south)));
    const Routed r = routed(raster, options);
    const Index outlet = snapped_outlet(raster, request.at, snap_m, r.area_m2);
    const bool complete = r.complete[outlet] != 0;
    const auto label =
        terrain::basin_labels(r.graph, std::vector<terrain::Basin>{{outlet, r.area_m2[outlet], complete}});
    if (std::ranges::count(label, Index{0}) < 2) {
        throw Error(
            fmt::format("no cell drains to the outlet ({:.10g}, {:.10g}): let it be moved further with --snap-m",
                        request.at.x, request.at.y));
    }
    std::vector<std::uint8_t> inside(label.size());
    std::ranges::transform(label, inside.begin(), [](Index basin) { return basin == 0 ? 1 : 0; });
    Catchment catchment = cut_out(raster, label, outlet);
    return {.raster = std::move(catchment.raster),
            .outlet = catchment.outlet,
            .report = {.given = request.at,
                       .snapped = raster.placement.center(grid.row(outlet), grid.col(outlet)),
                       .snap_m = snap_m,
                       .moved_m = distance_m(grid, cell, place_of(raster, cell, request.at), outlet),
                       .area_m2 = r.area_m2[outlet],
                       .complete = complete},
            .void_cells = io::void_cells_beside(raster, inside)};
}

NamedRaster cut_to_outlet(const NamedRaster& dem, const OutletRequest& request, MeasureOptions& options,
                          const Messages& messages) {
    messages.progress("looking for the outlet");
    OutletCatchment cut = catchment_above(dem.raster, request, options);
    options.catchment_outlet = cut.outlet;
    options.endorheic = {};  // what keeps its water does not drain to the outlet and is gone
    if (!options.channel_area_m2 && options.channels == ChannelRule::area) {
        options.channel_area_m2 = catchment_channel_area(cut.raster);
    }
    NamedRaster basin{.raster = std::move(cut.raster),
                      .file = dem.file,
                      .sha256 = dem.sha256,
                      .crs_name = dem.crs_name,
                      .warnings = dem.warnings,
                      .origin = dem.origin,
                      .vertical_unit_m = dem.vertical_unit_m,
                      .void_cells = cut.void_cells,
                      .outlet = cut.report};
    if (!cut.report.complete) {
        basin.warnings.push_back(
            "the basin above the outlet is cut off by the edge of the data, or by a hole in it: its drainage areas are "
            "too small, and what hangs on them is wrong by as much");
        messages.warning(basin.warnings.back());
    }
    return basin;
}

}  // namespace thalweg::study
