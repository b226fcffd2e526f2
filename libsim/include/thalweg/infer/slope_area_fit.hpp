// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thalweg/channel/slope_area.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::infer {

/// What is known besides the slope–area curve.
struct SlopeAreaFitOptions {
    double n = 1;                              ///< slope exponent, given
    std::optional<double> uplift_m_per_yr;     ///< without it only θ, ks and k/u can be told
    double uplift_sd_m_per_yr = 0;             ///< carried into k's error
    std::optional<double> theta_fixed;         ///< concavity held at this value
    std::optional<double> area_min_m2, area_max_m2;
    double smallest_se_dex = 0.01;             ///< floor of a bin's standard error
};

/// k and m with their uncertainties (k in m^(1−2m)/yr).
struct SlopeAreaFit {
    double n;
    Estimate theta, ks;                        ///< S = ks·A^(−θ)
    Estimate m;                                ///< = n·θ
    Estimate k_over_uplift;                    ///< ks^(−n), m^(−2m)
    std::optional<Estimate> k;                 ///< uplift·ks^(−n)
    double reference_area_m2;                  ///< geometric mean area of the bins, weighted: where k·A^m is known best
    Estimate k_at_reference_area;              ///< k·A0^m, 1/yr·m; NaN without uplift
    double correlation_log_k_m;
    double reduced_chi2;
    int iterations;
    bool converged;
    std::string message;
    std::array<double, 2> area_range_m2;
    std::vector<channel::SlopeAreaBin> bins;   ///< those used
    std::vector<double> fitted_slope;          ///< the curve at those bins
};

/// Weighted least squares of ln S = (ln u − ln(k·A0^m) − m·ln(A/A0))/n on the bins with Ceres (Huber loss, one thread),
/// errors from Ceres' covariance. Throws Error with fewer than three bins in the range.
SlopeAreaFit fit_slope_area(std::span<const channel::SlopeAreaBin>, const SlopeAreaFitOptions&);

}  // namespace thalweg::infer
