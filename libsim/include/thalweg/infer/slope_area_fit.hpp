// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thalweg/channel/slope_area.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::infer {

/// What is known besides the slope–area curve.
struct SlopeAreaFitOptions {
    double n = 1;                                        ///< slope exponent, given; > 0
    std::optional<double> uplift_m_per_yr{};             ///< > 0; without it only θ, ks and k/u can be told
    double uplift_sd_m_per_yr = 0;                       ///< ≥ 0, carried into k's error
    double deposition_g = 0;                             ///< G ≥ 0 of rivers that lay down sediment
    std::optional<double> theta_fixed{};                 ///< concavity held at this value
    std::optional<double> area_min_m2{}, area_max_m2{};  ///< bins whose mean area lies outside are left out
    double smallest_se_dex = 0.01;                       ///< floor of a bin's standard error; > 0
};

/// k and m with their uncertainties (k in m^(1−2m)/yr).
///
/// Rivers that lay down sediment (G > 0; Davy & Lague 2009; Yuan et al. 2019) rest under even uplift and rain on slopes
/// ks·A^(−θ) with ks = ((1 + G)·u/k)^(1/n): slope and area tell k/((1 + G)·u), and k with u and G given. θ, ks and m are
/// those without deposition.
///
/// Errors. A bin weighs by the error of its mean (`channel::bin_errors`: moderated and floored). Residuals
/// beyond 1.345 robust standard deviations (1.4826·median |r|, at least the stated errors) count linearly (Huber 1964).
/// Standard errors come from Ceres' covariance at the solution, times √max(1, `reduced_chi2`): scatter larger than the
/// bins' errors explain widens them, smaller scatter does not narrow them. 95 % intervals use Student's t with
/// bins − parameters degrees of freedom; those of ks, k/u, k and k·A0^m are taken in the logarithm, so they are
/// lopsided and positive, and their standard errors are value × that of the logarithm. The uplift's sd/u adds in
/// quadrature to ln k and ln(k·A0^m). Bins are taken as independent, and slopes as a fair sample: where erodibility
/// scatters from cell to cell, rivers seek weak rock, and m comes out too low by more than its error (by 0.01, 0.03 and
/// 0.05 for a scatter of ln S of 0.1, 0.2 and 0.4 in each cell, tried on 64² steady rasters).
struct SlopeAreaFit {
    double n;
    Estimate theta, ks;            ///< S = ks·A^(−θ); ks in m^(2θ)
    Estimate m;                    ///< = n·θ; with `theta_fixed` without error
    Estimate k_over_uplift;        ///< (1 + G)·ks^(−n), m^(−2m)
    std::optional<Estimate> k;     ///< uplift·(1 + G)·ks^(−n)
    std::string k_unit;            ///< of k at the fitted m, e.g. "m^0.1/yr"
    double reference_area_m2;      ///< A0: geometric mean area of the bins, weighted: where k·A^m is known best
    Estimate k_at_reference_area;  ///< k·A0^m, m/yr; NaN without uplift
    double correlation_log_k_m;    ///< of ln k (or ln k/u) and m, not centred: near 1 in size; NaN with `theta_fixed`
    double reduced_chi2;           ///< weighted residuals squared (linear where robust) over degrees of freedom
    int degrees_of_freedom;        ///< bins − free parameters
    int iterations;                ///< of the solver, all rounds
    bool converged;
    std::string message;                  ///< why the solver stopped
    std::array<double, 2> area_range_m2;  ///< least and largest mean area of the bins used
    Estimate curvature;  ///< c of ln S = a − θ·x + c·x², x = ln(A/A0): 0 if one steady, uniform power law
                         ///< holds; NaN with fewer than four bins
    std::vector<std::string> identifiable;    ///< names of the members that the data and what is given determine
    std::vector<std::string> notes;           ///< sentences for the reader: what is missing, what looks doubtful
    std::vector<channel::SlopeAreaBin> bins;  ///< those used
    std::vector<double> fitted_slope;         ///< the curve at those bins
};

/// Weighted least squares of ln S = (ln((1 + G)·u) − ln(k·A0^m) − m·ln(A/A0))/n on the bins with Ceres (Huber loss, one thread),
/// errors from Ceres' covariance. Bins without a positive, finite area and slope are left out. Throws Error with fewer
/// than three bins in the range, or if n, the uplift, its sd, G, the range or the floor is not as required.
SlopeAreaFit fit_slope_area(std::span<const channel::SlopeAreaBin>, const SlopeAreaFitOptions&);

}  // namespace thalweg::infer
