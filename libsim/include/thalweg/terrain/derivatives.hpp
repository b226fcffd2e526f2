// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"

/// Derivatives of a raster of heights, cell by cell. All are NaN at no data, where any of the 3 × 3 cells has none, and
/// on the rim. On geographic grids, distances are those of the ellipsoid in the cell's own row, and curvatures are the
/// surface's over the ellipsoid, not over the sheet of degrees (the parallels' own bend is taken out). Linear, on
/// several threads, the same bits for any number of them. Errors fall with the square of the cell
/// (tests/terrain/derivatives.cpp).
namespace thalweg::terrain {

/// Length of the gradient, m/m, by Horn's (1981) differences, as GDAL has it: neighbours across count twice those in
/// the corners. Exact on planes and paraboloids.
std::vector<double> slope(const Grid&, std::span<const double> elevation_m);

/// Where the surface faces, the direction of steepest descent, rad clockwise from north, 0 to under 2π, by the same
/// differences. NaN where it is level.
std::vector<double> aspect(const Grid&, std::span<const double> elevation_m);

/// Curvatures of the quadric of least squares through the 3 × 3 cells (Evans 1980), 1/m, with p, q its gradient and r,
/// s, t its second derivatives east–east, east–north and north–north; NaN where it is level. Exact on quadrics.
///
/// Profile curvature, −(p²r + 2pqs + q²t)/((p² + q²)·(1 + p² + q²)^(3/2)): of the surface down the slope, positive
/// where it steepens (convex).
std::vector<double> profile_curvature(const Grid&, std::span<const double> elevation_m);

/// Plan curvature, −(q²r − 2pqs + p²t)/(p² + q²)^(3/2): of the contour, positive on noses, where flow parts, and
/// negative in hollows; without bound towards level ground.
std::vector<double> plan_curvature(const Grid&, std::span<const double> elevation_m);

/// Difference of the highest and the lowest of the cells whose middle lies within `radius_m`, of those with data:
/// windows that the edge cuts tell of what they hold. NaN only at no data. Throws Error unless the radius is positive.
/// Costs as many steps per cell as the circle has rows.
std::vector<double> local_relief(const Grid&, std::span<const double> elevation_m, double radius_m);

}  // namespace thalweg::terrain
