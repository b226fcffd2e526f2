// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/cell_areas.hpp"
#include "thalweg/core/index.hpp"

namespace thalweg::terrain {

/// Distribution of area over height (Strahler 1952), both relative.
struct Hypsometry {
    double minimum_m, maximum_m, mean_m;  ///< area-weighted mean
    double integral;                      ///< (mean − min) / (max − min)
    double integral_by_curve;             ///< area under the curve, from the sorted heights; must agree with `integral`
    /// Of the hypsometric curve as a distribution (Harlin 1978): with f(x) the relative height that the share x of the
    /// area lies above, μ = ∫x·f dx / ∫f dx and m_k = ∫(x − μ)^k·f dx / ∫f dx over 0 ≤ x ≤ 1, the skewness is
    /// m_3 / m_2^(3/2) and the kurtosis m_4 / m_2² (not the excess over 3). A tilted plane has 2√2/5 and 2.4.
    double skewness, kurtosis;
    /// The same of the curve's density −df/dx, which tells where along the area the height is lost (Harlin 1978). A
    /// tilted plane has 0 and 1.8.
    double density_skewness, density_kurtosis;
    std::vector<double> relative_height;  ///< 0 … 1 in equal steps
    std::vector<double> relative_area;    ///< share of the area at or above that height, 1 … 0
};

/// Hypsometry of the nodes with data (elevation not NaN), each weighted by its cell area (m²), at `points` heights.
/// A surface without relief has NaN for the integral and the moments, and an empty curve; one without data has NaN for
/// the heights too. Throws Error if the arrays differ in size or `points` is below 2.
///
/// Up to 65 536 cells are sorted, and the integral, the moments and the curve are exact for the cells seen as steps. Of
/// more cells those within one of some 65 536 equal parts of the relief make one step at their mean height, so that the
/// cost is linear: the integral stays exact, the curve at the asked heights too, and the moments err by less than 1e-8.
Hypsometry hypsometry(std::span<const double> elevation_m, const CellAreas& cell_area_m2, int points = 101);

/// The same of each basin: the nodes of basin b are `nodes[offset[b]]` to before `nodes[offset[b + 1]]`.
std::vector<Hypsometry> hypsometries(std::span<const double> elevation_m, const CellAreas& cell_area_m2,
                                     std::span<const Index> offset, std::span<const Index> nodes, int points = 21);

}  // namespace thalweg::terrain
