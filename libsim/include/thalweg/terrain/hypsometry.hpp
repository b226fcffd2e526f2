// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

namespace thalweg::terrain {

/// Distribution of area over height (Strahler 1952), both relative.
struct Hypsometry {
    double minimum_m, maximum_m, mean_m;   ///< area-weighted mean
    double integral;                       ///< (mean − min) / (max − min)
    double integral_by_curve;              ///< area under the curve, from the sorted heights; must agree with `integral`
    double skewness, kurtosis;             ///< of the hypsometric curve as a distribution (Harlin 1978)
    std::vector<double> relative_height;   ///< 0 … 1 in equal steps
    std::vector<double> relative_area;     ///< share of the area at or above that height, 1 … 0
};

/// Hypsometry of the nodes with data (elevation not NaN), each weighted by its cell area (m²), at `points` heights.
/// A surface without relief has NaN for the integral and the moments.
Hypsometry hypsometry(std::span<const double> elevation_m, std::span<const double> cell_area_m2, int points = 101);

}  // namespace thalweg::terrain
