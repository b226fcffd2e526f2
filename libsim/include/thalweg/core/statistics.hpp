// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

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
    double r2;                 ///< weighted coefficient of determination
    double reduced_chi2;       ///< weighted residual sum of squares over the degrees of freedom
};

/// Fits a line. `weights` are inverse variances, or empty for equal ones. The errors are scaled by the residual scatter
/// (so only the ratios of the weights matter) and the 95 % intervals use Student's t. With fewer than three points, or
/// no spread in x, what cannot be known is NaN.
Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> weights = {});

double mean(std::span<const double> values);

/// Two-sided 95 % quantile of Student's t with the given degrees of freedom (≥ 1).
double student_t95(double degrees_of_freedom);

}  // namespace thalweg
