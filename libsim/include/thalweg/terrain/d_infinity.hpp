// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/terrain/multiple_flow.hpp"

namespace thalweg::terrain {

/// D∞ (Tarboton 1997): flow in the direction of the steepest of the eight triangular facets around a cell, divided
/// between the two neighbours that enclose it in proportion to the angles.
///
/// A facet is spanned by the cell, a straight and a diagonal neighbour. Its slope is that of the plane through the
/// three where the plane falls between them, else that towards the steeper one. Facets are measured with the row's own
/// lengths, so dx ≠ dy and geographic grids are exact; angles between neighbours are then not 45°. Ties go to the facet
/// that comes first clockwise from the east. Beside voids and edges, where facets are missing, the steepest single
/// neighbour counts as one.
///
/// No loops: inside a facet flow falls towards both neighbours, and only those with a lower water level are taken, as
/// in `multiple_flow`; pits, lakes and flats follow `single`. (Loops of D∞ elsewhere come from flats that were given
/// directions as angles.)
MultipleFlow d_infinity(const Grid&, std::span<const double> elevation_m, const FlowDirections& single);

/// Direction of that flow, radians counter-clockwise from the east, in [0, 2π); towards the receiver where a cell
/// follows `single`. NaN at outlets and without data. Angles are planar, within the facet's own triangle.
std::vector<double> d_infinity_angle(const Grid&, std::span<const double> elevation_m, const FlowDirections& single);

}  // namespace thalweg::terrain
