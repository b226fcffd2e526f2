// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

namespace thalweg {

/// A fitted number with its uncertainty. Where a quantity is undefined all members are NaN.
struct Estimate {
    double value;
    double standard_error;
    std::array<double, 2> interval95;
};

/// Straight line y = intercept + slope·x by weighted least squares, with what the residuals say of its errors.
struct Line {
    Estimate slope;
    Estimate intercept;
    double r2;            ///< weighted coefficient of determination
    double reduced_chi2;  ///< weighted residual sum of squares over the degrees of freedom
};

/// Fits a line. `weights` are inverse variances, or empty for equal ones. The errors are scaled by the residual scatter
/// (so only the ratios of the weights matter) and the 95 % intervals use Student's t. With fewer than three points, or
/// no spread in x, what cannot be known is NaN.
Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> weights = {});

/// What e^x is where x is only estimated: the error to first order, the interval's ends carried over.
Estimate exponential(const Estimate& logarithm);

/// Power law y = coefficient·x^exponent.
struct PowerLawFit {
    Estimate coefficient;
    Estimate exponent;
    double r2;  ///< weighted coefficient of determination of the logarithms
};

/// Fits ln y on ln x with fit_line; pairs in which either is not above zero are left out.
PowerLawFit fit_power_law(std::span<const double> x, std::span<const double> y, std::span<const double> weights = {});

double mean(std::span<const double> values);  ///< NaN for none

/// Standard deviation of a sample, with n − 1; NaN for fewer than two values.
double standard_deviation(std::span<const double> values);

/// The value under which the given share of a sample lies, interpolated linearly between its members in order (0: the
/// smallest, 0.5: the median, 1: the largest); NaN for no values.
double quantile(std::vector<double> values, double share);

/// Largest difference between the shares of two samples that lie at or below any value (Kolmogorov–Smirnov), 0 to 1;
/// NaN where a sample is empty.
double kolmogorov_distance(std::vector<double> a, std::vector<double> b);

/// Two-sided 95 % quantile of Student's t with the given degrees of freedom (≥ 1).
double student_t95(double degrees_of_freedom);

}  // namespace thalweg
