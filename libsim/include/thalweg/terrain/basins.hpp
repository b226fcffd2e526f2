// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/terrain/graph.hpp"

namespace thalweg::terrain {

/// Outlet reached by each node (a node without receiver is its own); `none` without data.
std::vector<Index> outlet_of(const FlowGraph&);

/// 1 where the whole upslope area is known, that is holds no cell on the edge of the data; cells within two rows and
/// columns of the outlet they drain to do not count as cut. If at least 99 % of the cells with data leave by one outlet
/// the mask is a catchment, and every node is complete.
std::vector<std::uint8_t> complete_catchments(const Grid&, const FlowGraph&, std::span<const Boundary>);

/// A catchment in the statistics.
struct Basin {
    Index outlet;        ///< its lowest node
    double area_m2;      ///< upslope area of the outlet
    bool complete;       ///< no part of it is cut off by the edge of the data
};

/// Maximal complete catchments of at least `smallest_area_m2`, largest first (ties: lower outlet); where
/// `keep_incomplete` asks for it, whole drainage trees instead, complete or not.
enum class EdgeBasins { drop, keep };
std::vector<Basin> basins(const FlowGraph&, std::span<const double> drainage_area_m2,
                          std::span<const std::uint8_t> complete, double smallest_area_m2, EdgeBasins);

/// Number of the basin each node belongs to, `none` outside of all. Basins may not overlap.
std::vector<Index> basin_labels(const FlowGraph&, std::span<const Basin>);

/// The nodes of each basin, ascending, as compressed rows: those of basin b are node[offset[b]] to before
/// node[offset[b + 1]]. Linear.
struct BasinNodes {
    std::vector<Index> offset;  ///< basins + 1
    std::vector<Index> node;
};
BasinNodes nodes_of_basins(std::span<const Index> label, Index basins);

/// Length of each basin's divide (m). Along the sides of cells a slanting line is up to √2 times too long; so, after
/// Crofton, the crossings of the label's border with lines through the cells' centres in the four directions of
/// neighbours are counted, each with the distance of such lines and the share of the circle it stands for. On square cells
/// a straight border along the rows is 5.2 % too short, one at 22.5° to them 2.6 % too long, and a circle right to
/// discretisation. Lengths of geographic grids are those of their rows. Linear.
std::vector<double> basin_perimeters(const Grid&, std::span<const Index> label, Index basins);

}  // namespace thalweg::terrain
